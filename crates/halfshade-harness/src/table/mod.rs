//! Tables: one model, and a file per format that writes it.

mod by_class;
mod csv_format;
mod details;
mod differences;
pub(crate) mod html;
mod latex;
pub(crate) mod markdown;
mod views;

pub use by_class::error_by_class;
pub use details::details;
pub use differences::differences;
use views::relative_rmse;
pub use views::{error_split, results_csv, scene_table};
pub(crate) use views::{groups, runs_of};

/// A table.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// What it shows.
    pub title: String,
    /// Column by column.
    pub columns: Vec<Column>,
    /// Row by row, each with a cell per column.
    pub rows: Vec<Vec<Cell>>,
    /// Sentences below: what is meant, what is not.
    pub notes: Vec<String>,
}

/// One column.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Its head.
    pub name: String,
    /// Which way is better, if one is: the best cell is set bold, the second underlined.
    pub better: Option<Better>,
}

/// Which way is better.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Better {
    /// Small numbers.
    Lower,
    /// Large numbers.
    Higher,
}

/// One cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// What is shown.
    pub text: String,
    /// What is ranked; nothing for text.
    pub value: Option<f64>,
}

/// Formats of tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// GitHub's Markdown.
    Markdown,
    /// Comma-separated values.
    Csv,
    /// LaTeX with booktabs.
    Latex,
    /// A fragment of HTML.
    Html,
}

impl Column {
    /// A column of text, or of numbers without a winner.
    pub fn plain(name: impl Into<String>) -> Self {
        Self { name: name.into(), better: None }
    }

    /// A column with a winner.
    pub fn ranked(name: impl Into<String>, better: Better) -> Self {
        Self { name: name.into(), better: Some(better) }
    }
}

impl Cell {
    /// Text.
    pub fn text(text: impl Into<String>) -> Self {
        Self { text: text.into(), value: None }
    }

    /// A number.
    pub fn number(text: impl Into<String>, value: f64) -> Self {
        Self { text: text.into(), value: Some(value) }
    }

    /// An error that the truth can't tell from none: the best there is, whatever its size, and as good as any other such.
    pub fn unresolved(text: impl Into<String>) -> Self {
        Self::number(text, 0.0)
    }

    /// Nothing.
    pub fn empty() -> Self {
        Self::text("")
    }
}

impl Table {
    /// In `format`; `provenance` says where the numbers come from, in one line.
    pub fn write(&self, format: Format, provenance: &str) -> String {
        match format {
            Format::Markdown => markdown::write(self),
            Format::Csv => csv_format::write(self),
            Format::Latex => latex::write(self, provenance),
            Format::Html => html::write(self),
        }
    }

    /// The place of each cell within its column: 1 for the best, 2 for the second, `None` for all others. Equal values
    /// share a place. Columns with fewer than two values have no winner.
    fn places(&self) -> Vec<Vec<Option<u8>>> {
        let mut places = vec![vec![None; self.columns.len()]; self.rows.len()];
        for (c, column) in self.columns.iter().enumerate() {
            let Some(better) = column.better else { continue };
            let mut values: Vec<f64> =
                self.rows.iter().filter_map(|row| row[c].value).filter(|value| value.is_finite()).collect();
            if values.len() < 2 {
                continue;
            }
            values.sort_by(f64::total_cmp);
            if better == Better::Higher {
                values.reverse();
            }
            values.dedup();
            for (row, places) in self.rows.iter().zip(&mut places) {
                places[c] = match row[c].value {
                    Some(value) if values.first() == Some(&value) => Some(1),
                    Some(value) if values.get(1) == Some(&value) => Some(2),
                    _ => None,
                };
            }
        }
        places
    }
}

