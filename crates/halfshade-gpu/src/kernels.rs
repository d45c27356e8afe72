//! The table of kernels: which shader is the twin of which code, and how closely.

mod transfer;
mod twin;

pub use transfer::{PRT, PRT_CLUSTERS, PRT_LAMPS};
pub use twin::{Kernel, Missing, Twin};

use twin::{
    CAP, EYE_LOBES, LIGHT_CAP, NEAR_ZERO, OCTAHEDRAL, PLACED_LAMPS, RECEIVERS, REFLECTANCE, REST_IRRADIANCE,
    TANGENT_PLANE,
};

/// Light without visibility.
pub const UNSHADOWED: Kernel = Kernel {
    name: "unshadowed",
    shader: "unshadowed/shade.wgsl",
    twins: &[CAP, OCTAHEDRAL],
    buffers: &[RECEIVERS, &["frame", "lights", "table"]],
};

/// Shadow rays.
pub const RAY_TRACED: Kernel = Kernel {
    name: "ray-traced",
    shader: "ray_traced/shade.wgsl",
    twins: &[
        Twin {
            shader: "ray_traced/random.wgsl",
            cpu: "halfshade_strategies::ray_traced::shade::points",
            tolerance: 1e-7,
            reason: "24 bits of the same fixed-point numbers",
        },
        Twin {
            shader: "ray_traced/light.wgsl",
            cpu: "halfshade_strategies::ray_traced::prepare::light_sampler",
            tolerance: 1e-3,
            reason: "single precision next to the rim of a small sun",
        },
        Twin {
            shader: "ray_traced/traverse.wgsl",
            cpu: "halfshade_rays",
            tolerance: 1e-3,
            reason: "a ray that grazes an edge may be decided otherwise: a share of all rays",
        },
        Twin {
            shader: "ray_traced/cutout.wgsl",
            cpu: "halfshade_scene::Mesh::is_cut_out",
            tolerance: 1e-3,
            reason: "a ray that grazes the edge of a hole may be decided otherwise: a share of all rays",
        },
        Twin {
            shader: "ray_traced/irradiance.wgsl",
            cpu: "halfshade_strategies::shared::irradiance",
            tolerance: 1e-4,
            reason: "those of its parts",
        },
        CAP,
        OCTAHEDRAL,
        Twin {
            shader: "ray_traced/light_tree.wgsl",
            cpu: "halfshade_strategies::ray_traced::prepare::light_tree",
            tolerance: 1e-3,
            reason: "a number next to where a cell ends may be decided otherwise; cos and sin of the device",
        },
        Twin {
            shader: "ray_traced/product.wgsl",
            cpu: "halfshade_strategies::ray_traced::shade::product",
            tolerance: 1e-3,
            reason: "those of its parts",
        },
        Twin {
            shader: "ray_traced/sequence.wgsl",
            cpu: "halfshade_strategies::ray_traced::shade::sequence",
            tolerance: 0.0,
            reason: "whole numbers of 32 bits",
        },
        Twin {
            shader: "ray_traced/reflector.wgsl",
            cpu: "halfshade_strategies::ray_traced::shade::reflector",
            tolerance: 1e-4,
            reason: "that of the reflectance; rounding of directions next to the axis of a sharp lobe",
        },
        REFLECTANCE,
        EYE_LOBES,
        NEAR_ZERO,
    ],
    buffers: &[RECEIVERS, &["frame", "nodes", "triangles", "rows"], &["part"]],
};

/// Shares of the light that rays see, smoothed over neighbours.
pub const RAY_TRACED_FILTER: Kernel = Kernel {
    name: "ray-traced-filter",
    shader: "ray_traced/filter.wgsl",
    twins: &[Twin {
        shader: "ray_traced/stops.wgsl",
        cpu: "halfshade_strategies::ray_traced::shade::filter",
        tolerance: 1e-5,
        reason: "one less a cosine, in units of the largest turn",
    }],
    buffers: &[RECEIVERS, &["stops", "neighbours"]],
};

