//! A hand that opens and closes over a ground box while a ball passes by: what deforms, in a scene of its own.
//!
//! One closed mesh, fifteen joints, weights from how far along its finger a vertex lies.

use super::choreography::{FRAME_COUNT, FRAMES_PER_SEC, keyframes, upright, wave};
use super::ground::ground;
use super::implicit::Body;
use super::polygonize::polygonize;
use super::{shapes, studio};
use crate::skin::INFLUENCES;
use crate::{Camera, Joint, Mesh, Motion, Object, Pose, Scene, Skin};
use glam::{Affine3A, DQuat, Quat, Vec3};

/// Edge length of the cells that the hand is meshed with.
const CELL: f64 = 0.022;
/// The hand stays this high above the box, so that no two faces coincide.
const GAP: f32 = 0.004;
/// Half the length along a finger over which one joint hands over to the next.
const SOFTNESS: f32 = 0.07;

/// A finger, straight at rest: where it begins and ends, its radius at both ends, where along it, from 0 to 1, its joints
/// are, how far each bends at most, in radians, and its place in the wave that runs through the fingers.
struct Finger {
    base: [f32; 3],
    tip: [f32; 3],
    radii: [f32; 2],
    joints: &'static [(f32, f32)],
    phase: f64,
}

const JOINTS: &[(f32, f32)] = &[(0.0, 0.9), (0.42, 1.15), (0.72, 0.8)];

const FINGERS: [Finger; 5] = [
    Finger { base: [-0.31, 0.84, 0.0], tip: [-0.50, 1.42, 0.0], radii: [0.085, 0.066], joints: JOINTS, phase: 0.00 },
    Finger { base: [-0.105, 0.90, 0.0], tip: [-0.16, 1.62, 0.0], radii: [0.088, 0.067], joints: JOINTS, phase: 0.06 },
    Finger { base: [0.105, 0.89, 0.0], tip: [0.19, 1.56, 0.0], radii: [0.086, 0.066], joints: JOINTS, phase: 0.12 },
    Finger { base: [0.30, 0.80, 0.0], tip: [0.50, 1.28, 0.0], radii: [0.080, 0.060], joints: JOINTS, phase: 0.18 },
    Finger {
        base: [-0.30, 0.42, 0.04],
        tip: [-0.78, 0.86, 0.16],
        radii: [0.125, 0.085],
        joints: &[(0.12, 0.5), (0.6, 0.7)],
        phase: 0.22,
    },
];

/// The scene.
pub(super) fn scene() -> Scene {
    let mesh = polygonize(&hand(), CELL);
    let skin = skin(&mesh);
    let objects = vec![
        ground(Vec3::new(1.9, 0.15, 1.7), [76, 68], Vec3::new(0.62, 0.60, 0.56), 6),
        Object::new("hand", mesh)
            .sphere_count(24)
            .cluster_count(16)
            .motion(keyframes(|time| upright(Vec3::new(0.0, GAP, -0.15), 0.25 * wave(time, 1.0, 0.0), 1.0)))
            .skin(skin),
        Object::new("ball", shapes::sphere(16))
            .albedo(Vec3::new(0.75, 0.12, 0.07))
            .sphere_count(1)
            .cluster_count(2)
            .motion(keyframes(|time| {
                let place = Vec3::new(0.62 * wave(time, 1.0, 0.25), 0.40 + 0.1 * wave(time, 2.0, 0.0), 0.75);
                upright(place, 0.0, 0.2)
            })),
    ];
    Scene {
        camera: Camera {
            eye: Vec3::new(1.9, 1.9, 3.7),
            target: Vec3::new(0.0, 0.62, 0.1),
            vertical_fov_degrees: 31.0,
            resolution: [800, 600],
        },
        frames_per_sec: FRAMES_PER_SEC,
        frame_count: FRAME_COUNT,
        ..Scene::at_rest("hand", objects, studio::studio())
    }
}

/// A left hand that stands on its wrist, palm towards +Z, fingers up.
fn hand() -> Body {
    let skin = Vec3::new(0.78, 0.52, 0.38);
    let mut hand = Body::new(0.02)
        .ellipsoid([0.0, 0.58, 0.0], [0.42, 0.40, 0.15], DQuat::IDENTITY, 0.0, skin)
        .ellipsoid([-0.19, 0.42, 0.06], [0.19, 0.26, 0.14], DQuat::from_rotation_z(0.5), 0.10, skin)
        .tube(&[[0.0, 0.05, 0.0, 0.20], [0.0, 0.40, 0.0, 0.21]], 0.14, skin);
    for finger in &FINGERS {
        let at = |share: f32| {
            let [x, y, z] = finger.at(share).to_array().map(f64::from);
            [x, y, z, f64::from(finger.radii[0] + share * (finger.radii[1] - finger.radii[0]))]
        };
        hand = hand.tube(&[at(-0.1), at(0.35), at(0.7), at(1.0)], 0.05, skin);
    }
    hand.flat_base(0.0, 0.04)
}

