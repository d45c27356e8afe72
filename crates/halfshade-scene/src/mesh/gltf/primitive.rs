//! Primitives: what a mesh of a document is made of.

use super::Buffers;
use super::accessor::{WholeNumbers, any_numbers, indices, numbers, of_count, vectors};
use super::extensions;
use super::material::{Coverage, Surface};
use super::morph::Target;
use super::textures::Textures;
use crate::SceneError;
use crate::mesh::assemble::{RawMesh, RawShift};
use ::gltf::accessor::Dimensions;
use ::gltf::mesh::Mode;
use ::gltf::{Accessor, Primitive, Semantic};
use glam::{DMat3, DMat4, DVec2, DVec3, DVec4, Vec2, Vec3};

/// Most vertices, and most triangles, of all copies of all meshes together: what a small file has in many places must not
/// fill memory.
const MOST: usize = 1 << 25;

/// The number of a mask that isn't there.
const NO_MASK: f32 = u32::MAX as f32;

/// A primitive as the document has it, in the space of its mesh.
pub(super) struct Part<'a> {
    positions: Vec<DVec3>,
    /// Zero where one is of no use; without them, each triangle is flat.
    normals: Option<Vec<DVec3>>,
    /// Linear colour and alpha; empty, or one per position.
    colors: Vec<DVec4>,
    /// Coordinates of its texture; empty without one.
    coordinates: Vec<DVec2>,
    triangles: Vec<[u32; 3]>,
    /// Indices after the last whole triangle.
    pub(super) left_over: usize,
    pub(super) targets: Vec<Target>,
    surface: Surface<'a>,
}

/// Placement of the vertices of a primitive.
pub(super) enum Placement<'a> {
    /// All where a matrix takes them.
    Rigid(DMat4),
    /// Each where its own matrix takes it.
    Each(&'a [DMat4]),
}

/// Result of putting a primitive into a mesh.
pub(super) struct Placed {
    /// Vertex of the primitive by new vertex.
    pub(super) sources: Vec<u32>,
    pub(super) coverage: Coverage,
}

impl<'a> Part<'a> {
    /// Reads a primitive; `None` of one that has no triangles, but points or lines.
    pub(super) fn read(primitive: &Primitive<'a>, buffers: &Buffers) -> Result<Option<Self>, SceneError> {
        if !matches!(primitive.mode(), Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            return Ok(None);
        }
        let attribute = |semantic: &Semantic| primitive.get(semantic);
        let Some(accessor) = attribute(&Semantic::Positions) else {
            return Err(SceneError::new("a primitive has no POSITION"));
        };
        let draco = extensions::COMPRESSIONS[0];
        if primitive.extension_value(draco).is_some() && buffers.is_zero(accessor.index()) {
            return Err(extensions::compressed(draco));
        }
        let positions = vectors(&accessor, buffers).map_err(|error| about(&Semantic::Positions, error))?;
        let count = positions.len();
        let normals = attribute(&Semantic::Normals).map(|accessor| {
            // Normals that aren't finite are of no use, but there are smooth ones to put in their place.
            let list = any_numbers::<3>(&accessor, buffers, Dimensions::Vec3, WholeNumbers::AsDeclared)?;
            let sound = |n: [f64; 3]| DVec3::from(n).normalize_or_zero();
            of_count(list.into_iter().map(sound).collect(), count)
        });
        let normals = normals.transpose().map_err(|error| about(&Semantic::Normals, error))?;
        let colors = attribute(&Semantic::Colors(0)).map(|a| of_count(colors(&a, buffers)?, count)).transpose();
        let colors = colors.map_err(|error| about(&Semantic::Colors(0), error))?.unwrap_or_default();
        let surface = Surface::new(&primitive.material());
        let coordinates = match surface.coordinates() {
            None => Vec::new(),
            Some(semantic) => {
                let accessor = attribute(&semantic).ok_or_else(|| {
                    SceneError::new(format!("a primitive has a texture, but no {}", semantic.to_string()))
                        .with_remedy("export texture coordinates, or leave the texture out")
                })?;
                let whole = if buffers.is_quantized { WholeNumbers::AsDeclared } else { WholeNumbers::Fraction };
                let list = numbers::<2>(&accessor, buffers, Dimensions::Vec2, whole);
                list.and_then(|list| of_count(list.into_iter().map(|place| surface.placed(place)).collect(), count))
                    .map_err(|error| about(&semantic, error))?
            }
        };
        let indices = match primitive.indices() {
            Some(accessor) => indices(&accessor, buffers)?,
            None => (0..count as u32).collect(),
        };
        if let Some(index) = indices.iter().find(|&&index| index as usize >= count) {
            return Err(SceneError::new(format!("vertex {index} is named, but there are only {count}"))
                .with_remedy("the file was damaged or written wrongly: export it again"));
        }
        let triangles: Vec<[u32; 3]> = triangles(primitive.mode(), &indices).collect();
        let left_over = if primitive.mode() == Mode::Triangles { indices.len() % 3 } else { 0 };
        let targets = primitive.morph_targets().enumerate().map(|(number, target)| {
            Target::read(&target, buffers, count)
                .map_err(|error| SceneError { problem: format!("morph target {number}: {}", error.problem), ..error })
        });
        let targets = targets.collect::<Result<_, _>>()?;
        Ok(Some(Self { positions, normals, colors, coordinates, triangles, left_over, targets, surface }))
    }

