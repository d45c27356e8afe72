//! OBJ and PLY as programs write them, and as they should not: what is read, what is noted, what is refused.

use glam::Vec3;
use halfshade_scene::mesh::{self, ColorEncoding};
use halfshade_scene::{Mesh, SceneError};
use std::path::Path;
use std::time::{Duration, Instant};

pub(crate) fn read(name: &str, bytes: &[u8]) -> Result<(Mesh, Vec<String>), SceneError> {
    mesh::parse(Path::new(name), bytes, None)
}

fn mesh_of(name: &str, bytes: impl AsRef<[u8]>) -> (Mesh, String) {
    let (mesh, notes) = read(name, bytes.as_ref()).unwrap_or_else(|error| panic!("{error}"));
    (mesh, notes.join("\n"))
}

pub(crate) fn area(mesh: &Mesh) -> f64 {
    let area = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|v| mesh.positions[v as usize].as_dvec3());
        0.5 * (b - a).cross(c - a).length()
    };
    mesh.triangles.iter().map(area).sum()
}

/// The colour of the vertex at a place.
fn color_at(mesh: &Mesh, place: Vec3) -> Vec3 {
    let vertex = mesh.positions.iter().position(|position| *position == place).unwrap();
    mesh.colors.get(vertex).copied().unwrap_or(Vec3::ONE)
}

fn refusal(name: &str, bytes: impl AsRef<[u8]>) -> String {
    let error = read(name, bytes.as_ref()).expect_err(&String::from_utf8_lossy(bytes.as_ref()));
    assert!(error.remedy.is_some(), "no remedy: {error}");
    error.to_string()
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
pub(crate) const ARROWHEAD: &str = "v 0 0 0\nv 2 1 0\nv 0 2 0\nv 1 1 0\nf 1 2 3 4\n";
pub(crate) const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                   element face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0\n2 1 0\n0 2 0\n1 1 0\n4 0 1 2 3\n";

/// An SRGB value of 8 bits, by the definition.
fn linear(code: u8) -> f32 {
    let value = f64::from(code) / 255.0;
    (if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }) as f32
}

#[test]
fn a_byte_order_mark_changes_nothing_and_wide_text_is_named() {
    for (name, text) in [("a.obj", SQUARE), ("a.ply", PLY)] {
        let marked = [b"\xef\xbb\xbf", text.as_bytes()].concat();
        assert_eq!(mesh_of(name, marked), mesh_of(name, text));
        for mark in [&[0xff, 0xfe][..], &[]] {
            let wide: Vec<u8> = mark.iter().copied().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect();
            assert!(refusal(name, wide).contains("UTF-16; save it as UTF-8"));
        }
    }
    // Two files joined.
    let joined = format!("{SQUARE}\u{feff}v 5 5 5\nf -1 1 2\n");
    assert_eq!(mesh_of("a.obj", joined).0.triangles.len(), 3);
}

#[test]
fn polygons_with_reflex_corners_keep_area_and_normals() {
    for (name, text) in [("a.obj", ARROWHEAD), ("a.ply", PLY)] {
        let (mesh, notes) = mesh_of(name, text);
        assert!((area(&mesh) - 1.0).abs() < 1e-6 && notes.is_empty(), "{notes}");
        assert!(mesh.normals.iter().all(|normal| *normal == Vec3::Z), "{:?}", mesh.normals);
    }
    let crossing = SQUARE.replace("f 1 2 3 4", "f 1 3 2 4");
    assert!(mesh_of("a.obj", crossing).1.contains("cross themselves"));
}

#[test]
fn a_polygon_of_a_hundred_thousand_corners_takes_no_square_of_that() {
    let count = 100_000;
    let mut text = String::new();
    for i in 0..count {
        let (sin, cos) = (f64::from(i) / f64::from(count) * std::f64::consts::TAU).sin_cos();
        let radius = if i % 2 == 0 { 1.0 } else { 0.7 };
        text += &format!("v {} {} 0\n", radius * cos, radius * sin);
    }
    text += "f";
    (1..=count).for_each(|i| text += &format!(" {i}"));
    let start = Instant::now();
    let (mesh, notes) = mesh_of("a.obj", text + "\n");
    assert!(start.elapsed() < Duration::from_secs(120), "{:?}", start.elapsed());
    // A triangle at the centre for each edge: r·R·sin(2π/n)/2.
    let expected = 0.35 * f64::from(count) * (std::f64::consts::TAU / f64::from(count)).sin();
    assert!((area(&mesh) / expected - 1.0).abs() < 1e-4 && notes.is_empty(), "{} {expected} {notes}", area(&mesh));
}

