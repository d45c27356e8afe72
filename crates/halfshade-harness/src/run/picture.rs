//! Pictures of a group: of the truth, of strategies with their errors, of the difference of two.

use super::{
    group::{Group, View},
    plan::{DIFFERENCE_FACTOR, TRUTH_LABEL},
    record::Record,
};
use crate::{
    HarnessError, Picture, Reference, file_names,
    image_io::{Origin, exr_bytes, png_bytes},
    image_metrics::{FlipMap, Similarity},
    picture_colors::signed_error,
    results::PictureFiles,
};
use halfshade_scene::RadianceBuffer;
use std::path::PathBuf;

/// Draws the truth, unless it is drawn already.
pub(super) fn picture_truth(group: &Group<'_>, view: &View, record: &mut Record) -> Result<(), HarnessError> {
    if record.truth_picture(&group.frame.scene.name, group.frame.index).is_some() {
        return Ok(());
    }
    let picture = view.picture(&group.references.mesh.reference.radiance);
    let files = write(group, view, TRUTH_LABEL, &picture, None, record)?;
    record.add_truth_picture(files)
}

/// Draws what the variant at `place` has shaded, and how far it is from the truth.
pub(super) fn picture_variant(
    group: &Group<'_>,
    view: &View,
    place: usize,
    radiance: &RadianceBuffer,
    record: &mut Record,
) -> Result<(), HarnessError> {
    let (row, reference) = (&group.rows[place], &group.references.mesh.reference);
    let (picture, truth) = (view.picture(radiance), view.picture(&reference.radiance));
    let (similarity, flip) = Similarity::between(&picture, &truth, view.exposure);
    let files = write(group, view, &row.blank.label, &picture, Some((&truth, reference, flip)), record)?;
    record.add_picture(&row.key, files, similarity)
}

/// Key under which the picture of a difference is recorded.
pub(super) fn difference_key(group: &Group<'_>) -> String {
    format!("{} {} {} difference", group.frame.scene.name, group.frame.index, group.kind)
}

/// Draws the magnified difference of what two variants have shaded.
pub(super) fn picture_difference(
    group: &Group<'_>,
    view: &View,
    label: &str,
    [first, second]: [&RadianceBuffer; 2],
    record: &mut Record,
) -> Result<(), HarnessError> {
    let picture = view.picture(first).magnified_difference(&view.picture(second), DIFFERENCE_FACTOR);
    let files = write(group, view, label, &picture, None, record)?;
    record.add_picture(&difference_key(group), files, Similarity::default())
}

/// Writes a picture, with its error and its map of FLIP if there is a truth to compare it with.
fn write(
    group: &Group<'_>,
    view: &View,
    label: &str,
    picture: &Picture,
    truth: Option<(&Picture, &Reference, Option<FlipMap>)>,
    record: &mut Record,
) -> Result<PictureFiles, HarnessError> {
    let (scene, frame) = (&group.frame.scene.name, group.frame.index);
    let base = file_names::picture(scene, frame, label);
    let truth_samples = Some(group.references.mesh.samples);
    let origin = Origin { program: &view.program, scene, frame, strategy: label, truth_samples };
    let mut write = |ending: &str, bytes: Result<Vec<u8>, String>| -> Result<String, HarnessError> {
        let file = PathBuf::from(format!("{base}{ending}"));
        let bytes = bytes.map_err(|problem| HarnessError::in_file(&file, problem))?;
        record.write(&file, &bytes)?;
        Ok(format!("{base}{ending}"))
    };
    let mut layers = vec![("", picture)];
    let error;
    let (mut error_png, mut flip_png) = (None, None);
    if let Some((truth, reference, flip)) = truth {
        error = picture.minus(truth);
        layers.extend([("truth", truth), ("error", &error)]);
        error_png = Some(write(".error.png", png_bytes(&signed_error(&error, reference.unshadowed_mean)))?);
        flip_png = flip.map(|map| write(".flip.png", png_bytes(&map))).transpose()?;
    }
    Ok(PictureFiles {
        scene: scene.clone(),
        frame,
        label: label.to_owned(),
        exr: write(".exr", exr_bytes(&layers, &origin))?,
        png: write(".png", png_bytes(&picture.to_srgb(view.exposure)))?,
        error_png,
        flip_png,
        exposure: view.exposure,
    })
}