impl Finger {
    /// The point of its axis at a share of its length.
    fn at(&self, share: f32) -> Vec3 {
        Vec3::from(self.base).lerp(self.tip.into(), share)
    }

    fn length(&self) -> f32 {
        Vec3::from(self.base).distance(self.tip.into())
    }

    /// The axis that it bends about, towards +Z.
    fn hinge(&self) -> Vec3 {
        (self.at(1.0) - self.at(0.0)).cross(Vec3::Z).normalize()
    }

    /// A point's place along the axis, in lengths from the base, and its distance from it in radii.
    fn place(&self, point: Vec3) -> (f32, f32) {
        let axis = (self.at(1.0) - self.at(0.0)) / self.length();
        let along = (point - self.at(0.0)).dot(axis);
        let share = (along / self.length()).clamp(0.0, 1.0);
        let radius = self.radii[0] + share * (self.radii[1] - self.radii[0]);
        (along, point.distance(self.at(share)) / radius)
    }
}

/// Joint 0 is the palm, which stays; then come the fingers', from base to tip.
fn skin(mesh: &Mesh) -> Skin {
    let mut joints =
        vec![Joint { parent: None, motion: Motion::Still(Pose::IDENTITY), joint_from_rest: Affine3A::IDENTITY }];
    let mut firsts = Vec::new();
    for finger in &FINGERS {
        firsts.push(joints.len());
        let mut before = (0, Vec3::ZERO);
        for &(share, most) in finger.joints {
            let place = finger.at(share);
            let (hinge, offset, phase) = (finger.hinge(), place - before.1, finger.phase);
            joints.push(Joint {
                parent: Some(before.0),
                motion: keyframes(|time| {
                    let bent = 0.5 - 0.5 * wave(time, 1.0, 0.25 - phase);
                    Pose {
                        rotation: Quat::from_axis_angle(hinge, most * (0.05 + 0.85 * bent)),
                        ..Pose::from_translation(offset)
                    }
                }),
                joint_from_rest: Affine3A::from_translation(-place),
            });
            before = (joints.len() - 1, place);
        }
    }
    let influences = (mesh.positions.iter())
        .map(|&position| {
            let mut influences = [(0, 0.0); INFLUENCES];
            influences[0].1 = 1.0;
            let nearest =
                |a: &usize, b: &usize| FINGERS[*a].place(position).1.total_cmp(&FINGERS[*b].place(position).1);
            let Some(number) = (0..FINGERS.len()).min_by(nearest) else { return influences };
            let finger = &FINGERS[number];
            let (along, _) = finger.place(position);
            // Flesh past a joint is moved by it; that which the next one takes over is not.
            for (k, &(share, _)) in finger.joints.iter().enumerate() {
                let x = ((along - share * finger.length()) / (2.0 * SOFTNESS) + 0.5).clamp(0.0, 1.0);
                let passed = x * x * (3.0 - 2.0 * x);
                influences[k + 1] = ((firsts[number] + k) as u16, influences[k].1 * passed);
                influences[k].1 *= 1.0 - passed;
            }
            influences
        })
        .collect();
    Skin { joints, influences, ..Skin::default() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::shapes::tests::check_solid;
    use crate::builtin::tests::built;

    #[test]
    fn the_hand_is_solid_and_its_weights_add_up() {
        let hand = &built("hand").objects[1];
        check_solid(&hand.mesh);
        let skin = hand.skin.as_ref().unwrap();
        assert_eq!((skin.joints.len(), skin.influences.len()), (15, hand.mesh.positions.len()));
        for influences in &skin.influences {
            let total: f32 = influences.iter().map(|(_, weight)| weight).sum();
            assert!((total - 1.0).abs() < 1e-6 && influences.iter().all(|(_, weight)| *weight >= 0.0));
        }
    }

    #[test]
    fn fingers_bend_and_the_wrist_stays() {
        let scene = built("hand");
        let (rest, frame) = (&scene.objects[1].mesh, scene.frame(60));
        let tip = |positions: &[Vec3]| {
            let highest = (0..positions.len()).max_by(|&a, &b| rest.positions[a].y.total_cmp(&rest.positions[b].y));
            positions[highest.unwrap()]
        };
        let moved = tip(frame.positions(1)) - tip(&rest.positions);
        assert!(moved.y < -0.3 && moved.z > 0.2, "{moved}");
        for (now, before) in frame.positions(1).iter().zip(&rest.positions).filter(|(_, before)| before.y < 0.1) {
            assert!(now.distance(*before) < 1e-6);
        }
        // A skin that folds onto itself would turn triangles over.
        let kept = rest.triangles.iter().filter(|triangle| {
            let area = |positions: &[Vec3]| {
                let [a, b, c] = triangle.map(|vertex| positions[vertex as usize]);
                0.5 * (b - a).cross(c - a).length()
            };
            let ratio = area(frame.positions(1)) / area(&rest.positions);
            (0.2..4.0).contains(&ratio)
        });
        assert!(kept.count() as f64 > 0.98 * rest.triangles.len() as f64);
    }
}
