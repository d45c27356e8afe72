//! The vertices of a PLY file.

use super::header::{Element, Property, Type};
use super::payload::Payload;
use crate::SceneError;
use crate::mesh::colors::{ColorNumbers, FileColors};
use glam::{DVec3, Vec3};

/// Places of values of a vertex.
const POSITION: usize = 0;
const NORMAL: usize = 3;
const COORDINATE: usize = 6;
const COLOR: usize = 8;
const ALPHA: usize = 11;
const VALUES: usize = 12;

/// Names of properties that only together mean something, with the first of their places. In a file they may be in
/// capitals.
const FAMILIES: &[(usize, &[&str])] = &[
    (POSITION, &["x", "y", "z"]),
    (NORMAL, &["nx", "ny", "nz"]),
    (COORDINATE, &["u", "v"]),
    (COORDINATE, &["s", "t"]),
    (COORDINATE, &["texture_u", "texture_v"]),
    (COORDINATE, &["tx", "ty"]),
    (COORDINATE, &["texcoord_u", "texcoord_v"]),
    (COLOR, &["red", "green", "blue"]),
    (COLOR, &["diffuse_red", "diffuse_green", "diffuse_blue"]),
    (COLOR, &["r", "g", "b"]),
];

const ALPHAS: &[&str] = &["alpha", "diffuse_alpha", "a"];

/// Vertices, as read.
#[derive(Debug, Default)]
pub(super) struct Vertices {
    pub(super) positions: Vec<Vec3>,
    /// Empty, or one per position, zero where it is no direction.
    pub(super) normals: Vec<Vec3>,
    pub(super) colors: Option<FileColors>,
    /// Empty, or one per position: u, and v upward.
    pub(super) coordinates: Vec<[f64; 2]>,
    /// Lines in a text.
    pub(super) lines: Vec<usize>,
    pub(super) notes: Vec<String>,
}

/// Assignment of an element's properties to values of a vertex.
struct Layout<'a> {
    element: &'a Element,
    /// Place of each property's value, where it is read.
    places: Vec<Option<usize>>,
    is_there: [bool; VALUES],
    /// The property that is alpha.
    alpha: Option<usize>,
    /// The kind of number of the colours, and their type.
    colors: Option<(ColorNumbers, Type)>,
    notes: Vec<String>,
}

impl<'a> Layout<'a> {
    fn new(element: &'a Element) -> Result<Self, SceneError> {
        let place_of = |name: &str| element.properties.iter().position(|p| p.name.eq_ignore_ascii_case(name));
        for axis in ["x", "y", "z"] {
            if place_of(axis).is_none() {
                return Err(SceneError::new(format!("the header declares no property `{axis}` for the vertices"))
                    .with_remedy("export the mesh again"));
            }
        }
        // The first family of a kind that is there counts.
        let mut places: Vec<Option<usize>> = vec![None; element.properties.len()];
        let mut is_there = [false; VALUES];
        let (mut notes, mut is_noted) = (Vec::new(), vec![false; element.properties.len()]);
        for &(first, names) in FAMILIES {
            let found: Vec<usize> = names.iter().filter_map(|name| place_of(name)).collect();
            if found.len() < names.len() {
                if !found.is_empty() {
                    found.iter().for_each(|&place| is_noted[place] = true);
                    let there =
                        found.iter().map(|&i| element.properties[i].name.as_str()).collect::<Vec<_>>().join(", ");
                    notes.push(format!(
                        "properties of vertices left out, since others of {} are missing: {there}",
                        names.join(", ")
                    ));
                }
            } else if !is_there[first] {
                for (axis, &place) in found.iter().enumerate() {
                    places[place] = Some(first + axis);
                    is_there[first + axis] = true;
                }
            }
        }
        let alpha = ALPHAS.iter().find_map(|name| place_of(name));
        if let Some(alpha) = alpha {
            places[alpha] = Some(ALPHA);
        }
        let mut read = element.properties.iter().zip(&places);
        let list = read.find(|(property, place)| place.is_some() && property.length.is_some());
        if let Some((property, _)) = list {
            return Err(SceneError::new(format!("the header declares `{}` of the vertices a list", property.name))
                .with_remedy("export the mesh again"));
        }
        let left_out: Vec<_> = element
            .properties
            .iter()
            .zip(places.iter().zip(&is_noted))
            .filter(|(_, (place, is_noted))| place.is_none() && !**is_noted)
            .map(|(p, _)| p.name.as_str())
            .collect();
        if !left_out.is_empty() {
            notes.push(format!("properties of vertices left out: {}", left_out.join(", ")));
        }
        let colors = if is_there[COLOR] { Some(color_numbers(&element.properties, &places)?) } else { None };
        Ok(Self { element, places, is_there, alpha, colors, notes })
    }

