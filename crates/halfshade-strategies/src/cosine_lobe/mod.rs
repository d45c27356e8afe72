//! Direct light of spherical lights and environments by cosine lobes \[Meunier2009\]: reflectance, light and visibility are sums
//! of lobes `s max(a·v, 0)^e`, and the integral of a product of lobes is looked up (`halfshade_sh::lobe`).
//!
//! ```text
//! L = Σ_i Σ_j ∫ ρ_i l_j V_j dω        ρ: reflectance (5.1)   l: a light (5.2)   V_j = 1 - Σ_k w_k c_k: what hides it (5.3)
//! ```
//!
//! Per receiver and light, spheres of all objects are projected onto a square around the light, whose quad-tree of shadow is
//! found (`square.rs`, `mask.rs`); each leaf is a lobe (`lobes.rs`). Memory and time depend on what is in the way only: an
//! unblocked receiver has no mask, and where one sphere or all together hide the light nothing is multiplied.
//!
//! **Two orders.** `order=published` multiplies reflectance and light first, as lobes, and the product with each leaf's lobe,
//! weighted (`weights.rs`). But a light is 0 or 1 too, as the mask is: their product is just the part of the light that a leaf
//! hides. `order=light-first`, the default, makes a lobe of that part, with its solid angle and middle:
//!
//! ```text
//! L = Σ_i (∫ ρ_i l_j dω - Σ_k ∫ ρ_i c_k dω)
//! ```
//!
//! with one product less, no weights, and for a diffuse surface a closed form in the first integral. A glossy surface sees the
//! unblocked light in parts of half its lobe's width, 8 by 8 at most.
//!
//! **Deviations** from the paper. Projection is stereographic instead of onto a plane, where spheres are exactly discs; the
//! tree is built from its finest cells, so that siblings hidden by several spheres join; where all cells with light are
//! hidden, radiance is 0. `leaves=fraction`, the default, keeps partly covered cells by the fraction covered. Spheres that
//! contain a receiver or cut its tangent plane follow the rules of [Guerrero2007, 4.2], since \[Meunier2009\] has none. As
//! published: `order=published,leaves=aggressive,fit=least-squares,product=published`.
//!
//! **Errors**, relative RMSE on `five-blockers` against its spheres' truth (`experiments/mask-depth.toml`):
//!
//! | | depth 2 | 3 | 4 | 5 | 6 |
//! | --- | --- | --- | --- | --- | --- |
//! | default, by depth | 0.0049 | 0.0015 | < 0.001 | < 0.001 | < 0.001 |
//! | `leaves=aggressive` | 0.062 | 0.031 | 0.016 | 0.008 | 0.004 |
//! | `leaves=conservative` | 0.066 | 0.033 | 0.016 | 0.008 | 0.004 |
//! | as published | 0.054 | 0.044 | 0.042 | 0.041 | 0.041 |
//! | as published, `weights=umbra` | | 0.055 | | 0.043 | |
//! | as published, `fit=scaled-solid-angle` | | 0.015 | | 0.008 | |
//!
//! What deeper masks leave of the published error is the light's own lobe, which has 4 % too much solid angle by least
//! squares. With a better lobe and leaves ignored, the published order is as good as the other at depth 5 and better at depth 3:
//! fitted weights make up for what is ignored. It is the fraction that makes the default near to exact, not the order.
//!
//! Penumbras of one blocker, from a tenth to nine tenths of the light, are within 1 % as wide as the truth's for lights of radius
//! 0.001 to 0.8 at a distance of 3, as published within 10 %. Where many small spheres hide a light together, less than 0.001
//! of it leaks through; with partly covered leaves ignored up to 0.15.
//!
//! On `glossy-sphere`, whose highlights are as sharp as the light, a single lobe for the light errs by 0.4 to 0.6 of the
//! mean, its parts by 0.05.
//!
//! **Threshold** [Meunier2009, 4.3]. A group of eight products is left out if none of them can reach `threshold` times the
//! unblocked radiance; each left out changes radiance by less than that. A diffuse lobe isn't tested in the default order.
//!
//! **Bounds.** Lobes aren't negative, and what a mask hides is taken from what the unblocked light gives, down to 0 at
//! most: in every order and setting radiance lies within [0, what is found without blockers].
//!
//! **Integration.** `integration=sampled` integrates the same sums of lobes by quadrature (`sampled.rs`), for comparison
//! only: on `five-blockers` and `glossy-sphere` products differ from it by less than 0.1 % of the mean by default, by 0.1
//! and 0.3 % as published (the paper's by 3 %), and it takes a hundred times as long. `twice=mask` and so on do a part of
//! the work twice and change no bit: how much longer that takes is the part's share of the time [Meunier2009, table 1].
//!
//! **Neighbours.** Spheres in the way are looked up for 64 receivers, and among those for 8: that is exact, so that a receiver
//! meets no more spheres than are near its own light. `share` also shares masks (`shared.rs`): on `two-squirrels` cubes of a
//! sixteenth of the light's radius leave 28 % of the masks and save an eighth of the time, but what they err, 0.035 of the mean
//! beside 0.02, shows as blocks. It is off by default.
//!
//! **Time.** That scene's 480,000 pixels, of which 6 % have a mask, take 0.2 s on two cores, 0.9 µs each on a core; the paper
//! takes 6.25 s on two of 2007. From 16 to 1,024 spheres it grows by 4 %, from depth 2 to 6 by 57 % (`experiments/lobe-box.toml`,
//! `experiments/lobe-costs.toml`).
//!
//! **Environments**, which the paper leaves open, are a constant and a few lobes fitted to the map (`env-lobes`), and a sun
//! is a spherical light infinitely far away, also one that is found in the map (`env-lamps`). One mask of all directions
//! serves all lobes (`env-depth`): see `environment/mod.rs`. Of a sky with a window and a lamp, 16 lobes miss unblocked
//! radiance by 0.002 of its mean (RMS), and what five spheres leave of it by 0.029, 0.013, 0.009 and 0.008 at depth 3, 4, 5
//! and 6; at depth 5, 8 lobes by 0.010 and 64 by 0.007 (`tests/cosine_lobe/environment.rs`). On `vases` and
//! `teapot-and-statue` the relative RMSE against the spheres' truth is 0.009, where exponentiated spherical harmonics of 6
//! bands have 0.03 to 0.05 in a quarter to two thirds of the time (`experiments/environment-lobes.toml`). Under ten captured
//! probes over a rabbit of 16 spheres it is 0.005 to 0.017, where they have 0.010 to 0.15 (`tests/tests/shared_assets.rs`);
//! without lamps, a captured sun makes it 0.11.
//!
//! **Limits.** Local lights are spheres. What of a map is no lamp is smeared over 5.6 degrees, the lobes' grid, and
//! highlights sharper than that show it; blockers of an environment are told apart by cells. Spheres behind the light are
//! ignored. From within a light it is an environment that ends at its surface. A Phong lobe without a cosine, which reaches below the horizon, is
//! cut there by the visible fraction of the light alone.

