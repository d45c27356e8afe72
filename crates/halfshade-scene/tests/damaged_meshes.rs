//! OBJ and PLY damaged at random: no damage makes the readers panic or hang.

use crate::mesh_files::{ARROWHEAD, PLY, area, colored, read};
use glam::{DVec3, Vec3};
use rand::{RngExt, SeedableRng};
use std::time::{Duration, Instant};

/// Files to damage: one of each thing that is read.
fn corpus() -> Vec<(&'static str, Vec<u8>)> {
    let binary = |big: bool| {
        let mut bytes = format!(
            "ply\nformat binary_{}_endian 1.0\nelement vertex 4\nproperty float x\nproperty double y\nproperty short z\n\
             property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n\
             property list uchar int vertex_indices\nelement tristrips 1\nproperty list uint int vertex_indices\nend_header\n",
            if big { "big" } else { "little" }
        )
        .into_bytes();
        let ordered = |mut bytes: Vec<u8>| {
            if big {
                bytes.reverse();
            }
            bytes
        };
        for (x, y) in [(0.0_f32, 0.0_f64), (2.0, 1.0), (0.0, 2.0), (1.0, 1.0)] {
            bytes.extend(ordered(x.to_le_bytes().to_vec()));
            bytes.extend(ordered(y.to_le_bytes().to_vec()));
            bytes.extend([0, 0, 200, 100, 50]);
        }
        bytes.push(4);
        (0..4_i32).for_each(|v| bytes.extend(ordered(v.to_le_bytes().to_vec())));
        [5_i32, 0, 1, -1, 2, 3].iter().for_each(|v| bytes.extend(ordered(v.to_le_bytes().to_vec())));
        bytes
    };
    let obj = "mtllib a.mtl\no a\nv 0 0 0 1 0 0\nv 2 1 0 0.5 0 0\nv 0 2 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 0.5 1\nvn 0 0 1\n\
               usemtl b\ns 1\nf 1/1/1 2/2/1 \\\n3/3/1 4/1/1\nl 1 2\n# c\nf -4/1/1 -3/2/1 -2/3/1\n";
    let wedge = PLY
        .replace("vertex_index\n", "vertex_index\nproperty list uchar float texcoord\n")
        .replace("2 3\n", "2 3 8 0 0 1 0 1 1 0 1\n");
    vec![
        ("a.obj", obj.as_bytes().to_vec()),
        ("a.obj", ARROWHEAD.replace('\n', "\r").into_bytes()),
        ("a.ply", PLY.as_bytes().to_vec()),
        ("a.ply", wedge.into_bytes()),
        ("a.ply", colored("ushort", ["128", "64", "255"]).into_bytes()),
        ("a.ply", binary(false)),
        ("a.ply", binary(true)),
    ]
}

/// Words that break readers.
const NASTY: [&str; 24] = [
    "-1",
    "0",
    "4294967295",
    "4294967296",
    "-9223372036854775808",
    "9223372036854775807",
    "1e38",
    "1e39",
    "-1e-45",
    "nan",
    "inf",
    "-nan(ind)",
    "1,5",
    "",
    "\\",
    "#",
    "\u{feff}",
    "\0",
    "list",
    "element vertex 4000000000",
    "uchar",
    "double",
    "/",
    "f",
];

/// Files cut, with bits turned, lines swapped, blocks doubled, numbers replaced: nothing panics, nothing hangs, and what
/// is read is finite. `HALFSHADE_MUTATIONS` says how many are tried, 20,000 by default.
#[test]
fn damaged_files_never_break_the_readers() {
    let count = std::env::var("HALFSHADE_MUTATIONS").ok().and_then(|count| count.parse().ok()).unwrap_or(20_000);
    let corpus = corpus();
    for (name, bytes) in &corpus {
        read(name, bytes).unwrap_or_else(|error| panic!("{error}"));
    }
    let mut random = rand_pcg::Pcg32::seed_from_u64(13);
    let mut sound = 0;
    for round in 0..count {
        let (name, bytes) = &corpus[random.random_range(0..corpus.len())];
        let mut bytes = bytes.clone();
        for _ in 0..random.random_range(1..4) {
            let place = random.random_range(0..=bytes.len());
            let end = random.random_range(place..=bytes.len());
            match random.random_range(0..7) {
                0 => bytes.truncate(place),
                1 if place < bytes.len() => bytes[place] ^= 1 << random.random_range(0..8),
                2 => drop(bytes.drain(place..end)),
                3 => {
                    let block = bytes[place..end].to_vec();
                    let times = random.random_range(1..4);
                    bytes.splice(place..place, block.repeat(times));
                }
                4 => {
                    let mut lines: Vec<Vec<u8>> =
                        bytes.split_inclusive(|&byte| byte == b'\n').map(<[u8]>::to_vec).collect();
                    if lines.len() > 1 {
                        let (a, b) = (random.random_range(0..lines.len()), random.random_range(0..lines.len()));
                        lines.swap(a, b);
                        bytes = lines.concat();
                    }
                }
                5 => {
                    // In place of a word.
                    let is_blank = |byte: &u8| byte.is_ascii_whitespace();
                    let first = bytes[..place].iter().rposition(is_blank).map_or(0, |i| i + 1);
                    let last = bytes[place..].iter().position(is_blank).map_or(bytes.len(), |i| place + i);
                    bytes.splice(first..last, NASTY[random.random_range(0..NASTY.len())].bytes());
                }
                _ => drop(bytes.splice(place..place, NASTY[random.random_range(0..NASTY.len())].bytes())),
            }
        }
        let start = Instant::now();
        let result = std::panic::catch_unwind(|| read(name, &bytes));
        let shown = || String::from_utf8_lossy(&bytes).into_owned();
        let result = result.unwrap_or_else(|_| panic!("round {round} panics: {}", shown()));
        assert!(start.elapsed() < Duration::from_secs(60), "round {round} takes {:?}: {}", start.elapsed(), shown());
        if let Ok((mesh, _)) = result {
            sound += 1;
            let finite = |list: &[Vec3]| list.iter().all(|value| value.is_finite());
            assert!(finite(&mesh.positions) && finite(&mesh.normals) && finite(&mesh.colors), "{}", shown());
            assert!(finite(&mesh.texture_coordinates) && area(&mesh).is_finite(), "{}", shown());
            let sum: DVec3 = mesh.normals.iter().map(|normal| normal.as_dvec3()).sum();
            assert!(sum.is_finite() && mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-4), "{}", shown());
        }
    }
    // Neither all refused nor nothing noticed.
    assert!(sound > count / 50 && sound < count / 2 + count / 4, "{sound} of {count} were read");
}
