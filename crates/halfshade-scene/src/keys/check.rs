//! A file's values, held to its schema.

use super::words::{bounds, choices, expected, range};
use crate::text::unknown;
use serde_json::{Map, Value};
use std::ops::Range;
use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

/// Something that the schema doesn't allow.
pub(super) struct Mistake {
    /// Its place in the file.
    pub(super) span: Range<usize>,
    /// The fault, in words of the file.
    pub(super) problem: String,
}

/// The first mistake in the file, if there is one.
pub(super) fn first_mistake(schema: &Value, document: &Spanned<DeTable<'_>>) -> Option<Mistake> {
    let mut found = Vec::new();
    check_table(schema, "the file", document.span(), document.get_ref(), &mut found);
    found.into_iter().min_by_key(|mistake| mistake.span.start)
}

/// Checks every key of a table, which errors call `name`.
fn check_table(schema: &Value, name: &str, span: Range<usize>, table: &DeTable<'_>, found: &mut Vec<Mistake>) {
    // A table of any keys may name none.
    let none = Map::new();
    let properties = schema["properties"].as_object().unwrap_or(&none);
    let mut has_unknown = false;
    for (key, value) in table {
        match (properties.get(key.get_ref().as_ref()), &schema["additionalProperties"]) {
            (Some(schema), _) => check(schema, key.get_ref(), value, found),
            (None, Value::Bool(false)) => {
                let problem = unknown("key", key.get_ref(), properties.keys().map(String::as_str));
                found.push(Mistake { span: key.span(), problem });
                has_unknown = true;
            }
            (None, others) => check(others, key.get_ref(), value, found),
        }
    }
    // A missing key may be the one that is misspelled.
    let needed = schema["required"].as_array().filter(|_| !has_unknown).into_iter().flatten().filter_map(Value::as_str);
    found.extend(needed.filter(|key| !table.contains_key(*key)).map(|key| {
        let summary = properties[key]["description"].as_str().map(first_sentence);
        let problem = format!("{name} needs the key `{key}`{}", summary.map_or(String::new(), |it| format!(" ({it})")));
        Mistake { span: span.clone(), problem }
    }));
}

/// Checks the value of `key`.
fn check(schema: &Value, key: &str, value: &Spanned<DeValue<'_>>, found: &mut Vec<Mistake>) {
    let mut add = |problem: String| found.push(Mistake { span: value.span(), problem });
    let mismatch = || format!("`{key}` must be {}, not {}", expected(schema), told(value.get_ref()));
    if let Some(alternatives) = schema["anyOf"].as_array() {
        let fits = |schema: &Value| {
            let mut found = Vec::new();
            check(schema, key, value, &mut found);
            found.is_empty()
        };
        if !alternatives.iter().any(fits) {
            add(mismatch());
        }
        return;
    }
    match (value.get_ref(), schema["type"].as_str()) {
        (DeValue::String(word), _) if choices(schema).is_some_and(|words| !words.contains(&word.as_ref())) => {
            add(unknown(key, word, choices(schema).unwrap_or_default()));
        }
        (DeValue::String(_), _) if choices(schema).is_some() => {}
        (DeValue::String(_), Some("string")) | (DeValue::Boolean(_), Some("boolean")) => {}
        (number @ DeValue::Integer(_), Some("integer" | "number")) | (number @ DeValue::Float(_), Some("number")) => {
            if !is_within(schema, number) {
                add(format!("`{key}` = {} must be {}", told(number), range(schema)));
            }
        }
        (DeValue::Table(table), Some("object")) => {
            check_table(schema, &format!("`{key}`"), value.span(), table, found);
        }
        (DeValue::Array(list), Some("array")) => {
            let count = list.len() as u64;
            let is_short = schema["minItems"].as_u64().is_some_and(|least| count < least);
            if is_short || schema["maxItems"].as_u64().is_some_and(|most| count > most) {
                return add(mismatch());
            }
            list.iter().for_each(|item| check(&schema["items"], key, item, found));
        }
        (_, None) if choices(schema).is_none() => {}
        _ => add(mismatch()),
    }
}

/// Whether a number lies within its bounds; NaN doesn't, where there are any.
fn is_within(schema: &Value, number: &DeValue<'_>) -> bool {
    let number: Option<f64> = match number {
        DeValue::Integer(number) => i64::from_str_radix(number.as_str(), number.radix()).ok().map(|it| it as f64),
        DeValue::Float(number) => number.as_str().parse().ok(),
        _ => None,
    };
    let [min, max] = bounds(schema).map(|bound| bound.and_then(Value::as_f64));
    let is_bounded = min.is_some() || max.is_some();
    let fits = |number: f64| min.is_none_or(|min| number >= min) && max.is_none_or(|max| number <= max);
    !is_bounded || number.is_some_and(fits)
}

/// A value as it is named in an error.
fn told(value: &DeValue<'_>) -> String {
    /// More letters of a text only hide what is wrong.
    const SHOWN_LETTERS: usize = 40;
    match value {
        DeValue::String(text) if text.chars().count() > SHOWN_LETTERS => "this text".into(),
        DeValue::String(text) => format!("the text {text:?}"),
        DeValue::Integer(number) => number.to_string(),
        DeValue::Float(number) => number.to_string(),
        DeValue::Boolean(value) => value.to_string(),
        DeValue::Datetime(date) => format!("the date {date}"),
        DeValue::Array(list) => format!("a list of {}", list.len()),
        DeValue::Table(_) => "a table".into(),
    }
}

/// The first sentence of a key's docs, without its full stop.
fn first_sentence(text: &str) -> String {
    let text = text.replace('\n', " ");
    text.split(". ").next().unwrap_or_default().trim_end_matches('.').to_owned()
}
