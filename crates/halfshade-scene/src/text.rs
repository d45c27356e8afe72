//! Text files: UTF-8, with or without a byte-order mark; and how mistakes in them are shown.

mod excerpt;
mod unknown;

pub use excerpt::Excerpt;
pub use unknown::{did_you_mean, unknown};

use crate::{SceneError, input};
use std::path::Path;

/// The UTF-8 byte-order mark.
pub const MARK: &[u8] = b"\xef\xbb\xbf";

/// A TOML file as a whole, lines ending in line feeds, whatever ended them. Errors name the file.
pub fn read(path: &Path) -> Result<String, SceneError> {
    let bytes = input::read(path).map_err(|error| SceneError::new(format!("cannot be read: {error}")).in_file(path))?;
    decode(&bytes).map(with_line_feeds).map_err(|error| error.in_file(path))
}

/// The text with carriage returns that end lines by themselves as line feeds: TOML has no such line ends.
fn with_line_feeds(text: &str) -> String {
    text.replace("\r\n", "\n").replace('\r', "\n")
}

/// Bytes as text, without a byte-order mark.
pub fn decode(bytes: &[u8]) -> Result<&str, SceneError> {
    let bytes = without_mark(bytes)?;
    std::str::from_utf8(bytes).map_err(|error| {
        let line = 1 + with_line_feeds(&String::from_utf8_lossy(&bytes[..error.valid_up_to()])).matches('\n').count();
        SceneError::new("the file is not UTF-8 text").at_line(line).with_remedy("save it as UTF-8")
    })
}

/// The bytes of a text file without a byte-order mark, for formats in which only names and comments may be other than
/// ASCII. UTF-16 and UTF-32 are refused: marked, or told by the zero bytes beside the first characters, which are ASCII
/// in every format that is read.
pub fn without_mark(bytes: &[u8]) -> Result<&[u8], SceneError> {
    if let Some(rest) = bytes.strip_prefix(MARK) {
        return Ok(rest);
    }
    let is_zero = |place: usize| bytes.get(place).map(|&byte| byte == 0);
    let encoding = match bytes {
        [0xff, 0xfe, 0, 0, ..] | [0, 0, 0xfe, 0xff, ..] => "UTF-32",
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => "UTF-16",
        _ => match [0, 1, 2, 3].map(is_zero) {
            [Some(true), Some(true), Some(true), Some(false)] | [Some(false), Some(true), Some(true), Some(true)] => {
                "UTF-32"
            }
            [Some(true), Some(false), Some(true) | None, Some(false) | None]
            | [Some(false), Some(true), Some(false) | None, Some(true) | None] => "UTF-16",
            _ => return Ok(bytes),
        },
    };
    Err(SceneError::new(format!("the file is text in {encoding}")).with_remedy("save it as UTF-8"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mark_is_no_text() {
        assert_eq!(decode(b"\xef\xbb\xbfname = 1").unwrap(), "name = 1");
        assert_eq!((decode(b"").unwrap(), decode(MARK).unwrap(), decode("ä".as_bytes()).unwrap()), ("", "", "ä"));
    }

    #[test]
    fn lines_of_a_file_end_in_line_feeds_whatever_ended_them() {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), "a = 1\rb = 2\r\n\r\rc = 3\n\rd = 4").unwrap();
        assert_eq!(read(file.path()).unwrap(), "a = 1\nb = 2\n\n\nc = 3\n\nd = 4");
    }

    #[test]
    fn other_encodings_are_named_with_what_to_do() {
        let wide = |text: &str, big: bool| -> Vec<u8> {
            text.encode_utf16().flat_map(|unit| if big { unit.to_be_bytes() } else { unit.to_le_bytes() }).collect()
        };
        let wider = |text: &str, big: bool| -> Vec<u8> {
            let bytes = |c: char| if big { u32::from(c).to_be_bytes() } else { u32::from(c).to_le_bytes() };
            text.chars().flat_map(bytes).collect()
        };
        for text in ["v 0 0 0\n", "# ü\n", "ply\n", "\u{feff}name = \"日本\"\n", "\u{feff}日本", "v"] {
            for big in [false, true] {
                let error = decode(&wide(text, big)).unwrap_err().to_string();
                assert!(error.contains("UTF-16") && error.contains("save it as UTF-8"), "{text:?}: {error}");
                let error = decode(&wider(text, big)).unwrap_err().to_string();
                assert!(error.contains("UTF-32"), "{text:?}: {error}");
            }
        }
        let latin = decode(b"a\nname = \"\xe4\"\n").unwrap_err();
        assert!(latin.line == Some(2) && latin.problem.contains("UTF-8"), "{latin}");
        assert_eq!(decode(b"a\r\nb\rname = \"\xe4\"\r").unwrap_err().line, Some(3));
    }
}