    pub(super) fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// Whether it has normals of its own.
    pub(super) fn is_flat(&self) -> bool {
        self.normals.is_none()
    }

    /// Moves vertices and normals as morph targets with these weights do; weights that are missing are 0.
    pub(super) fn morph(&mut self, weights: &[f64]) {
        for (target, &weight) in self.targets.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
            for (position, shift) in self.positions.iter_mut().zip(&target.positions) {
                *position += weight * *shift;
            }
            for (normal, shift) in self.normals.iter_mut().flatten().zip(&target.normals) {
                *normal += weight * *shift;
            }
        }
    }

    /// Shifts of the vertices of a placed primitive by a morph target, the first of which has the number `offset`.
    ///
    /// A shift of normals is relative to the length that the normal has before it is made a unit one.
    pub(super) fn shifts(
        &self,
        target: &Target,
        placement: &Placement<'_>,
        sources: &[u32],
        offset: usize,
    ) -> impl Iterator<Item = RawShift> {
        sources.iter().enumerate().filter_map(move |(place, &vertex)| {
            let of = |list: &[DVec3]| list.get(vertex as usize).copied().unwrap_or(DVec3::ZERO);
            let (position, normal) = (of(&target.positions), of(&target.normals));
            if position == DVec3::ZERO && normal == DVec3::ZERO {
                return None;
            }
            let matrix = placement.of(vertex);
            let turned = cofactors(matrix);
            let from = turned * self.normals.as_ref().map_or(DVec3::ZERO, |normals| normals[vertex as usize]);
            let normal = (turned * normal) / from.length();
            Some(RawShift {
                vertex: (offset + place) as u32,
                position: matrix.transform_vector3(position).as_vec3(),
                normal: if normal.is_finite() { normal.as_vec3() } else { Vec3::ZERO },
                from: from.as_vec3(),
            })
        })
    }

    /// Adds the primitive to a mesh.
    pub(super) fn place(
        &self,
        placement: &Placement<'_>,
        textures: &mut Textures<'_>,
        buffers: &Buffers,
        raw: &mut RawMesh,
    ) -> Result<Placed, SceneError> {
        let alphas = (0..self.colors.len().max(1)).map(|v| self.alpha(v as u32));
        let bounds = alphas.fold([f32::INFINITY, 0.0_f32], |[least, most], a| [least.min(a), most.max(a)]);
        let coverage = self.surface.coverage(bounds, textures, buffers)?;
        // Alpha of a texture only lowers that of the vertices.
        let is_left = |triangle: &&[u32; 3]| match coverage {
            Coverage::Masked(mask) => triangle.iter().any(|&v| self.alpha(v) >= textures.masks[mask].cutoff),
            Coverage::Gone => false,
            Coverage::Whole | Coverage::Blended => true,
        };
        let triangles: Vec<[u32; 3]> = self.triangles.iter().filter(is_left).copied().collect();
        // A flat triangle has corners of its own.
        let sources: Vec<u32> =
            if self.is_flat() { triangles.as_flattened().to_vec() } else { (0..self.positions.len() as u32).collect() };
        for (count, what) in
            [(raw.positions.len() + sources.len(), "vertices"), (raw.triangles.len() + triangles.len(), "triangles")]
        {
            if count > MOST {
                return Err(SceneError::new(format!("all meshes and their copies have more than {MOST} {what}"))
                    .with_remedy("export fewer copies, or parts of the scene as files of their own"));
            }
        }
        let offset = raw.positions.len() as u32;
        let is_mirrored = placement.is_mirrored(&sources);
        raw.triangles.extend(triangles.iter().enumerate().map(|(t, corners)| {
            let [a, b, c] = if self.is_flat() { [0, 1, 2].map(|k| 3 * t as u32 + k) } else { *corners };
            let [a, b, c] = [a + offset, b + offset, c + offset];
            if is_mirrored { [a, c, b] } else { [a, b, c] }
        }));
        let positions: Vec<DVec3> =
            sources.iter().map(|&v| placement.of(v).transform_point3(self.positions[v as usize])).collect();
        match &self.normals {
            Some(normals) => raw.normals.extend(
                sources
                    .iter()
                    .map(|&v| (cofactors(placement.of(v)) * normals[v as usize]).normalize_or_zero().as_vec3()),
            ),
            None => raw.normals.extend(positions.chunks_exact(3).flat_map(|corners| {
                let across = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
                [if is_mirrored { -across } else { across }.as_vec3(); 3]
            })),
        }
        raw.positions.extend(positions.iter().map(|p| p.as_vec3()));
        let color = |v: &u32| self.colors.get(*v as usize).copied().unwrap_or(DVec4::ONE);
        raw.colors.extend(sources.iter().map(|v| self.surface.color(color(v)).as_vec3()));
        self.place_coordinates(&sources, textures, buffers, raw)?;
        let mask = match coverage {
            Coverage::Masked(mask) => Some(mask as f32),
            _ => None,
        };
        if mask.is_some() || !raw.coverage.is_empty() {
            raw.coverage.resize(offset as usize, Vec2::new(1.0, NO_MASK));
            raw.coverage.extend(sources.iter().map(|&v| Vec2::new(self.alpha(v), mask.unwrap_or(NO_MASK))));
        }
        Ok(Placed { sources, coverage })
    }

    /// Alpha of a vertex, beside that of the texture.
    fn alpha(&self, vertex: u32) -> f32 {
        let of_vertex = self.colors.get(vertex as usize).map_or(1.0, |color| color.w);
        (self.surface.factor.w * of_vertex).clamp(0.0, 1.0) as f32
    }

    /// Adds texture coordinates, if the mesh has any so far or this primitive has.
    fn place_coordinates(
        &self,
        sources: &[u32],
        textures: &mut Textures<'_>,
        buffers: &Buffers,
        raw: &mut RawMesh,
    ) -> Result<(), SceneError> {
        let before = raw.positions.len() - sources.len();
        let texture = self.surface.texture(textures, buffers)?;
        if texture.is_none() && raw.texture_coordinates.is_empty() {
            return Ok(());
        }
        // Parts of the file without a texture have (0, 0) of the white one.
        let has_white = texture.is_none() || raw.texture_coordinates.len() < before;
        let white = if has_white { textures.number(None, buffers)? } else { 0 };
        let at = |place: DVec2, number: usize| place.extend(number as f64).as_vec3();
        raw.texture_coordinates.resize(before, at(DVec2::ZERO, white));
        let place = |v: &u32| self.coordinates.get(*v as usize).copied().unwrap_or(DVec2::ZERO);
        raw.texture_coordinates.extend(sources.iter().map(|v| at(place(v), texture.unwrap_or(white))));
        Ok(())
    }
}

