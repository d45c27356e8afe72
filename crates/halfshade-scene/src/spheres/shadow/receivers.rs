//! Points for which a sphere set is fitted, and what the mesh hides from each of them.
//!
//! *Around* the object they lie on planes that touch it or pass it closely, as the ground does on which it stands: one for
//! each of evenly spread directions, since nobody knows how the object will be turned. *On* the object they lie on its
//! surface, evenly by area. Rays are drawn by the cosine over the hemisphere, or, from where the object fills little of it,
//! evenly towards a sphere around the object.

use crate::spheres::normalized::NormalizedMesh;
use crate::spheres::points::drawn_by_area;
use glam::{DMat3, DVec3, Vec3};
use halfshade_rays::{MeshRays, Ray};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Rays per receiver.
const RAYS: usize = 96;
/// Planes beside the object.
const PLANES: usize = 48;
/// Receivers on each.
const PER_PLANE: usize = 40;
/// Distance from the object's middle up to which they lie, in largest extents of the object.
const REACH: f64 = 1.4;
/// Largest gap between a plane and the object, likewise; small ones are more frequent.
const LARGEST_GAP: f64 = 0.15;
/// Receivers on the surface.
const ON_SURFACE: usize = 1_200;
/// Weight of all receivers on the surface, those around it having 1: errors there are several times as large, and would
/// otherwise be lowered at the expense of shadows.
const SURFACE_WEIGHT: f64 = 0.1;
/// Cells of all directions: each is about as large as a light of 30 degrees.
const CELLS: usize = 60;
/// Least cosine by which a cell at the horizon counts: what light brings there is little, and its share nearly 0/0.
const LEAST_COSINE: f64 = 0.15;
/// Uncertainty of places of the surface after rounding to single precision, as a fraction of the extent.
const SLACK: f64 = 1e-6;
/// Turn between neighbours on a spiral, in turns.
const GOLDEN: f64 = 0.618_033_988_749_895;

/// A point with its rays.
#[derive(Debug, Clone)]
pub(super) struct Receiver {
    pub(super) position: DVec3,
    pub(super) normal: DVec3,
    /// Weight of its squared errors.
    pub(super) weight: f64,
    /// Whether it lies on the object, where only the error of all light counts: that of single lights is mostly noise of
    /// what spheres can't hold so near.
    pub(super) is_on_surface: bool,
    /// Unit directions of the rays.
    pub(super) direction: [Vec<f32>; 3],
    /// Share of each ray in the irradiance under constant light.
    pub(super) share: Vec<f32>,
    /// Cell of each ray among those of this receiver.
    pub(super) cell: Vec<u8>,
    /// Share of each cell in the irradiance, whether its rays come near the object or not.
    pub(super) cell_share: Vec<f64>,
    /// 1 where the mesh hides the light, else 0.
    pub(super) hidden: Vec<f32>,
}

/// Receivers around and on a mesh.
pub(super) fn receivers(mesh: &NormalizedMesh, seed: u64) -> Vec<Receiver> {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut places = around(mesh, &mut rng);
    places.extend(on_surface(mesh, &mut rng));
    let view = View::new(mesh);
    let turned: Vec<(Place, f64)> = places.into_iter().map(|place| (place, rng.random())).collect();
    turned.into_par_iter().map(|(place, turn)| view.receiver_at(&place, turn)).collect()
}

/// `count` evenly spread directions.
fn spiral(count: usize) -> impl Iterator<Item = DVec3> {
    (0..count).map(move |k| on_spiral(k, 0.0, 1.0 - (2.0 * k as f64 + 1.0) / count as f64))
}

/// The direction of this height over the plane z = 0 whose azimuth is the k-th of a spiral, turned.
fn on_spiral(k: usize, turn: f64, height: f64) -> DVec3 {
    let (sin, cos) = (TAU * (turn + k as f64 * GOLDEN)).sin_cos();
    let across = (1.0 - height * height).max(0.0).sqrt();
    DVec3::new(across * cos, across * sin, height)
}

/// Where a receiver is.
struct Place {
    position: DVec3,
    normal: DVec3,
    weight: f64,
    is_on_surface: bool,
}

fn around(mesh: &NormalizedMesh, rng: &mut Pcg64Mcg) -> Vec<Place> {
    let vertices = mesh.vertices();
    let mut places = Vec::with_capacity(PLANES * PER_PLANE);
    for normal in spiral(PLANES) {
        let lowest = vertices.iter().map(|vertex| vertex.dot(normal)).fold(f64::INFINITY, f64::min);
        let height = lowest - LARGEST_GAP * rng.random::<f64>().powi(2);
        let (right, up) = normal.any_orthonormal_pair();
        let turn: f64 = rng.random();
        for k in 0..PER_PLANE {
            // Denser near the middle, where errors are large; each stands for its part of the plane.
            let along = (k as f64 + 0.5) / PER_PLANE as f64;
            let aside = REACH * along * on_spiral(k, turn, 0.0);
            places.push(Place {
                position: height * normal + aside.x * right + aside.y * up,
                normal,
                weight: 2.0 * along / (PLANES * PER_PLANE) as f64,
                is_on_surface: false,
            });
        }
    }
    places
}