#[test]
fn lines_end_and_go_on_in_all_ways() {
    let expected = mesh_of("a.obj", SQUARE);
    assert_eq!(mesh_of("a.obj", SQUARE.replace("1 2 3 4", "1 2 \\\n 3 4")), expected);
    assert_eq!(mesh_of("a.obj", SQUARE.replace("1 2 3 4", "1 2\\\r\n3 \\ \r\n4")), expected);
    for ends in ["\r", "\r\n", "\n\n"] {
        assert_eq!(mesh_of("a.obj", format!("# c{ends}") + &SQUARE.replace('\n', ends)), expected, "{ends:?}");
        assert_eq!(mesh_of("a.ply", PLY.replace('\n', ends)), mesh_of("a.ply", PLY), "{ends:?}");
    }
    // A name or a comment that ends in a backslash swallows nothing.
    let text = format!("mtllib C:\\m\\\n# C:\\m\\\nusemtl a\\\n{SQUARE}");
    assert_eq!(mesh_of("a.obj", text), expected);
    assert!(refusal("a.obj", SQUARE.replace("1 2 3 4", "1 2 \\\n 3 x")).starts_with("a.obj:6: "));
    assert!(refusal("a.obj", SQUARE.replace("1 2 3 4", "1 2 \\\n 3 9 \\\n 4")).starts_with("a.obj:6: "));
    assert_eq!(
        mesh_of("a.obj", SQUARE.replace("f 1 2 3 4", "f 1 2 3#4\nf 1 3 4 # 2").replace("v 1 1 0", "v 1 1 0# c")).0,
        expected.0
    );
}

#[test]
fn vertex_colours_stay_with_their_vertices() {
    let text = "o b\nv 0 0 1 1 0 0\nv 1 0 1 1 0 0\nv 1 1 1 1 0 0\nf 1 2 3\no a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 4 5 6\n";
    let (mesh, notes) = mesh_of("a.obj", text);
    assert!(notes.is_empty() && mesh.colors.len() == 6, "{notes}");
    for (position, color) in mesh.positions.iter().zip(&mesh.colors) {
        assert_eq!(*color, if position.z == 1.0 { Vec3::X } else { Vec3::ONE });
    }
    let (mesh, notes) = mesh_of("a.obj", SQUARE.replace("v 1 1 0", "v 1 1 0 0.5 0.25 0 0.5"));
    assert_eq!(color_at(&mesh, Vec3::new(1.0, 1.0, 0.0)), Vec3::new(0.5, 0.25, 0.0));
    assert!(color_at(&mesh, Vec3::ZERO) == Vec3::ONE && notes.contains("alpha"), "{notes}");
    let (mesh, notes) = mesh_of("a.obj", SQUARE.replace("v 1 1 0", "v 1 1 0 128 64 0"));
    let expected = Vec3::new(linear(128), linear(64), 0.0);
    assert!(color_at(&mesh, Vec3::new(1.0, 1.0, 0.0)).distance(expected) < 1e-6 && notes.contains("8 bits"), "{notes}");
    for bad in ["nan", "-1", "inf", "300"] {
        let error = refusal("a.obj", SQUARE.replace("v 1 1 0", &format!("v 1 1 0 {bad} 0 0")));
        assert!(error.starts_with("a.obj:3: ") && error.contains("colour"), "{error}");
    }
}

/// A triangle with a colour of these numbers at its second corner.
pub(crate) fn colored(of: &str, color: [&str; 3]) -> String {
    let [r, g, b] = color;
    format!(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
         property {of} red\nproperty {of} green\nproperty {of} blue\nelement face 1\n\
         property list uchar int vertex_index\nend_header\n0 0 0 0 0 0\n1 0 0 {r} {g} {b}\n0 1 0 0 0 0\n3 0 1 2\n"
    )
}

