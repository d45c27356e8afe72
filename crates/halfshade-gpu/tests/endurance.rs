//! A thousand frames hold no more memory than the first few, on the device and off it.
//!
//! A program of its own: whatever else ran beside it would count.

use glam::Vec3;
use halfshade_gpu::{Choice, Gpu, strategies};
use halfshade_scene::{
    Cache, Environment, Object, Pose, RadianceBuffer, ReceiverBuffer, Scene, Sphere, SphereSet, builtin::shapes,
    progress::Silent,
};
use halfshade_strategy::StrategyError;
use libtest_mimic::{Arguments, Failed, Trial};
use std::{process::ExitCode, sync::Arc};

fn main() -> ExitCode {
    let choice: Choice = std::env::var("HALFSHADE_GPU").unwrap_or_default().parse().unwrap_or_default();
    let is_required = std::env::var_os("HALFSHADE_REQUIRE_GPU").is_some_and(|value| value == "1");
    let gpu = Gpu::open(&choice).map_err(|error| error.to_string());
    let is_ignored = !is_required && !matches!(gpu, Ok(Some(_)));
    let test = move || match gpu {
        Ok(Some(gpu)) => a_thousand_frames(&gpu),
        Ok(None) => Err("no device is wanted".into()),
        Err(problem) => Err(problem.into()),
    };
    let trial = Trial::test("a_thousand_frames_hold_no_more_than_the_first", test).with_ignored_flag(is_ignored);
    libtest_mimic::run(&Arguments::from_args(), vec![trial]).exit_code()
}

/// A turning ball over a ground, with one bounce of light.
fn scene() -> Scene {
    let set = SphereSet { spheres: vec![Sphere { center: Vec3::ZERO, radius: 1.0 }], ..SphereSet::default() };
    let ball = Object::new("ball", shapes::sphere(3))
        .spheres(Arc::new(set))
        .pose(Pose { translation: Vec3::Y, ..Pose::IDENTITY });
    let objects = vec![Object::new("ground", shapes::plane(2)), ball];
    let environment = Environment::constant(Vec3::ONE);
    Scene {
        bounces: 1,
        frame_count: 1000,
        environment_turn_per_sec: 0.1,
        ..Scene::at_rest("endurance", objects, environment)
    }
}

/// Bytes that the process holds in memory, where the system tells.
fn resident_bytes() -> Option<usize> {
    let pages = std::fs::read_to_string("/proc/self/statm").ok()?;
    Some(4096 * pages.split_whitespace().nth(1)?.parse::<usize>().ok()?)
}

/// Mesa's driver in software keeps 300 KB of every dispatch into which it has compiled numbers of a uniform (22.3.6).
fn a_thousand_frames(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let strategies = strategies(gpu, &Cache::disabled());
    let scene = scene();
    let receivers = ReceiverBuffer::vertices(&scene.frame(0));
    let mut out = RadianceBuffer::zeros(receivers.len());
    let field = "shells=6,inner=1,resolution=8,map=16,bands=2";
    for (name, settings) in [("unshadowed", ""), ("ray-traced", "samples=1"), ("sh-exp", ""), ("shadow-field", field)] {
        let told = |error: StrategyError| Failed::from(format!("{name}: {error}"));
        let strategy = strategies.iter().find(|strategy| strategy.info().name == name).ok_or("no such strategy")?;
        let params = strategy.info().parse(settings).map_err(|error| Failed::from(error.to_string()))?;
        let mut baked = strategy.bake(&scene, &params, &Silent).map_err(told)?;
        baked.place_receivers(&scene.frame(0), receivers.view()).map_err(told)?;
        let mut held = None;
        for number in 0..scene.frame_count {
            let prepared = baked.prepare(&scene.frame(number)).map_err(told)?;
            prepared.shade(receivers.view(), out.view_mut());
            prepared.read_back(out.view_mut()).map_err(told)?;
            drop(prepared);
            if number == scene.frame_count / 4 {
                held = Some(([gpu.held_bytes(), gpu.live_objects() as u64], resident_bytes()));
            }
        }
        let Some((before, resident)) = held else { return Err("no frames".into()) };
        let now = [gpu.held_bytes(), gpu.live_objects() as u64];
        if now != before {
            return Err(format!("{name}: bytes and objects on the device are {now:?}, and were {before:?}").into());
        }
        if let Some((before, now)) = resident.zip(resident_bytes()) {
            // A leak of a bind group per frame would be a hundred times as much.
            let grown = now.saturating_sub(before);
            if grown > 4 << 20 {
                return Err(format!("{name}: the process has grown by {grown} bytes").into());
            }
        }
    }
    Ok(())
}
