//! Every exponential stays finite and within the ringing bound, whatever the blockers.

use halfshade_sh::blocker_table::{BlockerTable, Quantity};
use halfshade_sh::exponential::{Exponential, Method};
use halfshade_sh::kernel::{self, BatchExponential, LANES, MAX_BANDS, ShBatch};
use halfshade_sh::logarithm::DEFAULT_CLIP;
use halfshade_sh::{dispatch_bands, zonal};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::f64::consts::{FRAC_PI_2, PI};
use wide::f32x8;

fn methods() -> Vec<Method> {
    let mut methods = vec![Method::OptimalLinear];
    for magnitude_limit in [0.25, 1.0, 4.8] {
        methods.push(Method::Hybrid { magnitude_limit });
        methods.push(Method::Quadratic { magnitude_limit });
        methods.push(Method::Series { terms: 3, magnitude_limit: Some(magnitude_limit) });
    }
    methods.push(Method::Series { terms: 2, magnitude_limit: None });
    methods.push(Method::Series { terms: 9, magnitude_limit: None });
    methods.push(Method::Series { terms: 16, magnitude_limit: None });
    methods
}

/// Irradiance of a constant environment under any SH vector that `limit_to_visibility` lets pass, as a fraction of the
/// unshadowed, is within this of [0, 1]: with |clamped cosine| = |c| and V_0 = v sqrt(4π), the rest of V has length at
/// most sqrt(4π v(1-v)), so the fraction is v ± |ĉ| sqrt(4π v(1-v))/π, and |ĉ|² < 2π/3 - π/4.
fn ringing_bound() -> f64 {
    let isolated = (2.0 * PI / 3.0 - PI / 4.0).sqrt();
    let slope = isolated * (4.0 * PI).sqrt() / PI;
    // The largest v + slope·sqrt(v(1-v)) over v is (1 + sqrt(1 + slope²))/2.
    0.5 * ((1.0 + slope * slope).sqrt() - 1.0)
}

/// Sums of log lobes: `blockers` per lane, each (direction, angular radius) given by lane and number.
fn sums<const N: usize>(
    table: &BlockerTable,
    blockers: usize,
    mut blocker: impl FnMut(usize, usize) -> ([f64; 3], f64),
) -> ShBatch<N> {
    let mut sum = [f32x8::ZERO; N];
    for number in 0..blockers {
        let lanes: [_; LANES] = std::array::from_fn(|lane| blocker(lane, number));
        let direction = std::array::from_fn(|axis| f32x8::from(lanes.map(|(d, _)| d[axis] as f32)));
        let sin_squared = f32x8::from(lanes.map(|(_, radius)| (radius.sin() * radius.sin()) as f32));
        kernel::accumulate_lobe(direction, &table.lookup::<N>(sin_squared), &mut sum);
    }
    sum
}

fn direction(random: &mut Pcg64Mcg, hemisphere: bool) -> [f64; 3] {
    let z: f64 = if hemisphere { random.random_range(0.0..1.0) } else { random.random_range(-1.0..1.0) };
    let (s, c) = random.random_range(0.0..2.0 * PI).sin_cos();
    let r = (1.0 - z * z).sqrt();
    [r * c, r * s, z]
}

fn check<const N: usize>(sum: &ShBatch<N>, methods: &[(Exponential, BatchExponential)], what: &str) {
    let bands = N.isqrt();
    let irradiance = zonal::to_spherical(&zonal::clamped_cosine(bands));
    let bound = ringing_bound() + 1e-5;
    for (exponential, batch) in methods {
        let visibility = batch.evaluate(sum);
        for lane in 0..LANES {
            let f: Vec<f64> = sum.iter().map(|value| f64::from(value.to_array()[lane])).collect();
            let f32_form: Vec<f64> = visibility.iter().map(|value| f64::from(value.to_array()[lane])).collect();
            for (form, vector) in [("f32", f32_form), ("f64", exponential.evaluate(&f))] {
                assert!(vector.iter().all(|value| value.is_finite()), "{what}: {form} {:?}", exponential.method());
                let fraction = halfshade_sh::basis::dot(&irradiance, &vector) / PI;
                assert!(
                    (-bound..=1.0 + bound).contains(&fraction),
                    "{what}: {form} {:?} {fraction}",
                    exponential.method()
                );
            }
        }
    }
}

#[test]
fn every_exponential_is_finite_and_bounded() {
    for bands in 1..=MAX_BANDS {
        let table = BlockerTable::build(bands, Quantity::Logarithm { clip: DEFAULT_CLIP }).unwrap();
        let methods: Vec<_> = methods()
            .into_iter()
            .map(|method| {
                let exponential = Exponential::new(bands, method, DEFAULT_CLIP);
                let batch = BatchExponential::new(&exponential).unwrap();
                (exponential, batch)
            })
            .collect();
        dispatch_bands!(bands, N => {
            let mut random = Pcg64Mcg::seed_from_u64(bands as u64);
            for count in [1, 7, 60, 2000] {
                let repeated: Vec<_> = (0..LANES).map(|_| direction(&mut random, false)).collect();
                for radius in [1e-6, 1e-3, 0.1, 0.87, 0.9, FRAC_PI_2 - 1e-3, 1.57] {
                    let same = sums::<N>(&table, count, |lane, _| (repeated[lane], radius));
                    check(&same, &methods, &format!("{bands} bands, {count} times radius {radius}"));
                }
                let cover = sums::<N>(&table, count, |_, _| (direction(&mut random, true), 0.5));
                check(&cover, &methods, &format!("{bands} bands, hemisphere covered by {count}"));
                let mixed = sums::<N>(&table, count, |lane, number| {
                    let radius = FRAC_PI_2 * 10f64.powf(-6.0 * ((lane * 31 + number * 17) % 101) as f64 / 100.0);
                    (repeated[(lane + number) % LANES], radius)
                });
                check(&mixed, &methods, &format!("{bands} bands, {count} of every radius"));
            }
            for magnitude in [1e3, 1e5, 1e6f32] {
                let spike: ShBatch<N> = std::array::from_fn(|i| f32x8::splat(if i % 3 == 1 { magnitude } else { 0.0 }));
                check(&spike, &methods, &format!("{bands} bands, magnitude {magnitude}"));
            }
        })
        .unwrap();
    }
}

#[test]
fn a_covered_hemisphere_is_dark() {
    // Methods that stay accurate must get this right: 2,000 blockers over the hemisphere leave nothing.
    let table = BlockerTable::build(4, Quantity::Logarithm { clip: DEFAULT_CLIP }).unwrap();
    let mut random = Pcg64Mcg::seed_from_u64(9);
    let sum = sums::<16>(&table, 2000, |_, _| (direction(&mut random, true), 0.5));
    let hybrid = Method::Hybrid { magnitude_limit: 0.25 };
    let exponential = BatchExponential::new(&Exponential::new(4, hybrid, DEFAULT_CLIP)).unwrap();
    let visibility = exponential.evaluate(&sum);
    let irradiance = zonal::to_spherical(&zonal::clamped_cosine(4));
    for lane in 0..LANES {
        let vector: Vec<f64> = visibility.iter().map(|value| f64::from(value.to_array()[lane])).collect();
        let fraction = halfshade_sh::basis::dot(&irradiance, &vector) / PI;
        assert!(fraction.abs() < 0.05, "{fraction}");
    }
}
