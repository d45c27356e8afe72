//! Directions that blockers close one after another: no harmonics, and no error but that of visibility.
//!
//! K directions ω_k are drawn from light times cosine, once for each node of a grid over normals and for as long as the light
//! stays the same. Every sphere is a cap of angular radius θ before a receiver and closes the directions within it; so do the
//! receiver's own mesh and boxes. Of the light E that arrives unshadowed, which is known, what is left is the part
//!
//! ```text
//! L = albedo/π · E · Σ_k v_k w_k max(n·ω_k, 0) / Σ_k w_k max(n·ω_k, 0)
//! ```
//!
//! with w_k the light of the cell around ω_k and v_k in [0, 1] the part of the cell that is open, by channel. Lamps (spherical
//! lights, the sun, small bright parts of a map) are apart: each is looked into in directions of its own, as many for all of them
//! together as for the rest, and only by spheres that may be before it.
//!
//! **Edges.** A direction stands for a cell of all directions. `edge=0` leaves it open or closes it, which makes v a mask of bits; by
//! default an edge that crosses the cell closes a part of it, see `kernel/directions.rs`, and spheres that are smaller than the
//! cell close the part that they cover. It takes up to half of the error away at no more time. Where several edges cross a cell, the
//! one that closes most of it counts: a product of what each leaves would err as much and take longer.
//!
//! **Directions** are the same for all receivers of about the same normal: there is no noise, and what one receiver misses its
//! neighbour misses too. Where neighbours lie nearer to another node, a step shows that is as large as the error. A
//! set for each node errs half as much as one set for all (`normals=0`), of whose directions half lie below the horizon.
//!
//! **Arithmetic, no table.** A cap closes eight directions in five operations: three products for the cosine, one for the edge, a
//! minimum. A table of closed directions by axis and radius needs fewer, but would be one per set of directions, more than a
//! cache holds, and has neither edges nor lamps.
//!
//! **Gloss.** A lobe `s max(a·ω, 0)^e` toward the eye is looked along in K/2 directions of its own, spread as the lobe is however
//! sharp that is (`kernel/lobe.rs`), which the same spheres, mesh and boxes close; the horizon closes a part of a cell as well. The light
//! over the whole lobe is known, of a map by a table over axes and exponents (`bake/lobe_light.rs`), and multiplied by the share that is
//! left:
//!
//! ```text
//! L = s · ∫ L_env(ω) max(a·ω, 0)^e dω · Σ_k v_k q_k c_k / Σ_k q_k
//! ```
//!
//! with q_k the map's mean over a direction's cell and c_k the cosine, or how much of the cell is above the horizon. Lamps add to a
//! lobe by the narrower of both: by the directions into the lamp, which are known already, or, where the lobe is narrower, by
//! those along the lobe, the cells of which the lamp fills in part. Where nothing is glossy none of this takes time.
//!
//! **Own object.** `own=baked` traces once what each mesh hides from its vertices (`kernel/own.rs`), which is interpolated between them,
//! and leaves the object's own spheres out. Objects that deform, and receivers that lie nowhere on a mesh or are seen from
//! behind, fall back on the spheres.
//!
//! **Ground.** Objects without spheres hide light from others if they are boxes or rectangles; any other is seen by itself alone.
//!
//! **Bounds.** Diffuse radiance lies between 0 and what arrives unshadowed, by its form; a blocker more never brightens.
//!
//! **Limits.** Mirrors show a map in cells of 2.8 degrees. Directions are few: a lamp's penumbra has as many steps as it is looked into. Spheres that cut the receiver's tangent
//! plane follow the rules of [Guerrero2007, 4.2].

pub mod arrays;
mod bake;
mod kernel;
mod prepare;
mod settings;
mod shade;

use crate::shared::{blockers::Blockers, by_mesh::distinct, divided_light::DividedLight};
use bake::{
    boxes::{SolidBox, solid_box},
    directions::{DirectionSets, Drawing},
    lobe_light::LobeLight,
    own::{OwnMesh, own_meshes},
};
use halfshade_scene::{Frame, Progress, Scene};
use halfshade_strategy::{Baked, Effect, Effects, Footprint, Info, Params, Prepared, Strategy, StrategyError};
use kernel::{lamp::Spiral, lobe::LobeSpiral};
use prepare::frame::FrameData;
use settings::{Own, PRESETS, STAGES, Settings};
use shade::{GlossTables, Shader};
use std::sync::Arc;

/// The strategy.
#[derive(Debug, Clone, Copy, Default)]
pub struct Mask;

/// Least width of an edge, in radii of a direction's cell: nothing is infinite.
const LEAST_EDGE: f32 = 1e-4;

