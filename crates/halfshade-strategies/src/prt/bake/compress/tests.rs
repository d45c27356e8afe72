//! Compressed tables against what is known of them.

use super::*;
use crate::shared::test_scenes::random;
use halfshade_scene::progress::Silent;

fn compressed(values: &[f32], width: usize, count: usize, components: usize) -> Clusters {
    let found = Clusters::new(&Rows::new(values, width), count, components, &Silent);
    assert!(found.fits(values.len() / width, width));
    found
}

/// Sum of squared errors, decoded in double precision.
fn error(values: &[f32], width: usize, found: &Clusters) -> f64 {
    let decoded = |row: usize, i: usize| {
        let vectors = &found.vectors[usize::from(found.of_row[row]) * (found.components + 1) * width..];
        let weights = &found.weights[row * found.components..];
        let axes = (0..found.components).map(|k| f64::from(weights[k]) * f64::from(vectors[(k + 1) * width + i]));
        f64::from(vectors[i]) + axes.sum::<f64>()
    };
    (values.iter().enumerate()).map(|(place, &x)| (f64::from(x) - decoded(place / width, place % width)).powi(2)).sum()
}

/// Points near four curves in space of 12 dimensions.
fn curves(count: usize) -> Vec<f32> {
    let mut random = random(3);
    let row = |i: usize| {
        let (t, curve) = (0.01 * i as f32, (i % 4) as f32);
        let noise: Vec<f32> = (0..12).map(|_| 0.01 * random()).collect();
        (0..12).map(move |k| ((1.0 + 0.3 * k as f32) * t + curve * k as f32).sin() + noise[k])
    };
    (0..count).flat_map(row).collect()
}

#[test]
fn all_components_are_exact() {
    let values = curves(200);
    for count in [1, 5, 1000] {
        let error = error(&values, 12, &compressed(&values, 12, count, 12));
        assert!(error < 1e-10, "{count}: {error}");
    }
    // Rows of rank 3, no more.
    let mut random = random(4);
    let basis: Vec<f32> = (0..3 * 12).map(|_| random()).collect();
    let row =
        |factors: [f32; 3]| (0..12).map(|i| (0..3).map(|k| factors[k] * basis[k * 12 + i]).sum::<f32>()).collect();
    let values: Vec<f32> = (0..50).flat_map(|_| -> Vec<f32> { row([random(), random(), random()]) }).collect();
    let found = compressed(&values, 12, 1, 12);
    assert!(error(&values, 12, &found) < 1e-10);
    assert!(error(&values, 12, &compressed(&values, 12, 1, 3)) < 1e-10);
    assert!(error(&values, 12, &compressed(&values, 12, 1, 2)) > 1e-2);
}

#[test]
fn errors_fall_with_clusters_and_components() {
    let values = curves(400);
    let table =
        [1, 4, 16, 64].map(|count| [0, 1, 2, 4].map(|k| error(&values, 12, &compressed(&values, 12, count, k))));
    for row in 0..4 {
        for column in 0..4 {
            assert!(row == 0 || table[row][column] < table[row - 1][column], "{table:?}");
            assert!(column == 0 || table[row][column] < table[row][column - 1], "{table:?}");
        }
    }
}

/// Two clusters of a few rows: the best of all ways to split them, by trying each. A local minimum needn't be that, but it is no better and not far off.
#[test]
fn few_rows_come_near_the_best_split() {
    let mut random = random(6);
    let mut ratios = Vec::new();
    for components in [0, 1] {
        for _ in 0..10 {
            let values: Vec<f32> = (0..9 * 3).map(|_| random()).collect();
            let rows = Rows::new(&values, 3);
            let split = |bits: u32| {
                let side = |side: u32| -> f64 {
                    let members: Vec<u32> = (0..9).filter(|i| bits >> i & 1 == side).collect();
                    let flat = principal::Flat::fit(&rows, &members, components);
                    let left = members.iter().map(|&row| {
                        let x = nalgebra::DVector::from_iterator(3, rows.row(row).iter().map(|&x| f64::from(x)));
                        let mut rest = x - &flat.mean;
                        flat.axes.iter().for_each(|axis| rest -= axis * axis.dot(&rest));
                        rest.norm_squared()
                    });
                    left.sum()
                };
                side(0) + side(1)
            };
            let best = (0..256).map(split).fold(f64::INFINITY, f64::min);
            let ratio = error(&values, 3, &compressed(&values, 3, 2, components)) / best;
            assert!(ratio > 1.0 - 1e-5, "{ratio}");
            ratios.push(ratio);
        }
    }
    ratios.sort_by(f64::total_cmp);
    assert!(ratios[10] < 1.3, "{ratios:?}");
}

#[test]
fn ends_are_told() {
    let none = compressed(&[], 4, 256, 8);
    assert_eq!((none.components, none.count(4)), (0, 0));
    let one = compressed(&[0.1, 0.2, 0.3, 0.4], 4, 256, 8);
    assert_eq!((one.components, &one.vectors[..4]), (0, &[0.1, 0.2, 0.3, 0.4][..]));
    let alike = compressed(&[0.5; 4 * 100], 4, 256, 8);
    assert_eq!((alike.components, &alike.vectors[..4]), (0, &[0.5; 4][..]));
    // Other clusters than rows: each is its own.
    let values = curves(40);
    let each = compressed(&values, 12, 4096, 8);
    assert_eq!((each.components, each.count(12)), (0, 40));
    assert!(error(&values, 12, &each) == 0.0);
    let huge: Vec<f32> = curves(40).into_iter().map(|x| 1e15 * x).collect();
    assert!(error(&huge, 12, &compressed(&huge, 12, 3, 2)).is_finite());
}

#[test]
fn threads_change_no_bit() {
    let values = curves(3000);
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let alone = one.install(|| compressed(&values, 12, 40, 3));
    assert_eq!(alone, compressed(&values, 12, 40, 3));
}
