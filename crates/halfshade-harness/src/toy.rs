//! Strategies for the harness's own tests: their errors are known without any truth.

use halfshade_scene::{Frame, Progress, RadianceMut, Receivers, Scene};
use halfshade_strategy::{
    Baked, Effect, Effects, Footprint, Info, Params, Prepared, Preset, Stage, Strategy, StrategyError, settings,
};

/// `dim` answers albedo times a factor, `black` answers nothing and cannot model local lights, `broken` answers NaN.
pub(crate) fn strategies() -> Vec<Box<dyn Strategy>> {
    vec![Box::new(Toy("dim")), Box::new(Toy("black")), Box::new(Toy("broken"))]
}

settings! {
    /// The settings of `dim`.
    struct Dimming {
        /// radiance by albedo
        "factor" => factor: f32 = 1.0, in 0.0..=1.0, levels ["0.25", "0.5", "1"];
    }
}

struct Toy(&'static str);

struct BakedToy(f32);

impl Strategy for Toy {
    fn info(&self) -> Info {
        Info {
            name: self.0,
            summary: "a toy",
            source: "",
            parameters: match self.0 {
                "dim" => Dimming::parameters(),
                _ => Vec::new(),
            },
            presets: match self.0 {
                "dim" => &[Preset { name: "half", summary: "half of it", settings: "factor=0.5" }],
                _ => &[],
            },
            stages: match self.0 {
                "dim" => &[Stage { name: "factor", exact: "factor=1" }],
                _ => &[],
            },
            effects: Effects::of(&[Effect::EnvironmentLight, Effect::ColouredLight, Effect::Motion]),
        }
    }

    fn needs_spheres(&self) -> bool {
        false
    }

    fn bake(&self, _scene: &Scene, params: &Params, _: &dyn Progress) -> Result<Box<dyn Baked>, StrategyError> {
        Ok(Box::new(BakedToy(match self.0 {
            "dim" => Dimming::read(params).factor,
            "black" => 0.0,
            _ => f32::NAN,
        })))
    }
}

impl Baked for BakedToy {
    fn footprint(&self) -> Footprint {
        Footprint { parts: vec![("factor", 4)] }
    }

    fn prepare(&mut self, _frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
        Ok(Box::new(&*self))
    }
}

impl Prepared for &BakedToy {
    fn shade(&self, receivers: Receivers<'_>, mut out: RadianceMut<'_>) {
        for i in 0..receivers.len() {
            out.set(i, receivers.albedo_at(i) * self.0);
        }
    }
}
