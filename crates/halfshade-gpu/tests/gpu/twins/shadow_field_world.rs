//! Objects with fields, lights and receivers made of random numbers, for functions of `shadow_field`; and what a field holds,
//! in double precision.

use super::{CALLS, direction, numbers};
use glam::{DMat3, DQuat, DVec3, Quat, Vec3};
use halfshade_gpu::probe::{FieldBuffers, Variable};
use halfshade_scene::{
    Environment, LafortuneLobe, Material, Mesh, Object, Pose, Reflectance, Scene, SurfacePoint, builtin::shapes,
};
use halfshade_sh::{rotation::ShRotation, zonal};
use halfshade_strategies::shadow_field::arrays::{
    Containment, FieldArrays, FrameArrays, LocalLight, MeshArrays, ObjectPlacement, SceneArrays, ShellArrays, Storage,
    StoredValues,
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Shells of all fields: radii in radii of the object, and sample points along longitude.
pub(super) const RADII: [f32; SHELLS] = [0.0, 0.125, 0.5, 0.5625, 1.0, 2.0, 6.0];
pub(super) const RESOLUTIONS: [usize; SHELLS] = [1, 2, 4, 16, 8, 8, 4];
pub(super) const SHELLS: usize = 7;
const STEP: f32 = 0.0625;

/// Objects of a world; the last hides nothing.
pub(super) const OBJECTS: usize = 6;

enum Stored {
    U8(Vec<u8>),
    F16(Vec<u16>),
    F32(Vec<f32>),
}

struct Shell {
    resolution: usize,
    stored: Stored,
    least: Vec<f32>,
    step: Vec<f32>,
    /// Samples one after another, as they are decoded.
    values: Vec<Vec<f64>>,
}

/// A field of random numbers.
pub(super) struct Field {
    shells: Vec<Shell>,
    outer: Vec<u8>,
}

/// Half precision.
fn half(bits: u16) -> f64 {
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f64::from(bits & 1023) / 1024.0);
    let size = if exponent == 0 { fraction * 2f64.powi(-14) } else { (1.0 + fraction) * 2f64.powi(exponent - 15) };
    if bits >> 15 == 1 { -size } else { size }
}

impl Shell {
    fn new(resolution: usize, count: usize, storage: Storage, random: &mut Pcg64Mcg) -> Self {
        let stride = count.next_multiple_of(8);
        let mut numbers = |range: std::ops::Range<f32>| -> Vec<f32> {
            (0..stride).map(|_| random.random_range(range.clone())).collect()
        };
        let (least, step) = (numbers(-1.0..1.0), numbers(0.0..0.01));
        let all = 0..resolution * resolution * stride;
        let (stored, decoded): (Stored, Vec<f64>) = match storage {
            Storage::U8 => {
                let bytes: Vec<u8> = all.map(|_| random.random_range(0..=255)).collect();
                let scales = least.iter().zip(&step).cycle();
                let decoded = bytes.iter().zip(scales);
                let decode = |(byte, (least, step)): (&u8, (&f32, &f32))| {
                    f64::from(*least) + f64::from(*step) * f64::from(*byte)
                };
                let decoded = decoded.map(decode).collect();
                (Stored::U8(bytes), decoded)
            }
            Storage::F16 => {
                // Either sign, smaller than 2, down to zero and denormal ones.
                let halves: Vec<u16> =
                    all.map(|_| random.random_range(0..1 << 14) | random.random_range(0..2) << 15).collect();
                let decoded = halves.iter().map(|&bits| half(bits)).collect();
                (Stored::F16(halves), decoded)
            }
            Storage::F32 => {
                let floats: Vec<f32> = all.map(|_| random.random_range(-1.0..1.0)).collect();
                let decoded = floats.iter().map(|&value| f64::from(value)).collect();
                (Stored::F32(floats), decoded)
            }
        };
        let values = decoded.chunks(stride).map(|sample| sample[..count].to_vec()).collect();
        Self { resolution, stored, least, step, values }
    }

