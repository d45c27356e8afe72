//! Receivers on objects that move, eight at a time, beside those on what stands still.

use super::place::Place;
use crate::{
    prt::{
        bake::table::Transfer,
        kernel::{
            decode::{Product, transposed},
            grid::Grid,
            volume::{BANDS, COEFFICIENTS, reflected},
        },
    },
    shared::rotate::rotated,
};
use glam::{Mat3, Vec3};
use halfshade_scene::{Pose, RadianceMut, Receivers, SurfacePoint};
use halfshade_sh::{
    kernel::{self, LANES},
    zonal,
};
use halfshade_strategy::Prepared;
use std::sync::Arc;
use wide::{f32x4, f32x8};

/// Shades what moves, after another one has shaded the rest.
pub(crate) struct VolumeShader<'a> {
    pub(crate) rest: Box<dyn Prepared + 'a>,
    pub(crate) grid: Grid,
    /// Light that arrives at its points.
    pub(crate) incoming: &'a [Product],
    /// Whether each object moves.
    pub(crate) moves: &'a [bool],
    pub(crate) baked_from_world: Pose,
    /// Transfer of bodies in their own space, by object.
    pub(crate) own: &'a [Option<Arc<Transfer>>],
    /// How they are turned, as `rotated` reads it.
    pub(crate) turns: &'a [Vec<f32>],
}

impl Prepared for VolumeShader<'_> {
    fn shade(&self, receivers: Receivers<'_>, mut out: RadianceMut<'_>) {
        self.rest.shade(receivers, RadianceMut { channels: out.channels.each_mut().map(|channel| &mut **channel) });
        let cosine = zonal::reflectance(BANDS).into_iter().map(|value| value as f32).collect::<Vec<_>>();
        for start in (0..receivers.len()).step_by(LANES) {
            let end = (start + LANES).min(receivers.len());
            let moves: [bool; LANES] =
                std::array::from_fn(|lane| start + lane < end && self.moves(&receivers, start + lane));
            if !moves.contains(&true) {
                continue;
            }
            let white = self.white(&receivers, start, &moves, &cosine).map(f32x8::to_array);
            for lane in (0..end - start).filter(|&lane| moves[lane]) {
                let i = start + lane;
                (0..3)
                    .for_each(|channel| out.channels[channel][i] = receivers.albedo[channel][i] * white[channel][lane]);
            }
        }
    }
}

impl VolumeShader<'_> {
    fn moves(&self, receivers: &Receivers<'_>, i: usize) -> bool {
        self.moves.get(receivers.object[i] as usize).is_some_and(|moves| *moves)
    }

    /// Radiance of white receivers.
    fn white(&self, receivers: &Receivers<'_>, start: usize, moves: &[bool; LANES], cosine: &[f32]) -> [f32x8; 3] {
        let rotation = Mat3::from_quat(self.baked_from_world.rotation);
        let normals: [Vec3; LANES] =
            std::array::from_fn(
                |lane| if moves[lane] { rotation * receivers.normal_at(start + lane) } else { Vec3::Y },
            );
        let normal = std::array::from_fn(|axis| f32x8::from(normals.map(|normal| normal[axis])));
        let basis: [f32x8; COEFFICIENTS] = kernel::basis::<f32x8, COEFFICIENTS>(normal);
        let mut transfer = kernel::times_bands(&basis, cosine).map(f32x8::to_array);
        self.set_own(receivers, start, moves, &mut transfer);
        transposed(|lane| {
            if !moves[lane] {
                return f32x4::ZERO;
            }
            let place = self.baked_from_world.transform_point(receivers.position_at(start + lane));
            reflected(self.incoming, &self.grid.weights(place), &transfer.each_ref().map(|values| values[lane]))
        })
    }

    /// Transfer of those receivers whose bodies have it, turned as those are.
    fn set_own(
        &self,
        receivers: &Receivers<'_>,
        start: usize,
        moves: &[bool; LANES],
        transfer: &mut [[f32; LANES]; COEFFICIENTS],
    ) {
        let mut left = *moves;
        while let Some(first) = left.iter().position(|is_left| *is_left) {
            let number = receivers.object[start + first] as usize;
            let mut vectors = [[0.0; LANES]; COEFFICIENTS];
            let mut is_own = [false; LANES];
            for lane in first..LANES {
                if !left[lane] || receivers.object[start + lane] as usize != number {
                    continue;
                }
                left[lane] = false;
                let own = self.own.get(number).and_then(Option::as_deref);
                if let Some(vector) = own.and_then(|own| own_vector(own, receivers.surface[start + lane])) {
                    is_own[lane] = true;
                    vectors.iter_mut().zip(vector).for_each(|(values, value)| values[lane] = value);
                }
            }
            if is_own.contains(&true) {
                let turned = rotated(&vectors.map(f32x8::from), &self.turns[number]).map(f32x8::to_array);
                for (values, turned) in transfer.iter_mut().zip(turned) {
                    (0..LANES).filter(|&lane| is_own[lane]).for_each(|lane| values[lane] = turned[lane]);
                }
            }
        }
    }
}

/// Transfer of a point of a body, in its space; none where nothing is baked.
fn own_vector(own: &Transfer, surface: SurfacePoint) -> Option<[f32; COEFFICIENTS]> {
    let between = match Place::on(own.objects.first()?, surface) {
        Place::Between(between) => between,
        Place::Dark => return Some([0.0; COEFFICIENTS]),
        Place::Open => return None,
    };
    let mut vector = [0.0; COEFFICIENTS];
    for (row, weight) in between {
        vector.iter_mut().zip(own.vector(row, 0)).for_each(|(sum, value)| *sum += weight * value);
    }
    Some(vector)
}
