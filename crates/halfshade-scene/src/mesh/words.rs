//! Lines and words of the text formats: what ends a line, what parts words, what is a number.

use std::str::FromStr;

/// A walk through a text, word by word within a line. Lines end with a line feed, a carriage return, or both.
#[derive(Debug, Clone)]
pub(super) struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
}

impl<'a> Words<'a> {
    /// At the start of the first line, which has this number.
    pub(super) fn new(bytes: &'a [u8], line: usize) -> Self {
        Self { bytes, at: 0, line }
    }

    /// The number of the line.
    pub(super) fn line(&self) -> usize {
        self.line
    }

    /// Bytes still to be read.
    pub(super) fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    /// Whether the text is at its end.
    pub(super) fn is_at_end(&self) -> bool {
        self.at == self.bytes.len()
    }

    /// The next word of the line; `None` at its end.
    pub(super) fn word(&mut self) -> Option<&'a [u8]> {
        self.skip_while(is_blank);
        let first = self.at;
        self.skip_while(|byte| !is_blank(byte) && !ends_line(byte));
        (self.at > first).then(|| &self.bytes[first..self.at])
    }

    /// The next word of a line of numbers in which `#` begins a comment and a backslash before the end of a line joins it
    /// with the next one; `None` at its end.
    pub(super) fn continued_word(&mut self) -> Option<&'a [u8]> {
        loop {
            self.skip_while(is_blank);
            let first = self.at;
            self.skip_while(|byte| !is_blank(byte) && !ends_line(byte) && byte != b'#' && byte != b'\\');
            match self.bytes.get(self.at) {
                Some(b'\\') if !self.at_last_backslash() => {
                    self.skip_while(|byte| !is_blank(byte) && !ends_line(byte));
                }
                Some(b'\\') if self.at == first => {
                    self.next_line();
                    continue;
                }
                Some(b'#') if self.at == first => return None,
                // `1.#IND` and its like are words, not the number 1 and a comment.
                Some(b'#') if self.bytes[first..self.at].ends_with(b"1.") && self.at_c_spelling() => {
                    self.skip_while(|byte| !is_blank(byte) && !ends_line(byte));
                }
                _ => {}
            }
            return (self.at > first).then(|| &self.bytes[first..self.at]);
        }
    }

    /// Goes to the start of the next line.
    pub(super) fn next_line(&mut self) {
        self.next_line_where(false);
    }

    /// Goes to the start of the next line; where carriage returns end lines alone, a line feed after one belongs to it.
    pub(super) fn next_line_where(&mut self, returns_stand_alone: bool) {
        self.skip_while(|byte| !ends_line(byte));
        let is_pair = !returns_stand_alone && self.rest().starts_with(b"\r\n");
        self.at += if is_pair { 2 } else { self.rest().len().min(1) };
        self.line += 1;
    }

    /// Whether the line, at whose end the walk is, ends with a carriage return alone.
    pub(super) fn is_at_return_alone(&self) -> bool {
        self.rest().starts_with(b"\r") && !self.rest().starts_with(b"\r\n")
    }

    /// Goes to the start of the next line that this one doesn't go on with. Only a backslash that stands alone joins
    /// lines of names: one at the end of a name may be part of it.
    pub(super) fn next_line_after_names(&mut self) {
        loop {
            let first = self.at;
            self.skip_while(|byte| !ends_line(byte));
            let goes_on = match &self.bytes[first..self.at] {
                [.., before, b'\\'] => is_blank(*before),
                _ => false,
            };
            self.next_line();
            if !goes_on {
                return;
            }
        }
    }

    /// The whole line, as far as it fits a message.
    pub(super) fn shown_line(&self) -> String {
        let first = self.bytes[..self.at].iter().rposition(|&byte| ends_line(byte)).map_or(0, |place| place + 1);
        let length = self.bytes[first..].iter().position(|&byte| ends_line(byte));
        shown(&self.bytes[first..length.map_or(self.bytes.len(), |length| first + length)])
    }

    /// Whether what follows the `#` is what C libraries of old print for what is no number.
    fn at_c_spelling(&self) -> bool {
        [&b"#IN"[..], b"#QNAN", b"#SNAN", b"#NAN"].iter().any(|spelling| self.rest().starts_with(spelling))
    }

    fn at_last_backslash(&self) -> bool {
        let after = self.bytes[self.at + 1..].iter().find(|&&byte| !is_blank(byte));
        after.is_none_or(|&byte| ends_line(byte))
    }

    fn skip_while(&mut self, test: impl Fn(u8) -> bool) {
        let rest = &self.bytes[self.at..];
        self.at += rest.iter().position(|&byte| !test(byte)).unwrap_or(rest.len());
    }
}

