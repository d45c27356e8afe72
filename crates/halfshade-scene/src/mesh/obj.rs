//! Wavefront OBJ, read with `tobj`.
//!
//! Only geometry is read: positions (with colours, where a line has six numbers), normals, texture coordinates and
//! faces. Texture coordinates count only where every corner has some. Lines of all other kinds, materials among them, are blanked before `tobj` sees them; what remains is checked first, because `tobj`
//! names no lines and takes a face cut short for a line or a point.

use super::assemble::RawMesh;
use crate::SceneError;
use glam::Vec3;
use std::io::{BufRead, Read};

pub(super) fn parse(bytes: &[u8]) -> Result<RawMesh, SceneError> {
    // Comments and names may be in any encoding; numbers are ASCII.
    let text = String::from_utf8_lossy(bytes);
    let geometry = checked_geometry(&text)?;
    let mut lines = Lines { rest: geometry.text.as_bytes(), line: 0 };
    let options = tobj::LoadOptions { triangulate: true, single_index: true, ignore_points: true, ignore_lines: true };
    let (models, _) = tobj::load_obj_buf(&mut lines, &options, |_| Err(tobj::LoadError::OpenFileFailed))
        .map_err(|error| SceneError::new(error.to_string()).at_line(lines.line))?;
    let mut raw = RawMesh::default();
    let vectors = |flat: &[f32]| flat.chunks_exact(3).map(Vec3::from_slice).collect::<Vec<_>>();
    for tobj::Model { mesh, .. } in models {
        let offset = raw.positions.len() as u32;
        raw.positions.extend(vectors(&mesh.positions));
        let count = raw.positions.len();
        // A list of another length belongs to a file in which only some corners have normals, or colours.
        if mesh.normals.len() == mesh.positions.len() {
            raw.normals.resize(offset as usize, Vec3::ZERO);
            raw.normals.extend(vectors(&mesh.normals));
        }
        raw.normals.resize(if raw.normals.is_empty() { 0 } else { count }, Vec3::ZERO);
        if mesh.vertex_color.len() == mesh.positions.len() {
            raw.colors.resize(offset as usize, Vec3::ONE);
            raw.colors.extend(vectors(&mesh.vertex_color).iter().map(|c| c.clamp(Vec3::ZERO, Vec3::ONE)));
        }
        raw.colors.resize(if raw.colors.is_empty() { 0 } else { count }, Vec3::ONE);
        if 3 * mesh.texcoords.len() == 2 * mesh.positions.len() {
            // OBJ counts v from the bottom.
            raw.texture_coordinates.resize(offset as usize, Vec3::ZERO);
            raw.texture_coordinates.extend(mesh.texcoords.chunks_exact(2).map(|uv| Vec3::new(uv[0], 1.0 - uv[1], 0.0)));
        }
        raw.texture_coordinates.resize(if raw.texture_coordinates.is_empty() { 0 } else { count }, Vec3::ZERO);
        raw.triangles.extend(mesh.indices.chunks_exact(3).map(|t| [t[0] + offset, t[1] + offset, t[2] + offset]));
    }
    if raw.triangles.is_empty() {
        return Err(SceneError::new("the mesh has no triangles").with_remedy("is the file complete?"));
    }
    if geometry.unused_positions && !geometry.ends_with_newline {
        return Err(SceneError::new("the file ends in the middle of a line and faces are missing: it was cut short")
            .at_line(text.lines().count()));
    }
    Ok(raw)
}

/// The lines of a file that matter, others blank, and what was noticed about them.
struct Geometry {
    text: String,
    unused_positions: bool,
    ends_with_newline: bool,
}

