//! GitHub's Markdown; the second place is underlined with a tag, which Markdown lets through.

use super::{
    page::{Block, Page, Picture},
    table::{Cell, Table},
};
use crate::picture_colors::FULL_SCALE;

/// Blocks with an empty line between them.
pub(super) fn page(page: &Page) -> String {
    let blocks: Vec<String> = page.blocks.iter().map(block).filter(|text| !text.is_empty()).collect();
    blocks.join("\n")
}

fn block(block: &Block) -> String {
    match block {
        Block::Title(text) => format!("# {}\n", escape(text)),
        Block::Heading(text) => format!("## {}\n", escape(text)),
        Block::Note(text) => format!("{}\n", escape(text)),
        Block::Table(content) => table(content),
        Block::Plot(plot) => format!("![{}]({}.svg)\n", escape(&plot.title), plot.file),
        Block::Pictures(content) => pictures(content),
    }
}

fn pictures(pictures: &[Picture]) -> String {
    if pictures.is_empty() {
        return String::new();
    }
    let mut text = String::from("| strategy | picture | error (blue: too dark, vermilion: too bright) |");
    let has_flip = pictures.iter().any(|picture| picture.files.flip_png.is_some());
    text += if has_flip { " FLIP (black: none) |\n| --- | --- | --- | --- |\n" } else { "\n| --- | --- | --- |\n" };
    for Picture { files, error: told } in pictures {
        let error = files.error_png.as_ref().map(|path| format!("![error]({path})")).unwrap_or_default();
        let flip = files.flip_png.as_ref().map(|path| format!(" ![FLIP]({path}) |")).unwrap_or_default();
        let told = told.as_ref().map(|told| format!("<br>{}", escape(told))).unwrap_or_default();
        text += &format!("| {0}{told} | ![{0}]({1}) | {error} |{flip}\n", escape(&files.label), files.png);
    }
    text + &format!(
        "\nFull colour is an error of {FULL_SCALE} of the mean unshadowed radiance. The EXR files beside the pictures hold the \
         result, `truth` and `error` as layers.\n"
    )
}

/// A table under its title.
pub(super) fn table(table: &Table) -> String {
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
pub(super) fn escape(text: &str) -> String {
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
