//! Meshes and light probes as people have them: every file of the asset folder is loaded and checked against what is
//! known of it. The folder is `shared/assets` beside the repository or above it, or what HALFSHADE_ASSETS names; none
//! of it is in the repository, so without it the tests say that they skipped.

#![expect(clippy::print_stderr, reason = "a skipped test must say so")]

use glam::{DVec3, Vec3};
use halfshade_scene::light::{self, Environment, ProbeOptions, Projection};
use halfshade_scene::mesh::{self, Topology};
use halfshade_scene::{SceneError, file, light::EnvironmentMap};
use std::path::{Path, PathBuf};

fn read_probe(path: &Path, projection: Projection, forward_degrees: f32) -> Result<EnvironmentMap, SceneError> {
    let options = ProbeOptions { projection: Some(projection), forward_degrees, ..ProbeOptions::default() };
    let (map, notes) = light::load_probe(path, &options)?;
    assert!(notes.is_empty(), "{}: {notes:?}", path.display());
    Ok(map)
}

fn assets() -> Option<PathBuf> {
    let named = std::env::var_os("HALFSHADE_ASSETS").map(PathBuf::from);
    let folder = named.or_else(|| {
        let above = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
        above.map(|folder| folder.join("shared/assets")).find(|folder| folder.is_dir())
    });
    if folder.is_none() {
        eprintln!("skipped: no shared/assets above {}, and HALFSHADE_ASSETS is not set", env!("CARGO_MANIFEST_DIR"));
    }
    folder
}

/// Files of a folder with one of `extensions`, sorted.
fn files(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|e| extensions.contains(&e.to_str().unwrap())));
    files.sort();
    assert!(!files.is_empty(), "nothing to load in {}", folder.display());
    files
}

fn name(path: &Path) -> &str {
    path.file_name().unwrap().to_str().unwrap()
}

/// Known facts of a mesh: vertices stored, distinct positions, triangles, bodies, boundary edges, bounds.
type KnownMesh = (&'static str, usize, usize, usize, usize, usize, [f32; 3], [f32; 3]);

#[rustfmt::skip]
const MESHES: [KnownMesh; 12] = [
    ("bob_floatie.obj", 5647, 5344, 10688, 1, 0, [-0.913, -0.511, -0.732], [0.943, 0.461, 0.732]),
    ("bowling_pin.ply", 12494, 12494, 24984, 1, 0, [-76.309, -76.285, 0.0], [76.309, 76.285, 381.0]),
    ("bunny.obj", 29834, 29834, 59664, 1, 0, [-0.770, -0.769, -0.597], [0.780, 0.770, 0.601]),
    ("cat.obj", 7949, 7949, 15894, 1, 0, [-1.527, -0.008, -0.669], [1.568, 3.458, 0.486]),
    ("dragon.obj", 50000, 50000, 100000, 1, 0, [-7.047, 0.0, -3.151], [7.047, 9.940, 3.151]),
    ("duck.glb", 2399, 2108, 4212, 1, 0, [-0.693, 0.099, -0.613], [0.962, 1.640, 0.539]),
    ("max_planck.obj", 5272, 5272, 10540, 1, 0, [-65.796, -195.658, -39.812], [126.921, 144.479, 204.407]),
    ("nefertiti.obj", 35002, 35002, 70000, 1, 0, [-119.354, -247.280, -181.358], [119.379, 247.377, 181.241]),
    ("spot.obj", 3225, 2930, 5856, 1, 0, [-0.472, -0.737, -0.669], [0.472, 0.954, 1.049]),
    ("suzanne.ply", 35258, 31658, 62976, 3, 336, [-1.703, -0.867, -0.895], [1.640, 1.101, 1.562]),
    ("teapot_closed.obj", 8334, 7850, 15704, 2, 0, [-71.893, 0.0, -47.928], [82.294, 79.007, 47.928]),
    ("vase.ply", 5457, 5457, 10910, 1, 0, [-42.425, -42.529, -10.736], [42.343, 42.240, 88.264]),
];

#[test]
fn every_mesh_loads_with_the_counts_bounds_and_closedness_known_of_it() {
    let Some(assets) = assets() else { return };
    let files = files(&assets.join("meshes"), mesh::EXTENSIONS);
    for path in &files {
        let name = name(path);
        let (mesh, notes) = mesh::load_with_notes(path).unwrap_or_else(|error| panic!("{error}"));
        assert!(notes.is_empty(), "{name}: {notes:?}");
        assert!(mesh.normals.len() == mesh.positions.len() && mesh.colors.is_empty(), "{name}");
        assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-5), "{name}");
        let topology = Topology::of(&mesh);
        let agreeing = mesh.triangles.iter().filter(|triangle| {
            let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
            triangle.iter().map(|&v| mesh.normals[v as usize]).sum::<Vec3>().dot((b - a).cross(c - a)) > 0.0
        });
        assert!(agreeing.count() as f64 > 0.99 * mesh.triangles.len() as f64, "{name}: normals against winding");
        let Some(&(_, stored, distinct, triangles, bodies, rim, min, max)) = MESHES.iter().find(|m| m.0 == name) else {
            eprintln!("{name}: loaded, but nothing is known of it");
            continue;
        };
        assert_eq!((topology.vertices, topology.triangles), (distinct, triangles), "{name}");
        // Vertices equal in everything are one receiver.
        assert!((distinct..=stored).contains(&mesh.positions.len()), "{name}: {}", mesh.positions.len());
        assert_eq!((topology.bodies.len(), topology.boundary_edges), (bodies, rim), "{name}");
        assert_eq!((topology.is_closed(), topology.is_solid()), (rim == 0, rim == 0), "{name}");
        for (found, known) in [(topology.bounds.0, min), (topology.bounds.1, max)] {
            assert!((found - Vec3::from(known)).abs().max_element() < 6e-4, "{name}: {found} {known:?}");
        }
    }
    eprintln!("{} meshes loaded", files.len());
}

