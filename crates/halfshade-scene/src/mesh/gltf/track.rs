//! Animation of one glTF node: channels, and the keyframes that they become.
//!
//! A [`Motion`] has keys of whole poses. Channels of one node have times of their own, so the pose is taken at all
//! times at which any of them needs a key:
//! - `LINEAR` translations and rotations need their own keys: a [`Motion`] interpolates as they do. Linear scales are cut
//!   where they grow, into steps of at most [`SCALE_STEP`], as a [`Motion`] interpolates logarithms.
//! - `STEP` needs, before each key, another one that is earlier by the least step of an f64: exact.
//! - `CUBICSPLINE` is cut into pieces of [`PIECE_SECS`], at most [`MOST_PIECES`] between two keys, straight in between.

use super::Buffers;
use super::accessor::{WholeNumbers, numbers};
use crate::{Motion, Pose, SceneError};
use ::gltf::accessor::Dimensions;
use ::gltf::animation::{Interpolation, Property, Sampler};
use glam::{DMat3, DMat4, DQuat, DVec3, DVec4};

/// Longest piece of a cubic spline that is replaced by its chord: a quarter of a frame at 60 frames per second.
const PIECE_SECS: f64 = 1.0 / 240.0;

/// Most pieces between two keys of a spline. Easing from 0 to 1 then errs by at most `6 / (8 · 64²)` = 2e-4.
const MOST_PIECES: usize = 64;

/// Largest difference of the logarithms of scale from key to key: interpolating them errs by at most `0.02² / 8` = 5e-5.
const SCALE_STEP: f64 = 0.02;

/// How much lengths and angles of a node's axes may differ, relatively, from a uniform scale: rounding, not intent.
const UNIFORM_TOLERANCE: f64 = 1e-3;

/// A value over time.
#[derive(Debug, Clone)]
struct Track {
    times: Vec<f64>,
    /// One per time; of splines three: the tangent toward it, itself, the tangent away from it.
    values: Vec<DVec4>,
    interpolation: Interpolation,
    property: Property,
}

/// The weight of a morph target over time: keys, between which it is linear.
pub(super) type Weights = Vec<(f64, f32)>;

/// The weights of the `count` morph targets of a mesh, as a channel moves them.
pub(super) fn weights(sampler: &Sampler<'_>, buffers: &Buffers, count: usize) -> Result<Vec<Weights>, SceneError> {
    let output = numbers::<1>(&sampler.output(), buffers, Dimensions::Scalar, WholeNumbers::Fraction)?;
    (0..count)
        .map(|target| {
            let values = output.iter().skip(target).step_by(count).map(|[weight]| DVec4::splat(*weight)).collect();
            let track = Track::new(Property::MorphTargetWeights, sampler, buffers, values)?;
            let mut times = track.times_of_keys();
            times.dedup();
            Ok(times.into_iter().map(|time| (time, track.at(time).x as f32)).collect())
        })
        .collect()
}

/// How an animation moves a node; what it doesn't move stays as the node says.
#[derive(Debug, Clone, Default)]
pub(super) struct Tracks {
    translation: Option<Track>,
    rotation: Option<Track>,
    scale: Option<Track>,
}

impl Tracks {
    /// Adds a channel that moves translation, rotation or scale.
    pub(super) fn add(
        &mut self,
        property: Property,
        sampler: &Sampler<'_>,
        buffers: &Buffers,
    ) -> Result<(), SceneError> {
        let track = Track::read(property, sampler, buffers)?;
        let (slot, name) = match property {
            Property::Translation => (&mut self.translation, "translation"),
            Property::Rotation => (&mut self.rotation, "rotation"),
            _ => (&mut self.scale, "scale"),
        };
        match slot.replace(track) {
            Some(_) => Err(SceneError::new(format!("two channels move its {name}"))),
            None => Ok(()),
        }
    }

    /// Keyframes of a node whose translation, rotation and scale are otherwise these.
    pub(super) fn motion(&self, (translation, rotation, scale): (DVec3, DQuat, DVec3)) -> Result<Motion, SceneError> {
        let tracks = [&self.translation, &self.rotation, &self.scale];
        let mut times: Vec<f64> = tracks.into_iter().flatten().flat_map(Track::times_of_keys).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        let mut keys: Vec<(f64, Pose)> = Vec::with_capacity(times.len());
        for time in times {
            let at = |track: &Option<Track>| track.as_ref().map(|track| track.at(time));
            let local = DMat4::from_scale_rotation_translation(
                at(&self.scale).map_or(scale, DVec4::truncate),
                at(&self.rotation).map_or(rotation, DQuat::from_vec4).normalize(),
                at(&self.translation).map_or(translation, DVec4::truncate),
            );
            let mut pose = pose_of(&local)
                .map_err(|error| SceneError { problem: format!("at {time} s {}", error.problem), ..error })?;
            // The same rotation by the quaternion that lies on the side of the one before: the shorter way.
            if keys.last().is_some_and(|(_, previous)| previous.rotation.dot(pose.rotation) < 0.0) {
                pose.rotation = -pose.rotation;
            }
            keys.push((time, pose));
        }
        Ok(Motion::Keyframes(keys))
    }
}

