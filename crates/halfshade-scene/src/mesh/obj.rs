//! Wavefront OBJ.
//!
//! Geometry is read: positions (`v`, with colours where a line has six numbers), normals, texture coordinates and faces.
//! Names, groups, materials and hints for display are passed over. Other elements of the format, points, lines and
//! free-form surfaces among them, are left out with a note. An unknown line is an error if it has any digit: it may be
//! geometry in disguise. Texture coordinates count only where every corner has some.

use super::assemble::{LARGEST_COORDINATE, RawMesh};
use super::colors::{ColorEncoding, ColorNumbers, FileColors};
use super::corners::{Corner, Corners};
use super::polygon::Cutter;
use super::words::{Words, number, remedy_for, shown};
use crate::{SceneError, text};
use glam::Vec3;
use std::collections::BTreeMap;

/// Statements without any effect on the surface: names, groups, materials, display, and what belongs to statements of
/// [`LEFT_OUT`] and means nothing without them.
const PASSED_OVER: &[&str] = &[
    "o",
    "g",
    "s",
    "mg",
    "usemtl",
    "mtllib",
    "usemap",
    "maplib",
    "bevel",
    "c_interp",
    "d_interp",
    "shadow_obj",
    "trace_obj",
    "ctech",
    "stech",
    "vp",
    "cstype",
    "deg",
    "bmat",
    "step",
    "parm",
    "trim",
    "hole",
    "scrv",
    "sp",
    "end",
    "con",
    "res",
];

/// Statements with geometry, or with a say in which geometry there is, that isn't read.
const LEFT_OUT: &[&str] = &["p", "l", "curv", "curv2", "surf", "bsp", "bzp", "cdc", "cdp", "lod", "call", "csh"];

/// Most of anything that indices can number.
const MOST: usize = u32::MAX as usize - 1;

pub(super) fn parse(bytes: &[u8], told: Option<ColorEncoding>) -> Result<RawMesh, SceneError> {
    let bytes = text::without_mark(bytes)?;
    let mut reader = Reader::new(bytes);
    while !reader.words.is_at_end() {
        reader.statement()?;
    }
    reader.check_indices()?;
    reader.check_end(bytes)?;
    reader.into_mesh(told)
}

/// The file's elements read so far.
struct Reader<'a> {
    words: Words<'a>,
    positions: Vec<Vec3>,
    /// Line of each position; empty without colours, which alone may be found wrong later.
    lines: Vec<usize>,
    /// Empty, or one per position.
    colors: Vec<Option<Vec3>>,
    normals: Vec<Vec3>,
    coordinates: Vec<[f32; 2]>,
    corners: Vec<Corner>,
    /// End of each face's corners.
    ends: Vec<usize>,
    /// The largest index of a position, a texture coordinate, a normal, each with its line: indices may name what comes
    /// later in the file.
    largest: [(i64, usize); 3],
    /// Normals without a direction, vertex colours with alpha, statements left out: how many, and the first one's line.
    noticed: BTreeMap<String, (usize, usize)>,
}

