//! Receivers as `common/receivers.wgsl` reads them, and the lobes that they show to the eye.

use super::direction;
use glam::{DMat3, DVec3, Vec3, Vec4};
use halfshade_gpu::probe::Variable;
use halfshade_scene::{Gloss, Lobe, Pose, Reflectance, Scene, reflectance::tangent};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

/// A receiver in the space of its object.
pub(super) struct PlacedReceiver {
    pub(super) object: usize,
    pub(super) position: Vec3,
    pub(super) normal: Vec3,
    pub(super) albedo: Vec3,
    pub(super) gloss: Gloss,
}

impl PlacedReceiver {
    /// Anywhere near its object, of any normal; some are as glossy as their object, some not at all.
    pub(super) fn random(object: usize, number: usize, random: &mut Pcg64Mcg) -> Self {
        let mut numbers = || Vec3::new(random.random(), random.random(), random.random());
        let (place, albedo, specular) = (numbers(), numbers(), numbers());
        let gloss = match number % 5 {
            0 => Gloss::NEUTRAL,
            1 => Gloss { specular: Vec3::ZERO, exponent: 0.0 },
            _ => Gloss { specular, exponent: random.random() },
        };
        let normal = if number.is_multiple_of(7) { Vec3::Y } else { direction(random).as_vec3() };
        Self { object, position: place - 0.5, normal, albedo, gloss }
    }

    /// Position, normal and the tangent of anisotropic lobes in the world.
    fn in_world(&self, scene: &Scene) -> [DVec3; 3] {
        let pose = scene.frame(0).world_from_object[self.object];
        let turned = |vector: Vec3| pose.rotation.as_dquat().normalize() * vector.as_dvec3();
        let position = f64::from(pose.scale) * turned(self.position) + pose.translation.as_dvec3();
        [position, turned(self.normal), turned(tangent(self.normal))]
    }

    /// Normal in the world.
    pub(super) fn normal(&self, scene: &Scene) -> DVec3 {
        self.in_world(scene)[1]
    }

    /// The lobes of all terms of its object toward the scene's eye, `None` where one is black, and the most that each can be.
    pub(super) fn lobes(&self, scene: &Scene) -> Vec<(Option<Lobe>, f64)> {
        let [position, normal, tangent] = self.in_world(scene);
        let to_eye = (scene.camera.eye.as_dvec3() - position).normalize_or_zero();
        let [normal, tangent, to_eye] = [normal, tangent, to_eye].map(|vector| vector.as_vec3());
        let lobe = |term: Reflectance| {
            let lobe = term.lobes(self.gloss, normal, tangent, to_eye).first().copied();
            (lobe, peak(&term, self.gloss.exponent))
        };
        terms(&scene.objects[self.object].material.reflectance).into_iter().map(lobe).collect()
    }
}

/// Reflectances of a single term that make up one.
fn terms(reflectance: &Reflectance) -> Vec<Reflectance> {
    match reflectance {
        Reflectance::Lambert => Vec::new(),
        Reflectance::Lafortune { lobes } => {
            lobes.iter().map(|lobe| Reflectance::Lafortune { lobes: vec![*lobe] }).collect()
        }
        term => vec![term.clone()],
    }
}

/// The largest scale of a lobe, its exponent multiplied by a factor.
pub(super) fn peak(term: &Reflectance, factor: f32) -> f64 {
    let most = |scale: &Vec3| f64::from(scale.max_element());
    match term {
        Reflectance::Lambert => 0.0,
        Reflectance::Phong { specular, .. } => most(specular),
        Reflectance::ModifiedPhong { specular, exponent } => {
            most(specular) * (f64::from(exponent * factor) + 2.0) / std::f64::consts::TAU
        }
        Reflectance::Lafortune { lobes } => {
            let of_lobe = |length: f64, exponent: f32| length.powf(f64::from(exponent * factor));
            let length = |axis: Vec3| f64::from(axis.abs().max_element());
            lobes.iter().map(|lobe| most(&lobe.scale) * of_lobe(length(lobe.axis), lobe.exponent)).sum()
        }
    }
}

/// Rows of a lobe as shaders give them: axis and whether it has the cosine, scale and exponent.
pub(super) fn lobe_rows(lobe: Option<&Lobe>) -> [[f32; 4]; 2] {
    let rows = |lobe: &Lobe| {
        let times_cosine = f32::from(u8::from(lobe.times_cosine));
        [lobe.axis.extend(times_cosine), lobe.scale.extend(lobe.exponent)].map(|row| row.to_array())
    };
    lobe.map_or([[0.0; 4]; 2], rows)
}

/// Rows of a lobe as numbers of one size: what isn't bright has no direction.
pub(super) fn weighed([axis, scale]: [[f32; 4]; 2], peak: f64) -> [[f32; 4]; 2] {
    let scale = Vec4::from(scale);
    let share = scale.truncate() / peak as f32;
    let brightest = share.max_element();
    let axis = brightest * Vec4::from(axis);
    [axis, share.extend(brightest * scale.w.ln_1p() / 12.0)].map(|row| row.to_array())
}

/// Buffers of group 0.
pub(super) struct ReceiverBuffers {
    places: Vec<[u32; 8]>,
    albedos: Vec<f32>,
    placements: Vec<[[f32; 4]; 6]>,
}

impl ReceiverBuffers {
    /// On the objects of a scene, in the space of its world.
    pub(super) fn new(receivers: &[PlacedReceiver], scene: &Scene) -> Self {
        let place = |receiver: &PlacedReceiver| {
            let ([x, y, z], [u, v, w]) = (receiver.position.to_array(), receiver.normal.to_array());
            let bits = [x, y, z, 0.0, u, v, w, 0.0].map(f32::to_bits);
            std::array::from_fn(|k| if k == 3 { receiver.object as u32 } else { bits[k] })
        };
        let factors = |receiver: &PlacedReceiver| {
            let Gloss { specular, exponent } = receiver.gloss;
            [receiver.albedo.to_array(), specular.to_array()].concat().into_iter().chain([exponent]).collect::<Vec<_>>()
        };
        let factors: Vec<Vec<f32>> = receivers.iter().map(factors).collect();
        Self {
            places: receivers.iter().map(place).collect(),
            albedos: (0..7).flat_map(|channel| factors.iter().map(move |factors| factors[channel])).collect(),
            placements: scene.frame(0).world_from_object.iter().map(placement).collect(),
        }
    }

    pub(super) fn variables(&self) -> [Variable<'_>; 3] {
        [
            Variable::storage(0, "places", &self.places),
            Variable::storage(1, "albedos", &self.albedos),
            Variable::storage(2, "placements", &self.placements),
        ]
        .map(|variable| variable.of_group(0))
    }
}

/// Rows that place points, and those that turn directions.
fn placement(pose: &Pose) -> [[f32; 4]; 6] {
    let turn = DMat3::from_quat(pose.rotation.as_dquat().normalize());
    let row = |k: usize| {
        let offset = f64::from(pose.translation[k % 3]);
        let row = turn.row(k % 3);
        if k < 3 { (f64::from(pose.scale) * row).extend(offset) } else { row.extend(0.0) }
    };
    std::array::from_fn(|k| row(k).as_vec4().to_array())
}
