//! Parameters: pairs of a type with a name, and values.

use super::tokens::{Tokens, Word};
use crate::SceneError;
use glam::Vec3;
use std::path::PathBuf;
use std::sync::Arc;

/// A value's elements.
#[derive(Debug, Clone, PartialEq)]
enum Values {
    Numbers(Vec<f64>),
    Words(Vec<String>),
}

#[derive(Debug, Clone, PartialEq)]
struct Parameter {
    kind: String,
    name: String,
    values: Values,
    line: usize,
}

/// The parameters of one directive.
#[derive(Debug, Clone)]
pub(super) struct Parameters {
    pub(super) path: Arc<PathBuf>,
    /// Line of the directive.
    pub(super) line: usize,
    list: Vec<Parameter>,
}

impl Parameters {
    /// Reads all that follow.
    pub(super) fn read(tokens: &mut Tokens, line: usize) -> Result<Self, SceneError> {
        let mut list = Vec::new();
        while tokens.peek() == Some("\"") {
            let line = tokens.line();
            let declaration = tokens.quoted("a parameter")?;
            let mut words = declaration.split_ascii_whitespace();
            let (Some(kind), Some(name), None) = (words.next(), words.next(), words.next()) else {
                let shown = declaration.escape_debug();
                return Err(tokens.error(format!("`{shown}` is no type and name of a parameter")));
            };
            let values = values(tokens, name)?;
            list.push(Parameter { kind: kind.to_owned(), name: name.to_owned(), values, line });
        }
        Ok(Self { path: tokens.path.clone(), line, list })
    }

    fn find(&self, name: &str) -> Option<&Parameter> {
        self.list.iter().find(|parameter| parameter.name == name)
    }

    pub(super) fn error(&self, problem: impl Into<String>) -> SceneError {
        SceneError::new(problem).in_file(&*self.path).at_line(self.line)
    }

    /// The error of what is wrong with a parameter.
    pub(super) fn error_at(&self, name: &str, problem: impl Into<String>) -> SceneError {
        self.error(problem).at_line(self.find(name).map_or(self.line, |parameter| parameter.line))
    }

    /// The type that a parameter is declared with.
    pub(super) fn kind(&self, name: &str) -> Option<&str> {
        Some(self.find(name)?.kind.as_str())
    }

    pub(super) fn numbers(&self, name: &str) -> Option<&[f64]> {
        match &self.find(name)?.values {
            Values::Numbers(numbers) => Some(numbers),
            Values::Words(_) => None,
        }
    }

    pub(super) fn number(&self, name: &str) -> Option<f64> {
        self.numbers(name)?.first().copied()
    }

    pub(super) fn text(&self, name: &str) -> Option<&str> {
        match &self.find(name)?.values {
            Values::Words(words) => words.first().map(String::as_str),
            Values::Numbers(_) => None,
        }
    }

    /// A colour by red, green and blue.
    pub(super) fn rgb(&self, name: &str) -> Option<Vec3> {
        match (self.kind(name)?, self.numbers(name)?) {
            ("rgb", &[r, g, b]) => Some(Vec3::new(r as f32, g as f32, b as f32)),
            _ => None,
        }
    }
}

/// The values of a parameter: one, or some in brackets.
fn values(tokens: &mut Tokens, name: &str) -> Result<Values, SceneError> {
    let is_list = tokens.peek() == Some("[");
    if is_list {
        tokens.next()?;
    }
    let (mut numbers, mut words) = (Vec::new(), Vec::new());
    loop {
        let line = tokens.line();
        let missing = |tokens: &mut Tokens| {
            let shown = name.escape_debug().to_string();
            tokens.error(format!("the values of parameter `{shown}` are missing, or don't end")).at_line(line)
        };
        match tokens.next()? {
            Some(Word::Plain(word)) if word == "]" && is_list => break,
            Some(Word::Quoted(word)) => words.push(word),
            Some(Word::Plain(word)) if word == "true" || word == "false" => words.push(word),
            Some(Word::Plain(word)) => match word.parse::<f64>() {
                Ok(number) if number.is_finite() => numbers.push(number),
                _ => {
                    let problem =
                        format!("`{}` is no value of parameter `{}`", word.escape_debug(), name.escape_debug());
                    return Err(tokens.error(problem).at_line(line));
                }
            },
            None => return Err(missing(tokens)),
        }
        if !is_list {
            break;
        }
    }
    match (numbers.is_empty(), words.is_empty()) {
        (_, true) => Ok(Values::Numbers(numbers)),
        (true, false) => Ok(Values::Words(words)),
        (false, false) => Err(tokens.error(format!("parameter `{}` mixes numbers and words", name.escape_debug()))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn read(text: &str) -> Result<Parameters, SceneError> {
        Parameters::read(&mut Tokens::new(Path::new("a.pbrt"), text.to_owned()), 1)
    }

    #[test]
    fn parameters_have_types_names_and_values() {
        let found = read("\"float fov\" 30 \"rgb L\" [1 2 3]\n \"bool b\" true \"string f\" [\"x y\"] Shape").unwrap();
        assert_eq!((found.number("fov"), found.text("b"), found.text("f")), (Some(30.0), Some("true"), Some("x y")));
        assert_eq!(
            (found.rgb("L"), found.rgb("fov"), found.kind("L")),
            (Some(Vec3::new(1.0, 2.0, 3.0)), None, Some("rgb"))
        );
        for (text, line, part) in [
            ("\"float\" 1", 1, "no type and name"),
            ("\"float a\"\n [1 2", 2, "don't end"),
            ("\n\"float a\"", 2, "missing"),
            ("\"float a\" [1 \"b\"]", 1, "mixes"),
            ("\"float a\" inf", 1, "no value"),
            ("\"float a\" Shape", 1, "no value"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.line == Some(line) && error.problem.contains(part), "{text}: {error}");
        }
    }
}
