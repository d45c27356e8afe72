//! Hierarchies beside every triangle one by one, in double precision.

use glam::{DAffine3, DQuat, DVec3, Vec3};
use halfshade_rays::{Instance, MeshRays, Ray, SceneRays};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::sync::Arc;

/// Crossings nearer than this to an edge, as a share of the triangle, may be found or not by another formula.
const DOUBT: f64 = 1e-9;

fn unit(random: &mut Pcg64Mcg) -> DVec3 {
    loop {
        let point = DVec3::from_array(std::array::from_fn(|_| random.random_range(-1.0..1.0)));
        if (0.01..1.0).contains(&point.length()) {
            return point.normalize();
        }
    }
}

/// By Cramer's rule: where the ray crosses the triangle's plane, and the smallest weight there.
fn cramer([a, b, c]: [DVec3; 3], origin: DVec3, direction: DVec3) -> (f64, f64) {
    let (ab, ac, offset) = (b - a, c - a, a - origin);
    let facing = ab.cross(ac).dot(direction);
    let across = direction.cross(offset);
    let (v, w) = (-across.dot(ac) / facing, across.dot(ab) / facing);
    (ab.cross(ac).dot(offset) / facing, v.min(w).min(1.0 - v - w))
}

/// Distances to all triangles that the ray crosses for sure, and whether any was in doubt.
fn brute_force(triangles: impl Iterator<Item = [DVec3; 3]>, origin: DVec3, direction: DVec3) -> (Vec<f64>, bool) {
    let (mut found, mut is_doubtful) = (Vec::new(), false);
    for triangle in triangles {
        let (distance, weight) = cramer(triangle, origin, direction);
        is_doubtful |= weight.abs() < DOUBT && distance > -DOUBT || distance.is_nan();
        if weight > 0.0 && distance > 0.0 {
            found.push(distance);
        }
    }
    found.sort_by(f64::total_cmp);
    (found, is_doubtful)
}

