//! Faces and triangle strips of a PLY file.

use super::header::{Element, Type};
use super::payload::Payload;
use crate::SceneError;
use std::collections::HashMap;

/// Names of the list of a face's or a strip's vertices.
const CORNERS: &[&str] = &["vertex_indices", "vertex_index"];

/// The list of texture coordinates of a face's corners: u and v of each.
const COORDINATES: &str = "texcoord";

/// Faces, as read.
#[derive(Debug, Default)]
pub(super) struct Faces {
    /// The vertices of all corners.
    pub(super) corners: Vec<u32>,
    /// End of each face's corners.
    pub(super) ends: Vec<usize>,
    /// The distinct texture coordinates of corners: u, and v upward.
    pub(super) coordinates: Vec<[f64; 2]>,
    /// One more than the place in `coordinates`, of each corner; 0: none.
    pub(super) coordinate_of: Vec<u32>,
    number_of: HashMap<[u64; 2], u32>,
    pub(super) notes: Vec<String>,
}

impl Faces {
    /// Adds the faces of an element, or the strips.
    pub(super) fn read(
        &mut self,
        payload: &mut Payload<'_>,
        element: &Element,
        vertex_count: usize,
    ) -> Result<(), SceneError> {
        let is_strip = element.name == "tristrips";
        let what = if is_strip { "strip" } else { "face" };
        let Some(list) =
            element.properties.iter().position(|p| CORNERS.contains(&p.name.as_str()) && p.length.is_some())
        else {
            let properties = element.properties.iter().map(|p| p.name.as_str()).collect::<Vec<_>>().join(", ");
            return Err(SceneError::new(format!("a {what} has no list `vertex_indices`, but: {properties}"))
                .with_remedy("export the mesh again"));
        };
        let wedges = element.properties.iter().position(|p| p.name == COORDINATES && p.length.is_some());
        let is_known = |place: usize| place == list || Some(place) == wedges;
        let others: Vec<_> = (0..element.properties.len())
            .filter(|&place| !is_known(place))
            .map(|i| element.properties[i].name.as_str())
            .collect();
        if !others.is_empty() && element.count > 0 {
            self.notes.push(format!("properties of {what}s left out: {}", others.join(", ")));
        }
        let (mut corners, mut coordinates) = (Vec::new(), Vec::new());
        for index in 0..element.count {
            payload.begin();
            let line = payload.line();
            coordinates.clear();
            for (place, property) in element.properties.iter().enumerate() {
                let into = if place == list {
                    Some(&mut corners)
                } else if Some(place) == wedges {
                    Some(&mut coordinates)
                } else {
                    None
                };
                let count = match property.length {
                    Some(length) => payload.length(length, property.of, &property.name)?,
                    None => 1,
                };
                match into {
                    Some(into) => {
                        into.clear();
                        for _ in 0..count {
                            into.push(payload.number(property.of, &property.name)?);
                        }
                    }
                    None => {
                        for _ in 0..count {
                            payload.number(property.of, &property.name)?;
                        }
                    }
                }
            }
            payload.end()?;
            let added = if is_strip {
                self.add_strip(&corners, element.properties[list].of, vertex_count)
            } else {
                self.add_face(&corners, &coordinates, vertex_count)
            };
            added.map_err(|problem| {
                let error = SceneError::new(format!("{what} {index} {problem}")).with_remedy("export the mesh again");
                SceneError { line, ..error }
            })?;
        }
        Ok(())
    }

    fn add_face(&mut self, corners: &[f64], coordinates: &[f64], vertex_count: usize) -> Result<(), String> {
        if corners.len() < 3 {
            return Err(format!("has {} corners instead of at least three", corners.len()));
        }
        if !coordinates.is_empty() && coordinates.len() != 2 * corners.len() {
            return Err(format!("has {} corners, but {} numbers in `{COORDINATES}`", corners.len(), coordinates.len()));
        }
        if let Some(bad) = coordinates.iter().find(|value| !value.is_finite()) {
            return Err(format!("has a texture coordinate that is not a finite number: {bad}"));
        }
        for &corner in corners {
            self.corners.push(vertex(corner, vertex_count)?);
        }
        for place in coordinates.chunks_exact(2) {
            let next = self.coordinates.len() as u32;
            let number = *self.number_of.entry([place[0].to_bits(), place[1].to_bits()]).or_insert(next);
            if number == next {
                self.coordinates.push([place[0], place[1]]);
            }
            // Faces before that had none.
            self.coordinate_of.resize(self.coordinate_of.len().max(self.corners.len() - corners.len()), 0);
            self.coordinate_of.push(number + 1);
        }
        self.ends.push(self.corners.len());
        Ok(())
    }

    /// Adds the triangles of a strip: each three vertices in a row, every other one turned around; -1 begins anew.
    fn add_strip(&mut self, corners: &[f64], of: Type, vertex_count: usize) -> Result<(), String> {
        // As an unsigned type has it.
        let largest = of.range().map_or(-1.0, |(low, high)| if low < 0 { -1.0 } else { high as f64 });
        let begins_anew = |corner: f64| corner == -1.0 || (corner == largest && largest >= vertex_count as f64);
        for strip in corners.split(|&corner| begins_anew(corner)) {
            let strip = strip.iter().map(|&corner| vertex(corner, vertex_count)).collect::<Result<Vec<_>, _>>()?;
            for (number, triangle) in strip.windows(3).enumerate() {
                let [a, b, c] = [triangle[0], triangle[1], triangle[2]];
                // Strips turn corners by triangles without an area.
                if a != b && b != c && c != a {
                    self.corners.extend(if number % 2 == 0 { [a, b, c] } else { [b, a, c] });
                    self.ends.push(self.corners.len());
                }
            }
        }
        Ok(())
    }
}

/// The number of a vertex.
fn vertex(number: f64, count: usize) -> Result<u32, String> {
    if number.fract() == 0.0 && number >= 0.0 && number < count as f64 && number < f64::from(u32::MAX) {
        Ok(number as u32)
    } else {
        Err(format!("names vertex {number}, but there are {count}, counted from 0"))
    }
}
