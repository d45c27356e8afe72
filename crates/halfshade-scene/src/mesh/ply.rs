//! Stanford PLY, ASCII and binary of both byte orders, read with `ply-rs-bw`.

use super::assemble::RawMesh;
use crate::SceneError;
use glam::Vec3;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Encoding, Property, PropertyAccess, PropertyAccessResult};

/// One vertex or one face: what its properties say.
#[derive(Debug, Default)]
struct Record {
    position: [f64; 3],
    normal: [f64; 3],
    color: [f64; 3],
    /// u, and v upward.
    coordinate: [f64; 3],
    corners: Option<Vec<i64>>,
}

impl PropertyAccess for Record {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let (target, axis, is_color) = match name {
            "x" => (&mut self.position, 0, false),
            "y" => (&mut self.position, 1, false),
            "z" => (&mut self.position, 2, false),
            "nx" => (&mut self.normal, 0, false),
            "ny" => (&mut self.normal, 1, false),
            "nz" => (&mut self.normal, 2, false),
            "red" | "diffuse_red" | "r" => (&mut self.color, 0, true),
            "green" | "diffuse_green" | "g" => (&mut self.color, 1, true),
            "blue" | "diffuse_blue" | "b" => (&mut self.color, 2, true),
            "u" | "s" | "texture_u" => (&mut self.coordinate, 0, false),
            "v" | "t" | "texture_v" => (&mut self.coordinate, 1, false),
            "vertex_indices" | "vertex_index" => {
                self.corners = whole_numbers(property);
                return if self.corners.is_some() {
                    PropertyAccessResult::Set
                } else {
                    PropertyAccessResult::UnsupportedType
                };
            }
            _ => return PropertyAccessResult::Ignored,
        };
        let (value, full) = match property {
            Property::Char(x) => (x.into(), f64::from(i8::MAX)),
            Property::UChar(x) => (x.into(), f64::from(u8::MAX)),
            Property::Short(x) => (x.into(), f64::from(i16::MAX)),
            Property::UShort(x) => (x.into(), f64::from(u16::MAX)),
            Property::Int(x) => (x.into(), f64::from(i32::MAX)),
            Property::UInt(x) => (x.into(), f64::from(u32::MAX)),
            Property::Float(x) => (x.into(), 1.0),
            Property::Double(x) => (x, 1.0),
            _ => return PropertyAccessResult::UnsupportedType,
        };
        target[axis] = if is_color { (value / full).clamp(0.0, 1.0) } else { value };
        PropertyAccessResult::Set
    }
}

/// A list of whole numbers of any width.
fn whole_numbers(property: Property) -> Option<Vec<i64>> {
    fn widened<T: Into<i64>>(list: Vec<T>) -> Vec<i64> {
        list.into_iter().map(Into::into).collect()
    }
    match property {
        Property::ListChar(list) => Some(widened(list)),
        Property::ListUChar(list) => Some(widened(list)),
        Property::ListShort(list) => Some(widened(list)),
        Property::ListUShort(list) => Some(widened(list)),
        Property::ListInt(list) => Some(widened(list)),
        Property::ListUInt(list) => Some(widened(list)),
        _ => None,
    }
}

