//! Once per scene: tables of lobes, cells of the square before a light and their weights, environments as lobes and cells.

pub(crate) mod cells;
pub(crate) mod environment;
pub(crate) mod tables;
pub(crate) mod weights;
