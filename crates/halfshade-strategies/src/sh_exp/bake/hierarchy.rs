//! The spheres of every object, from the leaves to coarser levels [Guerrero2007, 4.1 "Parent sphere construction"].

use crate::{sh_exp::settings::Overlap, shared::placed_spheres};
use halfshade_scene::{
    Deformed, Mesh, Object, Scene, Sphere, SphereSet,
    spheres::{Followed, SphereBinding, SphereHierarchy, overlap_shares},
};
use std::sync::Arc;

/// Spheres that stand for one object together.
#[derive(Debug, Clone)]
pub(crate) struct Level {
    pub(crate) spheres: Vec<Sphere>,
    /// How much of each sphere's logarithm counts.
    pub(crate) shares: Vec<f32>,
    /// For each sphere those of the next finer level that it stands for; none in the leaves.
    pub(crate) children: Vec<Vec<u32>>,
    /// How the spheres follow their mesh, if it deforms.
    binding: Option<SphereBinding>,
}

impl Level {
    /// The spheres of a level of `mesh` where it is now.
    pub(crate) fn followed(&self, mesh: &Mesh, deformed: Option<&Deformed>) -> Vec<Followed> {
        placed_spheres::followed(&self.spheres, self.binding.as_ref(), mesh, deformed)
    }
}

/// The levels of all sphere sets, kept from frame to frame.
#[derive(Debug, Clone)]
pub(crate) struct Hierarchies {
    overlap: Overlap,
    /// Children per parent; without it there are leaves only.
    branching: Option<usize>,
    known: Vec<Known>,
}

/// Hierarchies, and what they were made of.
#[derive(Debug, Clone)]
struct Known {
    set: Arc<SphereSet>,
    /// Only of a mesh that deforms.
    mesh: Option<Arc<Mesh>>,
    levels: Arc<[Level]>,
}

/// Shares w_i to the power of `1 - w̄`, w̄ being their mean by area.
///
/// A few spheres that hardly overlap are best left alone: what shares of all views take from them is missing in most. Of many
/// that lie in each other the sum counts every direction several times, and shares are right. The power leads from the one to
/// the other (`results/spheres-vs-error`).
fn balanced_shares(spheres: &[Sphere]) -> Vec<f32> {
    let shares = overlap_shares(spheres);
    let area = |sphere: &Sphere| f64::from(sphere.radius).powi(2);
    let whole: f64 = spheres.iter().map(area).sum();
    let own: f64 = spheres.iter().zip(&shares).map(|(sphere, share)| area(sphere) * f64::from(*share)).sum();
    // Radii may be so small that their squares vanish.
    let power = if whole > 0.0 { 1.0 - own / whole } else { 0.0 };
    shares.iter().map(|share| share.powf(power as f32)).collect()
}

impl Hierarchies {
    /// The levels of every object of `scene`, ahead of its first frame.
    pub(crate) fn new(scene: &Scene, overlap: Overlap, branching: Option<usize>) -> Self {
        let mut levels = Self { overlap, branching, known: Vec::new() };
        for object in &scene.objects {
            levels.of(object);
        }
        levels
    }

    pub(crate) fn bytes(&self) -> usize {
        let bindings = self.known.iter().flat_map(|known| &*known.levels).filter_map(|level| level.binding.as_ref());
        bindings.map(SphereBinding::bytes).sum()
    }

    /// The levels of an object that blocks, finest first; `None` if it doesn't or its sphere set is not built.
    pub(crate) fn of(&mut self, object: &Object) -> Option<Arc<[Level]>> {
        let set = object.spheres.as_ref().filter(|_| object.sphere_count > 0)?;
        let mesh = object.skin.as_ref().map(|_| &object.mesh);
        let is_known = |known: &&Known| {
            Arc::ptr_eq(&known.set, set) && known.mesh.as_ref().map(Arc::as_ptr) == mesh.map(Arc::as_ptr)
        };
        if let Some(known) = self.known.iter().find(is_known) {
            return Some(known.levels.clone());
        }
        let with_shares = |spheres: Vec<Sphere>, children| Level {
            binding: mesh.map(|mesh| SphereBinding::new(mesh, &spheres, set.fit)),
            shares: match self.overlap {
                Overlap::Independent => vec![1.0; spheres.len()],
                Overlap::Shared => overlap_shares(&spheres),
                Overlap::Balanced => balanced_shares(&spheres),
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
        self.known.push(Known { set: set.clone(), mesh: mesh.cloned(), levels: levels.clone() });
        Some(levels)
    }
}
