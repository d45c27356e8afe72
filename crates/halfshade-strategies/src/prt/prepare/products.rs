//! Light times vectors that many receivers share.

use super::{lamps::FrameLamps, light::FrameLight};
use crate::prt::{
    bake::volume::Volume,
    kernel::{
        decode::{Product, multiply},
        volume::COEFFICIENTS,
    },
};
use halfshade_sh::{dispatch_bands, kernel::LANES};
use rayon::prelude::*;

/// Vectors of a task: fewer take less time than it takes to wake another thread.
const TASK: usize = 512 * LANES;

/// Makes `products` those of a frame with so many rows of C vectors each; `vectors` end in as many zeros as a table does.
pub(crate) fn set(light: &FrameLight, vectors: &[f32], channels: usize, rows: usize, products: &mut Vec<Product>) {
    products.resize(rows, Product::default());
    let width = channels * light.bands * light.bands;
    let part = |(number, part): (usize, &mut [Product])| {
        let vectors = &vectors[number * TASK * width..];
        // Settings allow no other number of bands.
        let _: Option<()> = dispatch_bands!(light.bands, N => match channels {
            1 => multiply::<N, 1>(vectors, &light.vectors, part),
            _ => multiply::<N, 3>(vectors, &light.vectors, part),
        });
    };
    if products.len() <= TASK {
        part((0, products));
    } else {
        products.par_chunks_mut(TASK).enumerate().for_each(part);
    }
}

/// The same of a volume where every point has light of its own, that of local lights among it.
pub(crate) fn set_by_point(light: &FrameLight, lamps: &FrameLamps, volume: &Volume, products: &mut Vec<Product>) {
    products.resize(volume.rows(), Product::default());
    // Settings allow no other number of bands.
    let _: Option<()> = dispatch_bands!(light.bands, N => {
        let eight = |(number, products): (usize, &mut [Product])| {
            let first = number * LANES;
            let places = std::array::from_fn(|lane| volume.grid.point((first + lane).min(volume.grid.len() - 1)));
            let lights = lamps.with_distant::<N>(&places, &light.vectors);
            for (lane, products) in products.chunks_exact_mut(COEFFICIENTS).enumerate() {
                let vectors = &volume.vectors[(first + lane) * COEFFICIENTS * volume.channels * N..];
                match volume.channels {
                    1 => multiply::<N, 1>(vectors, &lights[lane], products),
                    _ => multiply::<N, 3>(vectors, &lights[lane], products),
                }
            }
        };
        products.par_chunks_mut(LANES * COEFFICIENTS).enumerate().for_each(eight);
    });
}
