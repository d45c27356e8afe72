//! Reflectance as lobes [Meunier2009, 5.1]: the diffuse one, and those that the surface shows the eye.

use glam::Vec3;
use halfshade_scene::{EyeLobes, Receivers, lobe};
use halfshade_sh::lobe::{Lobe8, LobeTable};
use std::f32::consts::FRAC_1_PI;
use wide::f32x8;

/// Most lobes of a receiver: the diffuse one and all others.
pub(super) const MOST_TERMS: usize = lobe::MAX_LOBES + 2;

/// Where a lobe ends at the horizon.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Horizon {
    /// It is the clamped cosine itself.
    Diffuse,
    /// It is a product with the cosine.
    Cosine,
    /// It goes on below, where nothing is reflected.
    None,
}

/// One lobe of the reflectance in every lane, with a colour apart.
#[derive(Debug, Clone, Copy)]
pub(super) struct Term {
    pub(super) lobe: Lobe8,
    /// In 1/steradian.
    pub(super) color: Vec3,
    pub(super) horizon: Horizon,
}

/// The terms of one receiver.
pub(super) struct Terms {
    terms: [Term; MOST_TERMS],
    count: usize,
}

impl Terms {
    /// Of receiver `i`.
    pub(super) fn of(receivers: &Receivers<'_>, i: usize, eye_lobes: Option<&EyeLobes>, table: &LobeTable) -> Self {
        let normal = receivers.normal_at(i);
        let cosine = in_every_lane(normal, 1.0);
        let diffuse = Term { lobe: cosine, color: FRAC_1_PI * receivers.albedo_at(i), horizon: Horizon::Diffuse };
        let mut terms = Self { terms: [diffuse; MOST_TERMS], count: 1 };
        let Some(eye_lobes) = eye_lobes else { return terms };
        for glossy in eye_lobes.at(receivers, i).iter().take(MOST_TERMS - 1) {
            let lobe = in_every_lane(glossy.axis, glossy.exponent);
            terms.terms[terms.count] = if glossy.times_cosine {
                Term { lobe: table.product8(&lobe, &cosine), color: glossy.scale, horizon: Horizon::Cosine }
            } else {
                Term { lobe, color: glossy.scale, horizon: Horizon::None }
            };
            terms.count += 1;
        }
        terms
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Term> {
        self.terms[..self.count].iter()
    }
}

fn in_every_lane(axis: Vec3, exponent: f32) -> Lobe8 {
    Lobe8 { axis: axis.to_array().map(f32x8::splat), exponent: f32x8::splat(exponent), scale: f32x8::ONE }
}
