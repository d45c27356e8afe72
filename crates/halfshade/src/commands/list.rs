//! `halfshade list`: what there is.

use super::context::Context;
use crate::{
    cli::{ListArguments, ListChoice},
    failure::Failure,
    terminal,
};
use halfshade_gpu::{
    AdapterFacts, devices,
    kernels::{KERNELS, Kernel, MISSING, Missing, Twin},
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
        (ListChoice::Devices, true) => {
            let devices: Vec<Value> = devices().iter().map(device_as_json).collect();
            format!("{:#}\n", json!(devices))
        }
        (ListChoice::Devices, false) => devices_as_text(&devices()),
        (ListChoice::Kernels, true) => format!("{:#}\n", kernels_as_json()),
        (ListChoice::Kernels, false) => kernels_as_text(),
    };
    terminal::data(&text)?;
    Ok(ExitCode::SUCCESS)
}

fn devices_as_text(devices: &[AdapterFacts]) -> String {
    if devices.is_empty() {
        return "no graphics devices; for one in software, `apt-get install mesa-vulkan-drivers libvulkan1`\n".into();
    }
    let line = |(number, device): (usize, &AdapterFacts)| {
        let kind = if device.is_software { ", in software" } else { "" };
        format!("{number}: {}\n    {}{kind}\n", device.name, device.driver)
    };
    devices.iter().enumerate().map(line).collect()
}

fn device_as_json(device: &AdapterFacts) -> Value {
    json!({ "name": device.name, "driver": device.driver, "software": device.is_software })
}

fn kernels_as_text() -> String {
    let mut text = String::new();
    for kernel in KERNELS {
        text += &format!("{}  shaders/{}\n", kernel.name, kernel.shader);
        for twin in kernel.twins {
            text +=
                &format!("    shaders/{} = {} within {:e}: {}\n", twin.shader, twin.cpu, twin.tolerance, twin.reason);
        }
    }
    for missing in MISSING {
        text += &format!("missing: {}; {}\n", missing.cpu, missing.instead);
    }
    text
}

fn kernels_as_json() -> Value {
    let twin = |twin: &Twin| json!({ "shader": twin.shader, "cpu": twin.cpu, "tolerance": twin.tolerance, "reason": twin.reason });
    let kernel = |kernel: &Kernel| {
        let twins: Vec<Value> = kernel.twins.iter().map(twin).collect();
        json!({ "name": kernel.name, "shader": kernel.shader, "buffers": kernel.buffers, "twins": twins })
    };
    let missing = |missing: &Missing| json!({ "cpu": missing.cpu, "instead": missing.instead });
    json!({
        "kernels": KERNELS.iter().map(kernel).collect::<Vec<_>>(),
        "missing": MISSING.iter().map(missing).collect::<Vec<_>>(),
    })
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
    let levels = info.parameters.iter().filter(|parameter| !parameter.levels.is_empty());
    for parameter in levels {
        text += &format!("    [tuned: {} = {}]\n", parameter.name, parameter.levels.join(", "));
    }
    for stage in info.stages {
        text += &format!("    [stage of the error: {}, exact by {}]\n", stage.name, stage.exact);
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
                "levels": parameter.levels,
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
        "stages": info.stages.iter().map(|it| json!({ "name": it.name, "exact": it.exact })).collect::<Vec<_>>(),
    })
}
