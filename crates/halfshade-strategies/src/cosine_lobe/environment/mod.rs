//! Light from infinitely far as lobes, and what blockers leave of it: beyond \[Meunier2009\], which has spherical lights only.
//!
//! A constant and lobes are fitted to the environment once (`halfshade_sh::lobe::LobeSum`); a sun stays a light of its own
//! (`light.rs`), and so do small bright parts of a map (`lamps.rs`). Unblocked, a receiver reflects the sum of products of
//! its lobes ρ_i with those of the light l_j, by the table, and of the constant in closed form. Visibility is not found
//! light by light, since lobes have no edge and all of them overlap, but once for all directions: two squares hold one
//! hemisphere each, spheres are discs on both, and a disc covers parts of cells (`cover.rs`). Light and visibility are
//! multiplied first, as in `order=light-first`: a cell has the light that all lobes together have there (`cells.rs`), of
//! which the part that is open counts,
//!
//! ```text
//! L = Σ_i (Σ_j ∫ ρ_i l_j dω) · (Σ_k ρ̄_ik E_k open_k) / (Σ_k ρ̄_ik E_k)
//! ```
//!
//! for each channel, where E_k is the flux of cell k and ρ̄_ik the mean of ρ_i about it: the clamped cosine in the
//! cell's direction, or for a glossy lobe the integral of its product with the lobe of the cell's solid angle. As a ratio of
//! two sums over the same cells it is exact where nothing or everything is covered.
//!
//! A spherical light around the receiver is a constant environment that ends at the light's surface: a sphere that begins
//! before the surface and whose silhouette lies beyond it shrinks on the way, as before any light (`square.rs`).
//!
//! The cells turn with the environment, so that light is gathered once; a frame turns directions alone. Work per receiver
//! doesn't grow with the number of lobes but by the unblocked products.

mod cells;
mod cover;
mod lamps;

use super::{
    blockers::{Ball, Receiver, Spheres},
    reflectance::{Horizon, Term, Terms},
    square::Square,
};
use cells::{Cells8, FRAMES};
use cover::Cover;
use glam::{Quat, Vec3};
use halfshade_scene::{
    Environment,
    light::{DistantLight, Sun},
    spheres::AdjustRule,
};
use halfshade_sh::lobe::{ColoredLobe, Lobe8, LobeSum, LobeTable};
use std::f32::consts::FRAC_1_SQRT_2;
use wide::f32x8;

/// What of a lobe's peak counts as nothing.
const NEGLIGIBLE: f32 = 1e-6;

/// An environment without its sun as lobes and cells, in its own frame.
#[derive(Debug)]
pub(super) struct Fitted {
    base: DistantLight,
    /// Too small for the others.
    lamps: Vec<Sun>,
    side: usize,
    uniform: Vec3,
    lobes: Vec<Lobes8>,
    cells: [Vec<Cells8>; 2],
}

/// Eight lobes of scale 1, and their colours.
#[derive(Debug, Clone, Copy)]
struct Lobes8 {
    lobe: Lobe8,
    color: [f32x8; 3],
}

/// A frame of a [`Fitted`]: all in world space.
#[derive(Debug)]
pub(super) struct Surroundings {
    side: usize,
    uniform: Vec3,
    lobes: Vec<Lobes8>,
    squares: [Square; 2],
    cells: [Vec<Cells8>; 2],
}

/// Working memory of one call.
#[derive(Debug, Clone, Default)]
pub(super) struct Work {
    covers: [Cover; 2],
}

