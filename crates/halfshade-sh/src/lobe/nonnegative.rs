//! Least squares with coefficients that are not negative.

use nalgebra::{DMatrix, DVector};

/// Gradients below this part of the largest target count as 0.
const TOLERANCE: f64 = 1e-11;

/// The x ≥ 0 that minimizes `xᵀGx/2 - cᵀx`: `‖Ax - b‖²` with `G = AᵀA`, `c = Aᵀb`.
///
/// By active sets ([LawsonHanson1974, 23]): the coefficient with the steepest gradient joins, those that become
/// negative leave. At the end `x_i > 0` where the gradient `(Gx - c)_i` is 0, and `x_i = 0` where it is positive. G
/// must be square, symmetric and not indefinite, with as many rows as c; columns that depend on others keep 0. Input
/// that isn't finite gives 0.
pub(super) fn nonnegative_least_squares(gram: &DMatrix<f64>, target: &[f64]) -> Vec<f64> {
    let count = target.len();
    let mut x = vec![0.0; count];
    // Per the length of a column, so that its scale doesn't matter.
    let length = |i: usize| gram[(i, i)].max(0.0).sqrt();
    let steepness = |x: &[f64], i: usize| {
        let product: f64 = (0..count).map(|j| gram[(i, j)] * x[j]).sum();
        (target[i] - product) / length(i)
    };
    let least = TOLERANCE * (0..count).map(|i| steepness(&x, i).abs()).filter(|s| s.is_finite()).fold(0.0, f64::max);
    let mut active: Vec<usize> = Vec::new();
    let mut refused = vec![false; count];
    // Rounding may make sets recur; in practice twice the count is enough.
    for _ in 0..4 * count {
        let steepest = (0..count)
            .filter(|i| !refused[*i] && !active.contains(i))
            .map(|i| (steepness(&x, i), i))
            .filter(|(steepness, _)| *steepness > least)
            .max_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, joining)) = steepest else { break };
        active.push(joining);
        loop {
            let Some(solution) = solve(gram, target, &active) else {
                active.retain(|&i| i != joining);
                refused[joining] = true;
                break;
            };
            let share = active
                .iter()
                .zip(solution.iter())
                .filter(|(_, value)| **value <= 0.0)
                .map(|(&i, value)| (x[i] / (x[i] - value).max(f64::MIN_POSITIVE), i))
                .min_by(|a, b| a.0.total_cmp(&b.0));
            let Some((share, leaving)) = share else {
                active.iter().zip(solution.iter()).for_each(|(&i, &value)| x[i] = value);
                break;
            };
            active.iter().zip(solution.iter()).for_each(|(&i, &value)| x[i] += share * (value - x[i]));
            x[leaving] = 0.0;
            active.retain(|&i| i != leaving);
            if leaving == joining {
                refused[joining] = true;
            }
        }
    }
    x
}

/// The coefficients of some columns alone; `None` if they depend on each other.
fn solve(gram: &DMatrix<f64>, target: &[f64], active: &[usize]) -> Option<DVector<f64>> {
    let count = active.len();
    // Columns of unit length: what is left of one beside all others then tells whether it depends on them.
    let length: Vec<f64> = active.iter().map(|&i| gram[(i, i)].sqrt()).collect();
    let scaled = DMatrix::from_fn(count, count, |a, b| gram[(active[a], active[b])] / (length[a] * length[b]));
    let factors = scaled.cholesky()?;
    if factors.l_dirty().diagonal().iter().any(|left| *left < 1e-6) {
        return None;
    }
    let solution = factors.solve(&DVector::from_fn(count, |a, _| target[active[a]] / length[a]));
    let unscaled = DVector::from_fn(count, |a, _| solution[a] / length[a]);
    unscaled.iter().all(|value| value.is_finite()).then_some(unscaled)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    /// Columns with a constant part, so that they are far from orthogonal, and what they are fitted to.
    fn problem(random: &mut Pcg64Mcg, rows: usize, columns: usize) -> (DMatrix<f64>, DVector<f64>) {
        let matrix = DMatrix::from_fn(rows, columns, |_, _| 0.7 + random.random_range(-1.0..1.0));
        (matrix, DVector::from_fn(rows, |_, _| random.random_range(-1.0..2.0)))
    }

    #[test]
    fn conditions_of_an_optimum_hold() {
        let mut random = Pcg64Mcg::seed_from_u64(3);
        let (mut zero, mut positive) = (0, 0);
        for case in 0..200 {
            let columns = 1 + case % 40;
            let (matrix, vector) = problem(&mut random, 60, columns);
            let gram = matrix.tr_mul(&matrix);
            let target = matrix.tr_mul(&vector);
            let x = DVector::from_vec(nonnegative_least_squares(&gram, target.as_slice()));
            let gradient = &gram * &x - &target;
            for i in 0..columns {
                assert!(x[i] >= 0.0);
                if x[i] > 0.0 {
                    positive += 1;
                    assert!(gradient[i].abs() < 1e-9, "{case} {i}: {}", gradient[i]);
                } else {
                    zero += 1;
                    assert!(gradient[i] > -1e-9, "{case} {i}: {}", gradient[i]);
                }
            }
        }
        assert!(zero > 500 && positive > 500, "{zero} {positive}");
    }

    #[test]
    fn what_is_a_sum_of_columns_is_found() {
        let mut random = Pcg64Mcg::seed_from_u64(4);
        let (matrix, _) = problem(&mut random, 50, 20);
        let exact = DVector::from_fn(20, |i, _| if i % 3 == 0 { 0.0 } else { i as f64 });
        let gram = matrix.tr_mul(&matrix);
        let x = nonnegative_least_squares(&gram, (&gram * &exact).as_slice());
        assert!((DVector::from_vec(x) - exact).amax() < 1e-9);
    }

    #[test]
    fn equal_columns_none_and_damaged_ones() {
        let same = nonnegative_least_squares(&DMatrix::from_element(3, 3, 2.0), &[4.0; 3]);
        assert!((same.iter().sum::<f64>() - 2.0).abs() < 1e-12, "{same:?}");
        assert_eq!(nonnegative_least_squares(&DMatrix::zeros(0, 0), &[]), Vec::<f64>::new());
        assert_eq!(nonnegative_least_squares(&DMatrix::zeros(2, 2), &[1.0, 0.0]), [0.0, 0.0]);
        assert_eq!(nonnegative_least_squares(&DMatrix::identity(2, 2), &[-1.0, 3.0]), [0.0, 3.0]);
        let damaged = nonnegative_least_squares(&DMatrix::from_element(2, 2, f64::NAN), &[1.0, f64::NAN]);
        assert_eq!(damaged, [0.0, 0.0]);
    }
}
