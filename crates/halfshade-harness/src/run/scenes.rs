//! The scenes of an experiment, loaded and changed as it says.

use crate::{
    Experiment, HarnessError, Published, ReceiverKind,
    experiment::{SceneEntry, View},
    inputs,
    scene_source::{self, MeshLight},
};
use glam::Vec3;
use halfshade_scene::{Camera, InputFile, Scene, SphereFit, doubts, file::Change, input, spheres::MAX_SPHERES};
use std::path::Path;

const BAD_VIEW: &str = "camera: eye and target must be finite and apart, vertical_fov_degrees between 0 and 180";

/// `camera` moved to `view`, or `None` if that can't be looked from.
fn viewed(view: &View, camera: &Camera) -> Option<Camera> {
    let (eye, target) = (Vec3::from(view.eye), Vec3::from(view.target));
    let fov = view.vertical_fov_degrees;
    let fits = eye.is_finite() && target.is_finite() && eye != target && fov > 0.0 && fov < 180.0;
    fits.then_some(Camera { eye, target, vertical_fov_degrees: fov, ..*camera })
}

/// Gives the scene's blockers `count` spheres in all, or one each if that is more, in proportion to what they have.
fn share_out_spheres(scene: &mut Scene, count: usize) {
    let total: usize = scene.objects.iter().map(|object| object.sphere_count).sum();
    let (mut own, mut given) = (0, 0);
    for object in scene.objects.iter_mut().filter(|object| object.sphere_count > 0) {
        // Rounded so that the sums are right, not each share.
        own += object.sphere_count;
        object.sphere_count = (own.saturating_mul(count) / total).saturating_sub(given).max(1);
        given += object.sphere_count;
    }
    scene.name = format!("{}, {count} spheres", scene.name);
}

/// Fits all sphere sets to `fit`.
fn fit_spheres(scene: &mut Scene, fit: SphereFit) {
    scene.objects.iter_mut().for_each(|object| object.fit = fit);
    let fitted = match fit {
        SphereFit::Bounding => "bounding",
        SphereFit::Shadow => "fitted to shadows",
    };
    scene.name = format!("{}, {fitted}", scene.name);
}

/// A scene of a plan.
#[derive(Debug)]
pub struct PlannedScene {
    /// The scene, without sphere sets.
    pub scene: Scene,
    /// Its frames.
    pub frames: Vec<usize>,
    /// Kinds of its receivers.
    pub receivers: Vec<ReceiverKind>,
    /// Published figures to stand beside ours.
    pub published: Vec<Published>,
}

/// Scenes, and what they were read from.
pub(super) struct Loaded {
    /// The scenes.
    pub(super) scenes: Vec<PlannedScene>,
    /// The files, relative to the experiment.
    pub(super) inputs: Vec<InputFile>,
}

/// Name, light and changes of a scene that is read.
type Source = (String, Option<String>, Vec<Change>);

/// Loads all scenes of `experiment`; of each only the first frame if `quick`.
pub(super) fn scenes(experiment: &Experiment, quick: bool) -> Result<Loaded, HarnessError> {
    let folder = experiment.path.parent().unwrap_or(Path::new("."));
    let mut scenes: Vec<PlannedScene> = Vec::new();
    let mut inputs = Vec::new();
    // A scene that several entries name is read once.
    let mut loaded: Vec<(Source, Scene)> = Vec::new();
    let swept = experiment.scenes.iter().map(|entry| entry.swept(experiment));
    for entry in swept.collect::<Result<Vec<_>, _>>()?.concat() {
        let error = |problem: String| experiment.error_at(entry.name.span(), problem);
        let light = MeshLight { name: entry.environment.as_deref(), ..MeshLight::default() };
        let source = (entry.name.get_ref().clone(), entry.environment.clone(), entry.changes.clone());
        let known = loaded.iter().find(|(other, _)| *other == source).map(|(_, scene)| scene.clone());
        let mut scene = match known {
            Some(scene) => scene,
            None => {
                let resolve = || scene_source::resolve_changed(&source.0, folder, &light, &source.2);
                let (scene, files) = input::recorded(resolve);
                inputs.extend(files);
                let scene = scene.map_err(|problem| match problem {
                    // The place in the scene's own file is where the mistake is.
                    HarnessError::Scene(of_scene) if of_scene.line.is_some() => of_scene.into(),
                    other => error(other.to_string()),
                })?;
                loaded.push((source, scene.clone()));
                scene
            }
        };
        change(&mut scene, &entry, experiment)?;
        let of_pictures = || experiment.pictures.as_ref().and_then(|pictures| pictures.resolution);
        if let Some(size) = entry.resolution.or_else(of_pictures) {
            scene.camera.resolution = size.map(|side| if quick { (side / 2).max(1) } else { side });
        }
        if scenes.iter().any(|other| other.scene.name == scene.name) {
            return Err(error(format!(
                "scene `{}` is listed twice: list it once, or give another `name` in its file to one of them",
                scene.name
            )));
        }
        let of_experiment = || if entry.still.is_some() { vec![0] } else { experiment.frames.clone() };
        let mut frames = entry.frames.clone().unwrap_or_else(of_experiment);
        if let Some(past) = frames.iter().find(|frame| **frame >= scene.frame_count.max(1)) {
            let (name, count) = (&scene.name, scene.frame_count);
            return Err(error(format!("scene `{name}` has {count} frames: there is no frame {past}")));
        }
        if quick {
            frames.truncate(1);
        }
        let receivers = entry.receivers.clone().unwrap_or_else(|| experiment.receivers.clone());
        scenes.push(PlannedScene { scene, frames, receivers, published: entry.published });
    }
    Ok(Loaded { scenes, inputs: inputs::relative_to(folder, inputs) })
}

