//! Clauses that every strategy must keep, as functions that a test calls and a macro that makes one named test of each.
//!
//! The reference values come from quadrature over directions written here, so that no code is shared with what is tested.

mod bounds;
mod gloss;
mod render;
mod scenes;

use crate::{Batching, Effect, Params, Strategy};
use glam::{DVec3, Quat, Vec3};
use halfshade_scene::{Environment, Frame, RadianceBuffer, ReceiverBuffer, Sphere, light::Sun};
use std::f64::consts::{PI, TAU};

pub use bounds::{Bounds, Violation};
pub use gloss::gloss_is_modelled_or_refused;

use bounds::{Checked, violation};
use render::{baked, bounced, frame_of, lit, prepare, read_back, rendered, shade};

/// Unshadowed radiance of a white receiver by the midpoint rule over its hemisphere, suns and lamps apart.
fn unshadowed(frame: &Frame<'_>, position: Vec3, normal: Vec3) -> DVec3 {
    let mut base = frame.clone();
    let mut scene = frame.scene.clone();
    let sun = scene.environment.sun.take();
    base.scene = &scene;
    // Equal steps of sin² of the polar angle are equal steps of irradiance.
    let hemisphere = |f: &dyn Fn(Vec3) -> Vec3| -> DVec3 {
        let (rings, spokes) = (96, 192);
        let (t, b) = normal.any_orthonormal_pair();
        let mut sum = DVec3::ZERO;
        for ring in 0..rings {
            let sine_squared = (f64::from(ring) + 0.5) / f64::from(rings);
            let (sine, cosine) = (sine_squared.sqrt() as f32, (1.0 - sine_squared).sqrt() as f32);
            for spoke in 0..spokes {
                let turn = f64::from(spoke) / f64::from(spokes) + 0.618_033_988_75 * f64::from(ring);
                let (y, x) = (turn * TAU).sin_cos();
                sum += f(sine * (x as f32 * t + y as f32 * b) + cosine * normal).as_dvec3();
            }
        }
        sum / f64::from(rings * spokes)
    };
    let mut radiance = hemisphere(&|direction| base.environment_radiance(direction));
    if let Some(Sun { direction, angular_radius, radiance: bright }) = sun {
        radiance +=
            cap(frame.world_from_environment * direction, f64::from(angular_radius), normal) * bright.as_dvec3();
    }
    for light in &frame.lights {
        let offset = light.center - position;
        let radius = f64::from(light.radius / offset.length()).asin();
        radiance += cap(offset.normalize(), radius, normal) * light.radiance.as_dvec3();
    }
    radiance
}

/// Irradiance over π of a cap of radiance 1, by the midpoint rule.
fn cap(axis: Vec3, radius: f64, normal: Vec3) -> f64 {
    let (t, b) = axis.any_orthonormal_pair();
    let (rings, spokes) = (64, 64);
    let mut sum = 0.0;
    for ring in 0..rings {
        let polar = radius * (f64::from(ring) + 0.5) / f64::from(rings);
        for spoke in 0..spokes {
            let (y, x) = (TAU * f64::from(spoke) / f64::from(spokes)).sin_cos();
            let direction = polar.sin() * (x * t.as_dvec3() + y * b.as_dvec3()) + polar.cos() * axis.as_dvec3();
            sum += direction.dot(normal.as_dvec3()).max(0.0) * polar.sin();
        }
    }
    sum * radius / f64::from(rings) * TAU / f64::from(spokes) / PI
}

fn mean_unshadowed(frame: &Frame<'_>, receivers: &ReceiverBuffer) -> f32 {
    let view = receivers.view();
    let sum: DVec3 = (0..receivers.len())
        .map(|i| unshadowed(frame, view.position_at(i), view.normal_at(i)) * view.albedo_at(i).as_dvec3())
        .sum();
    (sum.element_sum() / (3 * receivers.len()) as f64) as f32
}

