//! Adaptive shadow fields \[Tamura2006\]: visibility past an object is precomputed at points around it, and shading multiplies.
//!
//! Around every object lie concentric shells (section 6: radii 0.2 R (1 + c), c from 0, R that of the object's bounding sphere). At
//! points on them, by latitude and longitude, an *object occlusion field* holds the visibility that the object leaves, as a
//! vector of spherical harmonics (`bake/sh`) or Haar wavelets (`bake/haar`). Each shell is thinned out as far as
//! interpolation allows (`bake/adaptive.rs`, equation 1), and coefficients are stored in 8 bits. What an object hides from
//! itself is precomputed at its vertices (`bake/vertices.rs`).
//!
//! ```text
//! U = O_self * ρ̂            for all others, from near to far:    an object: U = O_j * U      a light: L += S_j · U
//! L = albedo (S_d · U + ..)
//! ```
//!
//! with * the SH product, ρ̂ the clamped cosine over π and S_d the distant light (figure 3). A local light's *source
//! radiance field* is known in closed form: a sphere of uniform radiance looks like a cap from everywhere.
//!
//! Fields stay in the space of their object; coefficients read from them are rotated into the space of the light, so that
//! objects may move, turn and change their size. All meshes occlude, those of objects without spheres too.
//!
//! **Phases.** `bake`: fields of every mesh, own occlusion at its vertices. `prepare`: placements of objects and lights, distant
//! light in the basis, rotations; it ends in plain data. `shade`: receivers by the functions in `kernel`, in either basis (`sh`,
//! `haar`).
//!
//! A glossy receiver has a U of its own for each lobe of its BRDF.
//!
//! **Order.** All receivers of an object multiply the others by the distances of their centres. Which of them are before a
//! local light is decided at each receiver: those whose centre is nearer to it than the light's. A light that holds the
//! receiver is all around it, and objects with their centre in the light are before it; from outside, no object is that lies
//! in the light as a whole.
//!
//! **Bounds.** Every product is held to what `U = V ρ` can be for a visibility V in [0, 1] (`kernel/bounded_product.rs`), and to
//! no more than before: under constant light radiance lies within [0, unshadowed] and falls with every product, however many
//! there are. (One more in the midst of them may leave the result brighter, by 0.02 of the unshadowed where that was seen, since
//! the next product is cut off at other bands.) Under any other light SH ring about a part of the unshadowed, by at most
//! `√(3/16π)` = 0.24 of the albedo times the light's norm `√∫L²`, and by `√∫c / 2` of the norm for a glossy lobe c of height 1. Haar wavelets are
//! held to [0, 1] texel by texel: under any light radiance lies within [0, unshadowed].
//!
//! **Beyond the paper.** Shells that neighbours tell go too (`sampling=adaptive-shells`). Three shells within the first, where
//! the paper says nothing, keep flat objects flat (`inner`). Sample points within a solid are moved out of it (`inside`):
//! nobody looks from there, but who is near its surface interpolates with them, and dark rings came of it. Wavelets are
//! stored as trees (`coding`).
//!
//! **Limits.** Light and gloss are as sharp as bands or texels. Within the innermost shell a receiver lies between shell and
//! centre; past the last one, what is blocked shrinks with the solid angle.
//! A receiver between vertices interpolates what its object hides from them. From one that
//! sees its surface from behind, or that lies nowhere on it, its own object hides nothing. Meshes that deform can't be modelled.

pub mod arrays;
mod bake;
mod haar;
mod kernel;
mod prepare;
mod settings;
mod sh;
mod shade;

use bake::{haar::HaarFields, meshes::Baking, sh::ShFields};
use haar::HaarBaked;
use halfshade_scene::{Cache, Progress, Scene};
use halfshade_strategy::{Baked, Effect, Effects, Info, Params, Strategy, StrategyError};
use settings::{Basis, PRESETS, STAGES, Settings};
pub use sh::ShBaked;

/// The strategy.
#[derive(Debug, Clone, Default)]
pub struct ShadowField {
    cache: Cache,
}

impl ShadowField {
    /// Keeps what takes rays in `cache`: fields as projected, before they are thinned out. The default keeps nothing.
    pub const fn new(cache: Cache) -> Self {
        Self { cache }
    }
}

impl Strategy for ShadowField {
    fn info(&self) -> Info {
        Info {
            name: "shadow-field",
            summary: "visibility precomputed on shells around every object, combined by SH triple products",
            source: "[Tamura2006]",
            parameters: Settings::parameters(),
            presets: PRESETS,
            stages: STAGES,
            effects: Effects::of(&[
                Effect::EnvironmentLight,
                Effect::LocalLights,
                Effect::ColouredLight,
                Effect::GlossyReflectance,
                Effect::Motion,
            ]),
        }
    }

    fn needs_spheres(&self) -> bool {
        false
    }

    fn bake(&self, scene: &Scene, params: &Params, progress: &dyn Progress) -> Result<Box<dyn Baked>, StrategyError> {
        let settings = Settings::read(params);
        Ok(match settings.basis {
            Basis::Sh => Box::new(self.bake_sh(scene, params, progress)?),
            Basis::Haar => {
                let fields = HaarFields::bake(&self.baking(&settings), scene, &settings, progress)?;
                Box::new(HaarBaked::new(fields))
            }
        })
    }
}

impl ShadowField {
    /// [`Strategy::bake`] in spherical harmonics, whatever the basis that is asked for: for who reads the arrays of frames.
    pub fn bake_sh(&self, scene: &Scene, params: &Params, progress: &dyn Progress) -> Result<ShBaked, StrategyError> {
        let settings = Settings::read(params);
        Ok(ShBaked::new(ShFields::bake(&self.baking(&settings), scene, &settings, progress)?))
    }

    fn baking(&self, settings: &Settings) -> Baking<'_> {
        Baking {
            cache: &self.cache,
            layout: settings.shell_layout(),
            thinning: settings.thinning(),
            source: settings.source(),
            storage: settings.storage,
        }
    }
}
