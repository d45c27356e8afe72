//! Axes, curves and labels of a plot.

use super::{
    legend::legend,
    series::{Point, Series, pareto_front},
    style::{FAMILY, LEGEND_WIDTH, SIZE, mark},
};
use plotters::{
    coord::Shift,
    prelude::*,
    style::{
        FontStyle, FontTransform,
        text_anchor::{HPos, Pos, VPos},
    },
};
use std::ops::Range;

/// A chart with logarithmic axes.
type Chart<'a, B> = ChartContext<'a, B, Cartesian2d<LogCoord<f64>, LogCoord<f64>>>;

/// A place of a grid line, and its label if it has one.
type Tick = (f64, Option<String>);

/// Ranges of the axes, and their ticks.
struct Axes {
    x: Range<f64>,
    y: Range<f64>,
    x_ticks: Vec<Tick>,
    y_ticks: Vec<Tick>,
}

impl Axes {
    /// Axes that hold all points.
    fn new(series: &[Series]) -> Self {
        let points = || series.iter().flat_map(|series| &series.points);
        let x = log_range(points().map(|p| p.frame_ms));
        let y = log_range(points().flat_map(|p| [p.error, p.error + p.error_noise]));
        Self { x_ticks: ticks(&x), y_ticks: ticks(&y), x, y }
    }
}

/// Draws the whole plot, `scale` times as large as an SVG.
pub(super) fn draw<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    scale: u32,
    title: &str,
    threads: usize,
    series: &[Series],
) -> Result<(), String> {
    let px = |n: u32| n * scale;
    area.fill(&WHITE).map_err(text)?;
    let (left, right) = area.split_horizontally(px(SIZE.0 - LEGEND_WIDTH));
    let axes = Axes::new(series);
    let mut chart = ChartBuilder::on(&left)
        .caption(title, (FAMILY, px(20)).into_font().style(FontStyle::Bold))
        .margin(px(14))
        .x_label_area_size(px(52))
        .y_label_area_size(px(78))
        .build_cartesian_2d(axes.x.clone().log_scale(), axes.y.clone().log_scale())
        .map_err(text)?;
    draw_grid(&mut chart, &axes, scale).map_err(text)?;
    let mut stairs = Vec::new();
    for pair in pareto_front(series).windows(2) {
        stairs.extend([pair[0], (pair[1].0, pair[0].1), pair[1]]);
    }
    chart.draw_series(LineSeries::new(stairs, RGBColor(170, 170, 170).stroke_width(px(4)))).map_err(text)?;
    for series in series {
        let line = series.points.iter().map(|point| (point.frame_ms, point.error));
        chart.draw_series(LineSeries::new(line, series.color.mix(0.55).stroke_width(px(2)))).map_err(text)?;
        for point in &series.points {
            draw_point(&mut chart, series, point, scale).map_err(text)?;
        }
    }
    draw_labels(&left, &chart, &axes, scale, threads).map_err(text)?;
    legend(&right, scale, series)?;
    area.present().map_err(text)
}

fn text<E: std::error::Error + Send + Sync>(error: DrawingAreaErrorKind<E>) -> String {
    error.to_string()
}

/// Draws the grid and a frame at the left and the top.
fn draw_grid<B: DrawingBackend>(
    chart: &mut Chart<'_, B>,
    axes: &Axes,
    scale: u32,
) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
    let grid = |strong: bool| if strong { RGBColor(205, 205, 205) } else { RGBColor(236, 236, 236) };
    for (x, label) in &axes.x_ticks {
        let line = vec![(*x, axes.y.start), (*x, axes.y.end)];
        chart.draw_series([PathElement::new(line, grid(label.is_some()).stroke_width(scale))])?;
    }
    for (y, label) in &axes.y_ticks {
        let line = vec![(axes.x.start, *y), (axes.x.end, *y)];
        chart.draw_series([PathElement::new(line, grid(label.is_some()).stroke_width(scale))])?;
    }
    let frame = [(0, 0), (0, 1), (1, 1)].map(|(i, j)| ([axes.x.start, axes.x.end][i], [axes.y.end, axes.y.start][j]));
    chart.draw_series([PathElement::new(frame.to_vec(), RGBColor(60, 60, 60).stroke_width(scale))])?;
    Ok(())
}

