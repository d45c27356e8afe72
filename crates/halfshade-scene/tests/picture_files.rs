//! Pictures to read: stored ones, and those that tests write.

use std::path::{Path, PathBuf};

pub(crate) fn stored(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/probes").join(name)
}

/// A Radiance picture of 16 by 8, run-length encoded, whose pixels are grey slopes.
pub(crate) fn radiance_picture(header: &str) -> Vec<u8> {
    let mut bytes = format!("#?RADIANCE\n{header}\n\n-Y 8 +X 16\n").into_bytes();
    for y in 0..8_u8 {
        bytes.extend([2, 2, 0, 16]);
        for _ in 0..3 {
            bytes.extend([128 + 8, 128 + y, 8]);
            bytes.extend((0..8).map(|x| 128 + 8 * x));
        }
        bytes.extend([128 + 16, 129]);
    }
    bytes
}

pub(crate) fn written(folder: &tempfile::TempDir, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}
