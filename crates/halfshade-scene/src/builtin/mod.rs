//! Built-in shapes and scenes: geometry that needs no file.
//!
//! The scenes `vases`, `ducks` and `squirrel-and-balls` rebuild those of [Guerrero2007, 6]: same kind of objects, same
//! numbers of vertices (within 2 %), leaf spheres and receiver clusters, so that its frame rates can stand beside ours.
//! The shapes, colours, movements and lights are our own. The thesis lights every scene with the Grace cathedral probe;
//! here each scene has another kind of light, since that decides how hard a scene is for a method of few bands:
//!
//! `bowling` and `falling`, which are simulated, are there with the feature `physics`, which is on by default.
//!
//! The scenes `statues`, `bowling` and `falling` are after [Tamura2006, 6]: as many objects and vertices, moved about by
//! hand or by a rigid-body simulation, the first two lit by moving lamps besides the environment.
//!
//! The scenes `glossy-sphere`, `five-blockers`, `rising-squirrel` and `two-squirrels` are after [Meunier2009, 6]: one
//! spherical light, no environment, and where the paper counts them as many shaded points and spheres.
//!
//! - `vases`: soft coloured panels in a dim room ([`studio`]), the easy case and the nearest to the probe's character:
//!   the error that is left comes from visibility;
//! - `ducks`: a clear sky with a high sun, the hard case: sharp shadows that few bands can't hold, in close quarters;
//! - `squirrel-and-balls`: the same sky, the sun low over the slope: long shadows sweep over receivers far
//!   from their blockers.

#[cfg(feature = "physics")]
mod bowling;
mod choreography;
mod courtyard;
mod daylight;
mod ducks;
#[cfg(feature = "physics")]
mod falling;
mod figures;
mod five_blockers;
mod glossy_sphere;
mod ground;
#[cfg(feature = "physics")]
mod gutter;
mod hand;
mod implicit;
mod lathe;
#[cfg(feature = "physics")]
mod physics;
mod polish;
mod polygonize;
mod profile;
mod rising_squirrel;
pub mod shapes;
mod small;
mod squirrel_and_balls;
mod statues;
mod studio;
mod teapot_and_statue;
#[cfg(feature = "physics")]
mod toys;
mod translucent_figure;
mod two_squirrels;
mod vases;

pub use lathe::{ProfilePoint, lathe};
pub use shapes::{SHAPES, shape};
pub use studio::studio;

use crate::{Scene, once};
use std::sync::OnceLock;

/// The built-in scenes: name and one-line summary.
pub const SCENES: &[(&str, &str)] = &[
    ("vases", "five vases on a ground box in a studio's soft light (15k vertices, 20 spheres, 35 clusters)"),
    ("ducks", "three rubber ducks close together under a clear sky (33k vertices, 30 spheres, 40 clusters)"),
    (
        "squirrel-and-balls",
        "a squirrel and rolling balls on an inclined box in a low sun (21k vertices, 14 spheres, 25 clusters)",
    ),
    ("hand", "a hand that opens and closes, deformed by a skeleton, and a ball in a studio's soft light"),
    ("statues", "five long figures moved about under two lamps (33k vertices, 60 spheres)"),
    #[cfg(feature = "physics")]
    ("bowling", "a ball rolls into ten pins under two lamps (41k vertices, 71 spheres)"),
    #[cfg(feature = "physics")]
    ("falling", "nineteen toys drop onto a heap in daylight (89k vertices, 153 spheres)"),
    ("teapot-and-statue", "a teapot and a statue on a slab in a studio's soft light: round, long and flat"),
    ("one-sphere", "a sphere over a plane under constant light: its shadow has a closed form"),
    ("five-blockers", "five spheres over a plane under one spherical light (17k vertices on the plane, 5 spheres)"),
    ("glossy-sphere", "a sphere whose gloss varies under one spherical light, without blockers (66k vertices)"),
    ("rising-squirrel", "a squirrel rises from a plane under one spherical light: a height a frame (64 spheres)"),
    ("two-squirrels", "two glossy squirrels in an open box under one spherical light (1,024 spheres)"),
    ("courtyard", "a figure walks between walls and columns that stand still, in a studio's soft light"),
    (
        "translucent-figure",
        "a figure of marble that light shines through, while the studio's light turns around it (6k vertices)",
    ),
    ("crowd", "64 tumbling blobs over a plane, 256 spheres: many blockers at once"),
];

