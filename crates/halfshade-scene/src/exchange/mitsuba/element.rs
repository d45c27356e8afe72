//! Elements of a scene file: what they say, with the lines where they say it.

use crate::SceneError;
use crate::exchange::assembly::rotation;
use crate::exchange::words::{numbers, triple};
use glam::{DMat4, DVec3, DVec4, Vec3};
use roxmltree::Node;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;

type Result<T> = std::result::Result<T, SceneError>;

/// A document, and what its elements may refer to.
pub(super) struct Elements<'a, 'input> {
    pub(super) path: &'a Path,
    /// Values of `$name`.
    pub(super) defaults: BTreeMap<String, String>,
    /// Elements by their `id`.
    pub(super) ids: BTreeMap<&'a str, Node<'a, 'input>>,
}

/// A transform, and the point that a camera looks at if it says so.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Transform {
    pub(super) matrix: DMat4,
    pub(super) target: Option<DVec3>,
}

/// The line of an element.
pub(super) fn line(node: Node<'_, '_>) -> usize {
    node.document().text_pos_at(node.range().start).row as usize
}

/// Names of older versions, which have capitals, as newer ones write them.
fn snake(name: &str) -> String {
    let mut snake = String::with_capacity(name.len() + 4);
    for c in name.chars() {
        if c.is_ascii_uppercase() {
            snake.push('_');
        }
        snake.push(c.to_ascii_lowercase());
    }
    snake
}

impl<'a, 'input> Elements<'a, 'input> {
    pub(super) fn error(&self, node: Node<'_, '_>, problem: impl Into<String>) -> SceneError {
        SceneError::new(problem).in_file(self.path).at_line(line(node))
    }

