//! Soft shadows by summing the logarithms of spherical blockers in spherical harmonics, \[Ren2006\] as
//! [Guerrero2007, 3.5 and 4.2] describes it.
//!
//! Every object is a set of spheres. A receiver sees each sphere, after the rules for spheres that contain it or cut its
//! tangent plane, as a cap of some angular radius. The logarithm of the cap's blocker function is a zonal vector from a
//! table; turned to the sphere's direction and summed over all spheres, its exponential is the visibility V:
//!
//! ```text
//! V = exp(Σ log B_s)          L = albedo · L_ρ(n) · V
//! ```
//!
//! `exp=product` multiplies the blockers one after another instead (eq. 4.6), which is what the logarithm approximates.
//!
//! **Hierarchy.** `levels=cluster` takes coarser spheres for objects that a cluster of receivers sees from afar, one level
//! of each object; `levels=tree` goes down the hierarchy sphere by sphere. The log blocker of a parent is
//! scaled band by band to the sum of its children's at the cluster's centre [Guerrero2007, eq. 4.8, 4.9].
//!
//! **Reflections** [Guerrero2007, 4.3]. In scenes that ask for bounces of light, the spheres that block also radiate what
//! the surface near them reflects. Light at sample points of the surface, times the surface's colours, is an SH vector r
//! on each sphere; a receiver adds up
//!
//! ```text
//! L = albedo · Σ_i L̃_i · ρ_n · (exp(S_i) - exp(S_i + log B_i))        S_i = Σ over nearer spheres of log B
//! ```
//!
//! with L̃_i the average of r_i over what it sees of the sphere, see [`halfshade_sh::form_factor`], and ρ_n the clamped
//! cosine over π. As published: `intersections=precomputed,walk=quadratic,projection=product,form-factor=cosine`. The
//! default takes intersecting spheres in order instead of baking who covers whom, which brings the built-in scenes nearer
//! to the truth at less cost (`results/thesis-frame-rates`). More bounces repeat the first pass with what the last one
//! found. `bounces=0` leaves it at shadows. Objects without spheres neither block nor reflect, as published; with
//! `ground=seen` they do both for all others, see `ground`.
//!
//! `exp=traced` measures what no way to combine blockers can do better, see `traced`.
//!
//! Two variants of shadows go beyond the papers. `exp=quadratic` replaces the optimal-linear form within the hybrid by the first two
//! powers of the series, see [`halfshade_sh::exponential::Method::Quadratic`]. `exp=shares` has no exponential: where k
//! spheres overlap as the receiver sees them, each is given 1/k of the direction, and V is 1 minus the caps times their
//! shares, found at `points` points per sphere, see [`halfshade_sh::kernel::ExposedShares`].
//!
//! **Bounds.** The exponential holds V to what a function with values in [0, 1] can be: `0 ≤ V_0 ≤ √4π` and
//! `|V|² ≤ √4π V_0`. What arrives directly is therefore finite and at most `|L_ρ(n)| √4π` in magnitude; for constant light
//! that is 1.64 times the unshadowed value. What `ground=seen` takes of it and what spheres and ground reflect are products
//! with the same V, or differences of such, and come on top; what is taken is affine in the place and may be less than
//! nothing. Ringing is reported, not hidden, unless `clamp=on` holds what arrives directly, less what the ground takes,
//! between 0 and the unshadowed value, and every part that is reflected at 0 or more: with `bounces=0` radiance lies
//! between 0 and unshadowed, with more it isn't below 0. What the method leaves in practice is in the tests.
//!
//! **Limits.** Distant light only. Few bands blur shadows: the sun's shadow is as wide as the last band. Products and
//! exponentials multiply overlapping blockers as if band-limited functions were exact, which leaves dense sets too bright
//! or too dark: two thousand equal spheres overhead, which leave a quarter of a constant sky's light open, come out too
//! bright by up to 0.35 of the unshadowed, or black. Shares err by 0.01 there, and on a bunny of 64 spheres at 2 bands
//! by 0.016 where the hybrid errs by 0.21; they cost about 11 times the hybrid's time there (all 64 overlap), in the
//! built-in scenes 1.8 to 2.8 times at 4 bands and 0.4 to 0.7 times at 6 (`results/soft-shadows`).
//!
//! **Continuity.** As published, the hybrid steps where |f̂| passes the magnitude limit times a power of two and it squares
//! once more: by 0.01 of the unshadowed at 4 and 6 bands with limit 1 and by 0.04 at 8. `squaring=continuous` blends that
//! away, see [`Exponential::blended`], for one squaring. Nothing steps then under `rule=continuous`. But where a sphere
//! grows so large that an eigenvalue of its blocker meets the clip, its logarithm is steep: `optimal-linear` changes by
//! 0.06 over less than a thousandth of a sphere's width, which is the method's nature.
//!
//! **Magnitude limit.** \[Guerrero2007\] has none that depends on bands. One that doesn't makes the hybrid's error rise from
//! 6 bands on (limit 1, a bunny of 64 spheres under a constant sky against the same spheres: 0.028 at 4 bands, 0.052 at 6,
//! 0.098 at 8); with 8/bands² it falls: 0.026, 0.020, 0.019.

