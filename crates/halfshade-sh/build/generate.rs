//! Straight-line Rust for the kernels, generic over the lane type.

use crate::recurrence::{legendre_step, sectoral_constant};
use crate::tripling::{self, Triple};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;
use std::fmt::Write;

/// Bands up to which products are unrolled. Beyond, the optimizer takes minutes over tens of thousands of
/// operations, so the products walk a table of the same groups instead.
const UNROLLED_BANDS: usize = 4;

/// Kernels for 1 to `max_bands` bands.
pub(crate) fn kernels(max_bands: usize) -> String {
    let all = tripling::distinct(max_bands);
    let mut code = String::new();
    for bands in 1..=max_bands {
        let triples: Vec<Triple> = all.iter().filter(|t| t.k < bands * bands).copied().collect();
        let groups = factor(&triples);
        basis(&mut code, bands);
        if bands <= UNROLLED_BANDS {
            product(&mut code, bands, &groups);
            square(&mut code, bands, &groups);
        } else {
            table(&mut code, bands, &groups);
        }
    }
    code
}

fn line(code: &mut String, text: std::fmt::Arguments<'_>) {
    writeln!(code, "    {text}").expect("writing to a string");
}

macro_rules! line {
    ($code:expr, $($text:tt)*) => { line($code, format_args!($($text)*)) };
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

/// Emits `h_at = a·b + h_at`, or `h_at = a·b` the first time.
fn accumulate(code: &mut String, started: &mut BTreeSet<String>, name: &str, a: &str, b: &str) {
    if started.insert(name.to_owned()) {
        line!(code, "let {name} = {a} * {b};");
    } else {
        line!(code, "let {name} = {a}.mul_add({b}, {name});");
    }
}

fn open_function(code: &mut String, name: &str, bands: usize, arguments: &[&str]) {
    let count = bands * bands;
    let list: Vec<String> = arguments.iter().map(|a| format!("{a}: &[L; {count}]")).collect();
    writeln!(code, "#[inline(always)]\nfn {name}_{bands}<L: Lane>({}) -> [L; {count}] {{", list.join(", "))
        .expect("writing to a string");
}

fn close_function(code: &mut String, bands: usize, constant_scale: bool) {
    if constant_scale {
        line!(code, "let h0 = h0 * L::constant({:e});", dc_scale());
    }
    let list: Vec<String> = (0..bands * bands).map(|i| format!("h{i}")).collect();
    line!(code, "[{}]", list.join(", "));
    code.push_str("}\n");
}

/// `Γ_0jj = 1/sqrt(4π)`: shared by all squares, so it is multiplied once into f_0 and g_0 and once into h_0.
fn dc_scale() -> f64 {
    1.0 / (4.0 * PI).sqrt()
}

/// `h = f*g`. Per pair (i, j): with `s = Σ c_k f_k`, `t = Σ c_k g_k`, `h_i += s g_j + t f_j`, `h_j += s g_i + t f_i`,
/// `h_k += c_k (f_i g_j + f_j g_i)`; half of that for squares.
fn product(code: &mut String, bands: usize, groups: &[Group]) {
    open_function(code, "product", bands, &["f", "g"]);
    if bands > 1 {
        line!(code, "let (f0, g0) = (f[0] * L::constant({0:e}), g[0] * L::constant({0:e}));", dc_scale());
    }
    let mut started = BTreeSet::new();
    for Group { i, j, thirds } in groups {
        let (i, j, is_square) = (*i, *j, i == j);
        let mut local = BTreeSet::new();
        for &(k, value) in thirds.iter().filter(|(k, _)| !(is_square && *k == i)) {
            for (name, factor) in [("s", "f"), ("t", "g")] {
                if k == 0 {
                    line!(code, "let {name} = {factor}0;");
                    local.insert(name.to_owned());
                } else {
                    let (constant, term) = (format!("L::constant({value:e})"), format!("{factor}[{k}]"));
                    accumulate(code, &mut local, name, &term, &constant);
                }
            }
        }
        let ends = if is_square { vec![(i, j)] } else { vec![(i, j), (j, i)] };
        for (to, other) in ends.iter().filter(|_| !local.is_empty()) {
            accumulate(code, &mut started, &format!("h{to}"), "s", &format!("g[{other}]"));
            accumulate(code, &mut started, &format!("h{to}"), "t", &format!("f[{other}]"));
        }
        line!(code, "let p = f[{i}] * g[{j}];");
        if !is_square {
            line!(code, "let p = f[{j}].mul_add(g[{i}], p);");
        }
        spread(code, &mut started, thirds, 1.0);
    }
    close_function(code, bands, true);
}

/// `h = f*f`, as [`product`] with f = g; the factor 2 goes into the constants.
fn square(code: &mut String, bands: usize, groups: &[Group]) {
    open_function(code, "square", bands, &["f"]);
    if bands > 1 {
        line!(code, "let f0 = f[0] * L::constant({:e});", 2.0 * dc_scale());
    }
    let mut started = BTreeSet::new();
    for Group { i, j, thirds } in groups {
        let (i, j, is_square) = (*i, *j, i == j);
        let mut local = BTreeSet::new();
        for &(k, value) in thirds.iter().filter(|(k, _)| !(is_square && *k == i)) {
            if k == 0 {
                line!(code, "let s = f0;");
                local.insert("s".to_owned());
            } else {
                let (constant, term) = (format!("L::constant({:e})", 2.0 * value), format!("f[{k}]"));
                accumulate(code, &mut local, "s", &term, &constant);
            }
        }
        let ends = if is_square { vec![(i, j)] } else { vec![(i, j), (j, i)] };
        for (to, other) in ends.iter().filter(|_| !local.is_empty()) {
            accumulate(code, &mut started, &format!("h{to}"), "s", &format!("f[{other}]"));
        }
        line!(code, "let p = f[{i}] * f[{j}];");
        spread(code, &mut started, thirds, if is_square { 1.0 } else { 2.0 });
    }
    close_function(code, bands, true);
}

/// The groups as a static table.
fn table(code: &mut String, bands: usize, groups: &[Group]) {
    writeln!(code, "static GROUPS_{bands}: [Group; {}] = [", groups.len()).expect("writing to a string");
    for Group { i, j, thirds } in groups {
        let list: Vec<String> = thirds.iter().map(|(k, value)| format!("({k}, {value:e})")).collect();
        line!(code, "Group {{ i: {i}, j: {j}, thirds: &[{}] }},", list.join(", "));
    }
    code.push_str("];\n");
}

/// `h_k += c_k p` for the thirds of a group; h_0 is scaled at the end instead.
fn spread(code: &mut String, started: &mut BTreeSet<String>, thirds: &[(usize, f64)], scale: f64) {
    for &(k, value) in thirds {
        if k == 0 {
            if started.insert("h0".to_owned()) {
                line!(code, "let h0 = p;");
            } else {
                line!(code, "let h0 = h0 + p;");
            }
        } else {
            accumulate(code, started, &format!("h{k}"), "p", &format!("L::constant({:e})", scale * value));
        }
    }
}

/// The basis along (x, y, z) by the recurrences of `basis.rs` with their constants filled in, and its accumulation
/// with one scale per band.
fn basis(code: &mut String, bands: usize) {
    let count = bands * bands;
    writeln!(code, "#[inline(always)]\nfn basis_{bands}<L: Lane>([x, y, z]: [L; 3]) -> [L; {count}] {{")
        .expect("writing to a string");
    if bands == 1 {
        line!(code, "let _ = (x, y, z); // band 0 is constant");
    }
    for m in 0..bands {
        match m {
            0 => {}
            1 => line!(code, "let (c, s) = (x, y);"),
            _ => line!(code, "let (c, s) = (x * c - y * s, x * s + y * c);"),
        }
        for l in m..bands {
            if l == m {
                line!(code, "let p{l} = L::constant({:e});", sectoral_constant(m));
            } else {
                let (alpha, beta) = legendre_step(l, m);
                line!(code, "let p{l} = z * p{} * L::constant({alpha:e});", l - 1);
                if l > m + 1 {
                    line!(code, "let p{l} = p{}.mul_add(L::constant({:e}), p{l});", l - 2, -beta);
                }
            }
            let (plus, minus) = (l * (l + 1) + m, l * (l + 1) - m);
            if m == 0 {
                line!(code, "let h{plus} = p{l};");
            } else {
                line!(code, "let (h{plus}, h{minus}) = (p{l} * c, p{l} * s);");
            }
        }
    }
    close_function(code, bands, false);
    writeln!(
        code,
        "#[inline(always)]\nfn accumulate_{bands}<L: Lane>(direction: [L; 3], scale: &[L], sum: &mut [L; {count}]) {{"
    )
    .expect("writing to a string");
    line!(code, "let y = basis_{bands}(direction);");
    for i in 0..count {
        line!(code, "sum[{i}] = y[{i}].mul_add(scale[{}], sum[{i}]);", i.isqrt());
    }
    code.push_str("}\n");
}