#[test]
fn bytes_are_srgb_floats_linear_unless_told_otherwise() {
    let color = |of: &str, color: [&str; 3], told| {
        let (mesh, _) = mesh::parse(Path::new("a.ply"), colored(of, color).as_bytes(), told).unwrap();
        color_at(&mesh, Vec3::X)
    };
    let expected = Vec3::new(linear(128), linear(64), 1.0);
    let close = |found: Vec3, expected: Vec3| assert!(found.distance(expected) < 1e-5, "{found} {expected}");
    close(color("uchar", ["128", "64", "255"], None), expected);
    close(color("ushort", ["32896", "16448", "65535"], None), expected);
    for of in ["ushort", "short", "int", "uint", "float"] {
        close(color(of, ["128", "64", "255"], None), expected);
    }
    close(color("char", ["-128", "64", "-1"], None), expected);
    close(color("float", ["0.5", "0.25", "1"], None), Vec3::new(0.5, 0.25, 1.0));
    let fractions = Vec3::new(128.0, 64.0, 255.0) / 255.0;
    close(color("uchar", ["128", "64", "255"], Some(ColorEncoding::Linear)), fractions);
    close(color("float", ["0.5019608", "0.2509804", "1"], Some(ColorEncoding::Srgb)), expected);
    for (of, bad) in
        [("float", "nan"), ("float", "-0.5"), ("float", "1e9"), ("int", "-3"), ("uint", "70000"), ("uchar", "256")]
    {
        assert!(refusal("a.ply", colored(of, [bad, "0", "0"])).starts_with("a.ply:14: "), "{of} {bad}");
    }
}

#[test]
fn a_scene_file_says_how_colours_are_encoded() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("a.ply", &colored("uchar", ["128", "64", "255"]));
    write("b.obj", SQUARE);
    let scene = |object: &str| {
        write("s.toml", &format!("\u{feff}[[object]]\n{object}\n"));
        halfshade_scene::file::load(&folder.path().join("s.toml"))
    };
    let red = |scene: halfshade_scene::Scene| color_at(&scene.objects[0].mesh, Vec3::X).x;
    assert!((red(scene("mesh = \"a.ply\"").unwrap()) - linear(128)).abs() < 1e-6);
    assert!((red(scene("mesh = \"a.ply\"\ncolors = \"linear\"").unwrap()) - 128.0 / 255.0).abs() < 1e-6);
    for (object, part) in [
        ("mesh = \"a.ply\"\ncolors = \"gamma\"", "s.toml:3:10: "),
        ("mesh = \"b.obj\"\ncolors = \"srgb\"", "s.toml:3:10: `b` has no vertex colours"),
        ("shape = \"box\"\ncolors = \"srgb\"", "this is a shape"),
        ("mesh = \"a.glb\"\nanimation = 0\ncolors = \"srgb\"", "linear by its specification"),
    ] {
        let error = scene(object).unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
    // Notes arrive with the file's name.
    write("b.obj", &(SQUARE.to_owned() + "l 1 2\n"));
    let notes = scene("mesh = \"b.obj\"").unwrap().notes;
    assert!(notes.len() == 1 && notes[0].contains("b.obj: `l` left out"), "{notes:?}");
}

#[test]
fn normals_of_no_use_are_computed_with_a_note() {
    for bad in ["-nan(ind) -nan(ind) -nan(ind)", "nan 0 0", "inf 0 0", "1.#IND 0 0", "-1.#QNAN 0 1.#INF", "0 0 0"] {
        let (mesh, notes) = mesh_of("a.obj", SQUARE.replace("f 1 2 3 4", &format!("vn {bad}\nf 1//1 2//1 3//1 4//1")));
        assert!(mesh.normals.iter().all(|normal| *normal == Vec3::Z) && notes.contains("directions"), "{bad}: {notes}");
        let error = refusal("a.obj", SQUARE.replace("v 1 1 0", &format!("v {}", bad.replace("0 0 0", "0 0 1e99"))));
        assert!(error.starts_with("a.obj:3: ") && error.contains("not a finite number"), "{error}");
    }
    // Corners without one beside corners with one.
    let (mesh, notes) = mesh_of("a.obj", SQUARE.replace("f 1 2 3 4", "vn 1 0 0\nf 1//1 2 3 4"));
    assert!(mesh.normals[0] == Vec3::X && mesh.normals[2] == Vec3::Z && notes.is_empty(), "{:?}", mesh.normals);
}

