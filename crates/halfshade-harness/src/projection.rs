//! Projection of receivers to pixels: those that a camera sees, and their weights.

use crate::image_io::Picture;
use glam::Vec3;
use halfshade_scene::{Camera, Frame, RadianceBuffer, ReceiverBuffer};
use halfshade_truth::Tracer;

/// Camera rays per pixel and axis where receivers are vertices: edges are smoothed, at no cost in receivers.
const SUPERSAMPLE: u32 = 2;

/// A camera's picture in terms of receivers.
#[derive(Debug, Clone)]
pub struct Projection {
    width: usize,
    height: usize,
    /// Samples per pixel and axis.
    supersample: usize,
    /// Row by row over all samples: three receivers and their weights, or nothing where nothing is hit.
    samples: Vec<Option<([u32; 3], Vec3)>>,
}

impl Projection {
    /// Pictures of vertex receivers: interpolated over the triangle that the ray hits.
    pub fn of_vertices(tracer: &Tracer, frame: &Frame<'_>, camera: &Camera) -> Self {
        let fine = Camera { resolution: camera.resolution.map(|n| n * SUPERSAMPLE), ..*camera };
        let mut first_vertex = Vec::new();
        let mut count = 0;
        for object in &frame.scene.objects {
            first_vertex.push(count);
            count += object.mesh.positions.len() as u32;
        }
        let samples = tracer.primary_hits(&fine).into_iter().map(|hit| {
            hit.map(|hit| {
                let object = hit.object as usize;
                let vertices = frame.scene.objects[object].mesh.triangles[hit.triangle as usize];
                (vertices.map(|vertex| first_vertex[object] + vertex), hit.barycentrics.as_vec3())
            })
        });
        let [width, height] = camera.resolution.map(|n| n as usize);
        Self { width, height, supersample: SUPERSAMPLE as usize, samples: samples.collect() }
    }

    /// The receivers that a camera sees through the centres of its pixels, tile by tile, so that consecutive receivers are
    /// neighbours in the picture both ways; and how they make a picture.
    pub fn of_pixels(tracer: &Tracer, camera: &Camera) -> (ReceiverBuffer, Self) {
        let [width, height] = camera.resolution.map(|n| n as usize);
        let mut receivers = ReceiverBuffer::default();
        let hits = tracer.primary_hits(camera);
        let mut samples = vec![None; hits.len()];
        for [column, row] in tiled(width, height) {
            let pixel = row * width + column;
            let Some(hit) = &hits[pixel] else { continue };
            let direction = camera.ray_direction(column as f32 + 0.5, row as f32 + 0.5);
            receivers.add(&tracer.receiver_at(hit, direction));
            samples[pixel] = Some(([receivers.len() as u32 - 1; 3], Vec3::X));
        }
        (receivers, Self { width, height, supersample: 1, samples })
    }

    /// Pairs of receivers of pixels side by side, and one above the other; those of [`Self::of_pixels`].
    pub(crate) fn neighbours(&self) -> Vec<[u32; 2]> {
        let receiver = |column: usize, row: usize| {
            let sample = self.samples.get(row * self.width + column).filter(|_| column < self.width);
            sample.copied().flatten().map(|([receiver, ..], _)| receiver)
        };
        let pixels = (0..self.height).flat_map(|row| (0..self.width).map(move |column| (column, row)));
        let pairs = pixels.flat_map(|(column, row)| [(column, row, column + 1, row), (column, row, column, row + 1)]);
        pairs.filter_map(|(column, row, next, below)| Some([receiver(column, row)?, receiver(next, below)?])).collect()
    }

    /// Whether the camera sees no receiver at all.
    pub fn is_empty(&self) -> bool {
        self.samples.iter().all(Option::is_none)
    }

    /// The picture of `radiance`; `background` where nothing is hit.
    pub fn picture(&self, radiance: &RadianceBuffer, background: Vec3) -> Picture {
        let mut picture = Picture::filled(self.width, self.height, Vec3::ZERO);
        let fine_width = self.width * self.supersample;
        let share = 1.0 / (self.supersample * self.supersample) as f32;
        for (i, sample) in self.samples.iter().enumerate() {
            let color = sample.map_or(background, |(receivers, weights)| {
                let [a, b, c] = receivers.map(|receiver| radiance.at(receiver as usize));
                a * weights.x + b * weights.y + c * weights.z
            });
            let (column, row) = (i % fine_width / self.supersample, i / fine_width / self.supersample);
            picture.pixels[row * self.width + column] += share * color;
        }
        picture
    }
}

/// Side of a tile of pixels, a power of 2.
const TILE: usize = 8;

/// Columns and rows of all pixels: tiles row by row, the pixels of a tile in Morton order.
fn tiled(width: usize, height: usize) -> impl Iterator<Item = [usize; 2]> {
    // Every other bit of a place in the tile, from bit `first` on.
    let coordinate = |place: usize, first: usize| {
        (0..TILE.ilog2()).map(|bit| (place >> (2 * bit as usize + first) & 1) << bit).sum::<usize>()
    };
    let tiles =
        (0..height).step_by(TILE).flat_map(move |row| (0..width).step_by(TILE).map(move |column| [column, row]));
    tiles
        .flat_map(move |[column, row]| {
            (0..TILE * TILE).map(move |place| [column + coordinate(place, 0), row + coordinate(place, 1)])
        })
        .filter(move |&[column, row]| column < width && row < height)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_hold_every_pixel_once() {
        for (width, height) in [(1, 1), (8, 8), (19, 5), (24, 17)] {
            let mut pixels: Vec<_> = tiled(width, height).collect();
            // Eight in turn lie in four columns and two rows.
            if width % TILE == 0 {
                let near = |pixels: &[[usize; 2]]| {
                    pixels.iter().all(|[x, y]| x.abs_diff(pixels[0][0]) < 4 && y - pixels[0][1] < 2)
                };
                assert!(pixels.chunks(8).take(8).all(near));
            }
            pixels.sort_by_key(|&[column, row]| (row, column));
            let rows: Vec<_> = (0..height).flat_map(|row| (0..width).map(move |column| [column, row])).collect();
            assert_eq!(pixels, rows);
        }
    }

    #[test]
    fn neighbours_lie_side_by_side_or_above_each_other() {
        let sample = |receiver: u32| Some(([receiver; 3], Vec3::X));
        // Three columns and two rows; nothing is hit in the middle of the upper.
        let samples = vec![sample(0), None, sample(1), sample(2), sample(3), sample(4)];
        let projection = Projection { width: 3, height: 2, supersample: 1, samples };
        assert_eq!(projection.neighbours(), [[0, 2], [1, 4], [2, 3], [3, 4]]);
    }

    #[test]
    fn samples_are_weighted_and_averaged_within_their_pixel() {
        let mut radiance = RadianceBuffer::zeros(3);
        for (i, value) in [1.0, 2.0, 4.0].into_iter().enumerate() {
            radiance.view_mut().set(i, Vec3::splat(value));
        }
        let hit = Some(([0, 1, 2], Vec3::new(0.5, 0.25, 0.25)));
        // Two pixels side by side, four samples each: the left is all hit, the right half.
        let samples = vec![hit, hit, hit, None, hit, hit, None, hit];
        let projection = Projection { width: 2, height: 1, supersample: 2, samples };
        let picture = projection.picture(&radiance, Vec3::splat(10.0));
        assert_eq!(picture.pixels, [Vec3::splat(2.0), Vec3::splat(6.0)]);
    }
}
