//! Windows on transfer vectors.

use crate::prt::settings::{Settings, WindowKind};
use halfshade_sh::nonnegative::MinimumSearch;
use rayon::prelude::*;

/// Multiplies the bands of every vector by their factors, where windows are on transfer: `nonnegative` has one of its own for each.
pub(crate) fn window(values: &mut [f32], settings: &Settings) {
    if !settings.window_on.is_on_transfer() || settings.window == WindowKind::None {
        return;
    }
    let search = MinimumSearch::new(settings.bands);
    values.par_chunks_exact_mut(settings.bands * settings.bands).for_each(|vector| {
        let mut windowed: Vec<f64> = vector.iter().copied().map(f64::from).collect();
        let window = match settings.window {
            WindowKind::Nonnegative => search.least_window(&windowed),
            fixed => fixed.fixed(),
        };
        window.apply(&mut windowed);
        vector.iter_mut().zip(windowed).for_each(|(value, windowed)| *value = windowed as f32);
    });
}