    fn arrays(&self) -> ShellArrays<'_> {
        let values = match &self.stored {
            Stored::U8(values) => StoredValues::U8(values),
            Stored::F16(values) => StoredValues::F16(values),
            Stored::F32(values) => StoredValues::F32(values),
        };
        ShellArrays { resolution: self.resolution, values, least: &self.least, step: &self.step }
    }
}

/// The shares that shells have at a distance: between the two around it, or the last one's shrunk by the distance squared.
pub(super) fn shares(distance: f64) -> [f64; SHELLS] {
    let radii = RADII.map(f64::from);
    let mut shares = [0.0; SHELLS];
    match radii.iter().position(|radius| *radius > distance) {
        None => shares[SHELLS - 1] = (radii[SHELLS - 1] / distance).powi(2),
        Some(outer) => {
            let share = (distance - radii[outer - 1]) / (radii[outer] - radii[outer - 1]);
            (shares[outer - 1], shares[outer]) = (1.0 - share, share);
        }
    }
    shares
}

/// Points of a grid around a place, and their weights: over a pole lies the opposite longitude.
pub(super) fn corners(resolution: usize, u: f64, v: f64) -> [(usize, f64); 4] {
    let side = resolution as f64;
    let (x, y) = (u * side - 0.5, v * side - 0.5);
    let (column, line) = (x.floor(), y.floor());
    [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(right, down)| {
        let weight = |next: f64, part: f64| if next == 1.0 { part } else { 1.0 - part };
        let weight = weight(right, x - column) * weight(down, y - line);
        let (column, line) = (column + right, line + down);
        let opposite = if line < 0.0 || line >= side { (resolution / 2) as f64 } else { 0.0 };
        let place = line.clamp(0.0, side - 1.0) * side + (column + opposite).rem_euclid(side);
        (place as usize, weight)
    })
}

impl Field {
    fn new(bands: usize, storage: Storage, random: &mut Pcg64Mcg) -> Self {
        let shells = RESOLUTIONS.map(|resolution| Shell::new(resolution, bands * bands, storage, random));
        let steps = (RADII[SHELLS - 1] / STEP) as usize;
        let next = |step: usize| RADII.iter().filter(|radius| **radius <= step as f32 * STEP).count() as u8;
        Self { shells: shells.into(), outer: (0..steps).map(next).collect() }
    }

    /// Coefficients at a place: distance, longitude, latitude.
    pub(super) fn at(&self, place: [f64; 3]) -> Vec<f64> {
        let mut sum = vec![0.0; self.shells[0].values[0].len()];
        for (shell, share) in self.shells.iter().zip(shares(place[0])) {
            for (point, weight) in corners(shell.resolution, place[1], place[2]) {
                sum.iter_mut().zip(&shell.values[point]).for_each(|(sum, value)| *sum += share * weight * value);
            }
        }
        sum
    }

    fn arrays(&self) -> FieldArrays<'_> {
        let shells = self.shells.iter().map(Shell::arrays).collect();
        FieldArrays { radii: &RADII, outer: &self.outer, step: STEP, shells }
    }
}

/// A frame of shadow fields.
pub(super) struct World {
    pub(super) bands: usize,
    pub(super) scene: Scene,
    /// Field by field of the objects that have one.
    pub(super) fields: Vec<Field>,
    pub(super) objects: Vec<ObjectPlacement>,
    /// Light space from object space.
    pub(super) turns: Vec<DMat3>,
    pub(super) lights: Vec<LocalLight>,
    /// Distant light, coefficient by coefficient.
    pub(super) distant: Vec<[f32; 3]>,
    /// Own occlusion of the vertices of each object.
    pub(super) own: Vec<Vec<Vec<f64>>>,
    /// Where receivers lie, by object.
    pub(super) receivers: Vec<(usize, SurfacePoint)>,
    orders: Vec<Vec<usize>>,
}

