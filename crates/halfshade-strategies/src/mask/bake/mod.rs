//! Once per scene: directions by normal, light by lobe, directions that each mesh hides from its own vertices, objects that are
//! boxes.

pub(crate) mod boxes;
pub(crate) mod directions;
pub(crate) mod lobe_light;
pub(crate) mod own;
