//! Reports on stored results: one model of a page, and a writer for each format.

mod all_runs;
mod by_class;
mod contents;
mod csv;
mod details;
mod differences;
mod error_cell;
mod error_split;
mod format;
mod groups;
mod html;
mod latex;
mod markdown;
mod page;
mod pareto;
mod plot;
mod ratio;
mod scene_table;
mod significant;
mod stability;
mod table;
mod text;
mod units;
mod verdict;
mod write;

pub use contents::{data, page, provenance, summary};
pub use format::Format;
pub use groups::Group;
pub use html::{Read, files_in};
pub use page::{Block, Page, Picture};
pub use plot::{LEAST_FRAMES, Plot};
pub use significant::significant;
pub use table::{Better, Cell, Column, Table};
pub use write::{Write, report, write_all, write_plots};
