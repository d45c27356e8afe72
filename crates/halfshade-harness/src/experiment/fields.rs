//! Values of an experiment file that must fit, each with an error that says what is expected.

use crate::file_names::is_folder_name;
use halfshade_scene::camera::check_resolution;
use halfshade_scene::keys::Spanned;
use schemars::{Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, de::Error as _};

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
    let name = String::deserialize(deserializer)?;
    if is_folder_name(&name) { Ok(name) } else { Err(D::Error::custom(expected)) }
}

pub(super) fn picture_size<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<[u32; 2]>, D::Error> {
    let size: [u32; 2] = Deserialize::deserialize(deserializer)?;
    check_resolution(size).map_err(D::Error::custom)?;
    Ok(Some(size))
}

/// Keys with the values that each takes.
pub type Sweep = Vec<(String, Spanned<Vec<toml::Value>>)>;

/// Schema of a table of lists.
pub(super) fn schema_of_lists(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": "object", "additionalProperties": { "type": "array" } })
}

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
