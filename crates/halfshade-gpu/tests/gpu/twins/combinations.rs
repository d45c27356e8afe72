//! How spheres combine: sums of logarithms, products, shares.

use super::{
    direction,
    sh_exp::{ExactTable, Frame, OfCut, Receiver, add_lobe, arrangements, seen_from, times_factors},
};
use glam::{DMat3, DQuat, DVec3};
use halfshade_gpu::{Gpu, probe::DeviceBlocker};
use halfshade_sh::{
    basis,
    blocker_table::Quantity,
    exponential::{limit_to_visibility, product_of_blockers},
    logarithm::DEFAULT_CLIP,
    wgsl::MAX_WGSL_BANDS,
};
use libtest_mimic::Failed;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::{f64::consts::TAU, sync::Arc};

pub(super) fn log_sum(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let arrangements = arrangements(&mut Pcg64Mcg::seed_from_u64(8));
    for bands in 1..=MAX_WGSL_BANDS {
        let mut frame = Frame::new(&format!("bands={bands},bounces=0"))?;
        let table = ExactTable::new(bands, Quantity::Logarithm { clip: DEFAULT_CLIP });
        let function = OfCut { shader: "sh_exp/log_sum.wgsl", function: "log_sum", bands, constants: &[] };
        function.hold(gpu, &mut frame, &arrangements, |blockers, receiver| {
            let mut sum = vec![0.0; bands * bands];
            for (blocker, (direction, sin_squared)) in seen(blockers, receiver) {
                add_lobe(direction, &times_factors(blocker, table.zonal(sin_squared)), 1.0, &mut sum);
            }
            sum
        })?;
    }
    Ok(())
}

pub(super) fn product(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let arrangements = arrangements(&mut Pcg64Mcg::seed_from_u64(9));
    for bands in 1..=MAX_WGSL_BANDS {
        let mut frame = Frame::new(&format!("bands={bands},bounces=0,exp=product"))?;
        let table = ExactTable::new(bands, Quantity::BlockerMinusOne);
        let shader = "sh_exp/product.wgsl";
        let function = OfCut { shader, function: "product_of_blockers", bands, constants: &[] };
        function.hold(gpu, &mut frame, &arrangements, |blockers, receiver| {
            let blockers: Vec<Vec<f64>> = seen(blockers, receiver)
                .map(|(_, (direction, sin_squared))| {
                    let mut blocker = basis::one(bands);
                    add_lobe(direction, &table.zonal(sin_squared), 1.0, &mut blocker);
                    blocker
                })
                .collect();
            product_of_blockers(bands, blockers.iter().map(Vec::as_slice))
        })?;
    }
    Ok(())
}

/// Points that fill rows of eight and points that don't, in a space that is turned.
pub(super) fn shares(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(10);
    let arrangements = arrangements(&mut random);
    for (bands, points) in (1..=MAX_WGSL_BANDS).zip([8, 5, 1, 8, 12, 8]) {
        let mut frame = Frame::new(&format!("bands={bands},bounces=0,exp=shares,points={points}"))?;
        let turn =
            DMat3::from_quat(DQuat::from_axis_angle(direction(&mut random).normalize(), random.random_range(0.0..TAU)));
        let rows = turn.transpose().to_cols_array_2d();
        frame.tables.uniforms.share_space = rows.map(|[x, y, z]| [x as f32, y as f32, z as f32, 0.0]);
        let table = ExactTable::new(bands, Quantity::BlockerMinusOne);
        let function = OfCut {
            shader: "sh_exp/shares.wgsl",
            function: "shares_of_blockers",
            bands,
            constants: &[("POINTS", f64::from(points))],
        };
        function.hold(gpu, &mut frame, &arrangements, |blockers, receiver| {
            let seen: Vec<(DVec3, f64)> = seen(blockers, receiver).map(|(_, seen)| seen).collect();
            let caps: Vec<Cap> =
                seen.iter().map(|&(direction, sin_squared)| Cap::new(turn * direction, sin_squared)).collect();
            let mut visibility = basis::one(bands);
            for (own, &(direction, sin_squared)) in seen.iter().enumerate() {
                let share = exposed_share(own, &caps, points);
                add_lobe(direction, &table.zonal(sin_squared), share, &mut visibility);
            }
            limit_to_visibility(&mut visibility);
            visibility
        })?;
    }
    Ok(())
}

/// The spheres that a receiver sees.
fn seen<'a>(
    blockers: &'a [DeviceBlocker],
    receiver: &Receiver,
) -> impl Iterator<Item = (&'a DeviceBlocker, (DVec3, f64))> {
    blockers.iter().filter_map(move |blocker| Some((blocker, seen_from(receiver, blocker)?)))
}

/// A cap of directions: its centre and `1 - cos` of its angular radius.
struct Cap {
    direction: DVec3,
    versine: f64,
}

impl Cap {
    fn new(direction: DVec3, sin_squared: f64) -> Self {
        Self { direction, versine: sin_squared / (1.0 + (1.0 - sin_squared).sqrt()) }
    }

    /// Points at equal solid angle, each turned by the golden angle from the one before.
    fn points(&self, count: u32) -> impl Iterator<Item = DVec3> {
        let d = self.direction;
        // The shortest turn from the y axis to the direction takes the other axes to these.
        let a = -1.0 / (1.0 + d.y).max(1e-4);
        let across = DVec3::new(d.x * d.x * a + 1.0, -d.x, d.x * d.z * a);
        let along = DVec3::new(d.x * d.z * a, -d.z, d.z * d.z * a + 1.0);
        (0..count).map(move |point| {
            let versine = self.versine * (f64::from(point) + 0.5) / f64::from(count);
            let (sin, cos) = (f64::from(point) * TAU * (1.0 - 0.5 * (5f64.sqrt() - 1.0))).sin_cos();
            (versine * (2.0 - versine)).sqrt() * (across * cos + along * sin) + (1.0 - versine) * d
        })
    }
}

/// The mean over the points of a cap of 1 over the number of caps there, where a cap no larger than what a point stands for is
/// widened to that, and counts for less.
fn exposed_share(own: usize, caps: &[Cap], count: u32) -> f64 {
    let points = f64::from(count);
    let part = caps[own].versine / points;
    let exposed = caps[own].points(count).map(|point| {
        let others = caps.iter().enumerate().filter(|(other, _)| *other != own);
        let number = others.map(|(_, other)| {
            let widened = other.versine.max(part);
            let versine = 0.5 * other.direction.distance_squared(point);
            (points + 0.5 - points * versine / widened).clamp(0.0, 1.0) * other.versine / widened
        });
        1.0 / (1.0 + number.sum::<f64>())
    });
    exposed.sum::<f64>() / points
}
