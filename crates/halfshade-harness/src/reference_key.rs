//! The key under which the truth is kept: everything that it depends on, by its exact bits.
//!
//! Every structure is taken apart without `..`: a field that is added must find its place here before this compiles. What
//! is left out is named, with the reason.

use halfshade_scene::{
    Environment, Frame, GlossVariation, Material, Mesh, Object, Receivers, Scene, Texture, cache::CacheKey,
    light::DistantLight, mesh::AlphaMask,
};
use halfshade_truth::Options;

/// Raise it whenever the meaning of what is cached changes.
const VERSION: u32 = 5;

/// The key of the truth of `receivers` at a frame.
pub(crate) fn key(frame: &Frame<'_>, receivers: Receivers<'_>, options: &Options) -> CacheKey {
    let key = of_options(CacheKey::new("truth", VERSION), options);
    of_frame(of_receivers(key, receivers), frame)
}

fn of_options(key: CacheKey, options: &Options) -> CacheKey {
    let Options { geometry, transport, samples, noise_target, bounces, max_samples, seed } = options;
    key.bytes(format!("{geometry:?} {transport:?}").as_bytes()).value(&(
        samples,
        noise_target,
        bounces,
        max_samples,
        seed,
    ))
}

fn of_receivers(key: CacheKey, receivers: Receivers<'_>) -> CacheKey {
    // Where on the mesh a receiver lies is for what is baked per vertex: the truth goes by its position.
    let Receivers { position, normal, albedo, object, surface: _, index, specular_factor, exponent_factor } = receivers;
    key.value(&(position, normal, albedo, object, index, specular_factor, exponent_factor))
}

fn of_frame(key: CacheKey, frame: &Frame<'_>) -> CacheKey {
    // The number tells nothing that poses don't.
    let Frame { scene, index: _, world_from_object, deformed, world_from_environment, lights } = frame;
    let deformed: Vec<_> = deformed.iter().map(Option::as_deref).collect();
    of_scene(key.value(&(world_from_object, deformed, world_from_environment, lights)), scene)
}

fn of_scene(key: CacheKey, scene: &Scene) -> CacheKey {
    let Scene {
        name: _,
        objects,
        environment,
        // Their values at a moment are in the frame.
        environment_turn: _,
        environment_turn_per_sec: _,
        lights: _,
        camera,
        frames_per_sec: _,
        frame_count: _,
        bounces,
        // For people.
        notes: _,
    } = scene;
    let key = of_environment(key.value(&(camera, bounces, objects.len())), environment);
    objects.iter().fold(key, of_object)
}

fn of_environment(key: CacheKey, environment: &Environment) -> CacheKey {
    let Environment { base, sun } = environment;
    let key = key.value(sun);
    match base {
        DistantLight::Constant(radiance) => key.value(&(0, radiance)),
        DistantLight::Map(map) => key.value(&(1, &**map)),
    }
}

fn of_object(key: CacheKey, object: &Object) -> CacheKey {
    let Object {
        name: _,
        mesh,
        material,
        // The spheres that were built are what counts.
        sphere_count: _,
        fit: _,
        spheres,
        // For strategies.
        cluster_count: _,
        // Their values at a moment are in the frame.
        motion: _,
        skin: _,
    } = object;
    of_material(of_mesh(key, mesh), material).value(&spheres.as_deref())
}

fn of_mesh(key: CacheKey, mesh: &Mesh) -> CacheKey {
    let Mesh { positions, normals, colors, texture_coordinates, textures, triangles, masks, coverage } = mesh;
    let textures: Vec<&Texture> = textures.iter().map(|texture| &**texture).collect();
    let key = key.value(&(positions, normals, colors, texture_coordinates, textures, triangles, coverage, masks.len()));
    masks.iter().fold(key, |key, AlphaMask { texture, cutoff }| key.value(&(texture.as_deref(), cutoff)))
}

