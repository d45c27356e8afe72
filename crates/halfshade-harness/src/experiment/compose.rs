//! Experiments without a file: some scenes, some strategies, all else by default.

use super::Experiment;
use crate::{HarnessError, ReceiverKind};
use std::path::Path;
use toml::{Table, Value};

/// Settings of a comparison that was asked for without a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Its purpose: `compare`, `tune`. With the scenes, the name of its folder.
    pub purpose: &'static str,
    /// Built-in names, scene files and mesh files, relative to the current folder.
    pub scenes: Vec<String>,
    /// Light of mesh files.
    pub environment: Option<String>,
    /// SPECs.
    pub strategies: Vec<String>,
    /// SPEC of the strategy that verdicts compare all others with.
    pub baseline: Option<String>,
    /// Frame that is compared.
    pub frame: usize,
    /// Whether scenes are held still at that frame.
    pub still: bool,
    /// Points that are scored.
    pub receivers: ReceiverKind,
    /// Samples of the truth per receiver.
    pub samples: usize,
    /// Whether pictures are drawn.
    pub pictures: bool,
}

impl Comparison {
    /// The experiment as the text of a file, for who wants to change it.
    pub fn text(&self) -> String {
        let word = |text: &str| Value::String(text.to_owned());
        let number = |count: usize| Value::Integer(i64::try_from(count).unwrap_or(i64::MAX));
        let mut text = Table::from_iter([
            ("name".to_owned(), word(&self.name())),
            ("claim".to_owned(), word("No claim: strategies beside each other.")),
            ("receivers".to_owned(), Value::Array(vec![word(&self.receivers.to_string())])),
        ]);
        if !self.still {
            text.insert("frames".into(), Value::Array(vec![number(self.frame)]));
        }
        if let Some(baseline) = &self.baseline {
            text.insert("baseline".into(), word(baseline));
        }
        text.insert("truth".into(), Table::from_iter([("samples".to_owned(), number(self.samples))]).into());
        let timing = [("warm_up".to_owned(), number(1)), ("repeats".to_owned(), number(7))];
        text.insert("timing".into(), Table::from_iter(timing).into());
        if self.pictures {
            text.insert("pictures".into(), Table::new().into());
        }
        let scenes = self.scenes.iter().map(|name| {
            let mut scene = Table::from_iter([("name".to_owned(), word(name))]);
            scene.extend(self.environment.iter().map(|light| ("environment".to_owned(), word(light))));
            scene.extend(self.still.then(|| ("still".to_owned(), number(self.frame))));
            Value::Table(scene)
        });
        text.insert("scene".into(), Value::Array(scenes.collect()));
        text.insert("strategy".into(), Value::Array(self.strategies.iter().map(|spec| strategy(spec)).collect()));
        text.to_string()
    }

    /// The experiment.
    ///
    /// # Errors
    /// The same as of a file with that text.
    pub fn experiment(&self) -> Result<Experiment, HarnessError> {
        Experiment::parse(&self.text(), Path::new(""))
    }

    /// Its purpose and the scenes, as the name of a folder.
    pub fn name(&self) -> String {
        let stems = self.scenes.iter().map(|scene| {
            let stem = Path::new(scene).file_stem().unwrap_or_default().to_string_lossy().into_owned();
            stem.replace(|c: char| !(c.is_ascii_alphanumeric() || c == '-' || c == '_'), "_")
        });
        let name = format!("{}-{}", self.purpose, stems.collect::<Vec<_>>().join("-"));
        name.chars().take(MOST_LETTERS).collect()
    }
}

/// Letters of a folder's name.
const MOST_LETTERS: usize = 60;

/// A SPEC as a table of an experiment.
fn strategy(spec: &str) -> Value {
    let (name, settings) = spec.split_once(':').unwrap_or((spec, ""));
    let mut table = Table::from_iter([("name".to_owned(), Value::String(name.trim().to_owned()))]);
    for setting in settings.split(',').map(str::trim).filter(|setting| !setting.is_empty()) {
        let (key, value) = setting.split_once('=').unwrap_or(("preset", setting));
        table.insert(key.trim().to_owned(), Value::String(value.trim().to_owned()));
    }
    Value::Table(table)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_comparison_is_an_experiment_that_can_be_kept() {
        let comparison = Comparison {
            purpose: "compare",
            scenes: vec!["vases".into(), "a b/bunny \"x\".obj".into()],
            environment: None,
            strategies: vec!["dim".into(), "dim:faint,factor=0.5".into()],
            baseline: Some("dim".into()),
            frame: 7,
            still: false,
            receivers: ReceiverKind::Pixels,
            samples: 64,
            pictures: true,
        };
        let experiment = comparison.experiment().unwrap();
        assert_eq!(experiment.name, "compare-vases-bunny__x_");
        assert_eq!(
            (experiment.frames.as_slice(), experiment.receivers.as_slice()),
            (&[7][..], &[ReceiverKind::Pixels][..])
        );
        assert_eq!(experiment.scenes[1].name.get_ref(), "a b/bunny \"x\".obj");
        let second = experiment.strategies[1].get_ref();
        let value = |key: &str| second[key].get_ref().as_str();
        assert_eq!([value("name"), value("preset"), value("factor")], [Some("dim"), Some("faint"), Some("0.5")]);
        assert_eq!(experiment.baseline.as_ref().map(|spec| spec.get_ref().as_str()), Some("dim"));
        // A mistake is told without a file and a line that nobody wrote.
        let error = experiment.error_at(0..0, "it is wrong").to_string();
        assert_eq!(error, "it is wrong");
        let still = Comparison { still: true, pictures: false, ..comparison }.experiment().unwrap();
        assert_eq!((still.scenes[0].still.as_ref().map(|it| *it.get_ref()), still.pictures.is_none()), (Some(7), true));
    }
}
