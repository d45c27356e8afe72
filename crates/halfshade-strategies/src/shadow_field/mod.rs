//! Adaptive shadow fields \[Tamura2006\]: what an object hides is precomputed at points around it, and shading multiplies.
//!
//! Around every object lie concentric shells (section 6: radii 0.2 R (1 + c), R that of the object's bounding sphere). At
//! points on them, by latitude and longitude, an *object occlusion field* holds the visibility that the object leaves, as a
//! vector of spherical harmonics (`occlusion`). Each shell is thinned out as far as interpolation allows (`adaptive`,
//! equation 1), and coefficients are stored in 8 bits (`field`). What an object hides from itself is precomputed at its
//! vertices (`own`).
//!
//! ```text
//! U = O_self * ρ̂            for all others, from near to far:    an object: U = O_j * U      a light: L += S_j · U
//! L = albedo (S_d · U + ..)
//! ```
//!
//! with * the SH product, ρ̂ the clamped cosine over π and S_d the distant light (figure 3). A local light's *source
//! radiance field* is known in closed form: a sphere of uniform radiance looks like a cap from everywhere.
//!
//! Fields stay in the space of their object; what is read from them is turned into the space of the light, so that objects
//! may move, turn and change their size. All meshes occlude, those of objects without spheres too.
//!
//! **Limits.** Diffuse receivers, spherical harmonics only. Distant light is as sharp as the bands. Within the first
//! shell a receiver lies between that shell and the centre; past the last one, what is blocked shrinks with the solid angle.
//! A receiver that is no vertex takes what the nearest vertex of its object hides from itself; with `own=projected`
//! nothing, because there the normal is in it. Meshes that deform can't be modelled.

mod adaptive;
mod field;
mod occlusion;
mod own;
mod shade;

use field::{Field, Projected, Storage};
use glam::{DMat3, DQuat, DVec3, Vec3};
use halfshade_scene::{
    Cache, Environment, Frame, Mesh, Progress, RadianceMut, Receivers, Scene, SceneError, SphereLight,
    cache::{CacheKey, CacheSource},
    light::DistantLight,
};
use halfshade_sh::{
    basis,
    blocker_table::{BlockerTable, Quantity},
    dispatch_bands, lat_long,
    rotation::ShRotation,
    zonal,
};
use halfshade_strategy::{
    Baked, Effect, Effects, Footprint, Info, Parameter, ParameterKind, Params, Strategy, StrategyError,
};
use own::{Kind, OwnOcclusion};
use std::sync::{Arc, OnceLock};

/// The strategy.
#[derive(Debug, Clone, Default)]
pub struct ShadowField {
    cache: Cache,
}

impl ShadowField {
    /// Keeps what takes rays in `cache`: fields as projected, before they are thinned out. The default keeps nothing.
    pub const fn new(cache: Cache) -> Self {
        Self { cache }
    }
}

impl Strategy for ShadowField {
    fn info(&self) -> Info {
        let parameter = |name, summary, kind| Parameter { name, summary, kind };
        Info {
            name: "shadow-field",
            summary: "visibility precomputed on shells around every object, combined by SH triple products",
            source: "[Tamura2006]",
            parameters: vec![
                parameter("bands", "bands of visibility", ParameterKind::Integer { default: 4, min: 1, max: 8 }),
                parameter("shells", "concentric shells", ParameterKind::Integer { default: 32, min: 1, max: 128 }),
                parameter(
                    "resolution",
                    "sample points per shell, in longitude as in latitude; rounded up to a power of two",
                    ParameterKind::Integer { default: 64, min: 1, max: 256 },
                ),
                parameter(
                    "map",
                    "directions per sample point, in longitude as in latitude",
                    ParameterKind::Integer { default: 64, min: 8, max: 256 },
                ),
                parameter(
                    "sampling",
                    "shells as dense as the threshold asks for, or all at the full resolution",
                    ParameterKind::Choice { values: &["adaptive", "fixed"], default: "adaptive" },
                ),
                parameter(
                    "threshold",
                    "adaptive: mean absolute error of visibility, over all directions, that a sample point may have",
                    ParameterKind::Float { default: 0.010, min: 0.0, max: 1.0 },
                ),
                parameter(
                    "storage",
                    "how coefficients are stored",
                    ParameterKind::Choice { values: &["u8", "f16", "f32"], default: "u8" },
                ),
                parameter(
                    "own",
                    "an object's own occlusion times the cosine: projected as they are, or as an SH product",
                    ParameterKind::Choice { values: &["projected", "product"], default: "product" },
                ),
            ],
            effects: Effects::of(&[
                Effect::EnvironmentLight,
                Effect::LocalLights,
                Effect::ColouredLight,
                Effect::Motion,
            ]),
        }
    }

