//! `ray-traced` on the device: shadow rays through hierarchies that stay there, one per mesh, under one over the objects.

use crate::{
    GpuError,
    hierarchy::{Hierarchy, MOST_IN_LEAF, Node, STACK, around},
    kernels::RAY_TRACED,
    receivers::{KernelSpace, affine_rows},
    runner::{Bench, Runner, Uploaded},
};
use bytemuck::{Pod, Zeroable};
use glam::{DMat3, DVec3, Vec3};
use halfshade_scene::{Frame, Mesh, Pose, Progress, Receivers, Scene, light::DistantLight};
use halfshade_strategies::{
    RayTraced,
    ray_traced::arrays::{LightSampler, SampleArrays},
};
use halfshade_strategy::{Baked, Effect, Effects, Footprint, Info, Params, Prepared, Strategy, StrategyError};
use std::sync::Arc;

/// [`RayTraced`], whose rays are traced on the device.
#[derive(Debug)]
pub struct RayTracedOnGpu {
    bench: Bench,
}

/// Settings of a frame, as `ray_traced/frame.wgsl` reads them.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
pub(crate) struct FrameUniforms {
    pub(crate) environment: [[f32; 4]; 3],
    pub(crate) constant: [f32; 4],
    pub(crate) sun: [f32; 4],
    pub(crate) sun_radiance: [f32; 4],
    pub(crate) plane_steps: [u32; 4],
    pub(crate) space_steps: [u32; 4],
    pub(crate) space_last_step: [u32; 2],
    pub(crate) samples: u32,
    pub(crate) cosine_share: f32,
    pub(crate) base_power: f32,
    pub(crate) sun_power: f32,
    pub(crate) map_width: u32,
    pub(crate) map_height: u32,
    pub(crate) instances: u32,
    pub(crate) instance_count: u32,
    pub(crate) lights: u32,
    pub(crate) light_count: u32,
    pub(crate) texels: u32,
    pub(crate) aliases: u32,
    pub(crate) padding: [u32; 2],
}

/// Most samples of a dispatch.
const SAMPLES_AT_ONCE: u32 = 64;

/// Corners, each filled up to four numbers.
type DeviceTriangle = [[f32; 4]; 3];

/// The hierarchy of one mesh within the buffers.
#[derive(Debug, Clone, Copy)]
struct Placed {
    first_node: usize,
    depth: usize,
    /// Corners of its box; `None` if nothing of it can be met.
    bounds: Option<[Vec3; 2]>,
}

struct BakedOnGpu {
    runner: Runner,
    samples: SampleArrays,
    light: Option<LightSampler>,
    /// The light whose map is on the device, and the row at which its texels begin.
    map: Option<(DistantLight, usize)>,
    meshes: Meshes,
}

/// Hierarchies and triangles of all meshes, as they are on the device; before them room for the hierarchy over objects.
#[derive(Default)]
struct Meshes {
    nodes: Vec<Node>,
    triangles: Vec<DeviceTriangle>,
    /// Those of each object.
    of_object: Vec<Placed>,
    is_deformed: bool,
}

impl RayTracedOnGpu {
    pub(crate) fn new(bench: Bench) -> Self {
        Self { bench }
    }
}

impl Strategy for RayTracedOnGpu {
    fn info(&self) -> Info {
        // Gloss has no kernel yet.
        Info { effects: Effects::of(&Effect::DIRECT), ..RayTraced.info() }
    }

    fn needs_spheres(&self) -> bool {
        false
    }

    fn bake(&self, scene: &Scene, params: &Params, _: &dyn Progress) -> Result<Box<dyn Baked>, StrategyError> {
        if scene.objects.iter().any(|object| object.mesh.has_cutouts()) {
            let reason = "no kernels for graphics devices yet: holes by a mask; take device `cpu`";
            return Err(StrategyError::Unsupported(reason.into()));
        }
        let constants = [("SAMPLES_AT_ONCE", f64::from(SAMPLES_AT_ONCE))];
        let runner = Runner::new(&self.bench, &RAY_TRACED, None, &constants, size_of::<FrameUniforms>())?;
        let mut baked = BakedOnGpu {
            runner,
            samples: SampleArrays::new(params),
            light: None,
            map: None,
            meshes: Meshes::of(&scene.frame(0)),
        };
        baked.runner.write(1, &baked.meshes.nodes)?;
        baked.runner.write(2, &baked.meshes.triangles)?;
        let samples = baked.samples.samples;
        let parts: Vec<[u32; 4]> =
            (0..samples).step_by(SAMPLES_AT_ONCE as usize).map(|first| [first, 0, 0, 0]).collect();
        baked.runner.set_parts(&parts)?;
        Ok(Box::new(baked))
    }
}

