//! Size, font, colours and marks of plots.

use plotters::{prelude::*, style::FontStyle};
use std::sync::Once;

/// Colours of strategies, by their place in the list of all.
pub(super) const PALETTE: [RGBColor; 8] = [
    RGBColor(86, 86, 86),
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(150, 110, 40),
];

/// Font of all text.
pub(super) const FAMILY: &str = "sans-serif";
/// Width and height in pixels of an SVG.
pub(super) const SIZE: (u32, u32) = (1000, 600);
/// Width of the legend, within it.
pub(super) const LEGEND_WIDTH: u32 = 270;

/// Makes [`FAMILY`] known to the library.
pub(super) fn register_font() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        // Both are sound font files of the crate; were one not, drawing would say so.
        let _ = plotters::style::register_font(FAMILY, FontStyle::Normal, dejavu::sans::regular());
        let _ = plotters::style::register_font(FAMILY, FontStyle::Bold, dejavu::sans::bold());
    });
}

/// A filled polygon and its outline, in pixels.
pub(super) type Mark = (Polygon<(i32, i32)>, PathElement<(i32, i32)>);

/// A mark about the origin of pixels, as a polygon and its outline: circle, square, triangle, diamond, triangle upside down.
pub(super) fn mark(number: usize, color: RGBColor, filled: bool, scale: u32) -> Mark {
    let r = f64::from(5 * scale);
    let (corners, turn, radius) = match number % 5 {
        0 => (24, 0.0, r),
        1 => (4, 45.0, 1.25 * r),
        2 => (3, -90.0, 1.4 * r),
        3 => (4, 0.0, 1.4 * r),
        _ => (3, 90.0, 1.4 * r),
    };
    let points: Vec<(i32, i32)> = (0..=corners)
        .map(|i| {
            let angle = f64::to_radians(turn + 360.0 * f64::from(i) / f64::from(corners));
            ((radius * angle.cos()).round() as i32, (radius * angle.sin()).round() as i32)
        })
        .collect();
    let inside = if filled { color } else { WHITE };
    (Polygon::new(points.clone(), inside.filled()), PathElement::new(points, color.stroke_width(scale)))
}
