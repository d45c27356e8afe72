//! GitHub's Markdown; the second place is underlined with a tag, which Markdown lets through.

use super::{Cell, Table};

pub(super) fn write(table: &Table) -> String {
    let mut text = format!("### {}\n\n", table.title);
    let heads: Vec<String> = table.columns.iter().map(|column| escape(&column.name)).collect();
    text += &format!("| {} |\n", heads.join(" | "));
    let numeric = |c: usize| table.columns[c].better.is_some() || table.rows.iter().any(|row| row[c].value.is_some());
    let rules: Vec<&str> = (0..table.columns.len()).map(|c| if numeric(c) { "---:" } else { "---" }).collect();
    text += &format!("| {} |\n", rules.join(" | "));
    for (row, places) in table.rows.iter().zip(table.places()) {
        let cells: Vec<String> = row.iter().zip(places).map(|(cell, place)| mark(cell, place)).collect();
        text += &format!("| {} |\n", cells.join(" | "));
    }
    for note in &table.notes {
        text += &format!("\n{note}\n");
    }
    text
}

fn mark(cell: &Cell, place: Option<u8>) -> String {
    let text = escape(&cell.text);
    match place {
        Some(1) => format!("**{text}**"),
        Some(_) => format!("<u>{text}</u>"),
        None => text,
    }
}

fn escape(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}
