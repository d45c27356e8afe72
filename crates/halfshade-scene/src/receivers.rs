//! Receivers: the points whose outgoing radiance is asked for, as structures of arrays.

use crate::{Frame, Gloss, SurfacePoint};
use glam::{Mat3, Vec3};
use std::ops::Range;

/// Owned receivers, one array per component.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReceiverBuffer {
    /// Positions in world space: x, y, z.
    pub position: [Vec<f32>; 3],
    /// Unit normals in world space: x, y, z.
    pub normal: [Vec<f32>; 3],
    /// Albedo: red, green, blue.
    pub albedo: [Vec<f32>; 3],
    /// The object each receiver lies on.
    pub object: Vec<u32>,
    /// Points on those objects.
    pub surface: Vec<SurfacePoint>,
    /// A number that is stable within the scene: for a vertex receiver its vertex, counted over all objects.
    pub index: Vec<u32>,
    /// Factors of the specular scale, red, green, blue ([`Gloss`]); empty unless gloss varies over some object.
    pub specular_factor: [Vec<f32>; 3],
    /// Factor of the exponents; empty unless gloss varies over some object.
    pub exponent_factor: Vec<f32>,
}

/// A borrowed batch of receivers; every slice has the same length, or is empty where it says so.
#[derive(Debug, Clone, Copy)]
pub struct Receivers<'a> {
    /// Positions in world space: x, y, z.
    pub position: [&'a [f32]; 3],
    /// Unit normals in world space: x, y, z.
    pub normal: [&'a [f32]; 3],
    /// Albedo: red, green, blue.
    pub albedo: [&'a [f32]; 3],
    /// The object each receiver lies on.
    pub object: &'a [u32],
    /// Points on those objects.
    pub surface: &'a [SurfacePoint],
    /// Stable numbers.
    pub index: &'a [u32],
    /// Factors of the specular scale; all empty unless gloss varies over some object. See [`Receivers::gloss_at`].
    pub specular_factor: [&'a [f32]; 3],
    /// Factor of the exponents; empty unless gloss varies over some object.
    pub exponent_factor: &'a [f32],
}

/// One receiver.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReceiverPoint {
    /// Position in world space.
    pub position: Vec3,
    /// Unit normal in world space.
    pub normal: Vec3,
    /// Albedo.
    pub albedo: Vec3,
    /// Gloss, relative to the material of its object.
    pub gloss: Gloss,
    /// The object that it lies on.
    pub object: u32,
    /// Point on that object.
    pub surface: SurfacePoint,
}

impl ReceiverBuffer {
    /// Every vertex of every object, in world space at `frame`.
    pub fn vertices(frame: &Frame<'_>) -> Self {
        let count = frame.scene.vertex_count();
        let mut buffer = Self {
            position: std::array::from_fn(|_| vec![0.0; count]),
            normal: std::array::from_fn(|_| vec![0.0; count]),
            albedo: std::array::from_fn(|_| Vec::with_capacity(count)),
            object: Vec::with_capacity(count),
            surface: Vec::with_capacity(count),
            index: (0..count as u32).collect(),
            ..Self::default()
        };
        for (number, object) in frame.scene.objects.iter().enumerate() {
            let mesh = &object.mesh;
            for vertex in 0..mesh.positions.len() {
                let albedo = object.albedo_at_vertex(vertex);
                buffer.albedo.iter_mut().zip(albedo.to_array()).for_each(|(channel, value)| channel.push(value));
                buffer.object.push(number as u32);
                buffer.surface.push(SurfacePoint::Vertex(vertex as u32));
            }
        }
        if frame.scene.objects.iter().any(|object| object.material.varied_gloss().is_some()) {
            for object in &frame.scene.objects {
                (0..object.mesh.positions.len()).for_each(|vertex| buffer.push_factors(object.gloss_at_vertex(vertex)));
            }
        }
        buffer.move_vertices(frame);
        buffer
    }

    fn push_factors(&mut self, gloss: Gloss) {
        self.specular_factor.iter_mut().zip(gloss.specular.to_array()).for_each(|(channel, value)| channel.push(value));
        self.exponent_factor.push(gloss.exponent);
    }

    /// Makes this [`ReceiverBuffer::vertices`] of `frame`, given that it was that of another frame of the same scene:
    /// moves positions and normals in place and allocates nothing. A buffer of another length is made anew.
    pub fn update_vertices(&mut self, frame: &Frame<'_>) {
        if self.len() == frame.scene.vertex_count() {
            self.move_vertices(frame);
        } else {
            *self = Self::vertices(frame);
        }
    }

    fn move_vertices(&mut self, frame: &Frame<'_>) {
        let mut first = 0;
        for (object, pose) in frame.world_from_object.iter().enumerate() {
            let (positions, normals) = (frame.positions(object), frame.normals(object));
            let range = first..first + positions.len();
            first = range.end;
            // Per vertex, a matrix is cheaper than a quaternion.
            let rotation = Mat3::from_quat(pose.rotation);
            let scaled = rotation * pose.scale;
            let [x, y, z] = self.position.each_mut().map(|axis| &mut axis[range.clone()]);
            for (((x, y), z), &position) in x.iter_mut().zip(y).zip(z).zip(positions) {
                [*x, *y, *z] = (scaled * position + pose.translation).to_array();
            }
            let [x, y, z] = self.normal.each_mut().map(|axis| &mut axis[range.clone()]);
            for (((x, y), z), &normal) in x.iter_mut().zip(y).zip(z).zip(normals) {
                [*x, *y, *z] = (rotation * normal).to_array();
            }
        }
    }

    /// Adds a receiver that lies nowhere on its object's mesh; its stable number is its place.
    pub fn push(&mut self, position: Vec3, normal: Vec3, albedo: Vec3, object: u32) {
        let surface = SurfacePoint::Elsewhere;
        self.add(&ReceiverPoint { position, normal, albedo, gloss: Gloss::NEUTRAL, object, surface });
    }

    /// Adds a receiver; its stable number is its place.
    pub fn add(&mut self, receiver: &ReceiverPoint) {
        let &ReceiverPoint { position, normal, albedo, gloss, object, surface } = receiver;
        if gloss != Gloss::NEUTRAL || !self.exponent_factor.is_empty() {
            // Up to the first that differs, none was stored.
            while self.exponent_factor.len() < self.len() {
                self.push_factors(Gloss::NEUTRAL);
            }
            self.push_factors(gloss);
        }
        self.index.push(self.object.len() as u32);
        self.object.push(object);
        self.surface.push(surface);
        for axis in 0..3 {
            self.position[axis].push(position[axis]);
            self.normal[axis].push(normal[axis]);
            self.albedo[axis].push(albedo[axis]);
        }
    }

    /// The receivers at `places` of a batch, in that order.
    pub fn gathered(receivers: Receivers<'_>, places: &[u32]) -> Self {
        let of = |values: &[f32]| places.iter().map(|&place| values[place as usize]).collect();
        let whole = |values: &[u32]| places.iter().map(|&place| values[place as usize]).collect();
        Self {
            position: receivers.position.map(of),
            normal: receivers.normal.map(of),
            albedo: receivers.albedo.map(of),
            object: whole(receivers.object),
            surface: places.iter().map(|&place| receivers.surface[place as usize]).collect(),
            index: whole(receivers.index),
            specular_factor: receivers
                .specular_factor
                .map(|values| if values.is_empty() { Vec::new() } else { of(values) }),
            exponent_factor: if receivers.exponent_factor.is_empty() {
                Vec::new()
            } else {
                of(receivers.exponent_factor)
            },
        }
    }

    /// Removes all receivers and keeps the memory.
    pub fn clear(&mut self) {
        self.position.iter_mut().chain(&mut self.normal).chain(&mut self.albedo).for_each(Vec::clear);
        self.object.clear();
        self.surface.clear();
        self.index.clear();
        self.specular_factor.iter_mut().for_each(Vec::clear);
        self.exponent_factor.clear();
    }

    /// Number of receivers.
    pub fn len(&self) -> usize {
        self.object.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.object.is_empty()
    }

    /// All of them, borrowed.
    pub fn view(&self) -> Receivers<'_> {
        Receivers {
            position: self.position.each_ref().map(Vec::as_slice),
            normal: self.normal.each_ref().map(Vec::as_slice),
            albedo: self.albedo.each_ref().map(Vec::as_slice),
            object: &self.object,
            surface: &self.surface,
            index: &self.index,
            specular_factor: self.specular_factor.each_ref().map(Vec::as_slice),
            exponent_factor: &self.exponent_factor,
        }
    }
}

impl<'a> Receivers<'a> {
    /// Number of receivers.
    pub fn len(&self) -> usize {
        self.object.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.object.is_empty()
    }

    /// A part of the batch.
    pub fn slice(&self, range: Range<usize>) -> Self {
        Self {
            position: self.position.map(|axis| &axis[range.clone()]),
            normal: self.normal.map(|axis| &axis[range.clone()]),
            albedo: self.albedo.map(|channel| &channel[range.clone()]),
            object: &self.object[range.clone()],
            surface: &self.surface[range.clone()],
            index: &self.index[range.clone()],
            specular_factor: self.specular_factor.map(|channel| part(channel, &range)),
            exponent_factor: part(self.exponent_factor, &range),
        }
    }

    /// Position of receiver `i` in world space.
    pub fn position_at(&self, i: usize) -> Vec3 {
        Vec3::from(self.position.map(|axis| axis[i]))
    }

    /// Unit normal of receiver `i` in world space.
    pub fn normal_at(&self, i: usize) -> Vec3 {
        Vec3::from(self.normal.map(|axis| axis[i]))
    }

    /// Albedo of receiver `i`.
    pub fn albedo_at(&self, i: usize) -> Vec3 {
        Vec3::from(self.albedo.map(|channel| channel[i]))
    }

    /// Receiver `i` as a whole.
    pub fn at(&self, i: usize) -> ReceiverPoint {
        ReceiverPoint {
            position: self.position_at(i),
            normal: self.normal_at(i),
            albedo: self.albedo_at(i),
            gloss: self.gloss_at(i),
            object: self.object[i],
            surface: self.surface[i],
        }
    }

    /// Gloss of receiver `i`, relative to the material of its object.
    pub fn gloss_at(&self, i: usize) -> Gloss {
        match self.exponent_factor.get(i) {
            Some(&exponent) => Gloss { specular: Vec3::from(self.specular_factor.map(|channel| channel[i])), exponent },
            None => Gloss::NEUTRAL,
        }
    }
}

/// A part of values that may all be missing.
fn part<'a>(values: &'a [f32], range: &Range<usize>) -> &'a [f32] {
    if values.is_empty() { values } else { &values[range.clone()] }
}

