//! Stanford PLY, ASCII and binary of both byte orders.
//!
//! Vertices, faces and triangle strips are read, in any order; other elements are left out with a note. Vertices have
//! positions, normals, colours and texture coordinates. Faces have texture coordinates of corners, which win over those
//! of vertices if all corners have some.

mod faces;
mod header;
mod payload;
mod vertices;

use super::assemble::RawMesh;
use super::colors::ColorEncoding;
use super::corners::{Corner, Corners};
use super::polygon::Cutter;
use super::words::Words;
use crate::{SceneError, text};
use faces::Faces;
use glam::Vec3;
use header::{Element, Header};
use payload::Payload;
use vertices::Vertices;

pub(super) fn parse(bytes: &[u8], told: Option<ColorEncoding>) -> Result<RawMesh, SceneError> {
    let mut words = Words::new(text::without_mark(bytes)?, 1);
    let header = Header::read(&mut words)?;
    let vertex_count = check_elements(&header)?;
    let mut payload = Payload::new(words, header.format);
    let mut vertices = Vertices::default();
    let mut faces = Faces::default();
    let mut notes = Vec::new();
    for element in &header.elements {
        payload.check_count(element)?;
        match element.name.as_str() {
            "vertex" => vertices = Vertices::read(&mut payload, element)?,
            "face" | "tristrips" => faces.read(&mut payload, element, vertex_count)?,
            name => {
                skip(&mut payload, element)?;
                if element.count > 0 {
                    notes
                        .push(format!("elements `{name}` left out, only faces and strips are read: {}", element.count));
                }
            }
        }
    }
    notes.extend(payload.check_end()?);
    let mut raw = mesh_of(vertices, faces, told)?;
    raw.notes.splice(0..0, notes);
    Ok(raw)
}

/// The number of vertices of a header that has all that a mesh needs.
fn check_elements(header: &Header) -> Result<usize, SceneError> {
    let named = |name: &'static str| header.elements.iter().filter(move |element| element.name == name);
    let mut vertices = named("vertex");
    let count = vertices.next().ok_or_else(|| SceneError::new("the header declares no element `vertex`"))?.count;
    if vertices.next().is_some() {
        return Err(
            SceneError::new("the header declares the element `vertex` twice").with_remedy("export the mesh again")
        );
    }
    if named("face").chain(named("tristrips")).next().is_none() {
        let there = header.elements.iter().map(|element| element.name.as_str()).collect::<Vec<_>>().join(", ");
        return Err(SceneError::new(format!("the header declares no element `face`, only: {there}"))
            .with_remedy("point clouds, edges and grids are not supported; export polygons"));
    }
    Ok(count)
}

/// Reads elements and forgets them.
fn skip(payload: &mut Payload<'_>, element: &Element) -> Result<(), SceneError> {
    for _ in 0..element.count {
        payload.begin();
        for property in &element.properties {
            let count = match property.length {
                Some(length) => payload.length(length, property.of, &property.name)?,
                None => 1,
            };
            for _ in 0..count {
                payload.number(property.of, &property.name)?;
            }
        }
        payload.end()?;
    }
    Ok(())
}

