//! A table as a model, which a file per format writes.

/// A table.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Its subject.
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
    /// Direction that is better, if one is: the best cell is set bold, the second underlined.
    pub better: Option<Better>,
}

/// Direction that is better.
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
    /// Text that is shown.
    pub text: String,
    /// Number that is ranked; `None` for text.
    pub value: Option<f64>,
    /// Whether the bound holds that is stated for it, if one is.
    pub holds: Option<bool>,
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
        Self { text: text.into(), value: None, holds: None }
    }

    /// A number.
    pub fn number(text: impl Into<String>, value: f64) -> Self {
        Self { text: text.into(), value: Some(value), holds: None }
    }

    /// Something with a stated bound, which holds or doesn't.
    pub fn bounded(text: impl Into<String>, value: Option<f64>, holds: bool) -> Self {
        let mark = if holds { '✓' } else { '✗' };
        Self { text: format!("{mark} {}", text.into()), value, holds: Some(holds) }
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
    /// The place of each cell within its column: 1 for the best, 2 for the second, `None` for all others. Equal values
    /// share a place. Columns with fewer than two values have no winner.
    pub(super) fn places(&self) -> Vec<Vec<Option<u8>>> {
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