/// Owned outgoing radiance, one array per channel.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RadianceBuffer {
    /// Red, green, blue.
    pub channels: [Vec<f32>; 3],
}

/// Borrowed outgoing radiance to write; every slice has the receivers' length.
#[derive(Debug)]
pub struct RadianceMut<'a> {
    /// Red, green, blue.
    pub channels: [&'a mut [f32]; 3],
}

impl RadianceBuffer {
    /// Black, for `len` receivers.
    pub fn zeros(len: usize) -> Self {
        Self { channels: std::array::from_fn(|_| vec![0.0; len]) }
    }

    /// Number of receivers.
    pub fn len(&self) -> usize {
        self.channels[0].len()
    }

    /// Whether it is for none.
    pub fn is_empty(&self) -> bool {
        self.channels[0].is_empty()
    }

    /// All of it, to write.
    pub fn view_mut(&mut self) -> RadianceMut<'_> {
        RadianceMut { channels: self.channels.each_mut().map(Vec::as_mut_slice) }
    }

    /// Radiance of receiver `i`.
    pub fn at(&self, i: usize) -> Vec3 {
        Vec3::from(self.channels.each_ref().map(|channel| channel[i]))
    }
}

impl<'a> RadianceMut<'a> {
    /// Number of receivers.
    pub fn len(&self) -> usize {
        self.channels[0].len()
    }

