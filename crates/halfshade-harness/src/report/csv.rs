//! Comma-separated values of what is shown.

use super::{page::Page, table::Table};

/// The tables, one after the other.
pub(super) fn page(page: &Page) -> String {
    page.tables().map(table).collect()
}

/// Records as lines, quoted where needed.
pub(super) fn table(table: &Table) -> String {
    let mut writer = ::csv::WriterBuilder::new().flexible(true).from_writer(Vec::new());
    let head: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
    let rows = table.rows.iter().map(|row| row.iter().map(|cell| cell.text.as_str()).collect());
    for record in std::iter::once(head).chain(rows) {
        // Writing to memory cannot fail.
        let _ = writer.write_record(record);
    }
    writer.into_inner().ok().and_then(|bytes| String::from_utf8(bytes).ok()).unwrap_or_default()
}
