//! Values of an experiment file that must fit, each with an error that says what is expected.

use crate::{file_names::is_folder_name, threads::MAX_THREADS};
use halfshade_scene::camera::check_resolution;
use halfshade_truth::MAX_SAMPLES;
use serde::{Deserialize, Deserializer, de::Error as _};
use std::num::{NonZeroU32, NonZeroUsize};
use toml::Spanned;

/// Most rounds that are timed, or thrown away before.
const MAX_ROUNDS: u32 = 10_000;

/// The smallest noise that can be asked for: less is beyond what radiance in 32 bits resolves.
const MIN_NOISE: f64 = 1e-6;

/// A value that `fits`, or an error that says what is expected; at the line where it stands.
fn fitting<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
    expected: &str,
    fits: impl FnOnce(&T) -> bool,
) -> Result<T, D::Error> {
    T::deserialize(deserializer).ok().filter(fits).ok_or_else(|| D::Error::custom(expected))
}

/// A list that names something, and nothing twice: every row would be there twice.
pub(super) fn distinct<'de, D: Deserializer<'de>, T: Deserialize<'de> + PartialEq>(
    deserializer: D,
) -> Result<Vec<T>, D::Error> {
    let list = Vec::deserialize(deserializer)?;
    if list.is_empty() {
        return Err(D::Error::custom("the list is empty: name at least one, or leave it out"));
    }
    match (0..list.len()).find(|&place| list[..place].contains(&list[place])) {
        None => Ok(list),
        Some(place) => {
            let problem = format!("entry {} of the list is there already; name each once", place + 1);
            Err(D::Error::custom(problem))
        }
    }
}

pub(super) fn some_distinct<'de, D: Deserializer<'de>, T: Deserialize<'de> + PartialEq>(
    deserializer: D,
) -> Result<Option<Vec<T>>, D::Error> {
    distinct(deserializer).map(Some)
}

pub(super) fn folder_name<'de, D: Deserializer<'de>>(deserializer: D) -> Result<String, D::Error> {
    let expected = "`name` becomes a folder: use up to 80 letters, digits, `-`, `_`, `.`, the first and the last no dot, \
                    and no name that Windows reserves";
    fitting(deserializer, expected, |name: &String| is_folder_name(name))
}

pub(super) fn sphere_count<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<NonZeroUsize>, D::Error> {
    /// Bound for all objects together; a single object has its own.
    const MOST: usize = 100_000;
    let fits = |count: &NonZeroUsize| count.get() <= MOST;
    fitting(deserializer, &format!("expected a whole number of spheres from 1 to {MOST}"), fits).map(Some)
}

pub(super) fn sample_count<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<NonZeroU32>, D::Error> {
    let fits = |count: &NonZeroU32| count.get() as usize <= MAX_SAMPLES;
    fitting(deserializer, &format!("expected a whole number of samples from 1 to {MAX_SAMPLES}"), fits).map(Some)
}

pub(super) fn noise<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    let expected = format!("`relative_noise` must be positive: from {MIN_NOISE} to 1");
    fitting(deserializer, &expected, |noise| (MIN_NOISE..=1.0).contains(noise)).map(Some)
}

pub(super) fn round_count<'de, D: Deserializer<'de>, T: Deserialize<'de> + Copy + Into<u32>>(
    deserializer: D,
) -> Result<T, D::Error> {
    let fits = |count: &T| (*count).into() <= MAX_ROUNDS;
    let expected = format!("expected a whole number of rounds, at most {MAX_ROUNDS}, and at least 1 that counts");
    fitting(deserializer, &expected, fits)
}

pub(super) fn thread_count<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<NonZeroUsize>, D::Error> {
    let fits = |count: &NonZeroUsize| count.get() <= MAX_THREADS;
    fitting(deserializer, &format!("expected a whole number of threads from 1 to {MAX_THREADS}"), fits).map(Some)
}

pub(super) fn picture_size<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<[u32; 2]>, D::Error> {
    let size: [u32; 2] = Deserialize::deserialize(deserializer)?;
    check_resolution(size).map_err(D::Error::custom)?;
    Ok(Some(size))
}

/// Keys with the values that each takes.
pub type Sweep = Vec<(String, Spanned<Vec<toml::Value>>)>;

/// Reads a table of lists.
pub(super) fn lists<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Sweep, D::Error> {
    struct Lists;

    impl<'de> serde::de::Visitor<'de> for Lists {
        type Value = Sweep;

        fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            f.write_str(
                "lists of values, such as { spheres = [10, 20], \"light.1.radiance\" = [[1, 1, 1], [5, 5, 5]] }",
            )
        }

        fn visit_map<A: serde::de::MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
            let mut lists = Vec::new();
            while let Some(entry) = map.next_entry()? {
                lists.push(entry);
            }
            Ok(lists)
        }
    }

    deserializer.deserialize_map(Lists)
}
