//! Straight-line code for the kernels: in Rust, generic over the lane type, and in WGSL, for one receiver per invocation.

use crate::recurrence::{legendre_step, sectoral_constant};
use crate::tripling::{self, Triple};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;
use std::fmt::Write;

/// Bands up to which products are unrolled in Rust. Beyond, the optimizer takes minutes over tens of thousands of
/// operations, so the products walk a table of the same groups instead.
const UNROLLED_BANDS: usize = 4;

/// Components of a row of four in WGSL.
const COMPONENTS: [&str; 4] = ["x", "y", "z", "w"];

/// Kernels in Rust for 1 to `max_bands` bands.
pub(crate) fn rust(max_bands: usize) -> String {
    let all = tripling::distinct(max_bands);
    let mut code = Code::new(Dialect::Rust);
    for bands in 1..=max_bands {
        let groups = factor(&of_bands(&all, bands));
        basis(&mut code, bands);
        if bands <= UNROLLED_BANDS {
            product(&mut code, bands, &groups);
            square(&mut code, bands, &groups);
        } else {
            table(&mut code, bands, &groups);
        }
    }
    code.text
}

/// A WGSL module of kernels for `bands` bands: `Sh`, an SH vector, and functions `sh_..` of it.
pub(crate) fn wgsl(bands: usize) -> String {
    let groups = factor(&of_bands(&tripling::distinct(bands), bands));
    let mut code = Code::new(Dialect::Wgsl);
    let count = bands * bands;
    write!(
        code.text,
        "// Written by the build script of halfshade-sh: {bands} bands.\nconst SH_BANDS = {bands}u;\n\
         const SH_COUNT = {count}u;\n{}{}",
        structure("Sh", count),
        structure("ShBands", bands)
    )
    .expect("writing to a string");
    basis(&mut code, bands);
    product(&mut code, bands, &groups);
    square(&mut code, bands, &groups);
    elementwise(&mut code, bands);
    code.text
}

/// A WGSL struct of numbers h0, h1, .. Compilers keep an array in memory where they can't follow it, but members in registers.
fn structure(name: &str, count: usize) -> String {
    let members: Vec<String> = (0..count).map(|i| format!("h{i}: f32")).collect();
    format!("struct {name} {{ {} }}\n", members.join(", "))
}

/// A WGSL function that turns a vector of `bands` bands by the blocks of a rotation, band by band and row by row. They are
/// read four at a time where they lie: as an argument they would fill registers.
pub(crate) fn wgsl_rotation(bands: usize) -> String {
    let mut code = Code::new(Dialect::Wgsl);
    let blocks = (0..bands).flat_map(|l| {
        let band = l * l..(l + 1) * (l + 1);
        band.clone().flat_map(move |row| band.clone().map(move |column| (row, column)))
    });
    let blocks: Vec<(usize, usize)> = blocks.collect();
    writeln!(code.text, "const SH_ROTATION_PARTS = {}u;", blocks.len().div_ceil(4)).expect("writing to a string");
    code.open("rotated", bands, "", "f: Sh, first: u32");
    let mut started = BTreeSet::new();
    for (part, four) in blocks.chunks(4).enumerate() {
        code.bind("part", &format!("sh_rotation_part(first + {part}u)"));
        for ((row, column), component) in four.iter().zip(COMPONENTS) {
            code.accumulate(&mut started, &format!("h{row}"), &format!("f.h{column}"), &format!("part.{component}"));
        }
    }
    code.close(bands);
    code.text
}

fn of_bands(all: &[Triple], bands: usize) -> Vec<Triple> {
    all.iter().filter(|t| t.k < bands * bands).copied().collect()
}

#[derive(Clone, Copy, PartialEq)]
enum Dialect {
    Rust,
    Wgsl,
}

/// Code in the making. Names may be bound again, as Rust allows: WGSL assigns to the same variable.
struct Code {
    dialect: Dialect,
    text: String,
    /// Names that the function at hand has declared.
    declared: BTreeSet<String>,
}