/// Shadows of `sh-exp`, and the second pass of its reflections.
pub const SH_EXP: Kernel = Kernel {
    name: "sh-exp",
    shader: "sh_exp/shade.wgsl",
    twins: &[
        TANGENT_PLANE,
        OCTAHEDRAL,
        CAP,
        Twin {
            shader: "sh_exp/blocker.wgsl",
            cpu: "halfshade_strategies::sh_exp::kernel::blocker",
            tolerance: 2e-5,
            reason: "that of the tangent plane",
        },
        Twin {
            shader: "sh_exp/log_sum.wgsl",
            cpu: "halfshade_strategies::sh_exp::kernel::log_sum",
            tolerance: 2e-5,
            reason: "that of the tangent plane",
        },
        Twin {
            shader: "sh_exp/exponential.wgsl",
            cpu: "halfshade_sh::kernel::BatchExponential",
            tolerance: 1e-4,
            reason: "every squaring doubles rounding, and there are ten for magnitudes of hundreds",
        },
        NEAR_ZERO,
        Twin {
            shader: "sh_exp/own.wgsl",
            cpu: "halfshade_strategies::sh_exp::kernel::own",
            tolerance: 1e-5,
            reason: "rounding of a rotation and a product",
        },
        Twin {
            shader: "sh_exp/product.wgsl",
            cpu: "halfshade_strategies::sh_exp::kernel::product",
            tolerance: 1e-5,
            reason: "rounding of hundreds of products in turn",
        },
        Twin {
            shader: "sh_exp/shares.wgsl",
            cpu: "halfshade_strategies::sh_exp::kernel::shares",
            tolerance: 2e-5,
            reason: "differences of unit directions, in units of the smallest cap",
        },
        Twin {
            shader: "sh_exp/lamps.wgsl",
            cpu: "halfshade_strategies::sh_exp::kernel::lamps",
            tolerance: 1e-3,
            reason: "differences of unit directions, in units of the distance of a small lamp's points",
        },
        Twin {
            shader: "sh_exp/light.wgsl",
            cpu: "halfshade_strategies::sh_exp::kernel::light",
            tolerance: 1e-4,
            reason: "those of its parts",
        },
        Twin {
            shader: "sh_exp/gather.wgsl",
            cpu: "halfshade_strategies::sh_exp::kernel::gather",
            tolerance: 1e-4,
            reason: "differences of exponentials; but where distances are the same, either sphere may come first",
        },
        Twin {
            shader: "sh_exp/ground.wgsl",
            cpu: "halfshade_strategies::sh_exp::kernel::ground",
            tolerance: 1e-5,
            reason: "rounding of a product",
        },
    ],
    buffers: &[RECEIVERS, &["frame", "blockers", "numbers", "tables", "radiating"]],
};

/// First pass of the reflections of `sh-exp`, after its shadows at sample points.
pub const SH_EXP_EMIT: Kernel = Kernel {
    name: "sh-exp-emit",
    shader: "sh_exp/emit.wgsl",
    twins: &[Twin {
        shader: "sh_exp/emit.wgsl",
        cpu: "halfshade_strategies::sh_exp::prepare::emitters",
        tolerance: 1e-5,
        reason: "sums in single precision",
    }],
    buffers: &[&["rounds", "emitters", "weights", "rotations", "light", "radiance"]],
};

/// Shadows of `shadow-field` in spherical harmonics.
pub const SHADOW_FIELD: Kernel = Kernel {
    name: "shadow-field",
    shader: "shadow_field/shade.wgsl",
    twins: &[
        REFLECTANCE,
        EYE_LOBES,
        NEAR_ZERO,
        Twin {
            shader: "shadow_field/shell_coordinates.wgsl",
            cpu: "halfshade_strategies::shadow_field::kernel::shell_coordinates",
            tolerance: 1e-6,
            reason: "rounding; next to a pole the arc cosine of the CPU loses half its digits, up to 4e-4",
        },
        Twin {
            shader: "shadow_field/shell_grid.wgsl",
            cpu: "halfshade_strategies::shadow_field::kernel::shell_grid",
            tolerance: 2e-5,
            reason: "the place in a cell is a difference of numbers as large as the grid",
        },
        Twin {
            shader: "shadow_field/reconstruct.wgsl",
            cpu: "halfshade_strategies::shadow_field::kernel::reconstruct",
            tolerance: 2e-5,
            reason: "that of the weights",
        },
        Twin {
            shader: "shadow_field/rotate.wgsl",
            cpu: "halfshade_strategies::shared::rotate",
            tolerance: 1e-6,
            reason: "rounding of eleven products",
        },
        Twin {
            shader: "shadow_field/occlusion.wgsl",
            cpu: "halfshade_strategies::shadow_field::shade::sh::occlusion",
            tolerance: 2e-5,
            reason: "those of its parts",
        },
        Twin {
            shader: "shadow_field/bounded_product.wgsl",
            cpu: "halfshade_strategies::shadow_field::kernel::bounded_product",
            tolerance: 5e-2,
            reason: "where nothing or all is hidden a sharp lobe is bound by the square root of rounding; elsewhere 1e-5",
        },
        Twin {
            shader: "shadow_field/light_order.wgsl",
            cpu: "halfshade_strategies::shadow_field::kernel::light_order",
            tolerance: 0.0,
            reason: "yes or no, but where both distances are the same",
        },
        Twin {
            shader: "shadow_field/light_product.wgsl",
            cpu: "halfshade_strategies::shadow_field::kernel::light_product",
            tolerance: 5e-6,
            reason: "sums in another order",
        },
        LIGHT_CAP,
        Twin {
            shader: "shared/cosine_power.wgsl",
            cpu: "halfshade_strategies::shared::cosine_power",
            tolerance: 1e-6,
            reason: "rounding",
        },
        Twin {
            shader: "shadow_field/gloss.wgsl",
            cpu: "halfshade_strategies::shadow_field::shade::sh::gloss",
            tolerance: 1e-4,
            reason: "that of the lobes",
        },
        Twin {
            shader: "shadow_field/frame.wgsl",
            cpu: "halfshade_strategies::shadow_field::prepare::frame",
            tolerance: 0.0,
            reason: "numbers are only read",
        },
    ],
    buffers: &[RECEIVERS, &["frame", "rows", "samples", "tables"]],
};

