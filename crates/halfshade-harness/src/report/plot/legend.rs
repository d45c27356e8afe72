//! The legend beside a plot.

use super::{
    series::Series,
    style::{FAMILY, mark},
};
use plotters::{
    coord::Shift,
    prelude::*,
    style::text_anchor::{HPos, Pos, VPos},
};

/// Draws it: a line and a mark for each series, the front, and the meaning of numbers at points.
pub(super) fn legend<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    scale: u32,
    series: &[Series],
) -> Result<(), String> {
    let text = |error: DrawingAreaErrorKind<B::ErrorType>| error.to_string();
    let px = |n: i32| n * scale as i32;
    let style = || (FAMILY, px(14)).into_font().color(&RGBColor(30, 30, 30)).pos(Pos::new(HPos::Left, VPos::Center));
    let mut y = px(60);
    let mut numbers: Vec<String> = Vec::new();
    // The lighter ones are told of together.
    let is_listed = |own: &&Series| own.name == own.kind || series.iter().all(|other| other.name != own.kind);
    for series in series.iter().filter(is_listed) {
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
    if let Some(other) = series.iter().find(|series| !is_listed(series)) {
        y += px(24);
        let device = other.name.trim_start_matches(&other.kind);
        area.draw(&Text::new(format!("lighter: the same{device}"), (px(44), y), style())).map_err(text)?;
    }
    if series.iter().flat_map(|series| &series.points).any(|point| !point.resolved) {
        y += px(24);
        area.draw(&Circle::new((px(19), y), px(5), BLACK.stroke_width(scale))).map_err(text)?;
        area.draw(&Text::new("not resolved by the truth", (px(44), y), style())).map_err(text)?;
    }
    if !numbers.is_empty() {
        y += px(36);
        area.draw(&Text::new("numbers at the points:", (px(4), y), style())).map_err(text)?;
        // Lines move together where there is little room left.
        let room = area.dim_in_pixel().1 as i32 - px(12) - y;
        let step = px(22).min(room / numbers.len() as i32);
        for line in numbers {
            y += step;
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_are_broken_between_words() {
        assert_eq!(wrapped("fast hybrid"), ["fast hybrid"]);
        let name = "fast solid-angle precomputed leaves center direct hybrid linear";
        let lines = wrapped(name);
        assert!(lines.len() > 1 && lines.iter().all(|line| line.len() <= LEGEND_LETTERS), "{lines:?}");
        assert_eq!(lines.join(" "), name);
    }
}
