//! Environments as lobes and cells, beyond \[Meunier2009\], which has spherical lights only.
//!
//! A constant and lobes are fitted to the environment once (`halfshade_sh::lobe::LobeSum`); a sun stays a light of its own,
//! and so do small bright parts of a map (`shared/lamps.rs`). The cells of two squares over both hemispheres have the light that
//! all lobes together have there (`cells.rs`). They turn with the environment, so that light is gathered once; a frame turns
//! directions alone.

pub(crate) mod cells;

use crate::{
    cosine_lobe::{
        kernel::environment::{Cells8, Lobes8},
        settings::Settings,
    },
    shared::lamps,
};
use glam::Vec3;
use halfshade_scene::{
    Environment,
    light::{DistantLight, Sun},
};
use halfshade_sh::lobe::{ColoredLobe, Lobe8, LobeSum, LobeTable};
use wide::f32x8;

/// An environment without its sun as lobes and cells, in its own frame.
#[derive(Debug)]
pub(crate) struct FittedEnvironment {
    base: DistantLight,
    /// Small bright parts of the map.
    lamps: Vec<Sun>,
    /// Cells along a side of each square.
    pub(crate) side: usize,
    pub(crate) uniform: Vec3,
    pub(crate) lobes: Vec<Lobes8>,
    pub(crate) cells: [Vec<Cells8>; 2],
}

impl FittedEnvironment {
    /// At most `lamp_count` lamps and `lobe_count` lobes, and `2^depth` cells along a side of a square.
    fn new(base: &DistantLight, lamp_count: usize, lobe_count: usize, depth: usize, table: &LobeTable) -> Self {
        let mut lamps = Vec::new();
        let sum = match base {
            DistantLight::Constant(radiance) => {
                LobeSum { uniform: radiance.to_array().map(f64::from), lobes: Vec::new() }
            }
            DistantLight::Map(map) => {
                let texels;
                (lamps, texels) = lamps::split(map, lamp_count);
                LobeSum::fit(lobe_count, map.width(), map.height(), &texels, table).unwrap_or_default()
            }
        };
        let side = 1 << depth;
        Self {
            base: base.clone(),
            lamps,
            side,
            uniform: Vec3::from(sum.uniform.map(|channel| channel as f32)),
            lobes: sum.lobes.chunks(8).map(gathered).collect(),
            cells: if sum == LobeSum::default() { Default::default() } else { cells::cells(side, &relative(&sum)) },
        }
    }

    /// The environment of a scene.
    pub(crate) fn of(environment: &Environment, settings: &Settings, table: &LobeTable) -> Self {
        let (lamps, lobes) = (settings.environment_lamps, settings.environment_lobes);
        Self::new(&environment.base, lamps, lobes, settings.environment_depth, table)
    }

    /// Radiance 1 from everywhere.
    pub(crate) fn everywhere(settings: &Settings, table: &LobeTable) -> Self {
        Self::new(&DistantLight::Constant(Vec3::ONE), 0, 0, settings.environment_depth, table)
    }

    /// Parts of the map that are lights of their own.
    pub(crate) fn lamps(&self) -> &[Sun] {
        &self.lamps
    }

    /// Whether it is made of `environment`.
    pub(crate) fn fits(&self, environment: &Environment) -> bool {
        self.base.is_same_as(&environment.base)
    }

    /// Bytes of lobes and of cells.
    pub(crate) fn bytes(&self) -> [usize; 2] {
        let cells = self.cells.iter().map(|cells| size_of_val(cells.as_slice())).sum();
        [size_of_val(self.lobes.as_slice()), cells]
    }
}

/// The sum at a brightness near 1, scaled by a power of two, which changes no bit: darkness is relative to it. Only parts of
/// the cells' light matter.
fn relative(sum: &LobeSum) -> LobeSum {
    let brightest = sum.lobes.iter().map(|lobe| lobe.scale).chain([sum.uniform]).flatten().fold(0.0, f64::max);
    let factor = if brightest > 0.0 { (-brightest.log2().floor()).exp2() } else { 1.0 };
    let scaled = |channels: [f64; 3]| channels.map(|channel| channel * factor);
    let lobes = sum.lobes.iter().map(|lobe| ColoredLobe { scale: scaled(lobe.scale), ..*lobe }).collect();
    LobeSum { uniform: scaled(sum.uniform), lobes }
}

fn gathered(lobes: &[ColoredLobe]) -> Lobes8 {
    // Lobes that fill the group up have an axis, but no scale.
    let filler = ColoredLobe { axis: [0.0, 1.0, 0.0], exponent: 1.0, scale: [0.0; 3] };
    let lanes = |get: &dyn Fn(&ColoredLobe) -> f64| {
        f32x8::from(std::array::from_fn::<f32, 8, _>(|lane| get(lobes.get(lane).unwrap_or(&filler)) as f32))
    };
    Lobes8 {
        lobe: Lobe8 {
            axis: std::array::from_fn(|i| lanes(&|lobe| lobe.axis[i])),
            exponent: lanes(&|lobe| lobe.exponent),
            scale: f32x8::ONE,
        },
        color: std::array::from_fn(|channel| lanes(&|lobe| lobe.scale[channel])),
    }
}