/// The mesh of what was read.
fn mesh_of(vertices: Vertices, faces: Faces, told: Option<ColorEncoding>) -> Result<RawMesh, SceneError> {
    let Vertices { positions, normals, colors, coordinates, lines, mut notes } = vertices;
    let Faces { corners, ends, coordinates: of_corners, mut coordinate_of, notes: of_faces, .. } = faces;
    notes.extend(of_faces);
    if corners.len() > u32::MAX as usize {
        return Err(SceneError::new("the file has more corners of faces than can be counted"));
    }
    let colors = match colors {
        Some(colors) => {
            let (colors, note) = colors.linear(told, |vertex| lines.get(vertex).copied())?;
            notes.extend(note);
            colors
        }
        None => Vec::new(),
    };
    // PLY counts v from the bottom.
    let from_top = |[u, v]: [f64; 2]| Vec3::new(u as f32, (1.0 - v) as f32, 0.0);
    let texture_coordinates = coordinates.into_iter().map(from_top).collect();
    let mut raw = RawMesh { positions, normals, colors, texture_coordinates, lines, notes, ..RawMesh::default() };

    let mut cutter = Cutter::default();
    let mut outline = Vec::new();
    // Numbers of corners first.
    let mut first = 0;
    for &end in &ends {
        if end - first == 3 {
            raw.triangles.push([0, 1, 2].map(|corner| first as u32 + corner));
        } else {
            outline.clear();
            outline.extend(corners[first..end].iter().map(|&vertex| raw.positions[vertex as usize]));
            let before = raw.triangles.len();
            cutter.cut(&outline, &mut raw.triangles);
            raw.triangles[before..].iter_mut().flatten().for_each(|corner| *corner += first as u32);
        }
        first = end;
    }
    raw.notes.extend(cutter.note());

    coordinate_of.resize(if of_corners.is_empty() { 0 } else { corners.len() }, 0);
    let bare = coordinate_of.iter().filter(|&&number| number == 0).count();
    if bare > 0 {
        raw.notes
            .push(format!("texture coordinates of corners left out: {bare} of {} corners have none", corners.len()));
    }
    if of_corners.is_empty() || bare > 0 {
        raw.triangles.iter_mut().flatten().for_each(|corner| *corner = corners[*corner as usize]);
        return Ok(raw);
    }
    let mut split = Corners::new(raw.positions.len());
    raw.triangles.iter_mut().flatten().for_each(|corner| {
        let place = *corner as usize;
        *corner = split.vertex(Corner { position: corners[place] + 1, coordinate: coordinate_of[place], normal: 0 });
    });
    fn chosen<T: Copy>(values: &[T], split: &Corners) -> Vec<T> {
        let of_vertex = |corner: &Corner| values.get(corner.position as usize - 1).copied();
        split.vertices().iter().filter_map(of_vertex).collect()
    }
    raw.positions = chosen(&raw.positions, &split);
    raw.normals = chosen(&raw.normals, &split);
    raw.colors = chosen(&raw.colors, &split);
    raw.lines = chosen(&raw.lines, &split);
    let coordinates = split.vertices().iter().map(|corner| of_corners[corner.coordinate as usize - 1]);
    raw.texture_coordinates = coordinates.map(from_top).collect();
    Ok(raw)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(bytes: &[u8]) -> Result<RawMesh, SceneError> {
        super::parse(bytes, None)
    }

    const HEADER: &str = "element vertex 4\nproperty float x\nproperty double y\nproperty short z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";

    fn ascii() -> String {
        format!(
            "ply\nformat ascii 1.0\ncomment a square\n{HEADER}0 0 0 255 0 0\n1 0 0 0 255 0\n1 1 0 0 0 255\n0 1 0 51 51 51\n4 0 1 2 3\n"
        )
    }

    fn binary(big: bool) -> Vec<u8> {
        let mut bytes =
            format!("ply\nformat binary_{}_endian 1.0\n{HEADER}", if big { "big" } else { "little" }).into_bytes();
        let colors = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [51, 51, 51_u8]];
        for ((x, y), color) in [(0.0_f32, 0.0_f64), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].into_iter().zip(colors) {
            bytes.extend(if big { x.to_be_bytes() } else { x.to_le_bytes() });
            bytes.extend(if big { y.to_be_bytes() } else { y.to_le_bytes() });
            bytes.extend([0, 0]);
            bytes.extend(color);
        }
        bytes.push(4);
        for v in 0..4_i32 {
            bytes.extend(if big { v.to_be_bytes() } else { v.to_le_bytes() });
        }
        bytes
    }

    #[test]
    fn the_same_square_in_three_encodings() {
        for bytes in [ascii().into_bytes(), binary(false), binary(true)] {
            let raw = parse(&bytes).unwrap();
            assert_eq!(raw.positions, [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y]);
            assert_eq!(raw.triangles, [[0, 1, 2], [0, 2, 3]]);
            // Bytes are sRGB: 51 is a fifth of 255, and [(0.2 + 0.055) / 1.055]^2.4 of white.
            assert_eq!(raw.colors[0], Vec3::X);
            assert!(raw.colors[3].abs_diff_eq(Vec3::splat(0.033_104_8), 1e-6), "{}", raw.colors[3]);
        }
    }

    #[test]
    fn texture_coordinates_are_read_with_v_turned_downward() {
        for [u, v] in [["u", "v"], ["s", "t"], ["texture_u", "texture_v"]] {
            let text = ascii()
                .replace("property uchar green", &format!("property float {u}"))
                .replace("property uchar blue", &format!("property float {v}"));
            let raw = parse(text.replace("0 0 0 255 0 0", "0 0 0 255 0.25 0.75").as_bytes()).unwrap();
            assert_eq!(raw.texture_coordinates[0], Vec3::new(0.25, 0.25, 0.0));
            assert_eq!(raw.texture_coordinates[3], Vec3::new(51.0, -50.0, 0.0));
        }
        assert!(parse(ascii().as_bytes()).unwrap().texture_coordinates.is_empty());
    }

    #[test]
    fn binary_data_cut_anywhere_is_refused() {
        for bytes in [binary(false), binary(true)] {
            for end in 0..bytes.len() {
                assert!(parse(&bytes[..end]).is_err(), "{end}");
            }
        }
    }

    #[test]
    fn mistakes_are_named_with_their_lines() {
        let check = |from: &str, to: &str, line: Option<usize>, part: &str| {
            let text = ascii().replacen(from, to, 1);
            let error = parse(text.as_bytes()).unwrap_err();
            assert!(error.line == line && error.problem.contains(part), "{to:?}: {error:?}");
        };
        check("4 0 1 2 3", "4 0 1 2 4", Some(18), "vertex 4");
        check("4 0 1 2 3", "4 0 1 2", Some(18), "");
        check("4 0 1 2 3", "2 0 1", Some(18), "2 corners");
        check("1 1 0 0 0 255", "1 x 0 0 0 255", Some(16), "");
        check("element vertex 4", "element vertex 4000000000000", None, "declared");
        check("property float x", "property float w", None, "`x`");
        check("element face", "element fact", None, "`face`");
    }
}