#[test]
fn the_duck_has_a_yellow_body_an_orange_beak_and_black_eyes() {
    let Some(assets) = assets() else { return };
    let scene = file::from_mesh(&assets.join("meshes/duck.glb"), Some(Environment::constant(Vec3::ONE))).unwrap();
    let duck = &scene.objects[0];
    assert_eq!((duck.mesh.textures.len(), duck.mesh.texture_coordinates.len()), (1, duck.mesh.positions.len()));
    let colors: Vec<Vec3> =
        (0..duck.mesh.positions.len()).map(|v| duck.albedo_at_vertex(v) / duck.material.albedo).collect();
    let share = |fits: &dyn Fn(Vec3) -> bool| colors.iter().filter(|c| fits(**c)).count() as f64 / colors.len() as f64;
    let (yellow, orange, black) = (
        share(&|c| c.y > 0.5 * c.x && c.z < 0.3 * c.x && c.x > 0.5),
        share(&|c| c.y > 0.05 * c.x && c.y < 0.4 * c.x && c.z < 0.3 * c.x && c.x > 0.3),
        share(&|c| c.max_element() < 0.1),
    );
    eprintln!("yellow {yellow:.3}, orange {orange:.3}, black {black:.3}");
    assert!(yellow > 0.5 && orange > 0.02 && black > 0.005, "{yellow} {orange} {black}");
    // The beak is what lies foremost, along +X; its tip is orange.
    let (tip, _) = duck.mesh.positions.iter().enumerate().max_by(|a, b| a.1.x.total_cmp(&b.1.x)).unwrap();
    assert!(colors[tip].y < 0.4 * colors[tip].x, "{}", colors[tip]);
}

