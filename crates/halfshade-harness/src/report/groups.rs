//! Groups of runs that are shown together.

use crate::results::{Results, Run};

/// Runs that are shown together: of one scene, frame and kind of receivers, against one reference.
pub(super) fn runs_of<'a>(
    results: &'a Results,
    scene: &'a str,
    frame: usize,
    receivers: &'a str,
) -> impl Iterator<Item = &'a Run> {
    results.runs.iter().filter(move |run| run.scene == scene && run.frame == frame && run.receivers == receivers)
}

/// Every (scene, frame, kind of receivers) there is, in order.
pub(super) fn groups(results: &Results) -> Vec<(String, usize, String)> {
    let mut groups: Vec<(String, usize, String)> = Vec::new();
    for run in &results.runs {
        let group = (run.scene.clone(), run.frame, run.receivers.clone());
        if !groups.contains(&group) {
            groups.push(group);
        }
    }
    groups
}
