//! Settings of a strategy, drawn from the ranges that it declares.

use crate::random::Random;
use halfshade_strategy::{Parameter, ParameterKind, Params, Strategy};

/// Upper ends of what only costs time. A parameter that isn't named here is drawn from its whole range.
const AFFORDABLE: &[(&str, i64)] = &[
    ("directions", 256),
    ("env-lobes", 16),
    ("face", 8),
    ("ground-directions", 64),
    ("map", 16),
    ("normals", 16),
    ("own-directions", 64),
    ("points", 16),
    ("resolution", 8),
    ("sample-divisions", 2),
    ("samples", 64),
    ("shells", 6),
    ("volume-steps", 6),
];

/// A strategy with its parameters set.
pub(crate) struct Subject<'a> {
    pub(crate) strategy: &'a dyn Strategy,
    pub(crate) name: &'static str,
    pub(crate) params: Params,
    /// The parameters as a user would write them.
    pub(crate) spec: String,
}

impl<'a> Subject<'a> {
    /// The strategy with all parameters as given in a SPEC; those that cost time are affordable where it says nothing.
    pub(crate) fn parse(strategy: &'a dyn Strategy, settings: &str) -> Self {
        let info = strategy.info();
        let params = info.parse(settings).expect("settings within their ranges");
        Self { strategy, name: info.name, params, spec: format!("{}:{settings}", info.name) }
    }

    /// Every parameter at random; one in four subjects has only one that isn't its default.
    pub(crate) fn draw(strategy: &'a dyn Strategy, random: &mut Random) -> Self {
        let info = strategy.info();
        let one = random.chance(0.25).then(|| random.below(info.parameters.len()));
        let mut settings = Vec::new();
        for (number, parameter) in info.parameters.iter().enumerate() {
            let keeps_default = one.map_or(random.chance(0.4), |one| one != number);
            let costly = AFFORDABLE.iter().find(|(name, _)| *name == parameter.name);
            if !keeps_default || costly.is_some() {
                settings.push(format!(
                    "{}={}",
                    parameter.name,
                    value(parameter, costly.map(|(_, most)| *most), random)
                ));
            }
        }
        Self::parse(strategy, &settings.join(","))
    }
}

fn value(parameter: &Parameter, most: Option<i64>, random: &mut Random) -> String {
    match parameter.kind {
        ParameterKind::Choice { words, .. } => random.pick(words).name.to_owned(),
        ParameterKind::Integer { min, max, .. } => {
            let max = most.map_or(max, |most| most.min(max));
            let inside = min + random.below((max - min + 1) as usize) as i64;
            random.pick(&[min, max, inside, inside]).to_string()
        }
        ParameterKind::Float { min, max, .. } => {
            let inside = f64::from(random.between(0.0, 1.0));
            // Near the lower end as often as anywhere else: that is where thresholds matter.
            let near = min + (max - min) * inside.powi(6);
            random.pick(&[min, max, near, min + (max - min) * inside]).to_string()
        }
    }
}
