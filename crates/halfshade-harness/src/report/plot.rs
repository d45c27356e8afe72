//! Error against time, log-log: which method to choose at which price.
//!
//! One colour per strategy, fixed by its place in the list of all (Okabe and Ito's palette, made for the colour-blind);
//! one mark per choice of words among its parameters; numbers among its parameters are written at the points, which are
//! joined in the order of time. Bars show the median absolute deviation of the time and the truth's noise in the
//! error. The grey staircase is the Pareto front: nothing measured is both faster and more exact. Unresolved errors are drawn
//! hollow, at the value that the truth can just resolve.

use super::groups::runs_of;
use crate::{
    file_names,
    image_io::png_bytes,
    results::{Results, Run},
};
use plotters::{
    coord::Shift,
    prelude::*,
    style::{
        FontStyle, FontTransform,
        text_anchor::{HPos, Pos, VPos},
    },
};
use std::sync::Once;

const PALETTE: [RGBColor; 8] = [
    RGBColor(86, 86, 86),
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(150, 110, 40),
];
const FAMILY: &str = "sans-serif";
const SIZE: (u32, u32) = (1000, 600);
const LEGEND_WIDTH: u32 = 270;

/// One measured run.
#[derive(Debug, Clone, PartialEq)]
struct Point {
    frame_ms: f64,
    frame_ms_mad: f64,
    error: f64,
    error_noise: f64,
    resolved: bool,
    /// The numbers among its parameters that differ within the series.
    numbers: String,
}

/// Runs of one strategy that differ in numbers only.
#[derive(Debug, Clone, PartialEq)]
struct Series {
    name: String,
    /// Meaning of the numbers at its points.
    numbers: String,
    color: RGBColor,
    mark: usize,
    points: Vec<Point>,
}

/// The plot of one frame of one scene, ready to be drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    /// Where its files lie, without their ending, relative to the results.
    pub file: String,
    title: String,
    threads: usize,
    series: Vec<Series>,
}

impl Plot {
    /// Error against time of all strategies; `None` if nothing was both scored and timed.
    pub fn error_against_time(results: &Results, scene: &str, frame: usize, receivers: &str) -> Option<Self> {
        let series = series(results, scene, frame, receivers);
        (!series.is_empty()).then(|| Self {
            file: file_names::plot(scene, frame, receivers),
            title: format!("{scene}, frame {frame}: error against time"),
            threads: results.machine.threads,
            series,
        })
    }

    /// As SVG text.
    pub fn svg(&self) -> Result<String, String> {
        register_font();
        let mut svg = String::new();
        draw(&SVGBackend::with_string(&mut svg, SIZE).into_drawing_area(), 1, &self.title, self.threads, &self.series)?;
        Ok(svg)
    }

    /// As PNG bytes, of twice the size, so that it stays sharp on dense screens.
    pub fn png(&self) -> Result<Vec<u8>, String> {
        register_font();
        let (width, height) = (2 * SIZE.0, 2 * SIZE.1);
        let mut pixels = vec![0; 3 * (width * height) as usize];
        {
            let area = BitMapBackend::with_buffer(&mut pixels, (width, height)).into_drawing_area();
            draw(&area, 2, &self.title, self.threads, &self.series)?;
        }
        let image = image::RgbImage::from_raw(width, height, pixels).ok_or("the bitmap has a wrong size")?;
        png_bytes(&image)
    }
}

fn register_font() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        // Both are sound font files of the crate; were one not, drawing would say so.
        let _ = plotters::style::register_font(FAMILY, FontStyle::Normal, dejavu::sans::regular());
        let _ = plotters::style::register_font(FAMILY, FontStyle::Bold, dejavu::sans::bold());
    });
}

