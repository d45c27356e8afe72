//! Scenes of Mitsuba, as far as they can be scenes here.

use super::element::{Elements, line};
use super::{emitters, import_materials::Materials, import_shapes::mesh_of};
use crate::exchange::assembly::{Assembly, Shape};
use crate::exchange::view::{View, vertical_degrees};
use crate::{Scene, SceneError, input, text};
use glam::{DMat4, DVec3};
use roxmltree::{Document, Node, ParsingOptions};
use std::collections::BTreeMap;
use std::path::Path;

type Result<T> = std::result::Result<T, SceneError>;

/// Most elements and pieces of text of a scene.
const MOST_NODES: u32 = 1 << 20;

/// Side of pictures of Mitsuba that don't say how large they are.
const DEFAULT_SIZE: [f64; 2] = [768.0, 576.0];

/// Reads a scene file of Mitsuba 2 or 3, or of version 0.6, and all that it names; sphere sets are not built yet.
///
/// Shapes `ply`, `obj`, `rectangle`, `cube` and `sphere`; spheres that are `area` emitters as lights; emitters `constant`
/// and `envmap`; BSDFs `diffuse`, `twosided`, `phong` and those of [`super::export`]; the first `perspective` sensor;
/// transforms; the integrator's depth. The scene is turned so that +Y is up in its picture. [`Scene::notes`] tell file and
/// line of everything else.
pub fn load(path: &Path) -> Result<Scene> {
    let bytes = input::read(path).map_err(|error| SceneError::new(format!("cannot be read: {error}")).in_file(path))?;
    let text = text::decode(&bytes).map_err(|error| error.in_file(path))?;
    let options = ParsingOptions { nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| {
        let problem = format!("this is no sound XML: {error}");
        SceneError::new(problem).in_file(path).at_line(error.pos().row as usize)
    })?;
    let root = document.root_element();
    if !root.has_tag_name("scene") {
        let problem = format!("the outermost element is `{}`, not `scene` as Mitsuba's", root.tag_name().name());
        return Err(SceneError::new(problem).in_file(path).at_line(line(root)));
    }
    let defaults = root.children().filter(|child| child.has_tag_name("default"));
    let defaults =
        defaults.filter_map(|child| Some((child.attribute("name")?.into(), child.attribute("value")?.into())));
    let ids = document.descendants().filter_map(|node| Some((node.attribute("id")?, node)));
    let ids = ids.filter(|(_, node)| !node.has_tag_name("ref")).collect();
    let elements = Elements { path, defaults: defaults.collect::<BTreeMap<_, _>>(), ids };
    let mut assembly = Assembly::new(path);
    let mut materials = Materials::default();
    let children: Vec<Node<'_, '_>> = root.children().filter(Node::is_element).collect();
    for node in &children {
        read(&elements, *node, &mut assembly, &mut materials)?;
    }
    assembly.finish()
}

fn read<'a, 'input>(
    elements: &Elements<'a, 'input>,
    node: Node<'a, 'input>,
    assembly: &mut Assembly,
    materials: &mut Materials,
) -> Result<()> {
    let kind = elements.kind(node);
    match (node.tag_name().name(), &*kind) {
        ("shape", _) => shape(elements, node, assembly, materials),
        ("emitter", _) => emitters::emitter(elements, node, assembly),
        ("integrator", _) => integrator(elements, node, assembly),
        ("sensor", "perspective" | "thinlens") if assembly.view.is_none() => {
            if kind == "thinlens" {
                assembly.note(elements.path, line(node), "the lens of `thinlens` is a pinhole here");
            }
            assembly.view = Some(view(elements, node)?);
            Ok(())
        }
        // Others refer to these.
        ("default" | "bsdf" | "texture", _) => Ok(()),
        (tag, "") => {
            assembly.note(elements.path, line(node), &format!("element `{tag}` left out"));
            Ok(())
        }
        (tag, kind) => {
            assembly.note(elements.path, line(node), &format!("{tag} `{kind}` left out"));
            Ok(())
        }
    }
}

fn shape<'a, 'input>(
    elements: &Elements<'a, 'input>,
    node: Node<'a, 'input>,
    assembly: &mut Assembly,
    materials: &mut Materials,
) -> Result<()> {
    let world_from_shape = elements.transform(node, "to_world")?.matrix;
    let emitter = elements.child(node, "emitter");
    let kind = elements.kind(node);
    let name = node.attribute("id").map_or_else(|| kind.clone().into_owned(), str::to_owned);
    if let Some(emitter) = emitter {
        if kind == "sphere" && elements.kind(emitter) == "area" {
            let lamp = emitters::lamp(elements, node, emitter, world_from_shape)?;
            let blocks = elements.child(node, "bsdf").is_none_or(|bsdf| elements.kind(bsdf) != "null");
            if blocks {
                assembly.note(
                    elements.path,
                    line(node),
                    "a sphere that shines hides nothing and reflects nothing here",
                );
            }
            assembly.lamps.extend(lamp);
            return Ok(());
        }
        let note = format!("shape `{name}` shines, which only spheres do here: its light is left out");
        assembly.note(elements.path, line(emitter), &note);
    }
    let Some(mut mesh) = mesh_of(elements, node, assembly)? else { return Ok(()) };
    let material = materials.of(elements, node, &mut mesh, assembly)?;
    assembly.add(Shape { name, mesh, world_from_mesh: world_from_shape, material, line: line(node) })
}

fn integrator<'a, 'input>(
    elements: &Elements<'a, 'input>,
    node: Node<'a, 'input>,
    assembly: &mut Assembly,
) -> Result<()> {
    let kind = elements.kind(node);
    assembly.bounces = match &*kind {
        "direct" => Some(0),
        "path" | "volpath" | "volpathmis" | "prb" | "prbvolpath" => match elements.number(node, "max_depth")? {
            Some(depth) if depth >= 0.0 => Some((depth as usize).saturating_sub(2)),
            _ => None,
        },
        _ => {
            assembly.note(elements.path, line(node), &format!("integrator `{kind}` left out: direct light alone"));
            Some(0)
        }
    };
    Ok(())
}

fn view<'a, 'input>(elements: &Elements<'a, 'input>, node: Node<'a, 'input>) -> Result<View> {
    let transform = elements.transform(node, "to_world")?;
    // Mitsuba's first axis points to the left.
    let to_right = DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    let mut view = View::new(&(transform.matrix * to_right), transform.target, line(node));
    let film = elements.child(node, "film");
    let side = |name: &str, default: f64| match film {
        Some(film) => Ok(elements.number(film, name)?.unwrap_or(default)),
        None => Ok(default),
    };
    let (width, height) = (side("width", DEFAULT_SIZE[0])?, side("height", DEFAULT_SIZE[1])?);
    // Casts saturate: what can't be a side is refused with the camera.
    view.resolution = [width as u32, height as u32];
    let axis = elements.text(node, "fov_axis").unwrap_or_else(|| "x".to_owned());
    let across = match axis.as_str() {
        "x" => width,
        "y" => height,
        "smaller" => width.min(height),
        "larger" => width.max(height),
        "diagonal" => width.hypot(height),
        other => return Err(elements.error(node, format!("fov_axis = `{}` is none", other.escape_debug()))),
    };
    let fov = match elements.number(node, "fov")? {
        Some(fov) => (fov, across),
        // A 50 mm lens over the diagonal of 35 mm film.
        None => (2.0 * (0.5 * 36.0_f64.hypot(24.0) / 50.0).atan().to_degrees(), width.hypot(height)),
    };
    view.vertical_fov_degrees = vertical_degrees(fov.0, fov.1, height);
    Ok(view)
}
