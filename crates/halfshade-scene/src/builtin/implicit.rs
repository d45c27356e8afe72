//! Implicit surfaces: rounded parts blended into one body, with exact gradients and a colour everywhere.
//!
//! A body is `{p : f(p) < 0}`. Parts are joined one after another by the quadratic smooth minimum
//! `smin(a, b) = min(a, b) - h²k/4`, `h = max(k - |a - b|, 0) / k`, which has a continuous gradient and changes
//! nothing where `a` and `b` differ by more than the blend `k`. Values are distances only near a single part; away from
//! there they are a smooth function of the right sign, which is all that meshing and projection need.

use glam::{DQuat, DVec3, DVec4, Vec3};

/// A rounded primitive.
#[derive(Debug, Clone)]
pub(super) enum Primitive {
    /// An ellipsoid with its axes turned by `rotation`.
    Ellipsoid { center: DVec3, radii: DVec3, rotation: DQuat },
    /// Spheres along a polyline, their radii interpolated linearly: (centre, radius); and a sphere that contains it.
    Tube { path: Vec<(DVec3, f64)>, bound: (DVec3, f64) },
}

/// A primitive, how it joins the parts before it, and its colour.
#[derive(Debug, Clone)]
pub(super) struct Part {
    primitive: Primitive,
    blend: f64,
    color: Vec3,
}

/// A body of blended parts.
#[derive(Debug, Clone, Default)]
pub(super) struct Body {
    parts: Vec<Part>,
    base: Option<(f64, f64)>,
    color_softness: f64,
}

/// Value of a body at a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    /// Negative inside.
    pub(super) value: f64,
    /// The value's gradient; outward on the surface.
    pub(super) gradient: DVec3,
    /// Colour of the nearest part, mixed over the softness at seams.
    pub(super) color: Vec3,
}

impl Body {
    /// No parts yet; colours of neighbours mix where their values differ by less than `color_softness` (positive).
    pub(super) fn new(color_softness: f64) -> Self {
        Self { color_softness, ..Self::default() }
    }

    /// Joins a sphere.
    pub(super) fn sphere(self, center: [f64; 3], radius: f64, blend: f64, color: Vec3) -> Self {
        self.ellipsoid(center, [radius; 3], DQuat::IDENTITY, blend, color)
    }

    /// Joins an ellipsoid.
    pub(super) fn ellipsoid(
        mut self,
        center: [f64; 3],
        radii: [f64; 3],
        rotation: DQuat,
        blend: f64,
        color: Vec3,
    ) -> Self {
        let primitive = Primitive::Ellipsoid { center: center.into(), radii: radii.into(), rotation };
        self.parts.push(Part { primitive, blend, color });
        self
    }

    /// Joins a tube along `path` of (x, y, z, radius).
    pub(super) fn tube(mut self, path: &[[f64; 4]], blend: f64, color: Vec3) -> Self {
        let path: Vec<_> = path.iter().map(|&[x, y, z, radius]| (DVec3::new(x, y, z), radius)).collect();
        let center = path.iter().map(|end| end.0).sum::<DVec3>() / path.len().max(1) as f64;
        let reach = path.iter().map(|end| center.distance(end.0) + end.1).fold(0.0, f64::max);
        self.parts.push(Part { primitive: Primitive::Tube { path, bound: (center, reach) }, blend, color });
        self
    }

    /// Joins an ellipsoid and its mirror image in z.
    pub(super) fn ellipsoid_pair(
        self,
        center: [f64; 3],
        radii: [f64; 3],
        rotation: DQuat,
        blend: f64,
        color: Vec3,
    ) -> Self {
        let [x, y, z] = center;
        // Mirroring in z turns a rotation's axis and sense into (-x, -y, z).
        let mirrored = DQuat::from_xyzw(-rotation.x, -rotation.y, rotation.z, rotation.w);
        self.ellipsoid(center, radii, rotation, blend, color).ellipsoid([x, y, -z], radii, mirrored, blend, color)
    }

    /// Joins a tube and its mirror image in z.
    pub(super) fn tube_pair(self, path: &[[f64; 4]], blend: f64, color: Vec3) -> Self {
        let mirrored: Vec<_> = path.iter().map(|&[x, y, z, radius]| [x, y, -z, radius]).collect();
        self.tube(path, blend, color).tube(&mirrored, blend, color)
    }

    /// Cuts off everything below y = `height`, the edge rounded over `blend`.
    pub(super) fn flat_base(mut self, height: f64, blend: f64) -> Self {
        self.base = Some((height, blend));
        self
    }

