//! What is told of fields: chosen resolution, interpolation error, bytes.

use super::{
    arrangement::Arrangement,
    baking::Known,
    basis::{Ball, Basis, rays},
    field::Field,
    shell::{Shell, VectorOf},
    shells::direction,
    solid::Solid,
};
use halfshade_scene::Mesh;
use halfshade_strategy::{Detail, Footprint};
use rayon::prelude::*;
use std::{f32::consts::FRAC_1_PI, sync::Arc};
use wide::f32x8;

/// What is known of meshes, each once, with the number of the first object that has it.
fn distinct<K>(known: &[Arc<K>]) -> impl Iterator<Item = (usize, &K)> {
    (known.iter().enumerate())
        .filter(|(number, one)| !known[..*number].iter().any(|other| Arc::ptr_eq(other, one)))
        .map(|(number, one)| (number, &**one))
}

/// Bytes of fields and, by `own_bytes`, of the meshes' own occlusion.
pub(super) fn footprint<S: Shell, O>(known: &[Arc<Known<S, O>>], own_bytes: impl Fn(&O) -> usize) -> Footprint {
    let fields = distinct(known).map(|(_, known)| known.field.as_ref().map_or(0, Field::bytes)).sum();
    let own = distinct(known).map(|(_, known)| own_bytes(&known.own)).sum();
    Footprint { parts: vec![("occlusion fields", fields), ("own occlusion", own)] }
}

/// Per mesh, named by its first object. `read` gives the vector at a place in shell coordinates, the same in all lanes.
pub(super) fn details<S: Shell, O>(
    basis: &S::Basis,
    arrangement: &Arrangement,
    known: &[Arc<Known<S, O>>],
    read: impl Fn(&Field<S>, [f32x8; 3]) -> VectorOf<S> + Sync,
) -> Vec<Detail> {
    let mut details = Vec::new();
    for (number, one) in distinct(known) {
        let Some(field) = &one.field else { continue };
        let (name, mesh) = arrangement.object(number);
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
    let rays = rays(mesh);
    let ball = Ball { center: field.center, radius: field.radius };
    let solid = Solid::new(&rays, ball);
    let radii = field.sampled.radii();
    (0..radii.len())
        .into_par_iter()
        .map(|shell| {
            let inward = if shell == 0 { 0.0 } else { radii[shell - 1] };
            let radius = 0.5 * (inward + radii[shell]);
            let error = |number: usize| {
                // A spiral of equal areas.
                let (u, z) = (0.618_034 * number as f32 % 1.0, 1.0 - (2.0 * number as f32 + 1.0) / POINTS as f32);
                let place = [u, z.acos() * FRAC_1_PI];
                let point = ball.center + radius * ball.radius * direction(place);
                let outside = !solid.holds(point);
                outside.then(|| {
                    basis.difference(
                        &read([radius, place[0], place[1]].map(f32x8::splat)),
                        &basis.blocked_from(&rays, point, ball),
                    )
                })
            };
            let errors: Vec<f64> = (0..POINTS).filter_map(error).collect();
            errors.iter().sum::<f64>() / errors.len().max(1) as f64
        })
        .collect()
}
