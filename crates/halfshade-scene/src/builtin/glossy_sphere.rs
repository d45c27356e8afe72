//! A sphere whose gloss varies from vertex to vertex, under one spherical light, without blockers.
//!
//! After [Meunier2009, figure 14]: 65,536 shaded points, Lafortune lobes with spatially varying parameters, what
//! reflectance costs when visibility costs nothing. The pattern and the numbers are our own.

use crate::{
    Camera, Environment, Gloss, GlossVariation, LafortuneLobe, Material, Mesh, Motion, Object, Pose, Reflectance,
    Scene, SphereLight,
};
use glam::{DVec3, Vec3};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Rows of vertices from pole to pole, and vertices in each.
const SIDE: usize = 256;

/// The sharpest highlight's exponent, and the dullest's.
const EXPONENTS: [f64; 2] = [200.0, 4.0];

pub(super) fn scene() -> Scene {
    let lobes = vec![
        // Near the mirrored direction, brighter towards grazing angles, a little wider along the meridians.
        LafortuneLobe {
            scale: Vec3::splat(0.35 * (EXPONENTS[0] as f32 + 2.0) / std::f32::consts::TAU),
            axis: Vec3::new(-1.0, -0.998, 0.999),
            exponent: EXPONENTS[0] as f32,
        },
        // A soft sheen back to where the light is.
        LafortuneLobe { scale: Vec3::new(4.0, 2.6, 1.2), axis: Vec3::new(0.7, 0.7, 0.9), exponent: 40.0 },
    ];
    let variation = GlossVariation { vertices: pattern(), ..GlossVariation::default() };
    let material = Material {
        reflectance: Reflectance::Lafortune { lobes },
        gloss_variation: Some(Arc::new(variation)),
        ..Material::new(Vec3::new(0.12, 0.2, 0.32))
    };
    let sphere = Object::new("sphere", mesh()).material(material).cluster_count(64);
    let light = SphereLight { center: Vec3::new(2.5, 3.0, 3.0), radius: 0.6, radiance: Vec3::splat(30.0) };
    Scene {
        lights: vec![(light, Motion::Still(Pose::IDENTITY))],
        camera: Camera {
            eye: Vec3::new(0.0, 0.8, 4.2),
            target: Vec3::ZERO,
            vertical_fov_degrees: 32.0,
            resolution: [800, 600],
        },
        ..Scene::at_rest("glossy-sphere", vec![sphere], Environment::constant(Vec3::ZERO))
    }
}

/// Polar angle and azimuth of each vertex, row by row from +Y.
fn angles() -> impl Iterator<Item = [f64; 2]> {
    (0..SIDE * SIDE).map(|i| {
        let turn = |place: usize, whole: f64| whole * (place as f64 + 0.5) / SIDE as f64;
        [turn(i / SIDE, PI), turn(i % SIDE, TAU)]
    })
}

/// The sphere of radius 1: rings of vertices, the polygons within the first and the last closed by fans.
fn mesh() -> Mesh {
    let positions: Vec<Vec3> = angles()
        .map(|[polar, azimuth]| {
            DVec3::new(polar.sin() * azimuth.sin(), polar.cos(), polar.sin() * azimuth.cos()).as_vec3()
        })
        .collect();
    let at = |row: usize, column: usize| (row * SIDE + column % SIDE) as u32;
    let mut triangles = Vec::with_capacity(2 * SIDE * SIDE);
    for row in 0..SIDE - 1 {
        for column in 0..SIDE {
            let (a, b) = (at(row, column), at(row, column + 1));
            let (c, d) = (at(row + 1, column), at(row + 1, column + 1));
            triangles.extend([[a, c, d], [a, d, b]]);
        }
    }
    for column in 1..SIDE - 1 {
        triangles.push([at(0, 0), at(0, column), at(0, column + 1)]);
        triangles.push([at(SIDE - 1, 0), at(SIDE - 1, column + 1), at(SIDE - 1, column)]);
    }
    let normals = positions.iter().map(|p| p.normalize()).collect();
    Mesh { positions, normals, triangles, ..Mesh::default() }
}

/// Exponents that fall to a fiftieth and come back seven times around the sphere, on waves of strong and faint gloss.
/// An exponent makes highlights as much wider as it makes them lower: scales go with (e + 2).
fn pattern() -> Vec<Gloss> {
    let [sharp, dull] = EXPONENTS;
    angles()
        .map(|[polar, azimuth]| {
            let dullness = 0.5 - 0.5 * (7.0 * azimuth + 1.0).cos();
            let factor = (dull / sharp).powf(dullness);
            let wave = (18.0 * polar).sin() * (24.0 * azimuth).sin();
            let strength = 0.25 + 0.75 / (1.0 + (-8.0 * wave).exp());
            let scale = strength * (sharp * factor + 2.0) / (sharp + 2.0);
            let tint = 0.3 * (5.0 * polar).cos().powi(2);
            let specular = scale * DVec3::new(1.0, 1.0 - 0.3 * tint, 1.0 - tint);
            Gloss { specular: specular.as_vec3(), exponent: factor as f32 }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EyeLobes, ReceiverBuffer, builtin::shapes::tests::check_solid};

    #[test]
    fn a_solid_sphere_of_65536_points_with_lobes_in_range() {
        let scene = scene();
        assert_eq!(scene.vertex_count(), 65_536);
        check_solid(&scene.objects[0].mesh);
        let material = &scene.objects[0].material;
        material.reflectance.validate(material.albedo).unwrap();
        let factors = &material.gloss_variation.as_ref().unwrap().vertices;
        assert!(factors.iter().all(|gloss| gloss.specular.min_element() > 0.0 && gloss.specular.max_element() <= 1.0));
        assert!(factors.iter().all(|gloss| gloss.exponent > 0.0 && gloss.exponent <= 1.0));
        let frame = scene.frame(0);
        let (lobes, receivers) = (EyeLobes::new(&frame).unwrap(), ReceiverBuffer::vertices(&frame));
        let seen = (0..receivers.len()).filter(|&i| lobes.at(&receivers.view(), i).len() == 2).count();
        // From 4.3 radii away a little less than half of the sphere is seen.
        assert!((20_000..32_768).contains(&seen), "{seen}");
    }
}
