//! The Pareto front.

/// Places on the front of `points` (time, error), in the order of time: no other is at least as fast and as exact. Of equal points
/// the first.
pub fn front(points: &[(f64, f64)]) -> Vec<usize> {
    let mut places: Vec<usize> = (0..points.len()).collect();
    places.sort_by(|&a, &b| points[a].0.total_cmp(&points[b].0).then(points[a].1.total_cmp(&points[b].1)));
    let mut best = f64::INFINITY;
    places.retain(|&place| {
        let is_better = points[place].1 < best;
        best = best.min(points[place].1);
        is_better
    });
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_on_the_front_is_beaten() {
        assert_eq!(front(&[(4.0, 1.0), (2.0, 6.0), (2.0, 4.0), (2.0, 4.0), (3.0, 4.0), (1.0, 5.0)]), [5, 2, 0]);
        assert!(front(&[]).is_empty());
    }
}
