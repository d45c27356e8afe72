//! Table of what sphere sets of a mesh hide wrongly, by count and fit, with the time that building them takes.
//!
//! `cargo run --release -p halfshade-scene --example sphere_fits -- MESH COUNT..`

#[path = "../tests/sphere_errors.rs"]
mod sphere_errors;

use halfshade_scene::{SphereFit, SphereSet, mesh, progress::Silent, spheres::BuildOptions};
use sphere_errors::{SphereErrors, sphere_errors};
use std::{error::Error, io::Write, path::Path, time::Instant};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("name a mesh file, then counts of spheres")?;
    let mesh = mesh::load(Path::new(&path))?;
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
            let SphereErrors { sky, disc, touching, own } = sphere_errors(&mesh, &set.spheres);
            let SphereSet { outside_volume_fraction, missing_volume_fraction, bounding_violation, .. } = set;
            writeln!(
                out,
                "| {count} | {fit:?} | {sky:.4} | {disc:.4} | {touching:.4} | {own:.4} | {outside_volume_fraction:.3} | \
                 {missing_volume_fraction:.3} | {bounding_violation:.4} | {seconds:.1} |"
            )?;
        }
        let SphereErrors { sky, disc, touching, own } = sphere_errors(&mesh, &shrunk.spheres);
        writeln!(
            out,
            "| {count} | Bounding, radii × 0.88 | {sky:.4} | {disc:.4} | {touching:.4} | {own:.4} | | | | |"
        )?;
    }
    Ok(())
}
