//! Directives of a scene file, one after another.

use super::lights::{emitted, light_source};
use super::materials::{Surface, Textures, default_surface, material, texture};
use super::parameters::Parameters;
use super::shapes::{MeshFiles, mesh_of, radius};
use super::tokens::{Tokens, Word};
use crate::exchange::assembly::{Assembly, Lamp, Shape, rotation};
use crate::exchange::view::{View, vertical_degrees};
use crate::{Scene, SceneError, input, text};
use glam::{DMat4, DVec3, DVec4, Vec3};
use std::collections::BTreeMap;
use std::path::Path;

type Result<T> = std::result::Result<T, SceneError>;

/// Deepest nesting of attributes, and of files.
const DEEPEST: usize = 64;
/// Most files that a scene includes.
const MOST_FILES: usize = 1024;
/// Bounces of pbrt's integrators that don't say: depth 5, of which the first is direct light.
const DEFAULT_BOUNCES: usize = 4;

/// Reads a scene file of pbrt-v4 and all that it names; sphere sets are not built yet.
///
/// Shapes `trianglemesh`, `plymesh` and `sphere`; spheres that are area lights as lights; light source `infinite`,
/// constant or by an image; material `diffuse`, by a colour or an image; instances; the `perspective` camera; transforms;
/// the integrator's depth. The scene is turned so that +Y is up in its picture, and mirrored where its space is left-handed.
/// Meshes without normals are faceted. [`Scene::notes`] tell file and line of everything else.
pub fn load(path: &Path) -> Result<Scene> {
    let mut reader = Reader::new(path);
    reader.file(path, 0).map_err(|error| if error.path.is_some() { error } else { error.in_file(path) })?;
    reader.finish()
}

/// Settings that directives change and `AttributeEnd` restores.
#[derive(Debug, Clone)]
struct State {
    world_from_here: DMat4,
    surface: Surface,
    /// Radiance of shapes to come.
    emitted: Option<Vec3>,
}

struct Reader {
    assembly: Assembly,
    state: State,
    stack: Vec<State>,
    /// Transforms by name.
    spaces: BTreeMap<String, DMat4>,
    surfaces: BTreeMap<String, Surface>,
    textures: Textures,
    meshes: MeshFiles,
    /// Shapes of objects that instances copy.
    objects: BTreeMap<String, Vec<Shape>>,
    /// The object that is being defined.
    object: Option<String>,
    resolution: [f64; 2],
    fov: f64,
    files: usize,
}

impl Reader {
    fn new(path: &Path) -> Self {
        let mut assembly = Assembly::new(path);
        assembly.bounces = Some(DEFAULT_BOUNCES);
        Self {
            assembly,
            state: State { world_from_here: DMat4::IDENTITY, surface: default_surface(), emitted: None },
            stack: Vec::new(),
            spaces: BTreeMap::new(),
            surfaces: BTreeMap::new(),
            textures: Textures::new(),
            meshes: MeshFiles::new(),
            objects: BTreeMap::new(),
            object: None,
            resolution: [1280.0, 720.0],
            fov: 90.0,
            files: 0,
        }
    }

    fn file(&mut self, path: &Path, depth: usize) -> Result<()> {
        self.files += 1;
        if depth > DEEPEST || self.files > MOST_FILES {
            return Err(SceneError::new(format!(
                "files include more than {MOST_FILES} files, or each other in a circle"
            )));
        }
        let about = |error: SceneError| error.in_file(path);
        let bytes = input::read(path).map_err(|error| about(SceneError::new(format!("cannot be read: {error}"))))?;
        let text = text::decode(&bytes).map_err(about)?;
        let mut tokens = Tokens::new(path, text.replace("\r\n", "\n").replace('\r', "\n"));
        loop {
            let line = tokens.line();
            match tokens.next()? {
                None => return Ok(()),
                Some(Word::Plain(directive)) => self.directive(&directive, &mut tokens, line, depth)?,
                Some(Word::Quoted(word)) => {
                    let problem = format!("`{}` stands where a directive should", word.escape_debug());
                    return Err(tokens.error(problem).at_line(line));
                }
            }
        }
    }

