//! Soft shadows by summing the logarithms of spherical blockers in spherical harmonics, \[Ren2006\] as
//! [Guerrero2007, 3.5 and 4.2] describes it, with diffuse reflections [Guerrero2007, 4.3].
//!
//! Every object is a set of spheres. A receiver sees each sphere, after the rules for spheres that contain it or cut its
//! tangent plane, as a cap of some angular radius. The logarithm of the cap's blocker function is a zonal vector from a
//! table; turned to the sphere's direction and summed over all spheres, its exponential is the visibility V:
//!
//! ```text
//! V = exp(Σ log B_s)          L = albedo · L_ρ(n) · V
//! ```
//!
//! `exp=product` multiplies the blockers one after another instead (eq. 4.6), which the logarithm approximates.
//!
//! **Phases.** `bake`: tables, sphere hierarchies, receiver clusters, colours and sample points of spheres, own occlusion. `prepare`: places
//! of the spheres, light by normal, lamps, cuts through the hierarchies, radiance of the spheres; it ends in plain
//! data. `shade`: receivers in batches of eight, by the functions in `kernel`.
//!
//! **Hierarchy.** `levels=cluster` takes coarser spheres for objects that a cluster of receivers sees from afar, one level
//! of each object; `levels=tree` goes down the hierarchy sphere by sphere. The log blocker of a parent is
//! scaled band by band to the sum of its children's at the cluster's centre [Guerrero2007, eq. 4.8, 4.9].
//!
//! **Reflections.** In scenes that ask for bounces of light, the spheres that block also radiate what
//! the surface near them reflects. Light at sample points of the surface, times the surface's colours, is an SH vector r
//! on each sphere; a receiver adds up
//!
//! ```text
//! L = albedo · Σ_i L̃_i · ρ_n · (exp(S_i) - exp(S_i + log B_i))        S_i = Σ over nearer spheres of log B
//! ```
//!
//! with L̃_i the average of r_i over what it sees of the sphere, see [`halfshade_sh::form_factor`], and ρ_n the clamped
//! cosine over π. More bounces repeat the first pass with what the last one found. `bounces=0` leaves it at shadows.
//!
//! **As published** is a preset, `as-published`. The defaults depart from it where scenes came nearer to the truth at no more
//! cost (`results/thesis-frame-rates`, `results/soft-shadows`): rules for cut spheres and squaring without jumps, a magnitude
//! limit that falls with the bands, leaves instead of clusters, intersecting spheres taken in order instead of baking who covers
//! whom, spheres of one object that share what they cover together; and three things that spheres and few bands can't show.
//!
//! **Beyond the papers.** `own=baked` asks the mesh, once per vertex, what it hides from itself, in the place of the object's
//! own spheres, see `bake/own.rs`; objects that deform fall back on those. `sun=apart` takes suns and small bright parts of
//! a map out of the light and handles them by how much of their discs spheres cover, see `kernel/lamps.rs`; spherical lights,
//! which distant light can't stand for, are handled so in any case. `ground=seen` lets objects without spheres block and reflect,
//! see `prepare/ground.rs`. `exp=quadratic` replaces the optimal-linear form within the hybrid by the first two
//! powers of the series, see [`halfshade_sh::exponential::Method::Quadratic`]. `exp=shares` has no exponential: where k
//! spheres overlap as the receiver sees them, each is given 1/k of the direction, and V is 1 less the caps times their
//! shares, found at `points` points per sphere, see [`halfshade_sh::kernel::ExposedShares`]. `exp=traced` measures what no way to
//! combine blockers can do better, see `kernel/traced.rs`.
//!
//! **Bounds.** The exponential holds V to what a function with values in [0, 1] can be: `0 ≤ V_0 ≤ √4π` and
//! `|V|² ≤ √4π V_0`. What arrives directly is therefore finite and at most `|L_ρ(n)| √4π` in magnitude; for constant light
//! that is 1.64 times the unshadowed value. Lamps give between nothing and what they do unshadowed. What `ground=seen` takes of it and what spheres and ground reflect are products
//! with the same V, or differences of such, and come on top; what is taken is affine in the place and may be less than
//! nothing. Ringing is reported, not hidden, unless `clamp=on` holds what arrives directly, less what the ground takes,
//! between 0 and the unshadowed value, and every part that is reflected at 0 or more: with `bounces=0` radiance lies
//! between 0 and unshadowed, with more it isn't below 0. `tests/sh_exp/stability.rs` holds the method to all that.
//!
//! **Limits.** Few bands blur shadows: with `sun=projected` the sun's shadow is as wide as the last band. Of lamps, objects
//! without spheres hide nothing; one that surrounds receivers is constant light behind all spheres; and an object's own mesh
//! hides them from its vertices to 7 degrees. Products and exponentials multiply blockers as if band-limited functions were exact.
//! Spheres of one object that lie in each other would block a direction many times: `overlap=balanced` weights them by a
//! power of the share of the silhouette that is theirs, at no cost per receiver, so that denser sets err hardly more
//! (`results/spheres-vs-error`). Shares are those of far views, averaged: within or below thousands of spheres light comes
//! through. `exp=shares` asks every receiver instead, and costs more at few bands.
//!
//! **Continuity.** As published, the hybrid steps where |f̂| passes the magnitude limit times a power of two and it squares
//! once more. `squaring=continuous` blends that away, see [`halfshade_sh::exponential::Exponential::blended`], for one
//! squaring. Nothing steps then under `rule=continuous`. But where a sphere grows so large that an eigenvalue of its blocker
//! meets the clip, its logarithm is steep, and `optimal-linear` with it: that is the method's nature.
//!
//! **Magnitude limit.** \[Guerrero2007\] has none that depends on bands. One that doesn't makes the hybrid's error rise from
//! 6 bands on; with 8/bands² it falls. `ExponentialForm::default_magnitude_limit` says why.

