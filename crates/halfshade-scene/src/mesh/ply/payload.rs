//! Numbers after the header of a PLY file, in text or binary.

use super::header::{Element, Format, Type};
use crate::SceneError;
use crate::mesh::words::{Words, number, remedy_for, shown};

/// A walk through the numbers. All types fit f64 exactly.
#[derive(Debug)]
pub(super) enum Payload<'a> {
    /// Each element has a line of its own.
    Ascii(Words<'a>),
    Binary {
        rest: &'a [u8],
        is_big: bool,
    },
}

impl<'a> Payload<'a> {
    /// At the start of what follows the header.
    pub(super) fn new(words: Words<'a>, format: Format) -> Self {
        match format {
            Format::Ascii => Self::Ascii(words),
            Format::LittleEndian => Self::Binary { rest: words.rest(), is_big: false },
            Format::BigEndian => Self::Binary { rest: words.rest(), is_big: true },
        }
    }

    /// The line, where there are lines.
    pub(super) fn line(&self) -> Option<usize> {
        match self {
            Self::Ascii(words) => Some(words.line()),
            Self::Binary { .. } => None,
        }
    }

    /// Refuses a count that the rest of the file cannot hold, before anything is read that often.
    pub(super) fn check_count(&self, element: &Element) -> Result<(), SceneError> {
        let (left, smallest) = match self {
            // A digit and a line end for each number.
            Self::Ascii(words) => (words.rest().len() + 1, 2 * element.properties.len()),
            Self::Binary { rest, .. } => {
                (rest.len(), element.properties.iter().map(|p| p.length.unwrap_or(p.of).size()).sum())
            }
        };
        let fits = element.count.checked_mul(smallest).is_some_and(|bytes| bytes <= left);
        if element.count > 0 && (smallest == 0 || !fits) {
            let Element { name, count, .. } = element;
            return Err(SceneError::new(format!(
                "{count} elements `{name}` are declared, but only {left} bytes follow"
            ))
            .with_remedy("the file was cut short or its header is wrong: get it again"));
        }
        Ok(())
    }

    /// Goes to the next element, over empty lines and comments.
    pub(super) fn begin(&mut self) {
        let Self::Ascii(words) = self else { return };
        loop {
            let mut ahead = words.clone();
            match ahead.word() {
                Some(b"comment" | b"obj_info") => {}
                None if !ahead.is_at_end() => {}
                _ => return,
            }
            words.next_line();
        }
    }

    /// Ends an element: nothing else may be in its line.
    pub(super) fn end(&mut self) -> Result<(), SceneError> {
        let Self::Ascii(words) = self else { return Ok(()) };
        if let Some(word) = words.word() {
            let problem =
                format!("`{}` is one number more than the header says, in `{}`", shown(word), words.shown_line());
            return Err(SceneError::new(problem)
                .at_line(words.line())
                .with_remedy("the header or the line is wrong: export the mesh again"));
        }
        words.next_line();
        Ok(())
    }

    /// The next number, which `name` names in messages.
    pub(super) fn number(&mut self, of: Type, name: &str) -> Result<f64, SceneError> {
        match self {
            Self::Ascii(words) => {
                let Some(word) = words.word() else {
                    let (problem, line) = if words.is_at_end() && words.shown_line().is_empty() {
                        (format!("the file ends before `{name}`"), words.line() - 1)
                    } else {
                        (format!("the line ends before `{name}`: `{}`", words.shown_line()), words.line())
                    };
                    return Err(SceneError::new(problem).at_line(line).with_remedy("is the file complete?"));
                };
                in_text(word, of).ok_or_else(|| {
                    let what = match of.range() {
                        None => "number".to_owned(),
                        Some((low, high)) => format!("whole number from {low} to {high}"),
                    };
                    SceneError::new(format!("`{name}` is no {what}: `{}` in `{}`", shown(word), words.shown_line()))
                        .at_line(words.line())
                        .with_remedy(remedy_for(word))
                })
            }
            Self::Binary { rest, is_big } => {
                let ended =
                    || SceneError::new(format!("the file ends before `{name}`")).with_remedy("get the file again");
                let (bytes, after) = rest.split_at_checked(of.size()).ok_or_else(ended)?;
                *rest = after;
                // Unused bytes stay 0 at the end that counts least.
                let mut wide = [0; 8];
                wide[..bytes.len()].copy_from_slice(bytes);
                if *is_big {
                    wide[..bytes.len()].reverse();
                }
                let [a, b, c, d, ..] = wide;
                Ok(match of {
                    Type::Char => f64::from(a as i8),
                    Type::UChar => f64::from(a),
                    Type::Short => f64::from(i16::from_le_bytes([a, b])),
                    Type::UShort => f64::from(u16::from_le_bytes([a, b])),
                    Type::Int => f64::from(i32::from_le_bytes([a, b, c, d])),
                    Type::UInt => f64::from(u32::from_le_bytes([a, b, c, d])),
                    Type::Float => f64::from(f32::from_le_bytes([a, b, c, d])),
                    Type::Double => f64::from_le_bytes(wide),
                })
            }
        }
    }

    /// The length of a list, at most what the rest of the file can hold.
    pub(super) fn length(&mut self, of: Type, item: Type, name: &str) -> Result<usize, SceneError> {
        let length = self.number(of, name)?;
        let left = match self {
            Self::Ascii(words) => words.rest().len().div_ceil(2),
            Self::Binary { rest, .. } => rest.len() / item.size(),
        };
        if length < 0.0 || length > left as f64 {
            let error = SceneError::new(format!("`{name}` has {length} items, but the file has at most {left} more"));
            return Err(SceneError { line: self.line(), ..error }.with_remedy("get the file again"));
        }
        Ok(length as usize)
    }

    /// A note on what is left after the last element, where nothing should be.
    pub(super) fn check_end(mut self) -> Result<Option<String>, SceneError> {
        self.begin();
        match self {
            Self::Ascii(mut words) => match words.word() {
                None => Ok(None),
                Some(_) => {
                    let problem = format!("a line follows that the header doesn't count: `{}`", words.shown_line());
                    Err(SceneError::new(problem)
                        .at_line(words.line())
                        .with_remedy("the counts in the header are wrong: export the mesh again"))
                }
            },
            Self::Binary { rest, .. } if rest.iter().all(u8::is_ascii_whitespace) => Ok(None),
            Self::Binary { rest, .. } => {
                Ok(Some(format!("bytes that the header doesn't count, left out at the end: {}", rest.len())))
            }
        }
    }
}

/// A number of a type, from text. Whole numbers may be written as `255.0`.
fn in_text(word: &[u8], of: Type) -> Option<f64> {
    match of.range() {
        // Rounded once, as binary files have it.
        None if of == Type::Float => number::<f32>(word).map(f64::from),
        None => number(word),
        Some((low, high)) => {
            let value: f64 = number(word)?;
            (value.fract() == 0.0 && value >= low as f64 && value <= high as f64).then_some(value)
        }
    }
}
