//! Objects and lights in the order in which one receiver sees them.

use super::receiver::Receiver;
use crate::shadow_field::{
    kernel::light_order::{LightSeen, distance_squared},
    prepare::frame::FrameData,
};

/// Objects and lights as one receiver sees them.
#[derive(Debug, Default)]
pub(crate) struct Order {
    /// All others, from near to far, by squared distance.
    pub(crate) objects: Vec<(f32, usize)>,
    /// Which objects are before each light.
    lights: Vec<Before>,
}

/// The objects before a light, counted from near to far.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Before {
    /// The first so many.
    First(usize),
    /// Others too, as where the light is all around.
    Others,
}

impl Order {
    pub(crate) fn set(&mut self, frame: &FrameData, receiver: &Receiver) {
        let Self { objects, lights } = self;
        let distance =
            |&other: &usize| (distance_squared(&frame.objects[other].center, &receiver.position).as_array()[0], other);
        objects.clear();
        objects.extend(frame.nearest_first[receiver.place.object].iter().map(distance));
        objects.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        lights.clear();
        lights.extend((0..frame.lights.len()).map(|light| {
            let seen = frame.see(light, &receiver.position);
            let is_before = |&(_, other): &(f32, usize)| is_before(frame, other, light, &seen, receiver);
            let first = objects.iter().take_while(|object| is_before(object)).count();
            if objects[first..].iter().any(is_before) { Before::Others } else { Before::First(first) }
        }));
    }

    /// The lights that have these objects before them.
    pub(crate) fn lights_behind(&self, objects: Before) -> impl Iterator<Item = usize> {
        (0..self.lights.len()).filter(move |&light| self.lights[light] == objects)
    }
}

/// Whether an object is before a light.
pub(crate) fn is_before(frame: &FrameData, object: usize, light: usize, seen: &LightSeen, receiver: &Receiver) -> bool {
    frame.is_before(object, light, seen, &receiver.position).to_bitmask() & 1 != 0
}
