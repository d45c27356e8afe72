//! Parent spheres: coarser and coarser sphere sets over the same object ([Guerrero2007, 4.1, "Parent sphere
//! construction"]).
//!
//! The spheres of a level are grouped by Lloyd's iteration on their centres: each joins the parent with the nearest
//! centre, and each parent becomes the smallest sphere that contains its children wholly. Neither step enlarges the
//! largest parent: |c − x| + r falls for a child (x, r) that comes nearer to a centre c, and the smallest sphere is no
//! larger than the one about the old centre. The thesis starts from random places and minimizes radii by Powell's
//! method; here places are spread, as for receiver clusters, and radii are exact.
//!
//! Every level bounds the leaves, with ever more outside volume. That holds for leaves that were fitted to shadows too: which
//! spheres a receiver sees is decided by how large the largest of them may look, so that parents must contain their
//! children, and what a parent hides too much is scaled to what its children hide [Guerrero2007, eq. 4.9].

use super::enclosing::enclosing_sphere;
use super::{DSphere, Sphere};
use crate::clusters::{at_least, lloyd, members};
use glam::DVec3;

/// Levels of spheres over the same object, finest first.
#[derive(Debug, Clone, PartialEq)]
pub struct SphereHierarchy {
    /// The leaves in the order given, then parents, then their parents, up to a level of one sphere.
    pub levels: Vec<HierarchyLevel>,
}

/// One level of a hierarchy.
#[derive(Debug, Clone, PartialEq)]
pub struct HierarchyLevel {
    /// Each contains its children wholly, rounding included.
    pub spheres: Vec<Sphere>,
    /// For each sphere, its children as rising indices into the next finer level, never none; empty for leaves.
    pub children: Vec<Vec<u32>>,
}

impl SphereHierarchy {
    /// Builds parents over `leaves` (finite) until one sphere is left.
    ///
    /// A level of n spheres has n / `branching` parents, rounded up; a branching factor below 2 counts as 2. No leaves
    /// give one level without spheres. The same seed gives the same bits, whatever the number of threads. Takes
    /// milliseconds for hundreds of leaves.
    pub fn new(leaves: &[Sphere], branching: usize, seed: u64) -> Self {
        let mut levels = vec![HierarchyLevel { spheres: leaves.to_vec(), children: vec![Vec::new(); leaves.len()] }];
        while let Some(finest) = levels.last().filter(|level| level.spheres.len() > 1) {
            let coarser = parents(&finest.spheres, finest.spheres.len().div_ceil(branching.max(2)), seed);
            levels.push(coarser);
        }
        Self { levels }
    }
}

/// The level of `count` spheres over `spheres`, of which there are as many or more.
fn parents(spheres: &[Sphere], count: usize, seed: u64) -> HierarchyLevel {
    let exact: Vec<DSphere> = spheres.iter().map(|s| in_f64(*s)).collect();
    let centers: Vec<DVec3> = exact.iter().map(|sphere| sphere.center).collect();
    let (assignment, places) = lloyd(&centers, count, seed, |own| smallest_around(&exact, own));
    let children = members(&assignment, count);
    let bound = |(place, own): (&DVec3, &Vec<u32>)| {
        let center = place.as_vec3();
        let reach = |&k: &u32| exact[k as usize].center.distance(center.as_dvec3()) + exact[k as usize].radius;
        Sphere { center, radius: at_least(own.iter().map(reach).fold(0.0, f64::max)) }
    };
    HierarchyLevel { spheres: places.iter().zip(&children).map(bound).collect(), children }
}

fn in_f64(sphere: Sphere) -> DSphere {
    DSphere { center: sphere.center.as_dvec3(), radius: f64::from(sphere.radius) }
}

