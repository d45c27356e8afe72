//! Pages of stored results.

use super::{
    all_runs::all_runs,
    by_class::error_by_class,
    details::details,
    differences::differences,
    error_cell::relative_rmse,
    error_split::error_split,
    groups::Group,
    page::{Block, Page, Picture},
    plot::Plot,
    scene_table::scene_table,
    stability::{overview, stability},
    stages::stages,
    verdict::verdicts,
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

/// The page for people: the verdicts, then tables, plots and pictures scene by scene.
pub fn page(results: &Results) -> Page {
    let provenance = provenance(results);
    let mut blocks = vec![
        Block::Title(results.experiment.clone()),
        Block::Note(results.claim.clone()),
        Block::Note(format!("{provenance}.")),
    ];
    blocks.extend(overview(results).into_iter().chain(verdicts(results)).map(Block::Table));
    let groups = Group::all(results);
    for (group, plot) in groups.iter().zip(Plot::error_against_time(results, &groups)) {
        blocks.push(Block::Heading(group.to_string()));
        blocks.push(Block::Table(scene_table(results, group)));
        blocks.extend(plot.map(Block::Plot));
        let further = [stability, error_by_class, error_split, stages, differences, details];
        blocks.extend(Plot::stacked(results, group).map(Block::Plot));
        blocks.extend(further.iter().filter_map(|table| table(results, group)).map(Block::Table));
        blocks.push(Block::Pictures(pictures(results, group)));
    }
    for (name, plot) in Plot::over_frames(results, &groups) {
        blocks.extend([Block::Heading(format!("{name}: over frames")), Block::Plot(plot)]);
    }
    Page { provenance, blocks }
}

/// Pictures of a group, each with its error. They are drawn of the first kind of receivers of the first frame.
fn pictures(results: &Results, group: &Group) -> Vec<Picture> {
    let own = results.pictures.iter().filter(|files| files.scene == group.scene && files.frame == group.frame);
    let error = |label: &str| {
        let run = group.strategies(results).into_iter().find(|run| run.label == label)?;
        Some(format!("relative RMSE {}", relative_rmse(&run.error.as_ref()?.metrics).text))
    };
    own.map(|files| Picture { files: files.clone(), error: error(&files.label) }).collect()
}

/// The page that a run ends with: a table per frame, and the verdicts.
pub fn summary(results: &Results) -> Page {
    let tables = Group::all(results).into_iter().map(|group| scene_table(results, &group));
    let blocks = tables.chain(overview(results)).chain(verdicts(results)).map(Block::Table).collect();
    Page { provenance: provenance(results), blocks }
}

/// The page for programs: every number of every run.
pub fn data(results: &Results) -> Page {
    Page { provenance: provenance(results), blocks: vec![Block::Table(all_runs(results))] }
}
