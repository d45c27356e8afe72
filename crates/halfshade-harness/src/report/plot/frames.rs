//! Error and time over the frames of a scene, one above the other.

use super::{
    chart::{draw_beside, draw_curve, log_range, text, title_size},
    legend::Legend,
    series::{Point, Series},
    spots::Spot,
    style::{FAMILY, LEGEND_WIDTH, SIZE, mark},
    ticks::{round_step, ticks},
};
use crate::report::units::{percent, seconds};
use plotters::{
    coord::Shift,
    prelude::*,
    style::{
        FontStyle, FontTransform,
        text_anchor::{HPos, Pos, VPos},
    },
};

/// A figure over frames: its axis, and at a point its value and the ends of its bar.
struct Figure {
    title: &'static str,
    label: fn(f64) -> String,
    value: fn(&Point) -> (f64, [f64; 2]),
}

const FIGURES: [Figure; 2] = [
    Figure { title: "relative RMSE", label: percent, value: |point| (point.error, point.error_ends) },
    Figure {
        title: "time per frame",
        label: |secs| seconds(secs, 2),
        value: |point| {
            let (secs, mad) = (point.frame_secs, point.frame_secs_mad);
            (secs, [secs - mad, secs + mad])
        },
    },
];

/// Draws the error, and below it the time if any frame was timed, `scale` times as large as an SVG; returns all points.
pub(super) fn draw<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    scale: u32,
    title: &str,
    curves: &[Series],
) -> Result<Vec<Spot>, String> {
    let px = |n: u32| n * scale;
    area.fill(&WHITE).map_err(text)?;
    let (left, right) = area.split_horizontally(px(SIZE.0 - LEGEND_WIDTH));
    let font = (FAMILY, title_size(title, scale)).into_font().style(FontStyle::Bold);
    let left = left.titled(title, font).map_err(text)?;
    let timed = curves.iter().flat_map(|curve| &curve.points).any(|point| point.frame_secs > 0.0);
    let figures = if timed { &FIGURES[..] } else { &FIGURES[..1] };
    let mut spots = Vec::new();
    for (panel, figure) in left.split_evenly((figures.len(), 1)).iter().zip(figures) {
        spots.extend(draw_panel([panel, area], scale, figure, curves)?);
    }
    Legend::new(curves, false).draw(&right, scale)?;
    area.present().map_err(text)?;
    Ok(spots)
}

/// Draws a figure on the first of two areas; the second is the whole, whose pixels texts are placed by.
fn draw_panel<B: DrawingBackend>(
    [panel, whole]: [&DrawingArea<B, Shift>; 2],
    scale: u32,
    figure: &Figure,
    curves: &[Series],
) -> Result<Vec<Spot>, String> {
    let px = |n: u32| n * scale;
    let points = || curves.iter().flat_map(|curve| &curve.points);
    let values = points().map(figure.value).filter(|(value, _)| *value > 0.0);
    let y = log_range(values.flat_map(|(value, [_, high])| [value, high]));
    let (first, last) = points().fold((usize::MAX, 0), |(first, last), it| (first.min(it.frame), last.max(it.frame)));
    let margin = (0.06 * (last - first) as f64).max(0.5);
    let x = first as f64 - margin..last as f64 + margin;
    let mut chart = ChartBuilder::on(panel)
        .margin(px(10))
        .x_label_area_size(px(42))
        .y_label_area_size(px(82))
        .build_cartesian_2d(x.clone(), y.clone().log_scale())
        .map_err(text)?;
    let grey = |strong: bool| if strong { RGBColor(205, 205, 205) } else { RGBColor(236, 236, 236) };
    let step = round_step((last - first) as f64 / 4.0).max(1.0);
    let x_ticks: Vec<f64> =
        ((first as f64 / step).ceil() as i64..=(last as f64 / step) as i64).map(|i| i as f64 * step).collect();
    let y_ticks = ticks(&y, figure.label);
    let lines = x_ticks.iter().map(|&tick| (vec![(tick, y.start), (tick, y.end)], true));
    let lines =
        lines.chain(y_ticks.iter().map(|(tick, label)| (vec![(x.start, *tick), (x.end, *tick)], label.is_some())));
    let lines = lines.map(|(line, strong)| PathElement::new(line, grey(strong).stroke_width(scale)));
    chart.draw_series(lines.collect::<Vec<_>>()).map_err(text)?;
    let frame = vec![(x.start, y.end), (x.start, y.start), (x.end, y.start)];
    chart.draw_series([PathElement::new(frame, RGBColor(60, 60, 60).stroke_width(scale))]).map_err(text)?;
    for curve in curves {
        let shown: Vec<(f64, f64, [f64; 2], bool)> = (curve.points.iter())
            .map(|point| (point.frame as f64, (figure.value)(point), point.resolved))
            .filter(|(_, (value, _), _)| *value > 0.0)
            .map(|(frame, (value, ends), resolved)| (frame, value, ends, resolved))
            .collect();
        let line = shown.iter().map(|(frame, value, ..)| (*frame, *value)).collect();
        draw_curve(&mut chart, line, curve.look, scale).map_err(text)?;
        for (frame, value, [low, high], resolved) in shown {
            let bar = vec![(frame, low.max(0.05 * value)), (frame, high)];
            chart.draw_series([PathElement::new(bar, curve.look.color.stroke_width(scale))]).map_err(text)?;
            let (inside, outline) = mark(curve.look, resolved, scale);
            chart.draw_series([EmptyElement::at((frame, value)) + inside + outline]).map_err(text)?;
        }
    }
    // Numbers stand at the last point; all others only keep their places free.
    let mut spots = Vec::new();
    let mut texts: Vec<((i32, i32), &str)> = Vec::new();
    for curve in curves {
        for (place, point) in curve.points.iter().enumerate() {
            let (value, _) = (figure.value)(point);
            if value > 0.0 {
                let pixel = chart.backend_coord(&(point.frame as f64, value));
                spots.push(Spot::new(pixel, curve, point));
                texts.push((pixel, if place + 1 == curve.points.len() { point.numbers.as_str() } else { "" }));
            }
        }
    }
    draw_beside(whole, chart.plotting_area().get_pixel_range(), &texts, scale)?;
    let style = |size: u32, horizontal: HPos, vertical: VPos| {
        (FAMILY, px(size)).into_font().color(&RGBColor(40, 40, 40)).pos(Pos::new(horizontal, vertical))
    };
    let ((x0, y0), (x1, y1)) = (chart.backend_coord(&(x.start, y.start)), chart.backend_coord(&(x.end, y.end)));
    let mut labels = Vec::new();
    for tick in x_ticks {
        let (column, row) = chart.backend_coord(&(tick, y.start));
        labels.push(Text::new(tick.to_string(), (column, row + px(5) as i32), style(13, HPos::Center, VPos::Top)));
    }
    for (tick, label) in y_ticks.into_iter().filter_map(|(tick, label)| Some((tick, label?))) {
        let (column, row) = chart.backend_coord(&(x.start, tick));
        labels.push(Text::new(label, (column - px(8) as i32, row), style(13, HPos::Right, VPos::Center)));
    }
    labels.push(Text::new("frame".into(), ((x0 + x1) / 2, y0 + px(24) as i32), style(14, HPos::Center, VPos::Top)));
    let turned = style(14, HPos::Center, VPos::Top).transform(FontTransform::Rotate270);
    let left = x0 - px(84) as i32;
    labels.push(Text::new(figure.title.into(), (left, (y0 + y1) / 2), turned));
    labels.iter().try_for_each(|label| whole.draw(label)).map_err(text)?;
    Ok(spots)
}
