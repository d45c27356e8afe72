//! Built-in scenes with their sphere sets, which a test program builds once.

use halfshade_scene::{Cache, Scene, builtin, progress::Silent};
use std::sync::LazyLock;

/// `vases` with one bounce of light.
pub(crate) static VASES: LazyLock<Scene> = LazyLock::new(|| built("vases"));

/// `hand`, whose spheres follow its skeleton, with one bounce of light.
pub(crate) static HAND: LazyLock<Scene> = LazyLock::new(|| built("hand"));

fn built(name: &str) -> Scene {
    let mut scene = builtin::scene(name).unwrap();
    scene.build_spheres(&Cache::disabled(), &Silent).unwrap();
    Scene { bounces: 1, ..scene }
}
