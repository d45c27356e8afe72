//! Shaders without a device: every kernel is parsed and validated, and its structs lie as those of the Rust that fills them.

use crate::{
    analytic, hierarchy::Node, kernels::KERNELS, mask, prt, ray_traced, receivers, sh_exp, shader, shadow_field,
    unshadowed,
};
use halfshade_sh::wgsl::MAX_WGSL_BANDS;
use naga::{
    Module, TypeInner,
    valid::{Capabilities, ModuleInfo, ValidationFlags, Validator},
};

/// A module that is right as far as naga can see.
fn valid(name: &str, code: &str) -> (Module, ModuleInfo) {
    let module =
        naga::front::wgsl::parse_str(code).unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(code)));
    // Half precision that is read as single precision is in every WebGPU.
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::SHADER_FLOAT16_IN_FLOAT32);
    let info = validator.validate(&module).unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(code)));
    (module, info)
}

/// Bytes of a struct, and the offsets of its members.
fn layout(module: &Module, name: &str) -> (usize, Vec<usize>) {
    let found = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name)).map(|(_, ty)| &ty.inner);
    let Some(TypeInner::Struct { members, span }) = found else { panic!("no struct `{name}`") };
    (*span as usize, members.iter().map(|member| member.offset as usize).collect())
}

#[test]
fn every_kernel_is_valid_for_every_number_of_bands() {
    for kernel in KERNELS {
        for bands in 1..=MAX_WGSL_BANDS {
            let name = format!("{} at {bands} bands", kernel.name);
            let (module, _) = valid(&name, &shader::module(kernel.shader, Some(bands)));
            assert_eq!(module.entry_points.len(), 1, "{name}");
            assert_eq!(module.entry_points[0].workgroup_size, [crate::pipeline::WORKGROUP, 1, 1], "{name}");
        }
    }
}

/// The buffers that the table names are those of the shader, in its order; and no more than WebGPU binds by default.
#[test]
fn the_table_names_the_buffers_of_each_shader() {
    for kernel in KERNELS {
        let (module, _) = valid(kernel.name, &shader::module(kernel.shader, Some(4)));
        let mut found: Vec<(u32, u32, &str)> = (module.global_variables.iter())
            .filter_map(|(_, global)| Some((global.binding?.group, global.binding?.binding, global.name.as_deref()?)))
            .collect();
        found.sort_unstable();
        let named = kernel
            .buffers
            .iter()
            .zip(0..)
            .flat_map(|(names, group)| names.iter().zip(0..).map(move |(name, binding)| (group, binding, *name)));
        assert_eq!(found, named.collect::<Vec<_>>(), "{}", kernel.name);
        let storage = module
            .global_variables
            .iter()
            .filter(|(_, global)| matches!(global.space, naga::AddressSpace::Storage { .. }));
        assert!(storage.count() <= 8, "{}", kernel.name);
    }
}

/// Files whose functions only read what the processor wrote.
const UNTWINNED: [&str; 2] = ["common/receivers.wgsl", "sh_exp/frame.wgsl"];

/// Every file that a kernel is made of and that has functions is in its list of twins.
#[test]
fn every_file_of_functions_has_its_twin() {
    for kernel in KERNELS {
        let code = shader::module(kernel.shader, None);
        for (path, text) in shader::SOURCES {
            if UNTWINNED.contains(path) || KERNELS.iter().any(|other| other.shader == *path) {
                continue;
            }
            let last_function = text.lines().rev().find(|line| line.starts_with("fn "));
            let is_part = last_function.is_some_and(|line| code.contains(line));
            let is_listed = kernel.twins.iter().any(|twin| twin.shader == *path);
            assert_eq!(is_part, is_listed, "{}: {path}", kernel.name);
        }
    }
}

