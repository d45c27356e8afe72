//! Distant light, projected onto spherical harmonics: S_d [Tamura2006, figure 3].

use crate::shared::projected_light::project_environment;
use halfshade_scene::Environment;

/// Distant light, projected.
pub(crate) struct DistantLight {
    pub(crate) environment: Environment,
    /// Coefficient by coefficient, red, green, blue.
    pub(crate) coefficients: Vec<[f32; 3]>,
}

/// The light of an environment in so many bands.
pub(crate) fn distant_light(bands: usize, environment: &Environment) -> DistantLight {
    let light = project_environment(bands, environment);
    let coefficients = (0..bands * bands).map(|i| std::array::from_fn(|channel| light[channel][i] as f32)).collect();
    DistantLight { environment: environment.clone(), coefficients }
}