impl Code {
    fn new(dialect: Dialect) -> Self {
        Self { dialect, text: String::new(), declared: BTreeSet::new() }
    }

    fn line(&mut self, text: &str) {
        writeln!(self.text, "    {text}").expect("writing to a string");
    }

    /// Begins a function of vectors of `count` coefficients; `arguments` and the result are in the words of the dialect.
    fn open(&mut self, name: &str, bands: usize, rust: &str, wgsl: &str) {
        self.declared.clear();
        let count = bands * bands;
        match self.dialect {
            Dialect::Rust => {
                writeln!(self.text, "#[inline(always)]\nfn {name}_{bands}<L: Lane>({rust}) -> [L; {count}] {{")
            }
            Dialect::Wgsl => writeln!(self.text, "fn sh_{name}({wgsl}) -> Sh {{"),
        }
        .expect("writing to a string");
    }

    /// Ends a function whose result is in h0, h1, ..
    fn close(&mut self, bands: usize) {
        let list: Vec<String> = (0..bands * bands).map(|i| format!("h{i}")).collect();
        let list = list.join(", ");
        self.line(&match self.dialect {
            Dialect::Rust => format!("[{list}]"),
            Dialect::Wgsl => format!("return Sh({list});"),
        });
        self.text.push_str("}\n");
    }

    /// `name = value`.
    fn bind(&mut self, name: &str, value: &str) {
        let is_new = self.declared.insert(name.to_owned());
        let keyword = match self.dialect {
            Dialect::Rust => "let ",
            Dialect::Wgsl if is_new => "var ",
            Dialect::Wgsl => "",
        };
        self.line(&format!("{keyword}{name} = {value};"));
    }

    /// Number `i` of a vector.
    fn at(&self, vector: &str, i: usize) -> String {
        match self.dialect {
            Dialect::Rust => format!("{vector}[{i}]"),
            Dialect::Wgsl => format!("{vector}.h{i}"),
        }
    }

    fn constant(&self, value: f64) -> String {
        match self.dialect {
            Dialect::Rust => format!("L::constant({value:e})"),
            Dialect::Wgsl => format!("{:e}f", value as f32),
        }
    }

    /// `a·b + c`.
    fn mul_add(&self, a: &str, b: &str, c: &str) -> String {
        match self.dialect {
            Dialect::Rust => format!("{a}.mul_add({b}, {c})"),
            // Compilers of shaders fuse it where the hardware can.
            Dialect::Wgsl => format!("{a} * {b} + {c}"),
        }
    }

    /// Binds `name` to `a·b` the first time, to `a·b + name` after.
    fn accumulate(&mut self, started: &mut BTreeSet<String>, name: &str, a: &str, b: &str) {
        let value = match started.insert(name.to_owned()) {
            true => format!("{a} * {b}"),
            false => self.mul_add(a, b, name),
        };
        self.bind(name, &value);
    }
}

/// The triples that share the pair `(i, j)`: `(k, coefficient)`. With `i == j` the pair is a square.
struct Group {
    i: usize,
    j: usize,
    thirds: Vec<(usize, f64)>,
}

/// Spreads the triples over as few pairs as a greedy cover finds.
///
/// A triple of three different indices may go to any of its three pairs; each further triple in a group costs three
/// operations, each further group six. Triples with equal indices have no choice.
fn factor(triples: &[Triple]) -> Vec<Group> {
    let mut squares: BTreeMap<usize, Vec<(usize, f64)>> = BTreeMap::new();
    let mut open: BTreeSet<usize> = BTreeSet::new();
    for (at, &Triple { i, j, k, value }) in triples.iter().enumerate() {
        match (i == j, j == k) {
            (false, false) => {
                open.insert(at);
            }
            (true, _) => squares.entry(i).or_default().push((k, value)),
            (false, true) => squares.entry(j).or_default().push((i, value)),
        }
    }
    let mut groups: Vec<Group> = squares.into_iter().map(|(i, thirds)| Group { i, j: i, thirds }).collect();
    while !open.is_empty() {
        let mut votes: BTreeMap<(usize, usize), Vec<usize>> = BTreeMap::new();
        for &at in &open {
            let Triple { i, j, k, .. } = triples[at];
            for pair in [(i, j), (i, k), (j, k)] {
                votes.entry(pair).or_default().push(at);
            }
        }
        let most = votes.values().map(Vec::len).max().unwrap_or(0);
        let Some(((i, j), members)) = votes.into_iter().find(|(_, members)| members.len() == most) else { break };
        let thirds = members
            .iter()
            .map(|&at| {
                let t = triples[at];
                (t.i + t.j + t.k - i - j, t.value)
            })
            .collect();
        members.iter().for_each(|at| {
            open.remove(at);
        });
        groups.push(Group { i, j, thirds });
    }
    groups
}