mod blockers;
mod clusters;
mod crossings;
mod cuts;
mod directions;
mod exposed;
mod ground;
mod levels;
mod light_product;
mod moment;
mod prepared;
mod reflections;
mod settings;
mod shade;
mod sun_product;
mod traced;

use cuts::{CutOf, CutSettings, Cuts};
use ground::Ground;
use halfshade_scene::{
    Frame, Progress, RadianceBuffer, RadianceMut, ReceiverBuffer, Receivers, Scene, light::OctahedralGrid,
};
use halfshade_sh::{
    blocker_table::{BlockerTable, Quantity},
    dispatch_bands,
    kernel::BatchExponential,
};
use halfshade_strategy::{
    Baked, Effect, Effects, Footprint, Info, Params, Prepared as PreparedFrame, Strategy, StrategyError,
};
use levels::Hierarchies;
use light_product::LightProduct;
use moment::Moment;
use prepared::{Combination, Prepared};
use reflections::Reflections;
use settings::{ExponentialForm, GroundMode, Levels, PRESETS, Ratios, Settings};
use std::sync::Arc;

/// The strategy.
#[derive(Debug, Clone, Copy, Default)]
pub struct ShExp;

const NO_LOCAL_LIGHTS: &str =
    "local lights: the spherical harmonics of an infinitely distant light don't describe a light at a finite distance";

const NO_REFLECTING_TREES: &str =
    "reflections from a cut through the tree: covering between spheres is baked for spheres of one level";

/// Sample points per unit of parallel work.
const SAMPLE_POINT_CHUNK: usize = 256;

impl Strategy for ShExp {
    fn info(&self) -> Info {
        Info {
            name: "sh-exp",
            summary: "sum of log blockers of spheres in spherical harmonics, exponentiated",
            source: "[Guerrero2007, 4.2]",
            parameters: Settings::parameters(),
            presets: PRESETS,
            effects: Effects::of(&[
                Effect::EnvironmentLight,
                Effect::ColouredLight,
                Effect::Interreflection,
                Effect::Motion,
                Effect::Deformation,
            ]),
        }
    }

    fn bake(&self, scene: &Scene, params: &Params, progress: &dyn Progress) -> Result<Box<dyn Baked>, StrategyError> {
        if !scene.lights.is_empty() {
            return Err(StrategyError::Unsupported(NO_LOCAL_LIGHTS.into()));
        }
        let settings = Settings::read(params);
        let bands = settings.bands;
        progress.start("tables of blockers and light", 2);
        let unsupported = || StrategyError::Failed(format!("{bands} bands: there are kernels for 1 to 8"));
        let build = |quantity| BlockerTable::build(bands, quantity).map(Arc::new).ok_or_else(unsupported);
        let exponential =
            |form, limit| BatchExponential::new(&settings.exponential(form, limit)).ok_or_else(unsupported);
        let logarithm = Quantity::Logarithm { clip: settings.clip };
        let quantity = settings.combination.exponential().map_or(Quantity::BlockerMinusOne, |_| logarithm);
        let combination = match settings.combination {
            settings::Combination::Product => Combination::Product,
            settings::Combination::Shares => Combination::Shares { points: settings.points },
            settings::Combination::Traced => Combination::Traced { directions: settings.directions },
            settings::Combination::Series
            | settings::Combination::OptimalLinear
            | settings::Combination::Hybrid
            | settings::Combination::Quadratic => {
                let form = settings.combination.exponential().unwrap_or(ExponentialForm::Hybrid);
                Combination::Exponential(exponential(form, settings.magnitude_limit)?)
            }
        };
        let table = build(quantity)?;
        let branching = (settings.levels != Levels::Leaves).then_some(settings.branching);
        let mut hierarchies = Hierarchies::new(scene, settings.overlap, branching);
        let bounces = scene.bounces.min(settings.bounces);
        let reflections = match bounces {
            0 => None,
            _ if settings.levels == Levels::Tree => {
                return Err(StrategyError::Unsupported(NO_REFLECTING_TREES.into()));
            }
            _ => {
                let exponential = exponential(settings.reflection_form, settings.reflection_limit)?;
                let table = if quantity == logarithm { table.clone() } else { build(logarithm)? };
                Some(Reflections::new(scene, &settings, bounces, exponential, table, &mut hierarchies))
            }
        };
        progress.advance(1);
        let light =
            LightProduct::new(bands, &scene.environment, OctahedralGrid::new(settings.normals), settings.window.into());
        progress.advance(1);
        Ok(Box::new(Prepared {
            bands,
            rule: settings.rule.into(),
            clamp: settings.clamp.is_on(),
            table,
            combination,
            light,
            levels: hierarchies,
            clusters: if settings.levels == Levels::Leaves { Vec::new() } else { clusters::clusters(scene) },
            cut_settings: CutSettings {
                choice: settings.levels,
                threshold_sine: settings.cut_angle.to_radians().sin(),
                ratios: settings.ratios != Ratios::Off,
                reflection_ratios: settings.ratios == Ratios::On,
                bands,
            },
            cuts: Cuts::default(),
            reflections,
            ground: (settings.ground == GroundMode::Seen)
                .then(|| Ground::new(scene, bands, settings.ground_directions))
                .flatten(),
            moment: None,
        }))
    }
}