    /// Whether it is for none.
    pub fn is_empty(&self) -> bool {
        self.channels[0].is_empty()
    }

    /// Two parts: the first `mid` receivers, and the rest.
    pub fn split_at(self, mid: usize) -> (Self, Self) {
        let [r, g, b] = self.channels;
        let ((r0, r1), (g0, g1), (b0, b1)) = (r.split_at_mut(mid), g.split_at_mut(mid), b.split_at_mut(mid));
        (Self { channels: [r0, g0, b0] }, Self { channels: [r1, g1, b1] })
    }

    /// Sets the radiance of receiver `i`.
    pub fn set(&mut self, i: usize, radiance: Vec3) {
        for (channel, value) in self.channels.iter_mut().zip(radiance.to_array()) {
            channel[i] = value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::tests::built;

    fn rows(view: &Receivers<'_>) -> Vec<(Vec3, Vec3, Vec3, u32, u32)> {
        (0..view.len())
            .map(|i| (view.position_at(i), view.normal_at(i), view.albedo_at(i), view.object[i], view.index[i]))
            .collect()
    }

    #[test]
    fn pushed_receivers_come_back() {
        let given: Vec<_> = (0..5)
            .map(|i| {
                (Vec3::splat(i as f32), Vec3::new(0.0, 1.0, i as f32), Vec3::new(0.1 * i as f32, 0.5, 1.0), i / 2, i)
            })
            .collect();
        let mut buffer = ReceiverBuffer::default();
        assert!(buffer.is_empty() && buffer.view().is_empty());
        for &(position, normal, albedo, object, _) in &given {
            buffer.push(position, normal, albedo, object);
        }
        assert_eq!((buffer.len(), buffer.view().len()), (5, 5));
        assert_eq!(rows(&buffer.view()), given);
        // A slice keeps the numbers that its receivers had.
        assert_eq!(rows(&buffer.view().slice(1..4)), given[1..4]);
        assert_eq!(rows(&buffer.view().slice(1..4).slice(1..2)), given[2..3]);
        assert!(buffer.view().slice(5..5).is_empty());
    }

    #[test]
    fn vertices_stand_where_their_poses_put_them() {
        let scene = built("squirrel-and-balls");
        let frame = scene.frame(37);
        let buffer = ReceiverBuffer::vertices(&frame);
        assert_eq!(buffer.len(), scene.vertex_count());
        let mut receiver = 0;
        for (number, object) in scene.objects.iter().enumerate() {
            let (mesh, pose) = (&object.mesh, &frame.world_from_object[number]);
            for vertex in 0..mesh.positions.len() {
                let (position, normal) = (buffer.view().position_at(receiver), buffer.view().normal_at(receiver));
                assert!(position.distance(pose.transform_point(mesh.positions[vertex])) < 1e-6);
                assert!(normal.distance(pose.transform_direction(mesh.normals[vertex])) < 1e-6);
                let color = mesh.colors.get(vertex).copied().unwrap_or(Vec3::ONE);
                assert_eq!(buffer.view().albedo_at(receiver), color * object.material.albedo);
                assert_eq!((buffer.object[receiver], buffer.index[receiver]), (number as u32, receiver as u32));
                assert_eq!(buffer.surface[receiver], SurfacePoint::Vertex(vertex as u32));
                receiver += 1;
            }
        }
    }

    #[test]
    fn an_update_equals_a_new_buffer_and_moves_no_memory() {
        let scene = built("one-sphere");
        let mut buffer = ReceiverBuffer::vertices(&scene.frame(0));
        let place = buffer.position[0].as_ptr();
        for index in [50, 3, 110] {
            buffer.update_vertices(&scene.frame(index));
            assert_eq!(buffer, ReceiverBuffer::vertices(&scene.frame(index)));
        }
        assert_eq!(buffer.position[0].as_ptr(), place);
        let other = built("crowd");
        buffer.update_vertices(&other.frame(1));
        assert_eq!(buffer, ReceiverBuffer::vertices(&other.frame(1)));
    }

    #[test]
    fn gloss_is_stored_from_the_first_receiver_on_that_differs() {
        let mut buffer = ReceiverBuffer::default();
        let gloss = Gloss { specular: Vec3::new(0.1, 0.2, 0.3), exponent: 0.5 };
        buffer.push(Vec3::ZERO, Vec3::Y, Vec3::ONE, 0);
        assert!(buffer.exponent_factor.is_empty());
        let glossy = ReceiverPoint { gloss, ..buffer.view().at(0) };
        buffer.add(&glossy);
        buffer.push(Vec3::ZERO, Vec3::Y, Vec3::ONE, 0);
        let found = [0, 1, 2].map(|i| buffer.view().gloss_at(i));
        assert_eq!(found, [Gloss::NEUTRAL, gloss, Gloss::NEUTRAL]);
        assert_eq!(buffer.view().at(1), glossy);
        assert_eq!(buffer.view().slice(1..3).gloss_at(0), gloss);
    }

    #[test]
    fn radiance_is_split_without_gap_or_overlap() {
        let mut buffer = RadianceBuffer::zeros(7);
        assert!(buffer.len() == 7 && !buffer.is_empty());
        let (mut head, tail) = buffer.view_mut().split_at(3);
        let (mut middle, mut last) = tail.split_at(4);
        assert_eq!((head.len(), middle.len(), last.is_empty()), (3, 4, true));
        (0..3).for_each(|i| head.set(i, Vec3::new(i as f32, 10.0, 20.0)));
        (0..4).for_each(|i| middle.set(i, Vec3::new((i + 3) as f32, 10.0, 20.0)));
        assert!(last.channels.iter_mut().all(|channel| channel.is_empty()));
        for i in 0..7 {
            assert_eq!(buffer.at(i), Vec3::new(i as f32, 10.0, 20.0));
        }
    }
}
