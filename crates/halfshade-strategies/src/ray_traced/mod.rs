//! A few shadow rays per receiver: what a user would pick today instead of a precomputed or band-limited method.
//!
//! Light E that would arrive unshadowed is known exactly; from the rays only the share of it that is seen is taken, by channel
//! \[Heitz2018\] (`estimator=ratio`):
//!
//! ```text
//! L ≈ albedo/π · E · Σ w_i V(ω_i) / Σ w_i      w_i = L(ω_i) max(n·ω_i, 0) / p(ω_i)
//! ```
//!
//! It lies between 0 and the unshadowed light, whatever the rays meet, and is E itself where no ray carries light. Its bias falls with
//! 1/k. Meshes have their hierarchies from `bake` on; `prepare` puts one over the objects where they stand when a pose has changed, and
//! refits those of meshes that deform.
//!
//! **Directions** (`sampling=product`) go to the environment, the sun and each lamp in turn, to each as often as its irradiance is a
//! part of E, and E times the share becomes the sum of each light's own. Of a map they are drawn by light times cosine, through cells that
//! are halved \[Clarberg2005\]: weights w are nearly equal, and what is left of the noise is that of visibility. Points are a
//! scrambled Sobol' sequence that neighbours in a picture share among themselves \[Ahmed2020\].
//!
//! **Neighbours** (`filter=edge-avoiding`, and not with the preset `unfiltered`) tell each other their shares: à trous
//! \[Dammertz2010\], over pixels or along the edges of a mesh, with weights that stop where surfaces turn and where shares differ
//! by more than their noise \[Schied2017\]. At equal time that errs less than more rays do. Light and albedo aren't smoothed, since they are known; nor are lobes of glossy receivers. It is biased where shadows are finer than
//! the neighbours are near: contact shadows and penumbras widen as far as noise hides their slope, by `2^filter-levels - 1`
//! pixels or edges at most, less the more rays there are; a receiver without neighbours of its kind, on a thin part or beside a
//! silhouette, keeps its noise. Surfaces that curve by more than `filter-angle` from neighbour to neighbour aren't smoothed at all;
//! below that, they are the less the more they curve. Other than the filter of \[Mehta2012\] it needs no distances of blockers, which
//! rays that stop at the first hit don't know.
//!
//! **Plain** (`estimator=plain`, and the preset of that name) estimates light and visibility together:
//!
//! ```text
//! L ≈ albedo/π · 1/k · Σ L(ω_i) V(ω_i) max(n·ω_i, 0) / p(ω_i)
//! ```
//!
//! with directions drawn by cosine, by light, or half and half with the density of the mixture, which is multiple
//! importance sampling under the balance heuristic \[Veach1995\]. Unbiased; the standard error falls faster than 1/√k
//! because the points are spread evenly; but a few rays miss what is bright in a map.
//!
//! A glossy receiver draws by all of its lobes, the diffuse one among them, in place of the cosine, and by light: `max(n·ω, 0) ·
//! albedo/π` becomes their sum. Sharp lobes are then found whatever shines into them, except by `sampling=light` alone, which is
//! unbiased there but noisy. Lobes are estimated plainly, the diffuse part by the ratio.
//!
//! Shares nothing with the truth but rays: a mistake that both made would cancel out in the score.

pub mod arrays;
mod prepare;
mod settings;
mod shade;

use crate::shared::{
    irradiance::{FrameIrradiance, Irradiance},
    scene_occlusion::{Meshes, Occlusion},
};
use arrays::{FILTERS_SHARES, FilterArrays, SampleArrays};
use halfshade_rays::SceneRays;
use halfshade_scene::{EyeLobes, Frame, Placement, Progress, Receivers, Scene};
use halfshade_strategy::{Baked, Effect, Effects, Footprint, Info, Params, Prepared, Preset, Strategy, StrategyError};
use prepare::{light_sampler::LightSampler, neighbours::Neighbours};
use settings::{STAGES, Settings};
use shade::{FrameRays, filter::Filter};