impl Fitted {
    /// At most `lamp_count` lamps and `lobe_count` lobes, and `2^depth` cells along a side of a square.
    pub(super) fn new(
        base: &DistantLight,
        lamp_count: usize,
        lobe_count: usize,
        depth: usize,
        table: &LobeTable,
    ) -> Self {
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

    /// Radiance 1 from everywhere.
    pub(super) fn everywhere(depth: usize, table: &LobeTable) -> Self {
        Self::new(&DistantLight::Constant(Vec3::ONE), 0, 0, depth, table)
    }

    /// Lights of their own.
    pub(super) fn lamps(&self) -> &[Sun] {
        &self.lamps
    }

    /// Whether it is that of `environment`.
    pub(super) fn is_of(&self, environment: &Environment) -> bool {
        self.base.is_same_as(&environment.base)
    }

    pub(super) fn bytes(&self) -> [usize; 2] {
        let cells = self.cells.iter().map(|cells| size_of_val(cells.as_slice())).sum();
        [size_of_val(self.lobes.as_slice()), cells]
    }

    /// `None` where there is no light.
    pub(super) fn turned(&self, world_from_environment: Quat) -> Option<Surroundings> {
        if self.lobes.is_empty() && self.uniform == Vec3::ZERO {
            return None;
        }
        let rotation = world_from_environment.normalize();
        let columns = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| (rotation * axis).to_array());
        let turn = |direction: [f32x8; 3]| -> [f32x8; 3] {
            std::array::from_fn(|i| {
                let [a, b, c] = columns.map(|column| f32x8::splat(column[i]));
                a.mul_add(direction[0], b.mul_add(direction[1], c * direction[2]))
            })
        };
        let lobes = |lobes: &Lobes8| Lobes8 { lobe: Lobe8 { axis: turn(lobes.lobe.axis), ..lobes.lobe }, ..*lobes };
        let cells = |cells: &Cells8| Cells8 { direction: turn(cells.direction), ..*cells };
        Some(Surroundings {
            side: self.side,
            uniform: self.uniform,
            lobes: self.lobes.iter().map(lobes).collect(),
            squares: FRAMES.map(|frame| Square::hemisphere(frame.map(|axis| (rotation * Vec3::from(axis)).to_array()))),
            cells: self.cells.each_ref().map(|half| half.iter().map(cells).collect()),
        })
    }
}

impl Surroundings {
    /// What a receiver reflects of it; behind `end`, whose middle is given from the receiver, nothing blocks.
    pub(super) fn reflected(
        &self,
        receiver: &Receiver,
        terms: &Terms,
        (spheres, end): (&Spheres, Option<&Ball>),
        rule: AdjustRule,
        table: &LobeTable,
        work: &mut Work,
    ) -> Vec3 {
        let is_blocked = self.cover(receiver, (spheres, end), rule, work);
        let mut radiance = Vec3::ZERO;
        for term in terms.iter() {
            let lobe = above_horizon(term, receiver, table);
            let unblocked = term.color * self.unblocked(&lobe, table);
            if unblocked == Vec3::ZERO {
                continue;
            }
            radiance += if is_blocked {
                let open = match term.horizon {
                    Horizon::Diffuse => self.open_part(work, |cells| cosine(&term.lobe, cells)),
                    Horizon::Cosine | Horizon::None => {
                        let least = self.least_cosine(&lobe);
                        self.open_part(work, |cells| mean(&lobe, cells, table, least))
                    }
                };
                unblocked * open
            } else {
                unblocked
            };
        }
        radiance
    }

    /// Finds what is covered; `false` if nothing is.
    fn cover(
        &self,
        receiver: &Receiver,
        (spheres, end): (&Spheres, Option<&Ball>),
        rule: AdjustRule,
        work: &mut Work,
    ) -> bool {
        let mut is_blocked = false;
        for (center, radius) in spheres.groups() {
            let (offset, radius) = receiver.adjusted(&center, radius, rule);
            let end = end.map(|end| end.surface_behind(&offset));
            for (half, square) in self.squares.iter().enumerate() {
                square.each_disc_before(end, &offset, radius, |disc| {
                    if !is_blocked {
                        is_blocked = true;
                        work.covers.iter_mut().for_each(|cover| cover.clear(self.side));
                    }
                    work.covers[half].splat(&disc);
                });
            }
        }
        is_blocked
    }

    /// `∫ c L dω` for a lobe c.
    fn unblocked(&self, lobe: &Lobe8, table: &LobeTable) -> Vec3 {
        let mut sums = [f32x8::ZERO; 3];
        for Lobes8 { lobe: light, color } in &self.lobes {
            let integral = table.product_integral8(lobe, light);
            sums.iter_mut().zip(color).for_each(|(sum, color)| *sum = integral.mul_add(*color, *sum));
        }
        Vec3::from(sums.map(f32x8::reduce_add)) + self.uniform * lobe.integral().to_array()[0]
    }

