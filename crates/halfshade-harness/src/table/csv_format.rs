//! Comma-separated values of what is shown; the raw numbers are in `results.csv`.

use super::Table;

pub(super) fn write(table: &Table) -> String {
    let rows = table.rows.iter().map(|row| row.iter().map(|cell| cell.text.as_str()).collect());
    let head: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
    lines(std::iter::once(head).chain(rows))
}

/// Records as lines of CSV, quoted where needed.
pub(super) fn lines<'a>(records: impl Iterator<Item = Vec<&'a str>>) -> String {
    let mut writer = csv::WriterBuilder::new().flexible(true).from_writer(Vec::new());
    for record in records {
        // Writing to memory cannot fail.
        let _ = writer.write_record(record);
    }
    writer.into_inner().ok().and_then(|bytes| String::from_utf8(bytes).ok()).unwrap_or_default()
}