/// Nothing blocks: constant light gives albedo times radiance exactly; other light what quadrature gives.
pub fn no_blocker_gives_the_analytic_answer(strategy: &dyn Strategy, params: &Params, bounds: &Bounds) -> Checked {
    let effects = strategy.info().effects;
    let receivers = scenes::receivers(29);
    let colour = if effects.contains(Effect::ColouredLight) { Vec3::new(1.0, 0.6, 0.3) } else { Vec3::ONE };
    let mut cases = Vec::new();
    if effects.contains(Effect::EnvironmentLight) {
        cases.push((scenes::spheres(Environment::constant(colour), &[]), bounds.constant));
        cases.push((scenes::spheres(scenes::map(), &[]), bounds.quadrature));
        cases.push((scenes::spheres(scenes::sun(), &[]), bounds.quadrature));
        if effects.contains(Effect::ColouredLight) {
            cases.push((scenes::spheres(scenes::coloured_map(), &[]), bounds.quadrature));
        }
    }
    if effects.contains(Effect::LocalLights) {
        let mut scene = scenes::spheres(Environment::constant(Vec3::ZERO), &[]);
        scene.lights.push((scenes::lamp(), halfshade_scene::Motion::Still(halfshade_scene::Pose::IDENTITY)));
        cases.push((scene, bounds.quadrature));
    }
    for (case, (scene, bound)) in cases.iter().enumerate() {
        let frame = scene.frame(0);
        let found = rendered(strategy, params, scene, &receivers)?;
        let allowed = bound * mean_unshadowed(&frame, &receivers);
        let view = receivers.view();
        for i in 0..receivers.len() {
            let exact = unshadowed(&frame, view.position_at(i), view.normal_at(i)).as_vec3() * view.albedo_at(i);
            let error = (found.at(i) - exact).abs().max_element();
            if error.is_nan() || error > allowed {
                return violation(format!("light {case}, receiver {i}: {} instead of {exact}", found.at(i)));
            }
        }
    }
    Ok(())
}

/// Everything turned together looks the same.
pub fn rotating_everything_changes_nothing(strategy: &dyn Strategy, params: &Params, bounds: &Bounds) -> Checked {
    let spheres = scenes::crowd(6);
    let receivers = scenes::receivers(61);
    for environment in [scenes::map(), scenes::sun()] {
        let scene = lit(strategy, bounced(strategy, scenes::spheres(environment, &spheres)));
        let frame = scene.frame(0);
        let mut baked = baked(strategy, params, &scene)?;
        let straight = frame_of(baked.as_mut(), &frame, &receivers)?;
        let allowed = bounds.rotation * mean_unshadowed(&frame, &receivers);
        for turn in [Quat::from_rotation_y(2.0), Quat::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), 1.1)] {
            let (turned_frame, turned_receivers) = scenes::turned(&frame, &receivers, turn);
            let turned = frame_of(baked.as_mut(), &turned_frame, &turned_receivers)?;
            for i in 0..receivers.len() {
                let error = (turned.at(i) - straight.at(i)).abs().max_element();
                if error.is_nan() || error > allowed {
                    return violation(format!("receiver {i}: {} turned, {} before", turned.at(i), straight.at(i)));
                }
            }
        }
    }
    Ok(())
}

/// A blocker more never makes a receiver brighter.
pub fn adding_a_blocker_never_brightens(strategy: &dyn Strategy, params: &Params, bounds: &Bounds) -> Checked {
    let spheres = scenes::crowd(10);
    let receivers = scenes::receivers(61);
    for environment in [Environment::constant(Vec3::ONE), scenes::sun()] {
        let mut before: Option<RadianceBuffer> = None;
        let mut allowed = 0.0;
        for count in 0..=spheres.len() {
            let scene = lit(strategy, scenes::spheres(environment.clone(), &spheres[..count]));
            if count == 0 {
                allowed = bounds.brightening * mean_unshadowed(&scene.frame(0), &receivers);
            }
            let after = rendered(strategy, params, &scene, &receivers)?;
            for i in 0..receivers.len() {
                let rise = before.as_ref().map_or(0.0, |before| (after.at(i) - before.at(i)).max_element());
                if rise.is_nan() || rise > allowed {
                    return violation(format!("receiver {i} is brighter by {rise} behind blocker {count}"));
                }
            }
            before = Some(after);
        }
    }
    Ok(())
}

