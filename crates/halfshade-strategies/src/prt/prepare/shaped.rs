//! Light as transfer gets it: in what basis, and under what window.

use crate::{
    prt::settings::{LightBasis, Settings, WindowKind},
    shared::projected_light::project_environment,
};
use halfshade_scene::Environment;
use halfshade_sh::{nonnegative::MinimumSearch, window::Window, zh3};

/// Basis and window of light.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LightShape {
    basis: LightBasis,
    window: WindowKind,
}

impl LightShape {
    pub(crate) fn new(settings: &Settings) -> Self {
        let window = if settings.window_on.is_on_light() { settings.window } else { WindowKind::None };
        Self { basis: settings.light, window }
    }

    /// SH vectors of an environment, per channel: radiance times steradian.
    pub(crate) fn projected(self, bands: usize, environment: &Environment) -> [Vec<f64>; 3] {
        let mut light = project_environment(bands, environment);
        // Zonal light has three bands.
        if self.basis != LightBasis::Sh {
            let axis = zh3::luminance_axis(&light);
            let zonal = if self.basis == LightBasis::Zh3 { zh3::keep_zonal } else { zh3::guess_zonal };
            light.iter_mut().for_each(|channel| zonal(channel, axis));
        }
        let window = self.window(bands, &light);
        light.iter_mut().for_each(|channel| window.apply(channel));
        light
    }

    /// One window for all channels: one for each would change the hue.
    fn window(self, bands: usize, light: &[Vec<f64>; 3]) -> Window {
        if self.window != WindowKind::Nonnegative {
            return self.window.fixed();
        }
        let search = MinimumSearch::new(bands);
        let weight = |channel: &Vec<f64>| match search.least_window(channel) {
            Window::Laplacian { lambda } => lambda,
            _ => 0.0,
        };
        match light.iter().map(weight).fold(0.0, f64::max) {
            0.0 => Window::None,
            lambda => Window::Laplacian { lambda },
        }
    }
}