/// Directions that blockers close.
pub const MASK: Kernel = Kernel {
    name: "mask",
    shader: "mask/shade.wgsl",
    twins: &[
        TANGENT_PLANE,
        OCTAHEDRAL,
        CAP,
        REST_IRRADIANCE,
        PLACED_LAMPS,
        REFLECTANCE,
        EYE_LOBES,
        NEAR_ZERO,
        Twin {
            shader: "mask/bundle.wgsl",
            cpu: "halfshade_strategies::mask::kernel::bundle",
            tolerance: 1e-3,
            reason: "differences of unit directions over the width of an edge before a small lamp",
        },
        Twin {
            shader: "mask/lobe.wgsl",
            cpu: "halfshade_strategies::mask::kernel::lobe",
            tolerance: 1e-4,
            reason: "powers, as those of the reflectance",
        },
        Twin {
            shader: "mask/lobe_light.wgsl",
            cpu: "halfshade_strategies::mask::bake::lobe_light",
            tolerance: 1e-4,
            reason: "the place between levels is a logarithm",
        },
        Twin {
            shader: "mask/four.wgsl",
            cpu: "halfshade_strategies::shared::vector",
            tolerance: 1e-6,
            reason: "rounding",
        },
        Twin {
            shader: "mask/cap.wgsl",
            cpu: "halfshade_strategies::mask::kernel::cap",
            tolerance: 2e-5,
            reason: "that of the tangent plane",
        },
        Twin {
            shader: "mask/directions.wgsl",
            cpu: "halfshade_strategies::mask::kernel::directions",
            tolerance: 1e-4,
            reason: "differences of cosines over the width of an edge",
        },
        Twin {
            shader: "mask/own.wgsl",
            cpu: "halfshade_strategies::mask::kernel::own",
            tolerance: 1e-6,
            reason: "rounding of weights; a direction between two cells may be decided otherwise",
        },
        Twin {
            shader: "mask/boxes.wgsl",
            cpu: "halfshade_strategies::mask::kernel::boxes",
            tolerance: 0.0,
            reason: "yes or no, but where a direction grazes an edge",
        },
        Twin {
            shader: "mask/lamp.wgsl",
            cpu: "halfshade_strategies::mask::kernel::lamp",
            tolerance: 1e-3,
            reason: "differences of unit directions over the width of an edge before a small lamp",
        },
    ],
    buffers: &[RECEIVERS, &["frame", "rows", "tables", "cells"]],
};

/// Products of what spheres leave.
pub const ANALYTIC: Kernel = Kernel {
    name: "analytic",
    shader: "analytic/shade.wgsl",
    twins: &[
        OCTAHEDRAL,
        CAP,
        REST_IRRADIANCE,
        PLACED_LAMPS,
        Twin {
            shader: "analytic/overlap.wgsl",
            cpu: "halfshade_strategies::analytic::kernel::overlap",
            tolerance: 5e-4,
            reason: "sectors less triangles, differences of about the same areas",
        },
    ],
    buffers: &[RECEIVERS, &["frame", "rows", "tables"]],
};

/// All kernels.
pub const KERNELS: &[Kernel] = &[
    UNSHADOWED,
    RAY_TRACED,
    RAY_TRACED_FILTER,
    SH_EXP,
    SH_EXP_EMIT,
    SHADOW_FIELD,
    MASK,
    ANALYTIC,
    PRT,
    PRT_LAMPS,
    PRT_CLUSTERS,
];

/// All that has none.
pub const MISSING: &[Missing] = &[
    Missing { cpu: "halfshade_strategies::sh_exp::kernel::traced", instead: "exp=hybrid or device `cpu`" },
    Missing { cpu: "halfshade_strategies::shadow_field::shade::haar", instead: "basis=sh or device `cpu`" },
    Missing { cpu: "halfshade_strategies::shadow_field::shade::traced", instead: "sampling=adaptive or device `cpu`" },
    Missing {
        cpu: "halfshade_strategies::prt::kernel::lamps::between_points",
        instead: "lamp-steps=0 or device `cpu`",
    },
    Missing { cpu: "halfshade_strategies::prt::kernel::volume", instead: "moving=refuse or device `cpu`" },
    Missing { cpu: "halfshade_strategies::cosine_lobe", instead: "device `cpu`" },
];
