//! Where receivers go that move.

use crate::prt::bake::arrangement::Arrangement;
use glam::Vec3;
use halfshade_scene::Scene;

/// The box around everything that moves, over all frames, in the world as it is at the first frame.
pub(crate) fn of_movers(scene: &Scene, arrangement: &Arrangement) -> Option<[Vec3; 2]> {
    let mut found: Option<[Vec3; 2]> = None;
    for index in 0..scene.frame_count.max(1) {
        let frame = scene.frame(index);
        let baked_from_world = arrangement.pose_from_world(&frame.world_from_object);
        for number in (0..scene.objects.len()).filter(|&number| arrangement.moves(number)) {
            let Some(corners) = corners(frame.positions(number)) else { continue };
            let pose = frame.world_from_object[number].then(&baked_from_world);
            for corner in
                corners.map(|corner| pose.transform_point(corner)).into_iter().filter(|corner| corner.is_finite())
            {
                let [low, high] = found.unwrap_or([corner; 2]);
                found = Some([low.min(corner), high.max(corner)]);
            }
        }
    }
    found
}

/// The corners of the box around positions.
fn corners(positions: &[Vec3]) -> Option<[Vec3; 8]> {
    let low = positions.iter().copied().reduce(Vec3::min)?;
    let high = positions.iter().copied().reduce(Vec3::max)?;
    let side = |bit: usize| if bit == 0 { low } else { high };
    Some(std::array::from_fn(|k| Vec3::new(side(k & 1).x, side(k & 2).y, side(k & 4).z)))
}