mod blockers;
mod environment;
mod light;
mod lobes;
mod mask;
mod moment;
mod reflectance;
mod sampled;
mod settings;
mod shade;
mod shared;
mod square;
mod tables;
mod visibility;
mod weights;

use crate::shared::origin::origin_of;
use blockers::{Body, Spheres, bodies, placed_spheres};
use environment::Fitted;
use halfshade_scene::{Environment, EyeLobes, Frame, Progress, RadianceMut, Receivers, Scene, once};
use halfshade_sh::lobe::{CapLobeTable, LobeTable, ProductRule};
use halfshade_strategy::{Baked, Detail, Effect, Effects, Footprint, Info, Params, Prepared, Strategy, StrategyError};
use light::Light;
use moment::Moment;
use sampled::Sampler;
use settings::{Integration, Order, PRESETS, Settings};
use shade::Shading;
use square::Cells;
use std::sync::{
    OnceLock,
    atomic::{AtomicU64, Ordering::Relaxed},
};
use tables::Tables;
use weights::WeightTable;

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
        progress.start("tables of lobes", 1);
        let settings = Settings::read(params);
        let products = table_of(settings.product.into());
        let caps = CapLobeTable::build(settings.fit.into());
        let cells = Cells::new(settings.depth);
        let sampler = match settings.integration {
            Integration::Analytic => None,
            Integration::Sampled => Some(Sampler::new(settings.samples)),
        };
        let weights = match settings.order {
            Order::LightFirst => WeightTable::ones(),
            Order::Published => WeightTable::new(&settings, &cells, &caps, products),
        };
        progress.advance(1);
        Ok(Box::new(Lobes {
            fitted: settings.fitted(&scene.environment, products),
            tables: Tables { products, caps, cells, weights, sampler },
            everywhere: (!scene.lights.is_empty()).then(|| settings.everywhere(products)),
            settings,
            bodies: bodies(scene),
            moment: None,
            counters: Counters::default(),
        }))
    }
}

impl Settings {
    fn fitted(&self, environment: &Environment, table: &LobeTable) -> Fitted {
        let (lamps, lobes) = (self.environment_lamps, self.environment_lobes);
        Fitted::new(&environment.base, lamps, lobes, self.environment_depth, table)
    }

