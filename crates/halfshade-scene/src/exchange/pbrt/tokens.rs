//! Words of a scene file, with their lines.

use crate::SceneError;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A word.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Word {
    /// Between quotation marks, which are left out.
    Quoted(String),
    /// Anything else up to a blank, a mark or a bracket; brackets stand alone.
    Plain(String),
}

/// The words of a file, one after another.
#[derive(Debug)]
pub(super) struct Tokens {
    pub(super) path: Arc<PathBuf>,
    text: String,
    place: usize,
    line: usize,
}

impl Tokens {
    pub(super) fn new(path: &Path, text: String) -> Self {
        Self { path: Arc::new(path.to_owned()), text, place: 0, line: 1 }
    }

    /// The line of the next word.
    pub(super) fn line(&mut self) -> usize {
        self.skip();
        self.line
    }

    pub(super) fn error(&mut self, problem: impl Into<String>) -> SceneError {
        let line = self.line();
        SceneError::new(problem).in_file(&*self.path).at_line(line)
    }

    /// Goes on to the next word: past blanks and comments.
    fn skip(&mut self) {
        let bytes = self.text.as_bytes();
        let mut in_comment = false;
        while let Some(&byte) = bytes.get(self.place) {
            match byte {
                b'\n' => {
                    self.line += 1;
                    in_comment = false;
                }
                b'#' => in_comment = true,
                _ if in_comment || byte.is_ascii_whitespace() => {}
                _ => break,
            }
            self.place += 1;
        }
    }

    /// The next word, if it is plain, without taking it.
    pub(super) fn peek(&mut self) -> Option<&str> {
        self.skip();
        let rest = &self.text[self.place..];
        match rest.bytes().next()? {
            b'[' | b']' => Some(&rest[..1]),
            b'"' => Some("\""),
            _ => Some(&rest[..plain_length(rest)]),
        }
    }

    /// The next word; `None` at the end.
    pub(super) fn next(&mut self) -> Result<Option<Word>, SceneError> {
        self.skip();
        let rest = &self.text[self.place..];
        let Some(first) = rest.bytes().next() else { return Ok(None) };
        let (word, length) = match first {
            b'"' => match quoted(rest) {
                Some((word, length)) => (Word::Quoted(word), length),
                None => return Err(self.error("a quotation mark is never closed in its line")),
            },
            b'[' | b']' => (Word::Plain(rest[..1].to_owned()), 1),
            _ => {
                let length = plain_length(rest);
                (Word::Plain(rest[..length].to_owned()), length)
            }
        };
        self.place += length;
        Ok(Some(word))
    }

    /// The next word, which must be quoted.
    pub(super) fn quoted(&mut self, what: &str) -> Result<String, SceneError> {
        match self.peek() {
            Some("\"") => match self.next()? {
                Some(Word::Quoted(word)) => Ok(word),
                _ => Err(self.error(format!("{what} is missing"))),
            },
            _ => Err(self.error(format!("{what} in quotation marks is missing"))),
        }
    }

    /// The next words, which must be so many finite numbers; brackets around them are passed over.
    pub(super) fn numbers<const N: usize>(&mut self, what: &str) -> Result<[f64; N], SceneError> {
        let is_bracketed = self.peek() == Some("[");
        if is_bracketed {
            self.next()?;
        }
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            let found = self.peek().and_then(|word| word.parse().ok()).filter(|number: &f64| number.is_finite());
            *number = found.ok_or_else(|| self.error(format!("{what} needs {N} finite numbers")))?;
            self.next()?;
        }
        if is_bracketed && self.next()? != Some(Word::Plain("]".to_owned())) {
            return Err(self.error(format!("{what} needs {N} numbers, and then `]`")));
        }
        Ok(numbers)
    }
}

fn plain_length(rest: &str) -> usize {
    rest.find(|c: char| c.is_ascii_whitespace() || matches!(c, '"' | '[' | ']' | '#')).unwrap_or(rest.len())
}

/// A quoted word at the beginning, and its length with its marks.
fn quoted(rest: &str) -> Option<(String, usize)> {
    let (mut word, mut is_escaped) = (String::new(), false);
    for (place, c) in rest.char_indices().skip(1) {
        match c {
            '\n' => return None,
            _ if is_escaped => {
                word.push(match c {
                    'n' => '\n',
                    't' => '\t',
                    other => other,
                });
                is_escaped = false;
            }
            '\\' => is_escaped = true,
            '"' => return Some((word, place + 1)),
            _ => word.push(c),
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_marks_and_comments() {
        let text = "Scale 1 [2 3.5]# a \"comment\nShape\"a \\\"b\\\"\"\n\n  x";
        let mut tokens = Tokens::new(Path::new("a"), text.to_owned());
        let mut found = Vec::new();
        while let Some(word) = tokens.next().unwrap() {
            found.push((word, tokens.line));
        }
        let plain = |word: &str, line| (Word::Plain(word.to_owned()), line);
        let mut expected = ["Scale", "1", "[", "2", "3.5", "]"].map(|word| plain(word, 1)).to_vec();
        expected.extend([plain("Shape", 2), (Word::Quoted("a \"b\"".into()), 2), plain("x", 4)]);
        assert_eq!(found, expected);
        let mut open = Tokens::new(Path::new("a"), "\n\"a\nb".into());
        assert_eq!(open.next().unwrap_err().line, Some(2));
        let mut numbers = Tokens::new(Path::new("a"), "[1 2] 3 4 nan".into());
        assert_eq!((numbers.numbers("x").unwrap(), numbers.numbers("x").unwrap()), ([1.0, 2.0], [3.0, 4.0]));
        assert!(numbers.numbers::<1>("Scale").unwrap_err().problem.contains("Scale needs 1"));
    }
}