/// Checks every line on which a mesh depends.
fn checked_geometry(text: &str) -> Result<Geometry, SceneError> {
    let mut kept = String::with_capacity(text.len());
    let mut positions = 0_i64;
    let mut normals = 0_i64;
    let mut coordinates = 0_i64;
    let mut used = Vec::new();
    // Indices may name what comes later in the file: checked at the end.
    let (mut largest, mut largest_normal, mut largest_coordinate) = ((0, 0), (0, 0), (0, 0));
    for (line, content) in (1..).zip(text.lines()) {
        let wrong = |problem: String| SceneError::new(problem).at_line(line);
        let mut words = content.split_whitespace();
        match words.next() {
            Some(kind @ ("v" | "vn" | "vt")) => {
                let mut kept_suffix = "";
                let mut numbers = words.take_while(|word| !word.starts_with('#')).map(str::parse::<f32>);
                let axes: &[&str] = if kind == "vt" { &["u", "v"] } else { &["x", "y", "z"] };
                for axis in axes {
                    match numbers.next() {
                        // A normal of no use is replaced later; a position of no use can't be.
                        Some(Ok(x)) if x.is_finite() || kind == "vn" => {}
                        Some(_) => {
                            return Err(wrong(format!("{axis} is not a finite number in `{}`", shortened(content))));
                        }
                        // A coordinate along a line has no v.
                        None if *axis == "v" => kept_suffix = " 0",
                        None => return Err(wrong(format!("{axis} is missing in `{}`", shortened(content)))),
                    }
                }
                *(match kind {
                    "v" => &mut positions,
                    "vn" => &mut normals,
                    _ => &mut coordinates,
                }) += 1;
                kept.push_str(content.split('#').next().unwrap_or_default());
                kept.push_str(kept_suffix);
            }
            Some("f") => {
                kept.push('f');
                let mut corners = 0;
                for word in words.take_while(|word| !word.starts_with('#')) {
                    let mut parts =
                        word.split('/').map(|part| if part.is_empty() { Ok(0) } else { part.parse::<i64>() });
                    let (v, vt, vn) = (parts.next(), parts.next(), parts.next());
                    let (Some(Ok(v)), Ok(vt), Ok(vn), None) =
                        (v, vt.unwrap_or(Ok(0)), vn.unwrap_or(Ok(0)), parts.next())
                    else {
                        return Err(wrong(format!("`{}` is no corner of a face", shortened(word))));
                    };
                    let v = if v < 0 { positions.saturating_add(v).saturating_add(1) } else { v };
                    let vn = if vn < 0 { normals.saturating_add(vn).saturating_add(1).max(-1) } else { vn };
                    let vt = if vt < 0 { coordinates.saturating_add(vt).saturating_add(1).max(-1) } else { vt };
                    if v <= 0 || vn < 0 || vt < 0 {
                        return Err(wrong(format!("`{}` names a vertex before the first", shortened(word))));
                    }
                    largest = largest.max((v, line));
                    largest_normal = largest_normal.max((vn, line));
                    largest_coordinate = largest_coordinate.max((vt, line));
                    used.push(v);
                    let named = |index: i64| if index == 0 { String::new() } else { index.to_string() };
                    kept.push_str(&format!(" {v}/{}/{}", named(vt), named(vn)));
                    corners += 1;
                }
                if corners < 3 {
                    return Err(wrong(format!("a face needs three corners, this one has {corners}")));
                }
            }
            _ => {}
        }
        kept.push('\n');
    }
    for ((index, line), count, what) in [
        (largest, positions, "vertex"),
        (largest_normal, normals, "normal"),
        (largest_coordinate, coordinates, "texture coordinate"),
    ] {
        if index > count {
            return Err(SceneError::new(format!("{what} {index} is named, but there are only {count}")).at_line(line));
        }
    }
    used.sort_unstable();
    used.dedup();
    Ok(Geometry {
        text: kept,
        unused_positions: (used.len() as i64) < positions,
        ends_with_newline: text.ends_with(['\n', '\r']),
    })
}

/// A piece of a line that fits a message.
fn shortened(text: &str) -> String {
    if text.chars().count() <= 60 { text.trim().to_owned() } else { text.chars().take(57).collect::<String>() + "..." }
}

