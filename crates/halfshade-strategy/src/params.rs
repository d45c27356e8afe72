//! Values of parameters, as a SPEC like `sh-exp:as-published,bands=6` sets them.

use crate::{Parameter, Value, settings::Setting};
use halfshade_scene::text::{did_you_mean, unknown};
use std::collections::{BTreeMap, BTreeSet};

/// A value for every parameter, each within its range.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Params(BTreeMap<&'static str, Value>);

/// A mistake in a SPEC.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SpecError {
    /// No parameter of that name.
    #[error("{}", unknown("parameter", .key, .known.iter().copied()))]
    UnknownKey {
        /// The key given.
        key: String,
        /// The keys there are.
        known: Vec<&'static str>,
    },
    /// A value out of range or of the wrong type.
    #[error("`{key}={value}`: expected {expected}{meant}")]
    BadValue {
        /// The key given.
        key: String,
        /// The value given.
        value: String,
        /// Values that would do.
        expected: String,
        /// The word that was probably meant, as a question; empty if there is none.
        meant: String,
    },
    /// A key that is set before.
    #[error("`{0}` is set twice; give it once")]
    Twice(String),
    /// A preset after another.
    #[error("`{0}` and `{1}` are presets both; give one")]
    TwoPresets(String, String),
    /// Neither `key=value` nor the name of a preset.
    #[error("`{text}` is not of the form key=value{}", no_preset(.text, .known))]
    NotAPair {
        /// The text given.
        text: String,
        /// The presets there are.
        known: Vec<&'static str>,
    },
}

/// Adds that a text is no preset, where there are presets.
fn no_preset(text: &str, known: &[&str]) -> String {
    let names = known.join(", ");
    if known.is_empty() {
        names
    } else {
        format!(", nor a preset: {names}{}", did_you_mean(text, known.iter().copied()))
    }
}

impl Params {
    /// Every parameter at its default.
    pub(crate) fn defaults(parameters: &[Parameter]) -> Self {
        Self(parameters.iter().map(|parameter| (parameter.name, parameter.kind.default())).collect())
    }

    /// Sets each `key=value` of `pairs`.
    pub(crate) fn set<'a>(
        &mut self,
        parameters: &[Parameter],
        pairs: impl Iterator<Item = &'a str>,
    ) -> Result<(), SpecError> {
        let mut done = BTreeSet::new();
        for pair in pairs {
            let (key, text) = pair.split_once('=').unwrap_or((pair, ""));
            let (key, text) = (key.trim(), text.trim());
            let parameter = parameters.iter().find(|p| p.name == key).ok_or_else(|| SpecError::UnknownKey {
                key: key.to_owned(),
                known: parameters.iter().map(|p| p.name).collect(),
            })?;
            let value = parameter.kind.parse(text).ok_or_else(|| SpecError::BadValue {
                key: key.to_owned(),
                value: text.to_owned(),
                expected: parameter.kind.range(),
                meant: did_you_mean(text, parameter.kind.words()),
            })?;
            if !done.insert(parameter.name) {
                return Err(SpecError::Twice(key.to_owned()));
            }
            self.0.insert(parameter.name, value);
        }
        Ok(())
    }

    /// Names and values, sorted by name.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, &Value)> {
        self.0.iter().map(|(name, value)| (*name, value))
    }

    /// The value set for `name`; panics if the strategy didn't declare such a parameter of that type, which is its own
    /// mistake.
    pub fn get<T: Setting>(&self, name: &str) -> T {
        let value = self.0.get(name);
        value.and_then(T::read).unwrap_or_else(|| panic!("no such parameter `{name}` was declared: {value:?}"))
    }

    /// The word chosen for `name`, for who knows the strategy but not its types; panics as [`Self::get`] does.
    pub fn word(&self, name: &str) -> &'static str {
        match self.0.get(name) {
            Some(Value::Choice(word)) => word,
            other => panic!("no choice `{name}` was declared: {other:?}"),
        }
    }

    /// The number set for `name`, for who knows the strategy but not its types; panics as [`Self::get`] does.
    pub fn number(&self, name: &str) -> f64 {
        match self.0.get(name) {
            Some(Value::Integer(number)) => *number as f64,
            Some(Value::Float(number)) => *number,
            other => panic!("no number `{name}` was declared: {other:?}"),
        }
    }
}
