//! Light without visibility: what ignoring shadows costs, and the value that errors are compared with.
//!
//! ```text
//! L = albedo/π · E(n)      E(n) = ∫ L_env(ω) max(n·ω, 0) dω + E_sun(n) + Σ E_light(p, n)
//! ```
//!
//! Constant light, the sun and local spheres are closed forms. A map's irradiance is tabulated over normals in the
//! environment's own space, so that turning the environment costs a rotation per receiver and no rebuilding. It isn't
//! band-limited; its error is that of the cells ([`DirectionalCells`]) and of the interpolation, together below 5e-3 of
//! the irradiance's mean at the default resolution. Of gloss it knows nothing: a lobe cut by a horizon has no table over
//! normals.

use glam::{Mat3, Vec3};
use halfshade_scene::{
    Frame, Progress, RadianceMut, Receivers, Scene, SphereLight,
    light::{DirectionalCells, DistantLight, OctahedralGrid, Sun},
};
use halfshade_strategy::{
    Baked, Effect, Effects, Footprint, Info, Params, Prepared, Strategy, StrategyError, settings,
};
use rayon::prelude::*;
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

/// The environment's irradiance over normals, in its own space.
#[derive(Debug)]
pub struct Irradiance {
    /// The environment without its sun.
    pub base: DistantLight,
    /// Nodes of the table.
    pub grid: OctahedralGrid,
    /// Irradiance at each node of the grid; empty for constant light.
    pub table: Vec<Vec3>,
}

impl Unshadowed {
    /// The table that it bakes for `scene`.
    pub fn irradiance(scene: &Scene, params: &Params) -> Irradiance {
        let grid = OctahedralGrid::new(Settings::read(params).normals);
        let mut irradiance = Irradiance { base: DistantLight::Constant(Vec3::ZERO), grid, table: Vec::new() };
        irradiance.set_base(&scene.environment.base);
        irradiance
    }
}

/// The light of a frame.
#[derive(Debug)]
struct FrameLight<'a> {
    distant: &'a Irradiance,
    sun: Option<Sun>,
    environment_from_world: Mat3,
    lights: Vec<SphereLight>,
}

impl Strategy for Unshadowed {
    fn info(&self) -> Info {
        Info {
            name: "unshadowed",
            summary: "light without visibility: what ignoring shadows costs",
            source: "[Dachsbacher2017]",
            parameters: Settings::parameters(),
            presets: &[],
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

impl Irradiance {
    /// Makes it that of `base`; whether it was another one.
    pub fn set_base(&mut self, base: &DistantLight) -> bool {
        if self.base.is_same_as(base) {
            return false;
        }
        self.base = base.clone();
        self.table = match base {
            DistantLight::Constant(_) => Vec::new(),
            DistantLight::Map(map) => {
                let cells = DirectionalCells::new(map);
                let nodes = 0..self.grid.node_count();
                nodes.into_par_iter().map(|node| cells.irradiance(self.grid.direction(node))).collect()
            }
        };
        true
    }

    fn at(&self, normal: Vec3) -> Vec3 {
        match &self.base {
            DistantLight::Constant(radiance) => PI * *radiance,
            DistantLight::Map(_) => {
                let found = self.grid.lookup(normal);
                (0..3).map(|k| found.weights[k] * self.table[found.nodes[k]]).sum()
            }
        }
    }
}

impl FrameLight<'_> {
    fn irradiance(&self, position: Vec3, normal: Vec3) -> Vec3 {
        let normal_in_environment = self.environment_from_world * normal;
        let mut irradiance = self.distant.at(normal_in_environment);
        if let Some(sun) = self.sun {
            irradiance += sun.irradiance(normal_in_environment);
        }
        self.lights.iter().fold(irradiance, |sum, light| sum + light.irradiance(position, normal))
    }
}

impl Baked for Irradiance {
    fn footprint(&self) -> Footprint {
        Footprint { parts: vec![("irradiance over normals", size_of_val(self.table.as_slice()))] }
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
        self.set_base(&frame.scene.environment.base);
        Ok(Box::new(FrameLight {
            distant: self,
            sun: frame.scene.environment.sun,
            environment_from_world: Mat3::from_quat(frame.world_from_environment.normalize().conjugate()),
            lights: frame.lights.clone(),
        }))
    }
}

impl Prepared for FrameLight<'_> {
    fn shade(&self, receivers: Receivers<'_>, mut out: RadianceMut<'_>) {
        for i in 0..receivers.len() {
            let irradiance = self.irradiance(receivers.position_at(i), receivers.normal_at(i));
            out.set(i, receivers.albedo_at(i) * irradiance / PI);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfshade_scene::light::EnvironmentMap;
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
