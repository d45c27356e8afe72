//! HTML: one file, plots within it.

use super::{
    page::{Block, Page},
    table::Table,
};
use crate::results::PictureFiles;

const STYLE: &str = "body{font:16px/1.5 sans-serif;max-width:72rem;margin:2rem auto;padding:0 1rem;color:#222}\
table{border-collapse:collapse;font-size:14px}th,td{padding:.2rem .6rem;border-bottom:1px solid #ddd;text-align:left}\
td.number{text-align:right;font-variant-numeric:tabular-nums}.pictures{display:flex;flex-wrap:wrap;gap:1rem}\
figure{margin:0}figure img{max-width:22rem;display:block}";

/// A whole document.
pub(super) fn page(page: &Page) -> String {
    let blocks: String = page.blocks.iter().map(block).collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{}</title>\n<style>{STYLE}</style>\n\
         </head>\n<body>\n{blocks}</body>\n</html>\n",
        escape(page.title())
    )
}

fn block(block: &Block) -> String {
    match block {
        Block::Title(text) => format!("<h1>{}</h1>\n", escape(text)),
        Block::Heading(text) => format!("<h2>{}</h2>\n", escape(text)),
        Block::Note(text) => format!("<p>{}</p>\n", escape(text)),
        Block::Table(content) => table(content),
        // One that cannot be drawn is told where plots are written as files.
        Block::Plot(plot) => plot.svg().unwrap_or_default(),
        Block::Pictures(files) => {
            format!("<div class=\"pictures\">\n{}</div>\n", files.iter().map(figure).collect::<String>())
        }
    }
}

fn figure(files: &PictureFiles) -> String {
    let error = files.error_png.as_ref().map(|path| format!("<img src=\"{}\" alt=\"error\">", escape(path)));
    format!(
        "<figure><img src=\"{}\" alt=\"{1}\">{2}<figcaption>{1}</figcaption></figure>\n",
        escape(&files.png),
        escape(&files.label),
        error.unwrap_or_default()
    )
}

/// A table under its title.
pub(super) fn table(table: &Table) -> String {
    let mut text = format!("<h3>{}</h3>\n<table>\n<thead><tr>", escape(&table.title));
    for column in &table.columns {
        text += &format!("<th>{}</th>", escape(&column.name));
    }
    text += "</tr></thead>\n<tbody>\n";
    for (row, places) in table.rows.iter().zip(table.places()) {
        text += "<tr>";
        for (cell, place) in row.iter().zip(places) {
            let class = if cell.value.is_some() { " class=\"number\"" } else { "" };
            let content = escape(&cell.text);
            text += &match place {
                Some(1) => format!("<td{class}><b>{content}</b></td>"),
                Some(_) => format!("<td{class}><u>{content}</u></td>"),
                None => format!("<td{class}>{content}</td>"),
            };
        }
        text += "</tr>\n";
    }
    text += "</tbody>\n</table>\n";
    for note in &table.notes {
        text += &format!("<p>{}</p>\n", escape(note));
    }
    text
}

/// Text as HTML shows it unchanged.
fn escape(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;");
    text.replace(|character: char| character.is_control() && character != '\n', " ")
}