/// The strategy.
#[derive(Debug, Clone, Copy, Default)]
pub struct RayTraced;

/// The state kept from frame to frame: objects that stay where they are, and light that doesn't change, cost nothing.
struct Kept {
    arrays: SampleArrays,
    meshes: Meshes,
    placed: Option<(Placement, SceneRays)>,
    light: Option<LightSampler>,
    /// If light is to be known.
    irradiance: Option<Irradiance>,
    /// If shares are smoothed over them.
    neighbours: Option<Neighbours>,
}

const PRESETS: [Preset; 2] = [
    Preset {
        name: "unfiltered",
        summary: "every receiver by its own rays alone: noise, but no shadow is smoothed",
        settings: "filter=none",
    },
    Preset {
        name: "plain",
        summary: "unbiased: light and visibility estimated together, by light and cosine half and half",
        settings: "sampling=mis,estimator=plain,filter=none",
    },
];

impl Strategy for RayTraced {
    fn info(&self) -> Info {
        Info {
            name: "ray-traced",
            summary: "a few shadow rays per receiver: what one would pick today instead",
            source: "[Heitz2018]",
            parameters: Settings::parameters(),
            presets: &PRESETS,
            stages: STAGES,
            effects: Effects::of(&Effect::DIRECT).with(Effect::GlossyReflectance),
        }
    }

    fn needs_spheres(&self) -> bool {
        false
    }

    fn bake(&self, scene: &Scene, params: &Params, _: &dyn Progress) -> Result<Box<dyn Baked>, StrategyError> {
        let arrays = SampleArrays::new(params);
        if arrays.filter.is_some() && !arrays.is_ratio {
            return Err(StrategyError::Unsupported(FILTERS_SHARES.into()));
        }
        let irradiance = arrays.irradiance(scene);
        let neighbours = arrays.filter.map(|_| Neighbours::default());
        let meshes = Meshes::new(scene);
        Ok(Box::new(Kept { arrays, meshes, placed: None, light: None, irradiance, neighbours }))
    }
}

impl Baked for Kept {
    fn footprint(&self) -> Footprint {
        Footprint {
            parts: vec![
                ("hierarchies and triangles", self.meshes.bytes()),
                ("hierarchy over objects", self.placed.as_ref().map_or(0, |(_, rays)| rays.bytes())),
                ("light sampler", self.light.as_ref().map_or(0, LightSampler::bytes)),
                ("neighbours of receivers", self.neighbours.as_ref().map_or(0, Neighbours::bytes)),
                ("irradiance over normals", self.irradiance.as_ref().map_or(0, Irradiance::bytes)),
            ],
        }
    }

