//! Small inputs that parsers accept, to start from.

use exr::prelude::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, WritableImage};
use std::io::Cursor;

/// Every target's seeds.
pub fn all() -> Vec<(&'static str, Vec<Vec<u8>>)> {
    let texts = |texts: &[&str]| texts.iter().map(|text| text.as_bytes().to_vec()).collect::<Vec<_>>();
    let cache = crate::cache_payloads().into_iter().enumerate().map(|(number, payload)| {
        let kind = u8::try_from(2 * number + 1).expect("few entries");
        [vec![kind], payload].concat()
    });
    vec![
        ("obj", texts(&[OBJ, OBJ_COLOURS, OBJ_CONCAVE])),
        ("ply", ply()),
        ("gltf", vec![gltf("a.bin", ""), gltf(&data_uri(), r#","translation":[0,0,1]"#), gltf_animated()]),
        ("glb", vec![glb(&gltf_of(None, "", ""), &buffer()), glb(&skinned(None), &buffer())]),
        ("hdr", vec![hdr(&[2, 1], false), hdr(&[8, 4], true), hdr(&[4, 4], false)]),
        (
            "exr",
            vec![exr(2, Encoding::UNCOMPRESSED), exr(4, Encoding::SMALL_LOSSLESS), exr(8, Encoding::FAST_LOSSLESS)],
        ),
        ("scene", texts(&[SCENE, SCENE_OF_FILES, SCENE_OF_KEYS])),
        ("mitsuba", texts(&[MITSUBA])),
        ("pbrt", texts(&[PBRT])),
        ("experiment", texts(&[EXPERIMENT, EXPERIMENT_SMALL])),
        ("results", vec![RESULTS.replace('\n', "").into_bytes(), RESULTS.as_bytes().to_vec()]),
        ("journal", vec![journal()]),
        ("cache", cache.collect()),
    ]
}

/// Files that others name.
pub(crate) fn companions() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("a.obj", OBJ.into()),
        ("a.bin", buffer()),
        ("a.hdr", hdr(&[2, 1], false)),
        ("a.toml", SCENE.into()),
        ("a.glb", glb(&skinned(None), &buffer())),
        ("a.png", png()),
    ]
}

const OBJ: &str = "# a square\nmtllib none.mtl\no a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\nf 1/1/1 2/2/1 3/3/1\nf -4 -2 -1\n";
const OBJ_COLOURS: &str =
    "v 0 0 0 1 0 0\r\nv 1 0 0 0 1 0\r\nv 0 1 0\r\nv 0 0 1e3\r\ng x\r\ns off\r\nf 1 2 3\r\nf 1//  2 \\\r\n 4\r\n";
const OBJ_CONCAVE: &str = "v 0 0 0\nv 2 0 0\nv .5 .5 0\nv 0 2 0\nv 3 3 3\nf 1 2 3 4\nl 1 2\np 1\nf 1 2 3 4 5\n";

fn ply() -> Vec<Vec<u8>> {
    let header = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\ncomment c\nelement vertex 4\nproperty float x\nproperty double y\nproperty short z\n\
             property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n\
             property list uchar int vertex_indices\nend_header\n"
        )
    };
    let binary = |big: bool| {
        let mut bytes = header(if big { "binary_big_endian" } else { "binary_little_endian" }).into_bytes();
        let mut put = |le: &[u8]| {
            if big { bytes.extend(le.iter().rev()) } else { bytes.extend(le) }
        };
        for (x, y) in [(0.0_f32, 0.0_f64), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
            put(&x.to_le_bytes());
            put(&y.to_le_bytes());
            put(&0_i16.to_le_bytes());
            [255_u8, 128, 0].iter().for_each(|c| put(&[*c]));
        }
        put(&[4]);
        (0..4_i32).for_each(|corner| put(&corner.to_le_bytes()));
        bytes
    };
    let text = header("ascii") + "0 0 0 255 0 0\n1 0 0 0 255 0\n1 1 0 0 0 255\n0 1 0 51 51 51\n4 0 1 2 3\n";
    let strips = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\n\
                  property float ny\nproperty float nz\nproperty float s\nproperty float t\nelement tristrips 1\n\
                  property list int int vertex_indices\nelement face 1\nproperty list uchar uint vertex_index\nend_header\n\
                  0 0 0 0 0 1 0 0\n1 0 0 0 0 1 1 0\n0 1 0 0 0 1 0 1\n1 1 0 0 0 1 1 1\n4 0 1 2 3\n3 0 1 2\n";
    vec![text.into_bytes(), binary(false), binary(true), strips.into()]
}

