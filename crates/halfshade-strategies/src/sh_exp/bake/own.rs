//! Own occlusion: what its own mesh hides from every vertex, once per scene.
//!
//! An object's spheres stick out of its surface and leave parts of it bare, so that on the surface itself they hide what is
//! open and leave open what is hidden. Rays against the mesh know better. Along K directions d_k of the hemisphere about a
//! vertex's normal, drawn with the density cos/π, rays find b_k, 1 where the mesh blocks and else 0. Blocked light is the
//! vector B that comes nearest to them in the least squares with the weight of a diffuse receiver, and to 0 below the
//! horizon:
//!
//! ```text
//! min over B of  1/K Σ_k (B(d_k) - b_k)² + ε/2π ∫ below the horizon B² dω        ε = BELOW
//! ```
//!
//! Projection, which a vector of all directions would call for, takes no notice of the cosine: at 4 bands it blurs what
//! lies below the horizon into what a receiver sees. With these weights the irradiance of an object alone is right for light
//! of as many bands, up to ε and the number of directions. The matrix of the normal equations is the same for all vertices
//! in their own frames; what it gives is turned into the object's space.
//!
//! Visibility past the object and that past all others are multiplied (`shade/batches.rs`).

use crate::shared::{
    by_mesh::{ByMesh, distinct},
    cosine_spiral::cosine_spiral,
    triangle_rays::{Start, TriangleRays},
};
use glam::{DMat3, DVec3, Vec3};
use halfshade_scene::{Mesh, Object, Scene, light::OctahedralGrid};
use halfshade_sh::{basis, quadrature::SphereQuadrature, rotation::ShRotation};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::{f64::consts::TAU, sync::Arc};

/// Weight of directions below the horizon: small enough not to be felt above it, large enough that what is found there
/// stays in the range of visibility, which products with others need.
const BELOW: f64 = 0.1;

/// Own occlusion of all meshes of a scene.
#[derive(Debug)]
pub(crate) struct OwnTables {
    /// Per object; `None` if it deforms.
    objects: Vec<Option<Arc<OwnVectors>>>,
    /// Directions in which small lights are looked for.
    pub(crate) grid: OctahedralGrid,
}

/// Own occlusion of one mesh.
#[derive(Debug)]
pub(crate) struct OwnVectors {
    pub(crate) mesh: Arc<Mesh>,
    /// Per vertex what is blocked, as an SH vector in object space; empty if nothing is.
    pub(crate) values: Vec<f32>,
    /// Per vertex a bit per node of the grid over directions in object space, 1 where the mesh hides it; empty where no lamp asks,
    /// or nothing is hidden.
    pub(crate) hidden: Vec<u32>,
}

impl OwnTables {
    /// For all objects of a scene that keep their shape, with so many rays from each vertex; and with a ray per node of the grid
    /// if there are small lights, `for_lamps`.
    pub(crate) fn new(scene: &Scene, bands: usize, directions: usize, for_lamps: bool) -> Self {
        // Four nodes for each direction over the hemisphere: with 256 of those seven degrees from node to node.
        let grid = OctahedralGrid::new((directions as f64).sqrt().round() as usize);
        let nodes: Vec<Vec3> = (0..if for_lamps { grid.node_count() } else { 0 }).map(|n| grid.direction(n)).collect();
        let fit = HemisphereFit::new(bands, directions);
        let mut meshes = ByMesh::new();
        let of = |object: &Object| meshes.of_rigid(object, |mesh| OwnVectors::new(mesh, &fit, &nodes));
        let objects = scene.objects.iter().map(of).collect();
        Self { objects, grid }
    }

    /// Own occlusion of an object; `None` if its spheres stand for it.
    pub(crate) fn of(&self, object: usize) -> Option<&OwnVectors> {
        self.objects.get(object)?.as_deref()
    }

    /// The objects that deform.
    pub(crate) fn left_to_spheres(&self) -> impl Iterator<Item = usize> {
        self.objects.iter().enumerate().filter(|(_, own)| own.is_none()).map(|(object, _)| object)
    }

    pub(crate) fn bytes(&self) -> usize {
        let bytes = |own: &Arc<OwnVectors>| size_of_val(own.values.as_slice()) + size_of_val(own.hidden.as_slice());
        distinct(self.objects.iter().flatten()).map(bytes).sum()
    }
}

impl OwnVectors {
    fn new(mesh: &Arc<Mesh>, fit: &HemisphereFit, nodes: &[Vec3]) -> Self {
        let rays = TriangleRays::new(mesh);
        let blocked = |position: Vec3, normal: Vec3, direction: Vec3| {
            rays.blocked(&Start::on_surface(position, normal), direction, f32::INFINITY)
        };
        let vertices = || mesh.positions.par_iter().zip(&mesh.normals);
        let vector = |(&position, &normal): (&Vec3, &Vec3)| {
            fit.blocked(normal.as_dvec3(), |direction| blocked(position, normal, direction.as_vec3()))
        };
        // Below the horizon nothing is asked: what a lamp next to it finds between nodes isn't darker for that.
        let bits = |(&position, &normal): (&Vec3, &Vec3)| {
            let hides = move |node: &Vec3| node.dot(normal) > 0.0 && blocked(position, normal, *node);
            nodes.chunks(32).map(move |nodes| {
                nodes.iter().enumerate().fold(0, |word, (bit, node)| word | u32::from(hides(node)) << bit)
            })
        };
        let mut values: Vec<f32> = vertices().flat_map_iter(vector).collect();
        let mut hidden: Vec<u32> = vertices().flat_map_iter(bits).collect();
        if values.iter().all(|value| *value == 0.0) {
            values = Vec::new();
        }
        if hidden.iter().all(|word| *word == 0) {
            hidden = Vec::new();
        }
        Self { mesh: mesh.clone(), values, hidden }
    }
}

