//! A frame of a scene as a scene of Mitsuba.

use super::map_image;
use super::materials::{PLUGIN, Surface, Textures};
use super::ply::{Column, ply};
use super::xml::{Xml, triple};
use crate::exchange::Exported;
use crate::light::{DistantLight, Sun};
use crate::{ExrFacts, Frame, ReceiverBuffer, Receivers, SceneError, Texture, exr_bytes};
use glam::Vec3;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Distance of the sun in sizes of the scene: seen from its ends, the sun's place differs by two hundredths of the real
/// sun's radius.
const SUN_DISTANCE: f32 = 1e4;

/// Scripts that go with every scene.
const RENDER: &str = include_str!("render.py");
const CONFIRM: &str = include_str!("confirm.py");
/// The plugin for gloss.
const LOBES: &str = include_str!("halfshade_lobes.py");

/// Writes a frame: `scene.xml`, meshes, textures and the environment beside it, and scripts that render it and compare it
/// with the truth (see [`super`] for what becomes of what).
pub fn export(frame: &Frame<'_>) -> Result<Exported, SceneError> {
    let (mut xml, mut writer) = (Xml::new(), Writer::default());
    let mut result = Ok(());
    xml.element("scene", &[("version", "3.0.0")], |xml| {
        integrator(xml, frame);
        sensor(xml, frame);
        result = writer.environment(xml, frame).and_then(|()| writer.objects(xml, frame));
        lamps(xml, frame);
    });
    result?;
    let mut files = vec![("scene.xml".to_owned(), xml.into_bytes())];
    files.append(&mut writer.files);
    files.append(&mut writer.textures.files);
    for (name, script) in [("render.py", RENDER), ("confirm.py", CONFIRM), (&format!("{PLUGIN}.py"), LOBES)] {
        files.push((name.to_owned(), script.as_bytes().to_vec()));
    }
    let mut notes = writer.notes;
    notes.append(&mut writer.textures.notes);
    Ok(Exported { files, notes })
}

fn integrator(xml: &mut Xml, frame: &Frame<'_>) {
    xml.element("integrator", &[("type", "volpath")], |xml| {
        xml.value("integer", "max_depth", &(frame.scene.bounces + 2).to_string());
        // None: b bounces are b bounces.
        xml.value("integer", "rr_depth", "1000000");
        xml.value("boolean", "hide_emitters", "true");
    });
}

fn sensor(xml: &mut Xml, frame: &Frame<'_>) {
    let camera = &frame.scene.camera;
    let distance = camera.target.distance(camera.eye);
    xml.element("sensor", &[("type", "perspective")], |xml| {
        xml.value("string", "fov_axis", "y");
        xml.value("float", "fov", &camera.vertical_fov_degrees.to_string());
        xml.value("float", "near_clip", &(1e-3 * distance).to_string());
        xml.value("float", "far_clip", &(1e5 * distance).to_string());
        xml.element("transform", &[("name", "to_world")], |xml| {
            let [origin, target, up] = [camera.eye, camera.target, camera.up()].map(triple);
            xml.leaf("lookat", &[("origin", &origin), ("target", &target), ("up", &up)]);
        });
        xml.element("film", &[("type", "hdrfilm")], |xml| {
            xml.value("integer", "width", &camera.resolution[0].to_string());
            xml.value("integer", "height", &camera.resolution[1].to_string());
            xml.value("string", "pixel_format", "rgb");
            xml.value("string", "component_format", "float32");
            xml.leaf("rfilter", &[("type", "box")]);
        });
        xml.element("sampler", &[("type", "independent")], |xml| xml.value("integer", "sample_count", "256"));
    });
}

fn lamps(xml: &mut Xml, frame: &Frame<'_>) {
    for light in frame.lights.iter().filter(|light| light.radiance != Vec3::ZERO) {
        lamp(xml, light.center, light.radius, light.radiance);
    }
}

/// A sphere that shines and hides nothing.
fn lamp(xml: &mut Xml, center: Vec3, radius: f32, radiance: Vec3) {
    xml.element("shape", &[("type", "sphere")], |xml| {
        xml.vector("point", "center", center);
        xml.value("float", "radius", &radius.to_string());
        xml.leaf("bsdf", &[("type", "null")]);
        xml.element("emitter", &[("type", "area")], |xml| xml.value("rgb", "radiance", &triple(radiance)));
    });
}

/// Files beside the scene.
#[derive(Default)]
struct Writer {
    textures: Textures,
    files: Vec<(String, Vec<u8>)>,
    notes: Vec<String>,
}

impl Writer {
    fn environment(&mut self, xml: &mut Xml, frame: &Frame<'_>) -> Result<(), SceneError> {
        match &frame.scene.environment.base {
            DistantLight::Constant(Vec3::ZERO) => {}
            DistantLight::Constant(radiance) => {
                xml.element("emitter", &[("type", "constant")], |xml| xml.value("rgb", "radiance", &triple(*radiance)));
            }
            DistantLight::Map(map) => {
                let image = map_image::image(map);
                let bytes = exr_bytes([image.width, image.height], &[("", &image.pixels)], ExrFacts::default());
                self.files.push(("environment.exr".to_owned(), bytes.map_err(SceneError::new)?));
                xml.element("emitter", &[("type", "envmap")], |xml| {
                    xml.value("string", "filename", "environment.exr");
                    xml.element("transform", &[("name", "to_world")], |xml| {
                        // Their centre looks along +Z, ours along -Z.
                        xml.leaf("rotate", &[("y", "1"), ("angle", "180")]);
                        let (axis, angle) = frame.world_from_environment.to_axis_angle();
                        if angle != 0.0 {
                            let [x, y, z] = axis.to_array().map(|component| component.to_string());
                            let angle = angle.to_degrees().to_string();
                            xml.leaf("rotate", &[("x", &x), ("y", &y), ("z", &z), ("angle", &angle)]);
                        }
                    });
                });
                let copies = map_image::copies(map);
                self.notes.push(format!(
                    "Mitsuba interpolates the environment: ramps of 1/{copies} of a texel stand where radiance steps here"
                ));
            }
        }
        if let Some(sun) = &frame.scene.environment.sun {
            self.sun(xml, frame, sun);
        }
        Ok(())
    }