    fn bake(&self, scene: &Scene, params: &Params, progress: &dyn Progress) -> Result<Box<dyn Baked>, StrategyError> {
        let bands = params.integer("bands") as usize;
        let table = BlockerTable::build(bands, Quantity::BlockerMinusOne)
            .ok_or_else(|| StrategyError::Failed(format!("{bands} bands: there are kernels for 1 to 8")))?;
        let shells = params.integer("shells") as usize;
        let resolution = (params.integer("resolution") as usize).next_power_of_two();
        let threshold = (params.choice("sampling") == "adaptive").then(|| params.float("threshold"));
        let storage = match params.choice("storage") {
            "f32" => Storage::F32,
            "f16" => Storage::F16,
            _ => Storage::U8,
        };
        let kind = if params.choice("own") == "projected" { Kind::Transfer } else { Kind::Visibility };
        let directions = occlusion::Directions::new(bands, params.integer("map") as usize);
        let mut known: Vec<(Arc<Mesh>, Arc<Entity>)> = Vec::new();
        let mut entities = Vec::new();
        progress.start("shadow fields", (scene.objects.len() * shells) as u64);
        for object in &scene.objects {
            if let Some((_, entity)) = known.iter().find(|(mesh, _)| Arc::ptr_eq(mesh, &object.mesh)) {
                progress.advance(shells as u64);
                entities.push(entity.clone());
                continue;
            }
            let mesh = &object.mesh;
            let rays = OnceLock::new();
            let rays = || rays.get_or_init(|| occlusion::rays(mesh));
            let key = |kind| {
                let geometry = (&mesh.positions, &mesh.triangles, &mesh.normals);
                CacheKey::new(kind, VERSION).value(&geometry).value(&(bands, params.integer("map")))
            };
            let failed = |error: SceneError| StrategyError::Failed(error.to_string());
            let field = self.cache.get_or_compute(&key("shadow-field").value(&(shells, resolution)), || {
                Ok(Projected::new(mesh, rays(), &directions, (shells, resolution), progress))
            });
            let (projected, outcome) = field.map_err(failed)?;
            if outcome.source == CacheSource::Read {
                progress.advance(shells as u64);
            }
            let own = self.cache.get_or_compute(&key("own-occlusion").value(&(kind == Kind::Transfer)), || {
                Ok(OwnOcclusion::vectors(mesh, rays(), &directions, kind))
            });
            let entity = Arc::new(Entity {
                field: projected.map(|projected| Field::new(&projected, bands, threshold, storage)),
                own: OwnOcclusion::new(mesh, kind, directions.count(), own.map_err(failed)?.0),
            });
            known.push((mesh.clone(), entity.clone()));
            entities.push(entity);
        }
        let cosine = zonal::reflectance(bands).into_iter().map(|value| value as f32).collect();
        let mut first_vertices = Vec::new();
        let mut count = 0;
        for object in &scene.objects {
            first_vertices.push(count);
            count += object.mesh.positions.len() as u32;
        }
        Ok(Box::new(Prepared {
            bands,
            table,
            cosine,
            entities,
            first_vertices,
            light: Vec::new(),
            known_light: None,
            places: Vec::new(),
            lights: Vec::new(),
            orders: Vec::new(),
            light_from_world: DQuat::IDENTITY,
            center: DVec3::ZERO,
        }))
    }
}