impl Meshes {
    fn of(frame: &Frame<'_>) -> Self {
        let objects = &frame.scene.objects;
        let mut meshes = Self {
            nodes: vec![Node::zeroed(); room_for_objects(objects.len())],
            is_deformed: frame.deformed.iter().any(Option::is_some),
            ..Self::default()
        };
        let mut known: Vec<(&Arc<Mesh>, Placed)> = Vec::new();
        for (number, object) in objects.iter().enumerate() {
            let shared = known.iter().find(|(mesh, _)| object.skin.is_none() && Arc::ptr_eq(mesh, &object.mesh));
            let placed = match shared {
                Some((_, placed)) => *placed,
                None => {
                    let placed = meshes.add(&object.mesh, frame.positions(number));
                    if object.skin.is_none() {
                        known.push((&object.mesh, placed));
                    }
                    placed
                }
            };
            meshes.of_object.push(placed);
        }
        meshes
    }

    fn add(&mut self, mesh: &Mesh, positions: &[Vec3]) -> Placed {
        let (first_node, first_triangle) = (self.nodes.len(), self.triangles.len());
        let corners = mesh.triangles.iter().map(|triangle| triangle.map(|vertex| positions[vertex as usize]));
        let corners: Vec<[Vec3; 3]> =
            corners.filter(|corners| corners.iter().all(|corner| corner.is_finite())).collect();
        let boxes: Vec<[Vec3; 2]> = corners.iter().map(|[a, b, c]| [a.min(*b).min(*c), a.max(*b).max(*c)]).collect();
        let bounds = around(boxes.iter().copied());
        let padding = bounds.map_or(0.0, padding_of);
        let padded: Vec<[Vec3; 2]> = boxes.iter().map(|corners| widened(*corners, padding)).collect();
        let hierarchy = Hierarchy::new(&padded, MOST_IN_LEAF);
        self.nodes.extend(hierarchy.nodes.iter().map(|node| moved(node, first_node, first_triangle)));
        let row = |corner: Vec3| corner.extend(0.0).to_array();
        self.triangles.extend(hierarchy.order.iter().map(|&slot| corners[slot as usize].map(row)));
        let bounds = bounds.map(|corners| widened(corners, padding));
        Placed { first_node, depth: hierarchy.depth, bounds }
    }

    /// Hierarchy over objects where they are, and a row of four for each, in the order of its leaves.
    fn instances(&mut self, frame: &Frame<'_>, space: &KernelSpace) -> Result<Vec<[[u32; 4]; 4]>, GpuError> {
        let placed: Vec<(usize, [Vec3; 2])> = (self.of_object.iter().zip(&frame.world_from_object).enumerate())
            .filter_map(|(number, (placed, pose))| Some((number, placed_box(placed.bounds?, pose, space)?)))
            .collect();
        let boxes: Vec<[Vec3; 2]> = placed.iter().map(|(_, corners)| *corners).collect();
        let hierarchy = Hierarchy::new(&boxes, 1);
        let deepest = self.of_object.iter().map(|placed| placed.depth).max().unwrap_or(0);
        if hierarchy.depth + deepest + 1 > STACK {
            let problem = format!("hierarchies of {} levels, of {STACK} at most", hierarchy.depth + deepest);
            return Err(GpuError::Refused(problem));
        }
        self.nodes[..hierarchy.nodes.len()].copy_from_slice(&hierarchy.nodes);
        let row = |slot: &u32| {
            let number = placed[*slot as usize].0;
            let [x, y, z] = object_from_kernel(&frame.world_from_object[number], space);
            [
                x.map(f32::to_bits),
                y.map(f32::to_bits),
                z.map(f32::to_bits),
                [self.of_object[number].first_node as u32, 0, 0, 0],
            ]
        };
        Ok(hierarchy.order.iter().map(row).collect())
    }
}