    /// Cosine to a lobe's axis below which the lobe is negligible all over a cell.
    fn least_cosine(&self, lobe: &Lobe8) -> f32 {
        let exponent = lobe.exponent.to_array()[0];
        // A cell is 4/side wide at most, and reaches half a diagonal from its middle.
        (NEGLIGIBLE.ln() / exponent.max(f32::MIN_POSITIVE)).exp() - FRAC_1_SQRT_2 * 4.0 / self.side as f32
    }

    /// What part of the light, weighted, is open, for each channel. Cells without a weight are left out.
    #[inline(always)]
    fn open_part(&self, work: &Work, weight: impl Fn(&Cells8) -> Option<f32x8>) -> Vec3 {
        let (mut open_sums, mut sums) = ([f32x8::ZERO; 3], [f32x8::ZERO; 3]);
        for (cover, half) in work.covers.iter().zip(&self.cells) {
            for (open, cells) in cover.open().iter().zip(half) {
                let Some(weight) = weight(cells) else { continue };
                for ((open_sum, sum), flux) in open_sums.iter_mut().zip(&mut sums).zip(&cells.flux) {
                    let light = weight * *flux;
                    *sum += light;
                    *open_sum = open.mul_add(light, *open_sum);
                }
            }
        }
        let part = |channel: usize| {
            let (open, all) = (open_sums[channel].reduce_add(), sums[channel].reduce_add());
            if all > 0.0 { (open / all).min(1.0) } else { 1.0 }
        };
        Vec3::new(part(0), part(1), part(2))
    }
}

/// Of a brightness near 1, by a power of two that changes no bit: what counts as dark is relative to it. Cells tell parts of
/// their light alone.
fn relative(sum: &LobeSum) -> LobeSum {
    let brightest = sum.lobes.iter().map(|lobe| lobe.scale).chain([sum.uniform]).flatten().fold(0.0, f64::max);
    let factor = if brightest > 0.0 { (-brightest.log2().floor()).exp2() } else { 1.0 };
    let scaled = |channels: [f64; 3]| channels.map(|channel| channel * factor);
    let lobes = sum.lobes.iter().map(|lobe| ColoredLobe { scale: scaled(lobe.scale), ..*lobe }).collect();
    LobeSum { uniform: scaled(sum.uniform), lobes }
}

/// The lobe of a term, without what it has below the horizon.
fn above_horizon(term: &Term, receiver: &Receiver, table: &LobeTable) -> Lobe8 {
    match term.horizon {
        Horizon::Diffuse | Horizon::Cosine => term.lobe,
        Horizon::None => {
            let axis = receiver.normal.map(f32x8::splat);
            table.product8(&term.lobe, &Lobe8 { axis, exponent: f32x8::ZERO, scale: f32x8::ONE })
        }
    }
}

/// The clamped cosine in the direction of each cell; `None` if all are below the horizon.
#[inline(always)]
fn cosine(lobe: &Lobe8, cells: &Cells8) -> Option<f32x8> {
    let cosine = cells.cosine(&lobe.axis);
    cosine.simd_gt(f32x8::ZERO).any().then(|| cosine.fast_max(f32x8::ZERO))
}

/// The mean of a lobe about each cell; `None` if all are farther from its axis than the `least` cosine.
#[inline(always)]
fn mean(lobe: &Lobe8, cells: &Cells8, table: &LobeTable, least: f32) -> Option<f32x8> {
    let part = Lobe8 { axis: cells.direction, exponent: cells.exponent, scale: cells.per_solid_angle };
    let is_near = cells.cosine(&lobe.axis).simd_gt(f32x8::splat(least)).any();
    is_near.then(|| table.product_integral8(lobe, &part))
}

fn gathered(lobes: &[ColoredLobe]) -> Lobes8 {
    // What fills the group up has an axis, but no scale.
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
