//! Movement of a node in the world: its own, and that of the nodes above it.

use super::nodes::{PlacedNode, base, label};
use super::track::pose_of;
use crate::{Motion, Pose, SceneError};

/// Longest step between keys of nodes that move within others that move, in between which poses are interpolated.
const PIECE_SECS: f64 = 1.0 / 60.0;
/// Most keys that steps may add.
const MOST_KEYS: usize = 1 << 16;

/// The movement of a node that an animation moves, itself or by a node above it.
pub(super) fn motion(places: &[PlacedNode<'_>], node: usize) -> Result<Motion, SceneError> {
    let mut chain = Vec::new();
    let mut next = Some(node);
    while let Some(place) = next.map(|index| &places[index]) {
        let motion = match &place.tracks {
            Some(tracks) => base(place).and_then(|base| tracks.motion(base)),
            None => pose_of(&place.parent_from_node).map(Motion::Still),
        };
        let about =
            |error: SceneError| SceneError { problem: format!("{}: {}", label(&place.node), error.problem), ..error };
        chain.push(motion.map_err(about)?);
        next = place.parent;
    }
    let at = |time: f64| chain.iter().fold(Pose::IDENTITY, |pose, motion| pose.then(&motion.at(time)));
    let mut times = Vec::new();
    let mut movements = 0;
    for motion in &chain {
        if let Motion::Keyframes(keys) = motion {
            times.extend(keys.iter().map(|(time, _)| *time));
            movements += 1;
        }
    }
    times.sort_by(f64::total_cmp);
    times.dedup();
    if movements > 1 {
        times = refined(&times);
    }
    let keys: Vec<(f64, Pose)> = times.into_iter().map(|time| (time, at(time))).collect();
    let is_sound = |pose: &Pose| pose.translation.is_finite() && pose.scale.is_finite() && pose.scale > 0.0;
    match keys.iter().all(|(_, pose)| is_sound(pose)) {
        true => Ok(Motion::Keyframes(keys)),
        false => Err(SceneError::new(format!("{}: it moves too far out to compute with", label(&places[node].node)))),
    }
}

/// Times with others in between, none farther apart than [`PIECE_SECS`] unless there would be too many.
fn refined(times: &[f64]) -> Vec<f64> {
    let (Some(first), Some(last)) = (times.first(), times.last()) else { return Vec::new() };
    let step = PIECE_SECS.max((last - first) / MOST_KEYS as f64);
    let mut refined = vec![*first];
    for pair in times.windows(2) {
        let pieces = ((pair[1] - pair[0]) / step).ceil().max(1.0) as usize;
        refined.extend((1..=pieces).map(|piece| pair[0] + (pair[1] - pair[0]) * piece as f64 / pieces as f64));
    }
    refined
}