/// However the receivers are split, the bits are the same; for who takes the whole frame at once, however often it is shaded.
pub fn splitting_a_batch_changes_no_bit(strategy: &dyn Strategy, params: &Params) -> Checked {
    let scene = lit(strategy, bounced(strategy, scenes::spheres(scenes::sun(), &scenes::crowd(12))));
    let receivers = scenes::receivers(101);
    let mut baked = baked(strategy, params, &scene)?;
    let prepared = prepare(baked.as_mut(), &scene.frame(0), &receivers)?;
    let whole = shade(prepared.as_ref(), &receivers)?;
    let sizes: &[usize] = match prepared.batching() {
        Batching::AnySplit => &[1, 3, 7, 8, 9, 16, 64, 100],
        Batching::WholeFrame => &[101, 101],
    };
    for &size in sizes {
        let mut parts = RadianceBuffer::zeros(receivers.len());
        let mut rest = parts.view_mut();
        for start in (0..receivers.len()).step_by(size) {
            let end = (start + size).min(receivers.len());
            let (part, after) = rest.split_at(end - start);
            prepared.shade(receivers.view().slice(start..end), part);
            rest = after;
        }
        read_back(prepared.as_ref(), parts.view_mut())?;
        for (channel, values) in whole.channels.iter().enumerate() {
            let differs = values.iter().zip(&parts.channels[channel]).position(|(a, b)| a.to_bits() != b.to_bits());
            if let Some(i) = differs {
                return violation(format!("receiver {i} changes when batches have {size}"));
            }
        }
    }
    Ok(())
}

/// Preparing a frame twice, or another one in between, leaves no trace.
pub fn preparing_twice_equals_once(strategy: &dyn Strategy, params: &Params) -> Checked {
    let scene = lit(strategy, bounced(strategy, scenes::spheres(scenes::map(), &scenes::crowd(5))));
    let other_scene = lit(strategy, scenes::spheres(scenes::sun(), &scenes::crowd(5)));
    let receivers = scenes::receivers(33);
    let frame = scene.frame(0);
    let mut other = other_scene.frame(0);
    other.world_from_environment = Quat::from_rotation_x(0.5);
    other.world_from_object.iter_mut().for_each(|pose| pose.translation += Vec3::new(0.3, 0.2, -0.4));
    let mut baked = baked(strategy, params, &scene)?;
    let mut shaded = |frame| frame_of(baked.as_mut(), frame, &receivers);
    let once = shaded(&frame)?;
    if shaded(&frame)? != once {
        return violation("the same frame prepared twice differs".into());
    }
    let between = shaded(&other)?;
    if shaded(&frame)? != once {
        return violation("a frame differs after another one was prepared".into());
    }
    if between == once {
        return violation("other light and other poses made no difference".into());
    }
    Ok(())
}

/// A strategy that says it needs no sphere sets gives the same bits where none were built.
pub fn who_needs_no_spheres_reads_none(strategy: &dyn Strategy, params: &Params) -> Checked {
    if strategy.needs_spheres() {
        return Ok(());
    }
    let blockers = [(Vec3::new(0.0, 1.6, 0.0), 0.8), (Vec3::new(1.5, 1.0, 0.6), 0.5)];
    let scene =
        lit(strategy, scenes::spheres(scenes::map(), &blockers.map(|(center, radius)| Sphere { center, radius })));
    let receivers = ReceiverBuffer::vertices(&scene.frame(0));
    let built = rendered(strategy, params, &scene, &receivers)?;
    let mut unbuilt = scene.clone();
    unbuilt.objects.iter_mut().for_each(|object| object.spheres = None);
    if rendered(strategy, params, &unbuilt, &receivers)?.channels == built.channels {
        return Ok(());
    }
    violation("needs no spheres, it says, but answers otherwise without".into())
}

