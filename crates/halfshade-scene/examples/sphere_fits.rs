//! Table of what sphere sets of a mesh hide wrongly, by count and fit, with the time that building them takes.
//!
//! `cargo run --release -p halfshade-scene --example sphere_fits -- MESH COUNT..`, where MESH is a file, or SCENE:NUMBER for the
//! mesh of an object of a built-in scene, or the name of a built-in shape.

#[path = "../tests/sphere_errors.rs"]
mod sphere_errors;

use halfshade_scene::{Mesh, SphereFit, SphereSet, builtin, mesh, progress::Silent, spheres::BuildOptions};
use sphere_errors::{SphereErrors, sphere_errors};
use std::{error::Error, io::Write, path::Path, time::Instant};

/// Rays for the sky and for each disc: with fewer their noise is as large as the errors of good fits.
const RAYS: usize = 2048;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().ok_or("name a mesh, then counts of spheres")?;
    let mesh = named(&name)?;
    let mut out = std::io::stdout();
    writeln!(out, "| spheres | fit | sky | disc | touching | own | outside | missing | gap | seconds |")?;
    writeln!(out, "| --: | :-- | --: | --: | --: | --: | --: | --: | --: | --: |")?;
    for count in arguments {
        let count: usize = count.parse()?;
        let mut shrunk = SphereSet::default();
        for fit in [SphereFit::Bounding, SphereFit::Shadow] {
            let clock = Instant::now();
            let set = SphereSet::build(&mesh, count, &BuildOptions { fit, ..BuildOptions::default() }, &Silent)?;
            let seconds = clock.elapsed().as_secs_f64();
            if fit == SphereFit::Bounding {
                shrunk.spheres.clone_from(&set.spheres);
                shrunk.spheres.iter_mut().for_each(|sphere| sphere.radius *= 0.88);
            }
            let SphereErrors { sky, disc, touching, own } = sphere_errors(&mesh, &set.spheres, RAYS);
            let SphereSet { outside_volume_fraction, missing_volume_fraction, bounding_violation, .. } = set;
            writeln!(
                out,
                "| {count} | {fit:?} | {sky:.4} | {disc:.4} | {touching:.4} | {own:.4} | {outside_volume_fraction:.3} | \
                 {missing_volume_fraction:.3} | {bounding_violation:.4} | {seconds:.1} |"
            )?;
        }
        let SphereErrors { sky, disc, touching, own } = sphere_errors(&mesh, &shrunk.spheres, RAYS);
        writeln!(
            out,
            "| {count} | Bounding, radii × 0.88 | {sky:.4} | {disc:.4} | {touching:.4} | {own:.4} | | | | |"
        )?;
    }
    Ok(())
}

fn named(name: &str) -> Result<Mesh, Box<dyn Error>> {
    if let Some(shape) = builtin::shape(name) {
        return Ok(shape);
    }
    let Some((scene, number)) =
        name.split_once(':').and_then(|(scene, number)| Some((builtin::scene(scene)?, number.parse::<usize>().ok()?)))
    else {
        return Ok(mesh::load(Path::new(name))?);
    };
    let object = scene.objects.get(number).ok_or("the scene has fewer objects")?;
    Ok((*object.mesh).clone())
}
