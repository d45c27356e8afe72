//! Scenes beyond diffuse vertices under light from afar: gloss, lamps around bodies, receivers between vertices.

use glam::Vec3;
use halfshade_scene::{
    Frame, Gloss, LafortuneLobe, Motion, Pose, ReceiverBuffer, ReceiverPoint, Reflectance, Scene, SphereLight,
    SurfacePoint,
};

/// Every model of reflectance, on an object each; the last stays diffuse.
pub(super) fn add_gloss(scene: &mut Scene) {
    let lobe = |axis: Vec3, exponent: f32| LafortuneLobe { scale: Vec3::new(0.3, 0.2, 0.1), axis, exponent };
    let models = [
        Reflectance::ModifiedPhong { specular: Vec3::new(0.2, 0.1, 0.0), exponent: 9.0 },
        Reflectance::Phong { specular: Vec3::new(0.1, 0.2, 0.3), exponent: 4.5 },
        Reflectance::Lafortune { lobes: vec![lobe(Vec3::new(-1.0, -0.4, 0.9), 7.0), lobe(Vec3::splat(0.8), 2.0)] },
        Reflectance::Phong { specular: Vec3::ONE, exponent: 0.0 },
    ];
    for (object, model) in scene.objects.iter_mut().zip(models) {
        object.material.albedo *= 0.7;
        object.material.reflectance = model;
    }
}

/// One above all, one that holds a body, one that holds the centre of a body.
pub(super) fn add_lamps(scene: &mut Scene) {
    let places = [(Vec3::new(1.0, 3.0, 0.5), 0.3), (Vec3::new(-1.9, 0.8, 0.1), 1.0), (Vec3::new(0.9, 1.2, 0.6), 0.6)];
    let lamps = places.map(|(center, radius)| SphereLight { center, radius, radiance: Vec3::new(3.0, 2.0, 1.0) });
    scene.lights.extend(lamps.map(|lamp| (lamp, Motion::Still(Pose::IDENTITY))));
}

/// A receiver within every third triangle, some from behind, with gloss that varies; and one that is nowhere on its object.
pub(super) fn between_vertices(frame: &Frame<'_>) -> ReceiverBuffer {
    let mut receivers = ReceiverBuffer::default();
    for (object, pose) in frame.world_from_object.iter().enumerate() {
        let mesh = &frame.scene.objects[object].mesh;
        for (triangle, corners) in mesh.triangles.iter().enumerate().step_by(3) {
            let share = (triangle % 8) as f32 / 8.0;
            let barycentric = [0.25, 0.75 * share, 0.75 * (1.0 - share)];
            let mixed =
                |values: &[Vec3]| corners.iter().zip(barycentric).map(|(&k, w)| w * values[k as usize]).sum::<Vec3>();
            let from_behind = triangle % 21 == 0;
            let normal = pose.rotation * mixed(&mesh.normals).normalize_or(Vec3::Y);
            receivers.add(&ReceiverPoint {
                position: pose.rotation * (pose.scale * mixed(&mesh.positions)) + pose.translation,
                normal: if from_behind { -normal } else { normal },
                albedo: Vec3::new(0.7, 0.6, share),
                gloss: Gloss { specular: Vec3::new(1.0, share, 0.5), exponent: 0.5 + share },
                object: object as u32,
                surface: SurfacePoint::Triangle { triangle: triangle as u32, barycentric, from_behind },
            });
        }
    }
    receivers.push(Vec3::new(0.3, 0.4, 0.5), Vec3::Y, Vec3::ONE, 0);
    receivers
}
