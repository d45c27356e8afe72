//! `halfshade spheres`: a sphere set, and how well it fits.

use super::context::Context;
use crate::{
    cli::{FitChoice, SpheresArguments},
    failure::Failure,
    terminal,
};
use halfshade_harness::{
    clock::time_secs,
    output::{check_no_input, write_atomically},
    scene_source,
    sphere_fit::{disc_shadow_error, ground_shadow_errors, own_surface_error},
};
use halfshade_scene::{
    Progress, SphereFit, SphereSet, input,
    spheres::{AdjustRule, BuildOptions},
};
use serde_json::json;
use std::{process::ExitCode, sync::Arc};

pub(super) fn spheres(context: &Context, arguments: &SpheresArguments) -> Result<ExitCode, Failure> {
    if let Some(output) = &arguments.output {
        context.prepare_output(output)?;
    }
    let (mesh, inputs) = input::recorded(|| scene_source::load_mesh(&arguments.mesh));
    let (mesh, notes) = mesh?;
    if let Some(output) = &arguments.output {
        check_no_input(output, &inputs)?;
    }
    let mesh = Arc::new(mesh);
    // Not cached: its time is part of the answer.
    let fit = match arguments.fit {
        FitChoice::Bounding => SphereFit::Bounding,
        FitChoice::Shadow => SphereFit::Shadow,
    };
    let options = BuildOptions { fit, ..BuildOptions::default() };
    let (seconds, set) =
        time_secs(&context.clock, || SphereSet::build(&mesh, arguments.count, &options, &context.bars));
    let set = set.map_err(|error| error.in_file(&arguments.mesh))?;
    let rules = [AdjustRule::default(), AdjustRule::Continuous, AdjustRule::Covering, AdjustRule::Published];
    let errors = ground_shadow_errors(&mesh, &set, rules, &context.bars).map_or([None; 4], |errors| errors.map(Some));
    let [shadow, continuous, covering, published] = errors;
    let disc = disc_shadow_error(&mesh, &set, &context.bars);
    let own = own_surface_error(&mesh, &set, &context.bars);
    for note in notes.iter().chain(&set.notes) {
        context.bars.note(&format!("{}: {note}", arguments.mesh.display()));
    }
    if let Some(output) = &arguments.output {
        let spheres: Vec<_> = set
            .spheres
            .iter()
            .map(|sphere| json!({ "center": sphere.center.to_array(), "radius": sphere.radius }))
            .collect();
        let value = json!({
            "mesh": arguments.mesh.display().to_string(),
            "fit": set.fit,
            "outside_volume_fraction": set.outside_volume_fraction,
            "outside_volume_error": set.outside_volume_error,
            "missing_volume_fraction": set.missing_volume_fraction,
            "bounding_violation": set.bounding_violation,
            "growth": set.growth,
            "ground_shadow_error": shadow,
            "ground_shadow_error_by_rule": { "continuous": continuous, "covering": covering, "published": published },
            "disc_shadow_error": disc,
            "own_surface_error": own,
            "seconds": seconds,
            "spheres": spheres,
        });
        write_atomically(output, format!("{value:#}\n").as_bytes())?;
    }
    terminal::data(&format!(
        "spheres: {}\noutside_volume_fraction: {:.4} ± {:.4}\nmissing_volume_fraction: {:.4}\nbounding_violation: {}\ngrowth: {:.2e}\n\
         ground_shadow_error: {}\nground_shadow_error_by_rule: continuous {}, covering {}, published {}\n\
         disc_shadow_error: {}\nown_surface_error: {}\nseconds: {seconds:.2}\n",
        set.spheres.len(),
        set.outside_volume_fraction,
        set.outside_volume_error,
        set.missing_volume_fraction,
        set.bounding_violation,
        set.growth,
        figure(shadow),
        figure(continuous),
        figure(covering),
        figure(published),
        figure(disc),
        figure(own),
    ))?;
    Ok(ExitCode::SUCCESS)
}

fn figure(error: Option<f64>) -> String {
    error.map_or_else(|| "none".to_owned(), |error| format!("{error:.4}"))
}