/// Directions about +Z, and what makes a vector of what is found along them.
#[derive(Debug)]
struct HemisphereFit {
    bands: usize,
    directions: Vec<DVec3>,
    /// A column per direction.
    solution: DMatrix<f64>,
}

impl HemisphereFit {
    fn new(bands: usize, count: usize) -> Self {
        let directions: Vec<DVec3> = cosine_spiral(count).collect();
        let coefficients = bands * bands;
        let column = |direction: [f64; 3]| DVector::from_vec(basis::evaluate(bands, direction));
        let columns: Vec<_> = directions.iter().map(|direction| column(direction.to_array())).collect();
        let right = DMatrix::from_columns(&columns) / count as f64;
        let mut normal = DMatrix::zeros(coefficients, coefficients);
        columns.iter().for_each(|y| normal.ger(1.0 / count as f64, y, y, 1.0));
        // Products of two functions of one parity have the same integral over both halves; the rest needs a fine rule.
        for (direction, weight) in SphereQuadrature::exact_to(8 * bands + 32).points().filter(|(d, _)| d[2] < 0.0) {
            let y = column(direction);
            normal.ger(BELOW * weight / TAU, &y, &y, 1.0);
        }
        let solution = normal.cholesky().map_or_else(|| right.clone(), |cholesky| cholesky.solve(&right));
        Self { bands, directions, solution }
    }

    /// B of a vertex, given which directions are `blocked` there.
    fn blocked(&self, normal: DVec3, blocked: impl Fn(DVec3) -> bool) -> Vec<f32> {
        let axis = normal.normalize_or(DVec3::Z);
        let (tangent, bitangent) = axis.any_orthonormal_pair();
        let frame = DMat3::from_cols(tangent, bitangent, axis);
        let mut sum = vec![0.0; self.bands * self.bands];
        let mut any = false;
        for (direction, column) in self.directions.iter().zip(self.solution.column_iter()) {
            if blocked(frame * *direction) {
                sum.iter_mut().zip(&column).for_each(|(sum, value)| *sum += value);
                any = true;
            }
        }
        if any {
            sum = ShRotation::new(self.bands, &frame.transpose().to_cols_array_2d()).apply(&sum);
        }
        sum.into_iter().map(|value| value as f32).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shared::test_scenes::with_spheres;
    use halfshade_scene::{Environment, builtin::shapes};
    use halfshade_sh::zonal;
    use std::f64::consts::PI;

    /// Share of a constant sky's irradiance that B takes.
    fn taken(bands: usize, blocked: &[f32], normal: DVec3) -> f64 {
        let cosine = zonal::rotate_to_axis(&zonal::clamped_cosine(bands), normal.to_array());
        cosine.iter().zip(blocked).map(|(c, b)| c / PI * f64::from(*b)).sum()
    }

    /// A wall at a right angle hides half of the sky, a cap its closed form; whatever the number of bands.
    #[test]
    fn a_sky_loses_what_is_hidden() {
        for bands in 2..=6 {
            let fit = HemisphereFit::new(bands, 1024);
            for normal in [DVec3::Z, DVec3::new(0.6, -0.48, 0.64), DVec3::NEG_Y] {
                let side = normal.any_orthonormal_vector();
                let wall = fit.blocked(normal, |direction| direction.dot(side) > 0.0);
                assert!((taken(bands, &wall, normal) - 0.5).abs() < 0.02, "{bands}: {}", taken(bands, &wall, normal));
                let (radius, axis) = (0.5f64, (0.8 * normal + 0.6 * side).normalize());
                let cap = fit.blocked(normal, |direction| direction.dot(axis) > radius.cos());
                let expected = radius.sin().powi(2) * axis.dot(normal);
                assert!((taken(bands, &cap, normal) - expected).abs() < 0.02, "{bands}: {expected}");
                let all = fit.blocked(normal, |_| true);
                assert!((taken(bands, &all, normal) - 1.0).abs() < 0.03, "{bands}: {}", taken(bands, &all, normal));
            }
        }
    }

    #[test]
    fn convex_meshes_hide_nothing_and_a_torus_its_inside() {
        let sphere = halfshade_scene::Sphere { center: Vec3::ZERO, radius: 1.0 };
        let mut scene = with_spheres(Environment::constant(Vec3::ONE), &[sphere]);
        let mut tables = |mesh: Mesh| {
            scene.objects[0].mesh = Arc::new(mesh);
            OwnTables::new(&scene, 4, 256, true)
        };
        for mesh in [shapes::sphere(8), shapes::plane(4)] {
            let tables = tables(mesh);
            let own = tables.of(0).unwrap();
            assert!(own.values.is_empty() && own.hidden.is_empty() && tables.bytes() == 0);
        }
        let tables = tables(shapes::torus(1.0, 0.3, 48, 24));
        let own = tables.of(0).unwrap();
        let words = tables.grid.node_count().div_ceil(32);
        for (vertex, (position, normal)) in own.mesh.positions.iter().zip(&own.mesh.normals).enumerate() {
            let blocked = taken(4, &own.values[16 * vertex..16 * (vertex + 1)], normal.as_dvec3());
            let bits = own.hidden[vertex * words..(vertex + 1) * words].iter().map(|word| word.count_ones());
            let across = position.with_y(0.0).normalize();
            if across.dot(*normal) > 0.9 {
                assert!(blocked.abs() < 0.01 && bits.sum::<u32>() == 0, "{position} {blocked}");
            } else if across.dot(*normal) < -0.9 {
                assert!(blocked > 0.1 && bits.sum::<u32>() > 50, "{position} {blocked}");
            }
        }
    }
}
