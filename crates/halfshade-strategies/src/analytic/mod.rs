//! Products of closed forms: the part of the sky, and of every lamp, that each sphere leaves. What games ship.
//!
//! ```text
//! L = albedo/π · (E_sky Π_s (1 - h_s) + Σ_l E_l Π_s (1 - h_sl))
//! ```
//!
//! with E the light that arrives unshadowed, which is known; h_s the part of a constant sky's irradiance that sphere s hides, in closed
//! form, cut by the horizon \[Snyder1996\]; h_sl the part of lamp l's cap of directions that the cap of the sphere hides
//! \[Oat2007\]. Lamps are spherical lights, the sun, and small bright parts of a map; the rest of a map is shadowed as if it
//! were constant.
//!
//! **One sphere** is exact under a constant sky, and in its part of a lamp's solid angle. **Many** are multiplied as if each hid light
//! independently of the others: right in the mean where they are scattered, too dark where they stand side by side and add up,
//! too dark by far where they overlap and hide the same light twice. An object made of dozens of overlapping spheres is the worst case:
//! `tests/analytic` holds how far off that is. Another set of spheres for the same object gives another shadow.
//!
//! **Own object.** Its spheres are left out, as they bound it and every receiver on it lies in some; so it hides no light from itself.
//! `own=spheres` keeps them. Objects without spheres hide nothing from others.
//!
//! **Within a sphere** a receiver sees it as the hemisphere towards its centre.
//!
//! **Bounds.** Radiance lies between 0 and what arrives unshadowed, and a blocker more never brightens.

pub mod arrays;
mod kernel;
mod prepare;
mod settings;
mod shade;

use crate::shared::{blockers::Blockers, divided_light::DividedLight};
use halfshade_scene::{Frame, Progress, Scene};
use halfshade_strategy::{Baked, Effect, Effects, Footprint, Info, Params, Prepared, Strategy, StrategyError};
use prepare::frame::FrameData;
use settings::Settings;
use shade::Shader;

/// The strategy.
#[derive(Debug, Clone, Copy, Default)]
pub struct Analytic;

/// Light of the scene, and data of the last frame.
#[derive(Debug)]
pub struct BakedScene {
    settings: Settings,
    light: DividedLight,
    blockers: Blockers,
    frame: FrameData,
    /// How often the light has become another one.
    light_changes: u32,
}

impl Strategy for Analytic {
    fn info(&self) -> Info {
        Info {
            name: "analytic",
            summary: "products of what each sphere hides of the sky and of every lamp, in closed form: what games ship",
            source: "[Snyder1996], [Oat2007]",
            parameters: Settings::parameters(),
            presets: &[],
            stages: &[],
            effects: Effects::of(&Effect::DIRECT),
        }
    }

    fn bake(&self, scene: &Scene, params: &Params, _: &dyn Progress) -> Result<Box<dyn Baked>, StrategyError> {
        Ok(Box::new(Self::bake_scene(scene, params)))
    }
}

impl Analytic {
    /// [`Strategy::bake`], for who reads the arrays of its frames.
    pub fn bake_scene(scene: &Scene, params: &Params) -> BakedScene {
        let settings = Settings::read(params);
        BakedScene {
            light: DividedLight::new(&scene.environment.base, settings.environment_lamps),
            blockers: Blockers::new(scene),
            settings,
            frame: FrameData::default(),
            light_changes: 0,
        }
    }
}

impl BakedScene {
    /// Brings everything up to a frame.
    fn prepare_frame(&mut self, frame: &Frame<'_>) -> Result<(), StrategyError> {
        if frame.scene.objects.len() != self.blockers.object_count() {
            return Err(StrategyError::Failed("the frame is of another scene than was baked".into()));
        }
        if self.light.set(&frame.scene.environment.base) {
            self.light_changes += 1;
        }
        self.frame = FrameData::new(frame, &self.blockers, &self.light);
        Ok(())
    }
}

impl Baked for BakedScene {
    fn footprint(&self) -> Footprint {
        Footprint {
            parts: vec![
                ("irradiance over normals", self.light.bytes()),
                ("spheres and lamps", self.frame.bytes()),
                ("bindings", self.blockers.bytes()),
            ],
        }
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
        self.prepare_frame(frame)?;
        Ok(Box::new(Shader { frame: &self.frame, rest: &self.light.rest, sees_own: self.sees_own() }))
    }
}