fn series(results: &Results, scene: &str, frame: usize, receivers: &str) -> Vec<Series> {
    let runs: Vec<&Run> = runs_of(results, scene, frame, receivers)
        .filter(|run| run.reference() == "mesh" && run.frame_secs().is_some())
        .collect();
    let mut all: Vec<Series> = Vec::new();
    for run in &runs {
        // A value that most of a strategy's runs share needs no label.
        let is_usual = |key: &String, value: &serde_json::Value| {
            let own = || runs.iter().filter(|other| other.strategy == run.strategy);
            2 * own().filter(|other| other.params.get(key) == Some(value)).count() > own().count()
        };
        let words: Vec<String> = (run.params.iter())
            .filter(|(key, value)| !is_usual(key, value))
            .filter_map(|(key, value)| Some(format!("{key}={}", value.as_str()?)))
            .collect();
        let varying: Vec<&str> = run
            .params
            .iter()
            .filter(|(key, value)| {
                value.is_number()
                    && runs.iter().any(|other| other.strategy == run.strategy && other.params.get(*key) != Some(value))
            })
            .map(|(key, _)| key.as_str())
            .collect();
        let name =
            if words.is_empty() { run.strategy.clone() } else { format!("{} {}", run.strategy, words.join(" ")) };
        let (Some(error), Some(truth), Some(time)) = (&run.error, &run.truth, &run.time) else { continue };
        let (m, scale) = (&error.metrics, truth.unshadowed_mean);
        if scale.is_nan() || scale <= 0.0 {
            continue;
        }
        let value = if m.resolved { m.rmse } else { m.rmse.max(truth.rms_standard_error) } / scale;
        let mads = [time.prepare_secs, time.shade_secs].into_iter().flatten().map(|spread| spread.mad);
        let point = Point {
            frame_ms: 1e3 * run.frame_secs().unwrap_or_default(),
            frame_ms_mad: 1e3 * mads.sum::<f64>(),
            error: value,
            error_noise: m.rmse_noise / scale,
            resolved: m.resolved,
            numbers: varying.iter().map(|key| run.params[*key].to_string()).collect::<Vec<_>>().join(", "),
        };
        if !(point.frame_ms > 0.0 && point.error > 0.0) {
            continue;
        }
        match all.iter_mut().find(|series| series.name == name) {
            Some(series) => series.points.push(point),
            None => {
                let place = results.strategies.iter().position(|strategy| *strategy == run.strategy).unwrap_or(0);
                let mark = all.iter().filter(|series| series.name.split(' ').next() == Some(&run.strategy)).count();
                let color = PALETTE[place % PALETTE.len()];
                let numbers = varying.join(", ");
                all.push(Series { name, numbers, color, mark, points: vec![point] });
            }
        }
    }
    for series in &mut all {
        series.points.sort_by(|a, b| a.frame_ms.total_cmp(&b.frame_ms));
    }
    all
}

/// Points that no other beats in both time and error, in the order of time.
fn pareto_front(series: &[Series]) -> Vec<(f64, f64)> {
    let mut points: Vec<&Point> = series.iter().flat_map(|series| &series.points).collect();
    // Nothing is better than what the truth can't tell from none.
    let rank = |point: &Point| if point.resolved { point.error } else { 0.0 };
    points.sort_by(|a, b| a.frame_ms.total_cmp(&b.frame_ms).then(rank(a).total_cmp(&rank(b))));
    let mut best = f64::INFINITY;
    points.retain(|point| {
        rank(point) < best && {
            best = rank(point);
            true
        }
    });
    points.iter().map(|point| (point.frame_ms, point.error)).collect()
}

/// The range of `values`, widened by a part of its decades on both sides.
fn log_range(values: impl Iterator<Item = f64>) -> std::ops::Range<f64> {
    let (low, high) = values.fold((f64::INFINITY, 0.0f64), |(low, high), value| (low.min(value), high.max(value)));
    let margin = (0.08 * (high / low).log10()).max(0.08);
    low * 10f64.powf(-margin)..high * 10f64.powf(1.4 * margin)
}

