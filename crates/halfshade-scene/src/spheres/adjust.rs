//! View from a receiver of a sphere that cuts its tangent plane, or that contains it ([Guerrero2007, 4.2]).
//!
//! A bounding sphere set contains the surface that it bounds, so that every receiver lies inside some sphere of its own
//! object; such spheres must not darken it. The rules of [Guerrero2007, 4.2] (after Ren et al. 2006) adjust each sphere
//! at each receiver. The paper leaves the points of its figure 4.7 undefined; this is the reading under which its
//! formula makes sense. With the receiver `p`, its unit normal `n`, a sphere of centre `x` and radius `r`:
//!
//! ```text
//! h  = n·(x − p)           height of the centre over the tangent plane
//! q0 = x + r n             the sphere's highest point
//! q1 = x − h n             the foot of its centre on the plane
//! t  = |p − q1|            distance of the receiver from that foot
//! |q1 − q0| = r + h        height of the part of the sphere in front of the plane
//! d² = r² − (r − |q1−q0|)² = r² − h²        radius of the circle in which the plane cuts the sphere
//! ```
//!
//! so that `p`, which lies on the plane, is inside the sphere exactly when `t < d`. The largest sphere in the part in
//! front of the plane has the diameter `|q1 − q0|` and touches the plane in q1 and the old sphere in q0. It is what
//! "reduce the radius and move the centre until tangent" makes of a sphere, whether its centre is in front or behind:
//!
//! ```text
//! r' = clamp((r + h)/2, 0, r)     h' = max(h, r')     x' = x + (h' − h) n
//! ```
//!
//! which is the sphere itself if it lies wholly in front (h ≥ r) and nothing if it lies wholly behind (h ≤ −r).
//! Finally the radius is scaled by α about the new centre: sin θ = α r' / |x' − p|. (Scaling about q1 instead, so that
//! the sphere stays tangent, would be discontinuous under a centre: seen from q1 every tangent sphere fills the
//! hemisphere, however small.) θ never exceeds π/2 and `p` is never inside, because |x' − p| ≥ h' ≥ r'.
//!
//! **Where the published α jumps.** The paper scales by α = min(1, (t − d)/d) (0 where p is inside) only if the centre
//! is *behind* the plane. On the way out of the sphere that is continuous: α = 0 on the cut circle. But as the centre
//! crosses the plane (h = 0, d = r) a receiver with t < 2r sees α jump from max(0, t/r − 1) to 1: from nothing to a
//! whole half-size sphere where it is inside. [`AdjustRule::Published`] keeps that for comparison.
//! [`AdjustRule::Continuous`] uses one formula for both sides,
//!
//! ```text
//! α = clamp(max(t/d − 1, h / (κ r)), 0, 1)      κ = 1/2
//! ```
//!
//! equal to the published one where the centre is behind the plane (h ≤ 0) or high over it (h ≥ κ r), and continuous
//! everywhere. It has no branches: three dot products, two square roots and a few minima and maxima per pair.
//!
//! **Where both let in light.** A ground that an object stands on cuts the spheres that bulge below it. A receiver
//! inside such a sphere, below its centre, is in the dark, but the tangent sphere blocks the less of its sky the farther
//! the foot is. [`AdjustRule::Covering`] pulls the foot towards the receiver: not at all on the cut circle (t = d),
//! by half its distance half-way in, and so on.
//!
//! ```text
//! w   = clamp(h / (κ r), 0, 1)            κ = 1/4
//! α   = clamp(max(t/d − 1, w), 0, 1)
//! x'  = x + (h' − h) n − w (1 − min(t/d, 1)) (q1 − p)
//! ```
//!
//! so that what is blocked rises from the published sphere's share on the cut circle to everything at the foot. Not part
//! of the published method. A centre may be in front of a receiver on the object's own surface where that is
//! concave; what its sphere blocks there is mostly real. On objects whose spheres hold much empty space (a thin hollow
//! vase) it darkens more of what is too dark already.

use super::Sphere;
use glam::{DVec3, Vec3};

/// Height of the centre over the tangent plane, as a fraction of the radius, from which the continuous rule no longer
/// fades a sphere that cuts the plane. Smaller is nearer to the published rule, and steeper.
pub const FADE_HEIGHT: f64 = 0.5;
/// The same for the covering rule. Smaller covers more of the ground, and more of the object's own surface.
pub const COVER_HEIGHT: f64 = 0.25;

