//! Reflectance as lobes [Meunier2009, 5.1]: the diffuse one, and those that the surface shows the eye.

use glam::Vec3;
use halfshade_scene::{EyeLobes, Receivers, lobe};
use halfshade_sh::lobe::{Lobe8, LobeTable};
use std::f32::consts::FRAC_1_PI;
use wide::f32x8;

/// Most lobes of a receiver: the diffuse one and all others.
pub(crate) const MOST_LOBES: usize = lobe::MAX_LOBES + 2;

/// Where a lobe ends at the horizon.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Horizon {
    /// It is the clamped cosine itself.
    Diffuse,
    /// It is a product with the cosine.
    Cosine,
    /// It goes on below, where nothing is reflected.
    None,
}

/// One lobe of the reflectance in every lane, with a colour apart.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ReflectanceLobe {
    pub(crate) lobe: Lobe8,
    /// In 1/steradian.
    pub(crate) color: Vec3,
    pub(crate) horizon: Horizon,
}

/// The lobes of one receiver's reflectance.
pub(crate) struct ReflectanceLobes {
    lobes: [ReflectanceLobe; MOST_LOBES],
    count: usize,
}

impl ReflectanceLobes {
    /// The lobes of receiver `i`.
    pub(crate) fn of(receivers: &Receivers<'_>, i: usize, eye_lobes: Option<&EyeLobes>, table: &LobeTable) -> Self {
        let normal = receivers.normal_at(i);
        let cosine = in_every_lane(normal, 1.0);
        let diffuse =
            ReflectanceLobe { lobe: cosine, color: FRAC_1_PI * receivers.albedo_at(i), horizon: Horizon::Diffuse };
        let mut found = Self { lobes: [diffuse; MOST_LOBES], count: 1 };
        let Some(eye_lobes) = eye_lobes else { return found };
        for glossy in eye_lobes.at(receivers, i).iter().take(MOST_LOBES - 1) {
            let lobe = in_every_lane(glossy.axis, glossy.exponent);
            found.lobes[found.count] = if glossy.times_cosine {
                ReflectanceLobe { lobe: table.product8(&lobe, &cosine), color: glossy.scale, horizon: Horizon::Cosine }
            } else {
                ReflectanceLobe { lobe, color: glossy.scale, horizon: Horizon::None }
            };
            found.count += 1;
        }
        found
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &ReflectanceLobe> {
        self.lobes[..self.count].iter()
    }
}

fn in_every_lane(axis: Vec3, exponent: f32) -> Lobe8 {
    Lobe8 { axis: axis.to_array().map(f32x8::splat), exponent: f32x8::splat(exponent), scale: f32x8::ONE }
}
