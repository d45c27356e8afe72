//! The values that a schema asks for, in words of people who write files.

use serde_json::Value;

/// The words that a value may be; `None` if it is no choice between words.
pub(super) fn choices(schema: &Value) -> Option<Vec<&str>> {
    if let Some(words) = schema["enum"].as_array() {
        return words.iter().map(Value::as_str).collect();
    }
    let described = schema["oneOf"].as_array()?;
    described.iter().map(|choice| choice["const"].as_str()).collect()
}

/// Smallest and largest number that is allowed, as far as they are bounded.
pub(super) fn bounds(schema: &Value) -> [Option<&Value>; 2] {
    [schema.get("minimum"), schema.get("maximum")]
}

/// `from 1 to 3`, `at least 1`, `at most 3`; nothing where a number is not bounded.
pub(super) fn range(schema: &Value) -> String {
    match bounds(schema) {
        [Some(min), Some(max)] => format!("from {min} to {max}"),
        [Some(min), None] => format!("at least {min}"),
        [None, Some(max)] => format!("at most {max}"),
        [None, None] => String::new(),
    }
}

/// The value that is expected, with its article: `a list of 3 numbers`.
pub(super) fn expected(schema: &Value) -> String {
    if let Some(words) = choices(schema) {
        return either(words.iter().map(|word| format!("\"{word}\"")).collect());
    }
    if let Some(alternatives) = schema["anyOf"].as_array() {
        return either(alternatives.iter().map(expected).collect());
    }
    match schema["type"].as_str() {
        Some("string") => "a text in quotes".into(),
        Some("integer") => "a whole number".into(),
        Some("number") => "a number".into(),
        Some("boolean") => "true or false".into(),
        Some("object") => "a table".into(),
        Some("array") => {
            let items = many(&schema["items"]);
            match (schema["minItems"].as_u64(), schema["maxItems"].as_u64()) {
                (Some(min), Some(max)) if min == max => format!("a list of {max} {items}"),
                _ => format!("a list of {items}"),
            }
        }
        _ => "a value".into(),
    }
}

/// `a`, `a or b`, `a, b or c`.
fn either(mut choices: Vec<String>) -> String {
    let last = choices.pop().unwrap_or_default();
    if choices.is_empty() { last } else { format!("{} or {last}", choices.join(", ")) }
}

/// The values that are expected, several of a kind.
fn many(schema: &Value) -> String {
    if choices(schema).is_some() || schema.get("anyOf").is_some() {
        return format!("any of {}", expected(schema));
    }
    let plural = match schema["type"].as_str() {
        Some("string") => "texts in quotes",
        Some("integer") => "whole numbers",
        Some("number") => "numbers",
        Some("object") => "tables",
        Some("array") => return format!("lists, each {}", expected(schema)),
        _ => "values",
    };
    plural.into()
}
