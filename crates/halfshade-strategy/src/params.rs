//! Parameters: what can be set, within which range, and how a SPEC like `sh-exp:exp=hybrid,bands=4` sets it.

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt,
};

/// One parameter of a strategy.
#[derive(Debug, Clone)]
pub struct Parameter {
    /// Key in a SPEC.
    pub name: &'static str,
    /// One line.
    pub summary: &'static str,
    /// Type, default and range.
    pub kind: ParameterKind,
}

/// Type, default and range of a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ParameterKind {
    /// One of a few words.
    Choice {
        /// The words; the first one is no default by itself.
        values: &'static [&'static str],
        /// The default word.
        default: &'static str,
    },
    /// A whole number, bounds included.
    Integer {
        /// Default.
        default: i64,
        /// Smallest.
        min: i64,
        /// Largest.
        max: i64,
    },
    /// A real number, bounds included.
    Float {
        /// Default.
        default: f64,
        /// Smallest.
        min: f64,
        /// Largest.
        max: f64,
    },
}

/// A parameter's value.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[serde(untagged)]
pub enum Value {
    /// A word.
    Choice(String),
    /// A whole number.
    Integer(i64),
    /// A real number.
    Float(f64),
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Choice(word) => f.write_str(word),
            Self::Integer(number) => number.fmt(f),
            Self::Float(number) => number.fmt(f),
        }
    }
}

/// A value for every parameter, each within its range.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Params(BTreeMap<&'static str, Value>);

/// What is wrong with a SPEC.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SpecError {
    /// No parameter of that name.
    #[error("unknown parameter `{key}`; known: {known}")]
    UnknownKey {
        /// The key given.
        key: String,
        /// The keys there are.
        known: String,
    },
    /// A value out of range or of the wrong type.
    #[error("`{key}={value}`: expected {expected}")]
    BadValue {
        /// The key given.
        key: String,
        /// The value given.
        value: String,
        /// What would do.
        expected: String,
    },
    /// A key that is set before.
    #[error("`{0}` is set twice; give it once")]
    Twice(String),
    /// Not `key=value`.
    #[error("`{0}` is not of the form key=value")]
    NotAPair(String),
}

impl ParameterKind {
    /// The default.
    pub fn default(&self) -> Value {
        match *self {
            Self::Choice { default, .. } => Value::Choice(default.to_owned()),
            Self::Integer { default, .. } => Value::Integer(default),
            Self::Float { default, .. } => Value::Float(default),
        }
    }

    /// What users may write.
    pub fn range(&self) -> String {
        match *self {
            Self::Choice { values, .. } => values.join(" | "),
            Self::Integer { min, max, .. } => format!("{min}..={max}"),
            Self::Float { min, max, .. } => format!("{min}..={max}"),
        }
    }

    fn parse(&self, text: &str) -> Option<Value> {
        match *self {
            Self::Choice { values, .. } => values.contains(&text).then(|| Value::Choice(text.to_owned())),
            Self::Integer { min, max, .. } => text.parse().ok().filter(|n| (min..=max).contains(n)).map(Value::Integer),
            Self::Float { min, max, .. } => text.parse().ok().filter(|x| (min..=max).contains(x)).map(Value::Float),
        }
    }
}

impl Params {
    /// Every parameter at its default.
    pub fn defaults(parameters: &[Parameter]) -> Self {
        Self(parameters.iter().map(|parameter| (parameter.name, parameter.kind.default())).collect())
    }

    /// Defaults, changed by `key=value,key=value` (the part of a SPEC after the colon; empty is fine).
    pub fn parse(parameters: &[Parameter], settings: &str) -> Result<Self, SpecError> {
        let mut params = Self::defaults(parameters);
        let mut set = BTreeSet::new();
        for pair in settings.split(',').map(str::trim).filter(|pair| !pair.is_empty()) {
            let (key, text) = pair.split_once('=').ok_or_else(|| SpecError::NotAPair(pair.to_owned()))?;
            let (key, text) = (key.trim(), text.trim());
            let parameter = parameters.iter().find(|p| p.name == key).ok_or_else(|| SpecError::UnknownKey {
                key: key.to_owned(),
                known: parameters.iter().map(|p| p.name).collect::<Vec<_>>().join(", "),
            })?;
            let value = parameter.kind.parse(text).ok_or_else(|| SpecError::BadValue {
                key: key.to_owned(),
                value: text.to_owned(),
                expected: parameter.kind.range(),
            })?;
            if !set.insert(parameter.name) {
                return Err(SpecError::Twice(key.to_owned()));
            }
            params.0.insert(parameter.name, value);
        }
        Ok(params)
    }

    /// Names and values, sorted by name.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, &Value)> {
        self.0.iter().map(|(name, value)| (*name, value))
    }

    /// The word chosen for `name`; panics if the strategy didn't declare such a choice, which is its own mistake.
    pub fn choice(&self, name: &str) -> &str {
        match self.0.get(name) {
            Some(Value::Choice(word)) => word,
            other => panic!("no choice `{name}` was declared: {other:?}"),
        }
    }

    /// The whole number set for `name`; panics as [`Self::choice`] does.
    pub fn integer(&self, name: &str) -> i64 {
        match self.0.get(name) {
            Some(Value::Integer(number)) => *number,
            other => panic!("no integer `{name}` was declared: {other:?}"),
        }
    }

    /// The real number set for `name`; panics as [`Self::choice`] does.
    pub fn float(&self, name: &str) -> f64 {
        match self.0.get(name) {
            Some(Value::Float(number)) => *number,
            other => panic!("no real number `{name}` was declared: {other:?}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PARAMETERS: [Parameter; 2] = [
        Parameter {
            name: "exp",
            summary: "",
            kind: ParameterKind::Choice { values: &["series", "hybrid"], default: "hybrid" },
        },
        Parameter { name: "bands", summary: "", kind: ParameterKind::Integer { default: 4, min: 1, max: 8 } },
    ];

    #[test]
    fn a_spec_sets_what_it_names_and_leaves_the_rest() {
        let params = Params::parse(&PARAMETERS, "bands=6").unwrap();
        assert_eq!((params.choice("exp"), params.integer("bands")), ("hybrid", 6));
    }

    #[test]
    fn mistakes_are_named() {
        let error = |settings| Params::parse(&PARAMETERS, settings).unwrap_err().to_string();
        assert_eq!(error("band=6"), "unknown parameter `band`; known: exp, bands");
        assert_eq!(error("bands=9"), "`bands=9`: expected 1..=8");
        assert_eq!(error("bands"), "`bands` is not of the form key=value");
        assert_eq!(error("bands=2,exp=series, bands=4"), "`bands` is set twice; give it once");
        assert_eq!(error("bands=2,bands=2"), "`bands` is set twice; give it once");
        assert_eq!(error("exp=magic"), "`exp=magic`: expected series | hybrid");
    }
}
