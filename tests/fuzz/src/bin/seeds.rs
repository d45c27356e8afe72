//! Writes the seed corpora: `seeds FOLDER` makes `FOLDER/TARGET/NAME`.

use std::{io, path::Path};

fn main() -> io::Result<()> {
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
