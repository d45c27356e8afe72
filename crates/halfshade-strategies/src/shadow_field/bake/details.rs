//! Figures on what was baked: chosen resolution, interpolation error, bytes.

use super::{
    basis::Basis,
    bounds::BoundingSphere,
    field::Field,
    grid::direction,
    meshes::BakedObject,
    shell::{Shell, VectorOf},
    solid::Solid,
};
use crate::shared::triangle_rays::TriangleRays;
use halfshade_scene::Mesh;
use halfshade_strategy::{Detail, Footprint};
use rayon::prelude::*;
use std::{f32::consts::FRAC_1_PI, sync::Arc};
use wide::f32x8;

/// The first object of each mesh.
pub(crate) fn distinct<S, O>(objects: &[BakedObject<S, O>]) -> impl Iterator<Item = &BakedObject<S, O>> {
    let is_first = |number: usize, object: &BakedObject<S, O>| {
        !objects[..number].iter().any(|other| Arc::ptr_eq(&other.occlusion, &object.occlusion))
    };
    objects.iter().enumerate().filter(move |(number, object)| is_first(*number, object)).map(|(_, object)| object)
}

/// Bytes of fields and, by `own_bytes`, of the meshes' own occlusion.
pub(crate) fn footprint<S: Shell, O>(objects: &[BakedObject<S, O>], own_bytes: impl Fn(&O) -> usize) -> Footprint {
    let fields = distinct(objects).map(|object| object.occlusion.field.as_ref().map_or(0, Field::bytes)).sum();
    let own = distinct(objects).map(|object| own_bytes(&object.occlusion.own)).sum();
    Footprint { parts: vec![("occlusion fields", fields), ("own occlusion", own)] }
}

/// Figures per mesh, named by its first object. `read` gives the vector at a place in shell coordinates, the same in all
/// lanes.
pub(crate) fn details<S: Shell, O>(
    basis: &S::Basis,
    objects: &[BakedObject<S, O>],
    read: impl Fn(&Field<S>, [f32x8; 3]) -> VectorOf<S> + Sync,
) -> Vec<Detail> {
    let mut details = Vec::new();
    for BakedObject { name, mesh, occlusion, .. } in distinct(objects) {
        let Some(field) = &occlusion.field else { continue };
        let mut add = |what: &str, values| details.push(Detail { name: format!("{name}: {what}"), values });
        add("resolution by shell", field.resolutions().into_iter().map(|x| x as f64).collect());
        let errors = interpolation_errors(field, basis, mesh, |place| read(field, place));
        add("mean interpolation error by shell", errors);
        add("field bytes", vec![field.bytes() as f64]);
    }
    details
}

/// The mean over points between sample points of how far a field is from what is projected there, by shell: as
/// equation 1 measures it, at `POINTS` places halfway to the next shell inward, of which those within the solid don't count.
fn interpolation_errors<S: Shell>(
    field: &Field<S>,
    basis: &S::Basis,
    mesh: &Mesh,
    read: impl Fn([f32x8; 3]) -> VectorOf<S> + Sync,
) -> Vec<f64> {
    const POINTS: usize = 64;
    let rays = TriangleRays::new(mesh);
    let bounds = BoundingSphere { center: field.center, radius: field.radius };
    let solid = Solid::new(&rays, bounds);
    let radii = field.layout.radii();
    (0..radii.len())
        .into_par_iter()
        .map(|shell| {
            let inward = if shell == 0 { 0.0 } else { radii[shell - 1] };
            let radius = 0.5 * (inward + radii[shell]);
            let error = |number: usize| {
                // A spiral of equal areas, by longitude and latitude as the field wants them: halfshade-sh's
                // `golden_spiral` gives directions, whose longitudes would be rounded otherwise.
                let (u, z) = (0.618_034 * number as f32 % 1.0, 1.0 - (2.0 * number as f32 + 1.0) / POINTS as f32);
                let place = [u, z.acos() * FRAC_1_PI];
                let point = bounds.center + radius * bounds.radius * direction(place);
                let outside = !solid.holds(point);
                outside.then(|| {
                    basis.difference(
                        &read([radius, place[0], place[1]].map(f32x8::splat)),
                        &basis.blocked_from(&rays, point, bounds),
                    )
                })
            };
            let errors: Vec<f64> = (0..POINTS).filter_map(error).collect();
            errors.iter().sum::<f64>() / errors.len().max(1) as f64
        })
        .collect()
}