/// Nodes of a hierarchy over so many objects, at most.
fn room_for_objects(count: usize) -> usize {
    count.max(1)
}

/// A node of a mesh's own hierarchy, its children numbered as they are among all.
fn moved(node: &Node, first_node: usize, first_triangle: usize) -> Node {
    let code = |child: u32| {
        let by = if child >> 31 == 1 { first_triangle } else { first_node };
        child + by as u32
    };
    Node { left: code(node.left), right: code(node.right), ..*node }
}

/// How much larger boxes are than what lies in them, so that rounding misses nothing.
fn padding_of([low, high]: [Vec3; 2]) -> f32 {
    16.0 * f32::EPSILON * low.abs().max(high.abs()).max_element()
}

fn widened([low, high]: [Vec3; 2], by: f32) -> [Vec3; 2] {
    [low - Vec3::splat(by), high + Vec3::splat(by)]
}

/// The box around an object's box where it is, in the space of kernels; `None` if that isn't finite.
fn placed_box([low, high]: [Vec3; 2], pose: &Pose, space: &KernelSpace) -> Option<[Vec3; 2]> {
    let corner = |k: usize| {
        let pick = |axis: usize| if k >> axis & 1 == 0 { low[axis] } else { high[axis] };
        let point = DVec3::new(f64::from(pick(0)), f64::from(pick(1)), f64::from(pick(2)));
        let world = pose.rotation.as_dquat() * (f64::from(pose.scale) * point) + pose.translation.as_dvec3();
        space.place(world).as_vec3()
    };
    let bounds = around((0..8).map(corner).map(|corner| [corner, corner]))?;
    let bounds = widened(bounds, padding_of(bounds));
    bounds.iter().all(|corner| corner.is_finite()).then_some(bounds)
}

/// Rows of the map from the space of kernels to an object's.
fn object_from_kernel(pose: &Pose, space: &KernelSpace) -> [[f32; 4]; 3] {
    let back = DMat3::from_quat(pose.rotation.as_dquat()).transpose() * f64::from(pose.scale).recip();
    let turn = back * space.rotation.transpose() * space.scale.recip();
    let offset = back * (space.center - pose.translation.as_dvec3());
    affine_rows(turn, offset)
}

impl Baked for BakedOnGpu {
    fn footprint(&self) -> Footprint {
        let [receivers, others] = self.runner.bytes();
        Footprint {
            parts: vec![("receivers on the device", receivers), ("hierarchies and light on the device", others)],
        }
    }

