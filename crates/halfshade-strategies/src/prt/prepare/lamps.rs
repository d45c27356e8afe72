//! Local lights, in the space that transfer was baked in.

use crate::prt::{
    bake::arrangement::Arrangement,
    kernel::{
        dot::LightVectors,
        grid::Grid,
        lamps::{Arriving, arriving, between_points},
    },
    settings::{LightBasis, Settings, WindowKind},
};
use glam::Vec3;
use halfshade_scene::{Frame, Pose, ReceiverBuffer, Scene, SphereLight};
use halfshade_sh::{
    blocker_table::{BlockerTable, Quantity},
    dispatch_bands,
    kernel::{self, LANES, MAX_BANDS},
    window::Window,
};
use halfshade_strategy::StrategyError;
use wide::f32x8;

/// Local lights of the last frame.
#[derive(Debug)]
pub(crate) struct FrameLamps {
    bands: usize,
    caps: BlockerTable,
    /// Factors of a window, by band.
    window: [f32; MAX_BANDS],
    lights: Vec<SphereLight>,
    /// Points between which light is interpolated; none if it is known wherever it is asked for.
    points: Option<Points>,
    pub(crate) baked_from_world: Pose,
}

/// Light that arrives at points of a grid.
#[derive(Debug)]
struct Points {
    grid: Grid,
    /// Three vectors for each point, one number after the other.
    values: Vec<f32>,
}

impl FrameLamps {
    /// Those of a scene; none if it has no local lights.
    ///
    /// # Errors
    /// Settings that local lights can't have.
    pub(crate) fn of(
        scene: &Scene,
        arrangement: &Arrangement,
        settings: &Settings,
    ) -> Result<Option<Self>, StrategyError> {
        if scene.lights.is_empty() {
            return Ok(None);
        }
        let on_light = settings.window_on.is_on_light();
        if settings.light != LightBasis::Sh || on_light && settings.window == WindowKind::Nonnegative {
            let reason = "light=zh3, light=guessed-zh3 and window=nonnegative are fitted to one light for all receivers, \
                          and local lights send another to each; take light=sh and window=none, hann or lanczos";
            return Err(StrategyError::Unsupported(reason.into()));
        }
        let window = if on_light { settings.window.fixed() } else { Window::None };
        let Some(caps) = BlockerTable::build(settings.bands, Quantity::BlockerMinusOne) else { return Ok(None) };
        let points = (settings.lamp_steps > 0).then(|| {
            let grid = Grid::around(bounds(&arrangement.at_rest(scene).frame(0)), settings.lamp_steps);
            Points { grid, values: Vec::new() }
        });
        Ok(Some(Self {
            bands: settings.bands,
            caps,
            window: std::array::from_fn(|l| window.factor(l, settings.bands) as f32),
            lights: Vec::new(),
            points,
            baked_from_world: Pose::IDENTITY,
        }))
    }

    /// Makes them those of a frame, in a space that is so far from the world.
    pub(crate) fn set(&mut self, frame: &Frame<'_>, baked_from_world: &Pose) {
        self.lights.clear();
        let shining = frame.lights.iter().filter(|light| light.radiance != Vec3::ZERO);
        self.lights.extend(shining.map(|light| light.moved(baked_from_world)));
        self.baked_from_world = *baked_from_world;
        if let Some(Points { grid, values }) = &mut self.points {
            let (mut points, grid) = (std::mem::take(values), *grid);
            // Settings allow no other number of bands.
            let _: Option<()> = dispatch_bands!(self.bands, N => self.project::<N>(&grid, &mut points));
            self.points = Some(Points { grid, values: points });
        }
    }

    /// Light at all points of the grid.
    fn project<const N: usize>(&self, grid: &Grid, values: &mut Vec<f32>) {
        values.clear();
        for start in (0..grid.len()).step_by(LANES) {
            let places = std::array::from_fn(|lane| grid.point((start + lane).min(grid.len() - 1)));
            let arriving = self.exact::<N>(&places).map(|channel| channel.map(f32x8::to_array));
            for lane in 0..LANES.min(grid.len() - start) {
                values.extend(arriving.iter().flatten().map(|lanes| lanes[lane]));
            }
        }
    }

    /// Light that arrives at eight places, which are in the space of transfer.
    pub(crate) fn arriving<const N: usize>(&self, places: &[Vec3; LANES]) -> Arriving<N> {
        match &self.points {
            Some(points) => between_points::<N>(points.values.as_chunks().0, &places.map(|p| points.grid.weights(p))),
            None => self.exact(places),
        }
    }

    fn exact<const N: usize>(&self, places: &[Vec3; LANES]) -> Arriving<N> {
        let position = std::array::from_fn(|axis| f32x8::from(places.map(|place| place[axis])));
        arriving::<N>(&self.lights, &position, &self.caps).map(|channel| kernel::times_bands(&channel, &self.window))
    }

    /// The same with light from infinitely far, place by place.
    pub(crate) fn with_distant<const N: usize>(
        &self,
        places: &[Vec3; LANES],
        distant: &LightVectors,
    ) -> [LightVectors; LANES] {
        let arriving = self.arriving::<N>(places).map(|channel| channel.map(f32x8::to_array));
        std::array::from_fn(|lane| {
            std::array::from_fn(|channel| {
                let mut eights = distant[channel].map(f32x8::to_array);
                let numbers = eights.as_flattened_mut().iter_mut().zip(&arriving[channel]);
                numbers.for_each(|(value, lanes)| *value += lanes[lane]);
                eights.map(f32x8::from)
            })
        })
    }

    /// Whether any band is lessened.
    pub(crate) fn is_windowed(&self) -> bool {
        self.window[..self.bands].iter().any(|factor| *factor != 1.0)
    }

    /// Points between which light is interpolated.
    pub(crate) fn point_count(&self) -> Option<usize> {
        self.points.as_ref().map(|points| points.grid.len())
    }

    pub(crate) fn bytes(&self) -> usize {
        let points = self.points.as_ref().map_or(0, |points| size_of_val(points.values.as_slice()));
        self.caps.bytes() + points + size_of_val(self.lights.as_slice())
    }
}

/// The box around all vertices of a frame.
fn bounds(frame: &Frame<'_>) -> [Vec3; 2] {
    let vertices = ReceiverBuffer::vertices(frame);
    let positions = (0..vertices.len()).map(|i| vertices.view().position_at(i)).filter(|position| position.is_finite());
    let boxes = positions.map(|position| [position; 2]);
    boxes.reduce(|[low, high], [a, b]| [low.min(a), high.max(b)]).unwrap_or_default()
}
