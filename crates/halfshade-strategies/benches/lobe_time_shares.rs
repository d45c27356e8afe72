//! Shares of time of the stages of cosine lobes, table 1 of [Meunier2009]: each stage is done twice in turn, and how much
//! longer shading takes is its share. Prints a table; one thread, all vertices.
//!
//! Published, in percent, for reflectance, light, mask, lobes of the mask, integrals:
//!
//! ```text
//! figure 14 (glossy-sphere)      29.6  15.5   0     0    54.9
//! figure 18 (two-squirrels)       0.3   0.2  82.7   6.1  10.7
//! figure 17 (rising-squirrel)   0.7 to 2.6   0.7 to 2.7   54 to 76.2   8.1 to 20.3   10.4 to 24.3
//! ```
//!
//! The claim: built from rows of bits, masks take less than 0.6 of the time where many spheres block, as opposed to the
//! published 0.83.

#![expect(clippy::print_stdout, reason = "its output is the table")]

use halfshade_scene::{Cache, RadianceBuffer, ReceiverBuffer, builtin, progress::Silent};
use halfshade_strategies::{CosineLobe, cosine_lobe::Stage};
use halfshade_strategy::Strategy;
use std::{
    hint::black_box,
    time::{Duration, Instant},
};

const SCENES: [(&str, &[usize]); 3] =
    [("glossy-sphere", &[0]), ("two-squirrels", &[0]), ("rising-squirrel", &[0, 50, 100])];
const WARM_UP: usize = 2;
const REPEATS: usize = 25;

fn main() {
    println!("| scene | frame | setting | reflectance | light | mask | lobes of the mask | integrals | ms |");
    println!("| --- | ---: | --- | ---: | ---: | ---: | ---: | ---: | ---: |");
    for (name, frames) in SCENES {
        let mut scene = builtin::scene(name).expect("built in");
        scene.build_spheres(&Cache::disabled(), &Silent).expect("spheres");
        for (&frame, settings) in frames.iter().flat_map(|frame| ["", "as-published"].map(|settings| (frame, settings)))
        {
            let params = CosineLobe.info().parse(settings).expect("valid settings");
            let once = CosineLobe.bake(&scene, &params, &Silent).expect("bakes");
            let repeating = Stage::ALL.map(|stage| CosineLobe.bake_repeating(stage, &scene, &params, &Silent));
            let mut baked: Vec<_> = std::iter::once(once).chain(repeating).collect();
            let at = scene.frame(frame);
            let receivers = ReceiverBuffer::vertices(&at);
            let mut out = RadianceBuffer::zeros(receivers.len());
            let prepared: Vec<_> = baked.iter_mut().map(|baked| baked.prepare(&at).expect("prepares")).collect();
            let mut times = vec![Vec::new(); prepared.len()];
            // All in turn, so that whatever else the machine does falls on all alike.
            for round in 0..WARM_UP + REPEATS {
                for (prepared, times) in prepared.iter().zip(&mut times) {
                    let start = Instant::now();
                    prepared.shade(black_box(receivers.view()), out.view_mut());
                    if round >= WARM_UP {
                        times.push(start.elapsed());
                    }
                }
            }
            let medians: Vec<f64> = times.iter_mut().map(|times| median(times).as_secs_f64()).collect();
            let shares: Vec<String> =
                medians[1..].iter().map(|twice| format!("{:.1} %", 100.0 * (twice / medians[0] - 1.0))).collect();
            let settings = if settings.is_empty() { "default" } else { settings };
            println!("| {name} | {frame} | {settings} | {} | {:.1} |", shares.join(" | "), 1e3 * medians[0]);
        }
    }
}

fn median(times: &mut [Duration]) -> Duration {
    times.sort_unstable();
    times[times.len() / 2]
}
