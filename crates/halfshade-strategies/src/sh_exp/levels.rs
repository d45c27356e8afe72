//! The spheres of every object, from the leaves to coarser levels [Guerrero2007, 4.1 "Parent sphere construction"].

use halfshade_scene::{Scene, Sphere, SphereSet, spheres::SphereHierarchy, spheres::overlap_shares};
use std::sync::Arc;

/// What to do about spheres of one object that cover each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Overlap {
    /// Each counts in full [Guerrero2007, eq. 4.7]: a direction behind k spheres is blocked k times.
    Independent,
    /// Each counts by the share of its silhouette that is its own, see [`overlap_shares`]: about once.
    Shared,
}

/// Spheres of one object that bound it together.
#[derive(Debug, Clone)]
pub(super) struct Level {
    pub(super) spheres: Vec<Sphere>,
    /// How much of each sphere's logarithm counts.
    pub(super) shares: Vec<f32>,
    /// For each sphere those of the next finer level that it stands for; none in the leaves.
    pub(super) children: Vec<Vec<u32>>,
}

/// The levels of all sphere sets, kept from frame to frame.
#[derive(Debug, Clone)]
pub(super) struct Levels {
    overlap: Overlap,
    /// Children per parent; without it there are leaves only.
    branching: Option<usize>,
    known: Vec<(Arc<SphereSet>, Arc<[Level]>)>,
}

impl Levels {
    /// Of every object of `scene`, ahead of its first frame.
    pub(super) fn new(scene: &Scene, overlap: Overlap, branching: Option<usize>) -> Self {
        let mut levels = Self { overlap, branching, known: Vec::new() };
        for set in scene.objects.iter().filter(|object| object.sphere_count > 0).filter_map(|o| o.spheres.as_ref()) {
            levels.of(set);
        }
        levels
    }

    /// The levels of `set`, finest first.
    pub(super) fn of(&mut self, set: &Arc<SphereSet>) -> Arc<[Level]> {
        if let Some((_, levels)) = self.known.iter().find(|(known, _)| Arc::ptr_eq(known, set)) {
            return levels.clone();
        }
        let with_shares = |spheres: Vec<Sphere>, children| Level {
            shares: match self.overlap {
                Overlap::Independent => vec![1.0; spheres.len()],
                Overlap::Shared => overlap_shares(&spheres),
            },
            spheres,
            children,
        };
        let levels: Arc<[Level]> = match self.branching {
            None => Arc::new([with_shares(set.spheres.clone(), vec![Vec::new(); set.spheres.len()])]),
            Some(branching) => (SphereHierarchy::new(&set.spheres, branching, 0).levels.into_iter())
                .map(|level| with_shares(level.spheres, level.children))
                .collect(),
        };
        self.known.push((set.clone(), levels.clone()));
        levels
    }
}