/// Draws a point of a series: bars of time and of noise, a mark, its numbers.
fn draw_point<B: DrawingBackend>(
    chart: &mut Chart<'_, B>,
    series: &Series,
    point: &Point,
    scale: u32,
) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
    let px = |n: u32| n * scale;
    let thin = series.color.stroke_width(scale);
    let (x, y) = (point.frame_ms, point.error);
    let low = (x - point.frame_ms_mad).max(0.05 * x);
    chart.draw_series([PathElement::new(vec![(low, y), (x + point.frame_ms_mad, y)], thin)])?;
    let low = (y - point.error_noise).max(0.05 * y);
    chart.draw_series([PathElement::new(vec![(x, low), (x, y + point.error_noise)], thin)])?;
    let (inside, outline) = mark(series.mark, series.color, point.resolved, scale);
    chart.draw_series([EmptyElement::at((x, y)) + inside + outline])?;
    if !point.numbers.is_empty() {
        let style = (FAMILY, px(12)).into_font().color(&RGBColor(70, 70, 70));
        let offset = (px(8) as i32, -(px(16) as i32));
        chart.draw_series([EmptyElement::at((x, y)) + Text::new(point.numbers.clone(), offset, style)])?;
    }
    Ok(())
}

/// Draws labels of ticks, and titles of axes. The library labels whole decades only, and axes that hold none not at all.
fn draw_labels<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    chart: &Chart<'_, B>,
    axes: &Axes,
    scale: u32,
    threads: usize,
) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
    let px = |n: u32| n * scale;
    let labels = |size: u32, horizontal: HPos, vertical: VPos| {
        (FAMILY, px(size)).into_font().color(&RGBColor(40, 40, 40)).pos(Pos::new(horizontal, vertical))
    };
    for (x, label) in axes.x_ticks.iter().filter_map(|(x, label)| Some((x, label.as_ref()?))) {
        let (column, row) = chart.backend_coord(&(*x, axes.y.start));
        let place = (column, row + px(6) as i32);
        area.draw(&Text::new(label.as_str(), place, labels(13, HPos::Center, VPos::Top)))?;
    }
    for (y, label) in axes.y_ticks.iter().filter_map(|(y, label)| Some((y, label.as_ref()?))) {
        let (column, row) = chart.backend_coord(&(axes.x.start, *y));
        let place = (column - px(8) as i32, row);
        area.draw(&Text::new(label.as_str(), place, labels(13, HPos::Right, VPos::Center)))?;
    }
    let ((x0, y0), (x1, y1)) =
        (chart.backend_coord(&(axes.x.start, axes.y.start)), chart.backend_coord(&(axes.x.end, axes.y.end)));
    let x_title = format!("time per frame, prepare + shade, {threads} threads (ms)");
    let place = ((x0 + x1) / 2, y0 + px(30) as i32);
    area.draw(&Text::new(x_title, place, labels(15, HPos::Center, VPos::Top)))?;
    let turned = labels(15, HPos::Center, VPos::Top).transform(FontTransform::Rotate270);
    area.draw(&Text::new("relative RMSE", (px(14) as i32, (y0 + y1) / 2), turned))
}

/// The range of `values`, widened by a part of its decades on both sides.
fn log_range(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = values.fold((f64::INFINITY, 0.0f64), |(low, high), value| (low.min(value), high.max(value)));
    let margin = (0.08 * (high / low).log10()).max(0.08);
    low * 10f64.powf(-margin)..high * 10f64.powf(1.4 * margin)
}

/// Places of grid lines, and the labels of those that have one: whole decades, and twice and five times as much
/// where few decades are shown.
fn ticks(range: &Range<f64>) -> Vec<Tick> {
    let (first, last) = (range.start.log10().floor() as i32, range.end.log10().ceil() as i32);
    let labelled: &[u32] = if (range.end / range.start).log10() < 2.2 { &[1, 2, 5] } else { &[1] };
    (first..=last)
        .flat_map(|decade| (1..10u32).map(move |digit| (decade, digit)))
        .map(|(decade, digit)| (format!("{digit}e{decade}").parse().unwrap_or(f64::NAN), digit))
        .filter(|(value, _)| range.contains(value))
        .map(|(value, digit)| (value, labelled.contains(&digit).then(|| value.to_string())))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_axis_has_labels_however_short() {
        let labels = |range| ticks(&range).into_iter().filter_map(|(_, label)| label).collect::<Vec<_>>();
        assert_eq!(labels(0.03..0.4), ["0.05", "0.1", "0.2"]);
        assert_eq!(labels(0.5..2000.0), ["1", "10", "100", "1000"]);
    }
}