    /// The body at `point`.
    pub(super) fn sample(&self, point: DVec3) -> Sample {
        let mut sample = Sample { value: f64::INFINITY, gradient: DVec3::Y, color: Vec3::ONE };
        for part in &self.parts {
            // Most samples lie so far from a tube that it leaves no trace: its value is no less than the distance.
            if let Primitive::Tube { bound: (center, reach), .. } = part.primitive
                && point.distance(center) - reach > sample.value + part.blend.max(self.color_softness)
            {
                continue;
            }
            let (value, gradient) = part.primitive.value_and_gradient(point);
            if sample.value.is_infinite() {
                sample = Sample { value, gradient, color: part.color };
                continue;
            }
            let difference = sample.value - value;
            let share = (0.5 + 0.5 * difference / self.color_softness).clamp(0.0, 1.0) as f32;
            let (value, weight) = smooth_minimum(sample.value, value, part.blend);
            sample.value = value;
            sample.gradient = sample.gradient * (1.0 - weight) + gradient * weight;
            sample.color = sample.color.lerp(part.color, share);
        }
        if let Some((height, blend)) = self.base {
            let (value, weight) = smooth_minimum(-sample.value, point.y - height, blend);
            sample.value = -value;
            sample.gradient = sample.gradient * (1.0 - weight) + DVec3::NEG_Y * weight;
        }
        sample
    }

    /// Corners of a box that contains the body.
    pub(super) fn bounds(&self) -> (DVec3, DVec3) {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for part in &self.parts {
            // A blend swells the surface by at most k/4 in value, and values grow nearly as distances do.
            let mut include = |center: DVec3, reach: f64| {
                low = low.min(center - reach - 0.5 * part.blend);
                high = high.max(center + reach + 0.5 * part.blend);
            };
            match &part.primitive {
                Primitive::Ellipsoid { center, radii, .. } => include(*center, radii.max_element()),
                Primitive::Tube { path, .. } => path.iter().for_each(|&(center, radius)| include(center, radius)),
            }
        }
        if let Some((height, _)) = self.base {
            low.y = low.y.max(height);
        }
        (low, high)
    }
}

impl Primitive {
    fn value_and_gradient(&self, point: DVec3) -> (f64, DVec3) {
        match self {
            Self::Ellipsoid { center, radii, rotation } => {
                let p = rotation.conjugate() * (point - *center);
                let (value, gradient) = ellipsoid(p, *radii);
                (value, *rotation * gradient)
            }
            Self::Tube { path, .. } => path
                .windows(2)
                .map(|ends| tapered_segment(point, ends[0], ends[1]))
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .unwrap_or((f64::INFINITY, DVec3::Y)),
        }
    }
}

/// First-order distance to an ellipsoid at the origin: `k0 (k0 - 1) / k1` with `k0 = |p / r|`, `k1 = |p / r²|`.
fn ellipsoid(p: DVec3, radii: DVec3) -> (f64, DVec3) {
    let (scaled, scaled_twice) = (p / radii, p / (radii * radii));
    let (k0, k1) = (scaled.length(), scaled_twice.length());
    if k1 < 1e-9 {
        return (-radii.min_element(), DVec3::Y);
    }
    let (gradient_k0, gradient_k1) = (scaled_twice / k0, scaled_twice / (radii * radii) / k1);
    let value = k0 * (k0 - 1.0) / k1;
    (value, ((2.0 * k0 - 1.0) * gradient_k0 - value * gradient_k1) / k1)
}

/// Distance from the axis between two spheres' centres, minus the radius interpolated between them.
fn tapered_segment(point: DVec3, (a, radius_a): (DVec3, f64), (b, radius_b): (DVec3, f64)) -> (f64, DVec3) {
    let (axis, offset) = (b - a, point - a);
    let inverse_length_squared = axis.length_squared().recip();
    let along = offset.dot(axis) * inverse_length_squared;
    let clamped = along.clamp(0.0, 1.0);
    let from_axis = offset - clamped * axis;
    let distance = from_axis.length();
    let mut gradient = if distance > 1e-12 { from_axis / distance } else { DVec3::Y };
    if along == clamped {
        gradient -= (radius_b - radius_a) * inverse_length_squared * axis;
    }
    (distance - radius_a - (radius_b - radius_a) * clamped, gradient)
}

/// The quadratic smooth minimum, and the weight of `b` in its gradient.
fn smooth_minimum(a: f64, b: f64, blend: f64) -> (f64, f64) {
    let h = if blend > 0.0 { (1.0 - (a - b).abs() / blend).max(0.0) } else { 0.0 };
    let weight_of_larger = 0.5 * h;
    (a.min(b) - 0.25 * h * h * blend, if b < a { 1.0 - weight_of_larger } else { weight_of_larger })
}