fn draw<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    scale: u32,
    title: &str,
    threads: usize,
    series: &[Series],
) -> Result<(), String> {
    let text = |error: DrawingAreaErrorKind<B::ErrorType>| error.to_string();
    let px = |n: u32| n * scale;
    let points = || series.iter().flat_map(|series| &series.points);
    area.fill(&WHITE).map_err(text)?;
    let (left, right) = area.split_horizontally(px(SIZE.0 - LEGEND_WIDTH));
    let x_range = log_range(points().map(|p| p.frame_ms));
    let y_range = log_range(points().flat_map(|p| [p.error, p.error + p.error_noise]));
    let mut chart = ChartBuilder::on(&left)
        .caption(title, (FAMILY, px(20)).into_font().style(FontStyle::Bold))
        .margin(px(14))
        .x_label_area_size(px(52))
        .y_label_area_size(px(78))
        .build_cartesian_2d(x_range.clone().log_scale(), y_range.clone().log_scale())
        .map_err(text)?;
    let (x_ticks, y_ticks) = (ticks(&x_range), ticks(&y_range));
    let grid = |strong: bool| if strong { RGBColor(205, 205, 205) } else { RGBColor(236, 236, 236) };
    for (x, label) in &x_ticks {
        let line = vec![(*x, y_range.start), (*x, y_range.end)];
        chart.draw_series([PathElement::new(line, grid(label.is_some()).stroke_width(scale))]).map_err(text)?;
    }
    for (y, label) in &y_ticks {
        let line = vec![(x_range.start, *y), (x_range.end, *y)];
        chart.draw_series([PathElement::new(line, grid(label.is_some()).stroke_width(scale))]).map_err(text)?;
    }
    let frame =
        [(0, 0), (0, 1), (1, 1)].map(|(i, j)| ([x_range.start, x_range.end][i], [y_range.end, y_range.start][j]));
    chart.draw_series([PathElement::new(frame.to_vec(), RGBColor(60, 60, 60).stroke_width(scale))]).map_err(text)?;

    let mut stairs = Vec::new();
    for pair in pareto_front(series).windows(2) {
        stairs.extend([pair[0], (pair[1].0, pair[0].1), pair[1]]);
    }
    chart.draw_series(LineSeries::new(stairs, RGBColor(170, 170, 170).stroke_width(px(4)))).map_err(text)?;

    for series in series {
        let thin = series.color.stroke_width(scale);
        let line = series.points.iter().map(|point| (point.frame_ms, point.error));
        chart.draw_series(LineSeries::new(line, series.color.mix(0.55).stroke_width(px(2)))).map_err(text)?;
        for point in &series.points {
            let (x, y) = (point.frame_ms, point.error);
            let low = (x - point.frame_ms_mad).max(0.05 * x);
            chart.draw_series([PathElement::new(vec![(low, y), (x + point.frame_ms_mad, y)], thin)]).map_err(text)?;
            let low = (y - point.error_noise).max(0.05 * y);
            chart.draw_series([PathElement::new(vec![(x, low), (x, y + point.error_noise)], thin)]).map_err(text)?;
            let (inside, outline) = mark(series.mark, series.color, point.resolved, scale);
            chart.draw_series([EmptyElement::at((x, y)) + inside + outline]).map_err(text)?;
            if !point.numbers.is_empty() {
                let style = (FAMILY, px(12)).into_font().color(&RGBColor(70, 70, 70));
                let offset = (px(8) as i32, -(px(16) as i32));
                chart
                    .draw_series([EmptyElement::at((x, y)) + Text::new(point.numbers.clone(), offset, style)])
                    .map_err(text)?;
            }
        }
    }
    // The library labels whole decades only, and axes that hold none not at all.
    let labels = |size: u32, horizontal: HPos, vertical: VPos| {
        (FAMILY, px(size)).into_font().color(&RGBColor(40, 40, 40)).pos(Pos::new(horizontal, vertical))
    };
    for (x, label) in x_ticks.iter().filter_map(|(x, label)| Some((x, label.as_ref()?))) {
        let (column, row) = chart.backend_coord(&(*x, y_range.start));
        let place = (column, row + px(6) as i32);
        left.draw(&Text::new(label.as_str(), place, labels(13, HPos::Center, VPos::Top))).map_err(text)?;
    }
    for (y, label) in y_ticks.iter().filter_map(|(y, label)| Some((y, label.as_ref()?))) {
        let (column, row) = chart.backend_coord(&(x_range.start, *y));
        let place = (column - px(8) as i32, row);
        left.draw(&Text::new(label.as_str(), place, labels(13, HPos::Right, VPos::Center))).map_err(text)?;
    }
    let ((x0, y0), (x1, y1)) =
        (chart.backend_coord(&(x_range.start, y_range.start)), chart.backend_coord(&(x_range.end, y_range.end)));
    let x_title = format!("time per frame, prepare + shade, {threads} threads (ms)");
    let place = ((x0 + x1) / 2, y0 + px(30) as i32);
    left.draw(&Text::new(x_title, place, labels(15, HPos::Center, VPos::Top))).map_err(text)?;
    let turned = labels(15, HPos::Center, VPos::Top).transform(FontTransform::Rotate270);
    left.draw(&Text::new("relative RMSE", (px(14) as i32, (y0 + y1) / 2), turned)).map_err(text)?;

    legend(&right, scale, series)?;
    area.present().map_err(text)
}