    fn directive(&mut self, directive: &str, tokens: &mut Tokens, line: usize, depth: usize) -> Result<()> {
        if self.transform(directive, tokens)? || self.nesting(directive, tokens, line)? {
            return Ok(());
        }
        match directive {
            "Include" | "Import" => {
                let name = tokens.quoted("a file's name")?;
                let path = tokens.path.parent().unwrap_or(Path::new("")).join(name);
                let named = |error: SceneError| match error.path {
                    Some(_) if path.is_file() => error,
                    _ => SceneError::new(error.to_string()).in_file(&*tokens.path).at_line(line),
                };
                self.file(&path, depth + 1).map_err(named)
            }
            "MediumInterface" => {
                tokens.quoted("a medium")?;
                if tokens.peek() == Some("\"") {
                    tokens.quoted("a medium")?;
                }
                self.left_out(tokens, line, "media are left out");
                Ok(())
            }
            "ReverseOrientation" => Ok(()), // Both faces reflect.
            "ColorSpace" => {
                let name = tokens.quoted("a colour space")?;
                if name != "srgb" {
                    self.left_out(tokens, line, &format!("colour space `{}` is taken for sRGB", name.escape_debug()));
                }
                Ok(())
            }
            "Attribute" => {
                let of = tokens.quoted("what attributes are of")?;
                Parameters::read(tokens, line)?;
                self.left_out(tokens, line, &format!("attributes of `{}` left out", of.escape_debug()));
                Ok(())
            }
            "Option" => Parameters::read(tokens, line).map(drop),
            "Texture" => {
                let name = tokens.quoted("a texture's name")?;
                tokens.quoted("a texture's type")?;
                let kind = tokens.quoted("a texture's kind")?;
                let parameters = Parameters::read(tokens, line)?;
                let value = texture(&kind, &parameters, &mut self.assembly)?;
                self.textures.insert(name, value);
                Ok(())
            }
            "NamedMaterial" => {
                let name = tokens.quoted("a material's name")?;
                let found = self.surfaces.get(&name).cloned();
                let missing =
                    || tokens.error(format!("no material `{}` stands before", name.escape_debug())).at_line(line);
                self.state.surface = found.ok_or_else(missing)?;
                Ok(())
            }
            _ => self.with_parameters(directive, tokens, line),
        }
    }

    /// Directives that are followed by a kind and parameters.
    fn with_parameters(&mut self, directive: &str, tokens: &mut Tokens, line: usize) -> Result<()> {
        const KNOWN: [&str; 12] = [
            "Shape",
            "Material",
            "MakeNamedMaterial",
            "LightSource",
            "AreaLightSource",
            "Camera",
            "Film",
            "Integrator",
            "Sampler",
            "PixelFilter",
            "Accelerator",
            "MakeNamedMedium",
        ];
        if !KNOWN.contains(&directive) {
            let problem = format!("`{}` is no directive of pbrt-v4", directive.escape_debug());
            return Err(tokens.error(problem).at_line(line));
        }
        let kind = tokens.quoted(&format!("the kind of {directive}"))?;
        let parameters = Parameters::read(tokens, line)?;
        match directive {
            "Shape" => self.shape(&kind, &parameters),
            "Material" => {
                self.state.surface = material(&kind, &parameters, &self.textures, &mut self.assembly)?;
                Ok(())
            }
            "MakeNamedMaterial" => {
                let of = parameters.text("type").unwrap_or("diffuse").to_owned();
                let surface = material(&of, &parameters, &self.textures, &mut self.assembly)?;
                self.surfaces.insert(kind, surface);
                Ok(())
            }
            "LightSource" => light_source(&kind, &parameters, self.state.world_from_here, &mut self.assembly),
            "AreaLightSource" => {
                self.state.emitted = Some(emitted(&parameters, &mut self.assembly)?);
                Ok(())
            }
            "Camera" => self.camera(&kind, &parameters, tokens),
            "Film" => {
                for (side, name) in self.resolution.iter_mut().zip(["xresolution", "yresolution"]) {
                    *side = parameters.number(name).unwrap_or(*side);
                }
                Ok(())
            }
            "Integrator" => {
                self.assembly.bounces = match parameters.number("maxdepth") {
                    Some(depth) => Some((depth.max(0.0) as usize).saturating_sub(1)),
                    None => Some(DEFAULT_BOUNCES),
                };
                Ok(())
            }
            "MakeNamedMedium" => {
                self.left_out(tokens, line, "media are left out");
                Ok(())
            }
            // They say how a picture is made, not of what.
            _ => Ok(()),
        }
    }