#[test]
fn faces_of_all_forms_are_read() {
    let (expected, _) = mesh_of("a.obj", SQUARE);
    for face in ["f -4 -3 -2 -1", "fo 1 2 3 4", "f 1 2 3 4 # 5", "f 1// 2/ 3 4", "f 1 1 2 3 3 4", "f +1 2 3 4"] {
        let (mesh, _) = mesh_of("a.obj", SQUARE.replace("f 1 2 3 4", face));
        assert!((area(&mesh) - 1.0).abs() < 1e-9 && mesh.positions == expected.positions, "{face}");
    }
    // Faces before their vertices.
    let (mesh, _) = mesh_of("a.obj", format!("f 1 2 3 4\n{}", SQUARE.replace("f 1 2 3 4\n", "")));
    assert_eq!(mesh, expected);
    let mixed = "vt 0.5 1\nvt 0.25\nvt 0 0 0\nvn 0 0 1\nf 1 2/2 3//1 4/1/1";
    let (mesh, notes) = mesh_of("a.obj", SQUARE.replace("f 1 2 3 4", mixed));
    assert!(mesh.texture_coordinates.is_empty() && notes.contains("2 of 4 corners"), "{notes}");
    let (mesh, notes) = mesh_of("a.obj", SQUARE.replace("v 1 1 0", "v 1 1 0 1.0"));
    assert!(mesh == expected && notes.is_empty());
}

#[test]
fn nothing_that_may_be_geometry_is_dropped_without_a_word() {
    for (from, to, line, part) in [
        ("v 1 1 0", "V 1 1 0", 3, "lower case"),
        ("f 1", "F 1", 5, "lower case"),
        ("v 1 1 0", "v1 1 0", 3, "`v1`"),
        ("v 1 1 0", "vertex 1 1 0", 3, "`vertex`"),
        ("v 1 1 0", "v,1,1,0", 3, "`v,1,1,0`"),
        ("v 1 1 0", "v 1,5 1,0 0,0", 3, "decimal point"),
        ("v 1 1 0", "v 1,1,0", 3, "decimal point"),
        ("v 1 1 0", "v 1 0x10 0", 3, "y is not"),
        ("v 1 1 0", "v 1 1 0f", 3, "z is not"),
        ("v 1 1 0", "v 1 1", 3, "z is missing"),
        ("v 1 1 0", "v 1 1 0 2", 3, "weight"),
        ("v 1 1 0", "v 1 1 0 1 1", 3, "five numbers"),
        ("v 1 1 0", "v 1 1 0 1 1 1 1 1", 3, "too many"),
        ("v 1 1 0", "v 1 1 0 x", 3, "`x`"),
        ("v 1 1 0", "v 1 1 1e20", 3, "too far"),
        ("f 1", "vn 0 0 1 0\nf 1", 5, "too many"),
        ("f 1", "vn 0 0\nf 1", 5, "z is missing"),
        ("f 1", "vt 0 0 0 0\nf 1", 5, "too many"),
        ("f 1", "vt\nf 1", 5, "u is missing"),
        ("f 1", "f 0", 5, "count from 1"),
        ("f 1", "f 1/0/0", 5, "count from 1"),
        ("f 1", "f 5", 5, "vertex 5"),
        ("f 1", "f -5", 5, "before the first"),
        ("f 1", "f 99999999999", 5, "vertex 99999999999"),
        ("f 1", "f 1/2/3/4", 5, "no corner"),
        ("f 1", "f /1", 5, "no corner"),
        ("f 1", "f 1.0", 5, "no corner"),
        ("f 1", "f 1,2", 5, "no corner"),
        ("f 1 2 3 4", "f 1 2", 5, "three corners"),
        ("f 1 2 3 4", "l 1 2 3 4\np 1", 0, "`l` left out"),
        ("f 1 2 3 4", "cstype bezier\nsurf 0 1 0 1 1 2 3 4\nend", 0, "`surf` left out"),
    ] {
        let error = refusal("a.obj", SQUARE.replacen(from, to, 1));
        let start = if line == 0 { "a.obj: ".to_owned() } else { format!("a.obj:{line}: ") };
        assert!(error.starts_with(&start) && error.contains(part), "{to}: {error}");
    }
    for (addition, part) in [
        ("l 1 2\nl 2 3\n", "`l` left out, only faces are read: 2, the first in line 6"),
        ("p 1\n", "`p`"),
        ("curv 0 1 1 2\n", "`curv`"),
        ("bzp 1 2 3\n", "`bzp`"),
        ("call other.obj\n", "`call`"),
        ("Exported by hand\n", "not understood, left out: 1, the first in line 6"),
    ] {
        let (mesh, notes) = mesh_of("a.obj", format!("{SQUARE}{addition}"));
        assert!(mesh.triangles.len() == 2 && notes.contains(part), "{addition}: {notes}");
    }
    let silent =
        "o a1\ng b2 c\ns 1\ns off\nusemtl d 3\nmtllib e.mtl\nlod_1\nmg 1 2\nbevel on\nvp 1 2\n".replace("lod_1\n", "");
    assert_eq!(mesh_of("a.obj", silent + SQUARE), mesh_of("a.obj", SQUARE));
}

