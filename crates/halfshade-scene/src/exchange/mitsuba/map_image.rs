//! A map of texels as a picture between whose pixels Mitsuba interpolates, and back.

use crate::light::EnvironmentMap;
use glam::Vec3;

/// Most pixels that texels are repeated to.
const MOST_PIXELS: usize = 1 << 22;
/// Most copies of a texel along an axis.
const MOST_COPIES: usize = 32;

/// A picture: columns, rows, pixels row by row.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Image {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) pixels: Vec<Vec3>,
}

/// How often a texel of the map is written along each axis.
pub(super) fn copies(map: &EnvironmentMap) -> usize {
    let texels = map.width() * map.height();
    (2..=MOST_COPIES).rev().find(|copies| copies * copies * texels <= MOST_PIXELS).unwrap_or(2)
}

/// The picture in which each texel is k columns wide and k rows high.
///
/// Mitsuba's rows 0 to k·h lie at the polar angles π i / (k h), so that every k-th lies on an edge between texels and
/// holds the mean of both. Columns lie at (j + 1/2)/(k w) of a turn, so that none lies on an edge. What is interpolated is
/// then the map but for ramps from texel to texel, 2/k and 1/k of a texel wide, whose means are those of the step.
pub(super) fn image(map: &EnvironmentMap) -> Image {
    let k = copies(map);
    let (width, height) = (k * map.width(), k * map.height() + 1);
    let texel = |column: usize, row: usize| map.texels()[row * map.width() + column];
    let mut pixels = Vec::with_capacity(width * height);
    for row in 0..height {
        let (above, below) = (row.saturating_sub(1) / k, (row / k).min(map.height() - 1));
        pixels.extend((0..width).map(|column| {
            let (above, below) = (texel(column / k, above), texel(column / k, below));
            if above == below { above } else { 0.5 * above + 0.5 * below }
        }));
    }
    Image { width, height, pixels }
}

/// The map of which [`image`] makes this picture, if there is one.
pub(super) fn map(picture: &Image) -> Option<EnvironmentMap> {
    let Image { width, height, pixels } = picture;
    let fits = |k: &usize| width.is_multiple_of(*k) && (height - 1).is_multiple_of(*k) && *height > *k;
    (2..=MOST_COPIES).rev().filter(fits).find_map(|k| {
        let (columns, rows) = (width / k, (height - 1) / k);
        let texels = (0..rows).flat_map(|row| (0..columns).map(move |column| (row * k + 1) * width + column * k));
        let map = EnvironmentMap::new(columns, rows, texels.map(|place| pixels[place]).collect())?;
        (copies(&map) == k && image(&map) == *picture).then_some(map)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spotted(width: usize, height: usize) -> EnvironmentMap {
        let texels = (0..width * height).map(|i| Vec3::new((i * 7 % 11) as f32, (i % 3) as f32, 1e6)).collect();
        EnvironmentMap::new(width, height, texels).unwrap()
    }

    /// Mitsuba's interpolation at a point of its unit square.
    fn at(picture: &Image, u: f32, v: f32) -> Vec3 {
        let (x, y) = (u * picture.width as f32 - 0.5, v * (picture.height - 1) as f32);
        let pixel = |x: f32, y: f32| {
            let column = x.rem_euclid(picture.width as f32) as usize;
            picture.pixels[(y as usize).min(picture.height - 1) * picture.width + column]
        };
        let row = |y: f32| pixel(x.floor(), y).lerp(pixel(x.floor() + 1.0, y), x - x.floor());
        row(y.floor()).lerp(row(y.floor() + 1.0), y - y.floor())
    }

    #[test]
    fn texels_keep_their_radiance_but_for_ramps_at_their_edges() {
        let map = spotted(8, 4);
        let picture = image(&map);
        assert_eq!((picture.width, picture.height), (256, 129));
        for row in 0..4 {
            for column in 0..8 {
                for inside in [0.1, 0.5, 0.9] {
                    let (u, v) = ((column as f32 + inside) / 8.0, (row as f32 + inside) / 4.0);
                    assert_eq!(at(&picture, u, v), map.texels()[row * 8 + column], "{column} {row}");
                }
            }
        }
        let edge = at(&picture, 0.3, 0.25);
        assert!(edge.distance(0.5 * (map.texels()[2] + map.texels()[10])) < 0.1);
    }

    #[test]
    fn pictures_of_repeated_texels_are_taken_back_and_others_are_not() {
        for (width, height) in [(8, 4), (1, 1), (7, 3), (256, 128)] {
            let map_of_texels = spotted(width, height);
            assert_eq!(map(&image(&map_of_texels)).as_ref(), Some(&map_of_texels), "{width} {height}");
        }
        let mut picture = image(&spotted(8, 4));
        picture.pixels[300] += Vec3::X;
        assert_eq!(map(&picture), None);
        assert_eq!(map(&Image { width: 4, height: 1, pixels: vec![Vec3::ONE; 4] }), None);
    }
}
