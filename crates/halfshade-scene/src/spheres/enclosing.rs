//! The smallest sphere around spheres.

use super::DSphere;
use glam::DVec3;

/// Excess of a sphere, as a fraction of the radius, that counts as inside: above rounding, far below need.
const TOLERANCE: f64 = 1e-12;
/// Edges at an angle below this to those before them count as lying in one line or plane with them.
const DEGENERATE: f64 = 1e-9;

/// The smallest sphere that contains all `spheres` (finite, radii not negative) wholly; of no spheres, radius 0 at the
/// origin.
///
/// At most four spheres decide it, and it touches them from inside \[Fischer2004\]. The search keeps such a support,
/// adds the sphere that reaches out farthest, and takes the smallest sphere around those five at most by trying every
/// part of them: the radius grows in each step, so that the steps end. (The recursion of \[Welzl1991\], good for
/// points, fails for spheres \[Fischer2004\].) The centre is exact up to rounding; the radius is the farthest reach
/// from it as computed, so that rounding leaves nothing outside.
pub(super) fn enclosing_sphere(spheres: &[DSphere]) -> DSphere {
    let Some(&first) = spheres.iter().max_by(|a, b| a.radius.total_cmp(&b.radius)) else {
        return DSphere { center: DVec3::ZERO, radius: 0.0 };
    };
    let mut support = vec![first];
    let mut best = first;
    loop {
        let reach = |sphere: &DSphere| sphere.center.distance(best.center) + sphere.radius;
        let farthest = *spheres.iter().max_by(|a, b| reach(a).total_cmp(&reach(b))).unwrap_or(&first);
        let done = DSphere { radius: reach(&farthest), ..best };
        if done.radius <= best.radius * (1.0 + TOLERANCE) || support.contains(&farthest) {
            return done;
        }
        support.push(farthest);
        match smallest_around(&support) {
            // Only rounding can keep it from growing when a sphere outside is added.
            Some((grown, part)) if grown.radius > best.radius => (best, support) = (grown, part),
            _ => return done,
        }
    }
}

/// The smallest sphere around at most five, which must touch the last, and the part of them that it touches.
fn smallest_around(spheres: &[DSphere]) -> Option<(DSphere, Vec<DSphere>)> {
    let (last, others) = spheres.split_last()?;
    let mut best: Option<(DSphere, Vec<DSphere>)> = None;
    for chosen in 0..1u32 << others.len() {
        if chosen.count_ones() > 3 {
            continue;
        }
        let mut part = vec![*last];
        part.extend((0..others.len()).filter(|k| chosen >> k & 1 == 1).map(|k| others[k]));
        for sphere in touching(&part) {
            let limit = sphere.radius * (1.0 + TOLERANCE);
            let holds = spheres.iter().all(|b| b.center.distance(sphere.center) + b.radius <= limit);
            if holds && best.as_ref().is_none_or(|(least, _)| sphere.radius < least.radius) {
                best = Some((sphere, part.clone()));
            }
        }
    }
    best
}

