//! Direct light of spherical lights and environments by cosine lobes \[Meunier2009\]: reflectance, light and visibility are sums
//! of lobes `s max(a·v, 0)^e`, and the integral of a product of lobes is looked up (`halfshade_sh::lobe`).
//!
//! ```text
//! L = Σ_i Σ_j ∫ ρ_i l_j V_j dω        ρ: reflectance (5.1)   l: a light (5.2)   V_j = 1 - Σ_k w_k c_k: what hides it (5.3)
//! ```
//!
//! Per receiver and light, spheres of all objects are projected onto a square around the light, whose quad-tree of shadow is
//! found (`kernel/square.rs`, `kernel/mask.rs`); each leaf is a lobe (`kernel/cell_lobes.rs`). Memory and time depend on
//! spheres in the way only: an unblocked receiver has no mask, and where one sphere or all together hide the light nothing is multiplied.
//!
//! **Two orders.** `order=published` multiplies reflectance and light first, as lobes, and the product with each leaf's lobe,
//! weighted (`bake/weights.rs`). But a light is 0 or 1 too, as the mask is: their product is just the part of the light that a leaf
//! hides. `order=light-first`, the default, makes a lobe of that part, with its solid angle and middle:
//!
//! ```text
//! L = Σ_i (∫ ρ_i l_j dω - Σ_k ∫ ρ_i c_k dω)
//! ```
//!
//! with one product less, no weights, and for a diffuse surface a closed form in the first integral. A glossy surface sees the
//! unblocked light in parts of half its lobe's width, 8 by 8 at most.
//!
//! **Phases.** `bake`: tables of lobes and cells, the environment as lobes. `prepare`: spheres and lights about an origin, the
//! environment turned; it ends in plain data. `shade`: receivers one by one, by the functions in `kernel`.
//!
//! **Deviations** from the paper. Projection is stereographic instead of onto a plane, where spheres are exactly discs; the
//! tree is built from its finest cells, so that siblings hidden by several spheres join; where all cells with light are
//! hidden, radiance is 0. `leaves=fraction`, the default, keeps partly covered cells by the fraction covered. Spheres that
//! contain a receiver or cut its tangent plane follow the rules of [Guerrero2007, 4.2], since \[Meunier2009\] has none. The preset
//! `as-published` has the paper's order, leaves, fit and products.
//!
//! **Errors** by depth, leaves and order are in `results/mask-depth`. The light's own lobe, which has too much solid angle by
//! least squares, is what deeper masks leave of the published error. With a better lobe and leaves ignored, the published order
//! is as good as the other at depth 5 and better at depth 3: fitted weights make up for what is ignored. It is the fraction that
//! makes the default near to exact, not the order.
//!
//! Penumbras of one blocker, from a tenth to nine tenths of the light, are within 1 % as wide as the truth's for lights of radius
//! 0.001 to 0.8 at a distance of 3, as published within 10 %. Where many small spheres hide a light together, less than 0.001
//! of it leaks through; with partly covered leaves ignored up to 0.15.
//!
//! On `glossy-sphere`, whose highlights are as sharp as the light, a single lobe for the light errs ten times as much as its
//! parts.
//!
//! **Threshold** [Meunier2009, 4.3]. A group of eight products is left out if none of them can reach `threshold` times the
//! unblocked radiance; each left out changes radiance by less than that. A diffuse lobe isn't tested in the default order.
//!
//! **Bounds.** Lobes aren't negative, and what a mask hides is taken from what the unblocked light gives, down to 0 at
//! most: in every order and setting radiance lies within [0, what is found without blockers].
//!
//! **Integration.** `integration=sampled` integrates the same sums of lobes by quadrature (`kernel/sampled.rs`), for comparison
//! only: `results/lobe-accuracy` has the differences. `benches/lobe_time_shares.rs` does each stage of the work twice: how much
//! longer that takes is its share of the time [Meunier2009, table 1].
//!
//! **Neighbours.** Spheres in the way are looked up for 64 receivers, and among those for 8: that is exact, so that a receiver
//! meets no more spheres than are near its own light. `share` also shares masks (`shade/shared_masks.rs`), which saves time but
//! shows as blocks (`results/lobe-costs`). It is off by default.
//!
//! **Time** by pixels, spheres and depth is in `results/lobe-box` and `results/lobe-costs`.
//!
//! **Environments**, which the paper leaves open, are a constant and a few lobes fitted to the map (`env-lobes`), and a sun
//! is a spherical light infinitely far away, also one that is found in the map (`env-lamps`). One mask of all directions
//! serves all lobes (`env-depth`): see `shade/surroundings.rs`. `tests/cosine_lobe/environment.rs` holds errors by lobes and depth,
//! `tests/tests/shared_assets.rs` those under captured probes, where without lamps a captured sun smears; `results/environment-lobes`
//! has them beside exponentiated spherical harmonics.
//!
//! **Limits.** Local lights are spheres. A map without its lamps is smeared over 5.6 degrees, the lobes' grid, and
//! highlights sharper than that show it; blockers of an environment are told apart by cells. Spheres behind the light are
//! ignored. From within a light it is an environment that ends at its surface. A Phong lobe without a cosine, which reaches below the horizon, is
//! cut there by the visible fraction of the light alone.

