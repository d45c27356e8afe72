//! One lobe per cell of the mask, eight at a time [Meunier2009, 5.3, figure 11].

use super::square::Square;
use halfshade_sh::{
    kernel::SphericalCap8,
    lobe::{CapLobeTable, Lobe, Lobe8, LobeTable, MAX_EXPONENT},
};
use std::f32::consts::{FRAC_PI_2, SQRT_2, TAU};
use wide::f32x8;

/// How much light a cell of the square has: what of it lies in the unit disc.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct LitCell {
    /// Area; all cells of a level have π.
    pub(crate) area: f32,
    /// Middle of that part.
    pub(crate) middle: [f32; 2],
}

/// Which lobe stands for a cell.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Shape<'a> {
    /// `max(a·v, 0)^e` about the middle of the cell's light with its solid angle: `e = 2π/Ω - 1`, and where that is beyond the
    /// largest exponent, as faint as it is too wide.
    Part,
    /// The lobe of a cap of its solid angle.
    SolidAngle(&'a CapLobeTable),
    /// The lobe of the cap of the cell's bounding sphere.
    Bounding(&'a CapLobeTable),
}

/// Lobes of cells, kept between uses.
#[derive(Debug, Clone, Default)]
pub(crate) struct CellLobes {
    x: [f32; 8],
    y: [f32; 8],
    size: [f32; 8],
    weight: [f32; 8],
    waiting: usize,
    len: usize,
    lobes: Vec<Lobe8>,
}

impl CellLobes {
    pub(crate) fn clear(&mut self) {
        self.waiting = 0;
        self.len = 0;
        self.lobes.clear();
    }

    /// How many cells were added.
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// Adds a cell that counts `weight` times.
    #[inline(always)]
    pub(crate) fn push(&mut self, cell: LitCell, level: usize, weight: f32, square: &Square, shape: Shape<'_>) {
        let i = self.waiting;
        [self.x[i], self.y[i]] = cell.middle;
        self.size[i] = match shape {
            Shape::Part | Shape::SolidAngle(_) => cell.area,
            // Half a diagonal.
            Shape::Bounding(_) => SQRT_2 / (1 << level) as f32,
        };
        self.weight[i] = weight;
        self.waiting += 1;
        self.len += 1;
        if self.waiting == 8 {
            self.flush(square, shape);
        }
    }

    /// Makes lobes of what is left, after the last cell.
    pub(crate) fn flush(&mut self, square: &Square, shape: Shape<'_>) {
        if self.waiting == 0 {
            return;
        }
        self.weight[self.waiting..].fill(0.0);
        self.waiting = 0;
        let [x, y, size, weight] = [self.x, self.y, self.size, self.weight].map(f32x8::from);
        let direction = square.directions(x, y);
        let stretch = square.stretch(x, y);
        let solid_angle = || (stretch * stretch * size).fast_max(f32x8::splat(1e-20));
        let lobe = match shape {
            Shape::Part => {
                let solid_angle = solid_angle();
                let exponent = f32x8::splat(TAU) / solid_angle - f32x8::ONE;
                let exponent = exponent.fast_max(f32x8::ZERO).fast_min(f32x8::splat(MAX_EXPONENT as f32));
                let scale = (exponent + f32x8::ONE) * solid_angle * f32x8::splat(TAU.recip());
                Lobe8 { axis: direction, exponent, scale: weight * scale.fast_min(f32x8::ONE) }
            }
            Shape::SolidAngle(caps) => {
                let versine = solid_angle() * f32x8::splat(TAU.recip());
                let lobe = caps.lookup(&SphericalCap8 { direction, versine });
                Lobe8 { scale: lobe.scale * weight, ..lobe }
            }
            Shape::Bounding(caps) => {
                let half = (stretch * size).fast_min(f32x8::splat(FRAC_PI_2)) * f32x8::splat(0.5);
                let half_sine = half.sin();
                let versine = half_sine * half_sine * f32x8::splat(2.0);
                let lobe = caps.lookup(&SphericalCap8 { direction, versine });
                Lobe8 { scale: lobe.scale * weight, ..lobe }
            }
        };
        self.lobes.push(lobe);
    }

    /// The lobes one by one.
    pub(crate) fn each(&self) -> impl Iterator<Item = Lobe> {
        self.lobes.iter().flat_map(|lobes| (0..8).map(|lane| lobes.lane(lane)))
    }

    /// `Σ ∫ factor·lobe` over all cells. Groups of eight whose every product is below `limit` are left out; adds to the
    /// numbers of products found and left out.
    #[inline(always)]
    pub(crate) fn integral(&self, factor: &Lobe8, table: &LobeTable, limit: Option<f32>, counts: &mut [u64; 2]) -> f32 {
        let mut sum = f32x8::ZERO;
        for lobe in &self.lobes {
            let is_small = |limit: f32| factor.product_bound(lobe).simd_lt(f32x8::splat(limit)).all();
            if limit.is_some_and(is_small) {
                counts[1] += 8;
                continue;
            }
            counts[0] += 8;
            sum += table.product_integral8(factor, lobe);
        }
        sum.reduce_add()
    }
}

/// The light as one lobe in every lane [Meunier2009, eq. 31], radiance apart.
pub(crate) fn light_lobe(square: &Square, caps: &CapLobeTable) -> Lobe8 {
    let direction = square.axis().map(f32x8::splat);
    caps.lookup(&SphericalCap8 { direction, versine: f32x8::splat(square.versine()) })
}