    fn everywhere(&self, table: &LobeTable) -> Fitted {
        Fitted::everywhere(self.environment_depth, table)
    }
}

/// The table of a rule, which depends on no scene.
fn table_of(rule: ProductRule) -> &'static LobeTable {
    static TABLES: [OnceLock<LobeTable>; ProductRule::ALL.len()] = [const { OnceLock::new() }; ProductRule::ALL.len()];
    once(&TABLES[rule as usize], || LobeTable::build(rule))
}

/// What was done since baking.
#[derive(Debug, Default)]
struct Counters {
    products: AtomicU64,
    left_out: AtomicU64,
    masks: AtomicU64,
    lobes: AtomicU64,
}

#[derive(Debug)]
struct Lobes {
    settings: Settings,
    tables: Tables,
    fitted: Fitted,
    /// If there are local lights.
    everywhere: Option<Fitted>,
    bodies: Vec<Option<Body>>,
    moment: Option<Moment>,
    counters: Counters,
}

impl Baked for Lobes {
    fn footprint(&self) -> Footprint {
        let bodies = self.bodies.iter().flatten();
        let [lobes, sky] = self.fitted.bytes();
        let everywhere = self.everywhere.as_ref().map_or(0, |fitted| fitted.bytes()[1]);
        Footprint {
            parts: vec![
                ("products", self.tables.products.bytes()),
                ("caps", self.tables.caps.bytes()),
                ("cells", self.tables.cells.bytes()),
                ("weights", self.tables.weights.bytes()),
                ("samples", self.tables.sampler.as_ref().map_or(0, Sampler::bytes)),
                ("lobes of the environment", lobes),
                ("cells of the environment", sky),
                ("cells around who is within a light", everywhere),
                ("spheres", self.moment.as_ref().map_or(0, |moment| moment.spheres.bytes())),
                ("bindings", bodies.map(Body::bytes).sum()),
            ],
        }
    }

    fn details(&self) -> Vec<Detail> {
        let Counters { products, left_out, masks, lobes } = &self.counters;
        let detail =
            |name: &str, count: &AtomicU64| Detail { name: name.into(), values: vec![count.load(Relaxed) as f64] };
        vec![
            detail("lobe products since baking", products),
            detail("lobe products left out since baking", left_out),
            detail("visibility masks since baking", masks),
            detail("visibility lobes since baking", lobes),
        ]
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
        if frame.scene.objects.len() != self.bodies.len() {
            return Err(StrategyError::Failed("the frame is of another scene than was baked".into()));
        }
        let environment = &frame.scene.environment;
        if !self.fitted.is_of(environment) {
            self.fitted = self.settings.fitted(environment, self.tables.products);
        }
        if self.everywhere.is_none() && !frame.lights.is_empty() {
            self.everywhere = Some(self.settings.everywhere(self.tables.products));
        }
        let placed = placed_spheres(frame, &self.bodies);
        let origin = origin_of(placed.iter().map(|(center, _)| *center));
        let spheres = Spheres::about(origin, &placed);
        let near = frame.lights.iter().map(|light| Light::near(light, origin));
        let suns = environment.sun.iter().chain(self.fitted.lamps());
        let far = suns.map(|sun| Light::far(sun, frame.world_from_environment));
        let moment = self.moment.insert(Moment {
            origin,
            ball: spheres.ball(),
            spheres,
            lights: near.chain(far).collect(),
            surroundings: self.fitted.turned(frame.world_from_environment),
            everywhere: self.everywhere.as_ref().and_then(|fitted| fitted.turned(frame.world_from_environment)),
            eye_lobes: EyeLobes::new(frame),
        });
        let (settings, tables, counters) = (&self.settings, &self.tables, &self.counters);
        Ok(Box::new(FrameLobes { settings, tables, moment, counters }))
    }
}

/// A frame ready to be shaded.
struct FrameLobes<'a> {
    settings: &'a Settings,
    tables: &'a Tables,
    moment: &'a Moment,
    counters: &'a Counters,
}

impl Prepared for FrameLobes<'_> {
    fn shade(&self, receivers: Receivers<'_>, out: RadianceMut<'_>) {
        let mut shading = Shading::new(self.settings, self.tables, self.moment);
        shading.run(receivers, out);
        let counts = shading.counts;
        self.counters.products.fetch_add(counts.products[0], Relaxed);
        self.counters.left_out.fetch_add(counts.products[1], Relaxed);
        self.counters.masks.fetch_add(counts.masks, Relaxed);
        self.counters.lobes.fetch_add(counts.lobes, Relaxed);
    }
}
