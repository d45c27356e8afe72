//! Local principal components [Sloan2003, 5]: clusters of rows, each near a flat of its own.
//!
//! Two steps alternate, as in k-means: every cluster gets the flat of its rows with the least error, and every row goes to the
//! flat that it is nearest to. First flats are points (vector quantization), then they get all of their dimensions. Neither
//! step makes the sum of squared errors larger; they end when it falls by less than a thousandth, or after so many rounds.
//!
//! A row is asked about the clusters alone whose means are nearest to the mean of its own, itself among them: with
//! as few clusters as that the search is whole. Far ones would seldom be better, and on a flat that happens to pass near a row far from its
//! mean nothing nearby would lie.

use super::{
    principal::Flat,
    rounded::RoundedFlat,
    seeds::seed,
    table::{Rows, squared_distance},
};
use halfshade_scene::Progress;
use rayon::prelude::*;

/// Clusters that a row may go to.
const NEIGHBOURS: usize = 32;

/// Rounds with points, and rounds with flats, at most.
pub(crate) const ROUNDS: usize = 20;

/// Fall of the error, as a part of it, with which rounds end.
const LEAST_FALL: f64 = 1e-3;

/// A cluster of rows.
#[derive(Debug)]
pub(crate) struct Cluster {
    pub(crate) flat: Flat,
    /// Numbers of its rows, ascending.
    pub(crate) members: Vec<u32>,
}

/// At most so many clusters, none without rows, with flats of at most so many dimensions.
pub(crate) fn clusters(rows: &Rows, count: usize, components: usize, progress: &dyn Progress) -> Vec<Cluster> {
    let (mut of_row, count) = seed(rows, count);
    for components in if components == 0 { vec![0] } else { vec![0, components] } {
        if count > 1 {
            of_row = refine(rows, of_row, count, components, progress);
        }
    }
    let members = members(&of_row, count).into_par_iter().filter(|members| !members.is_empty());
    members.map(|members| Cluster { flat: Flat::fit(rows, &members, components), members }).collect()
}

/// Rounds with flats of so many dimensions: the cluster of each row.
fn refine(rows: &Rows, mut of_row: Vec<u32>, count: usize, components: usize, progress: &dyn Progress) -> Vec<u32> {
    let mut known: Vec<(Vec<u32>, RoundedFlat)> = Vec::new();
    let mut before = f64::INFINITY;
    for _ in 0..ROUNDS {
        known = fit(rows, members(&of_row, count), components, known);
        let (next, error) = assign(rows, &of_row, &known);
        progress.advance(1);
        if error >= before {
            break;
        }
        let is_done = error > (1.0 - LEAST_FALL) * before || next == of_row;
        (of_row, before) = (next, error);
        if is_done {
            break;
        }
    }
    of_row
}

/// Flats of all clusters, those of clusters that have changed anew. Who has lost all rows keeps its flat, and may get rows again.
fn fit(
    rows: &Rows,
    members: Vec<Vec<u32>>,
    components: usize,
    known: Vec<(Vec<u32>, RoundedFlat)>,
) -> Vec<(Vec<u32>, RoundedFlat)> {
    let known = known.into_iter().map(Some).chain(std::iter::repeat_with(|| None));
    let pairs: Vec<_> = members.into_iter().zip(known).collect();
    let fitted = pairs.into_par_iter().map(|(members, known)| match known {
        Some(known) if known.0 == members || members.is_empty() => known,
        _ => {
            let flat = RoundedFlat::new(&Flat::fit(rows, &members, components));
            (members, flat)
        }
    });
    fitted.collect()
}

/// The nearest flat of each row, and the sum of squared errors.
fn assign(rows: &Rows, of_row: &[u32], flats: &[(Vec<u32>, RoundedFlat)]) -> (Vec<u32>, f64) {
    let neighbours: Vec<Vec<u32>> = (0..flats.len()).into_par_iter().map(|own| nearest(flats, own)).collect();
    let best = |(number, &own): (usize, &u32)| {
        let row = rows.eights(number as u32);
        let error = |&cluster: &u32| flats[cluster as usize].1.squared_error(row);
        // Its own comes first and is left for a lesser error alone.
        neighbours[own as usize]
            .iter()
            .map(|cluster| (*cluster, error(cluster)))
            .reduce(|a, b| if b.1 < a.1 { b } else { a })
    };
    let found: Vec<(u32, f32)> = of_row.par_iter().enumerate().filter_map(best).collect();
    let error = found.iter().map(|(_, error)| f64::from(*error)).sum();
    (found.into_iter().map(|(cluster, _)| cluster).collect(), error)
}

/// Itself, then the clusters with the nearest means.
fn nearest(flats: &[(Vec<u32>, RoundedFlat)], own: usize) -> Vec<u32> {
    let distance = |cluster: usize| squared_distance(&flats[cluster].1.mean, &flats[own].1.mean);
    let mut others: Vec<(f32, u32)> =
        (0..flats.len()).filter(|&other| other != own).map(|other| (distance(other), other as u32)).collect();
    let by_distance = |a: &(f32, u32), b: &(f32, u32)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
    if others.len() >= NEIGHBOURS {
        others.select_nth_unstable_by(NEIGHBOURS - 1, by_distance);
        others.truncate(NEIGHBOURS - 1);
    }
    others.sort_unstable_by(by_distance);
    std::iter::once(own as u32).chain(others.into_iter().map(|(_, other)| other)).collect()
}

/// Rows by cluster.
fn members(of_row: &[u32], count: usize) -> Vec<Vec<u32>> {
    let mut members = vec![Vec::new(); count];
    of_row.iter().enumerate().for_each(|(row, &cluster)| members[cluster as usize].push(row as u32));
    members
}
