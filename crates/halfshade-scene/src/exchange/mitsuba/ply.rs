//! Triangles as a binary PLY file.

/// A property of vertices and its values, one per vertex.
pub(super) type Column = (&'static str, Vec<f32>);

/// The file of `triangles` between vertices that have these properties.
pub(super) fn ply(columns: &[Column], triangles: &[[u32; 3]]) -> Vec<u8> {
    let count = columns.first().map_or(0, |(_, values)| values.len());
    let mut header = format!("ply\nformat binary_little_endian 1.0\nelement vertex {count}\n");
    for (name, _) in columns {
        header += &format!("property float {name}\n");
    }
    header += &format!("element face {}\nproperty list uchar int vertex_indices\nend_header\n", triangles.len());
    let mut bytes = Vec::with_capacity(header.len() + 4 * count * columns.len() + 13 * triangles.len());
    bytes.extend(header.bytes());
    for vertex in 0..count {
        for (_, values) in columns {
            bytes.extend(values[vertex].to_le_bytes());
        }
    }
    for triangle in triangles {
        bytes.push(3);
        triangle.iter().for_each(|corner| bytes.extend(corner.to_le_bytes()));
    }
    bytes
}
