//! Once per scene: transfer vectors of all vertices, by rays.
//!
//! From every vertex the same directions are asked, turned about its normal (`hemisphere.rs`): first for any surface in the way,
//! which gives the transfer of light that arrives from infinitely far, then, once per bounce, for what the blocked ones meet:
//!
//! ```text
//! T_0(x) = R_x Σ_k V(x, ω_k) w_k y(d_k)        T_b(x) = T_0(x) + Σ_k (1 - V(x, ω_k)) w_k a(h_k) T_{b-1}(h_k)
//! ```
//!
//! with R_x the rotation about the normal, h_k what is hit and a its albedo, T between vertices interpolated by barycentric
//! weights. Open directions are remembered as bits, so that a bounce traces the blocked ones alone; hits are found anew for each
//! bounce, so that memory holds three tables and a bit per ray, however many there are. Both faces of a triangle reflect, as both
//! block: see `rows.rs`. After each pass, what has entered translucent objects leaves them elsewhere (`subsurface`).

pub(crate) mod arrangement;
mod chunks;
pub(crate) mod compress;
pub(crate) mod gloss;
pub(crate) mod gloss_table;
pub(crate) mod hemisphere;
mod passes;
pub(crate) mod rows;
mod subsurface;
mod surface;
pub(crate) mod table;
pub(crate) mod volume;
mod windowed;

use super::{
    kernel::{dot::PADDING, grid::Grid},
    settings::{Settings, TransferKind},
};
use arrangement::Arrangement;
use chunks::{Chunks, colour_key, shape_key};
use compress::Clusters;
use gloss::GlossPasses;
use gloss_table::GlossTable;
use halfshade_scene::{Cache, Frame, Object, Progress, Scene};
use halfshade_strategy::StrategyError;
use hemisphere::Hemisphere;
use passes::Passes;
use rayon::prelude::*;
use rows::Rows;
use subsurface::Media;
use surface::Surfaces;
use table::Transfer;
use volume::{Probes, Volume};

/// Everything that is baked of a scene.
#[derive(Debug)]
pub(crate) struct Baked {
    pub(crate) transfer: Transfer,
    /// Light for objects that move, if any do.
    pub(crate) volume: Option<Volume>,
}

/// Transfer vectors of a scene.
///
/// # Errors
/// Those of the cache.
pub(crate) fn bake(
    scene: &Scene,
    arrangement: &Arrangement,
    settings: &Settings,
    cache: &Cache,
    progress: &dyn Progress,
) -> Result<Baked, StrategyError> {
    let grid = volume::of_movers(scene, arrangement).map(|bounds| Grid::around(bounds, settings.volume_steps));
    let is_traced = settings.transfer != TransferKind::Unshadowed;
    let own = match grid {
        Some(_) if is_traced => volume::of_bodies(scene, arrangement, settings.directions, cache, progress)?,
        _ => Vec::new(),
    };
    let scene = &*arrangement.at_rest(scene);
    let frame = scene.frame(0);
    let bounces = if settings.transfer == TransferKind::Interreflected { scene.bounces } else { 0 };
    let rows = Rows::new(&frame, is_traced);
    let probe_count = grid.as_ref().map_or(0, Grid::len);
    let media = Media::new(&frame, &rows, settings.bands, settings.directions);
    progress.start("transfer", ((rows.points.len() + media.row_count()) * (1 + bounces) + probe_count) as u64);
    let hemisphere = Hemisphere::new(settings.bands, settings.directions);
    let objects = scene.objects.iter().map(|object| object.mesh.clone()).zip(rows.objects.iter().copied()).collect();
    let mut transfer = Transfer {
        bands: settings.bands,
        channels: 1,
        bounces,
        objects,
        values: Vec::new(),
        clusters: None,
        gloss: None,
    };
    let colours_light = |object: &Object| !object.is_grey() && (bounces > 0 || object.material.subsurface.is_some());
    let channels = if scene.objects.iter().any(colours_light) { 3 } else { 1 };
    let gloss = GlossTable::plan(&frame, &rows, settings.bands, channels)?;
    let chunks = Chunks::new(cache, progress);
    let volume = if !is_traced {
        let open = |(number, (_, normal)): (usize, &(_, _))| {
            media.hemisphere(number, &hemisphere).open(*normal).into_iter().map(|value| value as f32)
        };
        transfer.values = rows.points.par_iter().enumerate().flat_map_iter(open).collect();
        let key = colour_key(&shape_key(&frame, 0), &frame, settings.bands).bytes(b"open");
        media.scatter(&mut transfer, channels, &chunks, &key)?;
        transfer.gloss = gloss.map(|table| gloss::open(table, &rows.points, settings.bands, transfer.channels));
        progress.advance((rows.points.len() + probe_count) as u64);
        grid.map(|grid| Volume::open(grid, settings.bands))
    } else {
        let surfaces = Surfaces::new(&frame, &rows);
        let points = &rows.points;
        let passes = Passes { hemisphere: &hemisphere, media: &media, surfaces: &surfaces, points, chunks: &chunks };
        trace(&frame, &passes, &mut transfer, Extras { channels, grid, gloss })?
    };
    windowed::window(&mut transfer.values, settings);
    transfer.values.iter_mut().filter(|value| !value.is_finite()).for_each(|value| *value = 0.0);
    transfer.clusters = Clusters::of(&transfer.values, transfer.width(), settings, cache, progress)?;
    if transfer.clusters.is_some() {
        transfer.values = Vec::new();
    }
    transfer.values.extend([0.0; PADDING]);
    Ok(Baked { transfer, volume: volume.map(|volume| Volume { own, ..volume }) })
}

