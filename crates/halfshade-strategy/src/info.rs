//! A strategy's account of itself, by which a SPEC like `sh-exp:as-published,bands=6` is read.

use crate::{Effects, Parameter, Params, Preset, SpecError, Stage};

/// A strategy's own account: name, source, parameters, effects.
#[derive(Debug, Clone)]
pub struct Info {
    /// Short name, as in a SPEC: lower case, words joined by hyphens.
    pub name: &'static str,
    /// One line.
    pub summary: &'static str,
    /// Where it is defined, as in `[Guerrero2007, 4.2]`.
    pub source: &'static str,
    /// Its parameters with defaults and ranges.
    pub parameters: Vec<Parameter>,
    /// Values under one name: `as-published` for whoever has departed from its paper.
    pub presets: &'static [Preset],
    /// Stages that are replaced one after the other to tell where its error comes from; what is left after the last is the rest.
    pub stages: &'static [Stage],
    /// Effects that it can model.
    pub effects: Effects,
}

impl Info {
    /// Every parameter at its default.
    pub fn defaults(&self) -> Params {
        Params::defaults(&self.parameters)
    }

    /// Defaults, changed by a preset and by `key=value`s, separated by commas: the part of a SPEC after the colon; empty is
    /// fine. A `key=value` counts more than a preset, wherever in the list they are.
    pub fn parse(&self, settings: &str) -> Result<Params, SpecError> {
        let mut params = self.defaults();
        let parts = || settings.split(',').map(str::trim).filter(|part| !part.is_empty());
        let mut chosen: Option<&Preset> = None;
        for name in parts().filter(|part| !part.contains('=')) {
            let preset = self.presets.iter().find(|preset| preset.name == name).ok_or_else(|| self.not_a_pair(name))?;
            if let Some(before) = chosen.replace(preset) {
                return Err(SpecError::TwoPresets(before.name.to_owned(), preset.name.to_owned()));
            }
        }
        if let Some(preset) = chosen {
            params.set(&self.parameters, preset.settings.split(','))?;
        }
        params.set(&self.parameters, parts().filter(|part| part.contains('=')))?;
        Ok(params)
    }

    /// `params` with the stage made exact.
    ///
    /// # Errors
    /// Settings that aren't this method's.
    pub fn made_exact(&self, params: &Params, stage: &Stage) -> Result<Params, SpecError> {
        let mut params = params.clone();
        params.set(&self.parameters, stage.exact.split(','))?;
        Ok(params)
    }

    fn not_a_pair(&self, text: &str) -> SpecError {
        SpecError::NotAPair { text: text.to_owned(), known: self.presets.iter().map(|preset| preset.name).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ParameterKind, choice, settings};

    choice! {
        /// How a thing is done.
        enum Way {
            /// term by term
            Series = "series",
            /// squared back
            Hybrid = "hybrid",
        }
    }

    settings! {
        /// A thing's settings.
        struct Settings {
            /// how it is done
            "exp" => way: Way = Way::Hybrid;
            /// how many
            "bands" => bands: usize = 4, in 1..=8;
            /// how much
            "limit" => limit: f32 = 0.5, in 0.0..=1.0;
        }
    }

    const PRESETS: [Preset; 2] = [
        Preset { name: "as-published", summary: "", settings: "exp=series,bands=6" },
        Preset { name: "quick", summary: "", settings: "bands=1" },
    ];

    fn info(presets: &'static [Preset]) -> Info {
        let parameters = Settings::parameters();
        Info { name: "toy", summary: "", source: "", parameters, presets, stages: &[], effects: Effects::default() }
    }

    fn read(settings: &str) -> Settings {
        Settings::read(&info(&PRESETS).parse(settings).unwrap())
    }

    #[test]
    fn a_spec_sets_what_it_names_and_leaves_the_rest() {
        assert_eq!(read(""), Settings { way: Way::Hybrid, bands: 4, limit: 0.5 });
        assert_eq!(read(" bands = 6 ,limit=1"), Settings { way: Way::Hybrid, bands: 6, limit: 1.0 });
    }

    #[test]
    fn a_preset_sets_its_own_and_what_is_said_counts_more() {
        assert_eq!(read("as-published"), Settings { way: Way::Series, bands: 6, limit: 0.5 });
        let both = Settings { way: Way::Hybrid, bands: 6, limit: 0.5 };
        assert_eq!((read("as-published,exp=hybrid"), read("exp=hybrid,as-published")), (both.clone(), both));
    }

    #[test]
    fn words_and_summaries_are_those_of_the_types() {
        let parameters = Settings::parameters();
        let names: Vec<_> = parameters.iter().map(|parameter| (parameter.name, parameter.summary)).collect();
        assert_eq!(names, [("exp", "how it is done"), ("bands", "how many"), ("limit", "how much")]);
        let ParameterKind::Choice { words, default } = parameters[0].kind else { panic!("a choice") };
        assert_eq!((words[0].name, words[0].summary, default), ("series", "term by term", "hybrid"));
        assert_eq!(parameters[2].kind.range(), "0..=1");
    }

    #[test]
    fn mistakes_are_named() {
        let error = |settings| info(&[]).parse(settings).unwrap_err().to_string();
        assert_eq!(error("band=6"), "unknown parameter `band` (did you mean `bands`?); known: exp, bands, limit");
        assert_eq!(error("bands=9"), "`bands=9`: expected 1..=8");
        assert_eq!(error("bands"), "`bands` is not of the form key=value");
        assert_eq!(error("bands=2,exp=series, bands=4"), "`bands` is set twice; give it once");
        assert_eq!(error("bands=2,bands=2"), "`bands` is set twice; give it once");
        assert_eq!(error("exp=magic"), "`exp=magic`: expected series | hybrid");
        assert_eq!(error("exp=serie"), "`exp=serie`: expected series | hybrid (did you mean `series`?)");
        let error = |settings| info(&PRESETS).parse(settings).unwrap_err().to_string();
        assert_eq!(error("slow"), "`slow` is not of the form key=value, nor a preset: as-published, quick");
        assert!(error("published").ends_with("quick (did you mean `as-published`?)"));
        assert_eq!(error("quick,as-published"), "`quick` and `as-published` are presets both; give one");
    }
}
