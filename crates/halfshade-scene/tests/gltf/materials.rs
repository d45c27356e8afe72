//! Base colour and alpha of glTF files, against closed forms.

use super::glb::Builder;
use glam::{DVec3, Vec3};
use halfshade_scene::SceneError;
use halfshade_scene::mesh::{self, Mesh};

/// The unit square of two triangles: accessors 0 (positions) and 1 (indices).
fn square() -> Builder {
    let mut builder = Builder::default();
    builder.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
    builder.indices(&[0, 1, 2, 0, 2, 3]);
    builder
}

/// A PNG of these pixels, row by row.
fn png(width: u32, pixels: &[[u8; 4]]) -> Vec<u8> {
    let bytes = pixels.concat();
    let image = image::RgbaImage::from_raw(width, pixels.len() as u32 / width, bytes).unwrap();
    let mut out = std::io::Cursor::new(Vec::new());
    image.write_to(&mut out, image::ImageFormat::Png).unwrap();
    out.into_inner()
}

fn load(builder: &Builder, attributes: &str, material: &str, rest: &str) -> Result<(Mesh, Vec<String>), SceneError> {
    let bytes = builder.glb(&format!(
        r#""scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],"materials":[{{{material}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0{attributes}}},"indices":1,"material":0}}]}}]{rest}"#
    ));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.glb");
    std::fs::write(&path, &bytes).unwrap();
    mesh::load_with_notes(&path)
}

/// The area that no mask cuts out, from samples within each triangle.
fn left_area(mesh: &Mesh) -> f64 {
    const N: usize = 64;
    let mut area = 0.0;
    for (number, triangle) in mesh.triangles.iter().enumerate() {
        let [a, b, c] = triangle.map(|v| mesh.positions[v as usize].as_dvec3());
        let whole = 0.5 * (b - a).cross(c - a).length();
        for i in 0..N {
            for j in 0..N {
                // The unit square folded onto the triangle.
                let (mut v, mut w) = ((i as f64 + 0.5) / N as f64, (j as f64 + 0.5) / N as f64);
                if v + w > 1.0 {
                    (v, w) = (1.0 - v, 1.0 - w);
                }
                let weights = DVec3::new(1.0 - v - w, v, w);
                area += whole / (N * N) as f64 * f64::from(u8::from(!mesh.is_cut_out(number, weights)));
            }
        }
    }
    area
}