/// A reader that hands out one line at a time, and so knows on which line its user stopped.
struct Lines<'a> {
    rest: &'a [u8],
    line: usize,
}

impl Read for Lines<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let count = self.fill_buf()?.read(buffer)?;
        self.consume(count);
        Ok(count)
    }
}

impl BufRead for Lines<'_> {
    fn fill_buf(&mut self) -> std::io::Result<&[u8]> {
        let end = self.rest.iter().position(|&byte| byte == b'\n').map_or(self.rest.len(), |i| i + 1);
        Ok(&self.rest[..end])
    }

    fn consume(&mut self, count: usize) {
        let (used, rest) = self.rest.split_at(count);
        self.line += used.iter().filter(|&&byte| byte == b'\n').count();
        self.rest = rest;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: &str =
        "# a square\r\nmtllib none.mtl\r\nv 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nusemtl x\r\nf 1 2 3 4\r\n";

    #[test]
    fn quads_carriage_returns_and_absent_materials_are_fine() {
        let raw = parse(SQUARE.as_bytes()).unwrap();
        assert_eq!((raw.positions.len(), &raw.triangles[..]), (4, &[[0, 1, 2], [0, 2, 3]][..]));
        assert!(raw.normals.is_empty() && raw.colors.is_empty());
    }

    #[test]
    fn relative_indices_normals_and_colours_are_read() {
        let text = "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nvn 0 0 2\ng\nf -3//-1 -2//-1 -1//-1\n";
        let raw = parse(text.as_bytes()).unwrap();
        assert_eq!((raw.normals, raw.colors), (vec![2.0 * Vec3::Z; 3], vec![Vec3::X, Vec3::Y, Vec3::Z]));
        assert_eq!(raw.triangles, [[0, 1, 2]]);
    }

    #[test]
    fn texture_coordinates_have_their_own_indices_and_v_is_turned_downward() {
        let text =
            "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0.25 0.75\nvt 1 0 0\nvt 0.5\nf 1/1 2/2 3/-1\nf 1/2 3/3 4/1\n";
        let raw = parse(text.as_bytes()).unwrap();
        // The first vertex is split: its coordinates differ between the triangles. The third's are the same.
        let at = |t: usize| raw.triangles[t].map(|v| raw.texture_coordinates[v as usize].truncate().to_array());
        assert_eq!(at(0), [[0.25, 0.25], [1.0, 1.0], [0.5, 1.0]]);
        assert_eq!(at(1), [[1.0, 1.0], [0.5, 1.0], [0.25, 0.25]]);
        assert_eq!(raw.positions.len(), 5);
        // Where some corner has none, there are none.
        let partly = parse(text.replace("3/3", "3").as_bytes()).unwrap();
        assert!(partly.texture_coordinates.is_empty() && partly.triangles.len() == 2);
    }

    #[test]
    fn mistakes_are_named_with_their_lines() {
        for (text, line, part) in [
            ("v 0 0 0\nv 1 0\n", 2, "z is missing"),
            ("v 0 0 0\nv 1 nan 0\n", 2, "y is not a finite"),
            ("v 0 0 0\nv 1 1e99 0\n", 2, "y is not a finite"),
            ("v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 4\n", 5, "vertex 4"),
            ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -9223372036854775808\n", 4, "before the first"),
            ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 6148914691236517206\n", 4, "named, but"),
            ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//1 2//1 3//1\n", 4, "normal 1"),
            ("v 0 0 0\nv 1 0 0\nf 1 2\n", 3, "three corners"),
            ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 x\n", 4, "no corner"),
            ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2/1 3/1\n", 4, "texture coordinate 1"),
            ("v 0 0 0\nvt nan 0\n", 2, "u is not a finite"),
            ("v 0 0 0 1 1\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 1, "color"),
        ] {
            let error = parse(text.as_bytes()).unwrap_err();
            assert!(error.line == Some(line) && error.problem.contains(part), "{text:?}: {error}");
        }
    }
}
