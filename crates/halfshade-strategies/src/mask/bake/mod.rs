//! Once per scene: directions by normal, directions that each mesh hides from its own vertices, objects that are boxes.

pub(crate) mod boxes;
pub(crate) mod directions;
pub(crate) mod own;