/// Centre and radius of the smallest sphere around those of `spheres` with the indices `own`.
fn smallest_around(spheres: &[DSphere], own: &[u32]) -> (DVec3, f64) {
    let own: Vec<DSphere> = own.iter().map(|&k| spheres[k as usize]).collect();
    let DSphere { center, radius } = enclosing_sphere(&own);
    (center, radius)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clusters::{assign, spread_centers};
    use glam::Vec3;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    fn sphere(x: f32, y: f32, z: f32, radius: f32) -> Sphere {
        Sphere { center: Vec3::new(x, y, z), radius }
    }

    fn random_spheres(count: usize, scale: f32, seed: u64) -> Vec<Sphere> {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        (0..count)
            .map(|_| {
                let center = Vec3::from_array(std::array::from_fn(|_| random.random_range(-1.0..1.0f32)));
                Sphere { center: scale * center, radius: scale * random.random_range(0.01..0.2f32) }
            })
            .collect()
    }

    /// The levels have the counts due, every sphere has one parent, and every parent contains its children.
    fn check(leaves: &[Sphere], branching: usize) -> SphereHierarchy {
        let hierarchy = SphereHierarchy::new(leaves, branching, 1);
        let levels = &hierarchy.levels;
        assert_eq!(levels[0].spheres, leaves);
        assert!(levels[0].children.len() == leaves.len() && levels[0].children.iter().all(Vec::is_empty));
        assert!(levels[levels.len() - 1].spheres.len() <= 1);
        for pair in levels.windows(2) {
            let [finer, coarser] = pair else { unreachable!() };
            assert_eq!(coarser.spheres.len(), finer.spheres.len().div_ceil(branching.max(2)));
            assert_eq!(coarser.children.len(), coarser.spheres.len());
            let mut parents = vec![0; finer.spheres.len()];
            for (parent, children) in coarser.spheres.iter().zip(&coarser.children) {
                assert!(!children.is_empty() && children.is_sorted());
                for &child in children {
                    parents[child as usize] += 1;
                    let (inner, outer) = (in_f64(finer.spheres[child as usize]), in_f64(*parent));
                    assert!(inner.center.distance(outer.center) + inner.radius <= outer.radius, "{inner:?} {outer:?}");
                }
            }
            assert!(parents.iter().all(|&n| n == 1), "{parents:?}");
        }
        hierarchy
    }

    #[test]
    fn levels_count_down_by_the_branching_factor_and_contain_each_other() {
        let spheres = random_spheres(512, 1.0, 3);
        let counts = |branching| check(&spheres, branching).levels.iter().map(|l| l.spheres.len()).collect::<Vec<_>>();
        assert_eq!(counts(4), [512, 128, 32, 8, 2, 1]);
        assert_eq!(counts(8), [512, 64, 8, 1]);
        assert_eq!(counts(600), [512, 1]);
        assert_eq!(counts(0), counts(2));
    }

    #[test]
    fn every_scale_gives_the_same_tree() {
        let unit = check(&random_spheres(100, 1.0, 7), 5);
        for scale in [1e-3f32, 1e3] {
            let scaled = check(&random_spheres(100, scale, 7), 5);
            assert_eq!(scaled.levels.len(), unit.levels.len());
            let top = |h: &SphereHierarchy| h.levels[h.levels.len() - 1].spheres[0].radius;
            // Rounded centres may order a tie otherwise, so that groups differ; the whole may hardly.
            assert!((top(&scaled) / (scale * top(&unit)) - 1.0).abs() < 0.05);
        }
    }

    #[test]
    fn few_equal_and_concentric_spheres() {
        assert_eq!(check(&[], 4).levels.len(), 1);
        assert_eq!(check(&random_spheres(1, 1.0, 1), 4).levels.len(), 1);
        // Copies need no larger parent, concentric spheres none larger than the largest.
        let same = [sphere(1.0, -2.0, 3.0, 0.7); 33];
        for level in check(&same, 3).levels {
            assert!(level.spheres.iter().all(|s| *s == same[0]));
        }
        let concentric: Vec<Sphere> = (1..20).map(|k| sphere(0.1, 0.2, 0.3, 0.1 * k as f32)).collect();
        let levels = check(&concentric, 4).levels;
        assert_eq!(levels[levels.len() - 1].spheres, [concentric[18]]);
    }

    #[test]
    fn far_heaps_get_parents_of_their_own() {
        let heap = random_spheres(20, 1.0, 2);
        let both: Vec<Sphere> = [0.0, 50.0]
            .iter()
            .flat_map(|&x| heap.iter().map(move |s| Sphere { center: s.center + Vec3::new(x, 0.0, 0.0), ..*s }))
            .collect();
        for seed in 0..20 {
            let level = &SphereHierarchy::new(&both, 20, seed).levels[1];
            assert_eq!(level.spheres.len(), 2);
            assert!(level.spheres.iter().all(|s| s.radius < 2.0), "{seed}: {:?}", level.spheres);
        }
    }

    #[test]
    fn a_round_never_enlarges_the_largest_parent() {
        for seed in 0..10 {
            let exact: Vec<DSphere> = random_spheres(200, 1.0, seed).into_iter().map(in_f64).collect();
            let points: Vec<DVec3> = exact.iter().map(|b| b.center).collect();
            let mut centers = spread_centers(&points, 12, seed);
            let mut before = f64::INFINITY;
            for _ in 0..10 {
                let found: Vec<_> =
                    members(&assign(&points, &centers), 12).iter().map(|own| smallest_around(&exact, own)).collect();
                let now = found.iter().map(|b| b.1).fold(0.0, f64::max);
                assert!(now <= before * (1.0 + 1e-12), "{now} after {before}");
                (centers, before) = (found.iter().map(|b| b.0).collect(), now);
            }
        }
    }

    #[test]
    fn the_same_seed_gives_the_same_levels_on_any_number_of_threads() {
        let spheres = random_spheres(90, 1.0, 4);
        let with_threads = |n| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
            pool.install(|| SphereHierarchy::new(&spheres, 4, 6))
        };
        assert_eq!(with_threads(1), with_threads(3));
        assert_ne!(with_threads(1), SphereHierarchy::new(&spheres, 4, 7));
    }
}