/// A coordinate whose square single precision holds.
pub(super) fn coordinate(random: &mut Pcg64Mcg) -> f32 {
    random.random_range(-64..=64) as f32 / 16.0
}

pub(super) fn point(random: &mut Pcg64Mcg) -> Vec3 {
    Vec3::new(coordinate(random), coordinate(random), coordinate(random))
}

fn reflectance(number: usize, random: &mut Pcg64Mcg) -> Reflectance {
    let specular = Vec3::new(0.3, 0.2, 0.1);
    let exponent = [1.0, 10.0, 100.0, 1e3, 1e4][number % 5];
    match number {
        0 => Reflectance::Lambert,
        1 | 2 => Reflectance::Phong { specular, exponent },
        3 => Reflectance::ModifiedPhong { specular, exponent },
        _ => {
            let mut axis = || Vec3::new(random.random_range(-1.0..-0.8), random.random_range(-1.0..0.8), 1.0);
            let mut lobe = |exponent| LafortuneLobe { scale: specular, axis: axis(), exponent };
            Reflectance::Lafortune { lobes: vec![lobe(exponent), lobe(0.5), lobe(7.0)] }
        }
    }
}

impl World {
    pub(super) fn new(bands: usize, storage: Storage, seed: u64) -> Self {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let random = &mut random;
        let mesh = shapes::plane(2);
        let vertices = mesh.positions.len();
        let count = bands * bands;
        let receivers = (0..CALLS).map(|i| (i % OBJECTS, receiver(i, &mesh, random))).collect();
        let turns: Vec<DMat3> = (0..OBJECTS).map(|number| turn(number, random)).collect();
        let channels = [(); 3].map(|()| numbers(count, 1.0, random));
        Self {
            bands,
            fields: (1..OBJECTS).map(|_| Field::new(bands, storage, random)).collect(),
            objects: turns.iter().map(|turn| placement(turn, random)).collect(),
            lights: (0..4).map(|number| light(number, random)).collect(),
            distant: (0..count).map(|i| channels.each_ref().map(|channel| channel[i] as f32)).collect(),
            own: (0..OBJECTS).map(|_| (0..vertices).map(|_| numbers(count, 1.0, random)).collect()).collect(),
            orders: (0..OBJECTS).map(|own| (0..OBJECTS).filter(|other| *other != own).rev().collect()).collect(),
            scene: scene(&mesh, random),
            turns,
            receivers,
        }
    }

    /// The same as the device gets it.
    pub(super) fn buffers(&self) -> FieldBuffers {
        let flat =
            |vectors: &Vec<Vec<f64>>| -> Vec<f32> { vectors.iter().flatten().map(|&value| value as f32).collect() };
        let own: Vec<Vec<f32>> = self.own.iter().map(flat).collect();
        let field = |object: usize| self.fields.get(object).map(Field::arrays);
        let cosine: Vec<f32> = zonal::reflectance(self.bands).iter().map(|&value| value as f32).collect();
        let fields = SceneArrays {
            bands: self.bands,
            cosine: &cosine,
            meshes: own.iter().enumerate().map(|(object, own)| MeshArrays { field: field(object), own }).collect(),
            mesh_of: (0..OBJECTS).collect(),
        };
        let rotations: Vec<Vec<f32>> = (self.turns.iter())
            .map(|turn| {
                let rotation = self.sh_rotation(turn);
                let block =
                    |l: usize| rotation.block(l).transpose().iter().map(|&value| value as f32).collect::<Vec<_>>();
                (0..self.bands).flat_map(block).collect()
            })
            .collect();
        let frame = FrameArrays {
            objects: &self.objects,
            lights: &self.lights,
            nearest_first: &self.orders,
            rotations: &rotations,
            light: &self.distant,
            light_from_world: DQuat::IDENTITY,
            origin: DVec3::ZERO,
        };
        let mesh = &self.scene.objects[0].mesh;
        let receivers = self.receivers.iter().map(|(object, place)| (*object, place.weights_in_front(mesh)));
        FieldBuffers::new(&self.scene, &fields, &frame, receivers)
    }