/// Triangles of all sizes around the origin, some of them slivers and some the same.
fn soup(random: &mut Pcg64Mcg, count: usize) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut positions = Vec::new();
    for i in 0..count {
        let middle = unit(random) * random.random_range(0.0f64..1.0);
        let size = 10f64.powf(random.random_range(-3.0..0.0));
        let mut corners = [(); 3].map(|()| (middle + size * unit(random)).as_vec3());
        if i % 17 == 0 {
            corners[2] = corners[0].lerp(corners[1], 0.3) + (1e-5 * unit(random)).as_vec3();
        }
        positions.extend(if i % 29 == 0 && i > 0 { [positions[0], positions[1], positions[2]] } else { corners });
    }
    (positions, (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

fn corners<'a>(positions: &'a [Vec3], triangles: &'a [[u32; 3]]) -> impl Iterator<Item = [DVec3; 3]> + 'a {
    triangles.iter().map(|triangle| triangle.map(|vertex| positions[vertex as usize].as_dvec3()))
}

/// Every answer of a mesh is that of its triangles, at any size, from inside, outside and far away.
#[test]
fn a_mesh_answers_as_its_triangles_do() {
    let mut random = Pcg64Mcg::seed_from_u64(1);
    let mut certain = 0;
    for count in [1, 5, 9, 70, 2000] {
        let (positions, triangles) = soup(&mut random, count);
        for scale in [1e-6f32, 1.0, 1e6] {
            let positions: Vec<Vec3> = positions.iter().map(|&position| scale * position).collect();
            let mesh = MeshRays::new(&positions, &triangles);
            for i in 0..400 {
                let far = [0.3, 1.0, 30.0, 3e4][i % 4] * f64::from(scale);
                let origin = far * unit(&mut random);
                let target = f64::from(scale) * random.random_range(0.0..1.0) * unit(&mut random);
                let direction = match i % 5 {
                    0 => DVec3::AXES[i % 3] * if i % 2 == 0 { 1.0 } else { -1.0 },
                    _ => (target - origin).normalize(),
                };
                let (found, is_doubtful) = brute_force(corners(&positions, &triangles), origin, direction);
                if is_doubtful {
                    continue;
                }
                certain += 1;
                let ray = Ray::new(origin, direction);
                assert_eq!(mesh.any(&ray, |_| true), !found.is_empty(), "{count} {scale} {i}");
                let closest = mesh.closest(&ray, |_| true).map(|crossing| crossing.distance);
                let mut all = Vec::new();
                mesh.any(&ray, |crossing| {
                    all.push(crossing.distance);
                    false
                });
                all.sort_by(f64::total_cmp);
                assert_eq!(all.len(), found.len(), "{count} {scale} {i}");
                let tolerance = 1e-9 * (far + f64::from(scale));
                assert!(all.iter().zip(&found).all(|(a, b)| (a - b).abs() < tolerance), "{all:?} {found:?}");
                assert_eq!(closest, all.first().copied());
                let Some(first) = found.first() else { continue };
                assert!(
                    !mesh.any(&ray.until(first - tolerance), |_| true)
                        && mesh.any(&ray.until(first + tolerance), |_| true)
                );
            }
        }
    }
    assert!(certain > 4000, "{certain}");
}

/// Rays at edges and vertices of closed bodies never get in or out: not along the axes, not from afar, not for slivers.
#[test]
fn a_closed_body_is_watertight() {
    let mut random = Pcg64Mcg::seed_from_u64(2);
    for (rings, stretch, shift) in
        [(4u32, 1.0f32, 0.0f32), (30, 1.0, 0.0), (30, 1e-3, 0.0), (16, 1.0, 1e3), (90, 1.0, -7.0)]
    {
        let (positions, triangles) = ball(rings, stretch, Vec3::splat(shift));
        let mesh = MeshRays::new(&positions, &triangles);
        let middle = DVec3::splat(f64::from(shift));
        for triangle in &triangles {
            let [a, b, _] = triangle.map(|vertex| positions[vertex as usize].as_dvec3());
            let share = random.random_range(0.0..1.0);
            for target in [a, b, a.lerp(b, 0.5), a.lerp(b, share)] {
                let inside = middle + 1e-4 * unit(&mut random);
                for origin in [middle, inside] {
                    let direction = (target - origin).normalize();
                    assert!(mesh.any(&Ray::new(origin, direction), |_| true), "out of {rings} {stretch} at {target}");
                }
                for far in [1.5, 100.0] {
                    // Through a vertex or an edge to the middle: never past the first side.
                    let outward = (target - middle).normalize();
                    let ray = Ray::new(target + far * outward, -outward).until(far + 0.5 * (target - middle).length());
                    assert!(mesh.any(&ray, |_| true), "into {rings} {stretch} at {target}");
                }
            }
        }
    }
}

/// A ball of triangles around a point, flattened along z.
fn ball(rings: u32, stretch: f32, center: Vec3) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let around = 2 * rings;
    let place = |ring: u32, turn: u32| {
        let (sin, cos) = (std::f32::consts::PI * ring as f32 / rings as f32).sin_cos();
        let (y, x) = (std::f32::consts::TAU * turn as f32 / around as f32).sin_cos();
        center + Vec3::new(sin * x, cos, stretch * sin * y)
    };
    let mut positions = vec![place(0, 0), place(rings, 0)];
    positions.extend((1..rings).flat_map(|ring| (0..around).map(move |turn| place(ring, turn))));
    let vertex = |ring: u32, turn: u32| match ring {
        0 => 0,
        ring if ring == rings => 1,
        ring => 2 + (ring - 1) * around + turn % around,
    };
    let mut triangles = Vec::new();
    for ring in 0..rings {
        for turn in 0..around {
            let [a, b] = [vertex(ring, turn), vertex(ring, turn + 1)];
            let [c, d] = [vertex(ring + 1, turn), vertex(ring + 1, turn + 1)];
            triangles.extend((ring > 0).then_some([a, b, c]));
            triangles.extend((ring + 1 < rings).then_some([b, d, c]));
        }
    }
    (positions, triangles)
}

/// Meshes that are turned, moved and scaled answer as their triangles do in the world.
#[test]
fn a_scene_answers_as_its_triangles_do() {
    let mut random = Pcg64Mcg::seed_from_u64(3);
    let (positions, triangles) = soup(&mut random, 300);
    let mesh = Arc::new(MeshRays::new(&positions, &triangles));
    for count in [1, 3, 40] {
        let instances: Vec<Instance> = (0..count)
            .map(|_| {
                let rotation = DQuat::from_axis_angle(unit(&mut random), random.random_range(0.0..6.0));
                let scale = DVec3::splat(10f64.powf(random.random_range(-2.0..0.5)));
                let translation = unit(&mut random) * random.random_range(0.0..6.0);
                let world_from_mesh = DAffine3::from_scale_rotation_translation(scale, rotation, translation);
                Instance { mesh: mesh.clone(), world_from_mesh }
            })
            .collect();
        let scene = SceneRays::new(&instances);
        let in_world: Vec<[DVec3; 3]> = (instances.iter())
            .flat_map(|instance| {
                corners(&positions, &triangles)
                    .map(|corners| corners.map(|corner| instance.world_from_mesh.transform_point3(corner)))
            })
            .collect();
        let (mut certain, mut met) = (0, 0);
        for i in 0..400 {
            let origin = [1.0, 8.0, 100.0][i % 3] * unit(&mut random);
            let target = instances[i % count].world_from_mesh.transform_point3(0.7 * unit(&mut random));
            let direction = (target - origin).normalize();
            let (found, is_doubtful) = brute_force(in_world.iter().copied(), origin, direction);
            if is_doubtful {
                continue;
            }
            certain += 1;
            met += usize::from(!found.is_empty());
            let ray = Ray::new(origin, direction);
            assert_eq!(scene.any(&ray, |_, _| true), !found.is_empty());
            let closest = scene.closest(&ray, |_, _| true);
            assert_eq!(closest.is_some(), !found.is_empty());
            let Some((number, crossing)) = closest else { continue };
            assert!(
                (crossing.distance - found[0]).abs() < 1e-9 * origin.length(),
                "{} {}",
                crossing.distance,
                found[0]
            );
            let place = triangles.len() * number as usize + crossing.triangle as usize;
            assert!((cramer(in_world[place], origin, direction).0 - found[0]).abs() < 1e-9 * origin.length());
            // A crossing that doesn't count is passed.
            let second = scene.closest(&ray, |object, other| (object, other.triangle) != (number, crossing.triangle));
            assert_eq!(second.is_some(), found.len() > 1);
            assert!(second.is_none_or(|(_, second)| second.distance >= crossing.distance));
        }
        assert!(certain > 300 && met > 100, "{certain} {met}");
    }
    assert!(!SceneRays::new(&[]).any(&Ray::new(DVec3::ZERO, DVec3::X), |_, _| true));
    let nowhere = DAffine3::from_scale(DVec3::ZERO);
    let flat = SceneRays::new(&[Instance { mesh, world_from_mesh: nowhere }]);
    assert!(!flat.any(&Ray::new(DVec3::NEG_X, DVec3::X), |_, _| true));
}

/// A hierarchy that was refitted answers as one that was built anew.
#[test]
fn a_deformed_mesh_is_met_where_it_is() {
    let mut random = Pcg64Mcg::seed_from_u64(4);
    let (mut positions, triangles) = ball(20, 1.0, Vec3::ZERO);
    let mut mesh = MeshRays::new(&positions, &triangles);
    for frame in 0..5 {
        let bend = 0.4 * frame as f32;
        for position in &mut positions {
            *position += Vec3::new(bend * position.y * position.y, 0.0, 0.1 * bend);
        }
        positions[9] = if frame == 2 { Vec3::NAN } else { Vec3::new(0.1, 0.2, 0.3) };
        mesh.refit(&positions, &triangles);
        let anew = MeshRays::new(&positions, &triangles);
        assert_eq!(mesh.bounds(), anew.bounds());
        for _ in 0..2000 {
            let ray = Ray::new(6.0 * unit(&mut random), unit(&mut random));
            let first = |mesh: &MeshRays| mesh.closest(&ray, |_| true).map(|crossing| crossing.distance);
            assert_eq!(first(&mesh), first(&anew));
        }
    }
}

/// No ray panics, and none that isn't one is met.
#[test]
fn strange_rays_and_meshes_are_met_by_nothing() {
    let (positions, triangles) = ball(8, 1.0, Vec3::ZERO);
    let mesh = MeshRays::new(&positions, &triangles);
    let strange = [0.0, -0.0, 1e-300, 1e300, f64::INFINITY, f64::NEG_INFINITY, f64::NAN];
    for x in strange {
        for y in strange {
            let ray = Ray::new(DVec3::new(x, y, 0.0), DVec3::X).leaving(DVec3::Y, DVec3::splat(1e-9));
            mesh.closest(&ray.until(y), |_| true);
            if !(x.is_finite() && y.is_finite()) {
                assert!(!mesh.any(&ray, |_| true), "{x} {y}");
            }
            assert!(!mesh.any(&Ray::new(DVec3::ZERO, DVec3::new(x * f64::NAN, y, 0.0)), |_| true));
        }
    }
    assert!(!mesh.any(&Ray::new(DVec3::ZERO, DVec3::ZERO), |_| true));
    assert!(mesh.any(&Ray::new(DVec3::new(-1e9, 0.05, 0.05), DVec3::X), |_| true));
    for (positions, triangles) in [
        (vec![], vec![]),
        (vec![Vec3::ZERO; 3], vec![[0, 1, 2]; 100]),
        (vec![Vec3::NAN, Vec3::X, Vec3::Y], vec![[0, 1, 2]]),
        (vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 7]]),
        (vec![Vec3::MAX, Vec3::MIN, Vec3::Y], vec![[0, 1, 2]]),
    ] {
        let mut mesh = MeshRays::new(&positions, &triangles);
        mesh.any(&Ray::new(DVec3::splat(0.5), DVec3::X), |_| true);
        mesh.refit(&positions, &triangles);
        mesh.closest(&Ray::new(DVec3::splat(-0.5), DVec3::X), |_| true);
    }
    let same = MeshRays::new(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]; 5000]);
    assert!(same.any(&Ray::new(DVec3::new(0.2, 0.2, -1.0), DVec3::Z), |_| true));
}
