//! Transfer found by rays at the receiver itself, `sampling=together`: no interpolation, no products.

use crate::{
    shadow_field::{bake::traced::TracedMesh, prepare::frame::FrameData},
    shared::triangle_rays::{ROUNDING, Start},
};
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

/// A receiver in light space.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LightSpaceReceiver {
    pub(crate) object: usize,
    pub(crate) position: [f32; 3],
    pub(crate) normal: Vec3,
}

/// `V cos/π` as a function of direction in light space: V is the visibility that the receiver's own object and the `nearer`
/// ones leave.
pub(crate) fn transfer<'a>(
    frame: &FrameData,
    traced: impl Fn(usize) -> Option<&'a TracedMesh>,
    receiver: LightSpaceReceiver,
    nearer: impl Iterator<Item = usize>,
) -> impl Fn(Vec3) -> f32 + 'a {
    let seen = |object: usize| {
        let traced = traced(object)?;
        let placement = &frame.objects[object];
        let local = placement.point_in_object(receiver.position) + traced.bounds.center;
        Some((traced, placement.rotation(), local))
    };
    // Positions were rounded where the whole scene is small numbers, not the object alone.
    let own = seen(receiver.object).map(|(traced, rotation, local)| {
        let rounding = ROUNDING * frame.objects[receiver.object].largest_term(receiver.position);
        (traced, rotation, local, rotation * receiver.normal, rounding)
    });
    let others: Vec<_> = nearer.filter_map(seen).collect();
    move |direction| {
        let cosine = direction.dot(receiver.normal);
        let hidden = || {
            own.as_ref().is_some_and(|(traced, rotation, local, normal, rounding)| {
                traced.rays.blocked(*local, *normal, *rotation * direction, *rounding)
            }) || others.iter().any(|(traced, rotation, local)| {
                traced.rays.rays().blocked(&Start::free(*local), *rotation * direction, f32::INFINITY)
            })
        };
        if cosine <= 0.0 || hidden() { 0.0 } else { FRAC_1_PI * cosine }
    }
}
