//! Once per frame: spheres where they are, light by normal, cuts through the hierarchy, and the first pass of reflections.
//! It ends in plain data, see [`frame`].

pub(crate) mod cuts;
pub(crate) mod emitters;
mod first_pass;
pub(crate) mod frame;
pub(crate) mod ground;
pub(crate) mod light;
pub(crate) mod own;
pub(crate) mod placed;
mod state;

use super::bake::Tables;
use cuts::Cuts;
use frame::FrameData;
use halfshade_scene::Frame;
use halfshade_strategy::StrategyError;
use own::OwnView;
use placed::PlacedSpheres;
use state::FrameState;

/// Where the first pass of reflections runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FirstPass {
    /// As a part of preparing the frame.
    Here,
    /// On another device, from the frame's arrays.
    Elsewhere,
}

/// Makes `data` that of `frame`.
pub(crate) fn prepare(
    tables: &mut Tables,
    data: &mut FrameData,
    frame: &Frame<'_>,
    first_pass: FirstPass,
) -> Result<(), StrategyError> {
    if data.state.as_ref().is_some_and(|state| state.is(frame)) {
        return Ok(());
    }
    data.state = None;
    data.light.set(&frame.scene.environment);
    let spheres = PlacedSpheres::new(frame, &mut tables.hierarchies)?;
    if let Some(reflections) = &tables.reflections
        && !reflections.fits(frame, &mut tables.hierarchies)
    {
        return Err(StrategyError::Failed("the frame is of another scene than reflections were baked for".into()));
    }
    data.cuts = Cuts::new(frame, &spheres, &tables.clusters, tables.logs(), &tables.cut);
    (data.space, data.blockers_from_light) = (spheres.space, spheres.blockers_from_light);
    data.lamps = data.light.placed_lamps(frame, &data.space);
    if let Some(ground) = &tables.ground {
        data.ground.get_or_insert_default().look(ground, frame, data.space.origin);
    }
    data.turns = spheres.turns;
    if tables.own.is_some() {
        data.own = OwnView::new(tables.bands, frame, &data.space, spheres.own);
    }
    if first_pass == FirstPass::Here
        && let Some(reflections) = &tables.reflections
    {
        first_pass::run(tables, reflections, data, frame);
    }
    data.state = Some(FrameState::of(frame));
    Ok(())
}
