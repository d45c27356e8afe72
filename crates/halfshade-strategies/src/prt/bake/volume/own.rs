//! Own shadows of bodies that move: transfer of each alone, in its own space, in as many bands as the volume has.

use crate::prt::{
    bake::{
        arrangement::Arrangement,
        chunks::{Chunks, shape_key},
        hemisphere::Hemisphere,
        passes::Passes,
        rows::Rows,
        subsurface::Media,
        surface::Surfaces,
        table::Transfer,
    },
    kernel::{dot::PADDING, volume::BANDS},
};
use halfshade_scene::{Cache, Mesh, Motion, Object, Pose, Progress, Scene};
use halfshade_strategy::StrategyError;
use std::sync::Arc;

/// Transfer of each object that moves and keeps its shape, by object.
pub(crate) fn of_bodies(
    scene: &Scene,
    arrangement: &Arrangement,
    directions: usize,
    cache: &Cache,
    progress: &dyn Progress,
) -> Result<Vec<Option<Arc<Transfer>>>, StrategyError> {
    let mut known: Vec<(Arc<Mesh>, Arc<Transfer>)> = Vec::new();
    let mut of_body = |number: usize| {
        let object = &scene.objects[number];
        if !arrangement.moves(number) || object.skin.as_ref().is_some_and(|skin| skin.moves()) {
            return Ok(None);
        }
        if let Some((_, same)) = known.iter().find(|(mesh, _)| Arc::ptr_eq(mesh, &object.mesh)) {
            return Ok(Some(same.clone()));
        }
        let transfer = Arc::new(of_body(scene, object, directions, &Chunks::new(cache, progress), progress)?);
        known.push((object.mesh.clone(), transfer.clone()));
        Ok(Some(transfer))
    };
    (0..scene.objects.len()).map(&mut of_body).collect()
}

fn of_body(
    scene: &Scene,
    object: &Object,
    directions: usize,
    chunks: &Chunks<'_>,
    progress: &dyn Progress,
) -> Result<Transfer, StrategyError> {
    let body = Object { motion: Motion::Still(Pose::IDENTITY), skin: None, ..object.clone() };
    let alone = Scene::at_rest(object.name.clone(), vec![body], scene.environment.clone());
    let frame = alone.frame(0);
    let rows = Rows::new(&frame, true);
    progress.start("what a body hides from itself", rows.points.len() as u64);
    let hemisphere = Hemisphere::new(BANDS, directions);
    let surfaces = Surfaces::new(&frame, &rows);
    let passes =
        Passes { hemisphere: &hemisphere, media: &Media::default(), surfaces: &surfaces, points: &rows.points, chunks };
    let direct = passes.direct(&shape_key(&frame, directions))?;
    let values = direct.iter().flat_map(|direct| &direct.values).map(|&x| if x.is_finite() { x } else { 0.0 });
    Ok(Transfer {
        bands: BANDS,
        channels: 1,
        bounces: 0,
        objects: vec![(object.mesh.clone(), rows.objects[0])],
        values: values.chain([0.0; PADDING]).collect(),
        clusters: None,
        gloss: None,
    })
}
