//! Axes, curves and labels of a plot.

use super::{
    labels::{Labelled, Rect, place},
    legend::Legend,
    series::{Point, Series, pareto_front},
    spots::Spot,
    style::{FAMILY, LEGEND_WIDTH, Look, MARK_RADIUS, SIZE, mark},
    ticks::{Tick, ticks},
};
use crate::report::units::{percent, seconds};
use plotters::{
    coord::{Shift, ranged1d::Ranged},
    prelude::*,
    style::{
        FontStyle, FontTransform,
        text_anchor::{HPos, Pos, VPos},
    },
};
use std::ops::Range;

/// A chart with logarithmic axes.
type Chart<'a, B> = ChartContext<'a, B, Cartesian2d<LogCoord<f64>, LogCoord<f64>>>;

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
        let x = log_range(points().map(|p| p.frame_secs));
        let y = log_range(points().flat_map(|p| [p.error, p.error_ends[1]]));
        Self { x_ticks: ticks(&x, |secs| seconds(secs, 2)), y_ticks: ticks(&y, percent), x, y }
    }
}

/// Draws the whole plot, `scale` times as large as an SVG; returns its points.
pub(super) fn draw<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    scale: u32,
    title: &str,
    threads: usize,
    series: &[Series],
) -> Result<Vec<Spot>, String> {
    let px = |n: u32| n * scale;
    area.fill(&WHITE).map_err(text)?;
    let (left, right) = area.split_horizontally(px(SIZE.0 - LEGEND_WIDTH));
    let axes = Axes::new(series);
    let mut chart = ChartBuilder::on(&left)
        .caption(title, (FAMILY, title_size(title, scale)).into_font().style(FontStyle::Bold))
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
        let line: Vec<(f64, f64)> = series.points.iter().map(|point| (point.frame_secs, point.error)).collect();
        draw_curve(&mut chart, line, series.look, scale).map_err(text)?;
        for point in &series.points {
            draw_point(&mut chart, series, point, scale).map_err(text)?;
        }
    }
    let spots = draw_numbers(&left, &chart, series, scale)?;
    draw_labels(&left, &chart, &axes, scale, threads).map_err(text)?;
    Legend::new(series, true).draw(&right, scale)?;
    area.present().map_err(text)?;
    Ok(spots)
}

pub(super) fn text<E: std::error::Error + Send + Sync>(error: DrawingAreaErrorKind<E>) -> String {
    error.to_string()
}

/// Size of the title's letters: smaller where it is long.
pub(super) fn title_size(title: &str, scale: u32) -> u32 {
    /// Letters that fit at full size.
    const LETTERS: usize = 58;
    let count = title.chars().count().max(LETTERS);
    (20 * scale) * LETTERS as u32 / count as u32
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

/// Draws a point of a series: bars of time and of error, and a mark.
fn draw_point<B: DrawingBackend>(
    chart: &mut Chart<'_, B>,
    series: &Series,
    point: &Point,
    scale: u32,
) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
    let thin = series.look.color.stroke_width(scale);
    let (x, y) = (point.frame_secs, point.error);
    let low = (x - point.frame_secs_mad).max(0.05 * x);
    chart.draw_series([PathElement::new(vec![(low, y), (x + point.frame_secs_mad, y)], thin)])?;
    let [low, high] = point.error_ends;
    chart.draw_series([PathElement::new(vec![(x, low.max(0.05 * y)), (x, high)], thin)])?;
    let (inside, outline) = mark(series.look, point.resolved, scale);
    chart.draw_series([EmptyElement::at((x, y)) + inside + outline])?;
    Ok(())
}

/// Draws the numbers of all points beside them; returns the points.
fn draw_numbers<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    chart: &Chart<'_, B>,
    series: &[Series],
    scale: u32,
) -> Result<Vec<Spot>, String> {
    let points = series.iter().flat_map(|series| series.points.iter().map(move |point| (series, point)));
    let placed = points.map(|(series, point)| {
        let pixel = chart.backend_coord(&(point.frame_secs, point.error));
        (Spot::new(pixel, series, point), (pixel, point.numbers.as_str()))
    });
    let (spots, texts): (Vec<Spot>, Vec<_>) = placed.unzip();
    draw_beside(area, chart.plotting_area().get_pixel_range(), &texts, scale)?;
    Ok(spots)
}

/// Draws each text beside its place, in pixels, within a plot's columns and rows, with a thin line to those that lie far away.
pub(super) fn draw_beside<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    (columns, rows): (Range<i32>, Range<i32>),
    texts: &[((i32, i32), &str)],
    scale: u32,
) -> Result<(), String> {
    let px = |n: u32| (n * scale) as i32;
    let grey = RGBColor(70, 70, 70);
    let style = || (FAMILY, px(12)).into_font().color(&grey).pos(Pos::new(HPos::Left, VPos::Top));
    let mut points = Vec::with_capacity(texts.len());
    for &(point, text) in texts {
        let size = match text {
            "" => (0, 0),
            text => style().font.box_size(text).map_err(|error| error.to_string())?,
        };
        points.push(Labelled { point, size: (size.0 as i32, size.1 as i32) });
    }
    let bounds = Rect { left: columns.start + px(2), top: rows.start, right: columns.end, bottom: rows.end - px(2) };
    let reach = px(MARK_RADIUS);
    for (&((x, y), numbers), label) in texts.iter().zip(place(&points, reach, bounds)) {
        let Some(Rect { left, top, right, bottom }) = label else { continue };
        let (nearest_x, nearest_y) = (x.clamp(left, right), y.clamp(top, bottom));
        let away = f64::from(nearest_x - x).hypot(f64::from(nearest_y - y));
        if away > 2.5 * f64::from(reach) {
            let line = PathElement::new(vec![(x, y), (nearest_x, nearest_y)], grey.mix(0.5).stroke_width(scale));
            area.draw(&line).map_err(text)?;
        }
        area.draw(&Text::new(numbers, (left, top), style())).map_err(text)?;
    }
    Ok(())
}

/// Draws a line in the looks of a series.
pub(super) fn draw_curve<B: DrawingBackend, X, Y>(
    chart: &mut ChartContext<'_, B, Cartesian2d<X, Y>>,
    line: Vec<(f64, f64)>,
    look: Look,
    scale: u32,
) -> Result<(), DrawingAreaErrorKind<B::ErrorType>>
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    let stroke = look.color.mix(0.55).stroke_width(2 * scale);
    match look.dash {
        None => chart.draw_series(LineSeries::new(line, stroke)).map(|_| ()),
        Some([dash, gap]) => {
            chart.draw_series(DashedLineSeries::new(line, dash * scale, gap * scale, stroke)).map(|_| ())
        }
    }
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
    let x_title = format!("time per frame, prepare + shade, {threads} threads");
    let place = ((x0 + x1) / 2, y0 + px(30) as i32);
    area.draw(&Text::new(x_title, place, labels(15, HPos::Center, VPos::Top)))?;
    let turned = labels(15, HPos::Center, VPos::Top).transform(FontTransform::Rotate270);
    area.draw(&Text::new("relative RMSE", (px(14) as i32, (y0 + y1) / 2), turned))
}

/// The range of `values`, widened by a part of its decades on both sides.
pub(super) fn log_range(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = values.fold((f64::INFINITY, 0.0f64), |(low, high), value| (low.min(value), high.max(value)));
    let margin = (0.08 * (high / low).log10()).max(0.08);
    low * 10f64.powf(-margin)..high * 10f64.powf(1.4 * margin)
}
