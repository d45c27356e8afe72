//! The tests are tested: a strategy that breaks one clause must fail that clause, and an honest one none.

use super::*;
use crate::{Baked, Effects, Footprint, Info, Prepared, StrategyError};
use glam::Mat3;
use halfshade_scene::{Progress, RadianceMut, Receivers, Scene, light::DistantLight};
use std::sync::atomic::{AtomicU32, Ordering};

#[derive(Debug, Clone, Copy, PartialEq)]
enum Fault {
    None,
    Scaled,
    WorldBound,
    Brightens,
    BatchPosition,
    Counts,
    Remembers,
    NotANumber,
    ClaimsGloss,
    /// None: it looks at the other receivers, and says so.
    Filters,
    /// It looks at the other receivers without saying so.
    FiltersParts,
}

/// Light by midpoint rule over a few directions, each blocked if a sphere is in the way.
struct Toy(Fault);

struct State {
    fault: Fault,
    frames: u32,
    shades: AtomicU32,
    spheres: Vec<(Vec3, f32)>,
    light: Vec<(Vec3, Vec3)>,
    up: Vec3,
}

impl Strategy for Toy {
    fn info(&self) -> Info {
        let effects = Effects::of(&[Effect::EnvironmentLight, Effect::ColouredLight, Effect::Motion]);
        let effects = if self.0 == Fault::ClaimsGloss { effects.with(Effect::GlossyReflectance) } else { effects };
        Info { name: "toy", summary: "", source: "", parameters: Vec::new(), presets: &[], stages: &[], effects }
    }

    fn bake(&self, _: &Scene, _: &Params, _: &dyn Progress) -> Result<Box<dyn Baked>, StrategyError> {
        let (spheres, light) = (Vec::new(), Vec::new());
        Ok(Box::new(State { fault: self.0, frames: 0, shades: AtomicU32::new(0), spheres, light, up: Vec3::Y }))
    }
}

impl Baked for State {
    fn footprint(&self) -> Footprint {
        Footprint::default()
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
        self.frames += 1;
        self.spheres = frame.world_from_object[1..].iter().map(|pose| (pose.translation, pose.scale)).collect();
        let turn = Mat3::from_quat(frame.world_from_environment);
        self.up = if self.fault == Fault::WorldBound { Vec3::Y } else { turn * Vec3::Y };
        let environment = &frame.scene.environment;
        let (rows, columns) = (48, 96);
        self.light = (0..rows * columns)
            .map(|i| {
                let y = 1.0 - 2.0 * ((i / columns) as f32 + 0.5) / rows as f32;
                let (sin, cos) = (((i % columns) as f32 + 0.5) / columns as f32 * std::f32::consts::TAU).sin_cos();
                let across = (1.0 - y * y).sqrt();
                let direction = Vec3::new(across * sin, y, -across * cos);
                let base = match &environment.base {
                    DistantLight::Constant(radiance) => *radiance,
                    DistantLight::Map(map) => map.radiance(direction),
                };
                (turn * direction, base * (4.0 / (rows * columns) as f32))
            })
            .chain(environment.sun.map(|sun| (turn * sun.direction, sun.radiance * sun.angular_radius.sin().powi(2))))
            .collect();
        Ok(Box::new(&*self))
    }
}

impl Prepared for &State {
    fn batching(&self) -> Batching {
        if self.fault == Fault::Filters { Batching::WholeFrame } else { Batching::AnySplit }
    }

    fn shade(&self, receivers: Receivers<'_>, mut out: RadianceMut<'_>) {
        let shades = self.shades.fetch_add(1, Ordering::Relaxed);
        for i in 0..receivers.len() {
            let (position, normal) = (receivers.position_at(i), receivers.normal_at(i));
            let mut sum = Vec3::ZERO;
            for &(direction, radiance) in &self.light {
                let blocked = self.spheres.iter().any(|&(center, radius)| {
                    let offset = center - position;
                    let along = offset.dot(direction);
                    offset.length() > radius && along > 0.0 && (offset - along * direction).length() < radius
                });
                if !blocked {
                    sum += radiance * direction.dot(normal).max(0.0);
                }
            }
            let factor = match self.fault {
                Fault::Scaled => 1.02,
                Fault::WorldBound => 1.0 + 0.1 * normal.dot(self.up),
                Fault::Brightens => 1.0 + 0.05 * self.spheres.len() as f32,
                Fault::BatchPosition => 1.0 + 1e-6 * (i % 8) as f32,
                Fault::Remembers => 1.0 + 0.01 * self.frames as f32,
                Fault::Counts => 1.0 + 1e-6 * shades as f32,
                Fault::NotANumber if self.spheres.len() > 100 => f32::NAN,
                _ => 1.0,
            };
            out.set(i, receivers.albedo_at(i) * sum * factor);
        }
        if matches!(self.fault, Fault::Filters | Fault::FiltersParts) {
            for channel in out.channels.iter_mut().filter(|channel| channel.len() > 1) {
                let last = channel[channel.len() - 1];
                channel[0] = 0.999 * channel[0] + 0.001 * last;
            }
        }
    }
}

// The rotation's bound is that of a few thousand directions.
const BOUNDS: Bounds = Bounds { constant: 5e-3, quadrature: 0.015, gloss: 0.015, rotation: 0.05, brightening: 1e-5 };

type Clause = fn(&Toy, &Params) -> Checked;

const ANALYTIC: Clause = |toy, params| no_blocker_gives_the_analytic_answer(toy, params, &BOUNDS);
const GLOSS: Clause = |toy, params| gloss_is_modelled_or_refused(toy, params, &BOUNDS);
const ROTATION: Clause = |toy, params| rotating_everything_changes_nothing(toy, params, &BOUNDS);
const BRIGHTENING: Clause = |toy, params| adding_a_blocker_never_brightens(toy, params, &BOUNDS);
const SPLITTING: Clause = |toy, params| splitting_a_batch_changes_no_bit(toy, params);
const PREPARING: Clause = |toy, params| preparing_twice_equals_once(toy, params);
const FINITE: Clause = |toy, params| every_output_is_finite(toy, params);

#[test]
fn an_honest_strategy_passes() {
    for clause in [ANALYTIC, GLOSS, ROTATION, BRIGHTENING, SPLITTING, PREPARING, FINITE] {
        assert_eq!(clause(&Toy(Fault::None), &Params::default()), Ok(()));
    }
}

#[test]
fn who_asks_for_the_whole_frame_may_look_at_neighbours() {
    assert_eq!(SPLITTING(&Toy(Fault::Filters), &Params::default()), Ok(()));
}

#[test]
fn each_fault_is_found() {
    for (fault, clause) in [
        (Fault::Scaled, ANALYTIC),
        (Fault::ClaimsGloss, GLOSS),
        (Fault::WorldBound, ROTATION),
        (Fault::Brightens, BRIGHTENING),
        (Fault::BatchPosition, SPLITTING),
        (Fault::Counts, SPLITTING),
        (Fault::FiltersParts, SPLITTING),
        (Fault::Remembers, PREPARING),
        (Fault::NotANumber, FINITE),
    ] {
        assert!(clause(&Toy(fault), &Params::default()).is_err(), "{fault:?}");
    }
}