/// Rule by which a sphere that cuts the tangent plane is scaled.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum AdjustRule {
    /// One formula for centres in front of and behind the plane; continuous in the receiver's position and normal.
    #[default]
    Continuous,
    /// Like `Continuous`, but a receiver under a sphere that dips below its plane is covered by it.
    Covering,
    /// [Guerrero2007, 4.2] as printed: jumps as the centre crosses the plane of a receiver with t < 2r.
    Published,
}

/// A sphere as one receiver sees it after the rules: never contains the receiver, never dips below its tangent plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdjustedSphere {
    /// Centre minus receiver; never zero.
    pub offset: DVec3,
    /// Radius, positive and at most the offset's length.
    pub radius: f64,
}

impl AdjustedSphere {
    /// Unit direction from the receiver to the centre.
    pub fn direction(&self) -> DVec3 {
        self.offset.normalize()
    }

    /// Sine of the angular radius, in (0, 1].
    pub fn sin_angular_radius(&self) -> f64 {
        (self.radius / self.offset.length()).min(1.0)
    }

    /// Angular radius in radians, in (0, π/2].
    pub fn angular_radius(&self) -> f64 {
        self.sin_angular_radius().asin()
    }

    /// The fraction of a constant environment's irradiance that it blocks alone: sin²θ cos γ, exact because it lies
    /// wholly above the horizon.
    pub fn blocked_fraction(&self, normal: DVec3) -> f64 {
        self.sin_angular_radius().powi(2) * self.direction().dot(normal)
    }
}

/// The rules at a receiver, in f64: the reference for every faster form.
///
/// `offset` is the sphere's centre minus the receiver's position, `radius` its radius (positive), `normal` the
/// receiver's unit normal. `None`: the sphere has no influence.
pub fn adjust(rule: AdjustRule, offset: DVec3, radius: f64, normal: DVec3) -> Option<AdjustedSphere> {
    let height = offset.dot(normal);
    let front_radius = (0.5 * (radius + height)).clamp(0.0, radius);
    let foot = offset - height * normal;
    // The floor only keeps the quotient defined where the plane does not cut; the scale is 1 or irrelevant there.
    let cut_radius_squared = (radius * radius - height * height).max(f64::MIN_POSITIVE);
    let relative = (foot.length_squared() / cut_radius_squared).sqrt();
    let in_front = match rule {
        AdjustRule::Continuous => height / (FADE_HEIGHT * radius),
        AdjustRule::Covering => height / (COVER_HEIGHT * radius),
        AdjustRule::Published => f64::from(u8::from(height >= 0.0)),
    }
    .clamp(0.0, 1.0);
    let scale = (relative - 1.0).max(in_front).clamp(0.0, 1.0);
    let pull = if rule == AdjustRule::Covering { in_front * (1.0 - relative.min(1.0)) } else { 0.0 };
    let moved = offset + (height.max(front_radius) - height) * normal - pull * foot;
    let distance = moved.length();
    let adjusted = AdjustedSphere { offset: moved, radius: (scale * front_radius).min(distance) };
    // Below this the sphere subtends nothing in any precision, and squares of its size would lose all digits.
    (adjusted.radius > 1e-100).then_some(adjusted)
}

/// The rules on a single-precision sphere and receiver: the adjusted sphere in the same space, or `None` if it has no
/// influence. Computed in f64; only the result is rounded, its radius downwards so that the receiver stays outside.
pub fn adjusted(rule: AdjustRule, sphere: Sphere, receiver_position: Vec3, receiver_normal: Vec3) -> Option<Sphere> {
    let position = receiver_position.as_dvec3();
    let offset = sphere.center.as_dvec3() - position;
    let result = adjust(rule, offset, f64::from(sphere.radius), receiver_normal.as_dvec3().normalize_or(DVec3::Y))?;
    let center = (position + result.offset).as_vec3();
    let limit = (center.as_dvec3() - position).length().min(result.radius);
    let radius = limit as f32;
    let radius = if f64::from(radius) > limit { radius.next_down() } else { radius };
    (radius > 0.0).then_some(Sphere { center, radius })
}

