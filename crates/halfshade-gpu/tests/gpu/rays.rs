//! `ray-traced` on the device beside the CPU: glossy receivers, meshes with holes.

use super::{
    beside_the_cpu::{compare_in, environments, scene},
    surfaces::{add_gloss, add_lamps, between_vertices},
};
use glam::{Quat, Vec2, Vec3};
use halfshade_scene::{
    Mesh, Object, Pose, ReceiverBuffer, Reflectance, Texture,
    builtin::shapes,
    mesh::AlphaMask,
    texture::{Filter, Wrap},
};
use halfshade_strategy::Strategy;
use libtest_mimic::Failed;
use std::sync::Arc;

/// Settings by which glossy receivers are shaded: by reflectance and light together, in more than one dispatch, and by either.
pub(super) const GLOSS: [&str; 4] =
    ["plain,samples=16,sampling=cosine", "plain,samples=16,sampling=light", "unfiltered,samples=70", ""];

/// Every model of reflectance and a sharp lobe, at vertices and between them.
pub(super) fn shades_gloss(strategies: [&dyn Strategy; 2], settings: &str) -> Result<(), Failed> {
    for (light, environment) in environments().into_iter().enumerate() {
        let mut scene = scene(1.0, environment);
        add_gloss(&mut scene);
        add_lamps(&mut scene);
        scene.objects[4].material.reflectance = Reflectance::Phong { specular: Vec3::splat(300.0), exponent: 2000.0 };
        scene.camera.eye = Vec3::new(0.5, 3.0, 4.0);
        let frame = scene.frame(0);
        for (place, receivers) in
            [("vertices", ReceiverBuffer::vertices(&frame)), ("between vertices", between_vertices(&frame))]
        {
            compare_in(strategies, &scene, &receivers, settings)
                .map_err(|problem| format!("light {light}, {place}: {problem}"))?;
        }
    }
    Ok(())
}

/// Sheets above all else with masks of every kind.
pub(super) fn passes_through_holes(strategies: [&dyn Strategy; 2]) -> Result<(), Failed> {
    for (light, environment) in environments().into_iter().enumerate() {
        let mut scene = scene(1.0, environment);
        add_lamps(&mut scene);
        let wraps = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];
        let mut meshes: Vec<Mesh> = (wraps.iter())
            .flat_map(|&wrap| [Filter::Linear, Filter::Nearest].map(|filter| sheet(wrap, filter)))
            .collect();
        // Alpha of vertices alone.
        meshes.extend(meshes.first().cloned().map(|mesh| {
            let masks = vec![AlphaMask { texture: None, cutoff: 0.5 }];
            Mesh { masks, texture_coordinates: Vec::new(), ..mesh }
        }));
        scene.objects.extend(meshes.into_iter().enumerate().map(|(i, mesh)| {
            let pose = Pose {
                scale: 0.6,
                rotation: Quat::from_rotation_x(0.2 * i as f32),
                translation: Vec3::new(1.3 * (i % 4) as f32 - 2.0, 1.6, 1.5 * (i / 4) as f32 - 1.0),
            };
            Object::new(format!("sheet {i}"), mesh).pose(pose)
        }));
        let receivers = ReceiverBuffer::vertices(&scene.frame(0));
        compare_in(strategies, &scene, &receivers, "plain,samples=16")
            .map_err(|problem| format!("light {light}: {problem}"))?;
    }
    Ok(())
}

/// A square with texture coordinates of twice its texture's extent around it, and alpha that falls along z. A third of its
/// triangles is whole.
fn sheet(wrap: Wrap, filter: Filter) -> Mesh {
    let alpha = (0..5 * 3).map(|i| Vec3::splat((i * 7 % 15) as f32 / 15.0)).collect();
    let texture = Texture::new(5, 3, alpha).expect("as many texels as it is large").wrapped([wrap, Wrap::Repeat]);
    let mesh = shapes::plane(4);
    // No corner is shared, as each has the number of its triangle's mask.
    let corners: Vec<usize> = mesh.triangles.iter().flatten().map(|&vertex| vertex as usize).collect();
    let of_corners = |values: &[Vec3]| corners.iter().map(|&corner| values[corner]).collect::<Vec<_>>();
    let positions = of_corners(&mesh.positions);
    let coverage =
        |(corner, place): (usize, &Vec3)| Vec2::new(0.8 - 0.2 * place.z, if corner / 3 % 3 == 0 { 9.0 } else { 0.0 });
    Mesh {
        texture_coordinates: positions.iter().map(|place| 2.0 * Vec3::new(place.x, place.z, 0.0)).collect(),
        masks: vec![AlphaMask { texture: Some(Arc::new(texture.filtered(filter))), cutoff: 0.4 }],
        coverage: positions.iter().enumerate().map(coverage).collect(),
        normals: of_corners(&mesh.normals),
        triangles: (0..mesh.triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        positions,
        ..mesh
    }
}
