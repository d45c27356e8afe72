//! Static precomputed radiance transfer \[Sloan2002\]\[Dachsbacher2017\]: what becomes of light from infinitely far until it leaves a
//! vertex is a vector, baked once; a frame multiplies it with the light's.
//!
//! ```text
//! L(x) = albedo(x) · Σ_i T_i(x) l_i        l_i = ∫ L_env(ω) y_i(ω) dω
//!
//! unshadowed:     T_i(x) = 1/π ∫ y_i(ω) max(n·ω, 0) dω
//! shadowed:       T_i(x) = 1/π ∫ V(x, ω) y_i(ω) max(n·ω, 0) dω
//! interreflected: T_i^b(x) = shadowed + 1/π ∫ (1 - V(x, ω)) albedo(y) T_i^{b-1}(y) max(n·ω, 0) dω
//! ```
//!
//! with y what is met along ω. 1/π is in T; the albedo of the receiver is outside, so that textures are sharp; that of other
//! surfaces is inside, which makes three vectors of one where any of them is coloured. b are the bounces that the scene asks for.
//!
//! **Space.** Vectors are of the world as it is at the first frame. Objects stand still against each other; the scene may move
//! and turn as a whole, and the light may turn and change: per frame the light's vector is turned the other way. Anything else
//! is unsupported, and so are local lights, whose light isn't the same everywhere.
//!
//! **Gloss.** A vertex of a glossy object has a matrix beside its vector, from light to what arrives of it (`bake/gloss.rs`):
//!
//! ```text
//! L_gloss(x) = scale · b^T M(x) l        M_ij = ∫ h(n·ω) V(x, ω) y_i(ω) y_j(ω) dω, and what others send
//! ```
//!
//! with b the lobe's power about its axis, fitted over the hemisphere in the weight h (`halfshade_sh::hemisphere`): what is below the
//! horizon doesn't matter, and leaves room to be better above it. n⁴ products per receiver and lobe, since the eye
//! and the light may change with every frame; 4 n⁴ bytes per vertex and channel, at most 4 GiB, else refused. Light of n bands on
//! open surfaces is exact up to the fit's ridge (about 0.1 % of its mean), where something is hidden it errs by what n
//! bands miss of the lobe: see [`sharpness`] for how sharp it may be. Light that glossy surfaces send to others is left out: what is met
//! along a ray reflects as if it were diffuse.
//!
//! **Ringing.** A window (`window`) may lessen what few bands overshoot. On light, `nonnegative` leaves no direction below 0, and so no
//! vertex, whatever hides it; channels have the same window, since others would change hues. On transfer, it has a window of its own
//! for each vector, and says nothing of light that is itself negative; matrices have none. `light=zh3` keeps of three bands what
//! is symmetric about the axis of the second \[Roughton2024\]; it costs as much as three bands here, and shows what five
//! numbers a channel hold.
//!
//! **Phases.** `bake`: rays from every vertex of every object against all triangles (`bake/mod.rs`), in chunks that are cached as they
//! are finished. `prepare`: one vector per channel. `shade`: a dot product per channel (`kernel/dot.rs`) which reads n² numbers
//! per vertex, near the speed of memory; pixels interpolate the vectors of the three vertices around them.
//!
//! **Error.** Of light limited to n bands the sum is exact, whatever the bands of V: `Σ T_i l_i = ∫ L T dω` needs one of the two
//! limited. Errors are those of K rays per vertex (`bake/hemisphere.rs`: none where nothing is hidden, or everything; else about
//! that of the boundary between both), of interpolation between vertices, and of light beyond n bands, which rings: radiance
//! may fall below 0 beside a sun.
//!
//! **Where nothing is baked.** A receiver on no triangle is lit as if nothing hid any light. The backs of surfaces have
//! vectors of their own, except for the insides of solids, which are dark.

pub mod arrays;
mod bake;
pub mod gloss_arrays;
mod kernel;
mod prepare;
mod settings;
mod shade;
pub mod sharpness;

use bake::{arrangement::Arrangement, bake, table::Transfer};
use halfshade_scene::{Cache, EyeLobes, Frame, Progress, Scene};
use halfshade_strategy::{Baked, Detail, Effect, Effects, Footprint, Info, Params, Prepared, Strategy, StrategyError};
use prepare::{light::FrameLight, shaped::LightShape};
use settings::Settings;
use shade::{
    Shader,
    gloss::{GlossShader, LobeFits},
};

