//! Light times vectors that many receivers share.

use super::light::FrameLight;
use crate::prt::kernel::decode::{Product, multiply};
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