impl<'a> Reader<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Self {
            words: Words::new(bytes, 1),
            positions: Vec::new(),
            lines: Vec::new(),
            colors: Vec::new(),
            normals: Vec::new(),
            coordinates: Vec::new(),
            corners: Vec::new(),
            ends: Vec::new(),
            largest: [(0, 0); 3],
            noticed: BTreeMap::new(),
        }
    }

    /// Reads a statement and goes to the start of the next one.
    fn statement(&mut self) -> Result<(), SceneError> {
        let Some(mut keyword) = self.words.continued_word() else {
            self.words.next_line();
            return Ok(());
        };
        // A file may be several that were joined.
        if let Some(rest) = keyword.strip_prefix(text::MARK) {
            keyword = rest;
        }
        match keyword {
            b"v" => self.position()?,
            b"vn" => self.normal()?,
            b"vt" => self.coordinate()?,
            b"f" | b"fo" => self.face()?,
            b"" => {}
            _ => return self.other(keyword),
        }
        self.words.next_line();
        Ok(())
    }

    fn position(&mut self) -> Result<(), SceneError> {
        // x, y, z and w, or x, y, z, colour and perhaps alpha.
        let (values, count) = self.numbers::<7>(&["x", "y", "z", "a value", "a value", "a value", "a value"], 3)?;
        let position = Vec3::from_slice(&values);
        if !position.is_finite() {
            let axis = ["x", "y", "z"][(0..3).find(|&axis| !position[axis].is_finite()).unwrap_or(0)];
            return Err(self.wrong(format!("{axis} is not a finite number")));
        }
        if position.abs().max_element() > LARGEST_COORDINATE {
            return Err(self.wrong("the vertex lies too far out to compute with".to_owned()));
        }
        match count {
            4 if values[3] != 1.0 => {
                return Err(self
                    .wrong("the vertex has a weight (a fourth number) other than 1".to_owned())
                    .with_remedy("programs read it in different ways: export three coordinates"));
            }
            5 => {
                return Err(self.wrong("the vertex has five numbers".to_owned()).with_remedy(
                    "a vertex has three coordinates, and perhaps a weight of 1, or a colour of three numbers",
                ));
            }
            6.. => {
                self.colors.resize(self.positions.len(), None);
                self.lines.resize(self.positions.len(), 0);
                self.colors.push(Some(Vec3::from_slice(&values[3..])));
                self.lines.push(self.words.line());
                if count == 7 && values[6] != 1.0 {
                    self.notice("alpha of vertex colours left out, every vertex is opaque");
                }
            }
            _ => {}
        }
        self.positions.push(position);
        self.check_count(self.positions.len())
    }

    fn normal(&mut self) -> Result<(), SceneError> {
        let (values, _) = self.numbers::<3>(&["x", "y", "z"], 3)?;
        let mut normal = Vec3::from(values);
        if !normal.is_finite() || normal == Vec3::ZERO {
            self.notice("normals that are no directions, computed instead");
            normal = Vec3::ZERO;
        }
        self.normals.push(normal);
        self.check_count(self.normals.len())
    }

    fn coordinate(&mut self) -> Result<(), SceneError> {
        // u along a line, u and v of a picture, or u, v, w of a solid texture.
        let (values, count) = self.numbers::<3>(&["u", "v", "w"], 1)?;
        if let Some(axis) = (0..count.min(2)).find(|&axis| !values[axis].is_finite()) {
            return Err(self.wrong(format!("{} is not a finite number", ["u", "v"][axis])));
        }
        self.coordinates.push([values[0], values[1]]);
        self.check_count(self.coordinates.len())
    }

    fn face(&mut self) -> Result<(), SceneError> {
        let first = self.corners.len();
        while let Some(word) = self.words.continued_word() {
            let corner = self.corner(word)?;
            self.corners.push(corner);
        }
        let count = self.corners.len() - first;
        if count < 3 {
            return Err(self.wrong(format!("a face needs three corners, this one has {count}")));
        }
        self.ends.push(self.corners.len());
        Ok(())
    }

    /// A corner: `position`, `position/coordinate`, `position//normal` or `position/coordinate/normal`.
    fn corner(&mut self, word: &[u8]) -> Result<Corner, SceneError> {
        let counts = [self.positions.len(), self.coordinates.len(), self.normals.len()];
        let mut named = [0; 3];
        for (place, part) in word.split(|&byte| byte == b'/').enumerate() {
            if place == 3 || (place == 0 && part.is_empty()) {
                return Err(self.no_corner(word));
            }
            if part.is_empty() {
                continue;
            }
            let index = whole(part).ok_or_else(|| self.no_corner(word))?;
            // Negative ones count back from the last one read.
            let index = if index < 0 { counts[place] as i64 + 1 + index.max(-i64::MAX / 2) } else { index };
            if index <= 0 {
                let problem = format!("`{}` names a vertex before the first", shown(word));
                return Err(self.wrong(problem).with_remedy("indices count from 1"));
            }
            // A larger index can't exist, and is told so at the end.
            named[place] = u32::try_from(index).unwrap_or(u32::MAX);
            if index > self.largest[place].0 {
                self.largest[place] = (index, self.words.line());
            }
        }
        Ok(Corner { position: named[0], coordinate: named[1], normal: named[2] })
    }

    fn no_corner(&self, word: &[u8]) -> SceneError {
        let problem = format!("`{}` is no corner of a face", shown(word));
        self.wrong(problem).with_remedy("a corner is position/texture/normal, whole numbers that count from 1")
    }

    /// A statement of another kind.
    fn other(&mut self, keyword: &[u8]) -> Result<(), SceneError> {
        let is_in = |list: &[&str]| list.iter().any(|known| known.as_bytes() == keyword);
        if is_in(LEFT_OUT) {
            let name = shown(keyword);
            self.notice(&format!("`{name}` left out, only faces are read"));
        } else if !is_in(PASSED_OVER) {
            let mut is_prose = true;
            let mut next = Some(keyword);
            while let Some(word) = next {
                is_prose &= !word.iter().any(u8::is_ascii_digit);
                next = self.words.continued_word();
            }
            if !is_prose {
                let problem = format!("`{}` is no word of the OBJ format, and may be geometry", shown(keyword));
                return Err(self
                    .wrong(problem)
                    .with_remedy("statements are in lower case, such as `v` and `f`, and comments begin with #"));
            }
            self.notice("lines without any number not understood, left out");
        }
        self.words.next_line_after_names();
        Ok(())
    }

    /// The numbers of the statement, at least `needed` and at most N, and how many there were; the others are 0.
    fn numbers<const N: usize>(&mut self, names: &[&str; N], needed: usize) -> Result<([f32; N], usize), SceneError> {
        let mut values = [0.0; N];
        let mut count = 0;
        while let Some(word) = self.words.continued_word() {
            if count == N {
                return Err(self
                    .wrong(format!("`{}` is one number too many", shown(word)))
                    .with_remedy(remedy_for(word)));
            }
            values[count] = number(word).ok_or_else(|| {
                let problem = format!("{} is not a finite number, but `{}`", names[count], shown(word));
                self.wrong(problem).with_remedy(remedy_for(word))
            })?;
            count += 1;
        }
        if count < needed {
            return Err(self.wrong(format!("{} is missing", names[count])));
        }
        Ok((values, count))
    }

    /// An error at the line, which is shown.
    fn wrong(&self, problem: String) -> SceneError {
        SceneError::new(format!("{problem} in `{}`", self.words.shown_line()))
            .at_line(self.words.line())
            .with_remedy("repair the line, or export the mesh again")
    }

    fn notice(&mut self, what: &str) {
        let line = self.words.line();
        match self.noticed.get_mut(what) {
            Some((count, _)) => *count += 1,
            None => {
                self.noticed.insert(what.to_owned(), (1, line));
            }
        }
    }

    fn check_count(&self, count: usize) -> Result<(), SceneError> {
        if count > MOST {
            return Err(SceneError::new(format!("the file has more than {MOST} vertices")).at_line(self.words.line()));
        }
        Ok(())
    }

    /// Whether everything that faces name is there.
    fn check_indices(&self) -> Result<(), SceneError> {
        let counts = [self.positions.len(), self.coordinates.len(), self.normals.len()];
        let names = ["vertex", "texture coordinate", "normal"];
        for (((index, line), count), name) in self.largest.into_iter().zip(counts).zip(names) {
            if index > count as i64 {
                return Err(SceneError::new(format!("{name} {index} is named, but there are only {count}"))
                    .at_line(line)
                    .with_remedy("is the file complete?"));
            }
        }
        Ok(())
    }

    /// Whether the file is one, and whole as far as can be told.
    fn check_end(&self, bytes: &[u8]) -> Result<(), SceneError> {
        if self.ends.is_empty() {
            let left_out: Vec<_> = self.noticed.keys().map(String::as_str).collect();
            let remedy = if left_out.is_empty() {
                "is the file complete?".to_owned()
            } else {
                format!("export polygons; the file has: {}", left_out.join("; "))
            };
            return Err(SceneError::new("the mesh has no triangles").with_remedy(remedy));
        }
        if bytes.ends_with(b"\n") || bytes.ends_with(b"\r") {
            return Ok(());
        }
        let mut is_used = vec![false; self.positions.len()];
        self.corners.iter().for_each(|corner| is_used[corner.position as usize - 1] = true);
        if is_used.contains(&false) {
            let problem = "the file ends in the middle of a line and faces are missing: it was cut short";
            // The walk through the words has gone past the last line.
            return Err(SceneError::new(problem).at_line(self.words.line() - 1).with_remedy("get the file again"));
        }
        Ok(())
    }

    fn into_mesh(mut self, told: Option<ColorEncoding>) -> Result<RawMesh, SceneError> {
        let mut raw = RawMesh::default();
        for (what, (count, line)) in &self.noticed {
            raw.notes.push(format!("{what}: {count}, the first in line {line}"));
        }
        let bare = self.corners.iter().filter(|corner| corner.coordinate == 0).count();
        if bare > 0 {
            if bare < self.corners.len() {
                let count = self.corners.len();
                raw.notes.push(format!("texture coordinates left out: {bare} of {count} corners have none"));
            }
            self.corners.iter_mut().for_each(|corner| corner.coordinate = 0);
        }
        let colors = if self.colors.is_empty() {
            Vec::new()
        } else {
            self.colors.resize(self.positions.len(), None);
            let file_colors = FileColors { numbers: ColorNumbers::Floats, values: self.colors };
            let (colors, note) = file_colors.linear(told, |vertex| self.lines.get(vertex).copied())?;
            raw.notes.extend(note);
            colors
        };

        let mut corners = Corners::new(self.positions.len());
        let mut cutter = Cutter::default();
        let (mut outline, mut vertices, mut pieces) = (Vec::new(), Vec::new(), Vec::new());
        let mut first = 0;
        for &end in &self.ends {
            let face = &self.corners[first..end];
            first = end;
            vertices.clear();
            vertices.extend(face.iter().map(|&corner| corners.vertex(corner)));
            if let &[a, b, c] = &vertices[..] {
                raw.triangles.push([a, b, c]);
                continue;
            }
            outline.clear();
            outline.extend(face.iter().map(|corner| self.positions[corner.position as usize - 1]));
            pieces.clear();
            cutter.cut(&outline, &mut pieces);
            raw.triangles.extend(pieces.iter().map(|piece| piece.map(|corner| vertices[corner as usize])));
        }
        raw.notes.extend(cutter.note());

        let vertices = corners.vertices();
        let position = |corner: &Corner| corner.position as usize - 1;
        raw.positions = vertices.iter().map(|corner| self.positions[position(corner)]).collect();
        if !colors.is_empty() {
            raw.colors = vertices.iter().map(|corner| colors[position(corner)]).collect();
        }
        // OBJ counts v from the bottom.
        let from_top = |[u, v]: [f32; 2]| Vec3::new(u, 1.0 - v, 0.0);
        if bare == 0 {
            let coordinates = vertices.iter().map(|corner| self.coordinates[corner.coordinate as usize - 1]);
            raw.texture_coordinates = coordinates.map(from_top).collect();
        }
        if vertices.iter().any(|corner| corner.normal > 0) {
            let normal =
                |corner: &Corner| (corner.normal as usize).checked_sub(1).map_or(Vec3::ZERO, |i| self.normals[i]);
            raw.normals = vertices.iter().map(normal).collect();
        }
        Ok(raw)
    }
}

