//! Strategies on a graphics device: the contract, and the CPU beside it.
//!
//! Without a device all of these report themselves ignored; with `HALFSHADE_REQUIRE_GPU=1` that is a failure.

mod beside_the_cpu;
mod clocks;
mod few_receivers;
mod mask;
mod prt;
mod rays;
mod shadow_field;
mod surfaces;
mod twins;

use beside_the_cpu::SIZES;
use halfshade_gpu::{Choice, Gpu, strategies};
use halfshade_scene::Cache;
use halfshade_strategies::{Analytic, Mask, Prt, RayTraced, ShExp, ShadowField, Unshadowed};
use halfshade_strategy::{
    Params, Strategy,
    contract::{self, Bounds, Violation},
};
use libtest_mimic::{Arguments, Failed, Trial};
use std::{
    path::Path,
    process::ExitCode,
    sync::{Arc, LazyLock},
};

/// Settings of `sh-exp` that are only compared with the CPU, which is held to the contract.
const SH_EXP_BESIDE: [&str; 11] = [
    "bounces=0,exp=shares,points=5,normals=16,own-directions=16",
    "as-published",
    "bounces=0,levels=tree,rule=covering,normals=16,own-directions=16",
    "own=spheres,sun=projected,ground=ignored,normals=16,own-directions=16",
    "bounces=0,exp=hybrid,bands=6,normals=16,own-directions=16",
    "bounces=0,exp=hybrid,clamp=on,rule=published,window=hann,squaring=published,normals=16,own-directions=16",
    "bounces=0,exp=optimal-linear,bands=2,normals=16,own-directions=16",
    "bounces=0,exp=product,overlap=shared,normals=16,own-directions=16",
    "exp=series,intersections=precomputed,order=power,clamp=on,normals=16,own-directions=16",
    "exp=quadratic,walk=quadratic,reflection-exp=series,bands=3,ground=ignored,normals=16,own-directions=16",
    "exp=product,reflection-exp=optimal-linear,levels=cluster,normals=16,own-directions=16",
];

/// Settings of `ray-traced` that are compared with the CPU: by light and by cosine alone, and more samples than one dispatch
/// takes.
const RAYS: [&str; 8] = [
    "plain,samples=64",
    "plain,samples=16,sampling=light",
    "plain,samples=16,sampling=cosine",
    "unfiltered,samples=20,sampling=mis",
    "unfiltered,samples=1",
    "unfiltered,samples=70",
    "unfiltered,samples=5,estimator=plain",
    "",
];

/// Settings of `shadow-field` that are held to its contract, and those that are compared with the CPU beside them: every
/// number of bands, which cost seconds of compiling each.
const FIELDS: &str = "shells=8,resolution=8,map=32";
const MORE_FIELDS: [&str; 5] = [
    "shells=6,inner=1,resolution=8,map=16,bands=6",
    "shells=6,inner=1,resolution=8,map=16,bands=5,storage=f32,sampling=fixed",
    "shells=6,inner=1,resolution=8,map=16,bands=3,storage=f16,sampling=adaptive-shells",
    "shells=6,inner=1,resolution=8,map=16,bands=2,storage=f32,own=projected",
    "shells=6,inner=1,resolution=8,map=16,bands=1,threshold=0.1,inside=blocked",
];

/// Settings of `prt` that are compared with the CPU.
const TRANSFER: [&str; 5] = [
    "bands=8,directions=32",
    "bands=3,transfer=shadowed,directions=32",
    "bands=1,transfer=unshadowed",
    "directions=32,compression=cpca,clusters=20,components=5",
    "bands=3,directions=32,compression=vq,clusters=30",
];

/// Settings of `prt` of glossy scenes.
const GLOSSY_TRANSFER: [&str; 3] =
    ["bands=6,directions=32", "bands=3,transfer=shadowed,directions=32", "bands=1,transfer=unshadowed"];

/// Settings of `mask` beside its defaults that are compared with the CPU.
const MASKS: [&str; 2] = ["directions=100,own=spheres,rule=covering", "directions=256,normals=0,rule=published"];

