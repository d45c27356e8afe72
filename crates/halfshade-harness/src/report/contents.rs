//! Pages of stored results.

use super::{
    all_runs::all_runs,
    by_class::error_by_class,
    details::details,
    differences::differences,
    error_split::error_split,
    groups::groups,
    page::{Block, Page},
    plot::Plot,
    scene_table::scene_table,
};
use crate::Results;

/// Source of the numbers, in one line.
pub fn provenance(results: &Results) -> String {
    format!(
        "halfshade {}: experiment {}{}, {} threads of {}, {}",
        results.revision,
        results.experiment,
        if results.quick { " (quick: not for publication)" } else { "" },
        results.machine.threads,
        results.machine.cpu,
        results.machine.os
    )
}

/// The page for people: tables, plots and pictures scene by scene.
pub fn page(results: &Results) -> Page {
    let provenance = provenance(results);
    let mut blocks = vec![
        Block::Title(results.experiment.clone()),
        Block::Note(results.claim.clone()),
        Block::Note(format!("{provenance}.")),
    ];
    for (scene, frame, receivers) in groups(results) {
        blocks.push(Block::Heading(format!("{scene}, frame {frame}, {receivers}")));
        blocks.push(Block::Table(scene_table(results, &scene, frame, &receivers)));
        blocks.extend(Plot::error_against_time(results, &scene, frame, &receivers).map(Block::Plot));
        let further = [error_by_class, error_split, differences, details];
        blocks.extend(further.iter().filter_map(|table| table(results, &scene, frame, &receivers)).map(Block::Table));
        let pictures = results.pictures.iter().filter(|files| files.scene == scene && files.frame == frame);
        blocks.push(Block::Pictures(pictures.cloned().collect()));
    }
    Page { provenance, blocks }
}

/// The page for programs: every number of every run.
pub fn data(results: &Results) -> Page {
    Page { provenance: provenance(results), blocks: vec![Block::Table(all_runs(results))] }
}
