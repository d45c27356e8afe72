//! Quantities in the unit that a person would use.

use super::significant::significant;

/// Seconds with `digits` significant digits, in the unit that leaves 1 to 999 before the point.
pub fn seconds(secs: f64, digits: usize) -> String {
    let (factor, unit) = unit_of(secs);
    format!("{} {unit}", significant(secs * factor, digits))
}

/// The same with a spread, in one unit.
pub(super) fn seconds_with_spread(secs: f64, spread: f64) -> String {
    let (factor, unit) = unit_of(secs);
    format!("{} ± {} {unit}", significant(secs * factor, 3), significant(spread * factor, 1))
}

fn unit_of(secs: f64) -> (f64, &'static str) {
    match secs.abs() {
        size if size < 0.9995e-6 && size > 0.0 => (1e9, "ns"),
        size if size < 0.9995e-3 && size > 0.0 => (1e6, "µs"),
        size if size < 0.9995 => (1e3, "ms"),
        _ => (1.0, "s"),
    }
}

/// A share as per cent.
pub fn percent(share: f64) -> String {
    format!("{} %", significant(100.0 * share, 2))
}

/// Bytes.
pub fn bytes(count: usize) -> String {
    match count {
        0..1024 => format!("{count} B"),
        1024..1_048_576 => format!("{} KiB", significant(count as f64 / 1024.0, 3)),
        1_048_576..1_073_741_824 => format!("{} MiB", significant(count as f64 / 1_048_576.0, 3)),
        _ => format!("{} GiB", significant(count as f64 / 1_073_741_824.0, 3)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_leave_one_to_three_digits_before_the_point() {
        let cases = [
            (1.79e-7, "179 ns"),
            (9.999e-7, "1.00 µs"),
            (1.8e-5, "18.0 µs"),
            (0.0, "0 ms"),
            (0.014_83, "14.8 ms"),
            (0.9999, "1.00 s"),
            (312.4, "312 s"),
        ];
        for (secs, text) in cases {
            assert_eq!(seconds(secs, 3), text);
        }
        assert_eq!(seconds_with_spread(0.001_234, 0.000_021), "1.23 ± 0.02 ms");
        assert_eq!((percent(0.0312), percent(1.234)), ("3.1 %".into(), "123 %".into()));
        assert_eq!((bytes(1000), bytes(1536), bytes(3 << 30)), ("1000 B".into(), "1.50 KiB".into(), "3.00 GiB".into()));
    }
}