/// The spheres that touch one to four others from outside around them, with the centre in the affine hull of theirs.
///
/// With the first sphere (c0, r0) as origin, edges e_i = c_i − c0, differences d_i = r_i − r0 and the unknowns
/// x = c − c0 and s = r − r0: |x| = s and |x − e_i| = s − d_i. Subtracting squares leaves
/// `x·e_i = (e_i² − d_i²)/2 + s d_i`, so that x = a + s b, and |x|² = s² is quadratic in s.
fn touching(spheres: &[DSphere]) -> impl Iterator<Item = DSphere> {
    let origin = spheres[0];
    let mut basis: Vec<DVec3> = Vec::with_capacity(3);
    let (mut a, mut b) = (DVec3::ZERO, DVec3::ZERO);
    let mut sound = true;
    for sphere in &spheres[1..] {
        let (edge, difference) = (sphere.center - origin.center, sphere.radius - origin.radius);
        // Gram-Schmidt; the next coordinate of a and b along the part of the edge that is new.
        let rest = basis.iter().fold(edge, |rest, axis| rest - rest.dot(*axis) * axis);
        let length = rest.length();
        sound &= length > DEGENERATE * edge.length();
        let axis = rest / length;
        a += (0.5 * (edge.length_squared() - difference * difference) - a.dot(edge)) / length * axis;
        b += (difference - b.dot(edge)) / length * axis;
        basis.push(axis);
    }
    // (b² − 1) s² + 2 (a·b) s + a² = 0; the second form of a root keeps its digits where the first cancels.
    let (square, half, constant) = (b.length_squared() - 1.0, a.dot(b), a.length_squared());
    let root = (half * half - square * constant).max(0.0).sqrt();
    let q = -(half + root.copysign(half));
    let solutions = if spheres.len() == 1 { [0.0, f64::NAN] } else { [q / square, constant / q] };
    solutions
        .into_iter()
        .filter(move |s| sound && s.is_finite() && *s >= 0.0)
        .map(move |s| DSphere { center: origin.center + a + s * b, radius: origin.radius + s })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    fn sphere(center: [f64; 3], radius: f64) -> DSphere {
        DSphere { center: DVec3::from_array(center), radius }
    }

    fn reach(spheres: &[DSphere], center: DVec3) -> f64 {
        spheres.iter().map(|b| b.center.distance(center) + b.radius).fold(0.0, f64::max)
    }

    #[test]
    fn closed_forms() {
        assert_eq!(enclosing_sphere(&[]), sphere([0.0; 3], 0.0));
        let one = sphere([1.0, 2.0, 3.0], 0.5);
        assert_eq!(enclosing_sphere(&[one; 6]), one);
        // Concentric, and one within another: the larger one itself.
        assert_eq!(enclosing_sphere(&[one, sphere([1.0, 2.0, 3.0], 0.2), sphere([1.1, 2.0, 3.0], 0.3)]), one);
        // Two apart: the diameter is the distance and both radii.
        let two = enclosing_sphere(&[sphere([0.0; 3], 1.0), sphere([3.0, 4.0, 0.0], 2.0)]);
        assert!((two.radius - 4.0).abs() < 1e-14 && two.center.distance(DVec3::new(1.8, 2.4, 0.0)) < 1e-14);
        // Three equal ones: the circumscribed circle of their centres, and a radius more.
        let corner = |k: f64| {
            sphere([(k * std::f64::consts::TAU / 3.0).cos(), (k * std::f64::consts::TAU / 3.0).sin(), 0.0], 0.25)
        };
        let three = enclosing_sphere(&[corner(0.0), corner(1.0), corner(2.0)]);
        assert!((three.radius - 1.25).abs() < 1e-14 && three.center.length() < 1e-14);
        // Three mutually tangent ones: the outer circle of Descartes' theorem, whose curvature is minus
        // k1 + k2 + k3 − 2 sqrt(k1 k2 + k2 k3 + k3 k1) for the curvatures k of the three.
        let tangent =
            [sphere([-1.0, 0.0, 0.0], 1.0), sphere([1.0, 0.0, 0.0], 1.0), sphere([0.0, 8f64.sqrt(), 0.0], 2.0)];
        assert!((enclosing_sphere(&tangent).radius - 1.0 / (8f64.sqrt() - 2.5)).abs() < 1e-13);
        // That circle has the radius 6 here, but the two larger ones alone need 5 and leave room for the third.
        let loose =
            enclosing_sphere(&[sphere([0.0; 3], 1.0), sphere([4.0, 0.0, 0.0], 3.0), sphere([0.0, 3.0, 0.0], 2.0)]);
        assert!((loose.radius - 5.0).abs() < 1e-14 && loose.center.distance(DVec3::new(2.4, 1.2, 0.0)) < 1e-14);
    }

    /// Least of a convex function on [low, high] by golden section: the least and where.
    fn least(low: f64, high: f64, f: &dyn Fn(f64) -> f64) -> (f64, f64) {
        let ratio = 0.5 * (5f64.sqrt() - 1.0);
        let (mut low, mut high) = (low, high);
        let (mut a, mut b) = (high - ratio * (high - low), low + ratio * (high - low));
        let (mut at_a, mut at_b) = (f(a), f(b));
        for _ in 0..38 {
            if at_a < at_b {
                (high, b, at_b) = (b, a, at_a);
                a = high - ratio * (high - low);
                at_a = f(a);
            } else {
                (low, a, at_a) = (a, b, at_b);
                b = low + ratio * (high - low);
                at_b = f(b);
            }
        }
        (at_a.min(at_b), if at_a < at_b { a } else { b })
    }

    /// The farthest reach is convex in the centre, hence so is its least over z in y, and over y and z in x.
    #[test]
    fn agrees_with_three_nested_line_searches() {
        let mut random = Pcg64Mcg::seed_from_u64(5);
        for round in 0..36 {
            let flat = [1.0, 1e-3, 0.0][round % 3];
            let largest = [1.0, 0.1, 0.0][round / 3 % 3];
            let spheres: Vec<DSphere> = (0..2 + round / 3)
                .map(|_| {
                    let [x, y, z] = std::array::from_fn(|_| random.random_range(-1.0..1.0));
                    sphere([x, y, flat * z], largest * random.random_range(0.0..1.0))
                })
                .collect();
            let found = enclosing_sphere(&spheres);
            let in_z = |x: f64, y: f64| least(-1.0, 1.0, &|z| reach(&spheres, DVec3::new(x, y, z))).0;
            let in_yz = |x: f64| least(-1.0, 1.0, &|y| in_z(x, y)).0;
            let (expected, _) = least(-1.0, 1.0, &in_yz);
            assert!((found.radius - expected).abs() < 1e-6 * expected, "{found:?} not {expected}: {spheres:?}");
            assert_eq!(found.radius, reach(&spheres, found.center));
        }
    }

    #[test]
    fn many_spheres_at_any_scale_and_nearly_degenerate_ones() {
        let mut random = Pcg64Mcg::seed_from_u64(9);
        let mut cube = || DVec3::from_array(std::array::from_fn(|_| random.random_range(-1.0..1.0)));
        // On a sphere about `away`, each touching a sphere of radius 1 from inside: many supports are right.
        let away = DVec3::new(30.0, -20.0, 10.0);
        let mut spheres: Vec<DSphere> = (0..512)
            .map(|k| {
                let radius = 0.9 * f64::from(k) / 512.0;
                DSphere { center: away + (1.0 - radius) * cube().normalize(), radius }
            })
            .collect();
        spheres.push(spheres[3]);
        for scale in [1e-3, 1.0, 1e3] {
            let scaled: Vec<DSphere> =
                spheres.iter().map(|b| DSphere { center: scale * b.center, radius: scale * b.radius }).collect();
            let found = enclosing_sphere(&scaled);
            assert!((found.radius / scale - 1.0).abs() < 1e-9 && found.center.distance(scale * away) < 1e-6 * scale);
        }
        // Almost one place, almost one line.
        for spread in [1e-15, 1e-9] {
            let spheres: Vec<DSphere> = (0..40)
                .map(|k| DSphere { center: DVec3::new(f64::from(k % 7), 0.0, 0.0) + spread * cube(), radius: 1.0 })
                .collect();
            let found = enclosing_sphere(&spheres);
            assert!((found.radius - 4.0).abs() < 1e-7, "{found:?}");
        }
    }
}
