//! Direct light at glossy receivers.
//!
//! ```text
//! L = Σ over lights ∫ L_in(v) V(v) c(v) dv        c: the sum of the receiver's lobes towards the eye
//! ```
//!
//! Every light is sampled twice, with equally many directions: where it shines (its map's radiance, its cap) and where
//! the receiver reflects ([`Mixture`]), combined with the balance heuristic \[Veach1995\]. A narrow lobe in a wide
//! light and a small light in a wide lobe are both found, and no sample outweighs the rest: `c/density` is bounded by
//! the lobes' integrals, `L_in/density` by the light's. Light that is all around is only sampled by reflectance.
//!
//! The unshadowed value has no closed form that would serve as control variate; it is the mean of the same samples with
//! visibility 1.

use crate::{
    batch::Batch,
    lights::Integral,
    mixture::Mixture,
    points::{Scramble, unit_f64},
    receiver::Receiver,
    source::{Densities, Source},
    tracer::Tracer,
};
use glam::DVec3;

/// Technique by which directions are drawn at a glossy receiver.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum GlossyTechnique {
    Light,
    Reflectance,
}

impl GlossyTechnique {
    pub(crate) const BOTH: [Self; 2] = [Self::Light, Self::Reflectance];
}

/// The light of one integral at one glossy receiver.
pub(crate) struct GlossyIntegral<'a> {
    source: Source<'a>,
    mixture: &'a Mixture,
}

impl<'a> GlossyIntegral<'a> {
    pub(crate) fn new(tracer: &'a Tracer, integral: Integral, receiver: &Receiver, mixture: &'a Mixture) -> Self {
        Self { source: tracer.lights.source(integral, receiver, &tracer.space), mixture }
    }

    /// Draws samples for at most one batch of points: values are radiance times reflectance over the densities' sum.
    /// `false` if this technique isn't taken.
    pub(crate) fn sample(
        &self,
        technique: GlossyTechnique,
        points: &[[u32; 2]],
        scramble: Scramble,
        batch: &mut Batch,
    ) -> bool {
        let densities = match technique {
            GlossyTechnique::Light if !self.source.is_drawn() => return false,
            GlossyTechnique::Light => self.source.draw(points, scramble, batch),
            GlossyTechnique::Reflectance => {
                batch.len = points.len();
                for (k, &point) in points.iter().enumerate() {
                    batch.set_direction(k, self.mixture.sample(scramble.apply(point).map(unit_f64)).to_array());
                }
                self.source.look(batch)
            }
        };
        self.weigh(&densities, batch);
        batch.clear_rest();
        true
    }

    fn weigh(&self, densities: &Densities, batch: &mut Batch) {
        for (k, &by_light) in densities.iter().enumerate().take(batch.len) {
            if !batch.carries_light(k) {
                continue;
            }
            let direction = DVec3::from_array(std::array::from_fn(|axis| f64::from(batch.direction[axis][k])));
            let (reflectance, density) = self.mixture.evaluate(direction);
            let sum = density + by_light;
            let weight = if sum > 0.0 { reflectance / sum } else { DVec3::ZERO };
            let radiance = DVec3::from_array(std::array::from_fn(|channel| f64::from(batch.value[channel][k])));
            batch.set_value(k, (radiance * weight).as_vec3().to_array());
        }
    }
}
