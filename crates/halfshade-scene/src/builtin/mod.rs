//! Built-in shapes and scenes: geometry that needs no file.

mod lathe;
pub mod shapes;

pub use lathe::{ProfilePoint, lathe};
pub use shapes::{SHAPES, shape};
