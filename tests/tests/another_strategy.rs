//! A strategy added from outside, in a crate of its own: it is a folder, a line in the list of strategies and a line in the
//! contract. Nothing else knows of it, yet experiments run it beside all others.

use glam::{Mat3, Vec3};
use halfshade_harness::{Experiment, Results, clock::SystemClock, results::Status, run};
use halfshade_scene::{
    Cache, Frame, Progress, RadianceMut, Receivers, Scene, Sphere, light::DistantLight, progress::Silent,
};
use halfshade_strategy::{
    Baked, Effect, Effects, Footprint, Info, Params, Prepared, Strategy, StrategyError, contract::Bounds,
    contract_tests, settings,
};
use std::f32::consts::TAU;

settings! {
    /// Everything that can be set.
    struct Settings {
        /// rings of directions over the sphere
        "rings" => rings: usize = 48, in 1..=256;
    }
}

/// Light from a fixed set of directions, each blocked if a sphere is in the way.
struct FixedDirections;

struct Directions {
    directions: Vec<Vec3>,
}

/// The light of a frame by direction, and the spheres in world space.
struct FrameData {
    light: Vec<(Vec3, Vec3)>,
    spheres: Vec<Sphere>,
}

impl Strategy for FixedDirections {
    fn info(&self) -> Info {
        Info {
            name: "fixed-directions",
            summary: "light from a fixed set of directions",
            source: "",
            parameters: Settings::parameters(),
            presets: &[],
            stages: &[],
            effects: Effects::of(&[Effect::EnvironmentLight, Effect::ColouredLight, Effect::Motion]),
        }
    }

    fn bake(&self, _: &Scene, params: &Params, _: &dyn Progress) -> Result<Box<dyn Baked>, StrategyError> {
        let rings = Settings::read(params).rings;
        let direction = |ring: usize, spoke: usize| {
            let y = 1.0 - 2.0 * (ring as f32 + 0.5) / rings as f32;
            let (sin, cos) = ((spoke as f32 + 0.5) / (2 * rings) as f32 * TAU).sin_cos();
            Vec3::new((1.0 - y * y).sqrt() * sin, y, -(1.0 - y * y).sqrt() * cos)
        };
        let directions = (0..rings).flat_map(|ring| (0..2 * rings).map(move |spoke| direction(ring, spoke)));
        Ok(Box::new(Directions { directions: directions.collect() }))
    }
}

impl Baked for Directions {
    fn footprint(&self) -> Footprint {
        Footprint { parts: vec![("directions", size_of_val(self.directions.as_slice()))] }
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
        let turn = Mat3::from_quat(frame.world_from_environment);
        let environment = &frame.scene.environment;
        let part = 4.0 / self.directions.len() as f32;
        let distant = self.directions.iter().map(|&direction| {
            let radiance = match &environment.base {
                DistantLight::Constant(radiance) => *radiance,
                DistantLight::Map(map) => map.radiance(direction),
            };
            (turn * direction, part * radiance)
        });
        let sun = environment.sun.map(|sun| (turn * sun.direction, sun.radiance * sun.angular_radius.sin().powi(2)));
        let light = distant.chain(sun).collect();
        let spheres = frame.scene.objects.iter().zip(&frame.world_from_object).flat_map(|(object, pose)| {
            let spheres = object.spheres.iter().flat_map(|set| &set.spheres);
            spheres.map(|&Sphere { center, radius }| Sphere {
                center: pose.transform_point(center),
                radius: pose.scale * radius,
            })
        });
        Ok(Box::new(FrameData { light, spheres: spheres.collect() }))
    }
}

