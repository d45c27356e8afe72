//! Formats of pages and tables.

use super::{
    csv,
    html::{self, Read},
    latex, markdown,
    page::Page,
    table::Table,
    text,
};

/// Formats of pages and tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// GitHub's Markdown.
    Markdown,
    /// Comma-separated values.
    Csv,
    /// LaTeX with booktabs.
    Latex,
    /// HTML.
    Html,
    /// Aligned columns for a terminal.
    Text,
}

impl Table {
    /// The table in `format`; `provenance` says in one line where the numbers come from.
    pub fn write(&self, format: Format, provenance: &str) -> String {
        match format {
            Format::Markdown => markdown::table(self),
            Format::Csv => csv::table(self),
            Format::Latex => latex::table(self, provenance),
            Format::Html => html::table(self),
            Format::Text => text::table(self),
        }
    }
}

impl Page {
    /// The page in `format`. HTML has the pictures within it that `read` finds.
    pub fn write(&self, format: Format, read: &Read<'_>) -> String {
        match format {
            Format::Markdown => markdown::page(self),
            Format::Csv => csv::page(self),
            Format::Latex => latex::page(self),
            Format::Html => html::page(self, read),
            Format::Text => text::page(self),
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::super::table::{Better, Cell, Column};
    use super::*;

    fn small() -> Table {
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
        assert_eq!(html.matches("best\" data-value=\"0e0\">not resolved<").count(), 2, "{html}");
        assert!(html.contains("second\" data-value=\"1e-1\">0.1<"), "{html}");
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
        assert_eq!(html.matches(escaped).count(), 5, "{html}");
        let csv = table.write(Format::Csv, "");
        let record = ::csv::Reader::from_reader(csv.as_bytes()).records().next().unwrap().unwrap();
        assert_eq!(&record[0], HOSTILE);
    }

    #[test]
    fn html_escapes_and_csv_quotes() {
        let html = small().write(Format::Html, "");
        assert!(
            html.contains("<td>c&lt;3</td>") && html.contains("<td class=\"number best\" data-value=\"1e-1\">0.1</td>"),
            "{html}"
        );
        let mut table = small();
        table.rows[0][0].text = "a,\"1\"".into();
        let csv = table.write(Format::Csv, "");
        assert_eq!(csv.lines().nth(1), Some("\"a,\"\"1\"\"\",0.5,10"));
    }
}
