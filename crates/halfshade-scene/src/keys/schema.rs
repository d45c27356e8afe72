//! The JSON Schema of a type, as it is for TOML.

use schemars::{JsonSchema, Schema, generate::SchemaSettings, transform::transform_subschemas};
use serde_json::{Value, json};

/// The JSON Schema (draft 7, which editors know) of files that hold a `T`: self-contained, and without null, of which TOML has none.
pub fn schema<T: JsonSchema>() -> Value {
    let settings = SchemaSettings::draft07().for_deserialize().with(|settings| settings.inline_subschemas = true);
    let mut schema = settings.with_transform(for_toml).into_generator().into_root_schema_for::<T>();
    schema.remove("title");
    schema.to_value()
}

/// Takes null away, and names of Rust's types for numbers; what they bound is kept.
fn for_toml(schema: &mut Schema) {
    transform_subschemas(&mut for_toml, schema);
    let null = json!("null");
    if schema.get("default").is_some_and(Value::is_null) {
        schema.remove("default");
    }
    if let Some(Value::Array(types)) = schema.get_mut("type") {
        types.retain(|kind| *kind != null);
        if let [only] = &types[..] {
            let only = only.clone();
            schema.insert("type".into(), only);
        }
    }
    if let Some(Value::Array(choices)) = schema.get_mut("enum") {
        choices.retain(|choice| !choice.is_null());
    }
    if let Some(Value::Array(choices)) = schema.get_mut("anyOf") {
        choices.retain(|choice| choice["type"] != null);
        if choices.len() == 1
            && let Value::Object(only) = choices.remove(0)
        {
            schema.remove("anyOf");
            // The key's own words count more than those of its type.
            only.into_iter().for_each(|(key, value)| {
                if schema.get(&key).is_none() {
                    schema.insert(key, value);
                }
            });
        }
    }
    if let Some(format) = schema.remove("format")
        && format == "uint32"
        && schema.get("maximum").is_none()
    {
        schema.insert("maximum".into(), u32::MAX.into());
    }
}
