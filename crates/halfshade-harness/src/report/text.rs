//! Plain text for a terminal: aligned columns, no marks.

use super::{
    page::{Block, Page},
    table::{Cell, Table},
};
use unicode_width::UnicodeWidthStr;

/// Space between columns.
const GAP: &str = "  ";

/// Titles, notes and tables with an empty line between them.
pub(super) fn page(page: &Page) -> String {
    let blocks = page.blocks.iter().filter_map(|block| match block {
        Block::Title(text) | Block::Heading(text) => Some(format!("{}\n{}\n", line(text), "=".repeat(text.width()))),
        Block::Note(text) => Some(format!("{}\n", line(text))),
        Block::Table(content) => Some(table(content)),
        Block::Plot(_) | Block::Pictures(_) => None,
    });
    blocks.collect::<Vec<_>>().join("\n")
}

/// A table under its title, numbers flush right.
pub(super) fn table(table: &Table) -> String {
    let mut text = format!("{}\n", line(&table.title));
    let numeric = |c: usize| table.rows.iter().any(|row| row[c].value.is_some());
    let heads: Vec<Cell> = table.columns.iter().map(|column| Cell::text(column.name.clone())).collect();
    let rows: Vec<&Vec<Cell>> = std::iter::once(&heads).chain(&table.rows).collect();
    // A reason in the place of figures may run on over the cells after it, which are empty.
    let runs_on = |row: &[Cell], c: usize| row[c + 1..].iter().all(|cell| cell.text.is_empty()) && c + 1 < row.len();
    let width_of = |c: usize| {
        let counted = rows.iter().filter(|row| !runs_on(row, c));
        counted.map(|row| row[c].text.width()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..table.columns.len()).map(width_of).collect();
    for row in rows {
        let cells = row.iter().enumerate().map(|(c, cell)| {
            let content = line(&cell.text);
            let space = " ".repeat(widths[c].saturating_sub(content.width()));
            if numeric(c) && !runs_on(row, c) { space + &content } else { content + &space }
        });
        text += cells.collect::<Vec<_>>().join(GAP).trim_end();
        text.push('\n');
    }
    for note in &table.notes {
        text += &format!("{}\n", line(note));
    }
    text
}

/// Text in one line, without anything that a terminal obeys.
fn line(text: &str) -> String {
    text.replace(char::is_control, " ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::table::Column;

    #[test]
    fn columns_are_aligned_and_nothing_is_marked() {
        let table = Table {
            title: "A_*b*".into(),
            columns: vec![Column::plain("method"), Column::plain("frame"), Column::plain("memory")],
            rows: vec![
                vec![Cell::text("a"), Cell::number("12.0 µs", 1.0), Cell::text("1 B")],
                vec![Cell::text("longer\x1b[1m"), Cell::number("1 s", 2.0), Cell::text("20 B")],
                vec![Cell::text("b"), Cell::text("unsupported: no"), Cell::empty()],
            ],
            notes: vec!["50 % of it".into()],
        };
        let expected = "A_*b*\n\
                        method        frame  memory\n\
                        a           12.0 µs  1 B\n\
                        longer [1m      1 s  20 B\n\
                        b           unsupported: no\n\
                        50 % of it\n";
        assert_eq!(super::table(&table), expected);
    }
}