/// `Γ_0jj = 1/sqrt(4π)`: shared by all squares, so it is multiplied once into f_0 and g_0 and once into h_0.
fn dc_scale() -> f64 {
    1.0 / (4.0 * PI).sqrt()
}

/// `h = f*g`: per pair of indices (i, j), with `s = Σ c_k f_k` and `t = Σ c_k g_k`, `h_i += s g_j + t f_j`,
/// `h_j += s g_i + t f_i`, `h_k += c_k (f_i g_j + f_j g_i)`; half of that for squares.
fn product(code: &mut Code, bands: usize, groups: &[Group]) {
    let count = bands * bands;
    code.open("product", bands, &format!("f: &[L; {count}], g: &[L; {count}]"), "f: Sh, g: Sh");
    if bands > 1 {
        let scale = code.constant(dc_scale());
        code.bind("f0", &format!("f[0] * {scale}"));
        code.bind("g0", &format!("g[0] * {scale}"));
    }
    let mut started = BTreeSet::new();
    for Group { i, j, thirds } in groups {
        let (i, j, is_square) = (*i, *j, i == j);
        let mut local = BTreeSet::new();
        for &(k, value) in thirds.iter().filter(|(k, _)| !(is_square && *k == i)) {
            for (name, factor) in [("s", "f"), ("t", "g")] {
                if k == 0 {
                    code.bind(name, &format!("{factor}0"));
                    local.insert(name.to_owned());
                } else {
                    let constant = code.constant(value);
                    let factor = code.at(factor, k);
                    code.accumulate(&mut local, name, &factor, &constant);
                }
            }
        }
        let ends = if is_square { vec![(i, j)] } else { vec![(i, j), (j, i)] };
        for (to, other) in ends.iter().filter(|_| !local.is_empty()) {
            let [f, g] = ["f", "g"].map(|vector| code.at(vector, *other));
            code.accumulate(&mut started, &format!("h{to}"), "s", &g);
            code.accumulate(&mut started, &format!("h{to}"), "t", &f);
        }
        code.bind("p", &format!("{} * {}", code.at("f", i), code.at("g", j)));
        if !is_square {
            let both = code.mul_add(&code.at("f", j), &code.at("g", i), "p");
            code.bind("p", &both);
        }
        spread(code, &mut started, thirds, 1.0);
    }
    scale_first(code);
    code.close(bands);
}

/// `h = f*f`, as [`product`] with f = g; the factor 2 goes into the constants.
fn square(code: &mut Code, bands: usize, groups: &[Group]) {
    let count = bands * bands;
    code.open("square", bands, &format!("f: &[L; {count}]"), "f: Sh");
    if bands > 1 {
        let scale = code.constant(2.0 * dc_scale());
        code.bind("f0", &format!("f[0] * {scale}"));
    }
    let mut started = BTreeSet::new();
    for Group { i, j, thirds } in groups {
        let (i, j, is_square) = (*i, *j, i == j);
        let mut local = BTreeSet::new();
        for &(k, value) in thirds.iter().filter(|(k, _)| !(is_square && *k == i)) {
            if k == 0 {
                code.bind("s", "f0");
                local.insert("s".to_owned());
            } else {
                let constant = code.constant(2.0 * value);
                let factor = code.at("f", k);
                code.accumulate(&mut local, "s", &factor, &constant);
            }
        }
        let ends = if is_square { vec![(i, j)] } else { vec![(i, j), (j, i)] };
        for (to, other) in ends.iter().filter(|_| !local.is_empty()) {
            let factor = code.at("f", *other);
            code.accumulate(&mut started, &format!("h{to}"), "s", &factor);
        }
        code.bind("p", &format!("{} * {}", code.at("f", i), code.at("f", j)));
        spread(code, &mut started, thirds, if is_square { 1.0 } else { 2.0 });
    }
    scale_first(code);
    code.close(bands);
}