/// Nothing but finite numbers at the extremes: light from 1e-6 to 1e6; no blocker to hundreds, among them the same one
/// many times and some that enclose everything; receivers inside spheres, on their surface and next to it.
pub fn every_output_is_finite(strategy: &dyn Strategy, params: &Params) -> Checked {
    let ball = Sphere { center: Vec3::new(0.1, 0.9, 0.0), radius: 0.8 };
    let crowds: [Vec<Sphere>; 5] = [
        Vec::new(),
        vec![ball; 40],
        scenes::crowd(120),
        vec![Sphere { center: Vec3::ZERO, radius: 3.0 }, Sphere { center: Vec3::ZERO, radius: 1e-6 }],
        vec![Sphere { center: Vec3::new(0.0, 1e4, 0.0), radius: 9.9e3 }, Sphere { center: Vec3::X, radius: 1e-5 }],
    ];
    let mut receivers = scenes::receivers(40);
    for distance in [0.0, 0.5, 1.0 - 1e-7, 1.0, 1.0 + 1e-7, 1.1] {
        for direction in [Vec3::X, Vec3::Y, Vec3::NEG_Y, Vec3::new(0.6, 0.0, 0.8)] {
            let place = ball.center + distance * ball.radius * direction;
            for normal in [direction, -direction, Vec3::Y, Vec3::Z] {
                receivers.push(place, normal, Vec3::ONE, 0);
            }
        }
    }
    for spheres in &crowds {
        for strength in [1e-6, 1e6] {
            let mut environment = scenes::sun();
            environment.base = halfshade_scene::light::DistantLight::Constant(Vec3::splat(strength));
            if let Some(sun) = &mut environment.sun {
                sun.radiance *= strength;
            }
            let scene = lit(strategy, bounced(strategy, scenes::spheres(environment, spheres)));
            let out = rendered(strategy, params, &scene, &receivers)?;
            if let Some(i) = (0..receivers.len()).find(|&i| !out.at(i).is_finite()) {
                return violation(format!("{} under {strength}, {} spheres, receiver {i}", out.at(i), spheres.len()));
            }
        }
    }
    Ok(())
}

/// One named test per clause of the contract.
///
/// `contract_tests!(name, strategy, "key=value,..", bounds);` makes a module `name` of tests.
#[macro_export]
macro_rules! contract_tests {
    ($name:ident, $strategy:expr, $settings:expr, $bounds:expr) => {
        mod $name {
            use super::*;

            fn subject() -> (impl $crate::Strategy, $crate::Params) {
                let strategy = $strategy;
                let info = $crate::Strategy::info(&strategy);
                let params = info.parse($settings).expect("the test's own settings are valid");
                (strategy, params)
            }

            fn check(outcome: Result<(), $crate::contract::Violation>) {
                if let Err(violation) = outcome {
                    panic!("{violation}");
                }
            }

            #[test]
            fn no_blocker_gives_the_analytic_answer() {
                let (strategy, params) = subject();
                check($crate::contract::no_blocker_gives_the_analytic_answer(&strategy, &params, &$bounds));
            }

            #[test]
            fn gloss_is_modelled_or_refused() {
                let (strategy, params) = subject();
                check($crate::contract::gloss_is_modelled_or_refused(&strategy, &params, &$bounds));
            }

            #[test]
            fn rotating_everything_changes_nothing() {
                let (strategy, params) = subject();
                check($crate::contract::rotating_everything_changes_nothing(&strategy, &params, &$bounds));
            }

            #[test]
            fn adding_a_blocker_never_brightens() {
                let (strategy, params) = subject();
                check($crate::contract::adding_a_blocker_never_brightens(&strategy, &params, &$bounds));
            }

            #[test]
            fn splitting_a_batch_changes_no_bit() {
                let (strategy, params) = subject();
                check($crate::contract::splitting_a_batch_changes_no_bit(&strategy, &params));
            }

            #[test]
            fn preparing_twice_equals_once() {
                let (strategy, params) = subject();
                check($crate::contract::preparing_twice_equals_once(&strategy, &params));
            }

            #[test]
            fn who_needs_no_spheres_reads_none() {
                let (strategy, params) = subject();
                check($crate::contract::who_needs_no_spheres_reads_none(&strategy, &params));
            }

            #[test]
            fn every_output_is_finite() {
                let (strategy, params) = subject();
                check($crate::contract::every_output_is_finite(&strategy, &params));
            }
        }
    };
}

#[cfg(test)]
mod tests;