impl Placement<'_> {
    pub(super) fn of(&self, vertex: u32) -> &DMat4 {
        match self {
            Self::Rigid(matrix) => matrix,
            Self::Each(list) => &list[vertex as usize],
        }
    }

    /// Whether it turns what is outside to the inside, for most of the vertices.
    fn is_mirrored(&self, vertices: &[u32]) -> bool {
        match self {
            Self::Rigid(matrix) => matrix.determinant() < 0.0,
            Self::Each(list) => {
                let mirrored = vertices.iter().filter(|&&v| list[v as usize].determinant() < 0.0).count();
                2 * mirrored > vertices.len()
            }
        }
    }
}

/// Matrix that turns normals: they are covectors, and cofactors keep them upright under any scale, even a singular one.
pub(super) fn cofactors(matrix: &DMat4) -> DMat3 {
    let m = DMat3::from_mat4(*matrix);
    let sign = if matrix.determinant() < 0.0 { -1.0 } else { 1.0 };
    sign * DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis))
}

/// An accessor of colours, which are linear, with alpha or without.
fn colors(accessor: &Accessor<'_>, buffers: &Buffers) -> Result<Vec<DVec4>, SceneError> {
    if accessor.dimensions() == Dimensions::Vec3 {
        let list = numbers::<3>(accessor, buffers, Dimensions::Vec3, WholeNumbers::Fraction)?;
        return Ok(list.into_iter().map(|color| DVec3::from(color).extend(1.0)).collect());
    }
    let list = numbers::<4>(accessor, buffers, Dimensions::Vec4, WholeNumbers::Fraction)?;
    Ok(list.into_iter().map(DVec4::from).collect())
}

fn about(semantic: &Semantic, error: SceneError) -> SceneError {
    SceneError { problem: format!("{}: {}", semantic.to_string(), error.problem), ..error }
}

/// The triangles of a list, a strip or a fan of vertices.
fn triangles(mode: Mode, indices: &[u32]) -> impl Iterator<Item = [u32; 3]> {
    let count = match mode {
        Mode::Triangles => indices.len() / 3,
        _ => indices.len().saturating_sub(2),
    };
    (0..count).map(move |t| {
        let [a, b, c] = match mode {
            Mode::Triangles => [3 * t, 3 * t + 1, 3 * t + 2],
            Mode::TriangleFan => [0, t + 1, t + 2],
            _ if t % 2 == 0 => [t, t + 1, t + 2],
            _ => [t + 1, t, t + 2],
        };
        [indices[a], indices[b], indices[c]]
    })
}
