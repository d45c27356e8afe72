//! The header of a PLY file: which elements follow, with which properties.

use crate::SceneError;
use crate::mesh::words::{Words, shown};

/// Encoding of numbers after the header.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Format {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// The type of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Type {
    Char,
    UChar,
    Short,
    UShort,
    Int,
    UInt,
    Float,
    Double,
}

impl Type {
    /// Names, the first those of the format's first description.
    const NAMES: [(&'static str, &'static str, Self); 8] = [
        ("char", "int8", Self::Char),
        ("uchar", "uint8", Self::UChar),
        ("short", "int16", Self::Short),
        ("ushort", "uint16", Self::UShort),
        ("int", "int32", Self::Int),
        ("uint", "uint32", Self::UInt),
        ("float", "float32", Self::Float),
        ("double", "float64", Self::Double),
    ];

    /// Bytes of a number in binary files.
    pub(super) fn size(self) -> usize {
        match self {
            Self::Char | Self::UChar => 1,
            Self::Short | Self::UShort => 2,
            Self::Int | Self::UInt | Self::Float => 4,
            Self::Double => 8,
        }
    }

    /// Smallest and largest whole number; `None` for floating point.
    pub(super) fn range(self) -> Option<(i64, i64)> {
        match self {
            Self::Char => Some((i8::MIN.into(), i8::MAX.into())),
            Self::UChar => Some((0, u8::MAX.into())),
            Self::Short => Some((i16::MIN.into(), i16::MAX.into())),
            Self::UShort => Some((0, u16::MAX.into())),
            Self::Int => Some((i32::MIN.into(), i32::MAX.into())),
            Self::UInt => Some((0, u32::MAX.into())),
            Self::Float | Self::Double => None,
        }
    }
}

/// A property of an element.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Property {
    pub(super) name: String,
    /// The type of the number, or of the list's items.
    pub(super) of: Type,
    /// The type of the length, if it is a list.
    pub(super) length: Option<Type>,
}

/// A kind of element, such as the vertices.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: usize,
    pub(super) properties: Vec<Property>,
}

/// A header.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Header {
    pub(super) format: Format,
    /// In the order in which they follow.
    pub(super) elements: Vec<Element>,
}

impl Header {
    /// Reads a header. Nothing but `words` knows where it ends: at the start of what follows.
    pub(super) fn read(words: &mut Words<'_>) -> Result<Self, SceneError> {
        if words.word() != Some(b"ply") || words.word().is_some() {
            return Err(SceneError::new("the file doesn't begin with a line `ply`")
                .at_line(1)
                .with_remedy("is it a PLY file?"));
        }
        // The data after the header may begin with a byte that is a line feed.
        let returns_stand_alone = words.is_at_return_alone();
        words.next_line();
        let mut format = None;
        let mut elements: Vec<Element> = Vec::new();
        loop {
            if words.is_at_end() {
                return Err(SceneError::new("the file ends within its header, before `end_header`")
                    .at_line(words.line() - 1)
                    .with_remedy("get the file again"));
            }
            let line: Vec<&[u8]> = match words.word() {
                // The words that follow may be of any length.
                Some(first @ (b"comment" | b"obj_info")) => vec![first],
                first => first.into_iter().chain(std::iter::from_fn(|| words.word())).take(6).collect(),
            };
            let line = Line { words: &line, file: words };
            match *line.words {
                [] | [b"comment" | b"obj_info"] => {}
                [b"end_header"] => break,
                [b"format", name, version] if format.is_none() => format = Some(line.format(name, version)?),
                [b"element", name, count] => elements.push(line.element(name, count)?),
                [b"property", ref rest @ ..] => {
                    let element = elements.last_mut();
                    let element = element
                        .ok_or_else(|| line.wrong("a property comes before any element", "export the mesh again"))?;
                    let property = line.property(rest)?;
                    if element.properties.iter().any(|other| other.name == property.name) {
                        return Err(line.wrong("the element has the property twice", "export the mesh again"));
                    }
                    element.properties.push(property);
                }
                _ => {
                    return Err(line.wrong(
                        "the line is not understood",
                        "a header has format, comment, obj_info, element, property and end_header",
                    ));
                }
            }
            words.next_line();
        }
        let format = format
            .ok_or_else(|| SceneError::new("the header has no line `format`").with_remedy("export the mesh again"))?;
        words.next_line_where(returns_stand_alone);
        Ok(Self { format, elements })
    }
}

/// A line of a header.
struct Line<'a> {
    words: &'a [&'a [u8]],
    /// The file, read up to the line's last word.
    file: &'a Words<'a>,
}

