//! `halfshade list`: what there is.

use super::context::Context;
use crate::{
    cli::{ListArguments, ListChoice},
    failure::Failure,
    terminal,
};
use halfshade_scene::builtin::SCENES;
use halfshade_strategy::{Info, ParameterKind, Preset};
use serde_json::{Value, json};
use std::process::ExitCode;

pub(super) fn list(context: &Context, arguments: &ListArguments) -> Result<ExitCode, Failure> {
    let infos: Vec<Info> = context.strategies.iter().map(|strategy| strategy.info()).collect();
    let text = match (arguments.what, arguments.json) {
        (ListChoice::Strategies, true) => format!("{:#}\n", json!(infos.iter().map(as_json).collect::<Vec<_>>())),
        (ListChoice::Strategies, false) => infos.iter().map(as_text).collect::<Vec<_>>().join("\n"),
        (ListChoice::Scenes, true) => {
            let scenes: Vec<Value> =
                SCENES.iter().map(|(name, summary)| json!({ "name": name, "summary": summary })).collect();
            format!("{:#}\n", json!(scenes))
        }
        (ListChoice::Scenes, false) => {
            SCENES.iter().map(|(name, summary)| format!("{name}\n    {summary}\n")).collect()
        }
    };
    terminal::data(&text)?;
    Ok(ExitCode::SUCCESS)
}

fn as_text(info: &Info) -> String {
    let mut text = format!("{}\n    {} {}\n    models: {}\n", info.name, info.summary, info.source, info.effects);
    for parameter in &info.parameters {
        text += &format!(
            "    {} = {}  [{}]  {}\n",
            parameter.name,
            parameter.kind.default(),
            parameter.kind.range(),
            parameter.summary
        );
        if let ParameterKind::Choice { words, .. } = parameter.kind {
            for word in words {
                text += &format!("        {}: {}\n", word.name, word.summary);
            }
        }
    }
    for preset in info.presets {
        text += &format!("    {}  [preset: {}]  {}\n", preset.name, preset.settings, preset.summary);
    }
    text
}

fn preset_as_json(preset: &Preset) -> Value {
    json!({ "name": preset.name, "summary": preset.summary, "settings": preset.settings })
}

fn as_json(info: &Info) -> Value {
    let parameters: Vec<Value> = info
        .parameters
        .iter()
        .map(|parameter| {
            let (kind, range) = match parameter.kind {
                ParameterKind::Choice { words, .. } => {
                    let values: Vec<&str> = words.iter().map(|word| word.name).collect();
                    let summaries: Vec<&str> = words.iter().map(|word| word.summary).collect();
                    ("choice", json!({ "values": values, "summaries": summaries }))
                }
                ParameterKind::Integer { min, max, .. } => ("integer", json!({ "min": min, "max": max })),
                ParameterKind::Float { min, max, .. } => ("float", json!({ "min": min, "max": max })),
            };
            json!({
                "name": parameter.name,
                "summary": parameter.summary,
                "type": kind,
                "default": parameter.kind.default(),
                "range": range,
            })
        })
        .collect();
    json!({
        "name": info.name,
        "summary": info.summary,
        "source": info.source,
        "effects": info.effects.iter().map(|effect| effect.name()).collect::<Vec<_>>(),
        "parameters": parameters,
        "presets": info.presets.iter().map(preset_as_json).collect::<Vec<_>>(),
    })
}
