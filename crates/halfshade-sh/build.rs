//! Writes the straight-line f32 kernels (basis, lobe accumulation, product, square): in Rust for 1 to 8 bands, in WGSL for
//! 1 to 6.
//!
//! The tripling coefficients come from the same file that the f64 reference uses, so the two cannot drift apart.
//! Fully unrolled code is what lets a product run at a few hundred fused multiply-adds without an index in sight.

#[path = "build/generate.rs"]
mod generate;
#[path = "src/recurrence.rs"]
mod recurrence;
#[path = "src/tripling.rs"]
#[expect(dead_code, unreachable_pub, reason = "written for the library, which needs all of it")]
mod tripling;

use std::path::Path;

fn main() {
    for input in ["build.rs", "build/generate.rs", "src/recurrence.rs", "src/tripling.rs"] {
        println!("cargo::rerun-if-changed={input}");
    }
    let folder = std::env::var_os("OUT_DIR").expect("cargo sets OUT_DIR");
    let write = |name: &str, text: String| {
        let path = Path::new(&folder).join(name);
        std::fs::write(&path, text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    };
    write("kernels.rs", generate::rust(8));
    for bands in 1..=6 {
        write(&format!("sh_{bands}.wgsl"), generate::wgsl(bands));
        write(&format!("sh_rotation_{bands}.wgsl"), generate::wgsl_rotation(bands));
    }
}