/// h_0 is scaled at the end instead of term by term.
fn scale_first(code: &mut Code) {
    let scale = code.constant(dc_scale());
    code.bind("h0", &format!("h0 * {scale}"));
}

/// The groups as a static table.
fn table(code: &mut Code, bands: usize, groups: &[Group]) {
    writeln!(code.text, "static GROUPS_{bands}: [Group; {}] = [", groups.len()).expect("writing to a string");
    for Group { i, j, thirds } in groups {
        let list: Vec<String> = thirds.iter().map(|(k, value)| format!("({k}, {value:e})")).collect();
        code.line(&format!("Group {{ i: {i}, j: {j}, thirds: &[{}] }},", list.join(", ")));
    }
    code.text.push_str("];\n");
}

/// `h_k += c_k p` for the thirds of a group.
fn spread(code: &mut Code, started: &mut BTreeSet<String>, thirds: &[(usize, f64)], scale: f64) {
    for &(k, value) in thirds {
        if k == 0 {
            let value = if started.insert("h0".to_owned()) { "p" } else { "h0 + p" };
            code.bind("h0", value);
        } else {
            let constant = code.constant(scale * value);
            code.accumulate(started, &format!("h{k}"), "p", &constant);
        }
    }
}

/// The basis along (x, y, z) by the recurrences of `basis.rs` with their constants filled in, and its accumulation
/// with one scale per band.
fn basis(code: &mut Code, bands: usize) {
    let count = bands * bands;
    code.open("basis", bands, "[x, y, z]: [L; 3]", "direction: vec3f");
    match code.dialect {
        Dialect::Wgsl => ["x", "y", "z"].iter().for_each(|axis| code.bind(axis, &format!("direction.{axis}"))),
        Dialect::Rust if bands == 1 => code.line("let _ = (x, y, z); // band 0 is constant"),
        Dialect::Rust => {}
    }
    for m in 0..bands {
        match m {
            0 => {}
            1 => {
                code.bind("c", "x");
                code.bind("s", "y");
            }
            _ => {
                code.bind("turned", "x * c - y * s");
                code.bind("s", "x * s + y * c");
                code.bind("c", "turned");
            }
        }
        for l in m..bands {
            let name = format!("p{l}");
            if l == m {
                let constant = code.constant(sectoral_constant(m));
                code.bind(&name, &constant);
            } else {
                let (alpha, beta) = legendre_step(l, m);
                let constant = code.constant(alpha);
                code.bind(&name, &format!("z * p{} * {constant}", l - 1));
                if l > m + 1 {
                    let constant = code.constant(-beta);
                    let value = code.mul_add(&format!("p{}", l - 2), &constant, &name);
                    code.bind(&name, &value);
                }
            }
            let (plus, minus) = (l * (l + 1) + m, l * (l + 1) - m);
            if m == 0 {
                code.bind(&format!("h{plus}"), &name);
            } else {
                code.bind(&format!("h{plus}"), &format!("{name} * c"));
                code.bind(&format!("h{minus}"), &format!("{name} * s"));
            }
        }
    }
    code.close(bands);
    match code.dialect {
        Dialect::Rust => {
            writeln!(
                code.text,
                "#[inline(always)]\nfn accumulate_{bands}<L: Lane>(direction: [L; 3], scale: &[L], sum: &mut [L; {count}]) {{"
            )
            .expect("writing to a string");
            code.line(&format!("let y = basis_{bands}(direction);"));
            for i in 0..count {
                code.line(&format!("sum[{i}] = y[{i}].mul_add(scale[{}], sum[{i}]);", i.isqrt()));
            }
            code.text.push_str("}\n");
        }
        Dialect::Wgsl => {
            code.open("add_lobe", bands, "", "direction: vec3f, scale: ShBands, sum: Sh");
            code.bind("y", "sh_basis(direction)");
            for i in 0..count {
                let value = code.mul_add(&code.at("y", i), &code.at("scale", i.isqrt()), &code.at("sum", i));
                code.bind(&format!("h{i}"), &value);
            }
            code.close(bands);
        }
    }
}