fn legend<B: DrawingBackend>(area: &DrawingArea<B, Shift>, scale: u32, series: &[Series]) -> Result<(), String> {
    let text = |error: DrawingAreaErrorKind<B::ErrorType>| error.to_string();
    let px = |n: i32| n * scale as i32;
    let style = || (FAMILY, px(14)).into_font().color(&RGBColor(30, 30, 30)).pos(Pos::new(HPos::Left, VPos::Center));
    let mut y = px(60);
    let mut numbers: Vec<String> = Vec::new();
    for series in series {
        area.draw(&PathElement::new(vec![(px(4), y), (px(34), y)], series.color.mix(0.55).stroke_width(2 * scale)))
            .map_err(text)?;
        let (inside, outline) = mark(series.mark, series.color, true, scale);
        area.draw(&(EmptyElement::at((px(19), y)) + inside + outline)).map_err(text)?;
        for (number, line) in wrapped(&series.name).into_iter().enumerate() {
            y += if number > 0 { px(16) } else { 0 };
            area.draw(&Text::new(line, (px(44), y), style())).map_err(text)?;
        }
        y += px(24);
    }
    for series in series.iter().filter(|series| !series.numbers.is_empty()) {
        let strategy = series.name.split(' ').next().unwrap_or("");
        let line = format!("{strategy}: {}", series.numbers);
        if !numbers.contains(&line) {
            numbers.push(line);
        }
    }
    y += px(8);
    area.draw(&PathElement::new(vec![(px(4), y), (px(34), y)], RGBColor(170, 170, 170).stroke_width(4 * scale)))
        .map_err(text)?;
    area.draw(&Text::new("Pareto front", (px(44), y), style())).map_err(text)?;
    if series.iter().flat_map(|series| &series.points).any(|point| !point.resolved) {
        y += px(24);
        area.draw(&Circle::new((px(19), y), px(5), BLACK.stroke_width(scale))).map_err(text)?;
        area.draw(&Text::new("not resolved by the truth", (px(44), y), style())).map_err(text)?;
    }
    if !numbers.is_empty() {
        y += px(36);
        area.draw(&Text::new("numbers at the points:", (px(4), y), style())).map_err(text)?;
        for line in numbers {
            y += px(22);
            area.draw(&Text::new(line, (px(16), y), style())).map_err(text)?;
        }
    }
    Ok(())
}

/// Letters that fit beside a mark of the legend.
const LEGEND_LETTERS: usize = 30;

