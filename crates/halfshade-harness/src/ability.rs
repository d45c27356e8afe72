//! Whether a strategy can model a scene, and who can where it can't.

use halfshade_scene::Scene;
use halfshade_strategy::{Effects, Strategy};

/// Why `strategy` can't model `scene`, with the names of those of `all` that can; `None` if it can.
pub fn inability(strategy: &dyn Strategy, scene: &Scene, all: &[Box<dyn Strategy>]) -> Option<String> {
    let required = Effects::required_by(scene);
    let missing = strategy.info().effects.missing(required);
    if missing.is_empty() {
        return None;
    }
    let infos = all.iter().map(|strategy| strategy.info());
    let able: Vec<&str> =
        infos.filter(|info| info.effects.missing(required).is_empty()).map(|info| info.name).collect();
    let who = match &able[..] {
        [] => "no strategy can".to_owned(),
        [only] => format!("{only} can"),
        [others @ .., last] => format!("{} and {last} can", others.join(", ")),
    };
    Some(format!("can't model {missing}; {who}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toy;
    use halfshade_scene::Environment;
    use halfshade_strategy::Effect;

    #[test]
    fn those_who_can_are_named() {
        let scene =
            |bounces| Scene { bounces, ..Scene::at_rest("s", Vec::new(), Environment::constant(glam::Vec3::ONE)) };
        let all = toy::strategies();
        assert_eq!(inability(all[0].as_ref(), &scene(0), &all), None);
        let reason = inability(all[0].as_ref(), &scene(1), &all).unwrap();
        assert_eq!(reason, format!("can't model {}; no strategy can", Effect::Interreflection.name()));
    }
}
