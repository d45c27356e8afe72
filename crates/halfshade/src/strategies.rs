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
}
