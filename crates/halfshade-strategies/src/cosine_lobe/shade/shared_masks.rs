//! Masks shared between nearby receivers, which \[Meunier2009, 7\] leaves to the future.
//!
//! Space is divided into cubes. Receivers in one cube with nearly the same normal and at nearly the same height along it see the
//! light through the mask of one place: the cube's middle at that height, with that normal. The place depends on nothing
//! but these few whole numbers, so that which receivers are shaded together, and in what order, changes no bit. Where the
//! surface is flat that is one mask per cube, where it is curved several.
//!
//! From one side of a cube to the other, a blocker half way to the light moves before it by the cube's side, which `share`
//! gives in radii of the light: at `share = 2^(1-depth)` that is one of the mask's finest cells. Blockers near the receiver
//! move more, so that the shadow of a contact is where sharing errs. A light that is larger than the bounding
//! sphere of all blockers, like a lamp of the sun's size and distance, counts as that sphere's diameter.

use super::visibility::Hidden;
use crate::cosine_lobe::kernel::{cell_lobes::CellLobes, receiver::Receiver};
use glam::{IVec3, Vec3};

/// Normals are told apart by this part of their length along each axis.
const NORMAL_STEPS: f32 = 8.0;

/// Heights are told apart by this part of a cube's side.
const HEIGHT_STEPS: f32 = 8.0;

/// Masks kept, a power of 2: more than the cubes that a batch of receivers lies in.
const KEPT: usize = 256;

/// The cubes of one light.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cubes {
    side: f32,
}

/// Whose mask is shared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Key {
    light: usize,
    cube: IVec3,
    normal: IVec3,
    height: i32,
}

impl Cubes {
    /// `None` if they have no size, and nothing is shared.
    pub(crate) fn new(side: f32) -> Option<Self> {
        (side > 0.0 && side.is_finite()).then_some(Self { side })
    }

    /// A distance that no receiver is farther away from the place of its mask.
    pub(crate) fn reach(&self) -> f32 {
        2.0 * self.side
    }

    pub(crate) fn key(&self, receiver: &Receiver, light: usize) -> Key {
        let position = Vec3::from(receiver.position);
        let cube = (position / self.side).floor().as_ivec3();
        let normal = (Vec3::from(receiver.normal) * NORMAL_STEPS).round().as_ivec3();
        let height = (position - self.middle(cube)).dot(direction(normal));
        Key { light, cube, normal, height: (height * (HEIGHT_STEPS / self.side)).round() as i32 }
    }

    /// The place that sees the mask of a key.
    pub(crate) fn place(&self, key: &Key) -> Receiver {
        let normal = direction(key.normal);
        let height = key.height as f32 * (self.side / HEIGHT_STEPS);
        Receiver { position: (self.middle(key.cube) + height * normal).to_array(), normal: normal.to_array() }
    }

    fn middle(&self, cube: IVec3) -> Vec3 {
        (cube.as_vec3() + 0.5) * self.side
    }
}

fn direction(normal: IVec3) -> Vec3 {
    normal.as_vec3().normalize_or(Vec3::Y)
}

/// The occlusion of a light from one place.
#[derive(Debug, Clone)]
pub(crate) struct Entry {
    key: Option<Key>,
    pub(crate) hidden: Hidden,
    pub(crate) lobes: CellLobes,
}

/// Masks found lately; only one if none are shared.
#[derive(Debug)]
pub(crate) struct Masks(Vec<Entry>);

impl Masks {
    pub(crate) fn new(are_shared: bool) -> Self {
        let empty = Entry { key: None, hidden: Hidden::Nothing, lobes: CellLobes::default() };
        Self(vec![empty; if are_shared { KEPT } else { 1 }])
    }

    /// The slot for a key, and whether it holds its mask already. Without a key, it never does.
    pub(crate) fn slot(&mut self, key: Option<Key>) -> (usize, bool) {
        let slot = key.map_or(0, |key| key.hash()) % self.0.len();
        let known = &mut self.0[slot].key;
        let is_known = key.is_some() && *known == key;
        *known = key;
        (slot, is_known)
    }

    pub(crate) fn at(&self, slot: usize) -> &Entry {
        &self.0[slot]
    }

    pub(crate) fn at_mut(&mut self, slot: usize) -> &mut Entry {
        &mut self.0[slot]
    }
}

impl Key {
    fn hash(&self) -> usize {
        let numbers = [self.cube.x, self.cube.y, self.cube.z, self.normal.x, self.normal.y, self.normal.z, self.height];
        // Fowler, Noll and Vo's, by words; neighbouring cubes fall into different slots.
        let mixed = numbers.into_iter().fold(0xcbf2_9ce4_8422_2325 ^ self.light as u64, |hash, number| {
            (hash ^ u64::from(number as u32)).wrapping_mul(0x0000_0100_0000_01b3)
        });
        (mixed >> 20) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shared::test_scenes::random;

    #[test]
    fn a_place_is_near_its_receivers_and_on_their_surface() {
        let mut random = random(3);
        let cubes = Cubes::new(0.1).unwrap();
        let mut farthest = 0.0f32;
        for _ in 0..2_000 {
            let normal = Vec3::new(random(), random(), random()).normalize_or(Vec3::Y);
            let position = 5.0 * Vec3::new(random(), random(), random());
            let receiver = Receiver { position: position.to_array(), normal: normal.to_array() };
            let place = cubes.place(&cubes.key(&receiver, 0));
            let off = Vec3::from(place.position) - position;
            assert!(off.dot(normal).abs() < 0.025 && Vec3::from(place.normal).dot(normal) > 0.99, "{receiver:?}");
            farthest = farthest.max(off.length());
        }
        assert!(farthest < cubes.reach() && farthest > 0.05, "{farthest}");
    }

    /// A flat piece of floor has one place per cube.
    #[test]
    fn neighbours_share() {
        let cubes = Cubes::new(0.25).unwrap();
        let mut masks = Masks::new(true);
        let mut found = 0;
        for i in 0..32 * 32 {
            let position = [(i % 32) as f32 / 32.0, 0.37, (i / 32) as f32 / 32.0];
            let key = cubes.key(&Receiver { position, normal: [0.0, 1.0, 0.0] }, 0);
            found += usize::from(!masks.slot(Some(key)).1);
        }
        assert!((16..24).contains(&found), "{found}");
        assert!(!masks.slot(None).1 && !masks.slot(None).1);
        let mut alone = Masks::new(false);
        assert_eq!(alone.slot(None), (0, false));
    }

    #[test]
    fn ends_are_finite() {
        assert!(Cubes::new(0.0).is_none() && Cubes::new(f32::NAN).is_none() && Cubes::new(f32::INFINITY).is_none());
        for side in [f32::MIN_POSITIVE, 1e-6, 1.0, 1e30] {
            let cubes = Cubes::new(side).unwrap();
            for position in [[0.0; 3], [1e30, -1e30, 5.0], [f32::MAX; 3], [f32::NAN; 3]] {
                for normal in [[0.0; 3], [0.0, -1.0, 0.0], [f32::NAN; 3]] {
                    let key = cubes.key(&Receiver { position, normal }, 1);
                    let _ = Masks::new(true).slot(Some(key));
                    let _ = cubes.place(&key);
                }
            }
        }
    }
}
