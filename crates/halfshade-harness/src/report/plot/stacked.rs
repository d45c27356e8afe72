//! Where errors come from: a bar for each strategy, stacked of what its stages contribute.
//!
//! A stage contributes its share of the mean squared error times the root of that, so that a bar's sum is the error. What errs the other
//! way, and hides errors of others, goes to the left.

use super::{
    chart::{text, title_size},
    legend::wrapped,
    spots::Spot,
    style::{FAMILY, LEGEND_WIDTH, SIZE, stage_color},
    ticks::round_step,
};
use crate::report::units::percent;
use plotters::{
    coord::Shift,
    prelude::*,
    style::{
        FontStyle,
        text_anchor::{HPos, Pos, VPos},
    },
};

/// The bar of a strategy.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Bar {
    pub(super) label: String,
    /// Stage and contribution, a fraction of the mean unshadowed radiance.
    pub(super) parts: Vec<(String, f64)>,
}

/// Pixels of a bar with the gap below it, at the least.
const ROW: u32 = 44;
/// Pixels beside the bars for labels, above them for the title, below for the axis.
const LEFT: u32 = 250;
const TOP: u32 = 50;
const BOTTOM: u32 = 60;
/// Pixels between entries of the legend.
const STEP: u32 = 26;

/// Height of a plot of these bars, in pixels of an SVG.
pub(super) fn height(bars: &[Bar]) -> u32 {
    (TOP + BOTTOM + ROW * bars.len() as u32).max(TOP + STEP * (stages(bars).len() as u32 + 1)).max(SIZE.1 / 2)
}

/// All stages, in the order in which they are met.
fn stages(bars: &[Bar]) -> Vec<&str> {
    let mut stages: Vec<&str> = Vec::new();
    for (stage, _) in bars.iter().flat_map(|bar| &bar.parts) {
        if !stages.contains(&stage.as_str()) {
            stages.push(stage);
        }
    }
    stages
}

/// Draws the bars, `scale` times as large as an SVG; returns a spot for every part.
pub(super) fn draw<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    scale: u32,
    title: &str,
    bars: &[Bar],
) -> Result<Vec<Spot>, String> {
    let px = |n: u32| (n * scale) as i32;
    area.fill(&WHITE).map_err(text)?;
    let style = |size: u32, horizontal: HPos| {
        (FAMILY, px(size)).into_font().color(&RGBColor(40, 40, 40)).pos(Pos::new(horizontal, VPos::Center))
    };
    let bold = (FAMILY, title_size(title, scale)).into_font().style(FontStyle::Bold).color(&BLACK);
    let centre = px(SIZE.0 - LEGEND_WIDTH) / 2;
    area.draw(&Text::new(title, (centre, px(TOP / 2)), bold.pos(Pos::new(HPos::Center, VPos::Center))))
        .map_err(text)?;
    let side = |bar: &Bar, sign: f64| bar.parts.iter().map(|(_, part)| (sign * part).max(0.0)).sum::<f64>();
    let reach = |sign: f64| bars.iter().map(|bar| side(bar, sign)).fold(0.0, f64::max);
    let (low, high) = (-reach(-1.0), reach(1.0).max(1e-9));
    let (x0, x1) = (px(LEFT), px(SIZE.0 - LEGEND_WIDTH - 20));
    let column = |value: f64| x0 + ((value - low) / (high - low) * f64::from(x1 - x0)).round() as i32;
    let (_, rows) = area.dim_in_pixel();
    let bottom = rows as i32 - px(BOTTOM);
    let row = (bottom - px(TOP)) / bars.len().max(1) as i32;
    let step = round_step((high - low) / 5.0);
    for tick in (low / step).ceil() as i64..=(high / step).floor() as i64 {
        let value = tick as f64 * step;
        let at = column(value);
        let grey = if tick == 0 { RGBColor(60, 60, 60) } else { RGBColor(225, 225, 225) };
        area.draw(&PathElement::new(vec![(at, px(TOP)), (at, bottom)], grey.stroke_width(scale))).map_err(text)?;
        area.draw(&Text::new(percent(value), (at, bottom + px(14)), style(13, HPos::Center))).map_err(text)?;
    }
    let axis = "contribution to the relative RMSE";
    area.draw(&Text::new(axis, ((x0 + x1) / 2, bottom + px(38)), style(14, HPos::Center))).map_err(text)?;
    let (stages, mut spots) = (stages(bars), Vec::new());
    for (number, bar) in bars.iter().enumerate() {
        let (top, middle) = (px(TOP) + number as i32 * row, px(TOP) + number as i32 * row + row / 2);
        let lines = wrapped(&bar.label.replace(',', ", "));
        for (line, label) in lines.iter().enumerate() {
            let y = middle + px(15) * (2 * line as i32 + 1 - lines.len() as i32) / 2;
            area.draw(&Text::new(label.as_str(), (x0 - px(10), y), style(13, HPos::Right))).map_err(text)?;
        }
        let mut ends = [0.0; 2];
        for (stage, part) in &bar.parts {
            let end = &mut ends[usize::from(*part < 0.0)];
            let (from, to) = (column(*end), column(*end + part));
            *end += part;
            let place = stages.iter().position(|known| known == stage).unwrap_or(0);
            let corners = [(from.min(to), top + row / 6), (from.max(to), top + row - row / 6)];
            area.draw(&Rectangle::new(corners, stage_color(place).filled())).map_err(text)?;
            spots.push(Spot::of((from + to) / 2, middle, format!("{}: {stage} {}", bar.label, percent(*part))));
        }
    }
    let left = px(SIZE.0 - LEGEND_WIDTH + 10);
    for (place, stage) in stages.iter().enumerate() {
        let y = px(TOP + STEP * place as u32 + STEP / 2);
        let corners = [(left, y - px(7)), (left + px(22), y + px(7))];
        area.draw(&Rectangle::new(corners, stage_color(place).filled())).map_err(text)?;
        area.draw(&Text::new(*stage, (left + px(32), y), style(14, HPos::Left))).map_err(text)?;
    }
    area.present().map_err(text)?;
    Ok(spots)
}