impl Track {
    fn read(property: Property, sampler: &Sampler<'_>, buffers: &Buffers) -> Result<Self, SceneError> {
        let output = sampler.output();
        let values: Vec<DVec4> = if property == Property::Rotation {
            numbers::<4>(&output, buffers, Dimensions::Vec4, WholeNumbers::Fraction)?
                .into_iter()
                .map(DVec4::from)
                .collect()
        } else {
            let places = numbers::<3>(&output, buffers, Dimensions::Vec3, WholeNumbers::Refused)?;
            places.into_iter().map(|place| DVec3::from(place).extend(0.0)).collect()
        };
        Self::new(property, sampler, buffers, values)
    }

    /// A track of these values at the times of a sampler.
    fn new(
        property: Property,
        sampler: &Sampler<'_>,
        buffers: &Buffers,
        values: Vec<DVec4>,
    ) -> Result<Self, SceneError> {
        let times = numbers::<1>(&sampler.input(), buffers, Dimensions::Scalar, WholeNumbers::Refused)?;
        let times: Vec<f64> = times.into_iter().map(|[time]| time).collect();
        let interpolation = sampler.interpolation();
        let per_key = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        if times.is_empty() {
            return Err(SceneError::new("a channel has no keys"));
        }
        if values.len() != per_key * times.len() {
            let (found, count) = (values.len(), times.len());
            let problem = format!(
                "a channel has {found} values for {count} times, where {interpolation:?} has {per_key} per time"
            );
            return Err(SceneError::new(problem));
        }
        if let Some(later) = times.windows(2).position(|pair| pair[0] >= pair[1]) {
            return Err(SceneError::new(format!("key {} of a channel is not later than the one before", later + 1)));
        }
        let track = Self { times, values, interpolation, property };
        if property == Property::Rotation && (0..track.times.len()).any(|key| track.value(key).length_squared() < 1e-12)
        {
            return Err(SceneError::new("a rotation is the zero quaternion"));
        }
        Ok(track)
    }

    fn value(&self, key: usize) -> DVec4 {
        if self.interpolation == Interpolation::CubicSpline { self.values[3 * key + 1] } else { self.values[key] }
    }

    /// Times at which a [`Motion`] needs a key to follow this track.
    fn times_of_keys(&self) -> Vec<f64> {
        let mut times = vec![self.times[0]];
        for (key, pair) in self.times.windows(2).enumerate() {
            let span = pair[1] - pair[0];
            let pieces = match self.interpolation {
                Interpolation::Step => {
                    times.push(pair[1].next_down());
                    1
                }
                Interpolation::Linear if self.property == Property::Scale => {
                    let growth = (self.value(key + 1).x / self.value(key).x).abs().ln() / SCALE_STEP;
                    // From or to nothing there is no number of steps, and no pose.
                    if growth.is_finite() { (growth.abs().ceil() as usize).clamp(1, 256) } else { 1 }
                }
                Interpolation::Linear => 1,
                Interpolation::CubicSpline => ((span / PIECE_SECS).ceil() as usize).clamp(1, MOST_PIECES),
            };
            times.extend((1..pieces).map(|piece| pair[0] + span * piece as f64 / pieces as f64));
            times.push(pair[1]);
        }
        times
    }

    /// The value at a time; outside of the keys the nearest one's.
    fn at(&self, time: f64) -> DVec4 {
        let after = self.times.partition_point(|key| *key <= time);
        let Some(key) = after.checked_sub(1) else { return self.value(0) };
        if after == self.times.len() {
            return self.value(key);
        }
        let (a, b) = (self.value(key), self.value(after));
        let span = self.times[after] - self.times[key];
        let x = (time - self.times[key]) / span;
        match self.interpolation {
            Interpolation::Step => a,
            Interpolation::Linear if self.property == Property::Rotation => {
                let unit = |v: DVec4| DQuat::from_vec4(v.normalize());
                DVec4::from(unit(a).slerp(unit(b), x))
            }
            Interpolation::Linear => a.lerp(b, x),
            Interpolation::CubicSpline => {
                let (away, toward) = (self.values[3 * key + 2], self.values[3 * after]);
                let (x2, x3) = (x * x, x * x * x);
                (2.0 * x3 - 3.0 * x2 + 1.0) * a
                    + span * (x3 - 2.0 * x2 + x) * away
                    + (3.0 * x2 - 2.0 * x3) * b
                    + span * (x3 - x2) * toward
            }
        }
    }
}

