//! HTML: one file that needs nothing else, neither a network nor the files beside it.
//!
//! Tables can be sorted, points of plots tell their values, pictures lie over each other with a slider (`script.js`). Without
//! scripts everything is there to be read.

use super::{
    page::{Block, Page, Picture},
    table::Table,
};
use base64::{Engine, engine::general_purpose::STANDARD};
use std::path::{Component, Path};

const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("script.js");

/// Reads a file beside the results by its relative path; `None` if it isn't there.
pub type Read<'a> = dyn Fn(&str) -> Option<Vec<u8>> + 'a;

/// Reads the files that lie in `folder`; what leads out of it isn't read.
pub fn files_in(folder: &Path) -> impl Fn(&str) -> Option<Vec<u8>> {
    move |path: &str| {
        let stays = Path::new(path).components().all(|part| matches!(part, Component::Normal(_)));
        if stays { std::fs::read(folder.join(path)).ok() } else { None }
    }
}

/// A whole document, with the pictures that `read` finds.
pub(super) fn page(page: &Page, read: &Read<'_>) -> String {
    let title = escape(page.title());
    let headings =
        page.blocks.iter().filter_map(|block| if let Block::Heading(text) = block { Some(text) } else { None });
    let links: String =
        headings.enumerate().map(|(i, text)| format!("<li><a href=\"#part{i}\">{}</a></li>\n", escape(text))).collect();
    let contents =
        if links.is_empty() { links } else { format!("<nav aria-label=\"contents\"><ul>\n{links}</ul></nav>\n") };
    let mut parts = 0;
    let mut blocks = String::new();
    for block in &page.blocks {
        if matches!(block, Block::Heading(_)) {
            // Contents stand between the verdicts and the first part.
            if parts == 0 {
                blocks += &contents;
            }
            parts += 1;
        }
        blocks += &self::block(block, parts, read);
    }
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n<style>\n{STYLE}</style>\n\
         </head>\n<body>\n<a class=\"skip\" href=\"#part0\">to the first scene</a>\n<main>\n{blocks}</main>\n<script>\n{SCRIPT}</script>\n\
         </body>\n</html>\n"
    )
}

/// A block; `parts` is the number of headings so far, its own included.
fn block(block: &Block, parts: usize, read: &Read<'_>) -> String {
    match block {
        Block::Title(text) => format!("<h1>{}</h1>\n", escape(text)),
        Block::Heading(text) => format!("<h2 id=\"part{}\">{}</h2>\n", parts - 1, escape(text)),
        Block::Note(text) => format!("<p>{}</p>\n", escape(text)),
        Block::Table(content) => table(content),
        // One that cannot be drawn is told where plots are written as files.
        Block::Plot(plot) => {
            let svg = plot.svg_without_font().unwrap_or_default();
            let named = format!("<svg role=\"group\" aria-label=\"{}\" ", escape(&plot.title));
            format!("<div class=\"plot\">{}</div>\n", svg.replacen("<svg ", &named, 1))
        }
        Block::Pictures(pictures) if pictures.is_empty() => String::new(),
        Block::Pictures(pictures) => {
            let figures: String = pictures.iter().map(|picture| figure(picture, read)).collect();
            format!("<div class=\"gallery\">\n{figures}</div>\n")
        }
    }
}

fn figure(picture: &Picture, read: &Read<'_>) -> String {
    let label = escape(&picture.files.label);
    let image = |path: &str, class: &str, alt: &str| {
        // A picture that has gone since leaves its name.
        let source = read(path).map(|bytes| format!("data:image/png;base64,{}", STANDARD.encode(bytes)));
        source.map(|source| format!("<img class=\"{class}\" loading=\"lazy\" src=\"{source}\" alt=\"{alt}\">"))
    };
    let shown = image(&picture.files.png, "picture", &label).unwrap_or_default();
    let map = |path: &Option<String>, class: &str, name: &str| {
        path.as_ref().and_then(|path| image(path, class, &format!("{name} of {label}"))).unwrap_or_default()
    };
    let error = map(&picture.files.error_png, "error", "error");
    let flip = map(&picture.files.flip_png, "flip", "FLIP");
    let caption = picture.error.as_ref().map(|error| format!("{label}: {}", escape(error)));
    format!(
        "<figure data-label=\"{label}\">{shown}{error}{flip}<figcaption>{}</figcaption></figure>\n",
        caption.as_ref().unwrap_or(&label)
    )
}

/// A table under its title.
pub(super) fn table(table: &Table) -> String {
    let title = escape(&table.title);
    let mut text = format!("<h3>{title}</h3>\n<div class=\"wide\"><table aria-label=\"{title}\">\n<thead><tr>");
    for (c, column) in table.columns.iter().enumerate() {
        let class = if table.rows.iter().any(|row| row[c].value.is_some()) { " class=\"number\"" } else { "" };
        text += &format!("<th scope=\"col\"{class}><button type=\"button\">{}</button></th>", escape(&column.name));
    }
    text += "</tr></thead>\n<tbody>\n";
    for (row, places) in table.rows.iter().zip(table.places()) {
        text += "<tr>";
        // A reason in the place of figures has the room of all that are missing.
        let filled = row.iter().rposition(|cell| !cell.text.is_empty()).map_or(0, |last| last + 1);
        for (c, (cell, place)) in row.iter().zip(places).enumerate().take(filled) {
            let rank = match place {
                Some(1) => " best",
                Some(_) => " second",
                None => "",
            };
            let content = escape(&cell.text);
            let bound = cell.holds.map(|holds| if holds { "holds" } else { "breaks" });
            text += &match (cell.value.filter(|value| value.is_finite()), bound) {
                (Some(value), bound) => {
                    let bound = bound.map(|bound| format!(" {bound}")).unwrap_or_default();
                    format!("<td class=\"number{rank}{bound}\" data-value=\"{value:e}\">{content}</td>")
                }
                (None, Some(bound)) => format!("<td class=\"{bound}\">{content}</td>"),
                (None, None) if c + 1 == filled && filled + 1 < row.len() => {
                    format!("<td colspan=\"{}\">{content}</td>", row.len() - c)
                }
                (None, None) => format!("<td>{content}</td>"),
            };
        }
        text += "</tr>\n";
    }
    text += "</tbody>\n</table></div>\n";
    for note in &table.notes {
        text += &format!("<p class=\"note\">{}</p>\n", escape(note));
    }
    text
}

/// Text as HTML shows it unchanged.
fn escape(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;");
    text.replace(|character: char| character.is_control() && character != '\n', " ")
}
