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
//! and turn as a whole, and the light may turn and change: per frame the light's vector is turned the other way. Objects that move
//! against others or deform are refused, or take their light from an irradiance volume among the others (`bake/volume`): their
//! shadows are missing then.
//!
//! **Local lights** are seen elsewhere from every receiver, which makes as many vectors of them as there are receivers
//! (`kernel/lamps.rs`), `l(x)` in place of `l`. \[Dachsbacher2017\] has several vectors, of several directions of the light, and picks
//! one or interpolates between them; \[Sloan2002\] samples the light at a few points. `lamp-steps` does this over a grid of
//! points, vector by vector in linear weights. Transfer knows nothing of distances: what stands behind a local light hides it
//! as if it stood before it, and light that others reflect is reckoned as if the local light were seen from them as from the receiver.
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
//! **Translucent objects.** What enters a vertex of a translucent object is a vector like that of a diffuse one, with Fresnel's
//! transmittance beside the cosine; what leaves another is the sum of those in the weights of a dipole (`bake/subsurface`), a vector
//! again, so that frames cost what they do without. From local lights it is reckoned as if they shone where light enters as they do where
//! it leaves.
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
//! **Compression** \[Sloan2003\]. Rows may be stored as clusters of principal components (`bake/compress`): light times the
//! vectors of all clusters is part of `prepare` then, and a vertex is a few weights (`kernel/decode.rs`). The error is that of what
//! is left out, whatever the light.
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

use bake::{arrangement::Arrangement, bake, compress::Clusters, table::Transfer, volume::Volume};
use halfshade_scene::{Cache, EyeLobes, Frame, Pose, Progress, Scene};
use halfshade_strategy::{Baked, Detail, Effect, Effects, Footprint, Info, Params, Prepared, Strategy, StrategyError};
use kernel::decode::Product;
use prepare::{lamps::FrameLamps, light::FrameLight, products, shaped::LightShape, turns};
use settings::{STAGES, Settings};
use shade::{
    Shader,
    clusters::ClusterShader,
    gloss::{GlossOver, GlossShader, LobeFits},
    lamps::LampsOver,
    volume::VolumeShader,
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
    /// Local lights, if there are any.
    lamps: Option<FrameLamps>,
    /// Light times the vectors of clusters, if the transfer is compressed.
    products: Vec<Product>,
    /// Light for objects that move, if any do.
    volume: Option<Volume>,
    /// Light that arrives at its points.
    incoming: Vec<Product>,
    baked_from_world: Pose,
    /// Rotations of objects that move.
    turns: Vec<Vec<f32>>,
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
        let arrangement = Arrangement::of(scene, settings.moving)?;
        if arrangement.has_movers() && scene.is_glossy() {
            let reason =
                "a volume of light knows what arrives at points, not how gloss sends it on; mask or ray-traced do";
            return Err(StrategyError::Unsupported(reason.into()));
        }
        let enters = |number: &usize| scene.objects[*number].material.subsurface.is_some();
        if let Some(number) = (0..scene.objects.len()).filter(enters).find(|&number| arrangement.moves(number)) {
            let name = &scene.objects[number].name;
            let reason = format!(
                "light below the surface of `{name}` is baked where that stands, but it moves or deforms; hold the scene still at one frame"
            );
            return Err(StrategyError::Unsupported(reason));
        }
        let lamps = FrameLamps::of(scene, &arrangement, &settings)?;
        sharpness::note(scene, settings.bands, progress);
        let bake::Baked { transfer, volume } = bake(scene, &arrangement, &settings, &self.cache, progress)?;
        Ok(BakedScene {
            transfer,
            arrangement,
            light: FrameLight::new(LightShape::new(&settings), settings.bands, &scene.environment),
            lamps,
            products: Vec::new(),
            volume,
            incoming: Vec::new(),
            baked_from_world: Pose::IDENTITY,
            turns: Vec::new(),
            lobes: scene.is_glossy().then(|| LobeFits::new(settings.bands)),
            sharpest: sharpness::sharpest(scene).map(|(_, exponent)| exponent),
        })
    }
}

