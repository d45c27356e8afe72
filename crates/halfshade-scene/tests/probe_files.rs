//! Light probes as others write them: pictures of known values, written by OpenEXR's own library (3.5) and by hand.

use crate::picture_files::{radiance_picture, stored, written};
use glam::Vec3;
use halfshade_scene::light::{EnvironmentMap, ProbeOptions, load_probe};

/// Options by layer and largest radiance.
fn options(layer: Option<&str>, clamp: Option<f32>) -> ProbeOptions {
    ProbeOptions { layer: layer.map(str::to_owned), clamp, ..ProbeOptions::default() }
}

fn read(name: &str) -> (EnvironmentMap, Vec<String>) {
    load_probe(&stored(name), &ProbeOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// Radiance of the stored pictures of 16 by 8 at (x, y) of their display window, unless said otherwise.
fn expected(x: usize, y: usize) -> Vec3 {
    Vec3::new(1.0 + x as f32, 1.0 + y as f32, 0.5)
}

fn assert_texels(name: &str, tolerance: f32, expected: impl Fn(usize, usize) -> Vec3) {
    let (map, notes) = read(name);
    assert_eq!((map.width(), map.height(), notes.len()), (16, 8, 0), "{name}: {notes:?}");
    for (i, texel) in map.texels().iter().enumerate() {
        let expected = expected(i % 16, i / 16);
        let off = (*texel - expected).abs().max_element();
        assert!(off <= tolerance * expected.max_element(), "{name}, texel {i}: {texel} not {expected}");
    }
}

/// Irradiance over π that a receiver facing up has, texel by texel: rows span angles from the zenith, over which
/// ∫ cos θ sin θ dθ = (sin²θ₁ − sin²θ₀)/2.
fn upward_irradiance(map: &EnvironmentMap) -> Vec3 {
    let (width, height) = (map.width(), map.height());
    let sine_squared = |row: usize| (row as f32 * std::f32::consts::PI / height as f32).sin().powi(2);
    let row = |row: usize| (sine_squared(row + 1) - sine_squared(row)) / width as f32;
    (0..height / 2)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .map(|(x, y)| row(y) * map.texels()[y * width + x])
        .sum()
}

#[test]
fn every_encoding_gives_the_same_picture() {
    for name in ["none", "rle", "zips", "piz", "pxr24", "decreasing", "tiled", "mipmapped", "mixed"] {
        assert_texels(&format!("{name}.exr"), 0.0, expected);
    }
    // These lose something by design.
    assert_texels("b44.exr", 0.04, expected);
    assert_texels("dwaa.exr", 0.05, expected);
}

#[test]
fn the_picture_is_the_display_window() {
    // Columns 4 to 11, rows 2 to 5.
    let inside = |x, y| if (4..12).contains(&x) && (2..6).contains(&y) { expected(x, y) } else { Vec3::ZERO };
    assert_texels("smaller.exr", 0.0, inside);
    assert_texels("larger.exr", 0.0, |x, y| Vec3::new(100.0 + x as f32, 100.0 + y as f32, 0.5));
    // Data from (-8, 3) to (7, 10), display from (-12, 1).
    let shifted = |x: usize, y: usize| match (x, y) {
        (4.., 2..) => Vec3::new(100.0 + x as f32 - 12.0, 100.0 + y as f32 + 1.0, 0.5),
        _ => Vec3::ZERO,
    };
    assert_texels("shifted.exr", 0.0, shifted);
    assert_texels("apart.exr", 0.0, |_, _| Vec3::ZERO);
}

/// A window of half the circle's width that spans 45 degrees on either side of the horizon.
#[test]
fn light_of_a_window_falls_as_much_as_the_window_covers() {
    let (map, _) = read("smaller.exr");
    // Blue is 1/2 throughout; of red the mean over columns 4 to 11 is 8.5.
    let quarter = 0.25;
    let found = upward_irradiance(&map);
    assert!((found.z - 0.5 * quarter).abs() < 1e-6 && (found.x - 8.5 * quarter).abs() < 1e-5, "{found}");
}

#[test]
fn layers_parts_and_kinds_of_samples() {
    let constant = |name: &str, layer: Option<&str>| {
        let (map, notes) = load_probe(&stored(name), &options(layer, None)).unwrap();
        assert!(map.texels().iter().all(|texel| *texel == map.texels()[0]));
        (map.texels()[0], notes.concat())
    };
    let (first, note) = constant("parts.exr", None);
    assert_eq!(first, Vec3::new(1.0, 2.0, 3.0));
    assert!(note.contains("`beauty` is taken") && note.contains("`diffuse`"), "{note}");
    assert_eq!(constant("parts.exr", Some("diffuse")), (Vec3::new(4.0, 5.0, 6.0), String::new()));
    let error = |name: &str, layer: Option<&str>| {
        let error = load_probe(&stored(name), &options(layer, None)).unwrap_err().to_string();
        assert!(error.contains(name), "{error}");
        error
    };
    assert!(error("parts.exr", Some("normal")).contains("X, Y, Z in part `normal`"));
    let named = error("named.exr", None);
    assert!(named.contains("rgba.B, rgba.G, rgba.R") && named.contains("--env-layer rgba"), "{named}");
    let (map, _) = load_probe(&stored("named.exr"), &options(Some("rgba"), None)).unwrap();
    assert_eq!(map.texels()[16 + 2], expected(2, 1));
    assert!(error("uint.exr", None).contains("channel G holds whole numbers"));
    let (chroma, _) = constant("chroma.exr", None);
    assert!(chroma.abs_diff_eq(Vec3::new(1.0, 0.5, 0.25), 2e-4), "{chroma}");
}

#[test]
fn chromaticities_are_converted() {
    let (map, notes) = read("aces.exr");
    // (1, 1/2, 1/4) of ACES2065-1 in Rec. 709, by the published matrix.
    let expected = Vec3::new(1.857_732, 0.385_819_8, 0.200_222_6);
    assert!(map.texels()[5].abs_diff_eq(expected, 2e-5) && notes.is_empty(), "{} {notes:?}", map.texels()[5]);
}

#[test]
fn what_is_no_radiance_is_refused_or_clamped() {
    let error = load_probe(&stored("inf.exr"), &ProbeOptions::default()).unwrap_err().to_string();
    for word in ["inf.exr", "column 2, row 3", "not a finite number (and 1 others)", "--clamp 65504", "clamp = 65504"] {
        assert!(error.contains(word), "{error}");
    }
    let (map, notes) = load_probe(&stored("inf.exr"), &options(None, Some(100.0))).unwrap();
    let row = &map.texels()[3 * 16..];
    assert_eq!((row[2].x, row[4].y, row[5].z), (100.0, 0.0, 0.0));
    assert!(notes[0].contains("3 texels"), "{notes:?}");
    for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(load_probe(&stored("inf.exr"), &options(None, Some(bad))).unwrap_err().problem.contains("clamp"));
    }
}

#[test]
fn a_byte_order_mark_before_a_radiance_picture_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let picture = radiance_picture("EXPOSURE=2");
    let marked = [b"\xef\xbb\xbf", &*picture].concat();
    let read = |name, bytes: &[u8]| load_probe(&written(&folder, name, bytes), &options(None, None)).unwrap().0;
    assert_eq!(read("marked.hdr", &marked), read("plain.hdr", &picture));
}

#[test]
fn radiance_pictures_in_other_primaries() {
    let folder = tempfile::tempdir().unwrap();
    let read =
        |header: &str| load_probe(&written(&folder, "p.hdr", &radiance_picture(header)), &ProbeOptions::default());
    let plain = read("FORMAT=32-bit_rle_rgbe").unwrap().0;
    assert_eq!(plain.texels()[16 + 2], Vec3::splat(129.0 / 128.0));
    // White stays white, in whatever primaries.
    for header in ["FORMAT=32-bit_rle_xyze", "PRIMARIES=0.7347 0.2653 0 1 0.0001 -0.077 0.32168 0.33767"] {
        let (map, notes) = read(header).unwrap();
        let close = map.texels().iter().zip(plain.texels()).all(|(a, b)| a.abs_diff_eq(*b, 1e-5));
        assert!(close && notes.is_empty(), "{header}: {notes:?}");
    }
    let error =
        load_probe(&written(&folder, "p.hdr", &radiance_picture("")), &options(Some("rgba"), None)).unwrap_err();
    assert!(error.to_string().contains("no layers"), "{error}");
}
