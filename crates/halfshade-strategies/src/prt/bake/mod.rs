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
//! block: see `rows.rs`.

pub(crate) mod arrangement;
mod chunks;
pub(crate) mod gloss;
pub(crate) mod gloss_table;
pub(crate) mod hemisphere;
mod passes;
pub(crate) mod rows;
mod surface;
pub(crate) mod table;
mod windowed;

use super::settings::{Settings, TransferKind};
use chunks::{Chunks, colour_key, shape_key};
use gloss::GlossPasses;
use gloss_table::GlossTable;
use halfshade_scene::{Cache, Progress, Scene};
use halfshade_strategy::StrategyError;
use hemisphere::Hemisphere;
use passes::Passes;
use rayon::prelude::*;
use rows::Rows;
use surface::Surfaces;
use table::{PADDING, Transfer};

/// Transfer vectors of a scene.
///
/// # Errors
/// Those of the cache.
pub(crate) fn bake(
    scene: &Scene,
    settings: &Settings,
    cache: &Cache,
    progress: &dyn Progress,
) -> Result<Transfer, StrategyError> {
    let frame = scene.frame(0);
    let is_traced = settings.transfer != TransferKind::Unshadowed;
    let bounces = if settings.transfer == TransferKind::Interreflected { scene.bounces } else { 0 };
    let rows = Rows::new(&frame, is_traced);
    progress.start("transfer", (rows.points.len() * (1 + bounces)) as u64);
    let hemisphere = Hemisphere::new(settings.bands, settings.directions);
    let objects = scene.objects.iter().map(|object| object.mesh.clone()).zip(rows.objects.iter().copied()).collect();
    let mut transfer =
        Transfer { bands: settings.bands, channels: 1, bounces, objects, values: Vec::new(), gloss: None };
    let is_coloured = bounces > 0 && !scene.objects.iter().all(|object| object.is_grey());
    let channels = if is_coloured { 3 } else { 1 };
    let gloss = GlossTable::plan(&frame, &rows, settings.bands, channels)?;
    if !is_traced {
        let open = |(_, normal): &_| hemisphere.open(*normal).into_iter().map(|value| value as f32);
        transfer.values = rows.points.par_iter().flat_map_iter(open).collect();
        transfer.gloss = gloss.map(|table| gloss::open(table, &rows.points, settings.bands));
        progress.advance(rows.points.len() as u64);
    } else {
        let shape = shape_key(&frame, settings.directions);
        let surfaces = Surfaces::new(&frame, &rows);
        let chunks = Chunks::new(cache, progress);
        let passes = Passes { hemisphere: &hemisphere, surfaces: &surfaces, points: &rows.points, chunks: &chunks };
        let direct = passes.direct(&shape)?;
        transfer.values = direct.iter().flat_map(|direct| &direct.values).copied().collect();
        let gloss_passes = gloss.is_some().then(|| GlossPasses::new(&passes, &direct, settings.bands));
        let mut gloss = gloss.zip(gloss_passes);
        for bounce in 1..=bounces {
            let key = colour_key(&shape, &frame, settings.bands).value(&(bounce as u64));
            if bounce == bounces
                && let Some((table, passes)) = gloss.take()
            {
                let key = table.key(&key);
                transfer.gloss = Some(passes.fill(table, channels, Some((&transfer, &key)))?);
            }
            transfer.values = passes.bounce(&key, &direct, &transfer, channels)?;
            transfer.channels = channels;
        }
        if let Some((table, passes)) = gloss {
            transfer.gloss = Some(passes.fill(table, channels, None)?);
        }
    }
    windowed::window(&mut transfer.values, settings);
    transfer.values.iter_mut().filter(|value| !value.is_finite()).for_each(|value| *value = 0.0);
    transfer.values.extend([0.0; PADDING]);
    Ok(transfer)
}