/// Positions, indices, texture coordinates, key times, turns, joints, weights.
fn buffer() -> Vec<u8> {
    let floats = |list: &[f32]| list.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let mut bytes = floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    bytes.extend([0_u16, 1, 2, 0].iter().flat_map(|i| i.to_le_bytes()));
    bytes.extend(floats(&[0.25, 0.5, 0.75, 0.5, 1.25, 0.5]));
    bytes.extend(floats(&[0.0, 1.0]));
    bytes.extend(floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.6, 0.0, 0.8]));
    bytes.extend([0_u8, 1, 0, 0].repeat(3));
    bytes.extend(floats(&[0.5, 0.5, 0.0, 0.0].repeat(3)));
    bytes.extend(png());
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    bytes
}

/// A document of a triangle with a texture; `more` goes into its node, `rest` beside the meshes.
fn gltf_of(uri: Option<&str>, more: &str, rest: &str) -> String {
    let uri = uri.map(|uri| format!(r#""uri":"{uri}","#)).unwrap_or_default();
    let (length, picture) = (buffer().len(), png().len());
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
"materials":[{{"pbrMetallicRoughness":{{"baseColorFactor":[1,0.5,1,1],"baseColorTexture":{{"index":0,"extensions":{{"KHR_texture_transform":{{"scale":[2,1]}}}}}}}},"alphaMode":"MASK","alphaCutoff":0.5}}],
"textures":[{{"source":0,"sampler":0}}],"samplers":[{{"wrapS":33071,"wrapT":33648}}],
"images":[{{"bufferView":7,"mimeType":"image/png"}}],
"meshes":[{{"weights":[0.5],"primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_0":2,"JOINTS_0":5,"WEIGHTS_0":6}},"indices":1,"material":0,"targets":[{{"POSITION":0}}]}}]}}],
"nodes":[{{"mesh":0{more}}},{{"rotation":[0,0,0,1],"children":[2]}},{{"scale":[2,2,2]}}]{rest},
"accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},
{{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}},
{{"bufferView":2,"componentType":5126,"count":3,"type":"VEC2"}},
{{"bufferView":3,"componentType":5126,"count":2,"type":"SCALAR","min":[0],"max":[1]}},
{{"bufferView":4,"componentType":5126,"count":2,"type":"VEC4"}},
{{"bufferView":5,"componentType":5121,"count":3,"type":"VEC4"}},
{{"bufferView":6,"componentType":5126,"count":3,"type":"VEC4"}}],
"bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":6}},
{{"buffer":0,"byteOffset":44,"byteLength":24}},{{"buffer":0,"byteOffset":68,"byteLength":8}},
{{"buffer":0,"byteOffset":76,"byteLength":32}},{{"buffer":0,"byteOffset":108,"byteLength":12}},
{{"buffer":0,"byteOffset":120,"byteLength":48}},{{"buffer":0,"byteOffset":168,"byteLength":{picture}}}],
"buffers":[{{{uri}"byteLength":{length}}}]}}"#
    )
}

fn gltf(uri: &str, more: &str) -> Vec<u8> {
    gltf_of(Some(uri), more, "").into_bytes()
}

fn skinned(uri: Option<&str>) -> String {
    gltf_of(
        uri,
        r#","skin":0"#,
        r#","skins":[{"joints":[1,2]}],"animations":[{"name":"bend","samplers":[{"input":3,"output":4,"interpolation":"LINEAR"}],"channels":[{"sampler":0,"target":{"node":2,"path":"rotation"}}]}]"#,
    )
}

fn gltf_animated() -> Vec<u8> {
    skinned(Some("a.bin")).into_bytes()
}

fn data_uri() -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let bytes = buffer();
    let groups = bytes.chunks(3).map(|group| {
        let bits = group.iter().fold(0_u32, |bits, byte| bits << 8 | u32::from(*byte)) << (8 * (3 - group.len()));
        let letter = |place: usize| char::from(LETTERS[(bits >> (18 - 6 * place)) as usize & 63]);
        (0..4).map(|place| if place <= group.len() { letter(place) } else { '=' }).collect::<String>()
    });
    format!("data:application/octet-stream;base64,{}", groups.collect::<String>())
}

