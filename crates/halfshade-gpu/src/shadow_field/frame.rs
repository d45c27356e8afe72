//! A frame in rows of four numbers.

use super::tables::Tables;
use crate::{
    receivers::KernelSpace,
    rows::{Row, bits, fours},
};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use halfshade_strategies::shadow_field::arrays::{Containment, FrameArrays, LocalLight, ObjectPlacement};

/// Settings of a frame, as `shadow_field/frame.wgsl` reads them.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct FrameUniforms {
    pub(crate) light: [[f32; 4]; 27],
    pub(crate) cosine: [f32; 8],
    pub(crate) eye: [f32; 4],
    pub(crate) rotations: u32,
    pub(crate) orders: u32,
    pub(crate) lights: u32,
    pub(crate) receivers: u32,
}

/// Largest inverse of a radius: with it no distance overflows.
const LARGEST_INVERSE: f32 = 1e30;

/// Numbers, objects, rotations, orders and lights of a frame, and where they begin.
pub(super) fn frame_rows(
    arrays: &FrameArrays<'_>,
    tables: &Tables,
    space: &KernelSpace,
    eye: Vec3,
) -> (Vec<Row>, FrameUniforms) {
    let scaled = |length: f32| (f64::from(length) * space.scale) as f32;
    let place = |center: [f32; 3]| Vec3::from(center.map(scaled));
    let mut rows: Vec<Row> = vec![[arrays.objects.len() as u32, 1 + arrays.lights.len() as u32, 0, 0]];
    for (ObjectPlacement { center, object_from_light, inverse_radius, .. }, own) in
        arrays.objects.iter().zip(&tables.objects)
    {
        let inverse = (f64::from(*inverse_radius) / space.scale) as f32;
        rows.push(bits(place(*center), inverse.min(LARGEST_INVERSE)));
        for ([x, y, z], number) in object_from_light.iter().zip([own.field, own.terms, own.term_count]) {
            rows.push([x.to_bits(), y.to_bits(), z.to_bits(), number]);
        }
    }
    let rotations = rows.len() as u32;
    for blocks in arrays.rotations {
        rows.extend(fours(blocks.iter().map(|value| value.to_bits())));
    }
    let orders = rows.len() as u32;
    for (own, order) in arrays.nearest_first.iter().enumerate() {
        rows.extend(fours(std::iter::once(&own).chain(order).map(|&number| number as u32)));
    }
    let lights = rows.len() as u32;
    // Distant light is the first: all objects are before it.
    rows.extend([[0; 4], [0, 0, 0, 1]]);
    rows.extend(fours(arrays.objects.iter().map(|_| 0)));
    for LocalLight { center, radius, radiance, holds } in arrays.lights {
        rows.push(bits(place(*center), scaled(*radius)));
        let [r, g, b] = radiance.map(f32::to_bits);
        rows.push([r, g, b, 0]);
        rows.extend(fours(holds.iter().map(containment)));
    }
    let uniforms = FrameUniforms {
        light: light_by_fours(arrays.light),
        cosine: tables.cosine,
        eye: space.place_sphere(eye, 0.0),
        rotations,
        orders,
        lights,
        receivers: tables.receivers as u32,
    };
    (rows, uniforms)
}

/// A number as `shadow_field/light_order.wgsl` reads it.
fn containment(holds: &Containment) -> u32 {
    match holds {
        Containment::Outside => 0,
        Containment::Center => 1,
        Containment::Whole => 2,
    }
}

/// Per four coefficients those of red, green and blue.
fn light_by_fours(light: &[[f32; 3]]) -> [[f32; 4]; 27] {
    let mut rows = [[0.0; 4]; 27];
    for (i, value) in light.iter().enumerate() {
        (0..3).for_each(|channel| rows[i / 4 * 3 + channel][i % 4] = value[channel]);
    }
    rows
}