impl Prepared for FrameData {
    fn shade(&self, receivers: Receivers<'_>, mut out: RadianceMut<'_>) {
        for i in 0..receivers.len() {
            let (position, normal) = (receivers.position_at(i), receivers.normal_at(i));
            let blocks = |sphere: &Sphere, direction: Vec3| {
                let offset = sphere.center - position;
                let along = offset.dot(direction);
                offset.length() > sphere.radius && along > 0.0 && (offset - along * direction).length() < sphere.radius
            };
            let open = self.light.iter().filter(|(direction, _)| {
                direction.dot(normal) > 0.0 && !self.spheres.iter().any(|sphere| blocks(sphere, *direction))
            });
            let radiance: Vec3 = open.map(|&(direction, radiance)| radiance * direction.dot(normal)).sum();
            out.set(i, receivers.albedo_at(i) * radiance);
        }
    }
}

// The rotation's bound is that of a few thousand directions.
const BOUNDS: Bounds = Bounds { constant: 5e-3, quadrature: 0.015, gloss: 0.015, rotation: 0.05, brightening: 1e-5 };

contract_tests!(fixed_directions, FixedDirections, "", BOUNDS);

const EXPERIMENT: &str = r#"
name = "another"
claim = "a strategy from outside runs beside the others"
receivers = ["vertices"]
references = ["mesh"]

[truth]
samples = 256

[[scene]]
name = "scene.toml"

[[strategy]]
name = "unshadowed"

[[strategy]]
name = "fixed-directions"
rings = [2, 16]
"#;

const SCENE: &str = r#"
name = "ball over plane"
[[object]]
shape = "plane"
scale = 3
[[object]]
shape = "sphere"
spheres = 1
translate = [0, 1.2, 0]
[environment]
constant = [1, 1, 1]
[camera]
eye = [0, 2, 6]
target = [0, 0.5, 0]
vertical_fov_degrees = 40
resolution = [64, 48]
"#;

/// The program of such a crate is the command with one strategy more.
#[test]
fn the_command_runs_it_too() {
    let folder = tempfile::tempdir().unwrap();
    let (experiment, out) = (folder.path().join("another.toml"), folder.path().join("out"));
    std::fs::write(folder.path().join("scene.toml"), SCENE).unwrap();
    std::fs::write(&experiment, EXPERIMENT).unwrap();
    let words = ["halfshade".as_ref(), "run".as_ref(), experiment.as_os_str(), "--out".as_ref(), out.as_os_str()];
    let cache = ["--quick".as_ref(), "-q".as_ref(), "--cache".as_ref(), folder.path().as_os_str()];
    let arguments = words.into_iter().chain(cache).map(std::ffi::OsStr::to_os_string);
    let code = halfshade::main_with(arguments, |_| vec![Box::new(FixedDirections)]);
    assert_eq!(code, std::process::ExitCode::SUCCESS);
    let results = Results::load(&out).unwrap();
    assert!(results.runs.iter().any(|run| run.label == "fixed-directions:rings=16" && run.status == Status::Ok));
}

#[test]
fn an_experiment_runs_it_beside_the_others() {
    let cache = Cache::disabled();
    let mut strategies = halfshade::strategies(&cache);
    strategies.push(Box::new(FixedDirections));
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), SCENE).unwrap();
    let experiment = Experiment::parse(EXPERIMENT, &folder.path().join("another.toml")).unwrap();
    let tools = run::Tools {
        strategies: &strategies,
        graphics: None,
        band_limit: &|environment, _| environment.clone(),
        cache: &cache,
        progress: &Silent,
        clock: &SystemClock::start(),
        revision: "test",
    };
    let options = run::RunOptions { quick: true, ..run::RunOptions::default() };
    let results = run::run(&experiment, &tools, &options).unwrap();
    let error = |label: &str| {
        let run = results.runs.iter().find(|run| run.label == label).unwrap();
        assert_eq!(run.status, Status::Ok, "{label}: {:?}", run.reason);
        run.error.as_ref().unwrap().metrics.rel_rmse
    };
    let errors = ["fixed-directions:rings=16", "fixed-directions:rings=2", "unshadowed"].map(error);
    assert!(errors.is_sorted(), "{errors:?}");
}