/// Gives `scene` the name, stillness, bounces, view, spheres and their fit that its entry asks for.
fn change(scene: &mut Scene, entry: &SceneEntry, experiment: &Experiment) -> Result<(), HarnessError> {
    if let Some(light) = &entry.environment {
        let light = light.rsplit(['/', '\\']).next().unwrap_or(light);
        scene.name = format!("{}, {light}", scene.name);
    }
    if let Some(still) = &entry.still {
        let (frame, count) = (*still.get_ref(), scene.frame_count);
        if frame >= count.max(1) {
            let problem =
                format!("scene `{}` has {count} frames: there is no frame {frame} to hold it still at", scene.name);
            return Err(experiment.error_at(still.span(), problem));
        }
        *scene = scene.still_at(frame);
    }
    scene.bounces = entry.bounces.unwrap_or(scene.bounces);
    if let Some(view) = &entry.camera {
        scene.camera =
            viewed(view.get_ref(), &scene.camera).ok_or_else(|| experiment.error_at(view.span(), BAD_VIEW))?;
        scene.notes.extend(doubts::camera_inside(scene));
    }
    if let Some([width, height]) = entry.resolution {
        scene.name = format!("{}, {width}x{height}", scene.name);
    }
    if let Some(count) = entry.spheres {
        share_out_spheres(scene, count.get());
        if scene.objects.iter().any(|object| object.sphere_count > MAX_SPHERES) {
            let problem = format!("spheres = {count} gives an object more than the {MAX_SPHERES} it can use");
            return Err(experiment.error_at(entry.name.span(), problem));
        }
    }
    if let Some(fit) = entry.fit {
        fit_spheres(scene, fit);
    }
    scene.name.push_str(&entry.suffix());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfshade_scene::builtin;

    #[test]
    fn spheres_are_shared_out_as_they_were() {
        let counts = |scene: &Scene| -> Vec<usize> { scene.objects.iter().map(|object| object.sphere_count).collect() };
        let scene = builtin::scene("vases").unwrap();
        for (count, expected) in [(20, 20), (64, 64), (3, 5), (511, 511)] {
            let mut changed = scene.clone();
            share_out_spheres(&mut changed, count);
            assert_eq!(counts(&changed).iter().sum::<usize>(), expected, "{count}");
            let pairs = counts(&scene).into_iter().zip(counts(&changed));
            assert!(pairs.clone().all(|(before, after)| (before == 0) == (after == 0)), "{pairs:?}");
        }
        let mut fitted = scene.clone();
        fit_spheres(&mut fitted, SphereFit::Shadow);
        assert!(fitted.objects.iter().all(|object| object.fit == SphereFit::Shadow));
        assert_eq!(fitted.name, "vases, fitted to shadows");
        let mut same = scene.clone();
        share_out_spheres(&mut same, 20);
        assert_eq!((counts(&same), same.name.as_str()), (counts(&scene), "vases, 20 spheres"));
    }
}
