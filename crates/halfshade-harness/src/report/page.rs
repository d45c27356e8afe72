//! A page as a model, which a file per format writes.

use super::{plot::Plot, table::Table};
use crate::results::PictureFiles;

/// A page for people.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    /// Source of its numbers, in one line.
    pub provenance: String,
    /// Its blocks, from the top.
    pub blocks: Vec<Block>,
}

/// A part of a page; a format leaves out what it has no place for.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// The head of the page.
    Title(String),
    /// The head of a part.
    Heading(String),
    /// A paragraph.
    Note(String),
    /// A table.
    Table(Table),
    /// A plot, as a file beside the page or within it.
    Plot(Plot),
    /// Pictures side by side, each with its error.
    Pictures(Vec<Picture>),
}

/// A picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Its files.
    pub files: PictureFiles,
    /// Its error, in words; nothing of the truth.
    pub error: Option<String>,
}

impl Page {
    /// The head of the page; nothing if it has none.
    pub fn title(&self) -> &str {
        let titles =
            self.blocks.iter().filter_map(|block| if let Block::Title(text) = block { Some(text) } else { None });
        titles.map(String::as_str).next().unwrap_or_default()
    }

    /// All tables, in order.
    pub fn tables(&self) -> impl Iterator<Item = &Table> {
        self.blocks.iter().filter_map(|block| if let Block::Table(table) = block { Some(table) } else { None })
    }

    /// All plots, in order.
    pub fn plots(&self) -> impl Iterator<Item = &Plot> {
        self.blocks.iter().filter_map(|block| if let Block::Plot(plot) = block { Some(plot) } else { None })
    }
}