fn ends_line(byte: u8) -> bool {
    matches!(byte, b'\n' | b'\r')
}

/// Space, tab, and the control characters that editors of old have left, but zero.
fn is_blank(byte: u8) -> bool {
    matches!(byte, 1..=b' ') && !ends_line(byte)
}

/// A number, decimal, as C and most languages print it. Words that C libraries print where there is none, such as
/// `-nan(ind)` or `1.#IND`, are NaN.
pub(super) fn number<T: FromStr + From<f32>>(word: &[u8]) -> Option<T> {
    if let Some(number) = std::str::from_utf8(word).ok().and_then(|text| text.parse().ok()) {
        return Some(number);
    }
    let unsigned = word.strip_prefix(b"-").or(word.strip_prefix(b"+")).unwrap_or(word);
    let starts_with = |what: &[u8]| unsigned.get(..what.len()).is_some_and(|start| start.eq_ignore_ascii_case(what));
    (starts_with(b"nan(") || starts_with(b"1.#")).then(|| T::from(f32::NAN))
}

/// Remedy for a word that is no number.
pub(super) fn remedy_for(word: &[u8]) -> &'static str {
    if word.contains(&b',') {
        "write numbers with a decimal point and blanks between them, without commas"
    } else {
        "repair the line, or export the mesh again"
    }
}

/// A piece of a file that fits a message.
pub(super) fn shown(bytes: &[u8]) -> String {
    const LONGEST: usize = 60;
    // A character has at most four bytes.
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(4 * LONGEST + 4)]);
    let text: String = text.trim().chars().map(|c| if c.is_control() && c != '\t' { '\u{fffd}' } else { c }).collect();
    if text.chars().count() <= LONGEST { text } else { text.chars().take(LONGEST - 3).collect::<String>() + "..." }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_line_ends_part_lines_and_are_counted() {
        let mut words = Words::new(b"a b\n\rc\r\n\r\nd\re", 1);
        let mut found = Vec::new();
        while !words.is_at_end() {
            while let Some(word) = words.word() {
                found.push((words.line(), word[0]));
            }
            words.next_line();
        }
        assert_eq!(found, [(1, b'a'), (1, b'b'), (3, b'c'), (5, b'd'), (6, b'e')]);
    }

    #[test]
    fn lines_go_on_after_a_backslash_and_end_at_a_comment() {
        let mut words = Words::new(b"f 1\\ 2 \\ \r\n 3\\\n4#5 \\\n6", 1);
        let line: Vec<_> = std::iter::from_fn(|| words.continued_word()).collect();
        assert_eq!((line, words.line()), (vec![&b"f"[..], b"1\\", b"2", b"3", b"4"], 3));
        words.next_line();
        assert_eq!((words.continued_word(), words.line()), (Some(&b"6"[..]), 4));
        let mut end = Words::new(b"f \\", 1);
        assert_eq!((end.continued_word(), end.continued_word()), (Some(&b"f"[..]), None));
    }

    #[test]
    fn names_may_end_in_a_backslash() {
        let after = |text: &'static str| {
            let mut words = Words::new(text.as_bytes(), 1);
            words.next_line_after_names();
            (words.word(), words.line())
        };
        assert_eq!(after("mtllib C:\\a\\\nv"), (Some(&b"v"[..]), 2));
        assert_eq!(after("g a \\\n b \\\r\nc\nv"), (Some(&b"v"[..]), 4));
    }

    #[test]
    fn numbers_of_many_spellings() {
        for (word, value) in
            [("+.5", 0.5), ("1.", 1.0), ("1e5", 1e5), ("-1E-3", -1e-3), ("-0", 0.0), ("inf", f32::INFINITY)]
        {
            assert_eq!(number::<f32>(word.as_bytes()), Some(value), "{word}");
        }
        for word in ["nan", "-nan", "NaN", "-nan(ind)", "1.#IND", "-1.#QNAN", "+1.#INF00"] {
            assert!(number::<f32>(word.as_bytes()).unwrap().is_nan(), "{word}");
        }
        for word in ["1,5", "0x10", "1f", "", "-", "1..2", "1e", "1.0.0", "\u{ff11}", "1_000"] {
            assert!(number::<f64>(word.as_bytes()).is_none(), "{word}");
        }
    }

    #[test]
    fn messages_stay_short() {
        assert_eq!(shown(b" a\tb "), "a\tb");
        assert_eq!(shown(&[0xff; 9000]).chars().count(), 60);
        assert_eq!(Words::new(b"a\nbc", 1).shown_line(), "a");
    }
}