#[cfg(test)]
mod tests {
    use super::*;
    use AdjustRule::{Continuous, Covering, Published};
    use proptest::prelude::*;

    /// Receiver at the origin with normal +Y: a sphere of radius `r` whose centre is `t` aside and `h` up.
    fn at(rule: AdjustRule, t: f64, h: f64, r: f64) -> Option<AdjustedSphere> {
        adjust(rule, DVec3::new(t, h, 0.0), r, DVec3::Y)
    }

    #[test]
    fn the_four_published_cases() {
        for rule in [Published, Continuous, Covering] {
            let front = at(rule, 2.0, 1.5, 1.0).unwrap();
            assert_eq!((front.offset, front.radius), (DVec3::new(2.0, 1.5, 0.0), 1.0));
            assert_eq!(at(rule, 2.0, -1.5, 1.0), None);
            // Cut, centre in front: from the old top at 1.6 down to the plane.
            let red = at(rule, 3.0, 0.6, 1.0).unwrap();
            assert!(red.offset.distance(DVec3::new(3.0, 0.8, 0.0)) < 1e-15 && (red.radius - 0.8).abs() < 1e-15);
            // Cut, centre behind, receiver inside: gone. Outside: from the top at 0.4 down to the plane, times alpha;
            // the cut circle has radius 0.8, so alpha is 1/4 at 1.0 and 1 from 1.6 on.
            assert_eq!(at(rule, 0.79, -0.6, 1.0), None);
            let near = at(rule, 1.0, -0.6, 1.0).unwrap();
            assert!(near.offset.distance(DVec3::new(1.0, 0.2, 0.0)) < 1e-15 && (near.radius - 0.05).abs() < 1e-15);
            assert!((at(rule, 1.7, -0.6, 1.0).unwrap().radius - 0.2).abs() < 1e-15);
        }
    }

    /// Largest change of the blocked fraction between neighbours on a straight path of receivers through a sphere of
    /// radius 1 about the origin, their normals turning on the way.
    fn largest_step(rule: AdjustRule, from: DVec3, to: DVec3, normals: [DVec3; 2], steps: u32) -> f64 {
        let blocked = |i: u32| {
            let x = f64::from(i) / f64::from(steps);
            let normal = normals[0].lerp(normals[1], x).normalize_or(DVec3::Y);
            adjust(rule, -from.lerp(to, x), 1.0, normal).map_or(0.0, |s| s.blocked_fraction(normal))
        };
        (0..steps).map(|i| (blocked(i + 1) - blocked(i)).abs()).fold(0.0, f64::max)
    }

    /// A continuous function's largest step vanishes with the step's length; a jump stays.
    #[test]
    fn continuous_where_the_published_rule_jumps() {
        let along = |x: f64| DVec3::new(0.3, x, 0.1);
        let published = largest_step(Published, along(1.4), along(-1.4), [DVec3::Y; 2], 100_000);
        assert!(published > 0.5, "the centre crosses the plane of a receiver inside: {published}");
        for rule in [Continuous, Covering] {
            let largest = largest_step(rule, along(1.4), along(-1.4), [DVec3::Y; 2], 100_000);
            assert!(largest < 2e-3, "{rule:?}: {largest}");
        }
    }

    proptest! {
        #[test]
        fn no_jump_on_any_path(from in prop::array::uniform3(-2.0..2.0f64), to in prop::array::uniform3(-2.0..2.0f64),
                               n0 in prop::array::uniform3(-1.0..1.0f64), n1 in prop::array::uniform3(-1.0..1.0f64)) {
            let normals = [DVec3::from(n0), DVec3::from(n1)].map(|n| n.normalize_or(DVec3::Y));
            // Antipodal normals turn arbitrarily fast half-way: that is the path's doing, not the rule's.
            prop_assume!(normals[0].dot(normals[1]) > -0.9);
            let (from, to) = (DVec3::from(from), DVec3::from(to));
            for rule in [Continuous, Covering] {
                let coarse = largest_step(rule, from, to, normals, 20_000);
                prop_assert!(coarse < 0.02, "{rule:?}: coarse {coarse}");
                // Through the centre itself as well, the hardest path.
                let through = largest_step(rule, from, -from, normals, 20_000);
                prop_assert!(through < 0.02, "{rule:?}: through the centre {through}");
            }
        }

        #[test]
        fn never_contains_the_receiver_nor_dips_below(t in -3.0..3.0f64, h in -1.2..1.2f64, scale in -3..3i32) {
            let unit = 10f64.powi(scale);
            for rule in [Published, Continuous, Covering] {
                if let Some(sphere) = at(rule, unit * t, unit * h, unit) {
                    prop_assert!(sphere.radius <= sphere.offset.length());
                    prop_assert!(sphere.radius <= sphere.offset.y * (1.0 + 1e-12));
                    prop_assert!(sphere.angular_radius() <= std::f64::consts::FRAC_PI_2);
                    prop_assert!(sphere.radius <= unit);
                }
            }
        }
    }