fn of_material(key: CacheKey, material: &Material) -> CacheKey {
    let Material { albedo, texture, reflectance, gloss_variation, subsurface } = material;
    // Without a medium keys are what they were before there was any.
    let key = subsurface.iter().fold(key, |key, medium| key.value(medium));
    let key = key.value(&(albedo, texture.as_deref(), reflectance, gloss_variation.is_some()));
    match gloss_variation.as_deref() {
        None => key,
        Some(GlossVariation { vertices, specular, exponent }) => {
            key.value(&(vertices, specular.as_deref(), exponent.as_deref()))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec2, Quat, Vec2, Vec3};
    use halfshade_scene::{
        Deformed, Gloss, LafortuneLobe, ReceiverBuffer, Reflectance, Sphere, SphereLight, SphereSet, Subsurface,
        builtin,
        light::{EnvironmentMap, Sun},
        spheres::AdjustRule,
        texture::{Filter, Wrap},
    };
    use halfshade_truth::{Geometry, Transport};
    use std::{collections::HashMap, sync::Arc};

    /// All that a key is made of.
    #[derive(Clone)]
    struct Parts {
        scene: Scene,
        receivers: ReceiverBuffer,
        options: Options,
        change: fn(&mut Frame<'_>),
    }

    impl Parts {
        fn name(&self) -> String {
            let mut frame = self.scene.frame(0);
            (self.change)(&mut frame);
            key(&frame, self.receivers.view(), &self.options).file_name()
        }

        fn mesh(&mut self) -> &mut Mesh {
            Arc::make_mut(&mut self.scene.objects[0].mesh)
        }

        fn material(&mut self) -> &mut Material {
            &mut self.scene.objects[0].material
        }

        fn variation(&mut self) -> &mut GlossVariation {
            Arc::make_mut(self.material().gloss_variation.as_mut().unwrap())
        }

        fn spheres(&mut self) -> &mut SphereSet {
            Arc::make_mut(self.scene.objects[0].spheres.as_mut().unwrap())
        }
    }

    fn texture(value: f32) -> Arc<Texture> {
        Arc::new(Texture::new(1, 1, vec![Vec3::splat(value)]).unwrap())
    }

    fn map(value: f32) -> Environment {
        Environment::map(EnvironmentMap::new(2, 1, vec![Vec3::ONE, Vec3::splat(value)]).unwrap())
    }

    /// One of everything.
    fn parts() -> Parts {
        let mut scene = builtin::scene("one-sphere").unwrap();
        let object = &mut scene.objects[0];
        let mesh = Arc::make_mut(&mut object.mesh);
        mesh.colors = vec![Vec3::splat(0.5); mesh.positions.len()];
        mesh.texture_coordinates = vec![Vec2::splat(0.5).extend(0.0); mesh.positions.len()];
        mesh.textures = vec![texture(0.5)];
        mesh.masks = vec![AlphaMask { texture: Some(texture(0.5)), cutoff: 0.5 }];
        mesh.coverage = vec![Vec2::X; mesh.positions.len()];
        object.material.texture = Some(texture(0.25));
        let lobe = LafortuneLobe { scale: Vec3::splat(0.1), axis: Vec3::ONE, exponent: 3.0 };
        object.material.reflectance = Reflectance::Lafortune { lobes: vec![lobe] };
        object.material.gloss_variation = Some(Arc::new(GlossVariation {
            vertices: vec![Gloss::NEUTRAL; object.mesh.positions.len()],
            specular: Some(texture(0.5)),
            exponent: Some(texture(0.5)),
        }));
        let sphere = Sphere { center: Vec3::ZERO, radius: 1.0 };
        object.spheres = Some(Arc::new(SphereSet { spheres: vec![sphere], ..SphereSet::default() }));
        let sun = Sun { direction: Vec3::Y, angular_radius: 0.1, radiance: Vec3::ONE };
        scene.environment = Environment { sun: Some(sun), ..map(0.5) };
        let receivers = ReceiverBuffer::vertices(&scene.frame(0));
        Parts { scene, receivers, options: Options::default(), change: |_| () }
    }

    type Change = fn(&mut Parts);

    #[test]
    fn a_change_of_any_one_field_is_another_key() {
        let changes: &[(&str, Change)] = &[
            ("geometry", |p| p.options.geometry = Geometry::Spheres(AdjustRule::Continuous)),
            ("rule", |p| p.options.geometry = Geometry::Spheres(AdjustRule::Covering)),
            ("transport", |p| p.options.transport = Transport::Unshadowed),
            ("samples", |p| p.options.samples += 1),
            ("noise", |p| p.options.noise_target = Some(0.01)),
            ("bounces", |p| p.options.bounces += 1),
            ("most samples", |p| p.options.max_samples -= 1),
            ("seed", |p| p.options.seed += 1),
            ("receiver's place", |p| p.receivers.position[2][7] = -0.0),
            ("receiver's normal", |p| p.receivers.normal[0][7] += 0.5),
            ("receiver's albedo", |p| p.receivers.albedo[1][7] += 0.5),
            ("receiver's object", |p| p.receivers.object[7] += 1),
            ("receiver's number", |p| p.receivers.index[7] += 1),
            ("receiver's gloss", |p| p.receivers.specular_factor[1][7] += 0.5),
            ("receiver's exponent", |p| p.receivers.exponent_factor[7] += 0.5),
            ("receivers", |p| p.receivers.push(Vec3::ZERO, Vec3::Y, Vec3::ONE, 0)),
            ("pose", |p| p.change = |frame| frame.world_from_object[0].translation.x += 0.5),
            ("scale", |p| p.change = |frame| frame.world_from_object[0].scale *= 2.0),
            ("turn", |p| p.change = |frame| frame.world_from_object[0].rotation = Quat::from_rotation_y(0.5)),
            ("deformed", |p| p.change = |frame| frame.deformed[0] = Some(Arc::new(Deformed::default()))),
            ("environment's turn", |p| p.change = |frame| frame.world_from_environment = Quat::from_rotation_y(0.5)),
            ("light", |p| {
                p.change = |frame| {
                    frame.lights.push(SphereLight { center: Vec3::ONE, radius: 1.0, radiance: Vec3::ONE });
                }
            }),
            ("light's radiance", |p| {
                p.change = |frame| {
                    frame.lights.push(SphereLight { center: Vec3::ONE, radius: 1.0, radiance: Vec3::X });
                }
            }),
            ("eye", |p| p.scene.camera.eye.x += 0.5),
            ("scene's bounces", |p| p.scene.bounces += 1),
            ("objects", |p| drop(p.scene.objects.pop())),
            ("map", |p| p.scene.environment = Environment { sun: p.scene.environment.sun, ..map(0.75) }),
            ("constant", |p| p.scene.environment.base = DistantLight::Constant(Vec3::ONE)),
            ("no sun", |p| p.scene.environment.sun = None),
            ("sun", |p| p.scene.environment.sun.as_mut().unwrap().angular_radius *= 2.0),
            ("positions", |p| p.mesh().positions[3].y += 0.5),
            ("normals", |p| p.mesh().normals[3].y += 0.5),
            ("colours", |p| p.mesh().colors[3].y += 0.25),
            ("coordinates", |p| p.mesh().texture_coordinates[3].y += 0.25),
            ("mesh's texture", |p| p.mesh().textures[0] = texture(0.75)),
            ("wrap", |p| {
                let wrapped = (*texture(0.5)).clone().wrapped([Wrap::Clamp, Wrap::Repeat]);
                assert_eq!(wrapped.at(DVec2::ZERO), Vec3::splat(0.5));
                p.mesh().textures[0] = Arc::new(wrapped);
            }),
            ("filter", |p| p.mesh().textures[0] = Arc::new((*texture(0.5)).clone().filtered(Filter::Nearest))),
            ("mask", |p| p.mesh().masks[0].cutoff *= 0.5),
            ("mask's texture", |p| p.mesh().masks[0].texture = Some(texture(0.75))),
            ("no mask", |p| p.mesh().masks.clear()),
            ("coverage", |p| p.mesh().coverage[3].x *= 0.5),
            ("triangles", |p| p.mesh().triangles[0].rotate_left(1)),
            ("albedo", |p| p.material().albedo.x *= 0.5),
            ("texture", |p| p.material().texture = Some(texture(0.75))),
            ("no texture", |p| p.material().texture = None),
            ("lambert", |p| p.material().reflectance = Reflectance::Lambert),
            ("phong", |p| {
                p.material().reflectance = Reflectance::Phong { specular: Vec3::splat(0.1), exponent: 3.0 };
            }),
            ("modified phong", |p| {
                p.material().reflectance = Reflectance::ModifiedPhong { specular: Vec3::splat(0.1), exponent: 3.0 };
            }),
            ("medium", |p| {
                let coefficients = Vec3::new(1.0, 2.0, 3.0);
                p.material().subsurface = Some(Subsurface {
                    absorption: coefficients,
                    reduced_scattering: 10.0 * coefficients,
                    refractive_index: 1.3,
                });
            }),
            ("no variation", |p| p.material().gloss_variation = None),
            ("gloss of vertices", |p| p.variation().vertices[3].exponent = 0.5),
            ("specular texture", |p| p.variation().specular = None),
            ("exponent texture", |p| p.variation().exponent = Some(texture(0.75))),
            ("no spheres", |p| p.scene.objects[0].spheres = None),
            ("sphere", |p| p.spheres().spheres[0].radius *= 2.0),
        ];
        let mut names = HashMap::from([(parts().name(), "nothing")]);
        for (what, change) in changes {
            let mut parts = parts();
            change(&mut parts);
            if let Some(other) = names.insert(parts.name(), what) {
                panic!("{what} and {other} have one key");
            }
        }
    }

    #[test]
    fn what_the_truth_does_not_see_changes_nothing() {
        let mut other = parts();
        other.scene.name = "another".into();
        other.scene.objects[0].cluster_count += 1;
        other.scene.notes.push("a note".into());
        other.change = |frame| frame.index += 1;
        assert_eq!(other.name(), parts().name());
    }
}