    /// Rotation of SH vectors by one of the turns.
    pub(super) fn sh_rotation(&self, turn: &DMat3) -> ShRotation {
        ShRotation::new(self.bands, &turn.transpose().to_cols_array_2d())
    }
}

/// Objects of all models of reflectance, turned.
fn scene(mesh: &Mesh, random: &mut Pcg64Mcg) -> Scene {
    let objects = (0..OBJECTS).map(|number| {
        let material = Material { reflectance: reflectance(number, random), ..Material::default() };
        let rotation = Quat::from_axis_angle(direction(random).as_vec3().normalize(), number as f32);
        let pose = Pose { scale: 0.5, rotation, translation: point(random) };
        Object::new("object", mesh.clone()).material(material).pose(pose)
    });
    let mut scene = Scene::at_rest("world", objects.collect(), Environment::constant(Vec3::ONE));
    scene.camera.eye = Vec3::new(3.0, 5.0, -4.0);
    scene
}

fn placement(turn: &DMat3, random: &mut Pcg64Mcg) -> ObjectPlacement {
    let radius: f32 = random.random_range(0.1..2.0);
    ObjectPlacement {
        center: point(random).to_array(),
        // Columns of a rotation are rows of its inverse.
        object_from_light: turn.as_mat3().to_cols_array_2d(),
        inverse_scale: 1.0,
        radius,
        inverse_radius: radius.recip(),
    }
}

/// The first is a point.
fn light(number: u8, random: &mut Pcg64Mcg) -> LocalLight {
    let kinds = [Containment::Outside, Containment::Center, Containment::Whole];
    LocalLight {
        center: point(random).to_array(),
        radius: number.into(),
        radiance: [1.0, 2.0, 3.0],
        holds: (0..OBJECTS).map(|_| kinds[random.random_range(0..3)]).collect(),
    }
}

/// Nowhere, at a vertex, within a triangle, behind it, or on its edge.
fn receiver(number: usize, mesh: &Mesh, random: &mut Pcg64Mcg) -> SurfacePoint {
    let (first, second) = (random.random_range(0.0..0.5), random.random_range(0.0..0.5));
    let barycentric = [first, second, 1.0 - first - second];
    let triangle = random.random_range(0..mesh.triangles.len()) as u32;
    match number % 8 {
        0 => SurfacePoint::Elsewhere,
        1 => SurfacePoint::Vertex(random.random_range(0..mesh.positions.len()) as u32),
        2 => SurfacePoint::Triangle { triangle, barycentric, from_behind: true },
        3 => SurfacePoint::Triangle { triangle, barycentric: [first, 1.0 - first, 0.0], from_behind: false },
        _ => SurfacePoint::Triangle { triangle, barycentric, from_behind: false },
    }
}

/// None, by half a turn, or any.
fn turn(number: usize, random: &mut Pcg64Mcg) -> DMat3 {
    let angle = [0.0, std::f64::consts::PI].get(number).copied();
    let axis = if number < 2 { DVec3::X } else { direction(random).normalize() };
    DMat3::from_quat(DQuat::from_axis_angle(axis, angle.unwrap_or_else(|| random.random_range(0.0..6.0))))
}

/// Buffers that functions of `shadow_field` read.
pub(super) fn variables(buffers: &FieldBuffers) -> [Variable<'_>; 4] {
    [
        Variable::uniform(0, "frame", &buffers.uniforms),
        Variable::storage(1, "rows", &buffers.rows),
        Variable::storage(2, "samples", &buffers.samples),
        Variable::storage(3, "tables", buffers.tables()),
    ]
}