    /// An attribute, with `$name` replaced.
    pub(super) fn attribute<'n>(&'n self, node: Node<'n, '_>, name: &str) -> Option<Cow<'n, str>> {
        let text = node.attribute(name)?;
        if !text.contains('$') {
            return Some(Cow::Borrowed(text));
        }
        let mut pieces = text.split('$');
        let mut replaced = pieces.next().unwrap_or_default().to_owned();
        for piece in pieces {
            let end = piece.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(piece.len());
            match self.defaults.get(&piece[..end]) {
                Some(value) => replaced.extend([value.as_str(), &piece[end..]]),
                None => replaced.extend(["$", piece]),
            }
        }
        Some(Cow::Owned(replaced))
    }

    /// The `type` of an element.
    pub(super) fn kind<'n>(&'n self, node: Node<'n, '_>) -> Cow<'n, str> {
        self.attribute(node, "type").unwrap_or_default()
    }

    /// The element that gives a value its name, by the name of newer versions.
    pub(super) fn property(&self, node: Node<'a, 'input>, name: &str) -> Option<Node<'a, 'input>> {
        node.children().find(|child| child.attribute("name").is_some_and(|found| snake(found) == name))
    }

    /// The element of a tag within another, or the one that a `ref` there stands for.
    pub(super) fn child(&self, node: Node<'a, 'input>, tag: &str) -> Option<Node<'a, 'input>> {
        node.children().find_map(|child| self.resolved(child).filter(|found| found.has_tag_name(tag)))
    }

    /// An element, or what it refers to.
    pub(super) fn resolved(&self, node: Node<'a, 'input>) -> Option<Node<'a, 'input>> {
        match node.has_tag_name("ref") {
            true => self.ids.get(node.attribute("id")?).copied(),
            false => Some(node),
        }
    }

    pub(super) fn text(&self, node: Node<'a, 'input>, name: &str) -> Option<String> {
        Some(self.attribute(self.property(node, name)?, "value")?.trim().to_owned())
    }

    pub(super) fn flag(&self, node: Node<'a, 'input>, name: &str) -> Option<bool> {
        Some(self.text(node, name)?.eq_ignore_ascii_case("true"))
    }

    pub(super) fn number(&self, node: Node<'a, 'input>, name: &str) -> Result<Option<f64>> {
        self.property(node, name).map(|found| self.number_of(found, "value")).transpose()
    }

    fn number_of(&self, node: Node<'a, 'input>, name: &str) -> Result<f64> {
        let text = self.attribute(node, name).unwrap_or_default();
        match numbers(&text).as_deref() {
            Some([number]) => Ok(*number),
            _ => Err(self.error(node, format!("{name} = `{}` is no finite number", text.escape_debug()))),
        }
    }

    /// A colour that a property gives by itself: not by a texture.
    pub(super) fn color(&self, node: Node<'a, 'input>, name: &str) -> Result<Option<Vec3>> {
        let Some(found) = self.property(node, name).filter(|found| !found.has_tag_name("texture")) else {
            return Ok(None);
        };
        let text = self.attribute(found, "value").unwrap_or_default();
        let color = hexadecimal(&text).or_else(|| triple(&text));
        color.map(|color| Some(color.as_vec3())).ok_or_else(|| {
            self.error(found, format!("`{}` is no colour that is read", text.escape_debug()))
                .with_remedy("give one number, or red, green and blue, linear, or #rrggbb")
        })
    }

    /// A point or vector, of which coordinates may be missing.
    pub(super) fn vector(&self, node: Node<'a, 'input>, default: f64) -> Result<DVec3> {
        if let Some(text) = self.attribute(node, "value") {
            let wrong = || self.error(node, format!("`{}` is no vector", text.escape_debug()));
            return triple(&text).ok_or_else(wrong);
        }
        let axis = |name: &str| match node.has_attribute(name) {
            true => self.number_of(node, name),
            false => Ok(default),
        };
        Ok(DVec3::new(axis("x")?, axis("y")?, axis("z")?))
    }

    /// The transform of a name; the identity where there is none.
    pub(super) fn transform(&self, node: Node<'a, 'input>, name: &str) -> Result<Transform> {
        let mut transform = Transform { matrix: DMat4::IDENTITY, target: None };
        for step in self.property(node, name).iter().flat_map(Node::children).filter(Node::is_element) {
            let next = match step.tag_name().name() {
                "translate" => DMat4::from_translation(self.vector(step, 0.0)?),
                "scale" => DMat4::from_scale(self.vector(step, 1.0)?),
                "rotate" => rotation(self.vector(step, 0.0)?, self.number_of(step, "angle")?)
                    .ok_or_else(|| self.error(step, "the axis of a rotation is zero"))?,
                "matrix" => self.matrix(step)?,
                "lookat" | "look_at" | "lookAt" => {
                    let (matrix, target) = self.look_at(step)?;
                    transform.target = Some(target);
                    matrix
                }
                other => return Err(self.error(step, format!("`{other}` is no transform that is read"))),
            };
            transform.matrix = next * transform.matrix;
            if !step.tag_name().name().starts_with("look") {
                transform.target = transform.target.map(|target| next.transform_point3(target));
            }
        }
        Ok(transform)
    }

    fn matrix(&self, node: Node<'a, 'input>) -> Result<DMat4> {
        let text = self.attribute(node, "value").unwrap_or_default();
        let row = |n: &[f64]| DVec4::from_slice(n);
        match numbers(&text).as_deref() {
            Some(n) if n.len() == 16 => {
                Ok(DMat4::from_cols(row(n), row(&n[4..]), row(&n[8..]), row(&n[12..])).transpose())
            }
            Some(n) if n.len() == 9 => Ok(DMat4::from_mat3(glam::DMat3::from_cols_slice(n).transpose())),
            _ => Err(self.error(node, "a matrix has 9 or 16 finite numbers, row by row")),
        }
    }

    /// Axes to the left, up and forward, as Mitsuba's cameras have them.
    fn look_at(&self, node: Node<'a, 'input>) -> Result<(DMat4, DVec3)> {
        let point = |name: &str| {
            let text = self.attribute(node, name).unwrap_or_default();
            triple(&text).ok_or_else(|| self.error(node, format!("{name} = `{}` is no point", text.escape_debug())))
        };
        let (origin, target) = (point("origin")?, point("target")?);
        let up = if node.has_attribute("up") { point("up")? } else { DVec3::Y };
        let forward = (target - origin).try_normalize();
        let left = forward.and_then(|forward| up.cross(forward).try_normalize());
        let (Some(forward), Some(left)) = (forward, left) else {
            return Err(self.error(node, "it looks nowhere, or along its own up"));
        };
        let matrix = DMat4::from_cols(
            left.extend(0.0),
            forward.cross(left).extend(0.0),
            forward.extend(0.0),
            origin.extend(1.0),
        );
        Ok((matrix, target))
    }
}

/// A colour in hexadecimal digits, which is sRGB.
fn hexadecimal(text: &str) -> Option<DVec3> {
    let digits = text.trim().strip_prefix('#').filter(|digits| digits.len() == 6 && digits.is_ascii())?;
    let channel = |first: usize| u8::from_str_radix(&digits[first..first + 2], 16).ok();
    let linear = |code: u8| crate::texture::linear_from_srgb(f64::from(code) / 255.0);
    Some(DVec3::new(linear(channel(0)?), linear(channel(2)?), linear(channel(4)?)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_older_versions_and_colours() {
        assert_eq!((snake("toWorld"), snake("fov_axis")), ("to_world".to_owned(), "fov_axis".to_owned()));
        assert_eq!(hexadecimal("#ff00ff"), Some(DVec3::new(1.0, 0.0, 1.0)));
        assert_eq!((hexadecimal("#ff00f"), hexadecimal("#ff00fé"), hexadecimal("ff00ff")), (None, None, None));
    }
}
