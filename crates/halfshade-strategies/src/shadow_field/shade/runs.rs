//! Runs of receivers of one object, each of which has its order of the others.

use halfshade_scene::Receivers;
use std::ops::Range;

/// Calls with runs of receivers of one object; `None` where there is no such object.
pub(crate) fn each_object(
    receivers: Receivers<'_>,
    object_count: usize,
    mut work: impl FnMut(Range<usize>, Option<usize>),
) {
    let mut first = 0;
    for run in receivers.object.chunk_by(|a, b| a == b) {
        let object = run[0] as usize;
        work(first..first + run.len(), (object < object_count).then_some(object));
        first += run.len();
    }
}
