//! The steps of a group: score and picture every strategy, time them in turn, compare pairs, collect the rows.

use super::{
    difference::difference_between,
    group::Group,
    picture::{difference_key, picture_difference, picture_truth, picture_variant},
    record::Record,
    score::{reference_rows, score},
    setup::Setup,
    shade::Shaded,
    time::{Ready, time},
};
use crate::{
    HarnessError, ReferenceKind, Results,
    results::{Run, Status, TimeFigures},
};
use halfshade_scene::RadianceBuffer;
use std::collections::BTreeMap;

/// Radiance of variants that are compared with each other, by place; `None` where shading failed.
type Compared = BTreeMap<usize, Option<RadianceBuffer>>;

/// Measures what the record doesn't know of a group yet, and adds all of it to the results.
pub(super) fn measure(
    setup: &Setup<'_>,
    group: &Group<'_>,
    record: &mut Record,
    results: &mut Results,
) -> Result<(), HarnessError> {
    if group.has_first() {
        if let Some(view) = &group.view {
            picture_truth(group, view, record)?;
        }
        results.runs.extend(reference_rows(group));
    }
    let (mut ready, compared) = score_all(setup, group, record)?;
    time(setup, group, &mut ready, record)?;
    setup.steps.add(if setup.plan.timing.is_some() { group.own.len() } else { 0 });
    if group.has_last() {
        compare_pairs(setup, group, compared, record, results)?;
    }
    collect(group, record, results);
    Ok(())
}

/// Scores and pictures every variant of which that isn't known; returns those that are to be timed.
fn score_all(
    setup: &Setup<'_>,
    group: &Group<'_>,
    record: &mut Record,
) -> Result<(Vec<Ready>, Compared), HarnessError> {
    let (plan, mut ready, mut compared) = (setup.plan, Vec::new(), Compared::new());
    for place in group.own.clone() {
        let key = &group.rows[place].key;
        let view = group
            .view
            .as_ref()
            .filter(|_| plan.pictured.contains(&plan.variants[place].key()) && record.picture(key).is_none());
        let known = record.scored(key);
        let has_ended = known.is_some_and(|runs| runs.iter().any(|run| run.status != Status::Ok));
        let is_known = known.is_some();
        if has_ended || (is_known && view.is_none() && setup.missing_samples(record, key) == 0) {
            setup.steps.add(1);
            continue;
        }
        let scored = score(setup, group, place);
        if !is_known {
            record.add_scored(key, scored.runs)?;
        }
        let radiance = scored.shaded.map(|Shaded { baked, radiance }| {
            if plan.timing.is_some() && setup.is_kept {
                ready.push(Ready { key: key.clone(), device: plan.variants[place].device, baked });
            }
            radiance
        });
        if let (Some(view), Some(radiance)) = (view, &radiance) {
            picture_variant(group, view, place, radiance, record)?;
        }
        if plan.is_compared(place) {
            compared.insert(place, radiance);
        }
        setup.steps.add(1);
    }
    Ok((ready, compared))
}

/// Draws the difference that is to be drawn, and compares the pairs that are to be compared.
fn compare_pairs(
    setup: &Setup<'_>,
    group: &Group<'_>,
    mut compared: Compared,
    record: &mut Record,
    results: &mut Results,
) -> Result<(), HarnessError> {
    let plan = setup.plan;
    let is_drawn = record.picture(&difference_key(group)).is_some();
    let drawn = group.view.as_ref().zip(plan.difference).filter(|_| !is_drawn);
    for place in plan.pairs.iter().copied().chain(drawn.map(|(_, pair)| pair)).flatten() {
        // A resumed run shades once more what it has scored before, and a shard what another one scores.
        let shade = || score(setup, group, place).shaded.map(|shaded| shaded.radiance);
        compared.entry(place).or_insert_with(shade);
    }
    let both = |[a, b]: [usize; 2]| compared.get(&a)?.as_ref().zip(compared.get(&b)?.as_ref());
    if let Some((view, pair)) = drawn
        && let Some((first, second)) = both(pair)
    {
        picture_difference(group, view, &plan.difference_label(pair), [first, second], record)?;
    }
    let weights = &group.references.mesh.reference.weights;
    let difference = |pair: &[usize; 2]| {
        let [a, b] = pair.map(|place| &group.rows[place].blank);
        let (first, second) = both(*pair)?;
        difference_between(first, second, weights, a, b)
    };
    results.differences.extend(plan.pairs.iter().filter_map(difference));
    Ok(())
}

/// Adds the rows and pictures of a group to the results, with the times of all rounds.
fn collect(group: &Group<'_>, record: &Record, results: &mut Results) {
    if group.view.is_some() {
        results.pictures.extend(record.truth_picture(&group.frame.scene.name, group.frame.index).cloned());
    }
    for row in &group.rows[group.own.clone()] {
        let (samples, picture) = (record.samples(&row.key), record.picture(&row.key));
        let complete = |mut run: Run| {
            if let Some(time) = run.time.as_mut().filter(|_| !samples.is_empty()) {
                *time = TimeFigures::of(time.bake_secs, time.threads, samples.to_vec());
            }
            if let (Some(error), Some((_, similarity))) = (&mut run.error, picture)
                && error.reference == ReferenceKind::Mesh.to_string()
            {
                error.similarity = *similarity;
            }
            run
        };
        results.runs.extend(record.scored(&row.key).unwrap_or_default().iter().cloned().map(complete));
        results.pictures.extend(picture.map(|(files, _)| files.clone()));
    }
    results.pictures.extend(record.picture(&difference_key(group)).map(|(files, _)| files.clone()));
}
