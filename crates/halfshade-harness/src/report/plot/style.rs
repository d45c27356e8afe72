//! Size, font, colours, marks and lines of plots.

use plotters::{prelude::*, style::FontStyle};
use std::sync::Once;

/// Colours of strategies, by their place in the list of all: Okabe and Ito's, made for the colour-blind, and three more.
const PALETTE: [RGBColor; 10] = [
    RGBColor(86, 86, 86),
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(150, 110, 40),
    RGBColor(110, 70, 200),
    RGBColor(140, 20, 50),
];

/// Colour of the stage at a place in a plot's legend; from the tenth on lighter ones.
pub(super) fn stage_color(place: usize) -> RGBColor {
    let RGBColor(r, g, b) = PALETTE[(place + 1) % PALETTE.len()];
    let lighter = |value: u8| if place + 1 < PALETTE.len() { value } else { value / 2 + 127 };
    RGBColor(lighter(r), lighter(g), lighter(b))
}

/// Number of marks.
pub(super) const MARKS: usize = 12;

/// Lengths of dashes and of gaps between them, in pixels of an SVG; none for a solid line.
const DASHES: [Option<[u32; 2]>; 4] = [None, Some([10, 4]), Some([3, 3]), Some([18, 5])];

/// Font of all text: what is embedded, and where that is not read, the same if it is installed.
pub(super) const FAMILY: &str = "DejaVu Sans";
/// Width and least height in pixels of an SVG.
pub(super) const SIZE: (u32, u32) = (1000, 600);
/// Width of the legend, within it.
pub(super) const LEGEND_WIDTH: u32 = 290;

/// Looks of a series, the same in every plot of some results.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Look {
    pub(super) color: RGBColor,
    /// Less than [`MARKS`].
    pub(super) mark: usize,
    pub(super) dash: Option<[u32; 2]>,
}

impl Look {
    /// Looks of the series at `place` among all of some results, of the strategy at `strategy` among all. No two of the first 48
    /// series share mark and line, no two of the first twelve a mark.
    pub(super) fn new(strategy: usize, place: usize) -> Self {
        let mark = place % MARKS;
        let dash = DASHES[(place / MARKS + mark) % DASHES.len()];
        Self { color: PALETTE[strategy % PALETTE.len()], mark, dash }
    }

    /// The same on a graphics device: lighter.
    pub(super) fn lighter(self) -> Self {
        let RGBColor(r, g, b) = self.color;
        let [r, g, b] = [r, g, b].map(|value| value + (255 - value) / 2);
        Self { color: RGBColor(r, g, b), ..self }
    }
}

/// Makes [`FAMILY`] known to the library.
pub(super) fn register_font() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        // Both are sound font files of the crate; were one not, drawing would say so.
        let _ = plotters::style::register_font(FAMILY, FontStyle::Normal, dejavu::sans::regular());
        let _ = plotters::style::register_font(FAMILY, FontStyle::Bold, dejavu::sans::bold());
    });
}

/// A filled polygon and its outline, in pixels.
pub(super) type Mark = (Polygon<(i32, i32)>, PathElement<(i32, i32)>);

/// Radius that no mark exceeds, in pixels of an SVG.
pub(super) const MARK_RADIUS: u32 = 8;

/// A mark about the origin of pixels, as a polygon and its outline.
pub(super) fn mark(look: Look, filled: bool, scale: u32) -> Mark {
    let size = f64::from(5 * scale);
    let points: Vec<(i32, i32)> = outline(look.mark)
        .into_iter()
        .map(|(radius, degrees)| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            ((size * radius * cos).round() as i32, (size * radius * sin).round() as i32)
        })
        .collect();
    let inside = if filled { look.color } else { WHITE };
    (Polygon::new(points.clone(), inside.filled()), PathElement::new(points, look.color.stroke_width(scale)))
}

/// A closed outline in polar coordinates, angles in degrees from the right, downwards.
fn outline(mark: usize) -> Vec<(f64, f64)> {
    let regular = |corners: u32, radius: f64, turn: f64| -> Vec<(f64, f64)> {
        (0..=corners).map(|i| (radius, turn + 360.0 * f64::from(i) / f64::from(corners))).collect()
    };
    let star = |points: u32, inner: f64, outer: f64, turn: f64| -> Vec<(f64, f64)> {
        let radius = |i: u32| if i.is_multiple_of(2) { outer } else { inner };
        (0..=2 * points).map(|i| (radius(i), turn + 180.0 * f64::from(i) / f64::from(points))).collect()
    };
    /// Corners of a cross of four arms, within a quarter: two at the end of an arm, one between arms.
    const CROSS: [(f64, f64); 3] = [(1.45, -18.0), (1.45, 18.0), (0.6, 45.0)];
    let cross = |turn: f64| -> Vec<(f64, f64)> {
        let corners = (0..4).flat_map(|arm| CROSS.map(|(r, angle)| (r, angle + turn + 90.0 * f64::from(arm))));
        corners.chain([(CROSS[0].0, CROSS[0].1 + turn)]).collect()
    };
    match mark {
        0 => regular(24, 1.0, 0.0),
        1 => regular(4, 1.25, 45.0),
        2 => regular(3, 1.4, -90.0),
        3 => regular(4, 1.4, 0.0),
        4 => regular(3, 1.4, 90.0),
        5 => cross(0.0),
        6 => star(5, 0.6, 1.5, -90.0),
        7 => regular(3, 1.4, 180.0),
        8 => cross(45.0),
        9 => regular(3, 1.4, 0.0),
        10 => regular(6, 1.25, 0.0),
        _ => star(4, 0.55, 1.5, 0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn looks_tell_series_apart() {
        let all: Vec<(usize, Option<[u32; 2]>)> =
            (0..48).map(|place| Look::new(0, place)).map(|look| (look.mark, look.dash)).collect();
        assert_eq!(all.iter().collect::<BTreeSet<_>>().len(), 48);
        assert_eq!(all[..MARKS].iter().map(|(mark, _)| mark).collect::<BTreeSet<_>>().len(), MARKS);
        let outlines: Vec<Vec<(f64, f64)>> = (0..MARKS).map(outline).collect();
        for (place, outline) in outlines.iter().enumerate() {
            assert!(!outlines[..place].contains(outline), "{place}");
            let largest = outline.iter().map(|(radius, _)| 5.0 * radius).fold(0.0, f64::max);
            assert!(largest <= f64::from(MARK_RADIUS) && largest >= 5.0, "{place}: {largest}");
        }
    }
}
