//! A fragment of HTML.

use super::Table;

pub(super) fn write(table: &Table) -> String {
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
pub(crate) fn escape(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;");
    text.replace(|character: char| character.is_control() && character != '\n', " ")
}