    fn place_receivers(&mut self, frame: &Frame<'_>, receivers: Receivers<'_>) -> Result<(), StrategyError> {
        if let Some(FilterArrays { levels, .. }) = self.arrays.filter {
            self.neighbours = Some(Neighbours::new(frame, receivers, levels));
        }
        Ok(())
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
        let SampleArrays { samples, cosine_share, is_product, is_ratio, filter, .. } = self.arrays;
        let known = self.placed.take().filter(|(placement, _)| frame.is_placed_as(placement));
        let (_, rays) = self.placed.insert(known.unwrap_or_else(|| (frame.placement(), self.meshes.placed(frame))));
        let known = self.light.take();
        let sampler = LightSampler::new(frame, known);
        let light = self.light.insert(if is_product { sampler.with_tree() } else { sampler });
        let irradiance = self.irradiance.as_mut().map(|irradiance| {
            irradiance.set_base(&frame.scene.environment.base);
            FrameIrradiance::new(irradiance, frame)
        });
        Ok(Box::new(FrameRays {
            samples,
            is_product,
            is_ratio,
            cosine_share: if cosine_share > 0.0 && light.is_constant() { 1.0 } else { cosine_share },
            occlusion: Occlusion::new(&self.meshes, rays),
            light,
            irradiance,
            eye_lobes: EyeLobes::new(frame),
            filter: (self.neighbours.as_ref().zip(filter))
                .map(|(neighbours, FilterArrays { stops, .. })| Filter { neighbours, stops }),
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Unshadowed, shared::test_scenes::with_spheres};
    use glam::Vec3;
    use halfshade_scene::{
        Environment, Motion, Pose, RadianceBuffer, ReceiverBuffer, Sphere, SphereLight,
        light::{EnvironmentMap, Sun},
        progress::Silent,
    };

    fn shade(scene: &Scene, settings: &str, receivers: &ReceiverBuffer) -> RadianceBuffer {
        let params = RayTraced.info().parse(settings).unwrap();
        shaded(RayTraced.bake(scene, &params, &Silent).unwrap(), scene, receivers)
    }

    fn shaded(mut baked: Box<dyn Baked>, scene: &Scene, receivers: &ReceiverBuffer) -> RadianceBuffer {
        let frame = scene.frame(0);
        let prepared = baked.prepare(&frame).unwrap();
        let mut out = RadianceBuffer::zeros(receivers.len());
        prepared.shade(receivers.view(), out.view_mut());
        out
    }

    /// Mean over receivers that differ in nothing but their number.
    fn mean_of(count: usize, scene: &Scene, settings: &str) -> f64 {
        let mut receivers = ReceiverBuffer::default();
        (0..count).for_each(|_| receivers.push(Vec3::ZERO, Vec3::Y, Vec3::ONE, 0));
        let out = shade(scene, settings, &receivers);
        out.channels[0].iter().map(|&x| f64::from(x)).sum::<f64>() / count as f64
    }

    fn mean(scene: &Scene, settings: &str) -> f64 {
        mean_of(64, scene, settings)
    }

    #[test]
    fn a_sphere_over_a_receiver_blocks_the_closed_form() {
        let center = Vec3::new(1.0, 2.0, 0.5);
        let scene = with_spheres(Environment::constant(Vec3::ONE), &[Sphere { center, radius: 0.8 }]);
        let expected = 1.0 - 0.8f64.powi(2) / 5.25 * (2.0 / 5.25f64.sqrt());
        for settings in [
            "plain,samples=256,sampling=cosine",
            "plain,samples=256,sampling=light",
            "plain,samples=256",
            "samples=256",
        ] {
            // 64 × 256 samples: standard error below 3e-3 even by chance.
            assert!((mean(&scene, settings) - expected).abs() < 5e-3, "{settings}: {}", mean(&scene, settings));
        }
    }

    /// All ways estimate the same number where the light is a map, a sun and a local sphere.
    #[test]
    fn all_ways_agree() {
        let texels = (0..32 * 16).map(|i| Vec3::splat(0.2 + (i % 5) as f32)).collect();
        let mut environment = Environment::map(EnvironmentMap::new(32, 16, texels).unwrap());
        let direction = Vec3::new(0.5, 0.7, 0.2).normalize();
        environment.sun = Some(Sun { direction, angular_radius: 0.3, radiance: Vec3::splat(20.0) });
        let spheres = [
            Sphere { center: Vec3::new(0.9, 1.5, 0.2), radius: 0.5 },
            Sphere { center: Vec3::new(-0.8, 0.9, -0.4), radius: 0.4 },
        ];
        let mut scene = with_spheres(environment, &spheres);
        let lamp = SphereLight { center: Vec3::new(-1.2, 2.0, 0.6), radius: 0.6, radiance: Vec3::splat(30.0) };
        scene.lights.push((lamp, Motion::Still(Pose::IDENTITY)));
        let reference = mean(&scene, "plain,samples=2048");
        for (settings, tolerance) in [
            ("plain,samples=2048,sampling=cosine", 0.02),
            ("plain,samples=2048,sampling=light", 0.02),
            ("plain,samples=2048,sampling=product", 0.01),
            ("samples=2048", 0.01),
        ] {
            let relative = mean(&scene, settings) / reference - 1.0;
            assert!(relative.abs() < tolerance, "{settings}: {relative}");
        }
        // Few rays share the lights among them, and what each tells is right in the mean.
        for settings in
            ["unfiltered,samples=3,estimator=plain", "unfiltered,samples=4,estimator=plain", "unfiltered,samples=4"]
        {
            let relative = mean_of(4096, &scene, settings) / reference - 1.0;
            assert!(relative.abs() < 0.02, "{settings}: {relative}");
        }
    }

    fn lit_by_a_map() -> Scene {
        let texels =
            (0..32 * 16).map(|i| Vec3::new(0.2 + (i % 5) as f32, 1.0, if i == 40 { 300.0 } else { 0.1 })).collect();
        let mut environment = Environment::map(EnvironmentMap::new(32, 16, texels).unwrap());
        let direction = Vec3::new(0.5, 0.7, 0.2).normalize();
        environment.sun = Some(Sun { direction, angular_radius: 0.1, radiance: Vec3::splat(40.0) });
        with_spheres(environment, &[Sphere { center: Vec3::new(0.9, 1.5, 0.2), radius: 0.5 }])
    }

    /// A share of what is known: all of it where nothing is in the way, however few the rays; never less than nothing nor more than
    /// that; and by many rays what they see.
    #[test]
    fn a_ratio_is_a_share_of_the_light() {
        let mut scene = lit_by_a_map();
        let mut receivers = ReceiverBuffer::default();
        (0..64).for_each(|i| receivers.push(Vec3::X * (i as f32 * 0.05 - 1.0), Vec3::Y, Vec3::ONE, 0));
        let open = Unshadowed.bake(&scene, &Unshadowed.info().defaults(), &Silent).unwrap();
        let unshadowed = shaded(open, &scene, &receivers);
        for samples in [1, 4, 64] {
            for sampling in ["mis", "product"] {
                let found = shade(&scene, &format!("samples={samples},sampling={sampling}"), &receivers);
                for i in 0..receivers.len() {
                    assert!(
                        found.at(i).cmpge(Vec3::ZERO).all() && found.at(i).cmple(unshadowed.at(i) * 1.000_001).all()
                    );
                }
            }
        }
        let mean = |settings: &str| mean(&scene, settings);
        let difference = mean("samples=1024,sampling=mis") / mean("plain,samples=4096") - 1.0;
        assert!(difference.abs() < 0.02, "{difference}");
        scene.objects.clear();
        let found = shade(&scene, "samples=2", &receivers);
        assert!((0..receivers.len()).all(|i| (found.at(i) - unshadowed.at(i)).abs().max_element() < 1e-5));
    }

    /// A lobe of 10^5 finds what it mirrors, a small lamp, without a value that stands out.
    #[test]
    fn a_sharp_lobe_mirrors_a_lamp() {
        use halfshade_scene::{Material, Reflectance};
        let exponent = 1e5f32;
        let mut scene =
            with_spheres(Environment::constant(Vec3::ZERO), &[Sphere { center: Vec3::Y * -9.0, radius: 0.1 }]);
        let specular = Vec3::splat((exponent + 1.0) / std::f32::consts::TAU);
        scene.objects[0].material =
            Material { reflectance: Reflectance::Phong { specular, exponent }, ..Material::new(Vec3::ZERO) };
        scene.camera.eye = Vec3::new(0.0, 2.0, 2.0);
        let lamp = SphereLight { center: Vec3::new(0.0, 2.0, -2.0), radius: 0.3, radiance: Vec3::splat(5.0) };
        scene.lights.push((lamp, Motion::Still(Pose::IDENTITY)));
        let mut receivers = ReceiverBuffer::default();
        (0..64).for_each(|i| receivers.push(Vec3::X * 0.01 * i as f32, Vec3::Y, Vec3::ZERO, 0));
        for settings in ["plain,samples=256", "plain,samples=256,sampling=cosine"] {
            let out = shade(&scene, settings, &receivers);
            assert!((out.at(0).x / 5.0 - 1.0).abs() < 0.1, "{settings}: {}", out.at(0));
            assert!(out.at(63).x < 1e-3 && out.channels[0].iter().all(|&x| x < 6.0));
        }
    }
}
