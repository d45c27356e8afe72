//! A part of an experiment: some of its scenes and strategies.

use super::Experiment;
use crate::HarnessError;
use halfshade_scene::keys::Spanned;

impl Experiment {
    /// Keeps what `names` name: scenes, as the experiment writes them, and strategies. All scenes stay if none of them is named,
    /// and so do all strategies; comparisons with what has gone go with it.
    ///
    /// # Errors
    /// A name of neither.
    pub fn keep_only(&mut self, names: &[String]) -> Result<(), HarnessError> {
        let scenes: Vec<String> = self.scenes.iter().map(|scene| scene.name.get_ref().clone()).collect();
        let strategies: Vec<String> = self.strategies.iter().map(|table| name_of(table.get_ref())).collect();
        if let Some(unknown) = names.iter().find(|name| !scenes.contains(name) && !strategies.contains(name)) {
            let mut known: Vec<&str> = scenes.iter().chain(&strategies).map(String::as_str).collect();
            known.dedup();
            let problem = format!("has no scene or strategy `{unknown}`; it has {}", known.join(", "));
            return Err(HarnessError::in_file(&self.path, problem));
        }
        let kept = |all: &[String]| all.iter().filter(|name| names.contains(name)).cloned().collect::<Vec<String>>();
        let (scenes, strategies) = (kept(&scenes), kept(&strategies));
        if !scenes.is_empty() {
            self.scenes.retain(|scene| scenes.contains(scene.name.get_ref()));
        }
        if !strategies.is_empty() {
            self.strategies.retain(|table| strategies.contains(&name_of(table.get_ref())));
            let is_kept = |spec: &Spanned<String>| {
                let name = spec.get_ref().split(':').next().unwrap_or_default().trim();
                strategies.iter().any(|kept| kept == name)
            };
            self.baseline.take_if(|spec| !is_kept(spec));
            self.compare.retain(|pair| pair.iter().all(is_kept));
            if let Some(pictures) = &mut self.pictures {
                pictures.difference.take_if(|pair| !pair.iter().all(is_kept));
                if let Some(specs) = &mut pictures.strategies {
                    specs.retain(is_kept);
                }
            }
        }
        self.only.extend(names.iter().cloned());
        Ok(())
    }
}

/// Name of the strategy of a table.
pub(crate) fn name_of(table: &std::collections::BTreeMap<String, Spanned<toml::Value>>) -> String {
    table.get("name").and_then(|name| name.get_ref().as_str()).unwrap_or_default().to_owned()
}

#[cfg(test)]
mod tests {
    use super::super::tests::SMALL;
    use super::*;
    use std::path::Path;

    #[test]
    fn what_is_not_named_goes_with_what_is_compared_with_it() {
        let text = SMALL.replace("claim", "baseline = \"bright\"\ncompare = [[\"dim\", \"bright\"]]\nclaim");
        let text = text + "[[strategy]]\nname = \"bright\"\n[[scene]]\nname = \"ducks\"\n";
        let whole = Experiment::parse(&text, Path::new("e.toml")).unwrap();
        let only = |names: &[&str]| {
            let mut experiment = whole.clone();
            let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
            experiment.keep_only(&names).map(|()| experiment)
        };
        let part = only(&["dim", "ducks"]).unwrap();
        assert_eq!((part.scenes.len(), part.strategies.len(), part.compare.len()), (1, 1, 0));
        assert!(part.baseline.is_none() && part.hash() != whole.hash());
        let scenes = only(&["vases"]).unwrap();
        assert_eq!((scenes.scenes.len(), scenes.strategies.len(), scenes.compare.len()), (1, 2, 1));
        let error = only(&["Vases"]).unwrap_err().to_string();
        assert_eq!(error, "e.toml: has no scene or strategy `Vases`; it has vases, ducks, dim, bright");
    }
}