/// Everything that is traced beside vectors, and the number of those per row.
struct Extras {
    channels: usize,
    /// Points of a volume of light.
    grid: Option<Grid>,
    /// Matrices to fill in.
    gloss: Option<GlossTable>,
}

/// Traces rays from all rows of the table, and from all points of a grid, if there is one.
fn trace(
    frame: &Frame<'_>,
    passes: &Passes<'_>,
    transfer: &mut Transfer,
    Extras { channels, grid, gloss }: Extras,
) -> Result<Option<Volume>, StrategyError> {
    let Passes { hemisphere, media, surfaces, chunks, .. } = passes;
    let (bands, directions) = (transfer.bands, hemisphere.count());
    let shape = shape_key(frame, directions);
    let direct = passes.direct(&shape)?;
    transfer.values = direct.iter().flat_map(|direct| &direct.values).copied().collect();
    let key = |bounce: usize| colour_key(&shape, frame, bands).value(&(bounce as u64));
    media.scatter(transfer, channels, chunks, &key(0))?;
    // Light that arrives at a point has been reflected once less than light that leaves a receiver there.
    let volume = |reflected: Option<&Transfer>| -> Result<Option<Volume>, StrategyError> {
        let Some(grid) = grid else { return Ok(None) };
        let key = key(reflected.map_or(0, |transfer| transfer.bounces)).value(&grid.key());
        let probes = Probes { grid, surfaces, chunks, directions, bands };
        Ok(Some(probes.volume(&key, reflected, channels)?))
    };
    let gloss_passes = gloss.is_some().then(|| GlossPasses::new(passes, &direct, bands));
    let mut gloss = gloss.zip(gloss_passes);
    if transfer.bounces == 0 {
        if let Some((table, passes)) = gloss {
            transfer.gloss = Some(passes.fill(table, channels, None)?);
        }
        return volume(None);
    }
    let mut found = None;
    for bounce in 1..=transfer.bounces {
        if bounce == transfer.bounces {
            found = volume(Some(transfer))?;
            if let Some((table, passes)) = gloss.take() {
                let key = table.key(&key(bounce));
                transfer.gloss = Some(passes.fill(table, channels, Some((transfer, &key)))?);
            }
        }
        transfer.values = passes.bounce(&key(bounce), &direct, transfer, channels)?;
        transfer.channels = channels;
        media.scatter(transfer, channels, chunks, &key(bounce))?;
    }
    Ok(found)
}