/// A name in lines that fit the legend, broken between words.
fn wrapped(name: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in name.split(' ') {
        match lines.last_mut() {
            Some(line) if line.len() + word.len() < LEGEND_LETTERS => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// A filled polygon and its outline, in pixels.
type Mark = (Polygon<(i32, i32)>, PathElement<(i32, i32)>);

/// A mark about the origin of pixels, as a polygon and its outline: circle, square, triangle, diamond, triangle upside down.
fn mark(number: usize, color: RGBColor, filled: bool, scale: u32) -> Mark {
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

/// Places of grid lines, and the labels of those that have one: whole decades, and twice and five times as much
/// where few decades are shown.
fn ticks(range: &std::ops::Range<f64>) -> Vec<(f64, Option<String>)> {
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
    use crate::results::tests::example;

    #[test]
    fn the_front_holds_what_nothing_beats() {
        let point = |frame_ms, error| Point {
            frame_ms,
            frame_ms_mad: 0.0,
            error,
            error_noise: 0.0,
            resolved: true,
            numbers: String::new(),
        };
        let front = |points| {
            pareto_front(&[Series { name: String::new(), numbers: String::new(), color: BLACK, mark: 0, points }])
        };
        let points = vec![point(1.0, 0.5), point(2.0, 0.6), point(3.0, 0.1), point(3.0, 0.2), point(4.0, 0.1)];
        assert_eq!(front(points), [(1.0, 0.5), (3.0, 0.1)]);
        let unresolved = Point { resolved: false, ..point(2.0, 0.3) };
        let slower = Point { frame_ms: 5.0, ..unresolved.clone() };
        assert_eq!(front(vec![point(1.0, 0.5), unresolved, point(3.0, 0.2), slower]), [(1.0, 0.5), (2.0, 0.3)]);
    }

    #[test]
    fn numbers_join_a_series_and_words_part_it() {
        let mut results = example();
        let mut more = results.runs[0].clone();
        more.params.insert("bands".into(), serde_json::json!(6));
        let mut other = more.clone();
        other.params.insert("exp".into(), serde_json::json!("series"));
        results.runs.extend([more, other]);
        let series = series(&results, "vases", 0, "vertices");
        let shown: Vec<(&str, usize)> = series.iter().map(|s| (s.name.as_str(), s.points.len())).collect();
        assert_eq!(shown, [("fast", 2), ("exact", 1), ("fast exp=series", 1)]);
        assert_eq!(series[0].points[1].numbers, "6");
        assert_eq!(series[0].color, series[2].color);
        assert_ne!((series[0].mark, series[0].color), (series[2].mark, series[1].color));
    }

    #[test]
    fn every_axis_has_labels_however_short() {
        let labels = |range| ticks(&range).into_iter().filter_map(|(_, label)| label).collect::<Vec<_>>();
        assert_eq!(labels(0.03..0.4), ["0.05", "0.1", "0.2"]);
        assert_eq!(labels(0.5..2000.0), ["1", "10", "100", "1000"]);
    }

    #[test]
    fn long_names_are_broken_between_words() {
        assert_eq!(wrapped("fast hybrid"), ["fast hybrid"]);
        let name = "fast solid-angle precomputed leaves center direct hybrid linear";
        let lines = wrapped(name);
        assert!(lines.len() > 1 && lines.iter().all(|line| line.len() <= LEGEND_LETTERS), "{lines:?}");
        assert_eq!(lines.join(" "), name);
    }

    #[test]
    fn both_formats_are_drawn_whole() {
        let plot = Plot::error_against_time(&example(), "vases", 0, "vertices").unwrap();
        let (svg, png) = (plot.svg().unwrap(), plot.png().unwrap());
        assert!(svg.trim_end().ends_with("</svg>") && svg.contains("relative RMSE") && svg.contains("Pareto front"));
        let image = image::load_from_memory(&png).unwrap();
        assert_eq!((image.width(), image.height()), (2 * SIZE.0, 2 * SIZE.1));
        assert!(Plot::error_against_time(&example(), "nowhere", 0, "vertices").is_none());
    }
}