/// Of what is cached: raised whenever it would come out differently.
const VERSION: u32 = 1;

/// What is known of one mesh.
#[derive(Debug)]
struct Entity {
    field: Option<Field>,
    own: OwnOcclusion,
}

/// Where an object is in this frame.
#[derive(Debug, Clone)]
struct Place {
    /// In light space, about the frame's centre.
    field_center: [f32; 3],
    /// Object space from light space, row by row, without the scale.
    object_from_light: [[f32; 3]; 3],
    inverse_scale: f32,
    /// Blocks of the SH rotation from object space into light space, band by band, row by row.
    rotation: Vec<f32>,
}

/// A local light in light space.
#[derive(Debug, Clone, Copy)]
struct LocalLight {
    center: [f32; 3],
    radius: f32,
    radiance: [f32; 3],
}

/// Fields of the scene, light and places of the frame.
#[derive(Debug)]
struct Prepared {
    bands: usize,
    table: BlockerTable,
    /// Clamped cosine over π by band, times the rotation's factor: ρ̂.
    cosine: Vec<f32>,
    /// Per object.
    entities: Vec<Arc<Entity>>,
    /// Number of each object's first vertex among all.
    first_vertices: Vec<u32>,
    /// S_d: coefficient by coefficient, red, green, blue; and what it is of.
    light: Vec<[f32; 3]>,
    known_light: Option<Environment>,
    places: Vec<Place>,
    lights: Vec<LocalLight>,
    /// Per object and part of it the others, from near to far.
    orders: Vec<Vec<Vec<shade::Entity>>>,
    light_from_world: DQuat,
    center: DVec3,
}

/// Vertices of one part of an object. Each part has its order of the others, so that large objects are split.
const PART: usize = 1024;

impl Prepared {
    /// The part that a receiver of `object` belongs to.
    fn part_of(&self, object: usize, index: u32) -> usize {
        let parts = self.entities.get(object).map_or(0, |entity| entity.own.part_centers.len());
        let vertex = self.first_vertices.get(object).and_then(|first| index.checked_sub(*first));
        vertex.map_or(0, |vertex| vertex as usize / PART).min(parts.saturating_sub(1))
    }

    fn set_light(&mut self, environment: &Environment) {
        let is_known = |known: &Environment| known.sun == environment.sun && known.base.is_same_as(&environment.base);
        if self.known_light.as_ref().is_some_and(is_known) {
            return;
        }
        let count = self.bands * self.bands;
        let mut light: [Vec<f64>; 3] = match &environment.base {
            DistantLight::Constant(radiance) => {
                let one = basis::one(self.bands);
                radiance.to_array().map(|channel| one.iter().map(|value| f64::from(channel) * value).collect())
            }
            DistantLight::Map(map) => {
                let texels: Vec<[f32; 3]> = map.texels().iter().map(|texel| texel.to_array()).collect();
                lat_long::project(self.bands, map.width(), map.height(), &texels)
                    .unwrap_or_else(|| std::array::from_fn(|_| vec![0.0; count]))
            }
        };
        if let Some(sun) = environment.sun {
            let versine = 2.0 * (0.5 * f64::from(sun.angular_radius)).sin().powi(2);
            let axis = sun.direction.as_dvec3().normalize().to_array();
            let cap = zonal::rotate_to_axis(&zonal::cap_from_versine(self.bands, versine), axis);
            for (channel, radiance) in light.iter_mut().zip(sun.radiance.to_array()) {
                channel.iter_mut().zip(&cap).for_each(|(sum, value)| *sum += f64::from(radiance) * value);
            }
        }
        self.light = (0..count).map(|i| std::array::from_fn(|channel| light[channel][i] as f32)).collect();
        self.known_light = Some(environment.clone());
    }

