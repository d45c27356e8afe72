//! The keys of a file as tables in Markdown: one for each table of the file.

use super::words::{choices, expected, range};
use serde_json::Value;

/// Every key that `schema` knows: what it may be, what it means, its default.
pub fn reference(schema: &Value) -> String {
    let mut sections = Vec::new();
    collect("", "At the top of the file", schema, &mut sections);
    sections.join("\n")
}

/// Adds the table of `schema`, which lies at the dotted `path`, and those of all below it.
fn collect(path: &str, heading: &str, schema: &Value, sections: &mut Vec<String>) {
    let Some(properties) = schema["properties"].as_object() else { return };
    let needed = |key: &str| schema["required"].as_array().is_some_and(|needed| needed.iter().any(|it| it == key));
    let mut text = format!("**{heading}**");
    if let Some(description) = schema["description"].as_str().filter(|_| !path.is_empty()) {
        text += &format!(": {}", lower_first(&one_line(description)));
    }
    text += "\n\n| key | value | meaning |\n| --- | --- | --- |\n";
    for (key, property) in properties {
        text += &row(key, property, needed(key));
    }
    if schema["additionalProperties"].is_object() {
        text += &row("..", &schema["additionalProperties"], false);
    }
    sections.push(text);
    for (key, property) in properties {
        let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
        collect(&path, &format!("`[{path}]`"), property, sections);
        collect(&path, &format!("`[[{path}]]`"), &property["items"], sections);
    }
}

fn row(key: &str, property: &Value, is_needed: bool) -> String {
    let mut meaning = one_line(property["description"].as_str().unwrap_or_default());
    // A list has the words of its items.
    for choice in [property, &property["items"]].into_iter().flat_map(|it| it["oneOf"].as_array().into_iter().flatten())
    {
        let (word, summary) = (choice["const"].as_str(), choice["description"].as_str());
        if let (Some(word), Some(summary)) = (word, summary) {
            meaning += &format!(" `{word}`: {}", lower_first(&one_line(summary)));
        }
    }
    if is_needed {
        meaning += " **Needed.**";
    }
    if let Some(default) = property.get("default") {
        meaning += &format!(" Default: `{default}`.");
    }
    let value = match choices(property) {
        Some(_) => expected(property),
        None => format!("{} {}", expected(property), range(property)),
    };
    format!("| `{key}` | {} | {} |\n", value.trim().replace('|', "\\|"), meaning.trim().replace('|', "\\|"))
}

fn one_line(text: &str) -> String {
    text.replace('\n', " ")
}

fn lower_first(text: &str) -> String {
    let mut characters = text.chars();
    characters.next().map_or_else(String::new, |first| first.to_lowercase().chain(characters).collect())
}
