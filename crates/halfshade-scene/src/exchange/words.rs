//! Numbers in text.

use glam::DVec3;

/// Finite numbers between blanks and commas.
pub(super) fn numbers(text: &str) -> Option<Vec<f64>> {
    text.split(|c: char| c.is_whitespace() || c == ',')
        .filter(|word| !word.is_empty())
        .map(|word| word.parse().ok().filter(|number: &f64| number.is_finite()))
        .collect()
}

/// Three numbers, or one for all.
pub(super) fn triple(text: &str) -> Option<DVec3> {
    match numbers(text)?.as_slice() {
        [all] => Some(DVec3::splat(*all)),
        [x, y, z] => Some(DVec3::new(*x, *y, *z)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_between_blanks_and_commas() {
        assert_eq!(numbers(" 1,2\t-3e2 "), Some(vec![1.0, 2.0, -300.0]));
        assert_eq!((numbers("1 nan"), numbers("1e999"), numbers("")), (None, None, Some(Vec::new())));
        assert_eq!(
            (triple("2"), triple("1, 2"), triple("1 2 3")),
            (Some(DVec3::splat(2.0)), None, Some(DVec3::new(1.0, 2.0, 3.0)))
        );
    }
}
