//! The machine that a measurement ran on.

use crate::{GraphicsDevice, results::Machine};

/// Processor, threads, the graphics device if one is used, and operating system.
pub fn describe(threads: usize, graphics: Option<&GraphicsDevice>) -> Machine {
    let gpu = graphics.map(|graphics| graphics.description.clone());
    Machine { cpu: cpu(), threads, gpu, os: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH) }
}

fn cpu() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    text.lines()
        .find_map(|line| line.strip_prefix("model name")?.split_once(':').map(|(_, name)| name.trim().to_owned()))
        .unwrap_or_else(|| std::env::consts::ARCH.to_owned())
}

/// Hash of the program that runs, or nothing if it can't be read: built anew from changed sources, even one of the same
/// commit may compute something else.
pub fn program_hash() -> String {
    let bytes = std::env::current_exe().and_then(std::fs::read);
    bytes.map(|bytes| blake3::hash(&bytes).to_hex().to_string()).unwrap_or_default()
}
