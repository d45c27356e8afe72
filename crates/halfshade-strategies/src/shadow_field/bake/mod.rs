//! Once per scene: occlusion fields around every mesh and own occlusion at its vertices, in either basis.

pub(crate) mod adaptive;
pub(crate) mod basis;
pub(crate) mod bounds;
pub(crate) mod details;
pub(crate) mod field;
pub(crate) mod grid;
pub(crate) mod haar;
pub(crate) mod meshes;
pub(crate) mod projected;
pub(crate) mod sh;
pub(crate) mod shell;
pub(crate) mod solid;
pub(crate) mod traced;
pub(crate) mod vertices;
