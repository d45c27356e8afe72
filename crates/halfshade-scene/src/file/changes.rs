//! Values put into a scene file before it is read: what a sweep changes.

use crate::SceneError;
use toml_edit::{DocumentMut, Item, Value};

/// A value at a dotted path of a scene file: keys, and where they name a list, an entry by its number from 1 on or by its `name`.
/// `light.1.radiance`, `object.bunny.albedo`, `environment.sky.turbidity`.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// The path.
    pub path: String,
    /// The value, as TOML.
    pub value: String,
}

/// `text` with `changes`; lines stay where they are, unless a key is new.
pub(super) fn changed(text: &str, changes: &[Change]) -> Result<String, SceneError> {
    let mut document: DocumentMut =
        text.parse().map_err(|error: toml_edit::TomlError| SceneError::new(error.message()))?;
    for Change { path, value } in changes {
        let parsed: Value = value.parse().map_err(|_| SceneError::new(format!("`{path}`: {value} is no value")))?;
        let mut item = document.as_item_mut();
        for key in path.split('.') {
            item = entry(item, key).map_err(|problem| SceneError::new(format!("`{path}`: {problem}")))?;
        }
        *item = Item::Value(parsed);
    }
    Ok(document.to_string())
}

/// What `key` names in `item`; a new key of a table is none yet.
fn entry<'a>(item: &'a mut Item, key: &str) -> Result<&'a mut Item, String> {
    if key.is_empty() {
        return Err("a key is empty".into());
    }
    if item.is_none() {
        *item = Item::Value(Value::InlineTable(Default::default()));
    }
    let Some(count) = length(item) else {
        let no_keys = || format!("`{key}` is asked of a value that has no keys");
        return Ok(item.as_table_like_mut().ok_or_else(no_keys)?.entry(key).or_insert(Item::None));
    };
    let place = key.parse::<usize>().ok().and_then(|number| number.checked_sub(1)).or_else(|| named(item, key, count));
    let place = place.filter(|&place| place < count);
    let place = place.ok_or_else(|| {
        format!("there is no entry `{key}` in a list of {count}: name one by its number from 1 on or its `name`")
    })?;
    item.get_mut(place).ok_or_else(|| format!("there is no entry `{key}`"))
}

/// Entries of a list; `None` of anything else.
fn length(item: &Item) -> Option<usize> {
    item.as_array().map(|array| array.len()).or_else(|| item.as_array_of_tables().map(|tables| tables.len()))
}

/// Place of the entry that has this `name`.
fn named(item: &Item, name: &str, count: usize) -> Option<usize> {
    (0..count).find(|&place| item.get(place).and_then(|entry| entry.get("name")).and_then(Item::as_str) == Some(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "bounces = 0 # direct\n[[object]]\nshape = \"sphere\"\nname = \"ball\"\n[[object]]\nshape = \"plane\"\n\
                        [environment]\nsky = { turbidity = 3 }\n";

    fn put(path: &str, value: &str) -> Result<String, String> {
        let change = Change { path: path.into(), value: value.into() };
        changed(TEXT, &[change]).map_err(|error| error.to_string())
    }

    #[test]
    fn values_are_put_where_paths_lead_and_all_else_stays() {
        for (path, value, before, after) in [
            ("bounces", "2", "bounces = 0 # direct", "bounces = 2"),
            ("object.ball.shape", "\"box\"", "\"sphere\"", "\"box\""),
            ("object.2.shape", "\"box\"", "\"plane\"", "\"box\""),
            ("environment.sky.turbidity", "7.5", "turbidity = 3 ", "turbidity = 7.5"),
        ] {
            let parsed = |text: &str| text.parse::<toml::Table>().unwrap();
            assert_eq!(parsed(&put(path, value).unwrap()), parsed(&TEXT.replace(before, after)), "{path}");
        }
        let new = put("object.ball.albedo", "[0.5, 0.5, 0.5]").unwrap();
        assert_eq!(new.parse::<toml::Table>().unwrap()["object"][0]["albedo"][2].as_float(), Some(0.5));
        let new = put("camera.resolution", "[8, 4]").unwrap();
        assert_eq!(new.parse::<toml::Table>().unwrap()["camera"]["resolution"][1].as_integer(), Some(4));
    }

    #[test]
    fn paths_that_lead_nowhere_are_told() {
        for (path, what) in [
            ("object.3.albedo", "no entry `3` in a list of 2"),
            ("object.0.albedo", "no entry `0`"),
            ("object.cube.albedo", "no entry `cube`"),
            ("bounces.deep", "a value that has no keys"),
            ("object..albedo", "a key is empty"),
        ] {
            let error = put(path, "1").unwrap_err();
            assert!(error.contains(what) && error.contains(path), "{error}");
        }
        assert!(put("bounces", "= 1").unwrap_err().contains("is no value"));
    }
}
