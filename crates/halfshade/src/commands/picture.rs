//! Pictures that commands draw: how they look, where they go, and those in which nothing is to be seen.

use crate::{
    cli::{PictureArguments, SceneArguments},
    failure::Failure,
};
use glam::Vec3;
use halfshade_harness::Picture;
use halfshade_scene::Scene;
use std::path::{Path, PathBuf};

/// Radiance where nothing is hit.
pub(super) fn background(arguments: &PictureArguments) -> Vec3 {
    arguments.background.map_or(Vec3::ZERO, Vec3::from)
}

/// Factor for a picture that is looked at.
pub(super) fn exposure(picture: &Picture, arguments: &PictureArguments) -> f32 {
    arguments.exposure.map_or_else(|| picture.exposure(), f32::exp2)
}

/// A line that tells how a PNG was exposed, so that another can be exposed alike.
pub(super) fn told_exposure(output: &Path, exposure: f32) -> String {
    let is_png = output.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"));
    if is_png { format!(" with --exposure {:.2}", exposure.log2()) } else { String::new() }
}

/// A picture in which nothing is to be seen would pass for one of a dark scene.
pub(super) fn sees_nothing(scene: &Scene) -> Failure {
    let [width, height] = scene.camera.resolution;
    Failure::Error(format!(
        "the camera of scene `{}` sees nothing: no ray of {width}x{height} pixels meets an object; move or turn it, or give \
         more pixels",
        scene.name
    ))
}

/// A file named after the scene, in the current folder.
pub(super) fn default_output(arguments: &SceneArguments, suffix: &str) -> PathBuf {
    let stem = Path::new(&arguments.scene).file_stem().unwrap_or_default().to_string_lossy().into_owned();
    PathBuf::from(format!("{stem}{suffix}"))
}
