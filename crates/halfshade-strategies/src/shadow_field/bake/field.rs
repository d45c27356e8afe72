//! An object occlusion field [Tamura2006, 5.1]: shells of sample points, thinned out and stored in few bits.

use super::{
    adaptive::{kept_shells, thinned},
    basis::Storage,
    bounds::BoundingSphere,
    projected::{ProjectedField, ShellLayout},
    shell::{Shell, VectorOf},
};
use crate::shadow_field::kernel::shell_grid::{Corners, between_shells};
use glam::Vec3;
use serde::{Deserialize, Serialize};
use wide::f32x8;

/// Occlusion by one object, around it.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Field<S> {
    /// Centre of the shells, in the object's space.
    pub(crate) center: Vec3,
    /// Radius of the object's bounding sphere.
    pub(crate) radius: f32,
    /// Radii of the shells, from 0, in radii of the object.
    pub(crate) radii: Vec<f32>,
    pub(crate) shells: Vec<S>,
    /// By distance from the centre in steps of the finest spacing, the next shell outward.
    pub(crate) outer: Vec<u8>,
    /// How the shells lay before some were left out.
    pub(crate) layout: ShellLayout,
}

/// How a field is thinned out.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct Thinning {
    /// Largest error at any original sample point; `None` keeps all of them.
    pub(crate) threshold: Option<f64>,
    /// Whether shells may go too.
    pub(crate) drops_shells: bool,
}

/// By distance from the centre in steps of the finest spacing, the next of the shells of these `radii` outward.
fn outer_shells(radii: &[f32], layout: ShellLayout) -> Vec<u8> {
    let steps = (radii.last().unwrap_or(&0.0) / layout.step()).round() as usize;
    let next = |step: usize| {
        let middle = (step as f32 + 0.5) * layout.step();
        radii.partition_point(|&radius| radius <= middle) as u8
    };
    (0..steps).map(next).collect()
}

impl<S: Shell> Field<S> {
    /// Whether it is made of samples that lie so around `bounds`: from the centre to the outermost of their shells.
    pub(crate) fn fits(&self, bounds: BoundingSphere, layout: ShellLayout, is_shell: impl Fn(&S) -> bool) -> bool {
        let (radii, outermost) = (layout.radii(), self.radii.last().copied());
        (BoundingSphere { center: self.center, radius: self.radius }, self.layout) == (bounds, layout)
            && outermost == radii.last().copied()
            && self.radii.first() == Some(&0.0)
            && self.radii.is_sorted_by(|a, b| a < b)
            && self.radii[1..].iter().all(|radius| radii.contains(radius))
            && self.shells.len() == self.radii.len()
            && self.shells.iter().all(|shell| shell.resolution() <= layout.resolution && is_shell(shell))
            && self.outer == outer_shells(&self.radii, layout)
    }

    /// Thins a field out and stores it.
    pub(crate) fn new(
        basis: &S::Basis,
        projected: &ProjectedField<VectorOf<S>>,
        thinning: Thinning,
        storage: Storage,
    ) -> Self {
        let ProjectedField { center, radius, layout, radii, shells } = projected;
        let all = || (0..shells.len()).collect();
        let (kept, shells): (Vec<usize>, Vec<S>) = match thinning.threshold {
            Some(threshold) => {
                let grids: Vec<_> = shells.iter().map(|grid| thinned(basis, grid, threshold)).collect();
                let drops = thinning.drops_shells;
                let kept = if drops { kept_shells(basis, (radii, shells), &grids, threshold) } else { all() };
                let stored = kept.iter().map(|&number| S::store(basis, &grids[number], storage)).collect();
                (kept, stored)
            }
            None => (all(), shells.iter().map(|grid| S::store(basis, grid, storage)).collect()),
        };
        let radii: Vec<f32> = kept.iter().map(|&number| radii[number]).collect();
        let outer = outer_shells(&radii, *layout);
        Self { center: *center, radius: *radius, radii, shells, outer, layout: *layout }
    }

    /// Memory that it takes.
    pub(crate) fn bytes(&self) -> usize {
        self.shells.iter().map(Shell::bytes).sum()
    }

    /// Points along longitude that are left of every shell that was sampled, from inside out; 0: the shell is gone.
    pub(crate) fn resolutions(&self) -> Vec<usize> {
        let resolution = |radius: f32| {
            let kept = self.radii.iter().position(|kept| *kept == radius);
            kept.map_or(0, |number| self.shells[number].resolution())
        };
        self.layout.radii().into_iter().map(resolution).collect()
    }

    /// Adds the occlusion at eight places in shell coordinates, of which as many count as there are sums: distance from
    /// the centre in radii of the object, longitude and latitude as shares of the whole.
    ///
    /// Continuous: the centre is a shell of one point, and past the last shell what is blocked shrinks as the object's
    /// solid angle does.
    #[inline]
    pub(crate) fn add_at(&self, [distance, u, v]: [f32x8; 3], sums: &mut [S::Sum]) {
        let (outer, shares) = between_shells(distance, &self.radii, &self.outer, self.layout.step());
        for (inward, share) in [1, 0].into_iter().zip(shares) {
            let shells = outer.map(|outer| &self.shells[outer - inward]);
            let corners = Corners::new(f32x8::from(shells.map(|shell| shell.resolution() as f32)), u, v);
            for (k, sum) in sums.iter_mut().enumerate() {
                let share = share.as_array()[k];
                if share > 0.0 {
                    shells[k].add(corners.lane(k), share, sum);
                }
            }
        }
    }
}
