use super::*;
use crate::exponential::{Exponential, Method};
use crate::logarithm::DEFAULT_CLIP;
use crate::{zonal, zonal_algebra};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

fn random<const N: usize>(random: &mut Pcg64Mcg) -> [[f64; N]; LANES] {
    std::array::from_fn(|_| std::array::from_fn(|_| f64::from(random.random_range(-1.0f32..1.0))))
}

fn gather<const N: usize>(vectors: &[[f64; N]; LANES]) -> ShBatch<N> {
    std::array::from_fn(|i| f32x8::from(std::array::from_fn::<f32, LANES, _>(|lane| vectors[lane][i] as f32)))
}

fn lane<const N: usize>(batch: &ShBatch<N>, lane: usize) -> [f64; N] {
    std::array::from_fn(|i| f64::from(batch[i].to_array()[lane]))
}

fn assert_close(actual: &[f64], expected: &[f64], scale: f64) {
    assert_eq!(actual.len(), expected.len());
    for (a, e) in actual.iter().zip(expected) {
        assert!((a - e).abs() < 1e-5 * scale, "{a} {e}");
    }
}

#[test]
fn products_and_squares_agree_with_f64() {
    let mut generator = Pcg64Mcg::seed_from_u64(1);
    for bands in 1..=MAX_BANDS {
        dispatch_bands!(bands, N => {
            let (f, g) = (random::<N>(&mut generator), random::<N>(&mut generator));
            let batch = product(&gather(&f), &gather(&g));
            let squares = square(&gather(&f));
            for at in 0..LANES {
                let expected = crate::product::product(&f[at], &g[at]);
                let scale = crate::basis::magnitude(&expected);
                assert_close(&lane(&batch, at), &expected, scale);
                let (f32s, g32s) = (f[at].map(|x| x as f32), g[at].map(|x| x as f32));
                assert_close(&product_one(&f32s, &g32s).map(f64::from), &expected, scale);
                let expected = crate::product::square(&f[at]);
                let scale = crate::basis::magnitude(&expected);
                assert_close(&lane(&squares, at), &expected, scale);
                assert_close(&square_one(&f32s).map(f64::from), &expected, scale);
            }
        })
        .unwrap();
    }
}

#[test]
fn basis_and_lobes_agree_with_f64() {
    let mut generator = Pcg64Mcg::seed_from_u64(2);
    for bands in 1..=MAX_BANDS {
        dispatch_bands!(bands, N => {
            let directions: [[f64; 3]; LANES] = random::<3>(&mut generator).map(|d| {
                let length = crate::basis::magnitude(&d);
                d.map(|x| x / length)
            });
            let values: [f32x8; N] = basis(gather(&directions));
            let zonal: Vec<f64> = (0..bands).map(|l| 1.0 / (l + 1) as f64).collect();
            let scale: Vec<f32x8> = (0..bands).map(|l| f32x8::splat((zonal[l] * crate::zonal::rotation_scale(l)) as f32)).collect();
            let mut sum = [f32x8::splat(0.5); N];
            accumulate_lobe(gather(&directions), &scale, &mut sum);
            for (at, &direction) in directions.iter().enumerate() {
                let expected = crate::basis::evaluate(bands, direction);
                assert_close(&lane(&values, at), &expected, crate::basis::magnitude(&expected));
                let lobe: Vec<f64> = crate::zonal::rotate_to_axis(&zonal, direction).iter().map(|x| x + 0.5).collect();
                assert_close(&lane(&sum, at), &lobe, 1.0);
            }
        })
        .unwrap();
    }
    assert!(dispatch_bands!(9, N => N).is_none());
}

/// Sums of random log blockers, one per lane, of growing number: from 0 to 7 times `most`/7.
fn log_sums<const N: usize>(generator: &mut Pcg64Mcg, most: usize) -> [[f64; N]; LANES] {
    let bands = N.isqrt();
    std::array::from_fn(|lane| {
        let mut sum = [0.0; N];
        for _ in 0..lane * most / 7 {
            let direction: [f64; 3] = std::array::from_fn(|_| generator.random_range(-1.0..1.0));
            let length = crate::basis::magnitude(&direction);
            let radius = generator.random_range(0.02f64..0.7);
            let log = zonal_algebra::logarithm(&zonal::blocker(bands, radius.cos()), DEFAULT_CLIP);
            let lobe = zonal::rotate_to_axis(&log, direction.map(|x| x / length));
            sum.iter_mut().zip(lobe).for_each(|(s, l)| *s += l);
        }
        sum.map(|x| f64::from(x as f32))
    })
}