    fn left_out(&mut self, tokens: &Tokens, line: usize, what: &str) {
        self.assembly.note(&tokens.path, line, what);
    }

    /// Does a directive that changes the transform; `false` if this is none.
    fn transform(&mut self, directive: &str, tokens: &mut Tokens) -> Result<bool> {
        let here = &mut self.state.world_from_here;
        match directive {
            "Identity" => *here = DMat4::IDENTITY,
            "Translate" => *here *= DMat4::from_translation(tokens.numbers::<3>(directive)?.into()),
            "Scale" => *here *= DMat4::from_scale(tokens.numbers::<3>(directive)?.into()),
            "Rotate" => {
                let [degrees, x, y, z] = tokens.numbers(directive)?;
                let turn = rotation(DVec3::new(x, y, z), degrees);
                *here *= turn.ok_or_else(|| tokens.error("the axis of the rotation before is zero"))?;
            }
            "Transform" => *here = DMat4::from_cols_array(&tokens.numbers(directive)?),
            "ConcatTransform" => *here *= DMat4::from_cols_array(&tokens.numbers(directive)?),
            "LookAt" => {
                let [ex, ey, ez, tx, ty, tz, ux, uy, uz] = tokens.numbers(directive)?;
                let matrix = look_at(DVec3::new(ex, ey, ez), DVec3::new(tx, ty, tz), DVec3::new(ux, uy, uz));
                *here *= matrix.ok_or_else(|| tokens.error("the LookAt before looks nowhere, or along its own up"))?;
            }
            "CoordinateSystem" => {
                let name = tokens.quoted("a space's name")?;
                self.spaces.insert(name, *here);
            }
            "CoordSysTransform" => {
                let name = tokens.quoted("a space's name")?;
                let found = self.spaces.get(&name);
                *here =
                    *found.ok_or_else(|| tokens.error(format!("no space `{}` stands before", name.escape_debug())))?;
            }
            "ActiveTransform" => {
                tokens.next()?;
                let line = tokens.line();
                self.left_out(tokens, line, "moving transforms are left out");
            }
            "TransformTimes" => drop(tokens.numbers::<2>(directive)?),
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Does a directive that begins or ends something; `false` if this is none.
    fn nesting(&mut self, directive: &str, tokens: &mut Tokens, line: usize) -> Result<bool> {
        match directive {
            "WorldBegin" => {
                self.state.world_from_here = DMat4::IDENTITY;
                self.spaces.insert("world".to_owned(), DMat4::IDENTITY);
            }
            "WorldEnd" => {}
            "AttributeBegin" | "TransformBegin" => self.push(tokens)?,
            "AttributeEnd" | "TransformEnd" => self.pop(directive, tokens, line)?,
            "ObjectBegin" => {
                let name = tokens.quoted("an object's name")?;
                if self.object.is_some() {
                    return Err(tokens.error("an object begins within another").at_line(line));
                }
                self.push(tokens)?;
                self.objects.insert(name.clone(), Vec::new());
                self.object = Some(name);
            }
            "ObjectEnd" => {
                if self.object.take().is_none() {
                    return Err(tokens.error("an object ends that hasn't begun").at_line(line));
                }
                self.pop(directive, tokens, line)?;
            }
            "ObjectInstance" => {
                let name = tokens.quoted("an object's name")?;
                let missing = format!("no object `{}` ends before, outside of which it is used", name.escape_debug());
                let object = self.objects.get(&name).filter(|_| self.object.is_none());
                let shapes = object.cloned().ok_or_else(|| tokens.error(missing).at_line(line))?;
                for shape in shapes {
                    let world_from_mesh = self.state.world_from_here * shape.world_from_mesh;
                    self.assembly.add(Shape { world_from_mesh, ..shape })?;
                }
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn push(&mut self, tokens: &mut Tokens) -> Result<()> {
        if self.stack.len() >= DEEPEST {
            return Err(tokens.error(format!("attributes are nested more than {DEEPEST} deep")));
        }
        self.stack.push(self.state.clone());
        Ok(())
    }

    fn pop(&mut self, directive: &str, tokens: &mut Tokens, line: usize) -> Result<()> {
        let nothing = || tokens.error(format!("{directive} ends what hasn't begun")).at_line(line);
        self.state = self.stack.pop().ok_or_else(nothing)?;
        Ok(())
    }

    fn shape(&mut self, kind: &str, parameters: &Parameters) -> Result<()> {
        let (path, line) = (parameters.path.clone(), parameters.line);
        if let Some(radiance) = self.state.emitted {
            if self.object.is_some() {
                self.assembly.note(&path, line, "light of an object that instances copy left out");
            } else if kind == "sphere" {
                let world_from_lamp = self.state.world_from_here;
                let lamp = Lamp { world_from_lamp, radius: radius(parameters)?, radiance, line };
                self.assembly.note(&path, line, "a sphere that shines hides nothing and reflects nothing here");
                self.assembly.lamps.extend((radiance != Vec3::ZERO).then_some(lamp));
                return Ok(());
            } else {
                self.assembly.note(&path, line, "a shape shines, which only spheres do here: its light is left out");
            }
        }
        let Some(mut material) = self.state.surface.clone() else {
            self.assembly.note(&path, line, "a shape without a surface left out");
            return Ok(());
        };
        let Some(mesh) = mesh_of(kind, parameters, &mut self.meshes, &mut self.assembly)? else { return Ok(()) };
        if mesh.texture_coordinates.is_empty() && material.texture.take().is_some() {
            self.assembly.note(&path, line, "a texture left out: the shape has no `uv`");
        }
        let name =
            parameters.text("filename").map_or_else(|| kind.to_owned(), |file| crate::file::stem(Path::new(file)));
        let shape = Shape { name, mesh, world_from_mesh: self.state.world_from_here, material, line };
        match self.object.as_ref().and_then(|name| self.objects.get_mut(name)) {
            Some(object) => object.push(shape),
            None => self.assembly.add(shape)?,
        }
        Ok(())
    }

    fn camera(&mut self, kind: &str, parameters: &Parameters, tokens: &mut Tokens) -> Result<()> {
        let line = parameters.line;
        if kind != "perspective" {
            self.left_out(tokens, line, &format!("camera `{}` left out", kind.escape_debug()));
            return Ok(());
        }
        for name in ["screenwindow", "lensradius", "frameaspectratio"] {
            if parameters.kind(name).is_some() {
                self.left_out(tokens, line, &format!("`{name}` of the camera left out"));
            }
        }
        let world_from_camera = self.state.world_from_here.inverse();
        if !world_from_camera.is_finite() {
            return Err(parameters.error("the camera's transform has no inverse"));
        }
        self.spaces.insert("camera".to_owned(), world_from_camera);
        self.assembly.view = Some(View::new(&world_from_camera, None, line));
        self.fov = parameters.number("fov").unwrap_or(90.0);
        Ok(())
    }

    /// The scene; the film, which gives the camera its picture, may come after the camera.
    fn finish(mut self) -> Result<Scene> {
        if let Some(view) = &mut self.assembly.view {
            let [width, height] = self.resolution;
            view.resolution = [width as u32, height as u32];
            // The angle is that of the shorter side.
            view.vertical_fov_degrees = vertical_degrees(self.fov, width.min(height), height);
        }
        self.assembly.finish()
    }
}

/// The space of an eye, whose axes point to the right, up and forward, from that in which it looks at a target.
fn look_at(eye: DVec3, target: DVec3, up: DVec3) -> Option<DMat4> {
    let forward = (target - eye).try_normalize()?;
    let right = up.normalize_or_zero().cross(forward).try_normalize()?;
    let axis = |axis: DVec3| DVec4::from((axis, 0.0));
    let here = DMat4::from_cols(axis(right), axis(forward.cross(right)), axis(forward), eye.extend(1.0));
    Some(here.inverse())
}
