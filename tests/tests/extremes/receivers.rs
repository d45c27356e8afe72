//! Receivers on the surfaces of a scene: vertices, and points between them.

use crate::{random::Random, scene::Drawn};
use glam::{DVec3, Vec3};
use halfshade_scene::{Frame, ReceiverBuffer, ReceiverPoint, Receivers, SurfacePoint};

/// Most vertices of a scene that are asked.
const VERTICES: usize = 24;

/// Points between vertices.
const POINTS: usize = 12;

/// A point of a triangle of an object.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    pub(crate) object: usize,
    pub(crate) triangle: usize,
    pub(crate) weights: DVec3,
}

/// Places of a scene's receivers, in whatever frame.
pub(crate) struct Places {
    vertices: Vec<u32>,
    points: Vec<Place>,
}

impl Places {
    pub(crate) fn draw(drawn: &Drawn, random: &mut Random) -> Self {
        let count = drawn.scene.vertex_count();
        let mut vertices: Vec<u32> = (0..VERTICES.min(count)).map(|_| random.below(count) as u32).collect();
        vertices.sort_unstable();
        vertices.dedup();
        Self { vertices, points: (0..POINTS).filter_map(|_| place(drawn, random)).collect() }
    }

    /// The vertices, and the points, in world space.
    pub(crate) fn receivers(&self, frame: &Frame<'_>) -> [ReceiverBuffer; 2] {
        let vertices = ReceiverBuffer::gathered(ReceiverBuffer::vertices(frame).view(), &self.vertices);
        [vertices, at(frame, &self.points)]
    }
}

/// A point of a triangle, if the scene has any; on an edge as often as not.
pub(crate) fn place(drawn: &Drawn, random: &mut Random) -> Option<Place> {
    let objects = &drawn.scene.objects;
    let solid: Vec<usize> = (0..objects.len()).filter(|&i| !objects[i].mesh.triangles.is_empty()).collect();
    let object = *solid.get(random.below(solid.len()))?;
    let triangle = random.below(objects[object].mesh.triangles.len());
    let mut corner = || f64::from(random.between(0.0, 1.0));
    let weights = DVec3::new(corner(), corner(), if triangle.is_multiple_of(2) { 0.0 } else { corner() }) + 1e-6;
    Some(Place { object, triangle, weights: weights / weights.element_sum() })
}

/// Receivers at `places`.
pub(crate) fn at(frame: &Frame<'_>, places: &[Place]) -> ReceiverBuffer {
    let mut buffer = ReceiverBuffer::default();
    for &Place { object, triangle, weights } in places {
        let (of, pose) = (&frame.scene.objects[object], &frame.world_from_object[object]);
        let corners = of.mesh.triangles[triangle].map(|vertex| vertex as usize);
        let mixed = |values: &dyn Fn(usize) -> Vec3| {
            let [a, b, c] = corners.map(|corner| values(corner).as_dvec3());
            weights.x * a + weights.y * b + weights.z * c
        };
        let position = mixed(&|v| pose.transform_point(frame.positions(object)[v])).as_vec3();
        let normal = mixed(&|v| pose.transform_direction(frame.normals(object)[v])).normalize_or(DVec3::Y).as_vec3();
        buffer.add(&ReceiverPoint {
            position,
            normal,
            albedo: of.albedo_at(triangle, weights),
            gloss: of.gloss_at(triangle, weights),
            object: object as u32,
            surface: SurfacePoint::Triangle {
                triangle: triangle as u32,
                barycentric: weights.as_vec3().to_array(),
                from_behind: false,
            },
        });
    }
    buffer
}

/// Describes a receiver to people.
pub(crate) fn described(receivers: Receivers<'_>, i: usize) -> String {
    format!(
        "receiver at {} facing {} of object {}",
        receivers.position_at(i),
        receivers.normal_at(i),
        receivers.object[i]
    )
}
