//! GitHub's Markdown; the second place is underlined with a tag, which Markdown lets through.

use super::{Cell, Table};

pub(super) fn write(table: &Table) -> String {
    let mut text = format!("### {}\n\n", escape(&table.title));
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
        text += &format!("\n{}\n", escape(note));
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

/// Text as Markdown shows it unchanged, in one line. What means nothing where it stands is left as it is, so that tables
/// can be read as text too: `_` within a word, `<` before a space or a digit, `&` that begins no entity.
pub(crate) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    let mut previous = ' ';
    let mut rest = text.chars().peekable();
    while let Some(character) = rest.next() {
        let next = rest.peek().copied().unwrap_or(' ');
        let special = match character {
            '\\' | '`' | '*' | '[' | ']' | '|' | '~' | '$' => true,
            '_' => !(previous.is_alphanumeric() && next.is_alphanumeric()),
            '<' => next.is_alphabetic() || matches!(next, '/' | '!' | '?'),
            '&' => next.is_alphabetic() || next == '#',
            _ => false,
        };
        if special {
            escaped.push('\\');
        }
        escaped.push(if character.is_control() { ' ' } else { character });
        previous = character;
    }
    escaped
}
