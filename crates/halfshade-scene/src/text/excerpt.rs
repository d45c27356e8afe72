//! The line of a file that an error is about, with marks under the place.

use std::{fmt, ops::Range};
use unicode_width::{UnicodeWidthChar, UnicodeWidthStr};

/// Most columns of a line that are shown.
const SHOWN_COLUMNS: usize = 100;

/// Columns that are shown before the place in a line that is longer.
const SHOWN_BEFORE: usize = 40;

/// A line of a text, with a place in it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Excerpt {
    /// Line, counted from 1.
    pub line: usize,
    /// Character in the line, counted from 1.
    pub column: usize,
    /// Printable part of the line, in three: before the place, the place itself, behind it.
    shown: [String; 3],
}

impl Excerpt {
    /// The line in which the bytes `span` of `text` begin; as much of them as it holds.
    pub fn of(text: &str, span: Range<usize>) -> Self {
        let floor = |place: usize| (0..=place.min(text.len())).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0);
        let (start, end) = (floor(span.start), floor(span.end.max(span.start)));
        let first = text[..start].rfind('\n').map_or(0, |place| place + 1);
        let last = text[start..].find('\n').map_or(text.len(), |place| start + place);
        let (before, marked, behind) = (&text[first..start], &text[start..end.min(last)], &text[end.min(last)..last]);
        Self {
            line: 1 + text[..start].matches('\n').count(),
            column: 1 + before.chars().count(),
            shown: clipped(before, marked.trim_end(), behind),
        }
    }
}

impl fmt::Display for Excerpt {
    /// Three lines, without a line's end behind the last.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [before, marked, behind] = &self.shown;
        let number = self.line.to_string();
        let margin = " ".repeat(number.len());
        let (indent, width) = (" ".repeat(before.width()), marked.width().max(1));
        let line = format!("{before}{marked}{behind}");
        write!(f, "{margin} |\n{number} | {}\n{margin} | {indent}{}", line.trim_end(), "^".repeat(width))
    }
}

/// The parts of a line as a terminal can show them: no control characters, no more columns than fit.
fn clipped(before: &str, marked: &str, behind: &str) -> [String; 3] {
    let printable = |part: &str| part.chars().map(|c| if c.is_control() { ' ' } else { c }).collect::<String>();
    let [before, marked, behind] = [before, marked, behind].map(printable);
    let before = match before.width() {
        width if width <= SHOWN_BEFORE || width + marked.width() + behind.width() <= SHOWN_COLUMNS => before,
        _ => {
            let kept: String = first_columns(before.chars().rev(), SHOWN_BEFORE).chars().rev().collect();
            format!("...{kept}")
        }
    };
    let marked = first_columns(marked.chars(), SHOWN_COLUMNS.saturating_sub(before.width()));
    let rest = SHOWN_COLUMNS.saturating_sub(before.width() + marked.width());
    let behind = if behind.width() <= rest { behind } else { first_columns(behind.chars(), rest) + "..." };
    [before, marked, behind]
}

/// The first characters, as many as fit into `columns`.
fn first_columns(characters: impl Iterator<Item = char>, columns: usize) -> String {
    let mut used = 0;
    let fits = |c: &char| {
        used += c.width().unwrap_or(0);
        used <= columns
    };
    characters.take_while(fits).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_place_is_marked_in_its_line() {
        let text = "name = \"x\"\nalbedo = [1,\n 2]\n";
        let excerpt = Excerpt::of(text, 20..28);
        assert_eq!((excerpt.line, excerpt.column), (2, 10));
        assert_eq!(excerpt.to_string(), "  |\n2 | albedo = [1,\n  |          ^^^");
        // Behind the end, and at a line's end, there is nothing to mark but the place.
        assert_eq!(Excerpt::of("a =", 3..3).to_string(), "  |\n1 | a =\n  |    ^");
        assert_eq!(Excerpt::of("a", 99..120).column, 2);
        assert_eq!(Excerpt::of("", 0..0).to_string(), "  |\n1 | \n  | ^");
    }

    #[test]
    fn marks_stand_under_wide_characters_and_lines_are_cut() {
        let text = "\tä = \"日本\" x";
        let place = text.find('x').unwrap();
        let lines: Vec<String> = Excerpt::of(text, place..place + 1).to_string().lines().map(str::to_owned).collect();
        assert_eq!(lines[1..], ["1 |  ä = \"日本\" x".to_owned(), format!("  | {}^", " ".repeat(12))]);
        let long = format!("{}HERE{}", "a".repeat(5000), "b".repeat(5000));
        let shown = Excerpt::of(&long, 5000..5004).to_string();
        assert!(shown.lines().all(|line| line.width() < 120) && shown.contains("...aaa") && shown.contains("HEREbbb"));
        assert_eq!(Excerpt::of("\u{1b}[2Jx", 0..1).to_string().matches('\u{1b}').count(), 0);
        // Spans that cut characters apart are no reason to panic.
        for (start, end) in (0..9).flat_map(|start| (0..9).map(move |end| (start, end))) {
            let _ = Excerpt::of("äöü\nß", start..end).to_string();
        }
    }
}
