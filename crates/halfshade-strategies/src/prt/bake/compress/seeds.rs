//! First clusters: rows that lie far from each other, each with the rows nearest to it.
//!
//! Centres are drawn one by one, a row as likely as its squared distance from the nearest centre so far (k-means++, [Arthur2007]),
//! with numbers that are the same every time.

use super::table::{Rows, squared_distance};
use crate::shared::split_mix::split_mix;
use rayon::prelude::*;

/// The nearest centre of a row, and how far it is.
struct Nearest {
    cluster: u32,
    squared_distance: f32,
}

/// The cluster of each row, and how many there are: fewer than `count` if fewer rows differ.
pub(crate) fn seed(rows: &Rows, count: usize) -> (Vec<u32>, usize) {
    let far = |_| Nearest { cluster: 0, squared_distance: f32::INFINITY };
    let mut nearest: Vec<Nearest> = (0..rows.len()).map(far).collect();
    let mut found = 0;
    while found < count {
        let Some(centre) = draw(&nearest, found as u64) else { break };
        let centre = rows.eights(centre as u32);
        nearest.par_iter_mut().enumerate().with_min_len(256).for_each(|(number, nearest)| {
            let squared_distance = squared_distance(rows.eights(number as u32), centre);
            if squared_distance < nearest.squared_distance {
                *nearest = Nearest { cluster: found as u32, squared_distance };
            }
        });
        found += 1;
    }
    (nearest.iter().map(|nearest| nearest.cluster).collect(), found)
}

/// A row that is no centre yet.
fn draw(nearest: &[Nearest], number: u64) -> Option<usize> {
    if number == 0 {
        return (!nearest.is_empty()).then_some(0);
    }
    let total: f64 = nearest.iter().map(|nearest| f64::from(nearest.squared_distance)).sum();
    let mut rest = total * ((split_mix(number) >> 11) as f64 / (1_u64 << 53) as f64);
    let mut last = None;
    for (row, nearest) in nearest.iter().enumerate().filter(|(_, nearest)| nearest.squared_distance > 0.0) {
        last = Some(row);
        rest -= f64::from(nearest.squared_distance);
        if rest < 0.0 {
            break;
        }
    }
    last
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shared::test_scenes::random;

    #[test]
    fn rows_that_differ_are_told_apart() {
        let mut random = random(2);
        // Five heaps far from each other.
        let values: Vec<f32> = (0..200).map(|i| 100.0 * (i / 2 % 5) as f32 + random()).collect();
        let rows = Rows::new(&values, 2);
        let (clusters, found) = seed(&rows, 5);
        assert_eq!(found, 5);
        assert!((0..100).all(|i| clusters[i] == clusters[i % 5]));
        assert_eq!(seed(&rows, 1).0, [0; 100]);
        let (clusters, found) = seed(&rows, 1000);
        let mut sorted = clusters;
        sorted.sort_unstable();
        sorted.dedup();
        assert_eq!((found, sorted.len()), (100, 100));
    }

    #[test]
    fn rows_alike_are_one() {
        assert_eq!(seed(&Rows::new(&[0.5; 12], 3), 7), (vec![0; 4], 1));
        assert_eq!(seed(&Rows::new(&[], 3), 7), (vec![], 0));
    }
}
