//! Light times the vectors of a compressed table.

use super::light::FrameLight;
use crate::prt::{
    bake::{compress::Clusters, table::Transfer},
    kernel::decode::{Product, multiply},
};
use halfshade_sh::{dispatch_bands, kernel::LANES};
use rayon::prelude::*;

/// Vectors of a task: fewer take less time than it takes to wake another thread.
const TASK: usize = 512 * LANES;

/// Makes `products` those of a frame.
pub(crate) fn set(transfer: &Transfer, clusters: &Clusters, light: &FrameLight, products: &mut Vec<Product>) {
    let width = transfer.width();
    products.resize(clusters.count(width) * (clusters.components + 1), Product::default());
    let part = |(number, part): (usize, &mut [Product])| {
        let vectors = &clusters.vectors[number * TASK * width..];
        // Settings allow no other number of bands.
        let _: Option<()> = dispatch_bands!(transfer.bands, N => match transfer.channels {
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
