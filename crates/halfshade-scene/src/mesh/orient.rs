//! Triangles to turn around so that neighbours agree, body by body.

use super::{Welded, doubled_area_vector};

/// A body's share of an [`Orientation`].
#[derive(Debug, Clone, Copy)]
pub(super) struct OrientedBody {
    pub(super) closed: bool,
    pub(super) orientable: bool,
    pub(super) flipped_triangles: usize,
}

/// Bodies, edges, and the triangles to turn around.
#[derive(Debug, Clone)]
pub(super) struct Orientation {
    /// Body of each triangle.
    pub(super) body_of: Vec<u32>,
    /// Whether to turn each triangle around. Within a body, the choice that turns the smaller area.
    pub(super) flip: Vec<bool>,
    pub(super) bodies: Vec<OrientedBody>,
    pub(super) boundary_edges: usize,
    pub(super) non_manifold_edges: usize,
    pub(super) inconsistent_edges: usize,
}

/// Triangles that meet at edges. An edge with exactly two of them joins both into one body; turning is propagated
/// across such edges, breadth first. At edges of more triangles nothing can be said about who belongs to whom.
pub(super) fn orient(welded: &Welded) -> Orientation {
    let count = welded.triangles.len();
    // (low vertex, high vertex, triangle, runs from low to high), sorted, so that an edge's triangles are neighbours.
    let mut sides: Vec<(u32, u32, u32, bool)> = Vec::with_capacity(3 * count);
    for (t, &[a, b, c]) in welded.triangles.iter().enumerate() {
        sides.extend([(a, b), (b, c), (c, a)].map(|(from, to)| (from.min(to), from.max(to), t as u32, from < to)));
    }
    sides.sort_unstable();

    let mut neighbours: Vec<[Option<(u32, bool)>; 3]> = vec![[None; 3]; count];
    let (mut boundary_edges, mut non_manifold_edges, mut inconsistent_edges) = (0, 0, 0);
    for edge in sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        match *edge {
            [_] => boundary_edges += 1,
            [(_, _, s, s_rises), (_, _, t, t_rises)] => {
                let disagree = s_rises == t_rises;
                inconsistent_edges += usize::from(disagree);
                for (from, to) in [(s, t), (t, s)] {
                    if let Some(slot) = neighbours[from as usize].iter_mut().find(|slot| slot.is_none()) {
                        *slot = Some((to, disagree));
                    }
                }
            }
            _ => non_manifold_edges += 1,
        }
    }

    const NONE: u32 = u32::MAX;
    let mut body_of = vec![NONE; count];
    let mut flip = vec![false; count];
    let mut bodies = Vec::new();
    for seed in 0..count {
        if body_of[seed] != NONE {
            continue;
        }
        let body = bodies.len() as u32;
        body_of[seed] = body;
        let mut members = vec![seed];
        let (mut closed, mut orientable) = (true, true);
        let mut next = 0;
        while let Some(&t) = members.get(next) {
            next += 1;
            closed &= neighbours[t].iter().all(Option::is_some);
            for &(neighbour, disagree) in neighbours[t].iter().flatten() {
                let neighbour = neighbour as usize;
                let wanted = flip[t] != disagree;
                if body_of[neighbour] == NONE {
                    body_of[neighbour] = body;
                    flip[neighbour] = wanted;
                    members.push(neighbour);
                } else {
                    orientable &= flip[neighbour] == wanted;
                }
            }
        }
        if !orientable {
            members.iter().for_each(|&t| flip[t] = false);
        }
        let area = |flipped: bool| -> f64 {
            let part = members.iter().filter(|&&t| flip[t] == flipped);
            part.map(|&t| doubled_area_vector(welded.corners(t)).length()).sum()
        };
        if area(true) > area(false) {
            members.iter().for_each(|&t| flip[t] = !flip[t]);
        }
        let flipped_triangles = members.iter().filter(|&&t| flip[t]).count();
        bodies.push(OrientedBody { closed, orientable, flipped_triangles });
    }
    Orientation { body_of, flip, bodies, boundary_edges, non_manifold_edges, inconsistent_edges }
}