/// The built-in scene called `name` (see [`SCENES`]), its sphere sets not yet built.
pub fn scene(name: &str) -> Option<Scene> {
    // Meshing and simulating take seconds: once for the whole program.
    static MADE: [OnceLock<Option<Scene>>; SCENES.len()] = [const { OnceLock::new() }; SCENES.len()];
    let number = SCENES.iter().position(|(known, _)| *known == name)?;
    once(&MADE[number], || made(name)).clone()
}

fn made(name: &str) -> Option<Scene> {
    Some(match name {
        "vases" => vases::scene(),
        "ducks" => ducks::scene(),
        "squirrel-and-balls" => squirrel_and_balls::scene(),
        "hand" => hand::scene(),
        "statues" => statues::scene(),
        #[cfg(feature = "physics")]
        "bowling" => bowling::scene(),
        #[cfg(feature = "physics")]
        "falling" => falling::scene(),
        "teapot-and-statue" => teapot_and_statue::scene(),
        "one-sphere" => small::one_sphere(),
        "five-blockers" => five_blockers::scene(),
        "glossy-sphere" => glossy_sphere::scene(),
        "rising-squirrel" => rising_squirrel::scene(),
        "two-squirrels" => two_squirrels::scene(),
        "courtyard" => courtyard::scene(),
        "translucent-figure" => translucent_figure::scene(),
        "crowd" => small::crowd(),
        _ => return None,
    })
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::Motion;
    use crate::mesh::Topology;
    use glam::Vec3;
    use std::f32::consts::FRAC_PI_4;
    use std::sync::LazyLock;

    static BUILT: LazyLock<Vec<Scene>> =
        LazyLock::new(|| SCENES.iter().map(|(name, _)| scene(name).unwrap()).collect());

    /// A built-in scene, made once for all tests.
    pub(crate) fn built(name: &str) -> &'static Scene {
        BUILT.iter().find(|scene| scene.name == name).unwrap()
    }

    #[test]
    fn counts_are_those_of_the_thesis() {
        // [Guerrero2007, 6]: vertices, leaf spheres, clusters.
        for (name, vertices, spheres, clusters) in
            [("squirrel-and-balls", 21_000, 14, 25), ("ducks", 33_000, 30, 40), ("vases", 15_000, 20, 35)]
        {
            let scene = built(name);
            let off = scene.vertex_count() as f64 / f64::from(vertices) - 1.0;
            assert!(off.abs() < 0.02, "{name}: {} vertices", scene.vertex_count());
            assert_eq!(scene.objects.iter().map(|o| o.sphere_count).sum::<usize>(), spheres, "{name}");
            assert_eq!(scene.objects.iter().map(|o| o.cluster_count).sum::<usize>(), clusters, "{name}");
            assert!(scene.objects.iter().all(|o| o.cluster_count > 0));
        }
    }

    #[test]
    fn counts_are_those_of_tamura() {
        // [Tamura2006, 6]: objects, vertices.
        for (name, objects, vertices) in [("statues", 6, 32_875), ("bowling", 15, 41_340), ("falling", 20, 88_739)] {
            let scene = built(name);
            assert_eq!((scene.objects.len(), scene.vertex_count()), (objects, vertices), "{name}");
            let (_, summary) = SCENES.iter().find(|(known, _)| *known == name).unwrap();
            let spheres: usize = scene.objects.iter().map(|object| object.sphere_count).sum();
            assert!(summary.contains(&format!("{spheres} spheres")), "{summary}: {spheres}");
        }
    }

    #[test]
    fn every_blocker_is_one_solid_body() {
        for scene in BUILT.iter() {
            for object in scene.objects.iter().filter(|object| object.sphere_count > 0) {
                let topology = Topology::of(&object.mesh);
                assert!(topology.is_solid() && topology.bodies.len() == 1, "{}: {topology:?}", object.name);
                assert_eq!(topology.problems(), Vec::<String>::new(), "{}", object.name);
            }
        }
    }

    #[test]
    fn scenes_are_named_and_moving() {
        for ((name, summary), scene) in SCENES.iter().zip(BUILT.iter()) {
            assert_eq!(scene.name, *name);
            assert!(!summary.is_empty() && scene.frame_count >= 1);
            for object in &scene.objects {
                assert_eq!(object.motion.moves(), object.sphere_count > 0, "{name}: {}", object.name);
                assert!(object.material.albedo.min_element() >= 0.0 && object.material.albedo.max_element() <= 1.0);
                assert!(object.mesh.colors.iter().all(|c| c.min_element() >= 0.0 && c.max_element() <= 1.0));
            }
        }
        assert!(scene("teapot").is_none());
    }

    /// Scenes whose movements are simulated: what hits or falls is as fast as physics says.
    const SIMULATED: [&str; 2] = ["bowling", "falling"];

    fn choreographed() -> impl Iterator<Item = &'static Scene> {
        BUILT.iter().filter(|scene| !SIMULATED.contains(&&*scene.name))
    }

    /// The highest speed, in m/s, of the middle of an object from one frame to the next.
    pub(crate) fn fastest_middle(scene: &Scene) -> f32 {
        let per_object = scene.objects.iter().map(|object| {
            let (low, high) = object.mesh.bounds().unwrap();
            let middle_at =
                |i: usize| object.motion.at(i as f64 / scene.frames_per_sec).transform_point(0.5 * (low + high));
            (1..scene.frame_count).map(|i| middle_at(i).distance(middle_at(i - 1))).fold(0.0, f32::max)
        });
        per_object.fold(0.0, f32::max) * scene.frames_per_sec as f32
    }

    #[test]
    fn simulated_movements_come_to_rest() {
        for name in SIMULATED {
            let scene = built(name);
            for object in &scene.objects {
                let pose = |frame: usize| object.motion.at(frame as f64 / scene.frames_per_sec);
                for frame in 1..scene.frame_count {
                    // Less than an eighth of a turn: no doubt which way round.
                    let turned = pose(frame - 1).rotation.angle_between(pose(frame).rotation);
                    assert!(turned < FRAC_PI_4, "{} at frame {frame}: {turned}", object.name);
                }
                let (before, after) = (pose(scene.frame_count - 2), pose(scene.frame_count - 1));
                let speed = before.translation.distance(after.translation) * scene.frames_per_sec as f32;
                assert!(speed < 0.15, "{} ends at {speed} m/s", object.name);
            }
        }
    }

    #[test]
    fn movements_are_continuous() {
        for scene in choreographed() {
            for object in &scene.objects {
                let Motion::Keyframes(keys) = &object.motion else { continue };
                assert!(keys.windows(2).all(|pair| pair[0].0 < pair[1].0));
                let poses: Vec<_> =
                    (0..scene.frame_count).map(|i| object.motion.at(i as f64 / scene.frames_per_sec)).collect();
                for pair in poses.windows(2) {
                    assert!(pair[0].translation.distance(pair[1].translation) < 0.06, "{}", object.name);
                    assert!(pair[0].rotation.angle_between(pair[1].rotation) < 0.25, "{}", object.name);
                }
            }
        }
    }

    #[test]
    fn all_that_moves_stays_above_the_ground_and_near_it() {
        for scene in BUILT.iter() {
            let top = scene.objects[0].mesh.positions.iter().map(|p| p.y).fold(f32::MIN, f32::max);
            let reach = scene.objects[0].mesh.positions.iter().copied().reduce(Vec3::max).unwrap();
            for index in (0..scene.frame_count).step_by(5) {
                let frame = scene.frame(index);
                let poses = &frame.world_from_object;
                let into_ground = poses[0].inverse();
                let objects = scene.objects.iter().zip(poses).enumerate().skip(1);
                for (number, (object, pose)) in objects.filter(|(_, (object, _))| object.motion.moves()) {
                    let into_ground = pose.then(&into_ground);
                    let mut lowest = f32::INFINITY;
                    for &position in frame.positions(number) {
                        let place = into_ground.transform_point(position);
                        lowest = lowest.min(place.y - top);
                        assert!(place.x.abs() < reach.x && place.z.abs() < reach.z, "{} leaves", object.name);
                    }
                    let highest = if SIMULATED.contains(&&*scene.name) { f32::INFINITY } else { 0.5 };
                    assert!(lowest > 0.001 && lowest < highest, "{} at frame {index}: {lowest}", object.name);
                }
            }
        }
    }
}