    /// Under a sphere of radius 1 with its centre at 0.6, cut in a circle of radius 0.8.
    #[test]
    fn the_covering_rule_blocks_all_at_the_foot_and_joins_the_published_one_on_the_cut_circle() {
        let blocked = |rule, t| at(rule, t, 0.6, 1.0).unwrap().blocked_fraction(DVec3::Y);
        assert_eq!(blocked(Covering, 0.0), 1.0);
        for t in [0.8, 1.0, 2.0] {
            assert!((blocked(Covering, t) - blocked(Published, t)).abs() < 1e-12);
        }
        for k in 1..80 {
            let (t, before) = (f64::from(k) / 100.0, f64::from(k - 1) / 100.0);
            assert!(blocked(Covering, t) > blocked(Published, t) && blocked(Covering, t) < blocked(Covering, before));
        }
        // At half the way to the circle the foot is half as far: tangent sphere 0.8, foot at 0.2.
        let half = at(Covering, 0.4, 0.6, 1.0).unwrap();
        assert!(half.offset.distance(DVec3::new(0.2, 0.8, 0.0)) < 1e-12 && (half.radius - 0.8).abs() < 1e-12);
        // Behind the plane nothing changes, in front of it neither.
        for (t, h) in [(1.0, -0.6), (0.5, -0.1), (0.3, 1.2)] {
            assert_eq!(at(Covering, t, h, 1.0), at(Published, t, h, 1.0));
        }
    }

    #[test]
    fn finite_on_the_surface_and_next_to_it() {
        let surface = [DVec3::X, DVec3::Y, DVec3::NEG_Y, DVec3::new(0.6, 0.8, 0.0), DVec3::new(0.6, -0.8, 0.0)];
        for point in surface {
            for distance in [1.0, 1.0 - 1e-7, 1.0 + 1e-7, 1.0 - 1e-16, 0.0, 1e-7] {
                for normal in [point, -point, DVec3::Z, DVec3::Y] {
                    for rule in [Published, Continuous, Covering] {
                        if let Some(sphere) = adjust(rule, -distance * point, 1.0, normal) {
                            let (sin, blocked) = (sphere.sin_angular_radius(), sphere.blocked_fraction(normal));
                            assert!(sphere.direction().is_finite() && (0.0..=1.0).contains(&sin));
                            assert!((-1e-9..=1.0 + 1e-9).contains(&blocked), "{blocked}");
                        }
                    }
                }
            }
        }
        // A receiver on its own convex surface: nothing of its own sphere remains.
        assert_eq!(adjust(Continuous, DVec3::new(0.0, -1.0, 0.0), 1.0, DVec3::Y), None);
        assert_eq!(adjust(Continuous, DVec3::new(0.0, -0.9, 0.0), 1.0, DVec3::Y), None);
    }

    #[test]
    fn single_precision_never_contains_the_receiver() {
        let mut kept = 0;
        for i in 0..2_000 {
            let x = i as f32 * 0.001;
            let position = Vec3::new(10.0 + x, 20.0 - 0.5 * x, 30.0);
            let normal = Vec3::new(x - 1.0, 0.7, 0.3).normalize();
            let sphere = Sphere { center: Vec3::new(10.6, 20.1, 30.2), radius: 0.7 };
            if let Some(adjusted) = adjusted(Continuous, sphere, position, normal) {
                kept += 1;
                let distance = adjusted.center.as_dvec3().distance(position.as_dvec3());
                assert!(f64::from(adjusted.radius) <= distance);
            }
        }
        assert!(kept > 500);
    }
}