/// Fields are traced once, however many tests ask for them: the folder is empty when the program starts.
static CACHE: LazyLock<Cache> = LazyLock::new(|| {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fields-gpu");
    let _ = std::fs::remove_dir_all(&folder);
    Cache::open(Some(folder))
});

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let choice: Choice = std::env::var("HALFSHADE_GPU").unwrap_or_default().parse().unwrap_or_default();
    let gpu = Gpu::open(&choice);
    let is_required = std::env::var_os("HALFSHADE_REQUIRE_GPU").is_some_and(|value| value == "1");
    let mut trials = vec![
        Trial::test("there_is_a_device", {
            let problem = gpu.as_ref().err().map(ToString::to_string);
            move || problem.map_or(Ok(()), |problem| Err(Failed::from(problem)))
        })
        .with_ignored_flag(!is_required),
    ];
    let gpu = gpu.ok().flatten();
    let on_device: Option<Arc<Strategies>> = gpu.as_ref().map(|gpu| Arc::new(strategies(gpu, &CACHE)));
    let mut add = |name: String, test: Box<dyn FnOnce(Arc<Strategies>) -> Result<(), Failed> + Send>| {
        let device = on_device.clone();
        let run = move || device.map_or(Ok(()), test);
        trials.push(Trial::test(name, run).with_ignored_flag(on_device.is_none()));
    };
    for (strategy, settings, bounds) in subjects() {
        for (clause, check) in CLAUSES {
            let test = move |strategies: Arc<Strategies>| {
                let subject = on(&strategies, strategy);
                let params = subject.info().parse(settings).map_err(|error| Failed::from(error.to_string()))?;
                check(subject, &params, &bounds).map_err(|violation| Failed::from(violation.to_string()))
            };
            add(format!("{strategy}({settings})::{clause}"), Box::new(test));
        }
    }
    // Extreme sizes with the settings of the contract: others have the same numbers to keep in range.
    let subjects = subjects().into_iter().map(|(strategy, settings, _)| (strategy, settings, &SIZES[..]));
    let others = RAYS.map(|settings| ("ray-traced", settings)).into_iter();
    let others = others.chain(SH_EXP_BESIDE.map(|settings| ("sh-exp", settings)));
    let others = others.chain(MORE_FIELDS.map(|settings| ("shadow-field", settings)));
    let others = others.chain(MASKS.map(|settings| ("mask", settings)));
    let others = others.chain(TRANSFER.map(|settings| ("prt", settings)));
    let others = others.map(|(strategy, settings)| (strategy, settings, &SIZES[..1]));
    for (strategy, settings, sizes) in subjects.chain(others) {
        add(
            format!("{strategy}({settings})::as_on_the_cpu"),
            Box::new(move |all| beside_the_cpu::compare(on(&all, strategy), cpu(strategy).as_ref(), settings, sizes)),
        );
    }
    for settings in rays::GLOSS {
        add(
            format!("ray-traced({settings})::shades_gloss_as_on_the_cpu"),
            Box::new(move |all| rays::shades_gloss([on(&all, "ray-traced"), cpu("ray-traced").as_ref()], settings)),
        );
    }
    for settings in MASKS.into_iter().chain([""]) {
        add(
            format!("mask({settings})::shades_gloss_as_on_the_cpu"),
            Box::new(move |all| mask::shades_gloss([on(&all, "mask"), cpu("mask").as_ref()], settings)),
        );
    }
    add(
        "ray-traced::passes_through_holes_as_on_the_cpu".to_owned(),
        Box::new(|all| rays::passes_through_holes([on(&all, "ray-traced"), cpu("ray-traced").as_ref()])),
    );
    for settings in [FIELDS, MORE_FIELDS[2], MORE_FIELDS[3]] {
        add(
            format!("shadow-field({settings})::between_vertices_as_on_the_cpu"),
            Box::new(move |all| {
                shadow_field::compare([on(&all, "shadow-field"), cpu("shadow-field").as_ref()], settings)
            }),
        );
    }
    for settings in TRANSFER {
        add(
            format!("prt({settings})::between_vertices_as_on_the_cpu"),
            Box::new(move |all| prt::compare([on(&all, "prt"), cpu("prt").as_ref()], settings)),
        );
    }
    for settings in GLOSSY_TRANSFER {
        add(
            format!("prt({settings})::shades_gloss_as_on_the_cpu"),
            Box::new(move |all| prt::shades_gloss([on(&all, "prt"), cpu("prt").as_ref()], settings)),
        );
    }
    add(
        "shadow-field::what_has_no_kernel_is_refused".to_owned(),
        Box::new(|all| shadow_field::refuses(on(&all, "shadow-field"))),
    );
    add(
        "shadow-field::memory_grows_as_on_the_cpu".to_owned(),
        Box::new(|all| shadow_field::fills_as_much_memory([on(&all, "shadow-field"), cpu("shadow-field").as_ref()])),
    );
    add("prt::local_lights_without_kernel_are_refused".to_owned(), Box::new(|all| prt::refuses(on(&all, "prt"))));
    add("clocks".to_owned(), Box::new(|all| clocks::compare(&all)));
    add("few_receivers".to_owned(), Box::new(|all| few_receivers::compare(&all)));
    for &(name, test) in twins::TESTS {
        let gpu = gpu.clone();
        let run = move || gpu.map_or(Ok(()), |gpu| test(&gpu));
        trials.push(Trial::test(format!("twins::{name}"), run).with_ignored_flag(on_device.is_none()));
    }
    libtest_mimic::run(&arguments, trials).exit_code()
}

