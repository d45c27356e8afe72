//! Light without visibility: what ignoring shadows costs, and the value that errors are compared with.
//!
//! ```text
//! L = albedo/π · E(n)      E(n) = ∫ L_env(ω) max(n·ω, 0) dω + E_sun(n) + Σ E_light(p, n)
//! ```
//!
//! Constant light, the sun and local spheres are closed forms. A map's irradiance is tabulated over normals in the
//! environment's own space, so that turning the environment costs a rotation per receiver and no rebuilding. It isn't
//! band-limited; its error is that of the cells (`DirectionalCells`) and of the interpolation, together below 5e-3 of
//! the irradiance's mean at the default resolution. Of gloss it knows nothing: a lobe cut by a horizon has no table over
//! normals.

pub use crate::shared::irradiance::Irradiance;

use crate::shared::irradiance::FrameIrradiance;
use halfshade_scene::{Frame, Progress, RadianceMut, Receivers, Scene};
use halfshade_strategy::{
    Baked, Effect, Effects, Footprint, Info, Params, Prepared, Strategy, StrategyError, settings,
};
use std::f32::consts::PI;

/// The strategy.
#[derive(Debug, Clone, Copy, Default)]
pub struct Unshadowed;

settings! {
    /// Everything that can be set.
    struct Settings {
        /// cells from the centre of the table over normals to its side
        "normals" => normals: usize = 32, in 2..=256;
    }
}

impl Unshadowed {
    /// The table that it bakes for `scene`.
    pub fn irradiance(scene: &Scene, params: &Params) -> Irradiance {
        Irradiance::new(&scene.environment.base, Settings::read(params).normals)
    }
}

impl Strategy for Unshadowed {
    fn info(&self) -> Info {
        Info {
            name: "unshadowed",
            summary: "light without visibility: what ignoring shadows costs",
            source: "[Dachsbacher2017]",
            parameters: Settings::parameters(),
            presets: &[],
            stages: &[],
            effects: Effects::of(&Effect::DIRECT),
        }
    }

    fn needs_spheres(&self) -> bool {
        false
    }

    fn bake(&self, scene: &Scene, params: &Params, _: &dyn Progress) -> Result<Box<dyn Baked>, StrategyError> {
        Ok(Box::new(Self::irradiance(scene, params)))
    }
}

impl Baked for Irradiance {
    fn footprint(&self) -> Footprint {
        Footprint { parts: vec![("irradiance over normals", self.bytes())] }
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
        self.set_base(&frame.scene.environment.base);
        Ok(Box::new(FrameIrradiance::new(self, frame)))
    }
}

impl Prepared for FrameIrradiance<'_> {
    fn shade(&self, receivers: Receivers<'_>, mut out: RadianceMut<'_>) {
        for i in 0..receivers.len() {
            let irradiance = self.at(receivers.position_at(i), receivers.normal_at(i));
            out.set(i, receivers.albedo_at(i) * irradiance / PI);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use halfshade_scene::light::{DirectionalCells, DistantLight, EnvironmentMap};
    use std::sync::Arc;

    /// The table against the sum over cells, which `DirectionalCells` tests against quadrature.
    #[test]
    fn interpolation_error_of_the_table() {
        let texels = (0..64 * 32).map(|i| Vec3::new(if i % 97 == 0 { 50.0 } else { 0.1 }, 1.0, (i % 64) as f32 / 64.0));
        let map = Arc::new(EnvironmentMap::new(64, 32, texels.collect()).unwrap());
        let cells = DirectionalCells::new(&map);
        let scene =
            crate::shared::test_scenes::empty(halfshade_scene::Environment { base: DistantLight::Map(map), sun: None });
        let params = Unshadowed.info().defaults();
        let mut baked = Unshadowed.bake(&scene, &params, &halfshade_scene::progress::Silent).unwrap();
        let frame = scene.frame(0);
        let prepared = baked.prepare(&frame).unwrap();
        let mut receivers = halfshade_scene::ReceiverBuffer::default();
        for i in 0..500 {
            let angle = i as f32 * 2.4;
            let y = 1.0 - (i as f32 + 0.5) / 250.0;
            let normal = Vec3::new(angle.cos() * (1.0 - y * y).sqrt(), y, angle.sin() * (1.0 - y * y).sqrt());
            receivers.push(Vec3::ZERO, normal, Vec3::ONE, 0);
        }
        let mut out = halfshade_scene::RadianceBuffer::zeros(500);
        prepared.shade(receivers.view(), out.view_mut());
        for i in 0..500 {
            let exact = cells.irradiance(receivers.view().normal_at(i)) / PI;
            // Small bright texels put kinks into the irradiance, which the triangles round off.
            assert!((out.at(i) - exact).abs().max_element() < 5e-3 * exact.max_element(), "{i}: {} {exact}", out.at(i));
        }
    }
}