fn glb(json: &str, data: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bytes = b"glTF".to_vec();
    for number in [2, 12 + 8 + json.len() + 8 + data.len(), json.len()] {
        bytes.extend(u32::try_from(number).expect("a short file").to_le_bytes());
    }
    bytes.extend(b"JSON");
    bytes.extend(&json);
    bytes.extend(u32::try_from(data.len()).expect("a short file").to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(data);
    bytes
}

/// One white pixel.
fn png() -> Vec<u8> {
    let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x01\0\0\0\x01\x08\0\0\0\0\x3a\x7e\x9b\x55".to_vec();
    bytes.extend(b"\0\0\0\x0aIDAT\x78\x9c\x63\xf8\x0f\0\x01\x01\x01\0\xb1\x38\xf6\x14\0\0\0\0IEND\xae\x42\x60\x82");
    bytes
}

/// A picture of two rows of colour, flat or in the run-length encoding.
fn hdr(&[width, height]: &[u8; 2], encoded: bool) -> Vec<u8> {
    let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\nCOLORCORR=1 1 1\nPRIMARIES=.64 .33 .3 .6 .15 .06 .3127 .329\n\n".to_vec();
    bytes.extend(format!("-Y {height} +X {width}\n").bytes());
    for _ in 0..height {
        if encoded {
            bytes.extend([2, 2, 0, width]);
            for value in [128, 64, 32, 129] {
                bytes.extend([128 + width, value]);
            }
        } else {
            (0..width).for_each(|_| bytes.extend([128, 64, 32, 129]));
        }
    }
    bytes
}

fn exr(height: usize, encoding: Encoding) -> Vec<u8> {
    let channel = |name: &str, value: f32| AnyChannel::new(name, FlatSamples::F32(vec![value; 2 * height * height]));
    let channels = AnyChannels::sort([channel("R", 1.0), channel("G", 2.0), channel("B", 3.0)].into_iter().collect());
    let layer = Layer::new((2 * height, height), LayerAttributes::default(), encoding, channels);
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer).write().non_parallel().to_buffered(&mut bytes).expect("an image");
    bytes.into_inner()
}

const SCENE: &str = r#"name = "all"
bounces = 2
[[object]]
shape = "box"
name = "b"
albedo = [1, 0.5, 0]
spheres = 7
clusters = 3
reflectance = { model = "modified-phong", specular = [0, 0.5, 0.25], exponent = 30 }
keyframe = [{ time = 0 }, { time = 2, translate = [0, 4, 0], rotate = [0, 2, 0, 90], scale = 4 }]
[[object]]
shape = "plane"
translate = [0, -1, 0]
rotate = [1, 0, 0, 5]
scale = 5
[object.reflectance]
model = "lafortune"
lobes = [{ scale = [0.1, 0.2, 0.3], axis = [-1, -0.9, 0.95], exponent = 20 }]
[[light]]
sphere = { center = [0, 3, 0], radius = 0.5 }
radiance = [10, 20, 30]
keyframe = [{ time = 0 }, { time = 1, translate = [1, 0, 0] }]
[camera]
eye = [0, 1, 4]
target = [0, 0.5, 0]
vertical_fov_degrees = 30
resolution = [80, 60]
[animation]
frames_per_sec = 10
frame_count = 3
"#;
const SCENE_OF_FILES: &str = r#"[[object]]
mesh = "a.obj"
albedo_texture = "a.png"
[[object]]
mesh = "a.glb"
animation = 0
[environment]
image = "a.hdr"
projection = "latlong"
forward_degrees = 90
turn_degrees_per_sec = 10
"#;
const SCENE_OF_KEYS: &str = r#"[[object]]
shape = "sphere"
[environment]
sky = { sun_elevation_degrees = 30, sun_azimuth_degrees = 1, turbidity = 4, ground_albedo = [0, 0.5, 1], sun = true, resolution = 4 }
"#;
const MITSUBA: &str = r##"<scene version="3.0.0"><default name="d" value="3"/><integrator type="path"><integer name="max_depth" value="$d"/></integrator>
<sensor type="perspective"><float name="fov" value="45"/><transform name="to_world"><lookat origin="0, 1, 4" target="0, 0, 0" up="0, 0, 1"/></transform></sensor>
<bsdf type="twosided" id="b"><bsdf type="phong"><rgb name="diffuse_reflectance" value="#204060"/></bsdf></bsdf>
<shape type="rectangle"><transform name="to_world"><scale value="2"/><rotate x="1" angle="-90"/></transform><ref id="b"/></shape>
<shape type="obj"><string name="filename" value="a.obj"/></shape>
<shape type="sphere"><point name="center" y="3"/><emitter type="area"><rgb name="radiance" value="1 2 3"/></emitter></shape>
<emitter type="envmap"><string name="filename" value="a.hdr"/></emitter></scene>"##;
const PBRT: &str = r#"LookAt 0 4 1  0 0 0  0 0 1 Camera "perspective" "float fov" [45]
WorldBegin # here
LightSource "infinite" "rgb L" [1 2 3]
MakeNamedMaterial "m" "string type" "diffuse" "rgb reflectance" [0.5 0.25 0.1]
AttributeBegin NamedMaterial "m" Translate 1 2 3 Rotate 30 0 1 0
Shape "trianglemesh" "point3 P" [-1 0 0 1 0 0 0 1 0] "integer indices" [0 1 2]
AreaLightSource "diffuse" Shape "sphere" AttributeEnd
ObjectBegin "o" Shape "sphere" ObjectEnd ObjectInstance "o"
"#;
const EXPERIMENT: &str = r#"name = "e"
claim = "none"
frames = [0]
receivers = ["vertices", "pixels"]
references = ["mesh", "spheres", "bands", "bands=4"]
details = true
compare = [["sh-exp:bands=3", "unshadowed"]]
[truth]
relative_noise = 0.002
seed = 1
[timing]
warm_up = 2
repeats = 11
threads = 2
[pictures]
resolution = [48, 36]
strategies = ["unshadowed"]
difference = ["sh-exp:bands=3", "unshadowed"]
[[scene]]
name = "a.toml"
bounces = 1
spheres = 64
camera = { eye = [0, 1, 4], target = [0, 0.5, 0], vertical_fov_degrees = 20 }
[[scene.published]]
method = "m"
hardware = "h"
source = "s"
frames_per_sec = 95
[[scene]]
name = "a.obj"
environment = "a.hdr:latlong"
frames = [0]
[[strategy]]
name = "sh-exp"
exp = ["series", "hybrid"]
bands = [2, 3]
[[strategy]]
name = "unshadowed"
"#;
const EXPERIMENT_SMALL: &str = "name = \"s\"\nclaim = \"n\"\n[truth]\nsamples = 8\n[[scene]]\nname = \"a.toml\"\n[[strategy]]\nname = \"cosine-lobe\"\n";