    /// Reads the values of one vertex; the places of those that the file doesn't have stay as they are.
    fn read(&self, payload: &mut Payload<'_>, values: &mut [f64; VALUES]) -> Result<(), SceneError> {
        for (property, place) in self.element.properties.iter().zip(&self.places) {
            match (property.length, place) {
                (None, Some(place)) => values[*place] = payload.number(property.of, &property.name)?,
                (None, None) => drop(payload.number(property.of, &property.name)?),
                (Some(length), _) => {
                    for _ in 0..payload.length(length, property.of, &property.name)? {
                        payload.number(property.of, &property.name)?;
                    }
                }
            }
        }
        payload.end()
    }
}

impl Vertices {
    pub(super) fn read(payload: &mut Payload<'_>, element: &Element) -> Result<Self, SceneError> {
        let layout = Layout::new(element)?;
        let mut vertices = Self::default();
        // The count has been held against the file's length.
        vertices.positions.reserve_exact(element.count);
        let mut values = [0.0; VALUES];
        let mut colored = Vec::new();
        let (mut no_directions, mut transparent, mut wrapped) = (0, 0, 0);
        for _ in 0..element.count {
            payload.begin();
            vertices.lines.extend(payload.line());
            layout.read(payload, &mut values)?;
            let vector = |first: usize| DVec3::from_slice(&values[first..]).as_vec3();
            vertices.positions.push(vector(POSITION));
            if layout.is_there[NORMAL] {
                let normal = vector(NORMAL);
                let is_direction = normal.is_finite() && normal != Vec3::ZERO;
                no_directions += usize::from(!is_direction);
                vertices.normals.push(if is_direction { normal } else { Vec3::ZERO });
            }
            if layout.is_there[COORDINATE] {
                vertices.coordinates.push([values[COORDINATE], values[COORDINATE + 1]]);
            }
            if let Some((_, of)) = layout.colors {
                // A byte that was declared signed.
                let unwrapped = |value: f32| if of == Type::Char && value < 0.0 { value + 256.0 } else { value };
                let color = vector(COLOR);
                wrapped += usize::from(of == Type::Char && color.min_element() < 0.0);
                colored.push(Some(color.map(unwrapped)));
            }
            if let Some(alpha) = layout.alpha {
                let of = element.properties[alpha].of;
                let opaque = if of.range().is_some() { 255.0 } else { 0.999 };
                let value = values[ALPHA];
                transparent += usize::from(value < opaque && !(of == Type::Char && value == -1.0));
            }
        }
        vertices.colors = layout.colors.map(|(numbers, _)| FileColors { numbers, values: colored });
        vertices.notes = layout.notes;
        for (count, what) in [
            (no_directions, "normals that are no directions, computed instead"),
            (transparent, "alpha of vertex colours left out, every vertex is opaque"),
            (wrapped, "vertex colours of signed bytes below 0 taken for unsigned ones"),
        ] {
            if count > 0 {
                vertices.notes.push(format!("{what}: {count}"));
            }
        }
        Ok(vertices)
    }
}

/// The kind of number of the colours, and their type.
fn color_numbers(properties: &[Property], places: &[Option<usize>]) -> Result<(ColorNumbers, Type), SceneError> {
    let is_color = |place: &Option<usize>| place.is_some_and(|place| (COLOR..ALPHA).contains(&place));
    let types: Vec<Type> =
        properties.iter().zip(places).filter(|(_, place)| is_color(place)).map(|(p, _)| p.of).collect();
    let numbers = |of: Type| match of {
        Type::Char | Type::UChar => ColorNumbers::Bytes,
        Type::Float | Type::Double => ColorNumbers::Floats,
        _ => ColorNumbers::Wide,
    };
    let first = types[0];
    if types.iter().any(|&of| of != first) {
        return Err(SceneError::new("red, green and blue of the vertices are of different types")
            .with_remedy("export the mesh again"));
    }
    Ok((numbers(first), first))
}
