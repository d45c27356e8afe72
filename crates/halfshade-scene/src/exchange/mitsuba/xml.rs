//! XML text, indented.

use glam::Vec3;

/// A document that grows.
#[derive(Debug)]
pub(super) struct Xml {
    text: String,
    depth: usize,
}

impl Xml {
    pub(super) fn new() -> Self {
        Self { text: "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n".to_owned(), depth: 0 }
    }

    /// An element, and in it what `content` writes.
    pub(super) fn element(&mut self, tag: &str, attributes: &[(&str, &str)], content: impl FnOnce(&mut Self)) {
        self.tag(tag, attributes, ">");
        self.depth += 1;
        content(self);
        self.depth -= 1;
        self.indent();
        self.text += &format!("</{tag}>\n");
    }

    /// An element without content.
    pub(super) fn leaf(&mut self, tag: &str, attributes: &[(&str, &str)]) {
        self.tag(tag, attributes, "/>");
    }

    /// A value with a name.
    pub(super) fn value(&mut self, kind: &str, name: &str, value: &str) {
        self.leaf(kind, &[("name", name), ("value", value)]);
    }

    /// A point or a vector with a name.
    pub(super) fn vector(&mut self, kind: &str, name: &str, v: Vec3) {
        let [x, y, z] = v.to_array().map(|component| component.to_string());
        self.leaf(kind, &[("name", name), ("x", &x), ("y", &y), ("z", &z)]);
    }

    fn tag(&mut self, tag: &str, attributes: &[(&str, &str)], end: &str) {
        self.indent();
        self.text += &format!("<{tag}");
        for (name, value) in attributes {
            self.text += &format!(" {name}=\"{}\"", escaped(value));
        }
        self.text += &format!("{end}\n");
    }

    fn indent(&mut self) {
        self.text.extend(std::iter::repeat_n("    ", self.depth));
    }

    pub(super) fn into_bytes(self) -> Vec<u8> {
        self.text.into_bytes()
    }
}

/// Three numbers as Mitsuba writes them.
pub(super) fn triple(v: Vec3) -> String {
    format!("{}, {}, {}", v.x, v.y, v.z)
}

/// The value of an attribute: neither marks nor characters that XML forbids.
fn escaped(text: &str) -> String {
    text.chars()
        .map(|c| match c {
            '&' => "&amp;".to_owned(),
            '<' => "&lt;".to_owned(),
            '>' => "&gt;".to_owned(),
            '"' => "&quot;".to_owned(),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => "?".to_owned(),
            c => c.to_string(),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_nest_and_marks_are_escaped() {
        let mut xml = Xml::new();
        xml.element("a", &[("name", "<\"&\u{1}>")], |xml| xml.value("float", "b", "0.1"));
        let expected = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<a name=\"&lt;&quot;&amp;?&gt;\">\n    <float name=\"b\" \
                        value=\"0.1\"/>\n</a>\n";
        assert_eq!(String::from_utf8(xml.into_bytes()).unwrap(), expected);
    }
}
