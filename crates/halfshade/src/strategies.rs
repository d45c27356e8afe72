//! The only list of strategies.

use halfshade_scene::Cache;
use halfshade_strategies::{Analytic, CosineLobe, Mask, Prt, RayTraced, ShExp, ShadowField, Unshadowed};
use halfshade_strategy::Strategy;

/// Every strategy there is. `cache` is for what they bake.
pub fn strategies(cache: &Cache) -> Vec<Box<dyn Strategy>> {
    vec![
        Box::new(Unshadowed),
        Box::new(RayTraced),
        Box::new(ShExp),
        Box::new(ShadowField::new(cache.clone())),
        Box::new(CosineLobe),
        Box::new(Mask),
        Box::new(Analytic),
        Box::new(Prt::new(cache.clone())),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Presets are settings that the strategy takes, and change something.
    #[test]
    fn every_preset_can_be_set() {
        for info in strategies(&Cache::disabled()).iter().map(|strategy| strategy.info()) {
            for preset in info.presets {
                let params = info.parse(preset.name).unwrap_or_else(|error| panic!("{}: {error}", info.name));
                assert_ne!(params, info.defaults(), "{}: {}", info.name, preset.name);
                assert_eq!(params, info.parse(preset.settings).unwrap(), "{}: {}", info.name, preset.name);
            }
        }
    }

    /// Levels are values of their parameter, none twice, the default among them.
    #[test]
    fn every_level_can_be_set() {
        for info in strategies(&Cache::disabled()).iter().map(|strategy| strategy.info()) {
            for parameter in info.parameters.iter().filter(|parameter| !parameter.levels.is_empty()) {
                let set = |level: &&str| info.parse(&format!("{}={level}", parameter.name));
                let mut values = Vec::new();
                for level in parameter.levels {
                    let params = set(level).unwrap_or_else(|error| panic!("{}: {error}", info.name));
                    assert!(!values.contains(&params), "{}: {}={level} twice", info.name, parameter.name);
                    values.push(params);
                }
                assert!(values.contains(&info.defaults()), "{}: the default {} is no level", info.name, parameter.name);
            }
        }
    }

    #[test]
    fn every_stage_can_be_made_exact() {
        for info in strategies(&Cache::disabled()).iter().map(|strategy| strategy.info()) {
            for stage in info.stages {
                let exact = info.made_exact(&info.defaults(), stage);
                assert!(exact.is_ok(), "{}: {}: {:?}", info.name, stage.name, exact.err());
            }
        }
    }
}
