//! Strategies with their parameters set: from a SPEC such as `sh-exp:bands=4`, or from the sweeps of an experiment.

use crate::{Device, Experiment, HarnessError, experiment::name_of};
use halfshade_scene::{keys::Spanned, text};
use halfshade_strategy::{Params, Strategy};

/// One strategy with every parameter set.
#[derive(Debug, Clone, PartialEq)]
pub struct Variant {
    /// Place of the strategy in the list of all.
    pub strategy: usize,
    /// Name of the strategy.
    pub name: String,
    /// All parameters.
    pub params: Params,
    /// Whether it reads sphere sets.
    pub needs_spheres: bool,
    /// The device that it runs on.
    pub device: Device,
    /// Name, preset and the parameters that were set by hand: what users read.
    pub label: String,
}

impl Variant {
    /// Reads a SPEC: `name`, `name:key=value,key=value` or `name:preset,key=value`.
    pub fn parse(strategies: &[Box<dyn Strategy>], spec: &str) -> Result<Self, String> {
        let (name, settings) = spec.split_once(':').unwrap_or((spec, ""));
        let name = name.trim();
        let strategy = strategies
            .iter()
            .position(|strategy| strategy.info().name == name)
            .ok_or_else(|| text::unknown("strategy", name, strategies.iter().map(|strategy| strategy.info().name)))?;
        let info = strategies[strategy].info();
        let params = info.parse(settings).map_err(|error| format!("strategy `{name}`: {error}"))?;
        let set_by_hand =
            |key: &str| settings.split(',').any(|pair| pair.split('=').next().unwrap_or("").trim() == key);
        let presets = info.presets.iter().map(|preset| preset.name).filter(|name| set_by_hand(name));
        let set = info.parameters.iter().filter(|parameter| set_by_hand(parameter.name)).filter_map(|parameter| {
            params.iter().find(|(key, _)| *key == parameter.name).map(|(key, value)| format!("{key}={value}"))
        });
        let set: Vec<String> = presets.map(str::to_owned).chain(set).collect();
        let label = if set.is_empty() { name.to_owned() } else { format!("{name}:{}", set.join(",")) };
        let needs_spheres = strategies[strategy].needs_spheres();
        Ok(Self { strategy, name: name.to_owned(), params, needs_spheres, device: Device::Cpu, label })
    }

    /// The same on another device.
    pub fn on(&self, device: Device) -> Self {
        let label = if device.is_cpu() { self.label.clone() } else { format!("{} on {device}", self.label) };
        Self { device, label, ..self.clone() }
    }

    /// Name and all parameters: the same for the same work, however it was written.
    pub fn key(&self) -> String {
        let all: Vec<String> = self.params.iter().map(|(key, value)| format!("{key}={value}")).collect();
        format!("{}{}:{}", self.name, self.device.key(), all.join(","))
    }

    /// The parameter `bands`, where the strategy has one.
    pub fn bands(&self) -> Option<usize> {
        self.params.iter().find(|(key, _)| *key == "bands").and_then(|(_, value)| value.to_string().parse().ok())
    }
}

/// Most variants of an experiment.
const MAX_VARIANTS: usize = 10_000;

/// Key in an experiment of what a SPEC gives without one.
const PRESET: &str = "preset";

