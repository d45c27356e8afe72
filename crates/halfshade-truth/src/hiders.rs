//! Hiders of the light at a receiver: its own object, another one, the ground, or nothing.
//!
//! Sample rays carry shares of the unshadowed irradiance, radiance times cosine over density as luminance, from all
//! lights together. The share of a blocked ray goes to the object that the ray meets first: to the receiver's *own*
//! object; to the *ground*, which is any object without spheres; or to an*other* object. The class with the largest
//! share hides the light there, the first named of equal ones. Where all of them together hide less than
//! [`LEAST_SHARE`] it is *nothing*, as it is where no light arrives unshadowed.
//!
//! 64 rays per receiver and technique, each traced to its first hit: a class is as certain as 64 samples make it. The
//! reflectance of the receiver plays no part, nor does light that other surfaces reflect.

use crate::{REPLICATES, Tracer, batch::Batch, environment::LUMINANCE, estimate::for_every_batch, points::Points};
use glam::Vec3;
use halfshade_scene::{Progress, Receivers};
use rayon::prelude::*;

/// The share of the unshadowed irradiance below which nothing counts as hidden: more than one ray of 64 carries on
/// average.
pub const LEAST_SHARE: f64 = 0.02;

/// Points per technique, in [`REPLICATES`] scramblings.
const POINTS: usize = 4;

/// Receivers per unit of parallel work.
const CHUNK: usize = 64;

/// Scramblings apart from those of the truth: the classes must not know its noise.
const SEED: u64 = 0x6869_6465_7273;

/// Hider of most of the light that would reach a receiver.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Hider {
    /// The object that the receiver lies on, whether it has spheres or not.
    Own,
    /// Another object, one with spheres.
    Other,
    /// Another object, one without spheres.
    Ground,
    /// Less than [`LEAST_SHARE`] of the light is hidden.
    Nothing,
}

impl Hider {
    /// All of them, in the order of tables.
    pub const ALL: [Self; 4] = [Self::Own, Self::Other, Self::Ground, Self::Nothing];
}

/// Hider of the light at each receiver, by the meshes. The same on one thread or many, whatever the truth's seed.
pub fn hiders(tracer: &Tracer, receivers: Receivers<'_>, progress: &dyn Progress) -> Vec<Hider> {
    let points = Points::first(POINTS);
    progress.start("finding what hides the light", receivers.len() as u64);
    let chunks: Vec<Vec<Hider>> = (0..receivers.len().div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let range = chunk * CHUNK..((chunk + 1) * CHUNK).min(receivers.len());
            let mut batch = Batch::new();
            let found = range.clone().map(|i| hider(tracer, &receivers, i, &points, &mut batch)).collect();
            progress.advance(range.len() as u64);
            found
        })
        .collect();
    chunks.concat()
}

fn hider(tracer: &Tracer, receivers: &Receivers<'_>, i: usize, points: &Points, batch: &mut Batch) -> Hider {
    let (position, normal) = (receivers.position_at(i), receivers.normal_at(i));
    if !(position.is_finite() && normal.is_finite()) {
        return Hider::Nothing;
    }
    let (receiver, own) = (tracer.receiver(position, normal), receivers.object[i]);
    let (mut all, mut hidden) = (0.0, [0.0; 3]);
    for (number, integral) in tracer.lights.integrals().enumerate() {
        let seed = (SEED, receivers.index[i]);
        for_every_batch(tracer, (number as u32, integral), &receiver, seed, points, batch, |_, batch| {
            for k in (0..batch.len).filter(|&k| batch.carries_light(k)) {
                // Light limited to some bands may be negative.
                let share: f64 = (0..3)
                    .map(|channel| f64::from(LUMINANCE[channel]) * f64::from(batch.value[channel][k].abs()))
                    .sum();
                all += share;
                let direction = Vec3::from_array(batch.direction.each_ref().map(|axis| axis[k]));
                if let Some(object) = tracer.first_object(&receiver, direction, batch.distance[k]) {
                    let class = if object == own {
                        Hider::Own
                    } else if tracer.objects[object as usize].0.sphere_count == 0 {
                        Hider::Ground
                    } else {
                        Hider::Other
                    };
                    hidden[class as usize] += share;
                }
            }
        });
    }
    let most = (1..hidden.len()).fold(0, |most, class| if hidden[class] > hidden[most] { class } else { most });
    let least = LEAST_SHARE * all;
    if hidden.iter().sum::<f64>() > least { Hider::ALL[most] } else { Hider::Nothing }
}

const _: () = assert!(REPLICATES * POINTS == 64);
