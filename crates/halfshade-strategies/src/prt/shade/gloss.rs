//! Reflection of receivers beside their diffuse part, lobe by lobe.

use super::{lamps::places_in, place::Place};
use crate::prt::{
    bake::{gloss::in_world, gloss_table::GlossTable, hemisphere::Hemisphere, table::Transfer},
    kernel::{
        dot::{LightVectors, added},
        lobe::{LOBE_BANDS, add_product, fitted_power},
    },
    prepare::{lamps::FrameLamps, light::FrameLight},
};
use glam::{DMat3, Vec3};
use halfshade_scene::{EyeLobes, Lobes, RadianceMut, Receivers};
use halfshade_sh::{
    dispatch_bands,
    hemisphere::Weight,
    kernel::{LANES, ShBatch},
    rotation::ShRotation,
};
use halfshade_strategy::Prepared;
use wide::f32x8;

/// Lobes of all models of a scene of a number of bands.
#[derive(Debug)]
pub(crate) struct LobeFits {
    /// By [`Weight`].
    pub(crate) fits: [Vec<f32>; 2],
    /// The matrices of open vertices over their own frame, by weight.
    grams: [Vec<f64>; 2],
}

impl LobeFits {
    pub(crate) fn new(bands: usize) -> Self {
        let weights = [Weight::Cosine, Weight::Equal];
        Self {
            fits: weights.map(|weight| weight.fit(bands, LOBE_BANDS).into_iter().map(|value| value as f32).collect()),
            grams: weights.map(|weight| weight.gram(bands)),
        }
    }

    /// The matrix of a vertex that sees everything.
    pub(crate) fn open_matrix(&self, weight: Weight, bands: usize, frame: &DMat3) -> Vec<f32> {
        in_world(&self.grams[weight as usize], bands, frame).into_iter().map(|value| value as f32).collect()
    }

    pub(crate) fn bytes(&self) -> usize {
        let grams: usize = self.grams.iter().map(|gram| size_of_val(gram.as_slice())).sum();
        grams + self.fits.iter().map(|fit| size_of_val(fit.as_slice())).sum::<usize>()
    }
}

/// Gloss of a frame.
pub(crate) struct GlossShader<'a> {
    pub(crate) table: &'a GlossTable,
    pub(crate) fits: &'a LobeFits,
    pub(crate) light: &'a FrameLight,
    /// Local lights, if there are any.
    pub(crate) lamps: Option<&'a FrameLamps>,
    pub(crate) lobes: EyeLobes,
}

/// Shades gloss on top of what another one has shaded.
pub(crate) struct GlossOver<'a> {
    pub(crate) rest: Box<dyn Prepared + 'a>,
    pub(crate) transfer: &'a Transfer,
    pub(crate) gloss: GlossShader<'a>,
}

impl Prepared for GlossOver<'_> {
    fn shade(&self, receivers: Receivers<'_>, mut out: RadianceMut<'_>) {
        self.rest.shade(receivers, RadianceMut { channels: out.channels.each_mut().map(|channel| &mut **channel) });
        // Settings allow no other number of bands.
        let _: Option<()> = dispatch_bands!(self.transfer.bands, N => match self.transfer.channels {
            1 => self.add::<N, 1>(&receivers, &mut out),
            _ => self.add::<N, 3>(&receivers, &mut out),
        });
    }
}

impl GlossOver<'_> {
    fn add<const N: usize, const C: usize>(&self, receivers: &Receivers<'_>, out: &mut RadianceMut<'_>) {
        for start in (0..receivers.len()).step_by(LANES) {
            let radiance = self.gloss.radiance::<N, C>(self.transfer, receivers, start);
            for (out, radiance) in out.channels.iter_mut().zip(radiance) {
                out[start..].iter_mut().zip(radiance.to_array()).for_each(|(out, radiance)| *out += radiance);
            }
        }
    }
}

/// Where a receiver is in the table of matrices: their numbers and weights.
struct Corners {
    corners: [(usize, f32); 3],
    weight: Weight,
}

