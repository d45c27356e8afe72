//! The README's figures are those of the stored results.

use std::{fs, path::Path};

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
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let readme = fs::read_to_string(root.join("README.md")).expect("README.md");
    let tables = fs::read_to_string(root.join("results/rivals/tables.md")).expect("tables");
    let told = table(&readme, |header| header.get(1).is_some_and(|cell| cell == "rel. RMSE"));
    let place = tables.find("### vases, frame 60: 15022 vertices").expect("the table of the scene");
    let stored = table(&tables[place..], |header| header.iter().any(|cell| cell == "frames/s"));
    let columns =
        ["rel. RMSE", "frames/s"].map(|name| stored[0].iter().position(|cell| cell == name).expect("a column"));
    // Behind the header and the line under it.
    assert!(told.len() > 4);
    for row in &told[2..] {
        let found = stored.iter().find(|other| other[0] == row[0]).unwrap_or_else(|| panic!("no row {row:?}"));
        assert_eq!(row[1..], columns.map(|column| found[column].clone()), "{}", row[0]);
    }
}