#[test]
fn strips_and_faces_are_read_together() {
    let text = "ply\nformat ascii 1.0\nelement vertex 7\nproperty float x\nproperty float y\nproperty float z\n\
                element face 1\nproperty list uchar int vertex_indices\nelement tristrips 1\n\
                property list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 0 0\n3 0 0\n2 1 0\n\
                3 4 5 6\n4 0 1 2 3\n";
    let (mesh, notes) = mesh_of("a.ply", text);
    assert!((area(&mesh) - 1.5).abs() < 1e-9 && notes.is_empty(), "{notes}");
    assert!(mesh.normals.iter().all(|normal| *normal == Vec3::Z));
    // Begun anew, after corners turned by triangles without area.
    for (of, again) in [("int", "-1"), ("uint", "4294967295"), ("uchar", "255")] {
        let restarted = text
            .replace("int int", &format!("int {of}"))
            .replace("4 0 1 2 3", &format!("10 0 1 2 {again} 3 3 2 1 {again} {again}"));
        let (mesh, notes) = mesh_of("a.ply", restarted);
        assert!((area(&mesh) - 1.5).abs() < 1e-9, "{of}: {notes}");
        assert!(mesh.normals.iter().all(|normal| *normal == Vec3::Z), "{of}: {:?}", mesh.normals);
    }
    assert!(refusal("a.ply", text.replace("4 0 1 2 3", "4 0 1 2 -2")).starts_with("a.ply:20: strip 0 names vertex -2"));
    // Strips alone.
    let alone = text.replace("element face 1\nproperty list uchar int vertex_indices\n", "").replace("3 4 5 6\n", "");
    assert!((area(&mesh_of("a.ply", alone).0) - 1.0).abs() < 1e-9);
}

