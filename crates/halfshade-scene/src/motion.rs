//! Poses over time, so that a scene can move.

use crate::Pose;

/// Pose over time.
#[derive(Debug, Clone, PartialEq)]
pub enum Motion {
    /// It doesn't.
    Still(Pose),
    /// Keyframes `(time_secs, pose)` in rising order of time, at least one. Between keys, translation and the logarithm
    /// of the scale are interpolated linearly, rotation spherically; outside, the nearest key holds.
    Keyframes(Vec<(f64, Pose)>),
}

impl Motion {
    /// The pose at `time_secs`.
    pub fn at(&self, time_secs: f64) -> Pose {
        match self {
            Self::Still(pose) => *pose,
            Self::Keyframes(keys) => {
                let after = keys.partition_point(|(time, _)| *time <= time_secs);
                let (Some((t0, a)), Some((t1, b))) = (after.checked_sub(1).map(|i| keys[i]), keys.get(after).copied())
                else {
                    let nearest = if after == 0 { keys.first() } else { keys.last() };
                    return nearest.map_or(Pose::IDENTITY, |(_, pose)| *pose);
                };
                let x = ((time_secs - t0) / (t1 - t0)) as f32;
                Pose {
                    scale: a.scale.powf(1.0 - x) * b.scale.powf(x),
                    rotation: a.rotation.slerp(b.rotation, x),
                    translation: a.translation.lerp(b.translation, x),
                }
            }
        }
    }

    /// The time of the last keyframe, if there is one.
    pub fn last_key_secs(&self) -> Option<f64> {
        match self {
            Self::Still(_) => None,
            Self::Keyframes(keys) => keys.last().map(|(time, _)| *time),
        }
    }

    /// Whether the pose ever changes.
    pub fn moves(&self) -> bool {
        match self {
            Self::Still(_) => false,
            Self::Keyframes(keys) => keys.windows(2).any(|pair| pair[0].1 != pair[1].1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn keyframes_interpolate_and_hold() {
        let motion = Motion::Keyframes(vec![
            (1.0, Pose::from_translation(Vec3::ZERO)),
            (3.0, Pose::from_translation(Vec3::new(4.0, 0.0, 0.0))),
        ]);
        assert_eq!(motion.at(0.0).translation, Vec3::ZERO);
        assert_eq!(motion.at(2.0).translation, Vec3::new(2.0, 0.0, 0.0));
        assert_eq!(motion.at(9.0).translation, Vec3::new(4.0, 0.0, 0.0));
        assert!(motion.moves() && !Motion::Still(Pose::IDENTITY).moves());
    }
}