impl Line<'_> {
    fn wrong(&self, problem: &str, remedy: &str) -> SceneError {
        SceneError::new(format!("{problem} in `{}`", self.file.shown_line()))
            .at_line(self.file.line())
            .with_remedy(remedy)
    }

    fn format(&self, name: &[u8], version: &[u8]) -> Result<Format, SceneError> {
        if version != b"1.0" {
            return Err(self.wrong("the version isn't 1.0", "export the mesh again"));
        }
        match name {
            b"ascii" => Ok(Format::Ascii),
            b"binary_little_endian" => Ok(Format::LittleEndian),
            b"binary_big_endian" => Ok(Format::BigEndian),
            _ => Err(self.wrong("unknown format", "known: ascii, binary_little_endian, binary_big_endian")),
        }
    }

    fn element(&self, name: &[u8], count: &[u8]) -> Result<Element, SceneError> {
        let count = std::str::from_utf8(count).ok().and_then(|count| count.parse().ok());
        let count = count.ok_or_else(|| self.wrong("the count is no whole number", "export the mesh again"))?;
        Ok(Element { name: lossy(name), count, properties: Vec::new() })
    }

    /// The property that the words after `property` declare.
    fn property(&self, words: &[&[u8]]) -> Result<Property, SceneError> {
        let property = match *words {
            [b"list", length, item, name] => {
                Property { name: lossy(name), of: self.type_of(item)?, length: Some(self.type_of(length)?) }
            }
            [number, name] if number != b"list" => {
                Property { name: lossy(name), of: self.type_of(number)?, length: None }
            }
            _ => {
                return Err(self.wrong(
                    "a property has a type and a name, or `list`, two types and a name",
                    "export the mesh again",
                ));
            }
        };
        if property.length.is_some_and(|length| length.range().is_none()) {
            return Err(self.wrong("the length of a list is no whole number", "export the mesh again"));
        }
        Ok(property)
    }

    fn type_of(&self, name: &[u8]) -> Result<Type, SceneError> {
        let known = Type::NAMES.iter().find(|(a, b, _)| [a, b].iter().any(|known| known.as_bytes() == name));
        known.map(|known| known.2).ok_or_else(|| {
            let names = Type::NAMES.map(|known| known.0).join(", ");
            self.wrong(&format!("unknown type `{}`", shown(name)), &format!("known: {names}"))
        })
    }
}

fn lossy(name: &[u8]) -> String {
    String::from_utf8_lossy(name).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<(Header, usize), SceneError> {
        let mut words = Words::new(text.as_bytes(), 1);
        Header::read(&mut words).map(|header| (header, text.len() - words.rest().len()))
    }

    const SOUND: &str = "ply \ncomment \u{e4} element\nformat binary_big_endian 1.0\nobj_info num_cols 5\n\nelement a 2\n\
                         property uint8 x\nproperty list uchar float64 y\nelement b 0\nend_header\n";

    #[test]
    fn elements_and_properties_arrive_whatever_ends_lines() {
        let property = |name: &str, of, length| Property { name: name.to_owned(), of, length };
        let a = vec![property("x", Type::UChar, None), property("y", Type::Double, Some(Type::UChar))];
        let elements = vec![
            Element { name: "a".to_owned(), count: 2, properties: a },
            Element { name: "b".to_owned(), count: 0, properties: Vec::new() },
        ];
        for ends in ["\n", "\r\n", "\r"] {
            let text = SOUND.replace('\n', ends);
            let expected = Header { format: Format::BigEndian, elements: elements.clone() };
            assert_eq!(read(&format!("{text}x")).unwrap(), (expected.clone(), text.len()));
            assert_eq!(read(&format!("{text}\n")).unwrap(), (expected, text.len()));
        }
    }

    #[test]
    fn mistakes_are_named_with_their_lines() {
        for (from, to, line, part) in [
            ("ply ", "plyx", 1, "begin"),
            ("obj_info", "object", 4, "not understood"),
            ("uint8 x", "int64 x", 7, "unknown type `int64`"),
            ("list uchar", "list float", 8, "length"),
            ("list uchar", "list", 8, "`list`"),
            ("element a 2", "element a -2", 6, "whole number"),
            ("element a 2", "element a 2 3", 6, "not understood"),
            ("element a 2", "element a 99999999999999999999", 6, "whole number"),
            ("element a 2\n", "", 6, "before any element"),
            ("float64 y", "float64 x", 8, "twice"),
            ("1.0", "2.0", 3, "1.0"),
            ("binary_big", "binary_middle", 3, "ascii"),
            ("end_header\n", "", 9, "within its header"),
        ] {
            let error = read(&SOUND.replacen(from, to, 1)).unwrap_err();
            assert!(error.line == Some(line) && error.to_string().contains(part), "{to:?}: {error:?}");
        }
        let error = read(&SOUND.replacen("format", "comment", 1)).unwrap_err();
        assert!(error.problem.contains("`format`"), "{error}");
    }
}