/// Known facts of a probe: projection, largest value, mean weighted by solid angle.
type KnownProbe = (&'static str, Projection, f32, [f64; 3]);

const PROBES: [KnownProbe; 10] = [
    ("ennis_256.hdr", Projection::LatLong, 103.5, [1.278, 1.216, 1.275]),
    ("galileo_tomb.exr", Projection::LatLong, 963.0, [1.462, 1.074, 0.999]),
    ("grace_angular_128.hdr", Projection::Angular, 168.0, [0.743, 0.408, 0.500]),
    ("grace_cathedral.exr", Projection::LatLong, 1993.0, [2.865, 1.586, 1.964]),
    ("pisa.hdr", Projection::LatLong, 6.47, [0.206, 0.171, 0.164]),
    ("rooitou_park_1k.hdr", Projection::LatLong, 69120.0, [0.754, 0.770, 0.623]),
    ("st_fagans_interior_1k.hdr", Projection::LatLong, 1272.0, [0.983, 0.808, 0.544]),
    ("studio_small_03_1k.hdr", Projection::LatLong, 3568.0, [1.968, 2.261, 2.549]),
    ("uffizi_256.hdr", Projection::LatLong, 15.9, [0.895, 0.868, 0.988]),
    ("venice_sunset_1k.hdr", Projection::LatLong, 6496.0, [0.511, 0.482, 0.613]),
];

#[test]
fn every_probe_loads_with_the_mean_radiance_known_of_it() {
    let Some(assets) = assets() else { return };
    let files = files(&assets.join("envmaps"), light::EXTENSIONS);
    for path in &files {
        let name = name(path);
        let known = PROBES.iter().find(|probe| probe.0 == name);
        let projection = known.map_or(Projection::LatLong, |probe| probe.1);
        let map = read_probe(path, projection, 0.0).unwrap_or_else(|error| panic!("{error}"));
        assert!(map.texels().iter().all(|texel| texel.is_finite() && texel.min_element() >= 0.0), "{name}");
        let Some((_, _, max, mean)) = known else {
            eprintln!("{name}: loaded, but nothing is known of it");
            continue;
        };
        let relative = (map.mean_radiance() / DVec3::from(*mean) - DVec3::ONE).abs().max_element();
        assert!(relative < 0.01, "{name}: {} {mean:?}", map.mean_radiance());
        let largest = map.texels().iter().map(|texel| texel.max_element()).fold(0.0, f32::max);
        // Supersampling an angular map can only lose a peak.
        let floor = if projection == Projection::Angular { 0.5 } else { 0.995 };
        assert!((floor * max..1.005 * max).contains(&largest), "{name}: {largest} {max}");
        let other = if projection == Projection::LatLong { Projection::Angular } else { Projection::LatLong };
        assert!(read_probe(path, other, 0.0).unwrap_err().to_string().contains("try projection"), "{name}");
    }
    eprintln!("{} probes loaded", files.len());
}

/// The map's mean over cells of 30 by 30 degrees or so, to compare images of different sharpness.
fn coarse(map: &EnvironmentMap) -> Vec<f64> {
    let (rows, columns) = (6, 12);
    let mut sums = vec![0.0; rows * columns];
    for (i, texel) in map.texels().iter().enumerate() {
        let (row, column) = (i / map.width(), i % map.width());
        let cell = row * rows / map.height() * columns + column * columns / map.width();
        sums[cell] += map.texel_solid_angle(row) * f64::from(light::luminance(*texel));
    }
    sums.iter().map(|sum| (sum + 1e-6).ln()).collect()
}

#[test]
fn the_angular_probe_shows_the_same_cathedral_the_right_way_round() {
    let Some(assets) = assets() else { return };
    let read = |name: &str, projection, forward| {
        coarse(&read_probe(&assets.join("envmaps").join(name), projection, forward).unwrap())
    };
    let cathedral = read("grace_cathedral.exr", Projection::LatLong, 0.0);
    let correlation = |other: &[f64]| {
        let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
        let (a, b) = (mean(&cathedral), mean(other));
        let product = |x: &[f64], y: &[f64], a, b| x.iter().zip(y).map(|(x, y)| (x - a) * (y - b)).sum::<f64>();
        product(&cathedral, other, a, b) / (product(&cathedral, &cathedral, a, a) * product(other, other, b, b)).sqrt()
    };
    let angular = read("grace_angular_128.hdr", Projection::Angular, 0.0);
    assert!(correlation(&angular) > 0.97, "{}", correlation(&angular));
    let mirrored: Vec<f64> = angular.chunks(12).flat_map(|row| row.iter().rev().copied()).collect();
    let turned = read("grace_angular_128.hdr", Projection::Angular, 180.0);
    for wrong in [mirrored, turned] {
        assert!(correlation(&wrong) < correlation(&angular) - 0.03, "{}", correlation(&wrong));
    }
}

#[test]
fn a_scene_is_made_around_every_mesh() {
    let Some(assets) = assets() else { return };
    for path in files(&assets.join("meshes"), mesh::EXTENSIONS) {
        let scene = file::from_mesh(&path, Some(Environment::constant(Vec3::ONE))).unwrap();
        let (object, ground) = (&scene.objects[0], &scene.objects[1]);
        let (min, max) = object.mesh.bounds().unwrap();
        let [left, right] = [Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 0.0, 1.0)]
            .map(|corner| ground.motion.at(0.0).transform_point(corner));
        assert!((left.y - min.y).abs() <= 1e-6 * (max - min).length(), "{}", path.display());
        assert!(left.x < min.x && left.z < min.z && right.x > max.x && right.z > max.z);
        assert_eq!((object.sphere_count, ground.sphere_count), (64, 0));
    }
}

#[test]
fn real_files_cut_short_are_refused() {
    let Some(assets) = assets() else { return };
    let folder = tempfile::tempdir().unwrap();
    let meshes = ["bunny.obj", "spot.obj", "duck.glb", "vase.ply"].map(|name| assets.join("meshes").join(name));
    let probes = ["grace_cathedral.exr", "uffizi_256.hdr", "grace_angular_128.hdr"];
    for path in meshes.into_iter().chain(probes.map(|name| assets.join("envmaps").join(name))) {
        let bytes = std::fs::read(&path).unwrap();
        let cut = folder.path().join(path.file_name().unwrap());
        for percent in [1, 20, 50, 80, 99] {
            // Not at the end of a line: an OBJ cut there looks complete.
            let mut end = bytes.len() * percent / 100;
            while bytes[end - 1].is_ascii_whitespace() {
                end -= 1;
            }
            std::fs::write(&cut, &bytes[..end]).unwrap();
            let projection = if name(&path).contains("angular") { Projection::Angular } else { Projection::LatLong };
            let error = if mesh::EXTENSIONS.contains(&path.extension().unwrap().to_str().unwrap()) {
                mesh::load(&cut).err()
            } else {
                read_probe(&cut, projection, 0.0).err()
            };
            let error = error.unwrap_or_else(|| panic!("{} cut at {percent} % passes for whole", name(&path)));
            assert!(error.to_string().contains(name(&path)), "{error}");
        }
    }
}
