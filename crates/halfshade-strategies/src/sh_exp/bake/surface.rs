//! The surface of an object as its spheres know it [Guerrero2007, 4.3.1]: sample points, and colours.
//!
//! Every point of the surface belongs to the sphere of least radius-scaled distance `|p - x|/r` (eq. 4.10). A ray from a
//! sphere's centre sees of the surface's inside
//! 1. the farthest crossing that belongs to the sphere, or
//! 2. nothing, if all crossings belong to others: black, since another sphere covers this direction, or
//! 3. if there are no crossings because the centre lies outside, what the opposite ray meets from the front.
//!
//! The first pass multiplies the light M at the sample points with the colours c, `r = M * c` (eq. 4.20), where
//! `M = Σ_j M_j Y_j` sums over Voronoi cells (eq. 4.19). That is linear in the M_j, so the products are made here, once:
//!
//! ```text
//! r = Σ_j M_j W_j        W_j = Y_j * c
//! ```
//!
//! Two choices go beyond the thesis. [`Projection::Direct`] projects the product of cell and colour as it is,
//! `W_j = ∫_cell c y dω`, instead of multiplying two band-limited functions, and gives the cells of directions without a
//! sample to their neighbours, so that a colour's edge isn't darkened twice. [`Covered::Kept`] leaves out case 2: the first
//! crossing counts whoever it belongs to, and who covers whom is left to the second pass.

use super::{
    crossings::{Crossing, Crossings},
    geodesic::Geodesic,
};
use crate::sh_exp::settings::Projection;
use glam::{DVec3, Vec3};
use halfshade_scene::{Object, Sphere};
use halfshade_sh::product::product;
use rayon::prelude::*;

/// The colour of a sphere where another covers it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Covered {
    /// Nothing [Guerrero2007, 4.3.1].
    Black,
    /// The surface in that direction.
    Kept,
}

/// One sphere's part of a surface, in the object's space.
#[derive(Debug, Clone, Default)]
pub(crate) struct SphereSurface {
    /// Sample points: triangles, and weights of their vertices, so that points follow a mesh that deforms.
    pub(crate) samples: Vec<(u32, Vec3)>,
    /// W_j: per sample and channel an SH vector.
    pub(crate) weights: Vec<f32>,
}

/// The point that a ray from a sphere's centre sees.
struct Seen {
    point: DVec3,
    crossing: Crossing,
}

/// The surface of `object` as each of `spheres` knows it, with `channels` channels of albedo, 1 (of a grey one) or 3.
pub(crate) fn surfaces(
    object: &Object,
    spheres: &[Sphere],
    bands: usize,
    channels: usize,
    geodesic: &Geodesic,
    (projection, covered): (Projection, Covered),
) -> Vec<SphereSurface> {
    let crossings = Crossings::new(&object.mesh);
    let view = View { object, spheres, crossings, covered };
    (0..spheres.len())
        .into_par_iter()
        .map(|number| {
            let seen = |direction| view.seen_from(number, direction);
            let mut surface = SphereSurface::default();
            let mut valid = Vec::new();
            for (sample, &direction) in geodesic.samples.iter().enumerate() {
                if let Some(Seen { crossing, .. }) = seen(direction).filter(|seen| view.has_normal(&seen.crossing)) {
                    valid.push(sample);
                    surface.samples.push((crossing.triangle as u32, crossing.weights.as_vec3()));
                }
            }
            let all: Vec<usize> = (0..geodesic.samples.len()).collect();
            let among = if projection == Projection::Product { &all } else { &valid };
            let Some(cells) = geodesic.cells(among).filter(|_| !valid.is_empty()) else { return surface };
            let colours = CellColours::new(object, bands, geodesic, &cells, seen);
            surface.weights = valid.iter().flat_map(|&sample| colours.weights(sample, channels, projection)).collect();
            // A black surface needs no light.
            if surface.weights.iter().all(|&weight| weight == 0.0) { SphereSurface::default() } else { surface }
        })
        .collect()
}

/// The view from the spheres' centres onto the surface.
struct View<'a> {
    object: &'a Object,
    spheres: &'a [Sphere],
    crossings: Crossings,
    covered: Covered,
}

