//! Points that tell their values to who points at them or moves to them by keyboard.

use super::{
    series::{Point, Series},
    style::MARK_RADIUS,
};
use crate::report::units::{percent, seconds};

/// A point of a plot: its pixel, and its values in words.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Spot {
    pub(super) pixel: (i32, i32),
    pub(super) text: String,
}

impl Spot {
    pub(super) fn of(x: i32, y: i32, text: String) -> Self {
        Self { pixel: (x, y), text }
    }

    pub(super) fn new(pixel: (i32, i32), series: &Series, point: &Point) -> Self {
        let numbers =
            if point.numbers.is_empty() { String::new() } else { format!(" ({}: {})", series.numbers, point.numbers) };
        let below = if point.resolved { "" } else { "below " };
        let time = if point.frame_secs > 0.0 { format!(", {}", seconds(point.frame_secs, 3)) } else { String::new() };
        let text = format!("{}{numbers}: {below}{}{time}", series.name, percent(point.error));
        Self { pixel, text }
    }
}

/// `svg` with a place for each spot that shows nothing but its text when it is pointed at.
pub(super) fn with_spots(svg: &str, spots: &[Spot]) -> String {
    let circles: String = spots
        .iter()
        .map(|Spot { pixel: (x, y), text }| {
            let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
            format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{MARK_RADIUS}\" tabindex=\"0\"><title>{text}</title></circle>\n")
        })
        .collect();
    let end = svg.rfind("</svg>").unwrap_or(svg.len());
    format!("{}<g fill=\"transparent\">\n{circles}</g>\n{}", &svg[..end], &svg[end..])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spots_stand_before_the_end() {
        let spot = Spot { pixel: (3, 4), text: "a <b>".into() };
        let svg = with_spots("<svg>\n<rect/></svg>\n", &[spot]);
        let circle = "<circle cx=\"3\" cy=\"4\" r=\"8\" tabindex=\"0\"><title>a &lt;b&gt;</title></circle>";
        assert_eq!(svg, format!("<svg>\n<rect/><g fill=\"transparent\">\n{circle}\n</g>\n</svg>\n"));
    }
}