/// One run with everything that a run can tell.
const RUN: &str = r#"{"scene":"v","frame":0,"receivers":"vertices","receiver_count":9,"strategy":"fast","label":"fast:bands=4","params":{"bands":4},"status":"ok","reason":null,"error":{"reference":"mesh","transport":"direct","rmse":0.1,"rel_rmse":0.2,"bias":-0.05,"mae":0.08,"p95":0.2,"p99":0.25,"max":0.3,"rmse_noise":0.0001,"resolved":true,"flip":null,"ssim":0.5},"truth":{"samples":256,"rms_standard_error":0.001,"unshadowed_mean":0.5},"time":{"bake_secs":0.25,"prepare_secs":{"median":0.0,"mad":0.0},"shade_secs":{"median":0.002,"mad":0.0},"frames_per_sec":500.0,"threads":2,"samples":[{"prepare_secs":0.0,"shade_secs":0.002}]},"memory":{"bytes":2048,"parts":{"t":2048}},"details":[{"name":"d","values":[8.0,0.5]}]}"#;

const RESULTS: &str = concat!(
    r#"{"schema":"halfshade.results/1","experiment":"e","claim":"c","experiment_hash":"00","quick":false,"revision":"0",
"machine":{"cpu":"c","threads":2,"gpu":null,"os":"o"},"strategies":["fast","exact"],
"scenes":[{"name":"v","vertices":9,"triangles":3,"spheres":2,"published":[{"method":"m","hardware":"h","source":"s","frames_per_sec":95.0}]}],
"runs":[{"scene":"v","frame":0,"receivers":"vertices","receiver_count":9,"strategy":"exact","label":"exact","params":{},"status":"unsupported","reason":"no","error":null,"truth":null,"time":null,"memory":null},
"#,
    r#"{"scene":"v","frame":0,"receivers":"vertices","receiver_count":9,"strategy":"fast","label":"fast:bands=4","params":{"bands":4},"status":"ok","reason":null,"error":{"reference":"mesh","transport":"direct","rmse":0.1,"rel_rmse":0.2,"bias":-0.05,"mae":0.08,"p95":0.2,"p99":0.25,"max":0.3,"rmse_noise":0.0001,"resolved":true,"flip":null,"ssim":0.5},"truth":{"samples":256,"rms_standard_error":0.001,"unshadowed_mean":0.5},"time":{"bake_secs":0.25,"prepare_secs":{"median":0.0,"mad":0.0},"shade_secs":{"median":0.002,"mad":0.0},"frames_per_sec":500.0,"threads":2,"samples":[{"prepare_secs":0.0,"shade_secs":0.002}]},"memory":{"bytes":2048,"parts":{"t":2048}}}"#,
    r#"],"differences":[{"scene":"v","frame":0,"receivers":"vertices","first":"exact","second":"fast","mean":0.25,"bias":-0.01,"mae":0.02,"max":0.125}],
"pictures":[{"scene":"v","frame":0,"label":"fast","exr":"a.exr","png":"a.png","error_png":null,"exposure":1.0}]}"#
);

/// Facts without checksums, after a byte that asks for them.
fn journal() -> Vec<u8> {
    let header = r#"{"schema":"halfshade.journal/2","experiment_hash":"ab","quick":false,"threads":2,"revision":"1","program":"","inputs":[]}"#;
    let timed = r#"{"timed":{"key":"k","sample":{"prepare_secs":0.001,"shade_secs":0.30000000000000004}}}"#;
    format!("\u{1}{header}\n{timed}\n{{\"scored\":[{RUN}]}}\n").into_bytes()
}
