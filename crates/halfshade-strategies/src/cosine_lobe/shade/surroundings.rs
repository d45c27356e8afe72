//! Light from infinitely far, and around who is within a light, past the spheres.
//!
//! Unblocked, a receiver reflects the sum of products of its lobes ρ_i with those of the light l_j, by the table, and of the
//! constant in closed form. Visibility is not found light by light, since lobes have no edge and all of them overlap, but
//! once for all directions: two squares hold one hemisphere each, spheres are discs on both, and a disc covers parts of
//! cells (`kernel/cover.rs`). Light and visibility are multiplied first, as in `order=light-first`: a cell has the light that
//! all lobes together have there, of which the part that is open counts,
//!
//! ```text
//! L = Σ_i (Σ_j ∫ ρ_i l_j dω) · (Σ_k ρ̄_ik E_k open_k) / (Σ_k ρ̄_ik E_k)
//! ```
//!
//! for each channel, where E_k is the flux of cell k and ρ̄_ik the mean of ρ_i about it: the clamped cosine in the
//! cell's direction, or for a glossy lobe the integral of its product with the lobe of the cell's solid angle. As a ratio of
//! two sums over the same cells it is exact where nothing or everything is covered.
//!
//! A spherical light around the receiver is a constant environment that ends at the light's surface: a sphere that begins
//! before the surface and whose silhouette lies beyond it shrinks on the way, as before any light (`kernel/square.rs`).
//!
//! Work per receiver doesn't grow with the number of lobes but by the unblocked products.

use super::reflectance::{Horizon, ReflectanceLobe, ReflectanceLobes};
use crate::cosine_lobe::{
    kernel::{
        cover::Cover,
        environment::{cosine, least_cosine, mean, open_part, unblocked},
        receiver::Receiver,
        spheres::{BoundingSphere, Spheres},
    },
    prepare::surroundings::Surroundings,
};
use glam::Vec3;
use halfshade_scene::spheres::AdjustRule;
use halfshade_sh::lobe::{Lobe8, LobeTable};
use wide::f32x8;

/// Covers of both hemispheres, kept between uses.
#[derive(Debug, Clone, Default)]
pub(crate) struct Covers([Cover; 2]);

impl Covers {
    /// The light that a receiver reflects of its surroundings; behind `end`, whose centre is given from the receiver, nothing
    /// blocks.
    pub(crate) fn reflected(
        &mut self,
        surroundings: &Surroundings,
        receiver: &Receiver,
        reflectance: &ReflectanceLobes,
        (spheres, end): (&Spheres, Option<&BoundingSphere>),
        rule: AdjustRule,
        table: &LobeTable,
    ) -> Vec3 {
        let is_blocked = self.find(surroundings, receiver, (spheres, end), rule);
        let mut radiance = Vec3::ZERO;
        for part in reflectance.iter() {
            let lobe = above_horizon(part, receiver, table);
            let unblocked = part.color * unblocked(&lobe, &surroundings.lobes, surroundings.uniform, table);
            if unblocked == Vec3::ZERO {
                continue;
            }
            radiance += if is_blocked {
                let open = match part.horizon {
                    Horizon::Diffuse => open_part(&self.0, &surroundings.cells, |cells| cosine(&part.lobe, cells)),
                    Horizon::Cosine | Horizon::None => {
                        let least = least_cosine(&lobe, surroundings.side);
                        open_part(&self.0, &surroundings.cells, |cells| mean(&lobe, cells, table, least))
                    }
                };
                unblocked * open
            } else {
                unblocked
            };
        }
        radiance
    }

    /// Finds what spheres cover; `false` if nothing.
    fn find(
        &mut self,
        surroundings: &Surroundings,
        receiver: &Receiver,
        (spheres, end): (&Spheres, Option<&BoundingSphere>),
        rule: AdjustRule,
    ) -> bool {
        let mut is_blocked = false;
        for (center, radius) in spheres.groups() {
            let (offset, radius) = receiver.adjusted(&center, radius, rule);
            let end = end.map(|end| end.surface_behind(&offset));
            for (half, square) in surroundings.squares.iter().enumerate() {
                square.each_disc_before(end, &offset, radius, |disc| {
                    if !is_blocked {
                        is_blocked = true;
                        self.0.iter_mut().for_each(|cover| cover.clear(surroundings.side));
                    }
                    self.0[half].splat(&disc);
                });
            }
        }
        is_blocked
    }
}

/// A lobe without what it has below the horizon.
fn above_horizon(part: &ReflectanceLobe, receiver: &Receiver, table: &LobeTable) -> Lobe8 {
    match part.horizon {
        Horizon::Diffuse | Horizon::Cosine => part.lobe,
        Horizon::None => {
            let axis = receiver.normal.map(f32x8::splat);
            table.product8(&part.lobe, &Lobe8 { axis, exponent: f32x8::ZERO, scale: f32x8::ONE })
        }
    }
}