    /// For each part of an object all others, by their distance from the part's middle.
    fn order_for(&self, frame: &Frame<'_>, object: usize) -> Vec<Vec<shade::Entity>> {
        use shade::Entity::{Light, Object};
        let others = (0..self.places.len()).filter(|&other| other != object).map(Object);
        let others: Vec<_> = others.chain((0..self.lights.len()).map(Light)).collect();
        let for_part = |center: &Vec3| {
            let middle = Vec3::from(self.point(frame.world_from_object[object].transform_point(*center).as_dvec3()));
            let distance = |entity: &shade::Entity| match *entity {
                Object(other) => middle.distance_squared(self.places[other].field_center.into()),
                Light(number) => middle.distance_squared(self.lights[number].center.into()),
            };
            let mut order = others.clone();
            order.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
            order
        };
        self.entities[object].own.part_centers.iter().map(for_part).collect()
    }

    /// A point of the world in light space.
    fn point(&self, point: DVec3) -> [f32; 3] {
        (self.light_from_world * (point - self.center)).as_vec3().to_array()
    }
}

impl Baked for Prepared {
    fn footprint(&self) -> Footprint {
        let mut counted: Vec<*const Entity> = Vec::new();
        let (mut fields, mut own) = (0, 0);
        for entity in &self.entities {
            if !counted.contains(&Arc::as_ptr(entity)) {
                counted.push(Arc::as_ptr(entity));
                fields += entity.field.as_ref().map_or(0, Field::bytes);
                own += entity.own.bytes();
            }
        }
        Footprint { parts: vec![("occlusion fields", fields), ("own occlusion", own)] }
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<(), StrategyError> {
        if frame.scene.objects.len() != self.entities.len() {
            return Err(StrategyError::Failed("the frame is of another scene than fields were baked for".into()));
        }
        self.set_light(&frame.scene.environment);
        self.light_from_world = frame.world_from_environment.as_dquat().normalize().conjugate();
        let middles: Vec<DVec3> = (frame.world_from_object.iter().zip(&self.entities))
            .map(|(pose, entity)| {
                let middle = entity.field.as_ref().map_or(Vec3::ZERO, |field| field.center);
                pose.rotation.as_dquat().normalize() * (f64::from(pose.scale) * middle.as_dvec3())
                    + pose.translation.as_dvec3()
            })
            .collect();
        self.center = middles.iter().sum::<DVec3>() / middles.len().max(1) as f64;
        self.places = (frame.world_from_object.iter().zip(&middles))
            .map(|(pose, &middle)| {
                let light_from_object = self.light_from_world * pose.rotation.as_dquat().normalize();
                let columns = DMat3::from_quat(light_from_object).to_cols_array_2d();
                let rows = DMat3::from_quat(light_from_object).transpose().to_cols_array_2d();
                let rotation = ShRotation::new(self.bands, &rows);
                Place {
                    field_center: self.point(middle),
                    // The columns of a rotation are the rows of its inverse.
                    object_from_light: columns.map(|column| column.map(|value| value as f32)),
                    inverse_scale: pose.scale.recip(),
                    rotation: (0..self.bands)
                        .flat_map(|l| {
                            // Column by column of the transpose: row by row.
                            rotation.block(l).transpose().iter().map(|&value| value as f32).collect::<Vec<_>>()
                        })
                        .collect(),
                }
            })
            .collect();
        self.lights = (frame.lights.iter())
            .map(|light: &SphereLight| LocalLight {
                center: self.point(light.center.as_dvec3()),
                radius: light.radius,
                radiance: light.radiance.to_array(),
            })
            .collect();
        self.orders = (0..self.entities.len()).map(|object| self.order_for(frame, object)).collect();
        Ok(())
    }

    fn shade(&self, receivers: Receivers<'_>, out: RadianceMut<'_>) {
        // `bake` made sure that there is a kernel for this number of bands.
        let _: Option<()> = dispatch_bands!(self.bands, N => shade::shade::<N>(self, receivers, out));
    }
}
