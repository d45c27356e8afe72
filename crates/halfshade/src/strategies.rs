//! The only list of strategies.

use halfshade_scene::Cache;
use halfshade_strategies::{CosineLobe, RayTraced, ShExp, ShadowField, Unshadowed};
use halfshade_strategy::Strategy;

/// Every strategy there is. `cache` is for what they bake.
pub fn strategies(cache: &Cache) -> Vec<Box<dyn Strategy>> {
    vec![
        Box::new(Unshadowed),
        Box::new(RayTraced),
        Box::new(ShExp),
        Box::new(ShadowField::new(cache.clone())),
        Box::new(CosineLobe),
    ]
}
