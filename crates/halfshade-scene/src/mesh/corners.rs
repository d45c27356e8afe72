//! Vertices for the corners of faces, in formats that number positions, texture coordinates and normals apart.

use std::collections::HashMap;

/// Indices that a corner names, counted from 1; 0: none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Corner {
    /// Its position, never 0.
    pub(super) position: u32,
    pub(super) coordinate: u32,
    pub(super) normal: u32,
}

/// One vertex for each combination that corners name, in the order of first use.
#[derive(Debug)]
pub(super) struct Corners {
    vertices: Vec<Corner>,
    /// One more than the vertex of the first combination of each position; 0: none yet.
    first: Vec<u32>,
    /// The vertices of all others.
    others: HashMap<Corner, u32>,
}

impl Corners {
    pub(super) fn new(position_count: usize) -> Self {
        Self { vertices: Vec::with_capacity(position_count), first: vec![0; position_count], others: HashMap::new() }
    }

    /// The vertex of a corner.
    pub(super) fn vertex(&mut self, corner: Corner) -> u32 {
        let next = self.vertices.len() as u32;
        let first = &mut self.first[corner.position as usize - 1];
        let vertex = match *first {
            0 => {
                *first = next + 1;
                next
            }
            known if self.vertices[known as usize - 1] == corner => known - 1,
            _ => *self.others.entry(corner).or_insert(next),
        };
        if vertex == next {
            self.vertices.push(corner);
        }
        vertex
    }

    /// Indices that each vertex names.
    pub(super) fn vertices(&self) -> &[Corner] {
        &self.vertices
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_combination_has_one_vertex() {
        let mut corners = Corners::new(2);
        let named = [(1, 0, 0), (2, 1, 1), (1, 0, 0), (1, 2, 0), (2, 1, 2), (1, 2, 0), (2, 1, 1)];
        let named = named.map(|(position, coordinate, normal)| Corner { position, coordinate, normal });
        assert_eq!(named.map(|corner| corners.vertex(corner)), [0, 1, 0, 2, 3, 2, 1]);
        assert_eq!(corners.vertices(), [named[0], named[1], named[3], named[4]]);
    }
}