    fn sun(&mut self, xml: &mut Xml, frame: &Frame<'_>, sun: &Sun) {
        let receivers = ReceiverBuffer::vertices(frame);
        let bounds = receivers.position.each_ref().map(|axis| {
            let fold = |start: f32, pick: fn(f32, f32) -> f32| axis.iter().copied().fold(start, pick);
            [fold(f32::INFINITY, f32::min), fold(f32::NEG_INFINITY, f32::max)]
        });
        let [min, max] = [0, 1].map(|end| Vec3::from(bounds.map(|axis| axis[end])));
        let distance = SUN_DISTANCE * min.distance(max).max(f32::MIN_POSITIVE);
        let direction = frame.world_from_environment * sun.direction;
        lamp(xml, 0.5 * (min + max) + distance * direction, distance * sun.angular_radius.sin(), sun.radiance);
        self.notes.push(format!("the sun is a sphere {SUN_DISTANCE:e} times as far away as the scene is wide"));
    }

    fn objects(&mut self, xml: &mut Xml, frame: &Frame<'_>) -> Result<(), SceneError> {
        let all = ReceiverBuffer::vertices(frame);
        let mut first = 0;
        for (number, object) in frame.scene.objects.iter().enumerate() {
            let count = object.mesh.positions.len();
            self.object(xml, frame, number, &all.view().slice(first..first + count))?;
            first += count;
        }
        Ok(())
    }

    /// Writes an object, `vertices` being its own: one mesh for each of its textures.
    fn object(
        &mut self,
        xml: &mut Xml,
        frame: &Frame<'_>,
        number: usize,
        vertices: &Receivers<'_>,
    ) -> Result<(), SceneError> {
        let object = &frame.scene.objects[number];
        let (mesh, material) = (&object.mesh, &object.material);
        if mesh.has_cutouts() {
            self.notes.push(format!("object `{}`: holes that alpha masks cut are closed", object.name));
        }
        if material.subsurface.is_some() {
            self.notes.push(format!("object `{}`: light below its surface is left out: it is diffuse", object.name));
        }
        let mut parts: BTreeMap<usize, Vec<[u32; 3]>> = BTreeMap::new();
        for triangle in &mesh.triangles {
            let by_mesh = mesh.texture_coordinates.get(triangle[0] as usize).filter(|_| material.texture.is_none());
            parts.entry(by_mesh.map_or(0, |place| place.z.round() as usize)).or_default().push(*triangle);
        }
        for (part, triangles) in parts {
            let own = material.texture.as_ref().or_else(|| mesh.textures.get(part));
            let surface = Surface {
                material,
                pose: frame.world_from_object[number],
                texture: own.filter(|_| !mesh.texture_coordinates.is_empty()),
                has_colors: !mesh.colors.is_empty(),
                has_gloss: material.varied_gloss().is_some_and(|variation| !variation.vertices.is_empty()),
            };
            let file = format!("meshes/{number}-{part}.ply");
            let columns = columns(frame, number, vertices, surface.texture);
            self.files.push((file.clone(), ply(&columns, &triangles)));
            let mut result = Ok(());
            xml.element("shape", &[("type", "ply"), ("id", &format!("{} {number}-{part}", object.name))], |xml| {
                xml.value("string", "filename", &file);
                // Texture coordinates of PLY files rise upward.
                xml.value("boolean", "flip_tex_coords", "true");
                result = surface.write(xml, &mut self.textures);
            });
            result?;
        }
        Ok(())
    }
}

/// Values of the vertices of an object, in world space.
fn columns(frame: &Frame<'_>, number: usize, vertices: &Receivers<'_>, texture: Option<&Arc<Texture>>) -> Vec<Column> {
    let object = &frame.scene.objects[number];
    let mesh = &object.mesh;
    let mut columns: Vec<Column> = Vec::new();
    columns.extend(["x", "y", "z"].into_iter().zip(vertices.position.map(<[f32]>::to_vec)));
    columns.extend(["nx", "ny", "nz"].into_iter().zip(vertices.normal.map(<[f32]>::to_vec)));
    let has_gloss_texture =
        object.material.varied_gloss().is_some_and(|gloss| gloss.specular.is_some() || gloss.exponent.is_some());
    if texture.is_some() || has_gloss_texture {
        columns.push(("s", mesh.texture_coordinates.iter().map(|place| place.x).collect()));
        columns.push(("t", mesh.texture_coordinates.iter().map(|place| 1.0 - place.y).collect()));
    }
    if !mesh.colors.is_empty() {
        let channel = |c: usize| mesh.colors.iter().map(|color| (object.material.albedo * *color)[c]).collect();
        columns.extend(["r", "g", "b"].into_iter().zip([0, 1, 2].map(channel)));
    }
    if let Some(gloss) = object.material.varied_gloss().filter(|gloss| !gloss.vertices.is_empty()) {
        let channel = |c: usize| gloss.vertices.iter().map(|vertex| vertex.specular[c]).collect();
        columns.extend(["specular_r", "specular_g", "specular_b"].into_iter().zip([0, 1, 2].map(channel)));
        columns.push(("exponent_x", gloss.vertices.iter().map(|vertex| vertex.exponent).collect()));
    }
    columns
}
