//! The bytes behind a document.

use ::gltf::buffer;
use std::collections::HashSet;
use std::path::PathBuf;

/// The bytes that a document speaks of.
pub(super) struct Buffers {
    /// Folder of files that the document names.
    pub(super) folder: PathBuf,
    pub(super) data: Vec<Vec<u8>>,
    /// Accessors that have no data: all zero.
    pub(super) zeros: HashSet<usize>,
    /// Whether whole numbers may be themselves where glTF by itself has fractions: KHR_mesh_quantization.
    pub(super) is_quantized: bool,
}

impl Buffers {
    /// The part of a buffer that a view names; `None` if it lies beyond.
    pub(super) fn view(&self, view: &buffer::View<'_>) -> Option<&[u8]> {
        let data = self.data.get(view.buffer().index())?;
        data.get(view.offset()..view.offset().checked_add(view.length())?)
    }

    /// Whether an accessor has no data of its own.
    pub(super) fn is_zero(&self, accessor: usize) -> bool {
        self.zeros.contains(&accessor)
    }
}
