//! Names that nobody knows, and the known one that was probably meant.

/// Says that `name` is no `kind` that is known: first the one that it resembles, then all.
pub fn unknown<'a>(kind: &str, name: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let known: Vec<&str> = known.into_iter().collect();
    format!("unknown {kind} `{name}`{}; known: {}", did_you_mean(name, known.iter().copied()), known.join(", "))
}

/// ` (did you mean ..?)`, or nothing where no name is near.
pub fn did_you_mean<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    resembling(name, known).map_or_else(String::new, |meant| format!(" (did you mean `{meant}`?)"))
}

/// The name that takes the fewest slips of the pen, at most one in three letters; else the only one that is longer or shorter at
/// its ends.
fn resembling<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    /// Fewer letters are in many names.
    const FEWEST_LETTERS: usize = 3;
    let known: Vec<&str> = known.into_iter().collect();
    let name = name.to_lowercase();
    let slips = |other: &str| strsim::damerau_levenshtein(&name, &other.to_lowercase());
    let (count, nearest) = known.iter().map(|other| (slips(other), *other)).min_by_key(|(count, _)| *count)?;
    if 3 * count <= name.chars().count().max(nearest.chars().count()) {
        return Some(nearest);
    }
    let is_part = |part: &str, whole: &str| part.chars().count() >= FEWEST_LETTERS && whole.contains(part);
    let mut parts = known.iter().filter(|other| is_part(&name, other) || is_part(other, &name));
    parts.next().filter(|_| parts.next().is_none()).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_that_was_meant_comes_first() {
        let known = ["samples", "seed", "vertical_fov_degrees", "up"];
        for (name, meant) in
            [("sampels", "samples"), ("Samples", "samples"), ("sed", "seed"), ("fov", "vertical_fov_degrees")]
        {
            assert_eq!(resembling(name, known), Some(meant), "{name}");
        }
        for name in ["", "x", "degree_of_freedom", "colour", "u"] {
            assert_eq!(resembling(name, known), None, "{name}");
        }
        assert_eq!(resembling("x", []), None);
        let text = unknown("key", "sampels", ["samples", "seed"]);
        assert_eq!(text, "unknown key `sampels` (did you mean `samples`?); known: samples, seed");
        assert_eq!(unknown("key", "x", ["samples", "seed"]), "unknown key `x`; known: samples, seed");
    }
}