    fn place_receivers(&mut self, frame: &Frame<'_>, receivers: Receivers<'_>) -> Result<(), StrategyError> {
        Ok(self.runner.place_receivers(frame, receivers, &|i| receivers.index[i])?)
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
        if self.meshes.of_object.len() != frame.scene.objects.len() {
            return Err(StrategyError::Failed("the frame is of another scene than hierarchies were baked for".into()));
        }
        if self.meshes.is_deformed || frame.deformed.iter().any(Option::is_some) {
            self.meshes = Meshes::of(frame);
            self.runner.write(1, &self.meshes.nodes)?;
            self.runner.write(2, &self.meshes.triangles)?;
        }
        let known = self.light.take();
        let light = self.light.insert(LightSampler::new(frame, known));
        let space = space_of(frame, &self.meshes);
        let instances = self.meshes.instances(frame, &space)?;
        self.runner.write_part(1, &self.meshes.nodes[..room_for_objects(frame.scene.objects.len())]);
        let mut rows: Vec<[u32; 4]> = instances.concat();
        let bits = |v: Vec3, last: f32| v.extend(last).to_array().map(f32::to_bits);
        // Room for objects that can't be met, too: what follows stays where it is.
        rows.resize(4 * frame.scene.objects.len(), [0; 4]);
        let first_light = rows.len();
        for light in &light.lights {
            rows.push(space.place_sphere(light.center, light.radius).map(f32::to_bits));
            rows.push(bits(light.radiance, 0.0));
        }
        let first_texel = rows.len();
        let uniforms = FrameUniforms {
            lights: first_light as u32,
            light_count: light.lights.len() as u32,
            instance_count: instances.len() as u32,
            texels: first_texel as u32,
            ..uniforms(light, &self.samples)
        };
        let uniforms = match &light.base {
            DistantLight::Constant(_) => uniforms,
            DistantLight::Map(map) => FrameUniforms { aliases: (first_texel + map.texels().len()) as u32, ..uniforms },
        };
        let is_there = self.map.as_ref().is_some_and(|(map, row)| *row == first_texel && map.is_same_as(&light.base));
        if is_there {
            self.runner.write_part(3, &rows);
        } else {
            if let DistantLight::Map(map) = &light.base {
                // A black map draws no direction.
                let stay = |texel: usize| light.alias.cells.get(texel).map_or(1.0, |(stay, _)| *stay as f32);
                rows.extend(map.texels().iter().enumerate().map(|(i, texel)| bits(*texel, stay(i))));
                let aliases: Vec<u32> = light.alias.cells.iter().map(|(_, alias)| *alias).collect();
                rows.extend(aliases.chunks(4).map(|four| std::array::from_fn(|k| four.get(k).copied().unwrap_or(0))));
            }
            self.runner.write(3, &rows)?;
            self.map = Some((light.base.clone(), first_texel));
        }
        self.runner.write_uniforms(&uniforms);
        self.runner.place_objects(frame, &space)?;
        self.runner.upload()?;
        Ok(Box::new(Uploaded(&self.runner)))
    }
}

/// A space in which all objects have extents near 1.
fn space_of(frame: &Frame<'_>, meshes: &Meshes) -> KernelSpace {
    let plain = KernelSpace { rotation: DMat3::IDENTITY, center: DVec3::ZERO, scale: 1.0 };
    let boxes = meshes.of_object.iter().zip(&frame.world_from_object);
    let corners = boxes.filter_map(|(placed, pose)| placed_box(placed.bounds?, pose, &plain)).flatten();
    KernelSpace::of_points(corners.map(|corner| corner.as_dvec3()), DMat3::IDENTITY)
}

/// All settings that are known without the rows.
fn uniforms(light: &LightSampler, samples: &SampleArrays) -> FrameUniforms {
    let halves = |step: u64| [step as u32, (step >> 32) as u32];
    let [a, b] = samples.plane_steps.map(halves);
    let [x, y, z] = samples.space_steps.map(halves);
    let row = |v: Vec3, last: f32| v.extend(last).to_array();
    let (constant, [map_width, map_height]) = match &light.base {
        DistantLight::Constant(radiance) => (*radiance, [0; 2]),
        DistantLight::Map(map) => (Vec3::ZERO, [map.width() as u32, map.height() as u32]),
    };
    let sun = light.sun.as_ref().map(|(sun, power)| {
        let versine = 2.0 * (0.5 * f64::from(sun.angular_radius)).sin().powi(2);
        (row(sun.direction.normalize_or(Vec3::Y), versine as f32), row(sun.radiance, 0.0), *power as f32)
    });
    let (sun, sun_radiance, sun_power) = sun.unwrap_or(([0.0, 1.0, 0.0, -1.0], [0.0; 4], 0.0));
    let by_cosine_alone = samples.cosine_share > 0.0 && light.is_constant();
    FrameUniforms {
        environment: std::array::from_fn(|k| row(light.environment_from_world.row(k), 0.0)),
        constant: row(constant, 0.0),
        sun,
        sun_radiance,
        plane_steps: [a[0], a[1], b[0], b[1]],
        space_steps: [x[0], x[1], y[0], y[1]],
        space_last_step: z,
        samples: samples.samples,
        cosine_share: if by_cosine_alone { 1.0 } else { samples.cosine_share as f32 },
        base_power: light.base_power as f32,
        sun_power,
        map_width,
        map_height,
        ..FrameUniforms::default()
    }
}