/// A number with `digits` significant digits, without a needless exponent.
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { "0".into() } else { value.to_string() };
    }
    // Rounding first, so that 9.996 counts as 10.0.
    let scientific = format!("{:.*e}", digits.saturating_sub(1), value);
    let exponent: i32 = scientific.split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0);
    if (-5..6).contains(&exponent) {
        format!("{value:.*}", (digits as i32 - 1 - exponent).max(0) as usize)
    } else {
        scientific
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(super) fn small() -> Table {
        Table {
            title: "A & B".into(),
            columns: vec![
                Column::plain("method"),
                Column::ranked("error", Better::Lower),
                Column::ranked("fps", Better::Higher),
            ],
            rows: vec![
                vec![Cell::text("a_1"), Cell::number("0.5", 0.5), Cell::number("10", 10.0)],
                vec![Cell::text("b|2"), Cell::number("0.1", 0.1), Cell::number("20", 20.0)],
                vec![Cell::text("c<3"), Cell::text("no light"), Cell::number("10", 10.0)],
            ],
            notes: vec!["50% of it".into()],
        }
    }

    #[test]
    fn markdown() {
        let expected = "### A & B\n\n\
            | method | error | fps |\n\
            | --- | ---: | ---: |\n\
            | a_1 | 0.5 | 10 |\n\
            | b\\|2 | **0.1** | **20** |\n\
            | c<3 | no light | 10 |\n\n\
            50% of it\n";
        let underlined = expected.replace("| a_1 | 0.5 | 10 |", "| a_1 | <u>0.5</u> | <u>10</u> |");
        let underlined = underlined.replace("| no light | 10 |", "| no light | <u>10</u> |");
        assert_eq!(small().write(Format::Markdown, ""), underlined);
    }

    #[test]
    fn latex_has_booktabs_and_says_where_it_comes_from() {
        let text = small().write(Format::Latex, "halfshade 1\nnot a command");
        assert!(text.starts_with("% halfshade 1 not a command\n"), "{text}");
        assert!(text.contains("\\toprule") && text.contains("\\bottomrule") && text.contains("\\begin{tabular}{lrr}"));
        assert!(text.contains("a\\_1 & \\underline{0.5} & \\underline{10} \\\\"), "{text}");
        // In the fonts that LaTeX starts with, a bare bar prints as a dash.
        assert!(text.contains("b\\textbar{}2 & \\textbf{0.1} & \\textbf{20} \\\\"), "{text}");
        assert!(text.contains("A \\& B") && text.contains("50\\% of it"), "{text}");
    }

    #[test]
    fn what_is_not_resolved_is_best_in_every_format() {
        let mut table = small();
        table.rows[2][1] = Cell::unresolved("not resolved");
        table.rows.push(vec![Cell::text("d"), Cell::unresolved("not resolved"), Cell::number("5", 5.0)]);
        let markdown = table.write(Format::Markdown, "");
        assert_eq!(markdown.matches("**not resolved**").count(), 2, "{markdown}");
        assert!(markdown.contains("| <u>0.1</u> |") && markdown.contains("| a_1 | 0.5 |"), "{markdown}");
        let latex = table.write(Format::Latex, "");
        assert_eq!(latex.matches("\\textbf{not resolved}").count(), 2, "{latex}");
        assert!(latex.contains("\\underline{0.1}"), "{latex}");
        let html = table.write(Format::Html, "");
        assert_eq!(html.matches("<b>not resolved</b>").count(), 2, "{html}");
        assert!(html.contains("<u>0.1</u>"), "{html}");
        // One alone among text has nothing to win against.
        let alone = Table { rows: table.rows.split_off(3), ..table };
        assert!(!alone.write(Format::Markdown, "").contains("**"));
    }

    /// A name that means something in every format.
    pub(crate) const HOSTILE: &str = "a|b `c` *d* _e_ <i>f</i> [g](h) \\i &amp; {j} #k $l$ ~m~ ^n %o \"p\"\nq";

    #[test]
    fn names_stand_as_they_are_in_every_format() {
        let mut table = small();
        table.title = HOSTILE.into();
        table.columns[1].name = HOSTILE.into();
        table.rows[0][0].text = HOSTILE.into();
        table.notes = vec![HOSTILE.into()];
        let escaped = r#"a\|b \`c\` \*d\* \_e\_ \<i>f\</i> \[g\](h) \\i \&amp; {j} #k \$l\$ \~m\~ ^n %o "p" q"#;
        let markdown = table.write(Format::Markdown, "");
        assert_eq!(markdown.matches(escaped).count(), 4, "{markdown}");
        assert!(markdown.starts_with(&format!("### {escaped}\n\n")), "{markdown}");
        let latex = table.write(Format::Latex, "");
        let escaped = r#"\_e\_ \textless{}i\textgreater{}f\textless{}/i\textgreater{} {[}g{]}(h) \textbackslash{}i \&amp; \{j\} \#k \$l\$"#;
        let end = r#"\textasciitilde{}m\textasciitilde{} \textasciicircum{}n \%o {"}p{"} q"#;
        let escaped = format!(r"a\textbar{{}}b \textasciigrave{{}}c\textasciigrave{{}} {{*}}d{{*}} {escaped} {end}");
        assert_eq!(latex.matches(&escaped).count(), 4, "{latex}");
        let html = table.write(Format::Html, "");
        let escaped = "&lt;i&gt;f&lt;/i&gt; [g](h) \\i &amp;amp; {j}";
        assert_eq!(html.matches(escaped).count(), 4, "{html}");
        let csv = table.write(Format::Csv, "");
        let record = csv::Reader::from_reader(csv.as_bytes()).records().next().unwrap().unwrap();
        assert_eq!(&record[0], HOSTILE);
    }

    #[test]
    fn html_escapes_and_csv_quotes() {
        let html = small().write(Format::Html, "");
        assert!(
            html.contains("<td>c&lt;3</td>") && html.contains("<b>0.1</b>") && html.contains("<u>0.5</u>"),
            "{html}"
        );
        let mut table = small();
        table.rows[0][0].text = "a,\"1\"".into();
        let csv = table.write(Format::Csv, "");
        assert_eq!(csv.lines().nth(1), Some("\"a,\"\"1\"\"\",0.5,10"));
    }

    #[test]
    fn significant_digits() {
        let cases = [(0.012345, "0.0123"), (9.996, "10.0"), (123_456.0, "123456"), (1.5e-9, "1.50e-9"), (0.0, "0")];
        for (value, text) in cases {
            assert_eq!(significant(value, 3), text);
        }
        assert_eq!(significant(-2.0, 2), "-2.0");
    }
}