/// A whole number.
fn whole(word: &[u8]) -> Option<i64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(bytes: &[u8]) -> Result<RawMesh, SceneError> {
        super::parse(bytes, None)
    }

    const SQUARE: &str =
        "# a square\r\nmtllib none.mtl\r\nv 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nusemtl x\r\nf 1 2 3 4\r\n";

    #[test]
    fn quads_carriage_returns_and_absent_materials_are_fine() {
        let raw = parse(SQUARE.as_bytes()).unwrap();
        assert_eq!((raw.positions.len(), &raw.triangles[..]), (4, &[[0, 1, 2], [0, 2, 3]][..]));
        assert!(raw.normals.is_empty() && raw.colors.is_empty());
    }

    #[test]
    fn relative_indices_normals_and_colours_are_read() {
        let text = "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nvn 0 0 2\ng\nf -3//-1 -2//-1 -1//-1\n";
        let raw = parse(text.as_bytes()).unwrap();
        assert_eq!((raw.normals, raw.colors), (vec![2.0 * Vec3::Z; 3], vec![Vec3::X, Vec3::Y, Vec3::Z]));
        assert_eq!(raw.triangles, [[0, 1, 2]]);
    }

    #[test]
    fn texture_coordinates_have_their_own_indices_and_v_is_turned_downward() {
        let text =
            "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0.25 0.75\nvt 1 0 0\nvt 0.5\nf 1/1 2/2 3/-1\nf 1/2 3/3 4/1\n";
        let raw = parse(text.as_bytes()).unwrap();
        // The first vertex is split: its coordinates differ between the triangles. The third's are the same.
        let at = |t: usize| raw.triangles[t].map(|v| raw.texture_coordinates[v as usize].truncate().to_array());
        assert_eq!(at(0), [[0.25, 0.25], [1.0, 1.0], [0.5, 1.0]]);
        assert_eq!(at(1), [[1.0, 1.0], [0.5, 1.0], [0.25, 0.25]]);
        assert_eq!(raw.positions.len(), 5);
        // Where some corner has none, there are none.
        let partly = parse(text.replace("3/3", "3").as_bytes()).unwrap();
        assert!(partly.texture_coordinates.is_empty() && partly.triangles.len() == 2);
    }

    #[test]
    fn mistakes_are_named_with_their_lines() {
        for (text, line, part) in [
            ("v 0 0 0\nv 1 0\n", 2, "z is missing"),
            ("v 0 0 0\nv 1 nan 0\n", 2, "y is not a finite"),
            ("v 0 0 0\nv 1 1e99 0\n", 2, "y is not a finite"),
            ("v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 4\n", 5, "vertex 4"),
            ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -9223372036854775808\n", 4, "before the first"),
            ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 6148914691236517206\n", 4, "named, but"),
            ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//1 2//1 3//1\n", 4, "normal 1"),
            ("v 0 0 0\nv 1 0 0\nf 1 2\n", 3, "three corners"),
            ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 x\n", 4, "no corner"),
            ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2/1 3/1\n", 4, "texture coordinate 1"),
            ("v 0 0 0\nvt nan 0\n", 2, "u is not a finite"),
            ("v 0 0 0 1 1\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 1, "five numbers"),
        ] {
            let error = parse(text.as_bytes()).unwrap_err();
            assert!(error.line == Some(line) && error.problem.contains(part), "{text:?}: {error}");
        }
    }
}