/// Points (x, y, z, radius) along the Catmull-Rom spline through `points`, sixteen per span:
/// enough to hide the kinks of normals where segments join.
pub(super) fn smooth_path(points: &[[f64; 4]]) -> Vec<[f64; 4]> {
    const STEPS: usize = 16;
    let at = |i: isize| DVec4::from(points[i.clamp(0, points.len() as isize - 1) as usize]);
    let mut path = Vec::with_capacity(STEPS * points.len());
    for i in 0..points.len() as isize - 1 {
        let (p0, p1, p2, p3) = (at(i - 1), at(i), at(i + 1), at(i + 2));
        for step in 0..STEPS {
            let t = step as f64 / STEPS as f64;
            let point = p1
                + 0.5 * t * (p2 - p0)
                + 0.5 * t * t * (2.0 * p0 - 5.0 * p1 + 4.0 * p2 - p3)
                + 0.5 * t * t * t * (3.0 * (p1 - p2) + p3 - p0);
            path.push(point.to_array());
        }
    }
    path.push(at(points.len() as isize - 1).to_array());
    path
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};

    fn body() -> Body {
        Body::new(0.01)
            .ellipsoid([0.1, 0.4, 0.0], [0.5, 0.3, 0.4], DQuat::from_rotation_z(0.4), 0.0, Vec3::X)
            .tube(&[[0.0, 0.4, 0.0, 0.2], [0.6, 0.8, 0.1, 0.1], [0.7, 1.2, 0.1, 0.15]], 0.2, Vec3::Y)
            .ellipsoid_pair([0.0, 0.5, 0.4], [0.2, 0.1, 0.3], DQuat::from_rotation_y(0.3), 0.1, Vec3::Z)
            .flat_base(0.2, 0.1)
    }

    #[test]
    fn gradients_agree_with_differences() {
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(5);
        let (body, step) = (body(), 1e-6);
        let mut disagreeing = 0;
        for _ in 0..2000 {
            let point = DVec3::from_array(std::array::from_fn(|_| random.random_range(-0.3..1.3)));
            let sample = body.sample(point);
            let difference = DVec3::from_array(std::array::from_fn(|axis| {
                let mut offset = DVec3::ZERO;
                offset[axis] = step;
                (body.sample(point + offset).value - body.sample(point - offset).value) / (2.0 * step)
            }));
            disagreeing += usize::from(difference.distance(sample.gradient) > 1e-5);
        }
        // A tube's radius has a kink at its joints, and differences across one are neither side's gradient.
        assert!(disagreeing <= 2, "{disagreeing}");
    }

    #[test]
    fn a_ball_is_a_distance() {
        let ball = Body::new(0.1).sphere([1.0, 2.0, 3.0], 0.5, 0.0, Vec3::ONE);
        let at = |x: f64| ball.sample(DVec3::new(1.0 + x, 2.0, 3.0));
        assert!((at(2.0).value - 1.5).abs() < 1e-12 && (at(0.1).value + 0.4).abs() < 1e-12);
        assert!(at(0.5).gradient.distance(DVec3::X) < 1e-12);
        assert!(at(0.0).value < 0.0);
    }

    #[test]
    fn pairs_are_mirror_images() {
        let body = body();
        for (x, y, z) in [(0.0, 0.5, 0.6), (0.15, 0.45, 0.5), (-0.1, 0.6, 0.4)] {
            // The tube leans to one side; these points lie where it has no say.
            let (a, b) = (body.sample(DVec3::new(x, y, z)), body.sample(DVec3::new(x, y, -z)));
            assert!((a.value - b.value).abs() < 1e-12 && a.color == b.color, "{a:?} {b:?}");
        }
    }

    #[test]
    fn parts_colour_what_is_near_them() {
        let body = Body::new(0.01).sphere([0.0; 3], 1.0, 0.0, Vec3::X).sphere([3.0, 0.0, 0.0], 1.0, 0.0, Vec3::Y);
        assert_eq!(body.sample(DVec3::X).color, Vec3::X);
        assert_eq!(body.sample(DVec3::X * 2.0).color, Vec3::Y);
        assert_eq!(body.sample(DVec3::X * 1.5).color, Vec3::new(0.5, 0.5, 0.0));
    }

    #[test]
    fn the_path_passes_through_its_points() {
        let points = [[0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 2.0], [1.0, 1.0, 0.0, 3.0]];
        let path = smooth_path(&points);
        assert_eq!(path.len(), 33);
        for (i, point) in points.iter().enumerate() {
            assert!(DVec3::from_slice(&path[16 * i]).distance(DVec3::from_slice(point)) < 1e-12);
        }
    }
}