impl View<'_> {
    /// The sphere to which a point of the surface belongs.
    fn owner(&self, point: DVec3) -> Option<usize> {
        let distance =
            |sphere: &Sphere| point.distance_squared(sphere.center.as_dvec3()) / f64::from(sphere.radius).powi(2);
        let spheres = self.spheres;
        (0..spheres.len()).min_by(|&a, &b| distance(&spheres[a]).total_cmp(&distance(&spheres[b])))
    }

    /// The point of the surface that sphere `number` sees along a direction.
    fn seen_from(&self, number: usize, direction: DVec3) -> Option<Seen> {
        let center = self.spheres[number].center.as_dvec3();
        let (mut inside, mut best) = (false, None::<Seen>);
        let nearer =
            |best: &Option<Seen>, distance| best.as_ref().is_none_or(|b: &Seen| distance < b.crossing.distance);
        self.crossings.along(center, direction, |crossing| {
            if !crossing.leaves {
                return;
            }
            inside = true;
            let point = center + crossing.distance * direction;
            let better = match self.covered {
                Covered::Black => {
                    best.as_ref().is_none_or(|b| crossing.distance > b.crossing.distance)
                        && self.owner(point) == Some(number)
                }
                Covered::Kept => nearer(&best, crossing.distance),
            };
            if better {
                best = Some(Seen { point, crossing });
            }
        });
        if !inside {
            self.crossings.along(center, -direction, |crossing| {
                if !crossing.leaves && nearer(&best, crossing.distance) {
                    best = Some(Seen { point: center - crossing.distance * direction, crossing });
                }
            });
            best = best.filter(|seen| self.covered == Covered::Kept || self.owner(seen.point) == Some(number));
        }
        best
    }

    fn has_normal(&self, crossing: &Crossing) -> bool {
        let mesh = &self.object.mesh;
        mesh.interpolated(&mesh.normals, crossing.triangle, crossing.weights).try_normalize().is_some()
    }
}

/// The colours around one sphere, projected.
struct CellColours {
    count: usize,
    /// Per sample direction and channel: of the cell's colours.
    colored: Vec<f64>,
    /// Per sample direction: of the cell itself.
    plain: Vec<f64>,
    /// Per channel: of all colours.
    environment: Vec<f64>,
}

impl CellColours {
    /// Colours that are `seen` along the many directions of each cell.
    fn new(
        object: &Object,
        bands: usize,
        geodesic: &Geodesic,
        cells: &[usize],
        seen: impl Fn(DVec3) -> Option<Seen>,
    ) -> Self {
        let count = bands * bands;
        let mut colored = vec![0.0; geodesic.samples.len() * 3 * count];
        let mut plain = vec![0.0; geodesic.samples.len() * count];
        let mut environment = vec![0.0; 3 * count];
        for (dense, &cell) in geodesic.dense.iter().zip(cells) {
            add(&mut plain[cell * count..][..count], 1.0, &dense.weighted_basis);
            let Some(seen) = seen(dense.direction) else { continue };
            let albedo = object.albedo_at(seen.crossing.triangle, seen.crossing.weights).as_dvec3();
            for channel in 0..3 {
                let row = (cell * 3 + channel) * count;
                add(&mut colored[row..][..count], albedo[channel], &dense.weighted_basis);
                add(&mut environment[channel * count..][..count], albedo[channel], &dense.weighted_basis);
            }
        }
        Self { count, colored, plain, environment }
    }

    /// W_j of a sample, channel by channel.
    fn weights(&self, sample: usize, channels: usize, projection: Projection) -> impl Iterator<Item = f32> {
        let Self { count, colored, plain, environment } = self;
        (0..channels).flat_map(move |channel| {
            let vector = match projection {
                Projection::Direct => colored[(sample * 3 + channel) * count..][..*count].to_vec(),
                Projection::Product => {
                    product(&plain[sample * count..][..*count], &environment[channel * count..][..*count])
                }
            };
            vector.into_iter().map(|value| value as f32)
        })
    }
}

fn add(sum: &mut [f64], factor: f64, vector: &[f64]) {
    sum.iter_mut().zip(vector).for_each(|(sum, value)| *sum += factor * value);
}
