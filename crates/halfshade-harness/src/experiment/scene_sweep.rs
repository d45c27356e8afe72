//! Sweeps of a scene: its entry with every combination of the values that are listed.

use super::{Experiment, SceneEntry};
use crate::HarnessError;
use halfshade_scene::{
    file::Change,
    keys::{self, Spanned},
    text,
};
use std::ops::Range;

/// Most scenes that an entry becomes.
const MAX_SCENES: usize = 1000;

/// Keys of an entry that can be swept.
const KEYS: [&str; 6] = ["environment", "still", "bounces", "resolution", "spheres", "fit"];

impl SceneEntry {
    /// The entry without a sweep, or one for each combination of its sweep's values, keys in alphabetical order, the last of which changes
    /// first. Keys are those of an entry, or paths into its scene file.
    ///
    /// # Errors
    /// A key that is none, a list without values or with one twice, too many combinations.
    pub fn swept(&self, experiment: &Experiment) -> Result<Vec<Self>, HarnessError> {
        let mut all = vec![Self { sweep: Vec::new(), ..self.clone() }];
        for (key, values) in &self.sweep {
            let fail = |problem: String| Err(experiment.error_at(values.span(), problem));
            let list = values.get_ref();
            if list.is_empty() {
                return fail(format!("`{key}` is an empty list: nothing to run"));
            }
            if let Some(place) = (0..list.len()).find(|&place| list[..place].contains(&list[place])) {
                return fail(format!("`{key}` lists {} twice; list each value once", list[place]));
            }
            if all.len().saturating_mul(list.len()) > MAX_SCENES {
                return fail(format!("the sweep has more than {MAX_SCENES} combinations; leave some values out"));
            }
            let with = |entry: &Self, value: &toml::Value| {
                let problem = |problem| experiment.error_at(values.span(), format!("`{key}`: {problem}"));
                entry.with(key, value, values.span()).map_err(problem)
            };
            let each = |entry: &Self| list.iter().map(|value| with(entry, value)).collect::<Vec<_>>();
            all = all.iter().flat_map(each).collect::<Result<_, _>>()?;
        }
        Ok(all)
    }

    /// The entry with another value of `key`, for which `span` stands in errors.
    fn with(&self, key: &str, value: &toml::Value, span: Range<usize>) -> Result<Self, String> {
        let mut entry = self.clone();
        if key.contains('.') {
            entry.changes.push(Change { path: key.to_owned(), value: value.to_string() });
            return Ok(entry);
        }
        if !KEYS.contains(&key) {
            return Err(format!(
                "can't be swept{}; {} and paths into a scene file such as light.1.radiance can",
                text::did_you_mean(key, KEYS),
                KEYS.join(", ")
            ));
        }
        // Read as if it stood in a file of its own: the same bounds, the same words where it doesn't fit.
        let text = format!("name = \"\"\n{key} = {value}");
        let one: Self = keys::parse(&text).map_err(|error| error.problem)?;
        match key {
            "environment" => entry.environment = one.environment,
            "still" => entry.still = one.still.map(|still| Spanned::new(span, still.into_inner())),
            "bounces" => entry.bounces = one.bounces,
            "resolution" => entry.resolution = one.resolution,
            "spheres" => entry.spheres = one.spheres,
            _ => entry.fit = one.fit,
        }
        if key == "bounces" {
            entry.told.push(format!("bounces {value}"));
        }
        Ok(entry)
    }

    /// Ending of the scene's name that tells changes which change nothing else of it.
    pub fn suffix(&self) -> String {
        let changes = self.changes.iter().map(|Change { path, value }| format!("{path} {value}"));
        self.told.iter().cloned().chain(changes).map(|told| format!(", {told}")).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::SMALL;
    use super::*;
    use std::path::Path;

    fn swept(sweep: &str) -> Result<Vec<SceneEntry>, String> {
        let text = SMALL.replace("[[strategy]]", &format!("sweep = {sweep}\n[[strategy]]"));
        let experiment = Experiment::parse(&text, Path::new("e.toml")).map_err(|error| error.to_string())?;
        experiment.scenes[0].swept(&experiment).map_err(|error| error.to_string())
    }

    #[test]
    fn lists_become_every_combination() {
        let all =
            swept("{ spheres = [10, 20], bounces = [0, 1], \"light.1.radiance\" = [[1, 1, 1], [5, 5, 5]] }").unwrap();
        assert_eq!(all.len(), 8);
        let facts = |entry: &SceneEntry| (entry.spheres.unwrap().get(), entry.bounces.unwrap());
        assert_eq!((facts(&all[0]), facts(&all[1]), facts(&all[4])), ((10, 0), (20, 0), (10, 1)));
        assert_eq!(all[7].suffix(), ", bounces 1, light.1.radiance [5, 5, 5]");
        assert_eq!(swept("{}").unwrap().len(), 1);
    }

    #[test]
    fn what_cannot_be_swept_is_told_at_its_line() {
        for (sweep, what) in [
            ("{ spheres = [] }", "empty list"),
            ("{ spheres = [10, 10] }", "lists 10 twice"),
            ("{ spheres = [0] }", "`spheres` = 0 must be from 1"),
            ("{ sphere = [1] }", "`sphere`: can't be swept (did you mean `spheres`?)"),
            ("{ frames = [1] }", "can't be swept"),
            ("{ spheres = 10 }", "`spheres` must be a list of values, not 10"),
        ] {
            let error = swept(sweep).unwrap_err();
            assert!(error.starts_with("e.toml:7:") && error.contains(what), "{sweep}: {error}");
        }
        let many = format!("{{ spheres = {:?}, bounces = [0, 1] }}", (1..=501).collect::<Vec<_>>());
        assert!(swept(&many).unwrap_err().contains("more than 1000 combinations"));
    }
}