/// Every variant an experiment asks for, in its order. Sweeps that meet run once where they do; a list that names a value
/// twice and a table that adds nothing are mistakes.
pub fn sweep(experiment: &Experiment, strategies: &[Box<dyn Strategy>]) -> Result<Vec<Variant>, HarnessError> {
    let mut variants: Vec<Variant> = Vec::new();
    for table in &experiment.strategies {
        let name = name_of(table.get_ref());
        let at_name = table.get_ref().get("name").map_or(table.span(), Spanned::span);
        Variant::parse(strategies, &name).map_err(|problem| experiment.error_at(at_name.clone(), problem))?;
        let mut specs = vec![(at_name.clone(), format!("{name}:"))];
        for (key, value) in table.get_ref().iter().filter(|(key, _)| *key != "name") {
            let statement = experiment.statement(value.span());
            let error = |problem: String| experiment.error_at(statement.clone(), problem);
            let values = match value.get_ref() {
                toml::Value::Array(values) if values.is_empty() => {
                    return Err(error(format!("`{key}` is an empty list: nothing to run")));
                }
                toml::Value::Array(values) => values.as_slice(),
                single => std::slice::from_ref(single),
            };
            if let Some(place) = (0..values.len()).find(|&place| values[..place].contains(&values[place])) {
                let problem = format!("`{key}` lists {} twice; list each value once", values[place]);
                return Err(error(problem));
            }
            if specs.len().saturating_mul(values.len()) > MAX_VARIANTS {
                let problem = format!("the sweep has more than {MAX_VARIANTS} combinations; leave some values out");
                return Err(error(problem));
            }
            let mut swept = Vec::with_capacity(specs.len() * values.len());
            for (_, spec) in &specs {
                for value in values {
                    let text = match value {
                        toml::Value::String(text) => text.clone(),
                        toml::Value::Integer(_) | toml::Value::Float(_) => value.to_string(),
                        _ => {
                            let problem = format!("`{key}` must be a word, a number, or a list of them");
                            return Err(error(problem));
                        }
                    };
                    let setting = if key == PRESET { text } else { format!("{key}={text}") };
                    swept.push((statement.clone(), format!("{spec}{setting},")));
                }
            }
            specs = swept;
            // Checked after every key, so that a mistake is reported on its own line.
            for (_, spec) in &specs {
                Variant::parse(strategies, spec).map_err(error)?;
            }
        }
        let before = variants.len();
        for (statement, spec) in specs {
            let variant =
                Variant::parse(strategies, &spec).map_err(|problem| experiment.error_at(statement, problem))?;
            if variants.iter().all(|other| other.key() != variant.key()) {
                variants.push(variant);
            }
        }
        if variants.len() == before {
            let problem = format!("all of this `{name}` is listed above already; leave it out, or set its parameters");
            return Err(experiment.error_at(at_name, problem));
        }
    }
    Ok(variants)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{experiment, toy};
    use std::path::Path;

    fn labels(text: &str) -> Result<Vec<String>, String> {
        let experiment = Experiment::parse(text, Path::new("e.toml")).unwrap();
        let variants = sweep(&experiment, &toy::strategies()).map_err(|error| error.to_string())?;
        Ok(variants.into_iter().map(|variant| variant.label).collect())
    }

    #[test]
    fn lists_sweep_and_run_once_where_they_meet() {
        let text = experiment::tests::SMALL;
        assert_eq!(labels(text).unwrap(), ["dim:factor=0.5", "dim:factor=0.25"]);
        let preset = format!("{text}[[strategy]]\nname = \"dim\"\npreset = \"half\"\nfactor = [0.125, 1]\n");
        assert_eq!(labels(&preset).unwrap()[2..], ["dim:half,factor=0.125", "dim:half,factor=1"]);
        let twice = format!("{text}[[strategy]]\nname = \"dim\"\nfactor = [0.5, 1]\n[[strategy]]\nname = \"black\"\n");
        assert_eq!(labels(&twice).unwrap(), ["dim:factor=0.5", "dim:factor=0.25", "dim:factor=1", "black"]);
    }

    #[test]
    fn mistakes_name_the_line_and_what_is_known() {
        let text = experiment::tests::SMALL;
        let error = labels(&text.replace("factor", "colour")).unwrap_err();
        let told = "e.toml:9:1: strategy `dim`: unknown parameter `colour`; known: factor\n  |\n9 | colour = [0.5, 0.25]\n  | ^^^";
        assert!(error.starts_with(told), "{error}");
        let error = labels(&text.replace("\"dim\"\nfactor", "\"dimm\"\nfactor")).unwrap_err();
        assert!(
            error.starts_with("e.toml:8:8: unknown strategy `dimm` (did you mean `dim`?); known: dim, black"),
            "{error}"
        );
        assert!(labels(&text.replace("0.25", "7.0")).unwrap_err().contains("expected 0..=1"));
        let error = labels(&text.replace("0.25", "0.5")).unwrap_err();
        assert!(error.starts_with("e.toml:9:1: `factor` lists 0.5 twice"), "{error}");
        let error = labels(&format!("{text}[[strategy]]\nname = \"dim\"\nfactor = 0.25\n")).unwrap_err();
        assert!(error.starts_with("e.toml:11:8: all of this `dim` is listed above"), "{error}");
        for absurd in ["nan", "inf", "-inf", "1e300"] {
            assert!(labels(&text.replace("0.25", absurd)).is_err(), "{absurd}");
        }
        assert!(labels(&text.replace("[0.5, 0.25]", "[]")).unwrap_err().contains("empty list"));
        let refused = |text: String| Experiment::parse(&text, Path::new("e.toml")).unwrap_err().to_string();
        assert!(
            refused(text.replace("[0.5, 0.25]", "true"))
                .contains("`factor` must be a text in quotes, a number or a list")
        );
        assert!(refused(text.replace("name = \"dim\"\n", "")).contains("`strategy` needs the key `name`"));
    }
}