/// Lobes of number `number` of eight receivers, as kernels take them.
struct LobeBatch {
    axes: [Vec3; LANES],
    exponents: f32x8,
    scales: [f32x8; 3],
}

impl GlossShader<'_> {
    /// Radiance that eight receivers from `start` on send toward the eye; those past the last send none.
    pub(crate) fn radiance<const N: usize, const C: usize>(
        &self,
        transfer: &Transfer,
        receivers: &Receivers<'_>,
        start: usize,
    ) -> [f32x8; 3] {
        let lanes = (receivers.len() - start).min(LANES);
        let lobes: [Lobes; LANES] =
            std::array::from_fn(|lane| if lane < lanes { self.lobes.at(receivers, start + lane) } else { Lobes::NONE });
        let count = lobes.iter().map(|lobes| lobes.len()).max().unwrap_or(0);
        let mut radiance = [f32x8::ZERO; 3];
        if count == 0 {
            return radiance;
        }
        let places: [Place; LANES] = std::array::from_fn(|lane| {
            if lobes[lane].is_empty() { Place::Dark } else { Place::of(transfer, receivers, start + lane) }
        });
        let corners: [Option<Corners>; LANES] =
            std::array::from_fn(|lane| self.corners(&places[lane], receivers, start + lane));
        let with_lamps =
            self.lamps.map(|lamps| lamps.with_distant::<N>(&places_in(lamps, receivers, start), &self.light.vectors));
        let light = |lane: usize| with_lamps.as_ref().map_or(&self.light.vectors, |lights| &lights[lane]);
        for number in 0..count {
            let batch = self.batch(&lobes, number);
            let white = self.products::<N, C>(&batch, &corners, &light);
            for (sum, (scale, white)) in radiance.iter_mut().zip(batch.scales.iter().zip(white)) {
                *sum = scale.mul_add(white, *sum);
            }
            if places.contains(&Place::Open) {
                let open = self.open::<N>(&batch, &places, &light, (receivers, start));
                (0..3).for_each(|channel| radiance[channel] += batch.scales[channel] * open[channel]);
            }
        }
        radiance
    }

    fn corners(&self, place: &Place, receivers: &Receivers<'_>, i: usize) -> Option<Corners> {
        let Place::Between(between) = place else { return None };
        let rows = self.table.objects.get(receivers.object[i] as usize)?.as_ref()?;
        Some(Corners { corners: between.map(|(row, weight)| (rows.at(row), weight)), weight: rows.weight })
    }

    /// In the space of the table.
    fn batch(&self, lobes: &[Lobes; LANES], number: usize) -> LobeBatch {
        let mut batch = LobeBatch { axes: [Vec3::Z; LANES], exponents: f32x8::ZERO, scales: [f32x8::ZERO; 3] };
        let (mut exponents, mut scales) = ([0.0; LANES], [[0.0; LANES]; 3]);
        for (lane, lobes) in lobes.iter().enumerate() {
            let Some(lobe) = lobes.get(number) else { continue };
            batch.axes[lane] = self.light.baked_from_world * lobe.axis;
            exponents[lane] = lobe.exponent;
            (0..3).for_each(|channel| scales[channel][lane] = lobe.scale[channel]);
        }
        batch.exponents = exponents.into();
        batch.scales = scales.map(f32x8::from);
        batch
    }

    /// `b^T M l`, between up to three matrices, each in its own frame.
    fn products<'l, const N: usize, const C: usize>(
        &self,
        batch: &LobeBatch,
        corners: &[Option<Corners>; LANES],
        light: &impl Fn(usize) -> &'l LightVectors,
    ) -> [f32x8; 3] {
        let mut white = [f32x8::ZERO; 3];
        for corner in 0..3 {
            for weight in [Weight::Cosine, Weight::Equal] {
                let of_lane = |lane: usize| -> Option<(usize, f32)> {
                    let corners = corners[lane].as_ref().filter(|corners| corners.weight == weight)?;
                    Some(corners.corners[corner]).filter(|(_, share)| *share != 0.0)
                };
                let chosen: [Option<(usize, f32)>; LANES] = std::array::from_fn(of_lane);
                if chosen.iter().all(Option::is_none) {
                    continue;
                }
                let axes: [Vec3; LANES] = std::array::from_fn(|lane| {
                    chosen[lane].map_or(Vec3::Z, |(number, _)| in_frame(batch.axes[lane], self.table.frames[number]))
                });
                let lobe = self.fitted::<N>(&axes, batch.exponents, weight).map(|value| value.to_array());
                let found = added(|lane| {
                    let mut sums = [f32x8::ZERO; 3];
                    if let Some((number, _)) = chosen[lane] {
                        add_product::<N, C>(&self.table.values, number, &lobe, lane, light(lane), &mut sums);
                    }
                    sums
                });
                let shares = f32x8::from(chosen.map(|chosen| chosen.map_or(0.0, |(_, share)| share)));
                (0..3).for_each(|channel| white[channel] = found[channel].mul_add(shares, white[channel]));
            }
        }
        white
    }

    fn fitted<const N: usize>(&self, axes: &[Vec3; LANES], exponents: f32x8, weight: Weight) -> ShBatch<N> {
        let axis = std::array::from_fn(|i| f32x8::from(axes.map(|axis| axis[i])));
        fitted_power(axis, exponents, &self.fits.fits[weight as usize])
    }

    /// The same for receivers of which nothing is known, as if nothing hid any light: few, if any, so that they may take long.
    fn open<'l, const N: usize>(
        &self,
        batch: &LobeBatch,
        places: &[Place; LANES],
        light: &impl Fn(usize) -> &'l LightVectors,
        (receivers, start): (&Receivers<'_>, usize),
    ) -> [f32x8; 3] {
        let mut sums = [[0.0_f32; LANES]; 3];
        for lane in (0..LANES).filter(|&lane| places[lane] == Place::Open) {
            let normal = self.light.baked_from_world * receivers.normal_at(start + lane);
            let frame = Hemisphere::frame(Vec3::ZERO, normal);
            let weight = self.weight_of(receivers.object[start + lane]);
            let mut axes = [Vec3::Z; LANES];
            axes[lane] = in_frame(batch.axes[lane], [frame.z_axis, frame.x_axis].map(|axis| axis.as_vec3()));
            let lobe = self.fitted::<N>(&axes, batch.exponents, weight).map(|value| f64::from(value.to_array()[lane]));
            for (sum, light) in sums.iter_mut().zip(light(lane)) {
                let light = light.map(f32x8::to_array);
                let light = &light.as_flattened()[..N];
                sum[lane] = open_product(&lobe, &self.fits.grams[weight as usize], light, &frame) as f32;
            }
        }
        sums.map(f32x8::from)
    }

    /// Lobes of an object without matrices are those of a scene without any vertices.
    fn weight_of(&self, object: u32) -> Weight {
        self.table.objects.get(object as usize).and_then(Option::as_ref).map_or(Weight::Cosine, |rows| rows.weight)
    }
}

/// `b^T G R^T l` with R the turn of `frame`.
fn open_product(lobe: &[f64], gram: &[f64], light: &[f32], frame: &DMat3) -> f64 {
    let bands = lobe.len().isqrt();
    let light: Vec<f64> = light.iter().copied().map(f64::from).collect();
    let own = ShRotation::new(bands, &frame.to_cols_array_2d()).apply(&light);
    let rows = gram.chunks_exact(lobe.len()).map(|row| halfshade_sh::basis::dot(row, &own));
    rows.zip(lobe).map(|(row, b)| row * b).sum()
}

/// A direction in a frame of normal and tangent.
fn in_frame(direction: Vec3, [normal, tangent]: [Vec3; 2]) -> Vec3 {
    Vec3::new(direction.dot(tangent), direction.dot(normal.cross(tangent)), direction.dot(normal))
}
