//! Baked data that a test program traces once, however many of its tests ask for it.

use halfshade_scene::Cache;
use halfshade_strategies::ShadowField;
use std::{
    path::{Path, PathBuf},
    sync::LazyLock,
};

/// A cache that is empty when the program starts: it holds what this build traced, and nothing older.
pub(crate) fn kept() -> Cache {
    static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(concat!("fields-", env!("CARGO_CRATE_NAME")));
        let _ = std::fs::remove_dir_all(&folder);
        folder
    });
    Cache::open(Some(FOLDER.clone()))
}

/// Shadow fields that are kept.
pub(crate) fn shadow_fields() -> ShadowField {
    ShadowField::new(kept())
}
