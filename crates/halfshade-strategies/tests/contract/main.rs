//! Every strategy, and every exponential variant, against the contract.

#[path = "../cached_fields.rs"]
mod cached_fields;

use cached_fields::{kept, shadow_fields};
use halfshade_strategies::{Analytic, CosineLobe, Mask, Prt, RayTraced, ShExp, ShadowField, Unshadowed};
use halfshade_strategy::{
    Strategy,
    contract::{self, Bounds},
    contract_tests,
};

/// No visibility, no noise: what is left is the table over normals.
const TABLE: Bounds = Bounds { constant: 1e-5, quadrature: 0.01, gloss: 0.01, rotation: 0.005, brightening: 0.0 };

contract_tests!(unshadowed, Unshadowed, "", TABLE);

/// Noise: samples are turned neither with the scene nor with its number of blockers.
const NOISE: Bounds = Bounds { constant: 1e-4, quadrature: 0.1, gloss: 0.1, rotation: 0.25, brightening: 0.25 };

contract_tests!(ray_traced_mis, RayTraced, "plain,samples=256", Bounds { quadrature: 0.15, gloss: 0.15, ..NOISE });
contract_tests!(
    ray_traced_light,
    RayTraced,
    "plain,samples=512,sampling=light",
    Bounds { quadrature: 0.3, gloss: 0.3, constant: 0.1, ..NOISE }
);
// One ray in five hundred finds the sun, one in ninety the lamp.
contract_tests!(
    ray_traced_cosine,
    RayTraced,
    "plain,samples=1024,sampling=cosine",
    Bounds { quadrature: 0.8, gloss: 1.2, rotation: 1.5, brightening: 1.5, ..NOISE }
);

contract_tests!(
    ray_traced_ratio,
    RayTraced,
    "unfiltered,samples=256,sampling=mis",
    Bounds { quadrature: 0.15, gloss: 0.15, brightening: 0.0, ..NOISE }
);

/// Light is known: as good as a table without blockers.
const SHARES: Bounds = Bounds { constant: 1e-5, quadrature: 0.01, gloss: 0.15, rotation: 0.1, brightening: 1e-6 };

contract_tests!(ray_traced_product, RayTraced, "unfiltered,samples=256", SHARES);
contract_tests!(ray_traced_filtered, RayTraced, "samples=64", Bounds { gloss: 0.8, rotation: 0.3, ..SHARES });

/// Ringing of four bands under a sun: a blocker beside the sun may brighten its ray.
const RINGING: Bounds = Bounds { constant: 1e-5, quadrature: 0.01, gloss: 0.01, rotation: 0.005, brightening: 0.2 };

contract_tests!(sh_exp_hybrid, ShExp, "bounces=0,exp=hybrid,normals=16,own-directions=16", RINGING);
contract_tests!(sh_exp_product, ShExp, "bounces=0,exp=product,normals=16,own-directions=16", RINGING);
contract_tests!(sh_exp_series, ShExp, "bounces=0,exp=series,normals=16,own-directions=16", RINGING);
contract_tests!(
    sh_exp_bare_series,
    ShExp,
    "bounces=0,exp=series,scaling=off,normals=16,own-directions=16",
    Bounds { brightening: 2.0, ..RINGING }
);
contract_tests!(sh_exp_quadratic, ShExp, "bounces=0,exp=quadratic,normals=16,own-directions=16", RINGING);
contract_tests!(sh_exp_shares, ShExp, "bounces=0,exp=shares,normals=16,own-directions=16", RINGING);
contract_tests!(sh_exp_optimal_linear, ShExp, "bounces=0,exp=optimal-linear,normals=16,own-directions=16", RINGING);
contract_tests!(sh_exp_six_bands, ShExp, "bounces=0,exp=hybrid,bands=6,normals=16,own-directions=16", RINGING);
contract_tests!(sh_exp_tree, ShExp, "bounces=0,levels=tree,normals=16,own-directions=16", RINGING);
contract_tests!(sh_exp_reflections, ShExp, "", RINGING);
contract_tests!(
    sh_exp_by_spheres,
    ShExp,
    "own=spheres,sun=projected,ground=ignored,normals=16,own-directions=16",
    RINGING
);
contract_tests!(
    sh_exp_traced,
    ShExp,
    "exp=traced,directions=512,normals=16,own-directions=16",
    Bounds { rotation: 0.05, ..RINGING }
);
contract_tests!(sh_exp_as_published, ShExp, "as-published,bands=3,normals=16,own-directions=16", RINGING);
contract_tests!(
    sh_exp_reflections_precomputed,
    ShExp,
    "intersections=precomputed,order=power,normals=16,own-directions=16",
    RINGING
);

/// Four bands of everything: the clamped cosine alone is off by a twentieth of its peak, which a lamp shows, most where its
/// light is faint; a highlight of exponent 15 is off by a sixth of its height, which is many times the mean.
const FIELDS: Bounds = Bounds { constant: 0.02, quadrature: 0.5, gloss: 3.0, rotation: 0.1, brightening: 0.2 };