fn subjects() -> Vec<(&'static str, &'static str, Bounds)> {
    let table = Bounds { constant: 1e-5, quadrature: 0.01, gloss: 0.01, rotation: 0.005, brightening: 0.0 };
    // Ringing of few bands under a sun: a blocker beside the sun may brighten its ray.
    let ringing = Bounds { brightening: 0.2, ..table };
    let mut subjects = vec![("unshadowed", "", table)];
    subjects.push(("sh-exp", "", ringing));
    // Four bands of everything, as on the CPU.
    let few_bands = Bounds { constant: 0.02, quadrature: 0.5, gloss: 3.0, rotation: 0.1, brightening: 0.2 };
    subjects.push(("shadow-field", FIELDS, few_bands));
    // Directions don't turn with the scene.
    let directions = Bounds { rotation: 0.15, brightening: 1e-4, gloss: 0.15, ..table };
    subjects.push(("mask", "", directions));
    let closed_forms = Bounds { brightening: 1e-5, ..table };
    subjects.extend(["", "own=spheres"].map(|settings| ("analytic", settings, closed_forms)));
    // Light of four bands, as on the CPU.
    let limited = Bounds { constant: 1e-5, quadrature: 0.5, gloss: 3.0, rotation: 1e-4, brightening: 1e-6 };
    subjects.push(("prt", "directions=16", limited));
    subjects
}

type Clause = fn(&dyn Strategy, &Params, &Bounds) -> Result<(), Violation>;

const CLAUSES: [(&str, Clause); 7] = [
    ("no_blocker_gives_the_analytic_answer", contract::no_blocker_gives_the_analytic_answer),
    ("gloss_is_modelled_or_refused", contract::gloss_is_modelled_or_refused),
    ("rotating_everything_changes_nothing", contract::rotating_everything_changes_nothing),
    ("adding_a_blocker_never_brightens", contract::adding_a_blocker_never_brightens),
    ("splitting_a_batch_changes_no_bit", |strategy, params, _| {
        contract::splitting_a_batch_changes_no_bit(strategy, params)
    }),
    ("preparing_twice_equals_once", |strategy, params, _| contract::preparing_twice_equals_once(strategy, params)),
    ("every_output_is_finite", |strategy, params, _| contract::every_output_is_finite(strategy, params)),
];

type Strategies = Vec<Box<dyn Strategy>>;

/// A strategy of the device.
fn on<'a>(strategies: &'a Strategies, name: &str) -> &'a dyn Strategy {
    let found = strategies.iter().find(|strategy| strategy.info().name == name);
    found.expect("a strategy that has kernels").as_ref()
}

/// The same on the processor.
fn cpu(name: &str) -> Box<dyn Strategy> {
    match name {
        "unshadowed" => Box::new(Unshadowed),
        "ray-traced" => Box::new(RayTraced),
        "mask" => Box::new(Mask),
        "analytic" => Box::new(Analytic),
        "prt" => Box::new(Prt::new(CACHE.clone())),
        "shadow-field" => Box::new(ShadowField::new(CACHE.clone())),
        _ => Box::new(ShExp),
    }
}
