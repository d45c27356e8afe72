//! How far the forms of visibility are from each other: random caps over the upper hemisphere under a constant sky.
//!
//! Prints the RMSE of irradiance as a fraction of the unshadowed, for the exact visibility projected to few bands, for
//! SH products and for every exponential. Two sets of caps: spread over the hemisphere, and crowded together as the
//! spheres of one object are.

use halfshade_sh::exponential::{self, Exponential, Method};
use halfshade_sh::kernel::{ExposedShares, SphericalCap8};
use halfshade_sh::logarithm::DEFAULT_CLIP;
use halfshade_sh::quadrature::SphereQuadrature;
use halfshade_sh::{basis, zonal, zonal_algebra};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::f64::consts::PI;

/// A cap of directions: its unit axis and angular radius.
type SphericalCap = ([f64; 3], f64);

fn spread(random: &mut Pcg64Mcg, count: usize) -> Vec<SphericalCap> {
    (0..count)
        .map(|_| {
            let z: f64 = random.random_range(0.0..1.0);
            let (s, c) = random.random_range(0.0..2.0 * PI).sin_cos();
            let r = (1.0 - z * z).sqrt();
            ([r * c, r * s, z], random.random_range(0.1..0.4))
        })
        .collect()
}

/// Overlapping caps within 0.4 rad of one direction.
fn crowd(random: &mut Pcg64Mcg, count: usize) -> Vec<SphericalCap> {
    let (centre, _) = spread(random, 1)[0];
    (0..count)
        .map(|_| {
            let point = centre.map(|x| x + random.random_range(-0.3..0.3));
            let length = basis::magnitude(&point);
            (point.map(|x| x / length), random.random_range(0.08..0.25))
        })
        .collect()
}

/// `1 - Σ w_i cap_i` with the caps' exposed shares.
fn by_shares(bands: usize, caps: &[SphericalCap], points: usize) -> Vec<f64> {
    let batch: Vec<SphericalCap8> =
        caps.iter().map(|&(direction, radius)| SphericalCap8::splat(direction, radius)).collect();
    let mut exposed = ExposedShares::new(points, caps.len());
    let shares = exposed.evaluate(batch);
    caps.iter().zip(shares).fold(basis::one(bands), |mut visibility, (&(axis, radius), share)| {
        let share = f64::from(share.to_array()[0]);
        let cap = zonal::rotate_to_axis(&zonal::cap(bands, radius.cos()), axis);
        visibility.iter_mut().zip(cap).for_each(|(v, c)| *v -= share * c);
        visibility
    })
}

struct Form {
    name: String,
    squared: f64,
    bias: f64,
}

fn main() {
    let bands: usize = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(4);
    let clip = std::env::args().nth(2).and_then(|text| text.parse().ok()).unwrap_or(DEFAULT_CLIP);
    let rule = SphereQuadrature::exact_to(160);
    let points: Vec<_> = rule.points().map(|(s, weight)| (s, weight, basis::evaluate(bands, s))).collect();
    let normal = [0.0, 0.0, 1.0];
    let irradiance = zonal::rotate_to_axis(&zonal::clamped_cosine(bands), normal);
    let mut methods: Vec<(String, Exponential)> = Vec::new();
    let mut add = |name: &str, method| methods.push((name.to_owned(), Exponential::new(bands, method, clip)));
    add("series 9, limit 1", Method::Series { terms: 9, magnitude_limit: Some(1.0) });
    for limit in [1.0, 2.0] {
        add(&format!("quadratic, limit {limit}"), Method::Quadratic { magnitude_limit: limit });
    }
    add("optimal-linear", Method::OptimalLinear);
    for limit in [0.25, 1.0, 2.0, 4.8] {
        add(&format!("hybrid, limit {limit}"), Method::Hybrid { magnitude_limit: limit });
    }
    for (title, set) in [("spread", spread as fn(&mut Pcg64Mcg, usize) -> Vec<SphericalCap>), ("crowded", crowd)] {
        for count in [3, 10, 30, 60] {
            let mut random = Pcg64Mcg::seed_from_u64(2026);
            let mut forms: Vec<Form> = Vec::new();
            let (sets, mut magnitudes) = (60, 0.0);
            for _ in 0..sets {
                let caps = set(&mut random, count);
                let blocked = |s: [f64; 3]| caps.iter().any(|(axis, radius)| basis::dot(axis, &s) > radius.cos());
                let mut projected = vec![0.0; bands * bands];
                let mut truth = 0.0;
                for (s, weight, y) in &points {
                    if !blocked(*s) {
                        truth += weight * s[2].max(0.0) / PI;
                        projected.iter_mut().zip(y).for_each(|(p, y)| *p += weight * y);
                    }
                }
                let logs: Vec<f64> = caps.iter().fold(vec![0.0; bands * bands], |mut sum, (axis, radius)| {
                    let log = zonal_algebra::logarithm_of_blocker(&zonal::cap(bands, radius.cos()), clip);
                    sum.iter_mut().zip(zonal::rotate_to_axis(&log, *axis)).for_each(|(s, l)| *s += l);
                    sum
                });
                magnitudes += basis::magnitude(&logs[1..]) / f64::from(sets);
                let blockers: Vec<Vec<f64>> = caps
                    .iter()
                    .map(|(axis, radius)| zonal::rotate_to_axis(&zonal::blocker(bands, radius.cos()), *axis))
                    .collect();
                let mut results = vec![
                    ("projection".to_owned(), projected),
                    (
                        "products".to_owned(),
                        exponential::product_of_blockers(bands, blockers.iter().map(Vec::as_slice)),
                    ),
                    ("full series".to_owned(), exponential::full_series(&logs)),
                ];
                for points in [4, 16] {
                    results.push((format!("exposed shares, {points}"), by_shares(bands, &caps, points)));
                }
                results.extend(methods.iter().map(|(name, method)| (name.clone(), method.evaluate(&logs))));
                for (at, (name, vector)) in results.into_iter().enumerate() {
                    if forms.len() <= at {
                        forms.push(Form { name, squared: 0.0, bias: 0.0 });
                    }
                    let error = basis::dot(&irradiance, &vector) / PI - truth;
                    forms[at].squared += error * error / f64::from(sets);
                    forms[at].bias += error / f64::from(sets);
                }
            }
            let list: Vec<String> = forms
                .iter()
                .map(|form| format!("  {:<22} {:.4}  bias {:+.4}", form.name, form.squared.sqrt(), form.bias))
                .collect();
            report(&format!(
                "{title}, {count} caps, {bands} bands, mean magnitude {magnitudes:.1}\n{}",
                list.join("\n")
            ));
        }
    }
}

#[expect(clippy::print_stdout, reason = "the example's output")]
fn report(text: &str) {
    println!("{text}");
}