impl Baked for Prepared {
    fn footprint(&self) -> Footprint {
        Footprint {
            parts: vec![
                ("blockers by angular radius", self.table.bytes()),
                ("light by normal", self.light.bytes()),
                ("spheres", self.cuts.bytes() + self.levels.bytes()),
                ("reflections", self.reflections.as_ref().map_or(0, Reflections::bytes)),
                ("ground", self.ground.as_ref().map_or(0, Ground::bytes)),
            ],
        }
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn PreparedFrame + '_>, StrategyError> {
        if !frame.lights.is_empty() {
            return Err(StrategyError::Unsupported(NO_LOCAL_LIGHTS.into()));
        }
        if self.moment.as_ref().is_some_and(|moment| moment.is(frame)) {
            return Ok(Box::new(&*self));
        }
        self.moment = None;
        self.light.set(&frame.scene.environment);
        let logs = match self.combination {
            Combination::Exponential(_) => Some(&*self.table),
            Combination::Product | Combination::Shares { .. } | Combination::Traced { .. } => None,
        };
        self.cuts = Cuts::new(frame, &mut self.levels, &self.clusters, logs, &self.cut_settings)?;
        if let Some(reflections) = &self.reflections
            && !reflections.fits(frame, &mut self.levels)
        {
            return Err(StrategyError::Failed("the frame is of another scene than reflections were baked for".into()));
        }
        if let Some(ground) = &mut self.ground {
            let rotation = frame.world_from_environment.as_dquat().normalize().conjugate();
            ground.look(frame, rotation, self.cuts.center);
        }
        self.reflect(frame);
        self.moment = Some(Moment::of(frame));
        Ok(Box::new(&*self))
    }
}

impl PreparedFrame for &Prepared {
    fn shade(&self, receivers: Receivers<'_>, out: RadianceMut<'_>) {
        self.shade_by(receivers, CutOf::Cluster, out);
    }
}

impl Prepared {
    /// The first pass: as many rounds as there are bounces, each lit by the spheres of the one before.
    fn reflect(&mut self, frame: &Frame<'_>) {
        let Some(reflections) = &mut self.reflections else { return };
        reflections.begin(frame, self.light.is_grey());
        let (points, bounces) = (std::mem::take(&mut reflections.points), reflections.bounces);
        let on_ground = self.ground.as_mut().map_or_else(ReceiverBuffer::default, |g| std::mem::take(&mut g.points));
        let mut light = RadianceBuffer::zeros(points.receivers.len());
        let mut from_ground = RadianceBuffer::zeros(on_ground.len());
        for _ in 0..bounces {
            self.shade_points(points.receivers.view(), Some(&points.emitters), light.view_mut());
            self.shade_points(on_ground.view(), None, from_ground.view_mut());
            if let Some(ground) = &mut self.ground {
                ground.shine(&from_ground);
            }
            if let Some(reflections) = &mut self.reflections {
                reflections.shine(frame, &light, &self.cuts.turns);
            }
        }
        if let Some(reflections) = &mut self.reflections {
            reflections.points = points;
        }
        if let Some(ground) = &mut self.ground {
            ground.points = on_ground;
        }
        if self.cut_settings.reflection_ratios && self.cuts.is_coarse() {
            let mut cuts = std::mem::take(&mut self.cuts);
            let _: Option<()> = dispatch_bands!(self.bands, N => shade::scale_reflections::<N>(self, &mut cuts));
            self.cuts = cuts;
        }
    }

    /// Shades sample points, in parallel; those of spheres by `emitters`.
    fn shade_points(&self, receivers: Receivers<'_>, emitters: Option<&[u32]>, out: RadianceMut<'_>) {
        let count = receivers.len();
        if count <= SAMPLE_POINT_CHUNK {
            return self.shade_by(receivers, emitters.map_or(CutOf::Cluster, CutOf::Emitter), out);
        }
        let middle = count / 2;
        let (left, right) = out.split_at(middle);
        rayon::join(
            || self.shade_points(receivers.slice(0..middle), emitters.map(|of| &of[..middle]), left),
            || self.shade_points(receivers.slice(middle..count), emitters.map(|of| &of[middle..]), right),
        );
    }

    fn shade_by(&self, receivers: Receivers<'_>, whose: CutOf<'_>, out: RadianceMut<'_>) {
        // `bake` made sure that there is a kernel for this number of bands.
        let _: Option<()> = dispatch_bands!(self.bands, N => shade::shade::<N>(self, receivers, whose, out));
    }
}