pub(super) fn parse(bytes: &[u8]) -> Result<RawMesh, SceneError> {
    let parser = Parser::<Record>::new();
    let mut reader = Reader::new(bytes);
    let header = parser.read_header(&mut reader).map_err(described)?;
    let ascii = header.encoding == Encoding::Ascii;
    let vertices =
        header.elements.get("vertex").ok_or_else(|| SceneError::new("the header declares no element `vertex`"))?;
    for axis in ["x", "y", "z"] {
        if !vertices.properties.contains_key(axis) {
            return Err(SceneError::new(format!("the header declares no property `{axis}` for the vertices")));
        }
    }
    let has = |name: &str| vertices.properties.contains_key(name);
    let has_normals = has("nx") && has("ny") && has("nz");
    let has_colors = ["red", "diffuse_red", "r"].iter().any(|name| has(name));
    let has_coordinates = [["u", "v"], ["s", "t"], ["texture_u", "texture_v"]].iter().any(|[u, v]| has(u) && has(v));
    if !header.elements.contains_key("face") {
        return Err(SceneError::new("the header declares no element `face`")
            .with_remedy("triangle strips and point clouds are not supported; export polygons"));
    }

    let mut raw = RawMesh::default();
    for (name, element) in &header.elements {
        check_count(element, reader.get_ref().len())?;
        let first_line = reader.line();
        let records = parser.read_payload_for_element(&mut reader, element, &header).map_err(|error| {
            let error = described(error);
            // In binary data what is counted as a line is none.
            if ascii { error } else { SceneError { line: None, ..error } }
        })?;
        let vector = |[x, y, z]: [f64; 3]| Vec3::new(x as f32, y as f32, z as f32);
        match name.as_str() {
            "vertex" => {
                raw.positions = records.iter().map(|record| vector(record.position)).collect();
                if has_normals {
                    raw.normals = records.iter().map(|record| vector(record.normal)).collect();
                }
                if has_colors {
                    raw.colors = records.iter().map(|record| vector(record.color)).collect();
                }
                if has_coordinates {
                    let from_top = |[u, v, _]: [f64; 3]| Vec3::new(u as f32, (1.0 - v) as f32, 0.0);
                    raw.texture_coordinates = records.iter().map(|record| from_top(record.coordinate)).collect();
                }
                if ascii {
                    raw.lines = (first_line..).take(records.len()).collect();
                }
            }
            "face" => {
                for (index, record) in records.iter().enumerate() {
                    fan(record, vertices.count, &mut raw.triangles).map_err(|problem| {
                        let error = SceneError::new(format!("face {index} {problem}"));
                        if ascii { error.at_line(first_line + index) } else { error }
                    })?;
                }
            }
            _ => {}
        }
    }
    Ok(raw)
}

/// Refuses a count that the rest of the file cannot hold, before anything is read that often.
fn check_count(element: &ElementDef, bytes_left: usize) -> Result<(), SceneError> {
    if element.count > bytes_left || (element.count > 0 && element.properties.is_empty()) {
        return Err(SceneError::new(format!(
            "{} elements `{}` are declared, but only {bytes_left} bytes follow: the file was cut short or its header is wrong",
            element.count, element.name
        )));
    }
    Ok(())
}

/// Cuts a face into triangles.
fn fan(face: &Record, vertex_count: usize, triangles: &mut Vec<[u32; 3]>) -> Result<(), String> {
    let corners = face.corners.as_deref().ok_or("has no property `vertex_indices`")?;
    if corners.len() < 3 {
        return Err(format!("has {} corners instead of at least three", corners.len()));
    }
    let index = |corner: i64| {
        u32::try_from(corner)
            .ok()
            .filter(|&v| (v as usize) < vertex_count)
            .ok_or_else(|| format!("names vertex {corner}, but there are {vertex_count}, counted from 0"))
    };
    let first = index(corners[0])?;
    for pair in corners[1..].windows(2) {
        triangles.push([first, index(pair[0])?, index(pair[1])?]);
    }
    Ok(())
}

/// The parser's error as ours: its first line says what is wrong.
fn described(error: ParseError) -> SceneError {
    let text = error.to_string();
    let text = text.lines().next().unwrap_or_default();
    let problem = error.line().and_then(|line| text.strip_prefix(&format!("Line {line}: "))).unwrap_or(text);
    let result = SceneError::new(problem.trim_end_matches('.'));
    match error.line() {
        Some(line) => result.at_line(line),
        None => result,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
            assert_eq!((raw.colors[0], raw.colors[3]), (Vec3::X, Vec3::splat(0.2)));
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
