//! Entries of the table of kernels, and twins that several kernels are made of.

use crate::shader;

/// A kernel in WGSL and its twin on the CPU.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kernel {
    /// Name.
    pub name: &'static str,
    /// File in `shaders/`, with an entry point `main`.
    pub shader: &'static str,
    /// Files whose functions it is made of, each with its twin on the CPU.
    pub twins: &'static [Twin],
    /// Buffers that it reads and writes, group by group.
    pub buffers: &'static [&'static [&'static str]],
}

/// A WGSL file and the Rust whose numbers it gives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Twin {
    /// File in `shaders/`.
    pub shader: &'static str,
    /// The code on the CPU.
    pub cpu: &'static str,
    /// Largest difference, as a share of the largest value that the function takes.
    pub tolerance: f64,
    /// Why not less.
    pub reason: &'static str,
}

/// Work of the CPU that has no kernel on graphics hardware yet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Missing {
    /// The code on the CPU.
    pub cpu: &'static str,
    /// A way without it.
    pub instead: &'static str,
}

impl Kernel {
    /// Its whole WGSL; `bands` for kernels of SH vectors.
    pub fn code(&self, bands: Option<usize>) -> String {
        shader::module(self.shader, bands)
    }
}

pub(super) const RECEIVERS: &[&str] = &["places", "albedos", "placements", "radiances"];

pub(super) const TANGENT_PLANE: Twin = Twin {
    shader: "shared/tangent_plane.wgsl",
    cpu: "halfshade_strategies::shared::tangent_plane",
    tolerance: 2e-5,
    reason: "square roots next to the tangent plane magnify rounding",
};

pub(super) const OCTAHEDRAL: Twin = Twin {
    shader: "common/octahedral.wgsl",
    cpu: "halfshade_scene::light::OctahedralGrid::lookup_batch",
    tolerance: 2e-5,
    reason: "the place in a cell is a difference of numbers as large as the grid",
};

pub(super) const CAP: Twin = Twin {
    shader: "common/cap.wgsl",
    cpu: "halfshade_scene::light::cap_irradiance",
    tolerance: 1e-4,
    reason: "double precision on the CPU; atan2 may err by 4096 units in the last place",
};

pub(super) const REST_IRRADIANCE: Twin = Twin {
    shader: "shared/irradiance.wgsl",
    cpu: "halfshade_strategies::shared::irradiance",
    tolerance: 2e-5,
    reason: "that of the place in a cell",
};

pub(super) const PLACED_LAMPS: Twin = Twin {
    shader: "shared/placed_lamps.wgsl",
    cpu: "halfshade_strategies::shared::placed_lamps",
    tolerance: 1e-4,
    reason: "that of the cap",
};

pub(super) const REFLECTANCE: Twin = Twin {
    shader: "common/reflectance.wgsl",
    cpu: "halfshade_scene::Reflectance::lobes",
    tolerance: 1e-4,
    reason: "double precision on the CPU; a power magnifies by its exponent what log may err: 5e-7 next to 1",
};

pub(super) const EYE_LOBES: Twin = Twin {
    shader: "common/eye_lobes.wgsl",
    cpu: "halfshade_scene::EyeLobes",
    tolerance: 1e-4,
    reason: "that of the reflectance",
};

pub(super) const NEAR_ZERO: Twin = Twin {
    shader: "common/near_zero.wgsl",
    cpu: "f64::exp_m1 and f64::ln_1p",
    tolerance: 1e-6,
    reason: "rounding; exp and log may err by a few units in the last place",
};

pub(super) const LIGHT_CAP: Twin = Twin {
    shader: "shared/light_cap.wgsl",
    cpu: "halfshade_strategies::shared::light_cap",
    tolerance: 2e-5,
    reason: "a table on the CPU, its formula on the device",
};