/// A square with a texture of these pixels, whose left and right edges are those of the square.
fn textured(width: u32, pixels: &[[u8; 4]]) -> (Builder, String) {
    let mut builder = square();
    builder.floats("VEC2", &[0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    let view = builder.view(&png(width, pixels));
    let rest = format!(
        r#","textures":[{{"source":0,"sampler":0}}],"samplers":[{{"wrapS":33071,"wrapT":33071}}],
        "images":[{{"bufferView":{view},"mimeType":"image/png"}}]"#
    );
    (builder, rest)
}

const UV: &str = r#","TEXCOORD_0":2"#;
const TEXTURE: &str = r#""pbrMetallicRoughness":{"baseColorTexture":{"index":0}}"#;

#[test]
fn a_mask_cuts_out_what_lies_below_its_cutoff() {
    // Alpha 1 and 0, side by side: between the centres of texels it falls from 1 to 0, from x = 1/4 to 3/4.
    let (builder, rest) = textured(2, &[[255; 4], [255, 255, 255, 0]]);
    for (cutoff, expected) in [("", 0.5), (r#","alphaCutoff":0.25"#, 0.625), (r#","alphaCutoff":0.9"#, 0.3)] {
        let (mesh, notes) = load(&builder, UV, &format!(r#"{TEXTURE},"alphaMode":"MASK"{cutoff}"#), &rest).unwrap();
        assert!((left_area(&mesh) - expected).abs() < 0.01, "{cutoff}: {}", left_area(&mesh));
        assert!(notes.len() == 1 && notes[0].contains("alpha masks"), "{notes:?}");
    }
    // Without a mode, alpha says nothing; blending is a note.
    let (mesh, notes) = load(&builder, UV, TEXTURE, &rest).unwrap();
    assert!(!mesh.has_cutouts() && notes.is_empty() && left_area(&mesh) == 1.0);
    let (mesh, notes) = load(&builder, UV, &format!(r#"{TEXTURE},"alphaMode":"BLEND""#), &rest).unwrap();
    assert!(!mesh.has_cutouts() && notes.len() == 1 && notes[0].contains("blending"), "{notes:?}");
}

#[test]
fn the_nearest_texel_counts_where_the_sampler_says_so() {
    let (builder, rest) = textured(2, &[[255, 0, 0, 255], [0, 0, 255, 0]]);
    for (filter, is_nearest) in [
        (r#""magFilter":9728,"#, true),
        (r#""magFilter":9729,"minFilter":9728,"#, false),
        (r#""magFilter":9728,"minFilter":9987,"#, true),
        (r#""minFilter":9984,"#, true),
        (r#""minFilter":9985,"#, false),
        (r#""minFilter":9986,"#, true),
        (r#""minFilter":9987,"#, false),
    ] {
        let rest = rest.replace(r#""samplers":[{"#, &format!(r#""samplers":[{{{filter}"#));
        let masked = format!(r#"{TEXTURE},"alphaMode":"MASK","alphaCutoff":0.9"#);
        let (mesh, _) = load(&builder, UV, &masked, &rest).unwrap();
        // Alpha falls from 1 to 0 between 1/4 and 3/4, or at 1/2.
        let expected = if is_nearest { 0.5 } else { 0.3 };
        assert!((left_area(&mesh) - expected).abs() < 0.01, "{filter}: {}", left_area(&mesh));
        let middle = mesh.textures[0].at(glam::DVec2::new(0.49, 0.5));
        assert_eq!(middle == Vec3::X, is_nearest, "{filter}: {middle}");
    }
}

#[test]
fn factor_vertices_and_texture_multiply() {
    let (mut builder, rest) = textured(2, &[[255; 4], [255, 255, 255, 0]]);
    // Alpha of vertices: 1 below, 0 above.
    let alpha = |a| [1.0, 1.0, 1.0, a];
    let colors = builder.floats("VEC4", &[alpha(1.0), alpha(1.0), alpha(0.0), alpha(0.0)].concat());
    let attributes = format!(r#"{UV},"COLOR_0":{colors}"#);
    let material = |factor: f64| {
        format!(
            r#""pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}},"baseColorFactor":[1,1,1,{factor}]}},"alphaMode":"MASK","alphaCutoff":0.25"#
        )
    };
    // ∫ over x of the height below which factor · f(x) · (1 - y) ≥ cutoff.
    let expected = |factor: f64| {
        let height = |x: f64| (1.0 - 0.25 / (factor * (1.5 - 2.0 * x).clamp(1e-9, 1.0))).clamp(0.0, 1.0);
        (0..10_000).map(|i| height((f64::from(i) + 0.5) / 1e4) / 1e4).sum::<f64>()
    };
    for factor in [1.0, 0.5] {
        let (mesh, _) = load(&builder, &attributes, &material(factor), &rest).unwrap();
        assert!((left_area(&mesh) - expected(factor)).abs() < 0.01, "{} {}", left_area(&mesh), expected(factor));
    }
}

#[test]
fn alpha_that_is_the_same_all_over_keeps_or_drops_the_whole() {
    let material = |alpha: f64, mode: &str| {
        format!(r#""pbrMetallicRoughness":{{"baseColorFactor":[1,1,1,{alpha}]}},"alphaMode":"{mode}""#)
    };
    for alpha in [0.5, 0.8, 1.0] {
        let (mesh, notes) = load(&square(), "", &material(alpha, "MASK"), "").unwrap();
        assert!(!mesh.has_cutouts() && notes.is_empty() && mesh.triangles.len() == 2);
    }
    for alpha in [0.0, 0.49] {
        let error = load(&square(), "", &material(alpha, "MASK"), "").unwrap_err().to_string();
        assert!(error.contains("alpha masks cut out all") && error.contains("alphaCutoff"), "{error}");
    }
    assert!(load(&square(), "", &material(1.0, "BLEND"), "").unwrap().1.is_empty());
    assert_eq!(load(&square(), "", &material(0.0, "BLEND"), "").unwrap().1.len(), 1);
    // A texture that is opaque costs nothing.
    let (builder, rest) = textured(2, &[[255; 4], [9, 9, 9, 200]]);
    let (mesh, notes) = load(&builder, UV, &format!(r#"{TEXTURE},"alphaMode":"MASK""#), &rest).unwrap();
    assert!(!mesh.has_cutouts() && notes.is_empty());
}

/// Colour of the texture of the vertex that stands at a place.
fn color_at(mesh: &Mesh, place: [f32; 3]) -> Vec3 {
    let vertex = mesh.positions.iter().position(|p| p.distance(Vec3::from(place)) < 1e-6).unwrap();
    let coordinates = mesh.texture_coordinates[vertex];
    mesh.textures[coordinates.z as usize].at(coordinates.truncate().as_dvec2())
}

#[test]
fn coordinates_may_be_whole_numbers_that_a_transform_scales() {
    let mut builder = square();
    let list = |list: [u16; 8]| list.map(u16::to_le_bytes).concat();
    builder.list("VEC2", 5123, 4, &list([0, 4095, 4095, 4095, 4095, 0, 0, 0]), "");
    builder.list("VEC2", 5123, 4, &list([0, 65535, 65535, 65535, 65535, 0, 0, 0]), r#","normalized":true"#);
    let view = builder.view(&png(2, &[[255, 0, 0, 255], [0, 0, 255, 255]]));
    let rest = format!(
        r#","textures":[{{"source":0,"sampler":0}}],"samplers":[{{"wrapS":33071}}],"images":[{{"bufferView":{view},"mimeType":"image/png"}}],
        "extensionsUsed":["KHR_mesh_quantization","KHR_texture_transform"]"#
    );
    let scaled = r#""pbrMetallicRoughness":{"baseColorTexture":{"index":0,
        "extensions":{"KHR_texture_transform":{"scale":[0.0002442002442002442,0.0002442002442002442]}}}}"#;
    for (attributes, material) in [(UV, scaled), (r#","TEXCOORD_0":3"#, TEXTURE)] {
        let (mesh, notes) = load(&builder, attributes, material, &rest).unwrap();
        assert!(notes.is_empty());
        assert_eq!((color_at(&mesh, [0.0; 3]), color_at(&mesh, [1.0, 0.0, 0.0])), (Vec3::X, Vec3::Z));
    }
}

#[test]
fn diffuse_colour_of_specular_gloss_is_the_albedo() {
    let (builder, rest) = textured(2, &[[255, 0, 0, 255], [0, 0, 255, 255]]);
    let material = r#""extensions":{"KHR_materials_pbrSpecularGlossiness":{"diffuseFactor":[0.5,0.25,1,1],"diffuseTexture":{"index":0}}}"#;
    let rest = rest + r#","extensionsUsed":["KHR_materials_pbrSpecularGlossiness"]"#;
    let (mesh, notes) = load(&builder, UV, material, &rest).unwrap();
    assert!(notes.is_empty() && mesh.colors[0] == Vec3::new(0.5, 0.25, 1.0), "{notes:?} {:?}", mesh.colors);
    assert_eq!((color_at(&mesh, [0.0; 3]), color_at(&mesh, [1.0, 0.0, 0.0])), (Vec3::X, Vec3::Z));
}

#[test]
fn light_that_a_material_emits_is_told() {
    for (emission, expected) in [("[0, 0, 0]", false), ("[0, 0.5, 0]", true)] {
        let (_, notes) = load(&square(), "", &format!(r#""emissiveFactor": {emission}"#), "").unwrap();
        assert_eq!(
            notes.iter().any(|note| note.contains("light that materials emit left out: 1")),
            expected,
            "{notes:?}"
        );
    }
}

#[test]
fn of_a_webp_texture_the_image_beside_it_is_taken_and_what_cannot_be_read_is_named() {
    let (builder, rest) = textured(2, &[[255, 0, 0, 255], [0, 0, 255, 255]]);
    let webp = |texture: &str, images: &str| {
        let rest = rest.replace(r#""source":0,"sampler":0"#, texture).replace(r#""images":["#, images);
        load(&builder, UV, TEXTURE, &format!(r#"{rest},"extensionsUsed":["EXT_texture_webp"]"#))
    };
    let both = r#""source":0,"sampler":0,"extensions":{"EXT_texture_webp":{"source":1}}"#;
    let (mesh, notes) = webp(both, r#""images":["#).unwrap();
    assert!(notes.is_empty() && color_at(&mesh, [0.0; 3]) == Vec3::X);
    let alone = r#""extensions":{"EXT_texture_webp":{"source":0}}"#;
    let uri = r#""images":[{"uri":"data:image/webp;base64,UklGRhoAAABXRUJQVlA4TA0AAAAvAAAAEAcQERGIiP4HAA=="},"#;
    let error = webp(alone, uri).unwrap_err().to_string();
    assert!(error.contains("image 0") && error.contains("WebP") && error.contains("convert it to PNG"), "{error}");
    for (texture, part) in
        [("", "texture 0 names no image"), (r#""extensions":{"EXT_texture_webp":{"source":7}}"#, "image 7")]
    {
        let error = webp(texture, r#""images":["#).unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
}
