//! The legend beside a plot.

use super::{
    series::Series,
    style::{FAMILY, Look, SIZE, mark},
};
use plotters::{
    coord::Shift,
    element::DashedPathElement,
    prelude::*,
    style::text_anchor::{HPos, Pos, VPos},
};

/// Letters that fit beside a mark.
const LETTERS: usize = 28;

/// Pixels between the first lines of two entries, and between lines of one.
const STEP: u32 = 24;
const LINE: u32 = 17;

/// Pixels above the first entry and below the last.
const TOP: u32 = 60;
const BOTTOM: u32 = 16;

/// One entry: what stands at its left, and its lines.
struct Entry {
    sign: Sign,
    lines: Vec<String>,
}

enum Sign {
    Series(Look),
    Front,
    Hollow,
    None,
}

/// All entries of a plot: its series, the front if it shows one, marks, and the meaning of numbers at points.
pub(super) struct Legend(Vec<Entry>);

impl Legend {
    pub(super) fn new(series: &[Series], has_front: bool) -> Self {
        // The lighter ones are told of together.
        let is_listed = |own: &&Series| own.name == own.kind || series.iter().all(|other| other.name != own.kind);
        let mut entries: Vec<Entry> = Vec::new();
        let mut names: Vec<&str> = Vec::new();
        for series in series.iter().filter(is_listed) {
            if names.contains(&series.name.as_str()) {
                continue;
            }
            names.push(&series.name);
            entries.push(Entry { sign: Sign::Series(series.look), lines: wrapped(&series.name) });
        }
        if has_front {
            entries.push(Entry { sign: Sign::Front, lines: vec!["Pareto front".into()] });
        }
        if let Some(other) = series.iter().find(|series| !is_listed(series)) {
            let device = other.name.trim_start_matches(&other.kind);
            entries.push(Entry { sign: Sign::None, lines: vec![format!("lighter: the same{device}")] });
        }
        if series.iter().flat_map(|series| &series.points).any(|point| !point.resolved) {
            entries.push(Entry { sign: Sign::Hollow, lines: vec!["not resolved by the truth".into()] });
        }
        let mut numbers: Vec<String> = Vec::new();
        for series in series.iter().filter(|series| !series.numbers.is_empty()) {
            let strategy = series.name.split(' ').next().unwrap_or("");
            let line = format!("{strategy}: {}", series.numbers);
            if !numbers.contains(&line) {
                numbers.push(line);
            }
        }
        if !numbers.is_empty() {
            entries.push(Entry { sign: Sign::None, lines: vec!["numbers:".into()] });
            entries.extend(numbers.iter().map(|line| Entry { sign: Sign::None, lines: wrapped(line) }));
        }
        Self(entries)
    }

    /// Height of a plot that holds it, in pixels of an SVG.
    pub(super) fn height(&self) -> u32 {
        let lines: u32 = self.0.iter().map(|entry| STEP + LINE * (entry.lines.len() as u32 - 1)).sum();
        (TOP + lines + BOTTOM).max(SIZE.1)
    }

    pub(super) fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>, scale: u32) -> Result<(), String> {
        let text = |error: DrawingAreaErrorKind<B::ErrorType>| error.to_string();
        let px = |n: u32| (n * scale) as i32;
        let style =
            || (FAMILY, px(14)).into_font().color(&RGBColor(30, 30, 30)).pos(Pos::new(HPos::Left, VPos::Center));
        let mut y = px(TOP);
        for Entry { sign, lines } in &self.0 {
            let line = vec![(px(4), y), (px(38), y)];
            match sign {
                Sign::Series(look) => {
                    draw_line(area, line, look, scale).map_err(text)?;
                    let (inside, outline) = mark(*look, true, scale);
                    area.draw(&(EmptyElement::at((px(21), y)) + inside + outline)).map_err(text)?;
                }
                Sign::Front => {
                    let grey = RGBColor(170, 170, 170).stroke_width(4 * scale);
                    area.draw(&PathElement::new(line, grey)).map_err(text)?;
                }
                Sign::Hollow => {
                    area.draw(&Circle::new((px(21), y), px(5), BLACK.stroke_width(scale))).map_err(text)?;
                }
                Sign::None => {}
            }
            for (number, line) in lines.iter().enumerate() {
                y += if number > 0 { px(LINE) } else { 0 };
                area.draw(&Text::new(line.as_str(), (px(48), y), style())).map_err(text)?;
            }
            y += px(STEP);
        }
        Ok(())
    }
}

/// A line in the looks of a series.
fn draw_line<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    line: Vec<(i32, i32)>,
    look: &Look,
    scale: u32,
) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
    let stroke = look.color.mix(0.55).stroke_width(2 * scale);
    match look.dash {
        None => area.draw(&PathElement::new(line, stroke)),
        Some([dash, gap]) => area.draw(&DashedPathElement::new(line, dash * scale, gap * scale, stroke)),
    }
}

/// A text in lines that fit the legend, broken between words.
pub(super) fn wrapped(text: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if line.chars().count() + word.chars().count() < LETTERS => {
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
        assert!(lines.len() > 1 && lines.iter().all(|line| line.len() <= LETTERS), "{lines:?}");
        assert_eq!(lines.join(" "), name);
    }
}