/// The strategy.
#[derive(Debug, Clone, Default)]
pub struct Prt {
    cache: Cache,
}

/// Transfer of a scene, and the light of the last frame.
#[derive(Debug)]
pub struct BakedScene {
    transfer: Transfer,
    arrangement: Arrangement,
    light: FrameLight,
    /// Nothing where no object is glossy.
    lobes: Option<LobeFits>,
    /// The largest exponent of gloss.
    sharpest: Option<f64>,
}

impl Prt {
    /// Keeps vectors in `cache` as they are finished. The default keeps nothing.
    pub const fn new(cache: Cache) -> Self {
        Self { cache }
    }

    /// [`Strategy::bake`], for who reads the arrays of its frames.
    ///
    /// # Errors
    /// Why transfer can't be baked for this scene.
    pub fn bake_scene(
        &self,
        scene: &Scene,
        params: &Params,
        progress: &dyn Progress,
    ) -> Result<BakedScene, StrategyError> {
        let settings = Settings::of(params);
        let arrangement = Arrangement::of(scene)?;
        sharpness::note(scene, settings.bands, progress);
        Ok(BakedScene {
            transfer: bake(scene, &settings, &self.cache, progress)?,
            sharpest: sharpness::sharpest(scene).map(|(_, exponent)| exponent),
            lobes: scene.is_glossy().then(|| LobeFits::new(settings.bands)),
            arrangement,
            light: FrameLight::new(LightShape::new(&settings), settings.bands, &scene.environment),
        })
    }
}

impl Strategy for Prt {
    fn info(&self) -> Info {
        Info {
            name: "prt",
            summary: "precomputed radiance transfer: a vector per vertex of a scene that stands still, times the light's, a matrix where it is glossy",
            source: "[Sloan2002][Dachsbacher2017][Sloan2017][Roughton2024]",
            parameters: Settings::parameters(),
            presets: &[],
            effects: Effects::of(&[
                Effect::EnvironmentLight,
                Effect::ColouredLight,
                Effect::GlossyReflectance,
                Effect::Interreflection,
                Effect::Motion,
            ]),
        }
    }

    fn needs_spheres(&self) -> bool {
        false
    }

    fn bake(&self, scene: &Scene, params: &Params, progress: &dyn Progress) -> Result<Box<dyn Baked>, StrategyError> {
        Ok(Box::new(self.bake_scene(scene, params, progress)?))
    }
}

impl BakedScene {
    /// Brings the light up to a frame.
    fn prepare_frame(&mut self, frame: &Frame<'_>) -> Result<(), StrategyError> {
        self.arrangement.check(&frame.world_from_object, &frame.scene.objects, frame.index)?;
        self.light.set(frame, &self.arrangement);
        Ok(())
    }
}

impl Baked for BakedScene {
    fn footprint(&self) -> Footprint {
        let mut parts = vec![("transfer vectors", self.transfer.bytes()), ("light", self.light.bytes())];
        if let Some((table, fits)) = self.transfer.gloss.as_ref().zip(self.lobes.as_ref()) {
            parts.push(("transfer matrices", table.bytes() + fits.bytes()));
        }
        Footprint { parts }
    }

    fn details(&self) -> Vec<Detail> {
        let rows = (self.transfer.rows().len() / self.transfer.width()) as f64;
        let detail = |name: &str, value: f64| Detail { name: name.into(), values: vec![value] };
        let mut details = vec![
            detail("vertices, and vertices seen from behind, that have vectors", rows),
            detail("vectors of each", self.transfer.channels as f64),
            detail("bounces of light in them", self.transfer.bounces as f64),
        ];
        if let Some(exponent) = self.sharpest {
            details.push(Detail {
                name: "largest exponent of gloss, and the largest that so many bands show".into(),
                values: vec![exponent, sharpness::shown_exponent(self.transfer.bands)],
            });
        }
        details
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
        self.prepare_frame(frame)?;
        let gloss = (self.transfer.gloss.as_ref().zip(self.lobes.as_ref())).zip(EyeLobes::new(frame));
        let gloss = gloss.map(|((table, fits), lobes)| GlossShader { table, fits, light: &self.light, lobes });
        Ok(Box::new(Shader { transfer: &self.transfer, light: &self.light, gloss }))
    }
}
