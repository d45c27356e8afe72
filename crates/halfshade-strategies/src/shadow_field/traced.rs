//! What fields stand for, found by rays at the receiver itself: slow, to tell what interpolation and products cost.

use super::{
    arrangement::Arrangement,
    basis::{Ball, Basis},
    vertices::OwnRays,
};
use crate::shared::triangle_rays::{ROUNDING, Start};
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

/// The triangles of one mesh.
pub(super) struct Traced {
    own: OwnRays,
    ball: Ball,
}

impl Traced {
    pub(super) fn new(own: OwnRays, ball: Ball) -> Self {
        Self { own, ball }
    }

    /// What the mesh hides from a point, in its own space and from the middle of its ball.
    pub(super) fn blocked_from<B: Basis>(&self, basis: &B, local: Vec3) -> B::Vector {
        basis.blocked_from(self.own.rays(), local + self.ball.center, self.ball)
    }
}

/// A receiver in light space.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    pub(super) object: usize,
    pub(super) position: [f32; 3],
    pub(super) normal: Vec3,
}

/// What reaches a receiver at once, `V cos/π` as a function of direction in light space: V what its own object and the
/// `nearer` ones leave visible.
pub(super) fn reached<'a>(
    arrangement: &Arrangement,
    traced: impl Fn(usize) -> Option<&'a Traced>,
    point: Point,
    nearer: impl Iterator<Item = usize>,
) -> impl Fn(Vec3) -> f32 + 'a {
    let seen = |object: usize| {
        let traced = traced(object)?;
        let place = &arrangement.places[object];
        let local = place.point_in_object(point.position) + traced.ball.center;
        Some((traced, place.turn(), local))
    };
    // Positions were rounded where the whole scene is small numbers, not the object alone.
    let own = seen(point.object).map(|(traced, turn, local)| {
        let rounding = ROUNDING * arrangement.places[point.object].largest_term(point.position);
        (traced, turn, local, turn * point.normal, rounding)
    });
    let others: Vec<_> = nearer.filter_map(seen).collect();
    move |direction| {
        let cosine = direction.dot(point.normal);
        let hidden = || {
            own.as_ref().is_some_and(|(traced, turn, local, normal, rounding)| {
                traced.own.blocked(*local, *normal, *turn * direction, *rounding)
            }) || others.iter().any(|(traced, turn, local)| {
                traced.own.rays().blocked(&Start::free(*local), *turn * direction, f32::INFINITY)
            })
        };
        if cosine <= 0.0 || hidden() { 0.0 } else { FRAC_1_PI * cosine }
    }
}
