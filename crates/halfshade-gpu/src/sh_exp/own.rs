//! Own occlusion on the device: vectors of vertices, and where receivers lie between them.

use crate::rows::in_fours;
use halfshade_scene::Receivers;
use halfshade_strategies::sh_exp::arrays::{FrameArrays, OwnArrays, SceneArrays};

/// Added to whole numbers in rows of floats, so that none has the bits of a denormal one; as `sh_exp/own.wgsl` does.
const MARK: u32 = 0x4000_0000;

/// Bits of a number in rows of floats: those of the fraction of a float between 1 and 2.
const BITS: usize = 23;

/// Rows that `sh_exp/own.wgsl` reads.
#[derive(Debug)]
pub struct OwnRows {
    /// Vectors of vertices, each with its bits for small lights, mesh by mesh.
    vectors: Vec<[f32; 4]>,
    objects: Vec<Option<ObjectRows>>,
    receivers: Vec<ReceiverRows>,
}

/// Rows of an object that knows what its mesh hides.
#[derive(Debug, Clone, Copy)]
struct ObjectRows {
    first: usize,
    per_vertex: usize,
    knowledge: Knowledge,
}

/// How much is known, as the shader has it.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Knowledge {
    HidesNothing = 1,
    Vectors = 2,
    Bits = 3,
}

/// Where a receiver lies.
#[derive(Debug, Clone, Copy)]
struct ReceiverRows {
    /// Rows of vectors at vertices around it.
    vertices: [u32; 3],
    weights: [f32; 3],
    knowledge: Option<Knowledge>,
    cut: u32,
}

impl OwnRows {
    /// Vectors of a scene; `None` if spheres hide all objects from themselves.
    pub fn new(scene: &SceneArrays<'_>, objects: usize) -> Option<Self> {
        let own = scene.own?;
        let mut rows = Self { vectors: Vec::new(), objects: Vec::new(), receivers: Vec::new() };
        let mut known: Vec<(&[f32], ObjectRows)> = Vec::new();
        for object in 0..objects {
            let of_object = own.vectors(object).zip(own.hidden(object)).map(|(vectors, hidden)| {
                let same = known.iter().find(|(other, _)| !other.is_empty() && std::ptr::eq(*other, vectors));
                same.map(|(_, rows)| *rows).unwrap_or_else(|| {
                    let added = rows.add_mesh(scene.bands, vectors, hidden, own.grid().node_count());
                    known.push((vectors, added));
                    added
                })
            });
            rows.objects.push(of_object);
        }
        Some(rows)
    }

    fn add_mesh(&mut self, bands: usize, vectors: &[f32], hidden: &[u32], nodes: usize) -> ObjectRows {
        let (first, count) = (self.vectors.len(), bands * bands);
        if vectors.is_empty() && hidden.is_empty() {
            return ObjectRows { first, per_vertex: 0, knowledge: Knowledge::HidesNothing };
        }
        let words = nodes.div_ceil(32);
        let vertices = (vectors.len() / count).max(hidden.len() / words);
        for vertex in 0..vertices {
            let none = vec![0.0; count];
            let vector = vectors.get(vertex * count..(vertex + 1) * count).unwrap_or(&none);
            self.vectors.extend(in_fours(vector));
            if let Some(bits) = hidden.get(vertex * words..(vertex + 1) * words) {
                let bit = |node: usize| if node < nodes { (bits[node / 32] >> (node % 32)) & 1 } else { 0 };
                let number = |first: usize| (0..BITS).fold(0, |number, k| number | bit(first + k) << k);
                let numbers: Vec<f32> =
                    (0..nodes).step_by(BITS).map(|first| f32::from_bits(1.0_f32.to_bits() | number(first))).collect();
                self.vectors.extend(in_fours(&numbers));
            }
        }
        let knowledge = if hidden.is_empty() { Knowledge::Vectors } else { Knowledge::Bits };
        ObjectRows { first, per_vertex: (self.vectors.len() - first) / vertices.max(1), knowledge }
    }

    /// Forgets all receivers.
    pub fn clear(&mut self) {
        self.receivers.clear();
    }

    /// Adds receivers, each with its cut; gives the number by which the first finds its rows. Those of the next are two more.
    pub fn add(&mut self, own: &OwnArrays<'_>, receivers: Receivers<'_>, cut: &dyn Fn(usize) -> u32) -> u32 {
        let first = 2 * self.receivers.len() as u32;
        let row = |i: usize| {
            let object = receivers.object[i] as usize;
            let mut row = ReceiverRows { vertices: [0; 3], weights: [0.0; 3], knowledge: None, cut: cut(i) };
            let around = own.vertices_around(object, receivers.surface[i]);
            if let Some((around, rows)) = around.zip(self.objects.get(object).copied().flatten()) {
                row.knowledge = Some(rows.knowledge);
                for (k, (vertex, weight)) in around.parts().enumerate() {
                    (row.vertices[k], row.weights[k]) = ((rows.first + rows.per_vertex * vertex) as u32, weight);
                }
            }
            row
        };
        let added: Vec<_> = (0..receivers.len()).map(row).collect();
        self.receivers.extend(added);
        first
    }

    /// The row, counted from the first, at which receivers begin.
    pub fn first_receiver(&self) -> usize {
        self.vectors.len()
    }

    /// All rows, of which the first is to be row `at`.
    pub fn rows(&self, at: u32) -> impl Iterator<Item = [f32; 4]> {
        let of_receiver = move |receiver: &ReceiverRows| {
            let [a, b, c] = receiver.vertices.map(|row| row + at);
            let numbers = [a, b, c, receiver.cut].map(|number| f32::from_bits(number + MARK));
            let [u, v, w] = receiver.weights;
            [numbers, [u, v, w, receiver.knowledge.map_or(0.0, |knowledge| f32::from(knowledge as u8))]]
        };
        self.vectors.iter().copied().chain(self.receivers.iter().flat_map(of_receiver))
    }
}

/// Adds to `numbers` the rotations of all objects into light space, and their spheres; gives the places at which both begin.
pub(super) fn add_objects(numbers: &mut Vec<u32>, bands: usize, frame: &FrameArrays<'_>) -> [u32; 2] {
    let rotations = numbers.len();
    let padded = (0..bands).map(|l| (2 * l + 1) * (2 * l + 1)).sum::<usize>().next_multiple_of(4);
    for (object, blocks) in frame.own_rotations.iter().enumerate() {
        numbers.extend(blocks.iter().map(|value| value.to_bits()));
        numbers.resize(rotations + (object + 1) * padded, 0);
    }
    let spheres = numbers.len();
    numbers.extend(frame.own_spheres.iter().flat_map(|spheres| [spheres.first, spheres.count]));
    [rotations as u32, spheres as u32]
}
