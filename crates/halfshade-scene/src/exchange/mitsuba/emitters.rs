//! Light of a scene file.

use super::element::{Elements, line};
use super::map_image;
use crate::SceneError;
use crate::exchange::assembly::{Assembly, Distant, Lamp, half_turn};
use crate::exchange::values::radiance;
use crate::light::{EnvironmentMap, load_picture};
use glam::{DMat4, Vec3};
use roxmltree::Node;

type Result<T> = std::result::Result<T, SceneError>;

/// Adds an emitter that stands by itself.
pub(super) fn emitter<'a, 'input>(
    elements: &Elements<'a, 'input>,
    node: Node<'a, 'input>,
    assembly: &mut Assembly,
) -> Result<()> {
    let kind = elements.kind(node);
    let distant = match &*kind {
        "constant" => Distant::Constant(emitted(elements, node)?),
        "envmap" => environment_map(elements, node, assembly)?,
        _ => {
            assembly.note(elements.path, line(node), &format!("emitter `{kind}` left out"));
            return Ok(());
        }
    };
    if assembly.distant.is_some() {
        assembly.note(elements.path, line(node), "a second environment left out");
        return Ok(());
    }
    assembly.distant = Some(distant);
    Ok(())
}

/// The light of a sphere, unless it is black.
pub(super) fn lamp<'a, 'input>(
    elements: &Elements<'a, 'input>,
    shape: Node<'a, 'input>,
    emitter: Node<'a, 'input>,
    world_from_shape: DMat4,
) -> Result<Option<Lamp>> {
    let center = elements.property(shape, "center").map(|node| elements.vector(node, 0.0)).transpose()?;
    let radiance = emitted(elements, emitter)?;
    let lamp = Lamp {
        world_from_lamp: world_from_shape * DMat4::from_translation(center.unwrap_or_default()),
        radius: elements.number(shape, "radius")?.unwrap_or(1.0),
        radiance,
        line: line(shape),
    };
    Ok((radiance != Vec3::ZERO).then_some(lamp))
}

fn emitted<'a, 'input>(elements: &Elements<'a, 'input>, node: Node<'a, 'input>) -> Result<Vec3> {
    let color = elements.color(node, "radiance")?.unwrap_or(Vec3::ONE);
    radiance(color).map_err(|problem| elements.error(node, problem))
}

fn environment_map<'a, 'input>(
    elements: &Elements<'a, 'input>,
    node: Node<'a, 'input>,
    assembly: &mut Assembly,
) -> Result<Distant> {
    let name = elements.text(node, "filename").ok_or_else(|| elements.error(node, "an envmap names no file"))?;
    let path = elements.path.parent().map_or_else(|| (&name).into(), |folder| folder.join(&name));
    let about = |error: SceneError| match path.is_file() {
        true => error,
        false => elements.error(node, error.to_string()),
    };
    let ([width, height], pixels, notes) = load_picture(&path).map_err(about)?;
    assembly.note_all(&path, notes);
    let image = map_image::Image { width, height, pixels };
    let map = map_image::map(&image).or_else(|| {
        let note = "Mitsuba interpolates the environment: pixels of constant radiance stand for it here";
        assembly.note(elements.path, line(node), note);
        EnvironmentMap::new(width, height, image.pixels)
    });
    let map = map.ok_or_else(|| elements.error(node, "the environment has no pixels"))?;
    let scale = elements.number(node, "scale")?.unwrap_or(1.0) as f32;
    let map = if scale == 1.0 { map } else { map.scaled(scale) };
    if map.texels().iter().any(|texel| radiance(*texel).is_err()) {
        return Err(elements.error(node, format!("scale = {scale} makes radiance that is none")));
    }
    let world_from_map = elements.transform(node, "to_world")?.matrix * half_turn();
    Ok(Distant::Map { map, world_from_map })
}