/// The similarity that a matrix is, to within [`UNIFORM_TOLERANCE`].
pub(super) fn pose_of(matrix: &DMat4) -> Result<Pose, SceneError> {
    let axes = DMat3::from_mat4(*matrix);
    let lengths = DVec3::new(axes.x_axis.length(), axes.y_axis.length(), axes.z_axis.length());
    let (least, most) = (lengths.min_element(), lengths.max_element());
    if !matrix.is_finite() {
        return Err(SceneError::new("its transform is not finite"));
    }
    if least < f64::from(f32::MIN_POSITIVE) {
        return Err(SceneError::new("its scale is zero").with_remedy("give it a small scale instead"));
    }
    let remedy = "apply scales in the program that wrote the file";
    if most - least > UNIFORM_TOLERANCE * most {
        let [x, y, z] = lengths.to_array();
        let problem = format!("its scale is not uniform: {x:.4}, {y:.4}, {z:.4}");
        return Err(SceneError::new(problem).with_remedy(remedy));
    }
    if axes.determinant() < 0.0 {
        return Err(SceneError::new("its scale is negative, which mirrors").with_remedy(remedy));
    }
    let [x, y, z] = [axes.x_axis / lengths.x, axes.y_axis / lengths.y, axes.z_axis / lengths.z];
    if [x.dot(y), y.dot(z), z.dot(x)].iter().any(|cosine| cosine.abs() > UNIFORM_TOLERANCE) {
        return Err(SceneError::new("its transform shears").with_remedy(remedy));
    }
    let pose = Pose {
        scale: (lengths.x * lengths.y * lengths.z).cbrt() as f32,
        rotation: DQuat::from_mat3(&DMat3::from_cols(x, y, z)).normalize().as_quat().normalize(),
        translation: matrix.w_axis.truncate().as_vec3(),
    };
    if pose.scale.is_finite() && pose.translation.is_finite() && pose.rotation.is_finite() {
        Ok(pose)
    } else {
        Err(SceneError::new("its transform is too large to compute with"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(interpolation: Interpolation, property: Property, values: &[f64]) -> Track {
        Track {
            times: vec![1.0, 3.0],
            values: values.iter().map(|x| DVec4::splat(*x)).collect(),
            interpolation,
            property,
        }
    }

    #[test]
    fn a_spline_is_its_cubic_and_keys_cut_it_finely() {
        // t³ between 1 and 3: its tangents are 3 t².
        let cubic = track(Interpolation::CubicSpline, Property::Translation, &[0.0, 1.0, 3.0, 27.0, 27.0, 0.0]);
        for time in [1.0_f64, 1.4, 2.0, 2.9, 3.0] {
            assert!((cubic.at(time).x - time.powi(3)).abs() < 1e-12);
        }
        assert_eq!((cubic.at(0.0).x, cubic.at(9.0).x), (1.0, 27.0));
        assert_eq!(cubic.times_of_keys().len(), 1 + MOST_PIECES);
    }

    #[test]
    fn keys_are_where_a_motion_needs_them() {
        let linear = track(Interpolation::Linear, Property::Translation, &[0.0, 1.0]);
        assert_eq!((linear.times_of_keys(), linear.at(1.5).x), (vec![1.0, 3.0], 0.25));
        let step = track(Interpolation::Step, Property::Translation, &[0.0, 1.0]);
        assert_eq!(step.times_of_keys(), [1.0, 3.0_f64.next_down(), 3.0]);
        assert_eq!([1.0, 2.9, 3.0].map(|time| step.at(time).x), [0.0, 0.0, 1.0]);
        let scale = track(Interpolation::Linear, Property::Scale, &[1.0, 2.0]);
        assert_eq!(scale.times_of_keys().len(), 1 + (2.0_f64.ln() / SCALE_STEP).ceil() as usize);
        assert_eq!(track(Interpolation::Linear, Property::Scale, &[0.0, 2.0]).times_of_keys().len(), 2);
    }

    #[test]
    fn two_mirrors_are_a_turn_one_is_refused_and_so_is_shear() {
        let scaled = |scale| pose_of(&DMat4::from_scale(DVec3::from_array(scale)));
        let turned = scaled([-2.0, -2.0, 2.0]).unwrap();
        assert!(turned.transform_point(glam::Vec3::X).distance(-2.0 * glam::Vec3::X) < 1e-6);
        assert!(scaled([-2.0, 2.0, 2.0]).unwrap_err().problem.contains("mirrors"));
        assert!(scaled([2.0, 2.0, 2.01]).unwrap_err().problem.contains("not uniform"));
        assert!(scaled([2.0, 2.0, 2.001]).is_ok());
        let mut sheared = DMat4::IDENTITY;
        sheared.y_axis = DVec4::new(0.6, 0.8, 0.0, 0.0);
        assert!(pose_of(&sheared).unwrap_err().problem.contains("shears"));
        assert!(pose_of(&DMat4::from_translation(DVec3::splat(1e300))).unwrap_err().problem.contains("too large"));
    }
}