pub mod arrays;
mod bake;
mod kernel;
mod prepare;
mod settings;
mod shade;

use bake::{Tables, own::OwnTables};
use halfshade_scene::{Frame, Progress, Scene, light::OctahedralGrid};
use halfshade_strategy::{Baked, Detail, Effect, Effects, Footprint, Info, Params, Prepared, Strategy, StrategyError};
use prepare::{FirstPass, frame::FrameData, ground::GroundView, light::FrameLight};
use settings::{PRESETS, STAGES, Settings, SmallLights};
use shade::Shader;

/// The strategy.
#[derive(Debug, Clone, Copy, Default)]
pub struct ShExp;

impl Strategy for ShExp {
    fn info(&self) -> Info {
        Info {
            name: "sh-exp",
            summary: "sum of log blockers of spheres in spherical harmonics, exponentiated",
            source: "[Guerrero2007, 4.2]",
            parameters: Settings::parameters(),
            presets: PRESETS,
            stages: STAGES,
            effects: Effects::of(&[
                Effect::EnvironmentLight,
                Effect::LocalLights,
                Effect::ColouredLight,
                Effect::Interreflection,
                Effect::Motion,
                Effect::Deformation,
            ]),
        }
    }

    fn bake(&self, scene: &Scene, params: &Params, progress: &dyn Progress) -> Result<Box<dyn Baked>, StrategyError> {
        Ok(Box::new(Self::bake_scene(scene, params, progress)?))
    }
}

impl ShExp {
    /// [`Strategy::bake`], for who reads the arrays of its frames.
    pub fn bake_scene(scene: &Scene, params: &Params, progress: &dyn Progress) -> Result<BakedScene, StrategyError> {
        let settings = Settings::read(params);
        let tables = Tables::new(scene, &settings, progress)?;
        let grid = OctahedralGrid::new(settings.normals);
        let most_lamps = (settings.small_lights == SmallLights::Apart).then_some(settings.lamps);
        let light = FrameLight::new(settings.bands, &scene.environment, grid, settings.window.into(), most_lamps);
        Ok(BakedScene { tables, data: FrameData::new(light) })
    }
}

/// Tables of the scene, and data of the last frame.
#[derive(Debug)]
pub struct BakedScene {
    tables: Tables,
    data: FrameData,
}

impl Baked for BakedScene {
    fn footprint(&self) -> Footprint {
        let Self { tables, data } = self;
        let reflections = tables.reflections.as_ref().map(|tables| tables.bytes() + data.radiance.bytes());
        Footprint {
            parts: vec![
                ("blockers by angular radius", tables.blockers.bytes()),
                ("light by normal", data.light.by_normal.bytes()),
                ("spheres", data.cuts.bytes() + tables.hierarchies.bytes()),
                ("reflections", reflections.unwrap_or(0)),
                ("own occlusion", tables.own.as_ref().map_or(0, OwnTables::bytes)),
                ("ground", data.ground.as_ref().map_or(0, GroundView::bytes)),
            ],
        }
    }

    fn details(&self) -> Vec<Detail> {
        let Some(own) = &self.tables.own else { return Vec::new() };
        let values: Vec<f64> = own.left_to_spheres().map(|object| object as f64).collect();
        let name =
            "objects that deform, whose spheres hide them from themselves (own=baked needs a rigid mesh)".to_owned();
        if values.is_empty() { Vec::new() } else { vec![Detail { name, values }] }
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
        self.prepare_frame(frame, FirstPass::Here)?;
        Ok(Box::new(Shader { tables: &self.tables, data: &self.data }))
    }
}
