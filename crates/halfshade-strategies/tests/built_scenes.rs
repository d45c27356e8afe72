//! Built-in scenes with their sphere sets, which a test program builds once.

use halfshade_scene::{Cache, Scene, SphereFit, builtin, progress::Silent};
use std::sync::LazyLock;

/// `vases` with one bounce of light.
pub(crate) static VASES: LazyLock<Scene> = LazyLock::new(|| built("vases"));

/// `hand`, whose spheres follow its skeleton, with one bounce of light.
pub(crate) static HAND: LazyLock<Scene> = LazyLock::new(|| built("hand"));

fn built(name: &str) -> Scene {
    Scene { bounces: 1, ..bounded(builtin::scene(name).unwrap()) }
}

/// A scene with spheres that bound: any will do here, and these are there soonest.
pub(crate) fn bounded(mut scene: Scene) -> Scene {
    scene.objects.iter_mut().for_each(|object| object.fit = SphereFit::Bounding);
    scene.build_spheres(&Cache::disabled(), &Silent).unwrap();
    scene
}