fn on_surface(mesh: &NormalizedMesh, rng: &mut Pcg64Mcg) -> impl Iterator<Item = Place> {
    drawn_by_area(&mesh.corners, ON_SURFACE, rng).into_iter().map(|(triangle, position)| {
        let [a, b, c] = mesh.corners[triangle];
        let normal = (b - a).cross(c - a).normalize_or(DVec3::Y);
        Place { position, normal, weight: SURFACE_WEIGHT / ON_SURFACE as f64, is_on_surface: true }
    })
}

/// The mesh as rays see it.
struct View {
    rays: MeshRays,
    /// Radius of a sphere around the mesh, about the origin.
    radius: f64,
    cells: Vec<DVec3>,
}

impl View {
    fn new(mesh: &NormalizedMesh) -> Self {
        let points: Vec<Vec3> = mesh.corners.iter().flatten().map(|corner| corner.as_vec3()).collect();
        let triangles: Vec<[u32; 3]> = (0..mesh.corners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let radius = mesh.corners.iter().flatten().map(|corner| corner.length()).fold(0.0, f64::max);
        Self { rays: MeshRays::new(&points, &triangles), radius, cells: spiral(CELLS).collect() }
    }

    /// The receiver at a place, on the surface of that side from which more is seen: the other is within the object, or
    /// both are alike, whichever way the triangles are wound.
    fn receiver_at(&self, place: &Place, turn: f64) -> Receiver {
        let front = self.facing(place, place.normal, turn);
        if !place.is_on_surface {
            return front;
        }
        let back = self.facing(place, -place.normal, turn);
        let hidden = |it: &Receiver| it.hidden.iter().sum::<f32>();
        if hidden(&back) < hidden(&front) { back } else { front }
    }

    fn facing(&self, place: &Place, normal: DVec3, turn: f64) -> Receiver {
        let mut receiver = Receiver {
            position: place.position,
            normal,
            weight: place.weight,
            is_on_surface: place.is_on_surface,
            direction: [const { Vec::new() }; 3],
            share: Vec::new(),
            cell: Vec::new(),
            cell_share: Vec::new(),
            hidden: Vec::new(),
        };
        let mut known = [None; CELLS];
        for (direction, share) in self.directions(place, normal, turn) {
            let ray = if place.is_on_surface {
                let lifted = place.position + 2.0 * SLACK * normal.abs().element_sum() * normal;
                Ray::new(lifted, direction).leaving(normal, DVec3::splat(SLACK))
            } else {
                Ray::new(place.position, direction)
            };
            let is_hidden = self.rays.any(&ray, |_| true);
            let nearness = |cell: &usize| self.cells[*cell].dot(direction);
            let cell = (0..CELLS).max_by(|a, b| nearness(a).total_cmp(&nearness(b))).unwrap_or(0);
            receiver.cell.push(*known[cell].get_or_insert_with(|| {
                let cosine = self.cells[cell].dot(normal).max(LEAST_COSINE);
                receiver.cell_share.push(4.0 / CELLS as f64 * cosine);
                (receiver.cell_share.len() - 1) as u8
            }));
            receiver.share.push(share as f32);
            receiver.hidden.push(f32::from(u8::from(is_hidden)));
            for (list, x) in receiver.direction.iter_mut().zip(direction.to_array()) {
                list.push(x as f32);
            }
        }
        receiver
    }

    /// Directions of rays above the horizon with their shares in the irradiance.
    fn directions(&self, place: &Place, normal: DVec3, turn: f64) -> impl Iterator<Item = (DVec3, f64)> {
        let distance = place.position.length();
        let sine = (self.radius / distance).min(1.0);
        // One minus the cosine of the angular radius of the sphere around the object.
        let versine = 1.0 - (1.0 - sine * sine).sqrt();
        let is_narrow = !place.is_on_surface && 2.0 * versine < 1.0;
        let axis = if is_narrow { -place.position / distance } else { normal };
        let (right, up) = axis.any_orthonormal_pair();
        let world_from_local = DMat3::from_cols(right, up, axis);
        (0..RAYS).filter_map(move |k| {
            let x = (k as f64 + 0.5) / RAYS as f64;
            let height = if is_narrow { 1.0 - versine * x } else { (1.0 - x).sqrt() };
            let direction = world_from_local * on_spiral(k, turn, height);
            let density = if is_narrow { direction.dot(normal) * TAU * versine / PI } else { 1.0 };
            (density > 0.0).then_some((direction, density / RAYS as f64))
        })
    }
}