/// WGSL functions that work coefficient by coefficient: without loops nothing is indexed at run time.
fn elementwise(code: &mut Code, bands: usize) {
    let functions = [
        ("times_bands", "f: Sh, factors: ShBands", "f.h{i} * factors.h{l}"),
        ("scaled", "f: Sh, factor: f32", "f.h{i} * factor"),
        ("plus", "f: Sh, g: Sh", "f.h{i} + g.h{i}"),
        // `f + weight·(g - f)`.
        ("mix", "f: Sh, g: Sh, weight: f32", "weight * (g.h{i} - f.h{i}) + f.h{i}"),
        // `f·factor + g`.
        ("scaled_plus", "f: Sh, factor: f32, g: Sh", "f.h{i} * factor + g.h{i}"),
    ];
    for (name, arguments, value) in functions {
        code.open(name, bands, "", arguments);
        for i in 0..bands * bands {
            let value = value.replace("{i}", &i.to_string()).replace("{l}", &i.isqrt().to_string());
            code.bind(&format!("h{i}"), &value);
        }
        code.close(bands);
    }
    for (name, arguments, first, a, b) in
        [("dot", "f: Sh, g: Sh", 0, "f", "g"), ("isolated_energy", "f: Sh", 1, "f", "f")]
    {
        code.declared.clear();
        writeln!(code.text, "fn sh_{name}({arguments}) -> f32 {{").expect("writing to a string");
        code.bind("sum", "0.0f");
        for i in first..bands * bands {
            let value = code.mul_add(&code.at(a, i), &code.at(b, i), "sum");
            code.bind("sum", &value);
        }
        code.line("return sum;");
        code.text.push_str("}\n");
    }
    conversions(code, bands);
}

/// WGSL functions to and from rows of four, in which tables are stored.
fn conversions(code: &mut Code, bands: usize) {
    let component = |i: usize| COMPONENTS[i % 4];
    let list = |items: Vec<String>| items.join(", ");
    let of_band = |l: usize| format!("{}.{}", if l < 4 { "low" } else { "high" }, component(l));
    let of_coefficient = |i: usize| if i < bands * bands { format!("f.h{i}") } else { "0.0f".to_owned() };
    let parts = (bands * bands).div_ceil(4);
    let part = |k: usize| format!("vec4f({})", list((4 * k..4 * k + 4).map(of_coefficient).collect()));
    write!(
        code.text,
        "const SH_PARTS = {parts}u;\n\
         fn sh_bands(low: vec4f, high: vec4f) -> ShBands {{\n    return ShBands({});\n}}\n\
         fn sh_parts(f: Sh) -> array<vec4f, {parts}> {{\n    return array<vec4f, {parts}>({});\n}}\n\
         fn sh_part(f: Sh, part: u32) -> vec4f {{\n    switch part {{\n{}    }}\n}}\n\
         fn sh_of_parts(p: array<vec4f, {parts}>) -> Sh {{\n    return Sh({});\n}}\n",
        list((0..bands).map(of_band).collect()),
        list((0..parts).map(part).collect()),
        (0..parts)
            .map(|k| {
                let case = if k + 1 == parts { "default".to_owned() } else { format!("case {k}u") };
                format!("        {case}: {{ return {}; }}\n", part(k))
            })
            .collect::<String>(),
        list((0..bands * bands).map(|i| format!("p[{}].{}", i / 4, component(i))).collect()),
    )
    .expect("writing to a string");
}