#[test]
fn structs_lie_in_rust_as_in_wgsl() {
    use std::mem::offset_of;
    let (module, _) = valid("sh-exp", &shader::module("sh_exp/shade.wgsl", Some(4)));
    type Blocker = sh_exp::frame::DeviceBlocker;
    let factors = offset_of!(Blocker, factors);
    let blocker = vec![
        offset_of!(Blocker, center),
        offset_of!(Blocker, radius),
        factors,
        factors + 16,
        offset_of!(Blocker, emitter),
        offset_of!(Blocker, reflection_factor),
        offset_of!(Blocker, padding),
    ];
    assert_eq!(layout(&module, "Blocker"), (size_of::<Blocker>(), blocker));
    type Linear = sh_exp::tables::LinearTable;
    let linear = vec![
        offset_of!(Linear, row),
        offset_of!(Linear, last),
        offset_of!(Linear, limit),
        offset_of!(Linear, per_magnitude),
    ];
    assert_eq!(layout(&module, "LinearTable"), (size_of::<Linear>(), linear));
    type Frame = sh_exp::tables::FrameUniforms;
    let (cosine, reflectance) = (offset_of!(Frame, cosine), offset_of!(Frame, reflectance));
    let others = [
        offset_of!(Frame, light),
        offset_of!(Frame, sun_direction),
        offset_of!(Frame, sun_perpendicular),
        offset_of!(Frame, shadow_table),
        offset_of!(Frame, reflection_table),
        offset_of!(Frame, light_table),
        offset_of!(Frame, sun_table),
        offset_of!(Frame, log_table),
        offset_of!(Frame, form_table),
        offset_of!(Frame, grid_cells),
        offset_of!(Frame, masks),
        offset_of!(Frame, ground),
        offset_of!(Frame, fan),
        offset_of!(Frame, share_space),
        offset_of!(Frame, own_receivers),
        offset_of!(Frame, own_rotations),
        offset_of!(Frame, own_spheres),
        offset_of!(Frame, lamps),
        offset_of!(Frame, lamp_fan),
        offset_of!(Frame, mean_normals),
        offset_of!(Frame, padding),
    ];
    let cosines = [cosine, cosine + 16, reflectance, reflectance + 16];
    assert_eq!(layout(&module, "Frame"), (size_of::<Frame>(), [&cosines[..], &others[..]].concat()));
    type Placement = receivers::Placement;
    let placement = vec![offset_of!(Placement, position), offset_of!(Placement, direction)];
    assert_eq!(layout(&module, "Placement"), (size_of::<Placement>(), placement));
    type Place = receivers::Place;
    let place = vec![
        offset_of!(Place, position),
        offset_of!(Place, object),
        offset_of!(Place, normal),
        offset_of!(Place, group),
    ];
    assert_eq!(layout(&module, "Place"), (size_of::<Place>(), place));

    let (module, _) = valid("sh-exp-emit", &shader::module("sh_exp/emit.wgsl", Some(4)));
    type Emitter = sh_exp::first_pass::Emitter;
    let emitter = vec![
        offset_of!(Emitter, first_sample),
        offset_of!(Emitter, samples),
        offset_of!(Emitter, weights),
        offset_of!(Emitter, rotation),
    ];
    assert_eq!(layout(&module, "Emitter"), (size_of::<Emitter>(), emitter));
    type Rounds = sh_exp::first_pass::Rounds;
    let rounds = vec![
        offset_of!(Rounds, channels),
        offset_of!(Rounds, surface_channels),
        offset_of!(Rounds, used),
        offset_of!(Rounds, samples),
    ];
    assert_eq!(layout(&module, "Rounds"), (size_of::<Rounds>(), rounds));

    let (module, _) = valid("ray-traced", &shader::module("ray_traced/shade.wgsl", None));
    let node = vec![
        offset_of!(Node, left_low),
        offset_of!(Node, left),
        offset_of!(Node, left_high),
        offset_of!(Node, right),
        offset_of!(Node, right_low),
        offset_of!(Node, padding),
        offset_of!(Node, right_high),
        offset_of!(Node, more_padding),
    ];
    assert_eq!(layout(&module, "Node"), (size_of::<Node>(), node));
    type Triangle = ray_traced::meshes::DeviceTriangle;
    let triangle = vec![
        offset_of!(Triangle, a),
        offset_of!(Triangle, holes),
        offset_of!(Triangle, b),
        offset_of!(Triangle, padding),
        offset_of!(Triangle, c),
        offset_of!(Triangle, more_padding),
    ];
    assert_eq!(layout(&module, "Triangle"), (size_of::<Triangle>(), triangle));
    type Rays = ray_traced::frame::FrameUniforms;
    let rays = vec![
        offset_of!(Rays, environment),
        offset_of!(Rays, constant),
        offset_of!(Rays, sun),
        offset_of!(Rays, sun_radiance),
        offset_of!(Rays, eye),
        offset_of!(Rays, plane_steps),
        offset_of!(Rays, space_steps),
        offset_of!(Rays, space_last_step),
        offset_of!(Rays, samples),
        offset_of!(Rays, cosine_share),
        offset_of!(Rays, base_power),
        offset_of!(Rays, sun_power),
        offset_of!(Rays, map_width),
        offset_of!(Rays, map_height),
        offset_of!(Rays, instances),
        offset_of!(Rays, instance_count),
        offset_of!(Rays, lights),
        offset_of!(Rays, light_count),
        offset_of!(Rays, tables),
        offset_of!(Rays, texels),
        offset_of!(Rays, aliases),
        offset_of!(Rays, irradiances),
        offset_of!(Rays, grid_cells),
        offset_of!(Rays, levels),
        offset_of!(Rays, level_count),
        offset_of!(Rays, solid_angles),
        offset_of!(Rays, sums),
        offset_of!(Rays, largest),
        offset_of!(Rays, largest) + 4,
        offset_of!(Rays, normal_cells),
        offset_of!(Rays, order),
        offset_of!(Rays, padding),
        offset_of!(Rays, padding) + 4,
        offset_of!(Rays, padding) + 8,
    ];
    assert_eq!(layout(&module, "Frame"), (size_of::<Rays>(), rays));

    let (module, _) = valid("ray-traced-filter", &shader::module("ray_traced/filter.wgsl", None));
    type Stops = ray_traced::filter::DeviceStops;
    let stops = vec![
        offset_of!(Stops, turn),
        offset_of!(Stops, deviations_squared),
        offset_of!(Stops, variance),
        offset_of!(Stops, stage),
        offset_of!(Stops, is_last),
        offset_of!(Stops, padding),
        offset_of!(Stops, padding) + 4,
        offset_of!(Stops, padding) + 8,
    ];
    assert_eq!(layout(&module, "Stops"), (size_of::<Stops>(), stops));

    let (module, _) = valid("unshadowed", &shader::module("unshadowed/shade.wgsl", None));
    type Light = unshadowed::DeviceLight;
    let light = vec![offset_of!(Light, sphere), offset_of!(Light, radiance)];
    assert_eq!(layout(&module, "Light"), (size_of::<Light>(), light));
    type Plain = unshadowed::FrameUniforms;
    let plain = vec![
        offset_of!(Plain, constant),
        offset_of!(Plain, sun_direction),
        offset_of!(Plain, sun_radiance),
        offset_of!(Plain, light_count),
        offset_of!(Plain, is_tabulated),
        offset_of!(Plain, grid_cells),
        offset_of!(Plain, padding),
    ];
    assert_eq!(layout(&module, "Frame"), (size_of::<Plain>(), plain));

    let (module, _) = valid("shadow-field", &shader::module("shadow_field/shade.wgsl", Some(4)));
    type Fields = shadow_field::frame::FrameUniforms;
    let cosine = offset_of!(Fields, cosine);
    let fields = vec![
        offset_of!(Fields, light),
        cosine,
        cosine + 16,
        offset_of!(Fields, eye),
        offset_of!(Fields, rotations),
        offset_of!(Fields, orders),
        offset_of!(Fields, lights),
        offset_of!(Fields, receivers),
    ];
    assert_eq!(layout(&module, "Frame"), (size_of::<Fields>(), fields));

    let (module, _) = valid("mask", &shader::module("mask/shade.wgsl", None));
    type Masks = mask::FrameUniforms;
    let masks = vec![
        offset_of!(Masks, constant),
        offset_of!(Masks, eye),
        offset_of!(Masks, grid_cells),
        offset_of!(Masks, normal_cells),
        offset_of!(Masks, edge),
        offset_of!(Masks, lamp_directions),
        offset_of!(Masks, sphere_count),
        offset_of!(Masks, box_count),
        offset_of!(Masks, lamp_count),
        offset_of!(Masks, set_sixteens),
        offset_of!(Masks, lamp_sixteens),
        offset_of!(Masks, boxes),
        offset_of!(Masks, lamps),
        offset_of!(Masks, sets),
        offset_of!(Masks, spiral),
        offset_of!(Masks, own_side),
        offset_of!(Masks, levels),
        offset_of!(Masks, level_count),
        offset_of!(Masks, lobe_spiral),
        offset_of!(Masks, lobe_sixteens),
        offset_of!(Masks, objects),
        offset_of!(Masks, padding),
    ];
    assert_eq!(layout(&module, "Frame"), (size_of::<Masks>(), masks));

    let (module, _) = valid("analytic", &shader::module("analytic/shade.wgsl", None));
    type Closed = analytic::FrameUniforms;
    let closed = vec![
        offset_of!(Closed, constant),
        offset_of!(Closed, grid_cells),
        offset_of!(Closed, sphere_count),
        offset_of!(Closed, lamp_count),
        offset_of!(Closed, padding),
    ];
    assert_eq!(layout(&module, "Frame"), (size_of::<Closed>(), closed));

    let (module, _) = valid("prt", &shader::module("prt/shade.wgsl", None));
    type Transfer = prt::FrameUniforms;
    let transfer = vec![offset_of!(Transfer, light), offset_of!(Transfer, baked_from_world), offset_of!(Transfer, eye)];
    assert_eq!(layout(&module, "Frame"), (size_of::<Transfer>(), transfer));
    type Between = prt::Between;
    let between = vec![
        offset_of!(Between, rows),
        offset_of!(Between, fit),
        offset_of!(Between, weights),
        offset_of!(Between, terms),
        offset_of!(Between, matrices),
        offset_of!(Between, term_count),
    ];
    assert_eq!(layout(&module, "Between"), (size_of::<Between>(), between));

    let (module, _) = valid("prt-clusters", &shader::module("prt/shade_clusters.wgsl", None));
    // The rest of its last four is padding, which settings need that lie in a uniform buffer.
    let components = vec![offset_of!(prt::ClusterUniforms, components)];
    assert_eq!(layout(&module, "Frame"), (4, components));
    type Clusters = prt::ClusterBetween;
    let between = vec![offset_of!(Clusters, rows), offset_of!(Clusters, clusters), offset_of!(Clusters, weights)];
    assert_eq!(layout(&module, "Between"), (size_of::<Clusters>(), between));
}