/// Fewest directions into a lamp.
const FEWEST_PER_LAMP: usize = 16;

/// Tables of the scene, and data of the last frame.
#[derive(Debug)]
pub struct BakedScene {
    settings: Settings,
    drawing: Drawing,
    light: DividedLight,
    sets: DirectionSets,
    spiral: Spiral,
    /// Where anything is glossy.
    gloss: Option<GlossTables>,
    own: Vec<Option<Arc<OwnMesh>>>,
    boxes: Vec<Option<SolidBox>>,
    blockers: Blockers,
    frame: FrameData,
    /// How often the light has become another one.
    light_changes: u32,
}

impl Strategy for Mask {
    fn info(&self) -> Info {
        Info {
            name: "mask",
            summary: "a few directions drawn from the light, closed by every sphere's cap; no harmonics",
            source: "[Debevec2005]",
            parameters: Settings::parameters(),
            presets: PRESETS,
            stages: STAGES,
            effects: Effects::of(&Effect::DIRECT).with(Effect::GlossyReflectance),
        }
    }

    fn bake(&self, scene: &Scene, params: &Params, progress: &dyn Progress) -> Result<Box<dyn Baked>, StrategyError> {
        Ok(Box::new(Self::bake_scene(scene, params, progress)))
    }
}

impl Mask {
    /// [`Strategy::bake`], for who reads the arrays of its frames.
    pub fn bake_scene(scene: &Scene, params: &Params, progress: &dyn Progress) -> BakedScene {
        BakedScene::new(scene, params, progress)
    }
}

impl BakedScene {
    fn new(scene: &Scene, params: &Params, progress: &dyn Progress) -> Self {
        let settings = Settings::read(params);
        let edge = settings.edge.max(LEAST_EDGE);
        let drawing = Drawing { count: settings.directions, normals: settings.normals, edge };
        let light = DividedLight::new(&scene.environment.base, settings.environment_lamps);
        let own = match settings.own {
            Own::Baked => own_meshes(scene, settings.own_cells, progress),
            Own::Spheres => Vec::new(),
        };
        Self {
            sets: DirectionSets::new(&light.rest.base, &drawing),
            drawing,
            spiral: Spiral::new(settings.directions),
            gloss: scene.is_glossy().then(|| GlossTables {
                spiral: LobeSpiral::new((settings.directions / 2).next_multiple_of(16)),
                light: LobeLight::new(&light.rest.base),
            }),
            light,
            own,
            boxes: scene.objects.iter().map(solid_box).collect(),
            blockers: Blockers::new(scene),
            settings,
            frame: FrameData::default(),
            light_changes: 0,
        }
    }

    /// Brings everything up to a frame.
    fn prepare_frame(&mut self, frame: &Frame<'_>) -> Result<(), StrategyError> {
        if frame.scene.objects.len() != self.blockers.object_count() {
            return Err(StrategyError::Failed("the frame is of another scene than was baked".into()));
        }
        if self.light.set(&frame.scene.environment.base) {
            self.sets = DirectionSets::new(&self.light.rest.base, &self.drawing);
            if let Some(gloss) = &mut self.gloss {
                gloss.light = LobeLight::new(&self.light.rest.base);
            }
            self.light_changes += 1;
        }
        self.frame = FrameData::new(frame, &self.blockers, &self.boxes, &self.light);
        let count = self.per_lamp(self.frame.lamps.len());
        if self.spiral.count != count {
            self.spiral = Spiral::new(count);
        }
        Ok(())
    }

    /// Directions into each of so many lamps.
    fn per_lamp(&self, lamps: usize) -> usize {
        (self.settings.directions / lamps.max(1)).max(FEWEST_PER_LAMP)
    }
}

impl Baked for BakedScene {
    fn footprint(&self) -> Footprint {
        let own = distinct(self.own.iter().flatten());
        Footprint {
            parts: vec![
                ("directions", self.sets.bytes()),
                ("irradiance over normals", self.light.bytes()),
                ("light over lobes", self.gloss.as_ref().map_or(0, |gloss| gloss.light.bytes())),
                ("own visibility", own.map(|own| size_of_val(own.cells.words.as_slice())).sum()),
                ("spheres, boxes and lamps", self.frame.bytes()),
                ("bindings", self.blockers.bytes()),
            ],
        }
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
        self.prepare_frame(frame)?;
        Ok(Box::new(Shader {
            frame: &self.frame,
            sets: &self.sets,
            spiral: &self.spiral,
            own: &self.own,
            rest: &self.light.rest,
            gloss: self.gloss.as_ref(),
            rule: self.settings.rule.into(),
            edge: self.drawing.edge,
        }))
    }
}
