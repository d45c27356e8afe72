//! All of the light of receivers that nothing hides.

use super::{
    CALLS, compare, direction, finite,
    sampler::{position, scenes},
    tolerance,
    traverse::ray_variables,
};
use glam::{DVec3, Quat};
use halfshade_gpu::{
    Gpu,
    probe::{Probe, RayBuffers},
};
use halfshade_scene::{Frame, light::DistantLight};
use halfshade_strategies::{
    RayTraced,
    ray_traced::arrays::{Irradiance, SampleArrays},
};
use halfshade_strategy::Strategy;
use libtest_mimic::Failed;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use std::{f64::consts::PI, sync::Arc};

const SHADER: &str = "ray_traced/irradiance.wgsl";

/// Tables of maps, suns and lamps cut by the horizon, receivers within lamps.
pub(super) fn irradiance(gpu: &Arc<Gpu>) -> Result<(), Failed> {
    let mut random = Pcg64Mcg::seed_from_u64(41);
    let params = RayTraced.info().parse("estimator=ratio").map_err(|error| Failed::from(error.to_string()))?;
    for (number, scene) in scenes(&mut random).iter().enumerate() {
        let mut frame = scene.frame(0);
        frame.world_from_environment = Quat::from_axis_angle(glam::Vec3::new(0.6, 0.0, 0.8), 0.7 * number as f32);
        let Some(table) = SampleArrays::new(&params).irradiance(scene) else {
            return Err("light isn't known".into());
        };
        let rays = RayBuffers::new(&frame, &params)?;
        let calls: Vec<[DVec3; 2]> = (0..CALLS).map(|i| [position(i, &mut random), direction(&mut random)]).collect();
        let inputs: Vec<[f32; 4]> =
            calls.iter().flatten().map(|vector| vector.extend(0.0).as_vec4().to_array()).collect();
        let body = "output[0] = vec4f(irradiance_at(input[0].xyz, input[1].xyz), 0.0);";
        let variables = ray_variables(&rays);
        let found = Probe { shader: SHADER, bands: None, constants: &[], rows: [2, 1], body, variables: &variables }
            .call(gpu, &inputs)?;
        finite(&found)?;
        let expected: Vec<f64> = calls
            .iter()
            .flat_map(|[position, normal]| expected(&frame, &table, *position, *normal).to_array())
            .collect();
        compare(&format!("light {number}"), tolerance(SHADER), &found, &expected, 3)?;
    }
    Ok(())
}

/// The parts of the light, each by the code that owns it.
fn expected(frame: &Frame<'_>, table: &Irradiance, position: DVec3, normal: DVec3) -> DVec3 {
    let (position, normal) = (position.as_vec3(), normal.as_vec3());
    let turned = frame.world_from_environment.conjugate() * normal;
    let base = match &table.base {
        DistantLight::Constant(radiance) => PI * radiance.as_dvec3(),
        DistantLight::Map(_) => {
            let found = table.grid.lookup(turned);
            (found.nodes.iter().zip(found.weights))
                .map(|(&node, weight)| f64::from(weight) * table.table[node].as_dvec3())
                .sum()
        }
    };
    let sun = frame.scene.environment.sun.map_or(DVec3::ZERO, |sun| sun.irradiance(turned).as_dvec3());
    frame.lights.iter().fold(base + sun, |sum, light| sum + light.irradiance(position, normal).as_dvec3())
}
