//! Parameters: what can be set, and within which range.

use std::fmt;

/// One parameter of a strategy.
#[derive(Debug, Clone)]
pub struct Parameter {
    /// Key in a SPEC.
    pub name: &'static str,
    /// One line.
    pub summary: &'static str,
    /// Type, default and range.
    pub kind: ParameterKind,
    /// Values that trade error for time, from the cheapest to the most exact, as a SPEC sets them: what a search tries. Empty of
    /// parameters that aren't there for that.
    pub levels: &'static [&'static str],
}

/// Values of some parameters under one name, such as those of the published method.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Preset {
    /// Word in a SPEC: `as-published`.
    pub name: &'static str,
    /// One line.
    pub summary: &'static str,
    /// The values, as a SPEC sets them: `key=value,key=value`.
    pub settings: &'static str,
}

/// A stage of a method at which it errs, and the settings with which it doesn't, or as little as the method allows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stage {
    /// Its name: `bands`, `hierarchy`.
    pub name: &'static str,
    /// Settings of its exact counterpart: `key=value,key=value`.
    pub exact: &'static str,
}

/// One of the words that a parameter may be set to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Word {
    /// The word.
    pub name: &'static str,
    /// One line.
    pub summary: &'static str,
}

/// Type, default and range of a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ParameterKind {
    /// One of a few words.
    Choice {
        /// The words; the first one is no default by itself.
        words: &'static [Word],
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
    Choice(&'static str),
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

impl ParameterKind {
    /// The default.
    pub fn default(&self) -> Value {
        match *self {
            Self::Choice { default, .. } => Value::Choice(default),
            Self::Integer { default, .. } => Value::Integer(default),
            Self::Float { default, .. } => Value::Float(default),
        }
    }

    /// The range as users read it: `words | joined`, or `min..=max`.
    pub fn range(&self) -> String {
        match *self {
            Self::Choice { words, .. } => words.iter().map(|word| word.name).collect::<Vec<_>>().join(" | "),
            Self::Integer { min, max, .. } => format!("{min}..={max}"),
            Self::Float { min, max, .. } => format!("{min}..={max}"),
        }
    }

    /// The words of a choice; none of a number.
    pub(crate) fn words(&self) -> impl Iterator<Item = &'static str> {
        let words = if let Self::Choice { words, .. } = self { words } else { &[] as &[Word] };
        words.iter().map(|word| word.name)
    }

    /// The value that `text` stands for; `None` if it is out of range or of another type.
    pub(crate) fn parse(&self, text: &str) -> Option<Value> {
        match *self {
            Self::Choice { words, .. } => {
                words.iter().find(|word| word.name == text).map(|word| Value::Choice(word.name))
            }
            Self::Integer { min, max, .. } => text.parse().ok().filter(|n| (min..=max).contains(n)).map(Value::Integer),
            Self::Float { min, max, .. } => text.parse().ok().filter(|x| (min..=max).contains(x)).map(Value::Float),
        }
    }
}