mod bake;
mod kernel;
mod prepare;
mod settings;
mod shade;

use crate::shared::blockers::Blockers;
use bake::{environment::FittedEnvironment, tables::Tables};
use halfshade_scene::{Frame, Progress, Scene};
use halfshade_strategy::{Baked, Detail, Effect, Effects, Footprint, Info, Params, Prepared, Strategy, StrategyError};
use kernel::sampled::Sampler;
use prepare::frame::FrameData;
use settings::{PRESETS, STAGES, Settings};
#[doc(hidden)]
pub use shade::Stage;
use shade::{Counters, Shader};

/// The strategy.
#[derive(Debug, Clone, Copy, Default)]
pub struct CosineLobe;

impl Strategy for CosineLobe {
    fn info(&self) -> Info {
        Info {
            name: "cosine-lobe",
            summary: "products of cosine lobes; a quad-tree of shadow before each spherical light, one mask before an environment",
            source: "[Meunier2009]",
            parameters: Settings::parameters(),
            presets: PRESETS,
            stages: STAGES,
            effects: Effects::of(&[
                Effect::EnvironmentLight,
                Effect::LocalLights,
                Effect::ColouredLight,
                Effect::GlossyReflectance,
                Effect::Motion,
                Effect::Deformation,
            ]),
        }
    }

    fn bake(&self, scene: &Scene, params: &Params, progress: &dyn Progress) -> Result<Box<dyn Baked>, StrategyError> {
        Ok(Box::new(BakedScene::new(scene, params, progress, None)))
    }
}

impl CosineLobe {
    /// Bakes a scene of which shading does one stage twice, for `benches/lobe_time_shares.rs`: it changes no bit, and how
    /// much longer it takes is the stage's share of the time [Meunier2009, table 1].
    #[doc(hidden)]
    pub fn bake_repeating(
        self,
        stage: Stage,
        scene: &Scene,
        params: &Params,
        progress: &dyn Progress,
    ) -> Box<dyn Baked> {
        Box::new(BakedScene::new(scene, params, progress, Some(stage)))
    }
}

/// Tables of the scene, and data of the last frame.
#[derive(Debug)]
struct BakedScene {
    settings: Settings,
    tables: Tables,
    environment: FittedEnvironment,
    /// All directions alike, if there are local lights.
    everywhere: Option<FittedEnvironment>,
    blockers: Blockers,
    frame: Option<FrameData>,
    counters: Counters,
    /// A stage that runs twice.
    repeated: Option<Stage>,
}

impl BakedScene {
    fn new(scene: &Scene, params: &Params, progress: &dyn Progress, repeated: Option<Stage>) -> Self {
        progress.start("tables of lobes", 1);
        let settings = Settings::read(params);
        let tables = Tables::new(&settings);
        progress.advance(1);
        let products = tables.products;
        Self {
            environment: FittedEnvironment::of(&scene.environment, &settings, products),
            everywhere: (!scene.lights.is_empty()).then(|| FittedEnvironment::everywhere(&settings, products)),
            tables,
            settings,
            blockers: Blockers::new(scene),
            frame: None,
            counters: Counters::default(),
            repeated,
        }
    }
}

impl Baked for BakedScene {
    fn footprint(&self) -> Footprint {
        let Self { tables, environment, everywhere, blockers, frame, .. } = self;
        let [lobes, sky] = environment.bytes();
        Footprint {
            parts: vec![
                ("products", tables.products.bytes()),
                ("caps", tables.caps.bytes()),
                ("cells", tables.cells.bytes()),
                ("weights", tables.weights.bytes()),
                ("samples", tables.sampler.as_ref().map_or(0, Sampler::bytes)),
                ("lobes of the environment", lobes),
                ("cells of the environment", sky),
                ("cells around who is within a light", everywhere.as_ref().map_or(0, |fitted| fitted.bytes()[1])),
                ("spheres", frame.as_ref().map_or(0, |frame| frame.spheres.bytes())),
                ("bindings", blockers.bytes()),
            ],
        }
    }

    fn details(&self) -> Vec<Detail> {
        self.counters.details()
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
        if frame.scene.objects.len() != self.blockers.object_count() {
            return Err(StrategyError::Failed("the frame is of another scene than was baked".into()));
        }
        let Self { settings, tables, environment, everywhere, blockers, frame: data, counters, repeated } = self;
        let light = &frame.scene.environment;
        if !environment.fits(light) {
            *environment = FittedEnvironment::of(light, settings, tables.products);
        }
        if everywhere.is_none() && !frame.lights.is_empty() {
            *everywhere = Some(FittedEnvironment::everywhere(settings, tables.products));
        }
        let frame = data.insert(FrameData::new(frame, blockers, environment, everywhere.as_ref()));
        Ok(Box::new(Shader { settings, tables, frame, counters, repeated: *repeated }))
    }
}
