//! Ticks of logarithmic axes.

use std::ops::Range;

/// A place of a grid line, and its label if it has one.
pub(super) type Tick = (f64, Option<String>);

/// Decades from which on only whole ones are labelled.
const MANY_DECADES: f64 = 2.2;

/// Places of grid lines, and labels: whole decades, and twice and five times as much where few decades are shown; where fewer than two of
/// those lie in the range, multiples of a round step.
pub(super) fn ticks(range: &Range<f64>, label: fn(f64) -> String) -> Vec<Tick> {
    let (first, last) = (range.start.log10().floor() as i32, range.end.log10().ceil() as i32);
    let labelled: &[u32] = if (range.end / range.start).log10() < MANY_DECADES { &[1, 2, 5] } else { &[1] };
    let ticks: Vec<Tick> = (first..=last)
        .flat_map(|decade| (1..10u32).map(move |digit| (decade, digit)))
        .map(|(decade, digit)| (format!("{digit}e{decade}").parse().unwrap_or(f64::NAN), digit))
        .filter(|(value, _)| range.contains(value))
        .map(|(value, digit)| (value, labelled.contains(&digit).then(|| label(value))))
        .collect();
    if ticks.iter().filter(|(_, label)| label.is_some()).count() >= 2 {
        return ticks;
    }
    let step = round_step((range.end - range.start) / 4.0);
    let multiples = (range.start / step).ceil() as i64..=(range.end / step).floor() as i64;
    multiples.map(|count| count as f64 * step).map(|value| (value, Some(label(value)))).collect()
}

/// The largest of 1, 2, 5 times a power of ten that is not above `step`.
pub(super) fn round_step(step: f64) -> f64 {
    let decade = 10f64.powf(step.log10().floor());
    [5.0, 2.0].into_iter().map(|digit| digit * decade).find(|round| *round <= step * (1.0 + 1e-9)).unwrap_or(decade)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_axis_has_labels_however_short() {
        let labels = |range: Range<f64>| -> Vec<String> {
            ticks(&range, |value| format!("{value:.4}")).into_iter().filter_map(|(_, label)| label).collect()
        };
        assert_eq!(labels(0.03..0.4), ["0.0500", "0.1000", "0.2000"]);
        assert_eq!(labels(0.5..2000.0), ["1.0000", "10.0000", "100.0000", "1000.0000"]);
        assert_eq!(labels(0.21..0.29), ["0.2200", "0.2400", "0.2600", "0.2800"]);
        for start in [1e-9, 0.3, 7.7e5] {
            for ratio in [1.001, 1.05, 1.4, 2.0, 3.0, 9.0, 1e3] {
                let count = labels(start..start * ratio).len();
                assert!((2..=8).contains(&count), "{start} {ratio}: {count}");
            }
        }
    }
}
