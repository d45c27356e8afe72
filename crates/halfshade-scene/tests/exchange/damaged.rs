//! Scene files damaged at random: no damage makes the readers panic or hang.

use super::{load, write};
use glam::Vec3;
use halfshade_scene::{ExrFacts, exr_bytes};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::time::{Duration, Instant};

const MITSUBA: &str = r##"<?xml version="1.0"?>
<scene version="3.0.0"><default name="d" value="3"/>
<integrator type="path"><integer name="max_depth" value="$d"/></integrator>
<sensor type="perspective"><float name="fov" value="45"/><string name="fov_axis" value="y"/>
<transform name="to_world"><lookat origin="0, 1, 4" target="0, 0, 0" up="0, 0, 1"/></transform>
<film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="12"/></film></sensor>
<bsdf type="twosided" id="b"><bsdf type="phong"><rgb name="diffuse_reflectance" value="#204060"/><float name="exponent" value="20"/></bsdf></bsdf>
<bsdf type="halfshade_lobes" id="l"><vector name="reflectance" x="0.5" y="0.5" z="0.5"/><string name="model" value="lafortune"/>
<vector name="scale_0" x="1" y="1" z="1"/><vector name="axis_0" x="-1" y="-1" z="1"/><float name="exponent_0" value="9"/></bsdf>
<shape type="rectangle"><transform name="to_world"><scale value="2"/><rotate x="1" angle="-90"/></transform><ref id="l"/></shape>
<shape type="cube"><transform name="to_world"><matrix value="1 0 0 1 0 1 0 1 0 0 1 1 0 0 0 1"/></transform><ref id="b"/></shape>
<shape type="sphere"><point name="center" y="3"/><float name="radius" value="0.5"/><emitter type="area"><rgb name="radiance" value="1 2 3"/></emitter></shape>
<emitter type="envmap"><string name="filename" value="e.exr"/><float name="scale" value="2"/></emitter>
</scene>"##;

const PBRT: &str = r#"LookAt 0 4 1  0 0 0  0 0 1
Camera "perspective" "float fov" [45]
Film "rgb" "integer xresolution" [16] "integer yresolution" [12]
Integrator "path" "integer maxdepth" [3]
WorldBegin # here
LightSource "infinite" "string filename" "e.exr" "float scale" 2
MakeNamedMaterial "m" "string type" "diffuse" "rgb reflectance" [0.5 0.25 0.1]
AttributeBegin
NamedMaterial "m"
Translate 1 2 3 Scale 2 2 2 Rotate 30 0 1 0
Shape "trianglemesh" "point3 P" [-1 0 0 1 0 0 0 1 0 2 2 2] "integer indices" [0 1 2 1 2 3] "point2 uv" [0 0 1 0 0 1 1 1]
AreaLightSource "diffuse" "rgb L" [1 2 3]
Shape "sphere" "float radius" 0.5
AttributeEnd
ObjectBegin "o" ConcatTransform [1 0 0 0 0 1 0 0 0 0 1 0 4 0 0 1] Shape "sphere" ObjectEnd
ObjectInstance "o"
"#;

/// `HALFSHADE_FUZZ_SECS` sets how long; two seconds without.
#[test]
fn no_damage_makes_the_readers_panic_or_hang() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "e.exr", exr_bytes([2, 2], &[("", &[Vec3::ONE; 4])], ExrFacts::default()).unwrap());
    let corpus = [("a.xml", MITSUBA), ("a.pbrt", PBRT)];
    for (name, text) in corpus {
        write(folder.path(), name, text);
        load(&folder.path().join(name)).unwrap_or_else(|error| panic!("{error}"));
    }
    let seconds = std::env::var("HALFSHADE_FUZZ_SECS").ok().and_then(|text| text.parse().ok()).unwrap_or(2);
    let end = Instant::now() + Duration::from_secs(seconds);
    let mut random = Pcg64Mcg::seed_from_u64(29);
    let mut read = 0;
    while Instant::now() < end {
        let (name, text) = corpus[random.random_range(0..2)];
        let mut bytes = text.as_bytes().to_vec();
        for _ in 0..random.random_range(1..4) {
            let place = random.random_range(0..bytes.len());
            match random.random_range(0..6_u8) {
                0 => bytes[place] = random.random(),
                1 => bytes.truncate(place.max(1)),
                2 => drop(bytes.drain(place..(place + random.random_range(1..9)).min(bytes.len()))),
                3 => bytes.insert(place, b"-e0\"<[ "[random.random_range(0..7)]),
                _ => {
                    // A digit for a digit: plausible numbers that are wrong.
                    if let Some(digit) = bytes[place..].iter_mut().find(|byte| byte.is_ascii_digit()) {
                        *digit = b'0' + random.random_range(0..10);
                    }
                }
            }
            if bytes.is_empty() {
                bytes.push(b' ');
            }
        }
        write(folder.path(), name, &bytes);
        let start = Instant::now();
        if let Ok(scene) = load(&folder.path().join(name)) {
            read += 1;
            let vertices =
                scene.objects.iter().flat_map(|object| object.mesh.positions.iter().chain(&object.mesh.normals));
            assert!(vertices.into_iter().all(|vector| vector.is_finite()));
            assert!(scene.frame(0).lights.iter().all(|light| light.radius > 0.0 && light.radiance.is_finite()));
            assert!(scene.camera.ray_direction(0.0, 0.0).is_finite());
        }
        assert!(start.elapsed() < Duration::from_secs(5), "{}", String::from_utf8_lossy(&bytes));
    }
    assert!(read > 0);
}
