//! LaTeX: a `tabular` for the packages booktabs and (to keep it in the text's width) graphicx.

use super::{page::Page, table::Table};

/// The tables alone: what else a paper says is its own.
pub(super) fn page(page: &Page) -> String {
    page.tables().map(|content| table(content, &page.provenance) + "\n").collect()
}

/// A table with its caption, and in a comment where it comes from.
pub(super) fn table(table: &Table, provenance: &str) -> String {
    let numeric = |c: usize| table.columns[c].better.is_some() || table.rows.iter().any(|row| row[c].value.is_some());
    let alignment: String = (0..table.columns.len()).map(|c| if numeric(c) { 'r' } else { 'l' }).collect();
    let mut text = format!("% {}\n", provenance.replace(['\n', '\r'], " "));
    text += &format!("\\begin{{table}}\n\\centering\n\\caption{{{}}}\n", escape(&table.title));
    text += &format!("\\resizebox{{\\linewidth}}{{!}}{{%\n\\begin{{tabular}}{{{alignment}}}\n\\toprule\n");
    let heads: Vec<String> = table.columns.iter().map(|column| escape(&column.name)).collect();
    text += &format!("{} \\\\\n\\midrule\n", heads.join(" & "));
    for (row, places) in table.rows.iter().zip(table.places()) {
        let cells: Vec<String> = row
            .iter()
            .zip(places)
            .map(|(cell, place)| match place {
                Some(1) => format!("\\textbf{{{}}}", escape(&cell.text)),
                Some(_) => format!("\\underline{{{}}}", escape(&cell.text)),
                None => escape(&cell.text),
            })
            .collect();
        text += &format!("{} \\\\\n", cells.join(" & "));
    }
    text += "\\bottomrule\n\\end{tabular}}\n";
    for note in &table.notes {
        text += &format!("\n\\footnotesize {}\n", escape(note));
    }
    text + "\\end{table}\n"
}

fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => escaped.extend(['\\', character]),
            '\\' => escaped.push_str("\\textbackslash{}"),
            '<' => escaped.push_str("\\textless{}"),
            '>' => escaped.push_str("\\textgreater{}"),
            '|' => escaped.push_str("\\textbar{}"),
            '`' => escaped.push_str("\\textasciigrave{}"),
            // After the end of a row these two would be its options; a straight quote may be active.
            '[' | ']' | '*' | '"' => escaped.extend(['{', character, '}']),
            // Two in turn would be joined to a dash.
            '-' if escaped.ends_with('-') => escaped.push_str("{}-"),
            '~' => escaped.push_str("\\textasciitilde{}"),
            '^' => escaped.push_str("\\textasciicircum{}"),
            '±' => escaped.push_str("$\\pm$"),
            '✓' => escaped.push_str("$\\surd$"),
            '✗' => escaped.push_str("$\\times$"),
            '≤' => escaped.push_str("$\\le$"),
            _ if character.is_control() => escaped.push(' '),
            _ => escaped.push(character),
        }
    }
    escaped
}