impl Strategy for Prt {
    fn info(&self) -> Info {
        Info {
            name: "prt",
            summary: "precomputed radiance transfer: a vector per vertex of a scene that stands still, times the light's, a matrix where it is glossy",
            source: "[Sloan2002][Dachsbacher2017][Sloan2017][Roughton2024][Jensen2001]",
            parameters: Settings::parameters(),
            presets: &[],
            stages: STAGES,
            effects: Effects::of(&[
                Effect::EnvironmentLight,
                Effect::LocalLights,
                Effect::ColouredLight,
                Effect::GlossyReflectance,
                Effect::SubsurfaceScattering,
                Effect::Interreflection,
                Effect::Motion,
                Effect::Deformation,
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
        if let Some(clusters) = &self.transfer.clusters {
            let (vectors, channels) = (&clusters.vectors, self.transfer.channels);
            products::set(&self.light, vectors, channels, self.product_count(), &mut self.products);
        }
        self.baked_from_world = self.arrangement.pose_from_world(&frame.world_from_object);
        if let Some(lamps) = &mut self.lamps {
            lamps.set(frame, &self.baked_from_world);
        }
        if let Some(volume) = &self.volume {
            match &self.lamps {
                Some(lamps) => products::set_by_point(&self.light, lamps, volume, &mut self.incoming),
                None => products::set(&self.light, &volume.vectors, volume.channels, volume.rows(), &mut self.incoming),
            }
            self.turns = turns::of(frame, volume, &self.baked_from_world);
        }
        Ok(())
    }
}

impl BakedScene {
    /// Whether objects move against others, and take light from a volume.
    pub fn has_movers(&self) -> bool {
        self.arrangement.has_movers()
    }

    /// Means and axes of all clusters.
    fn product_count(&self) -> usize {
        let count = |clusters: &Clusters| clusters.count(self.transfer.width()) * (clusters.components + 1);
        self.transfer.clusters.as_ref().map_or(0, count)
    }
}

impl Baked for BakedScene {
    fn footprint(&self) -> Footprint {
        let mut parts = self.transfer.parts();
        parts.push(("light", self.light.bytes() + size_of_val(self.products.as_slice())));
        if let Some(lamps) = &self.lamps {
            parts.push(("local lights", lamps.bytes()));
        }
        if let Some(volume) = &self.volume {
            parts.push(("volume of light", volume.bytes() + size_of_val(self.incoming.as_slice())));
        }
        if let Some((table, fits)) = self.transfer.gloss.as_ref().zip(self.lobes.as_ref()) {
            parts.push(("transfer matrices", table.bytes() + fits.bytes()));
        }
        Footprint { parts }
    }

    fn details(&self) -> Vec<Detail> {
        let rows = self.transfer.row_count() as f64;
        let detail = |name: &str, value: f64| Detail { name: name.into(), values: vec![value] };
        let mut details = vec![
            detail("vertices, and vertices seen from behind, that have vectors", rows),
            detail("vectors of each", self.transfer.channels as f64),
            detail("bounces of light in them", self.transfer.bounces as f64),
        ];
        if let Some(clusters) = &self.transfer.clusters {
            let width = self.transfer.width();
            details.extend([
                detail("clusters", clusters.count(width) as f64),
                detail("principal components of each", clusters.components as f64),
                detail("bytes of the mean and axes of each", (4 * (clusters.components + 1) * width) as f64),
            ]);
        }
        if let Some(points) = self.lamps.as_ref().and_then(FrameLamps::point_count) {
            details.push(detail("points at which local lights are known", points as f64));
        }
        if let Some(volume) = &self.volume {
            let steps = volume.grid.steps().map(|steps| steps as f64);
            details.push(Detail { name: "steps of the volume of light along x, y, z".into(), values: steps.to_vec() });
            details.push(detail("points of it within solids", volume.inside as f64));
        }
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
        let Self { transfer, light, lamps, products, .. } = self;
        let lamps = lamps.as_ref();
        let mut rest: Box<dyn Prepared + '_> = match &transfer.clusters {
            Some(clusters) => Box::new(ClusterShader { transfer, table: clusters.table(), light, products }),
            None => Box::new(Shader { transfer, light }),
        };
        if let Some(lamps) = lamps {
            rest = Box::new(LampsOver { rest, transfer, light, lamps });
        }
        if let Some(volume) = &self.volume {
            return Ok(Box::new(VolumeShader {
                rest,
                grid: volume.grid,
                incoming: &self.incoming,
                moves: self.arrangement.movers(),
                baked_from_world: self.baked_from_world,
                own: &volume.own,
                turns: &self.turns,
            }));
        }
        let gloss = (transfer.gloss.as_ref().zip(self.lobes.as_ref())).zip(EyeLobes::new(frame));
        Ok(match gloss {
            Some(((table, fits), lobes)) => {
                Box::new(GlossOver { rest, transfer, gloss: GlossShader { table, fits, light, lamps, lobes } })
            }
            None => rest,
        })
    }
}