fn methods() -> [Method; 6] {
    [
        Method::Quadratic { magnitude_limit: 1.0 },
        Method::Series { terms: 4, magnitude_limit: None },
        Method::Series { terms: 4, magnitude_limit: Some(1.0) },
        Method::OptimalLinear,
        Method::Hybrid { magnitude_limit: 0.25 },
        Method::Hybrid { magnitude_limit: 4.8 },
    ]
}

#[test]
fn exponentials_agree_with_f64() {
    let mut generator = Pcg64Mcg::seed_from_u64(3);
    for bands in 1..=MAX_BANDS {
        for (method, blended) in methods().into_iter().flat_map(|method| [(method, false), (method, true)]) {
            let exponential = Exponential::new(bands, method, DEFAULT_CLIP);
            let exponential = if blended { exponential.blended() } else { exponential };
            let batch_exponential = BatchExponential::new(&exponential).unwrap();
            dispatch_bands!(bands, N => {
                let sums = log_sums::<N>(&mut generator, 14);
                let batch = batch_exponential.evaluate(&gather(&sums));
                let weights = gather(&random::<N>(&mut generator));
                let dots = batch_exponential.evaluate_dot(&gather(&sums), &weights).to_array();
                for (at, sum) in sums.iter().enumerate() {
                    let expected = exponential.evaluate(sum);
                    assert_close(&lane(&batch, at), &expected, 3.6);
                    let dot = crate::basis::dot(&expected, &lane(&weights, at));
                    assert_close(&[f64::from(dots[at])], &[dot], 3.6 * (1.0 + dot.abs()));
                }
            })
            .unwrap();
        }
    }
}

#[test]
fn thousands_of_blockers_cost_one_digit() {
    // Squaring values near 1 instead of their difference from 1 would lose more: 13 squarings double a rounding error
    // 13 times.
    let mut generator = Pcg64Mcg::seed_from_u64(5);
    for method in [Method::Hybrid { magnitude_limit: 0.25 }, Method::Quadratic { magnitude_limit: 1.0 }] {
        let exponential = Exponential::new(4, method, DEFAULT_CLIP);
        let batch_exponential = BatchExponential::new(&exponential).unwrap();
        // One direction repeated, so that half the sphere stays open however many there are.
        let sums: [[f64; 16]; LANES] = std::array::from_fn(|lane| {
            let log = zonal_algebra::logarithm(&zonal::blocker(4, 1.2f64.cos()), DEFAULT_CLIP);
            let axis: [f64; 3] = std::array::from_fn(|_| generator.random_range(-1.0..1.0));
            let length = crate::basis::magnitude(&axis);
            let lobe = zonal::rotate_to_axis(&log, axis.map(|x| x / length));
            std::array::from_fn(|i| f64::from((lobe[i] * (300 * lane) as f64) as f32))
        });
        let batch = batch_exponential.evaluate(&gather(&sums));
        for (at, sum) in sums.iter().enumerate() {
            assert_close(&lane(&batch, at), &exponential.evaluate(sum), 36.0);
        }
    }
}

#[test]
fn neighbours_change_no_bit() {
    let mut generator = Pcg64Mcg::seed_from_u64(4);
    for method in methods() {
        let exponential = BatchExponential::new(&Exponential::new(4, method, DEFAULT_CLIP).blended()).unwrap();
        let sums = log_sums::<16>(&mut generator, 70);
        let together = exponential.evaluate(&gather(&sums));
        for (at, sum) in sums.iter().enumerate() {
            let mut alone = [[0.0; 16]; LANES];
            alone[5] = *sum;
            let alone = exponential.evaluate(&gather(&alone));
            assert_eq!(lane(&alone, 5), lane(&together, at), "{method:?}");
        }
    }
}