contract_tests!(shadow_field, shadow_fields(), "shells=8,resolution=8,map=32", FIELDS);
contract_tests!(
    shadow_field_as_floats,
    shadow_fields(),
    "shells=8,resolution=8,map=32,sampling=fixed,storage=f32,own=projected,bands=3",
    FIELDS
);

/// Texels of 11 degrees, hardly smaller than the lamp and the lobes; and a turned cube is looked up.
const TEXELS: Bounds = Bounds { constant: 0.02, quadrature: 0.5, gloss: 1.0, rotation: 0.1, brightening: 0.0 };

contract_tests!(shadow_field_haar, shadow_fields(), "basis=haar,face=16,shells=8,resolution=8,kept=0.1", TEXELS);
contract_tests!(
    shadow_field_haar_by_wavelets,
    shadow_fields(),
    "basis=haar,face=8,shells=8,resolution=8,kept=0.1,product=wavelets,sampling=adaptive-shells",
    // Nothing holds what is hidden within [0, 1].
    Bounds { brightening: 0.02, ..TEXELS }
);

/// Without a cache, from which the second of two bakings would read what the first made.
#[test]
fn what_is_kept_was_made_without_spheres() {
    let cases: [(&dyn Strategy, &str); 3] = [
        (&ShadowField::default(), "shells=8,resolution=8,map=32"),
        (&ShadowField::default(), "basis=haar,face=8,shells=8,resolution=8"),
        (&Prt::default(), "directions=16"),
    ];
    for (strategy, settings) in cases {
        let params = strategy.info().parse(settings).expect("valid settings");
        if let Err(violation) = contract::who_needs_no_spheres_reads_none(strategy, &params) {
            panic!("{settings}: {violation}");
        }
    }
}

/// Turned with the scene, a light's square lies otherwise: other cells are partly covered. A highlight tells the texels of a map
/// from the lobes fitted to them.
const LOBES: Bounds = Bounds { constant: 1e-5, quadrature: 0.05, gloss: 0.15, rotation: 0.02, brightening: 0.01 };

contract_tests!(cosine_lobe, CosineLobe, "", LOBES);
contract_tests!(cosine_lobe_sampled, CosineLobe, "integration=sampled,samples=64", LOBES);
contract_tests!(cosine_lobe_shallow, CosineLobe, "depth=3,threshold=0", Bounds { rotation: 0.1, ..LOBES });
// The cubes of space don't turn with the scene.
contract_tests!(cosine_lobe_shared, CosineLobe, "share=0.1", Bounds { rotation: 0.2, ..LOBES });
contract_tests!(
    cosine_lobe_covering,
    CosineLobe,
    "rule=covering,leaves=conservative",
    Bounds { rotation: 0.1, ..LOBES }
);

/// A light's lobe is wider than the light, and a lobe for each leaf is wider than the leaf.
const WIDE_LOBES: Bounds = Bounds { constant: 1e-5, quadrature: 0.3, gloss: 0.3, rotation: 0.2, brightening: 0.2 };

contract_tests!(cosine_lobe_as_published, CosineLobe, "as-published", WIDE_LOBES);
contract_tests!(
    cosine_lobe_by_solid_angles,
    CosineLobe,
    "order=published,leaves=conservative,weights=solid-angle,fit=scaled-solid-angle",
    WIDE_LOBES
);

/// Directions don't turn with the scene, and few of them are told from their neighbours by a cap's edge.
const DIRECTIONS: Bounds = Bounds { constant: 1e-5, quadrature: 0.01, gloss: 0.15, rotation: 0.15, brightening: 1e-5 };

contract_tests!(mask, Mask, "", DIRECTIONS);
contract_tests!(mask_of_bits, Mask, "bits,normals=2,own=spheres", Bounds { rotation: 0.3, ..DIRECTIONS });
contract_tests!(mask_of_one_set, Mask, "directions=256,normals=0,rule=covering", DIRECTIONS);
contract_tests!(mask_of_many, Mask, "fine", Bounds { rotation: 0.06, ..DIRECTIONS });

/// Closed forms turn with the scene; the table over normals doesn't.
const CLOSED_FORMS: Bounds =
    Bounds { constant: 1e-5, quadrature: 0.01, gloss: 0.01, rotation: 0.005, brightening: 1e-5 };

contract_tests!(analytic, Analytic, "", CLOSED_FORMS);
contract_tests!(analytic_with_own_spheres, Analytic, "own=spheres", CLOSED_FORMS);

/// Light of four bands: a sun, a lamp and a map's corners are spread, and a lamp's highlight of exponent 15 is a part of its height off,
/// as in [`FIELDS`].
const LIMITED: Bounds = Bounds { constant: 1e-5, quadrature: 0.5, gloss: 3.0, rotation: 1e-4, brightening: 0.0 };

contract_tests!(prt, Prt::new(kept()), "directions=16", LIMITED);
contract_tests!(prt_unshadowed, Prt::default(), "bands=3,transfer=unshadowed", Bounds { gloss: 4.0, ..LIMITED });
contract_tests!(
    prt_compressed,
    Prt::default(),
    "bands=3,transfer=unshadowed,compression=cpca,clusters=8,components=6",
    Bounds { constant: 0.01, gloss: 4.0, rotation: 0.01, brightening: 0.01, ..LIMITED }
);
