#![no_main]
//! Writes the seed corpora: `seeds FOLDER` makes `FOLDER/TARGET/NAME`.
//!
//! A fuzz target in form, as everything here is instrumented, and only fuzz targets link what instrumented code calls.

use libfuzzer_sys::fuzz_target;
use std::{io, path::Path};

fuzz_target!(init: write_and_exit(), |_bytes: &[u8]| ());

fn write_and_exit() {
    write().expect("the folder can be written");
    std::process::exit(0);
}

fn write() -> io::Result<()> {
    let folder = std::env::args_os().nth(1).expect("usage: seeds FOLDER");
    for (target, inputs) in halfshade_fuzz::seeds::all() {
        let folder = Path::new(&folder).join(target);
        std::fs::create_dir_all(&folder)?;
        for (number, bytes) in inputs.iter().enumerate() {
            std::fs::write(folder.join(format!("seed-{number:02}")), bytes)?;
        }
    }
    Ok(())
}
