//! The README's figures are those of the stored results.

use crate::pages::{read, splice};

/// Rows of the README's table.
const TOLD: [&str; 10] = [
    "unshadowed",
    "analytic",
    "sh-exp:as-published,bounces=0",
    "sh-exp:bands=4,bounces=0",
    "mask:directions=64",
    "shadow-field:bands=6",
    "cosine-lobe",
    "ray-traced:plain,samples=4",
    "ray-traced:unfiltered,samples=4",
    "ray-traced:samples=4",
];

/// The cells of a row of Markdown, without marks of the best.
fn cells(row: &str) -> Vec<String> {
    let plain =
        |cell: &str| ["**", "<u>", "</u>", "`"].iter().fold(cell.to_owned(), |cell, mark| cell.replace(mark, ""));
    row.trim_matches('|').split('|').map(|cell| plain(cell).trim().to_owned()).collect()
}

/// The rows under the first header for which `is_header` holds, header included.
fn table(text: &str, is_header: impl Fn(&[String]) -> bool) -> Vec<Vec<String>> {
    let rows = text.lines().map(|line| if line.starts_with('|') { cells(line) } else { Vec::new() });
    rows.skip_while(|row| !is_header(row)).take_while(|row| !row.is_empty()).collect()
}

#[test]
fn the_readme_tells_figures_of_the_results() {
    let tables = read("results/rivals/tables.md");
    let place = tables.find("### vases, frame 60: 15022 vertices").expect("the table of the scene");
    let stored = table(&tables[place..], |header| header.iter().any(|cell| cell == "frames/s"));
    let columns =
        ["rel. RMSE", "frames/s"].map(|name| stored[0].iter().position(|cell| cell == name).expect("a column"));
    let mut told = "\n| `vases`, a picture of 320 × 240 | rel. RMSE | frames/s |\n| --- | ---: | ---: |\n".to_owned();
    for label in TOLD {
        let found = stored.iter().find(|other| other[0] == label).unwrap_or_else(|| panic!("no row {label:?}"));
        let [error, speed] = columns.map(|column| &found[column]);
        told += &format!("| `{label}` | {error} | {speed} |\n");
    }
    splice("README.md", "a table of results/rivals", &(told + "\n"));
}