#[test]
fn what_else_ply_files_hold_is_read_or_named() {
    let (expected, _) = mesh_of("a.ply", PLY);
    let faces_first = PLY
        .replace("element vertex 4\nproperty float x\nproperty float y\nproperty float z\n", "")
        .replace("end_header\n0 0 0\n2 1 0\n0 2 0\n1 1 0\n4 0 1 2 3\n", "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nend_header\n4 0 1 2 3\n\n0 0 0\n2 1 0\ncomment c\n0 2 0\n1 1 0\n");
    assert_eq!(mesh_of("a.ply", faces_first), (expected.clone(), String::new()));
    for of in ["float", "double", "short", "uint8"] {
        assert_eq!(mesh_of("a.ply", PLY.replace("uchar int", &format!("uint {of}"))).0, expected);
    }
    assert_eq!(
        mesh_of("a.ply", PLY.replace("element face", "element empty 0\nelement face")),
        (expected.clone(), String::new())
    );
    for (from, to, part) in [
        ("end_header", "element edge 1\nproperty int vertex1\nend_header", "`edge` left out"),
        (
            "end_header",
            "element range_grid 1\nproperty list uchar int vertex_indices\nend_header",
            "`range_grid` left out",
        ),
    ] {
        let text = PLY.replace(from, to) + if part.contains("edge") { "1\n" } else { "1 0\n" };
        let (mesh, notes) = mesh_of("a.ply", text);
        assert!(mesh == expected && notes.contains(part), "{notes}");
    }
    let flagged =
        PLY.replace("vertex_index\n", "vertex_index\nproperty int material_id\n").replace("4 0 1 2 3", "4 0 1 2 3 7");
    assert!(mesh_of("a.ply", flagged).1.contains("faces left out: material_id"));
    let transparent = PLY.replace("float z\n", "float z\nproperty uchar alpha\n").replace(" 0\n", " 0 9\n");
    assert!(mesh_of("a.ply", transparent).1.contains("alpha of vertex colours left out, every vertex is opaque: 4"));
    let measured = PLY.replace("float z\n", "float z\nproperty float quality\nproperty list uchar int Rings\n");
    let (mesh, notes) = mesh_of("a.ply", measured.replace(" 0\n", " 0 9 2 1 1\n"));
    assert_eq!((&mesh, &*notes), (&expected, "properties of vertices left out: quality, Rings"));
    let capitals = PLY
        .replace("float x", "float X")
        .replace("float z\n", "float z\nproperty uchar Red\nproperty uchar Green\nproperty uchar Blue\n")
        .replace(" 0\n", " 0 255 0 0\n");
    let (mesh, notes) = mesh_of("a.ply", capitals);
    assert!(notes.is_empty() && mesh.positions == expected.positions && mesh.colors == [Vec3::X; 4], "{notes}");
    let normals = PLY
        .replace("float z\n", "float z\nproperty float nx\nproperty float ny\nproperty float nz\n")
        .replace(" 0\n", " 0 0 -nan(ind) 1\n");
    let (mesh, notes) = mesh_of("a.ply", normals);
    assert!(mesh.normals == expected.normals && notes.contains("directions, computed instead: 4"), "{notes}");
    for (from, to, line, part) in [
        ("1 1 0\n", "1 1 0 5\n", 13, "one number more"),
        ("1 1 0\n", "1 1\n", 13, "ends before `z`"),
        ("1 1 0\n", "1 nan 0\n", 13, "not a finite"),
        ("1 1 0\n", "1 1,5 0\n", 13, "decimal point"),
        ("4 0 1 2 3", "4 0 1 2 3\n3 0 1 2", 15, "doesn't count"),
        ("4 0 1 2 3", "3 0 1 2 3", 14, "one number more"),
        ("4 0 1 2 3", "4 0 1 2 1.5", 14, "whole number"),
        ("4 0 1 2 3", "99 0 1 2 3", 14, "99 items"),
        ("element face 1", "element face 2", 14, "file ends"),
    ] {
        let error = refusal("a.ply", PLY.replacen(from, to, 1));
        assert!(error.starts_with(&format!("a.ply:{line}: ")) && error.contains(part), "{to}: {error}");
    }
    assert!(
        refusal("a.ply", PLY.replace("uchar int", "uchar float").replace("2 3\n", "2 1.5\n")).contains("vertex 1.5")
    );
    assert!(refusal("a.ply", PLY.replace("vertex_index", "corners")).contains("but: corners"));
}

#[test]
fn texture_coordinates_of_corners_split_vertices() {
    let wedges = |last: &str| {
        PLY.replace("element face 1", "element face 2")
            .replace("vertex_index\n", "vertex_index\nproperty list uchar float texcoord\n")
            .replace("4 0 1 2 3\n", &format!("3 0 1 3 6 0 0 1 0 0.5 1\n3 1 2 3 {last}\n"))
    };
    let (mesh, notes) = mesh_of("a.ply", wedges("6 1 0 0 0 0.5 1"));
    assert!((area(&mesh) - 1.0).abs() < 1e-6 && mesh.positions.len() == 4 && notes.is_empty(), "{notes}");
    assert_eq!(mesh.texture_coordinates[0], Vec3::new(0.0, 1.0, 0.0));
    let (mesh, _) = mesh_of("a.ply", wedges("6 0.25 0 0 0 0.5 1"));
    assert_eq!(mesh.positions.len(), 5);
    let (mesh, notes) = mesh_of("a.ply", wedges("0"));
    assert!(mesh.texture_coordinates.is_empty() && notes.contains("3 of 6 corners"), "{notes}");
    assert!(refusal("a.ply", wedges("2 0 0")).contains("2 numbers in `texcoord`"));
}
