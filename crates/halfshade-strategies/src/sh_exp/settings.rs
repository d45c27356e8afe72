//! Everything that can be set.

use crate::shared::adjustment::Rule;
use halfshade_scene::{Environment, Scene, light::DistantLight, scene::MAX_BOUNCES};
use halfshade_sh::{
    exponential::{Exponential, Method},
    form_factor, logarithm, window,
};
use halfshade_strategy::{Preset, Stage, choice, settings};

choice! {
    /// How blockers combine.
    pub(crate) enum Combination {
        /// one after another [Guerrero2007, eq. 4.6]
        Product = "product",
        /// exponential of summed logarithms, by its power series
        Series = "series",
        /// exponential, by the optimal linear form
        OptimalLinear = "optimal-linear",
        /// exponential, scaled, by the optimal linear form, and squared back
        Hybrid = "hybrid",
        /// exponential, scaled, by the first two powers, and squared back
        Quadratic = "quadratic",
        /// each by the share of it that no other hides
        Shares = "shares",
        /// traced and projected, which no other way can beat
        Traced = "traced",
    }
}

choice! {
    /// How the exponential of summed logarithms is found.
    pub(crate) enum ExponentialForm {
        /// by its power series
        Series = "series",
        /// by the optimal linear form
        OptimalLinear = "optimal-linear",
        /// scaled, by the optimal linear form, and squared back
        Hybrid = "hybrid",
        /// scaled, by the first two powers, and squared back
        Quadratic = "quadratic",
    }
}

choice! {
    /// Where squarings of the exponential begin.
    pub(crate) enum Squaring {
        /// blended from one count of squarings to the next
        Continuous = "continuous",
        /// one more at each power of two of the limit
        Published = "published",
    }
}

choice! {
    /// A feature that is on or off.
    pub(crate) enum Switch {
        /// not done
        Off = "off",
        /// done
        On = "on",
    }
}

choice! {
    /// The window against ringing.
    pub(crate) enum Window for window::Window {
        /// none
        None = "none",
        /// (1 + cos(π l/n))/2
        Hann = "hann",
        /// sin(π l/n)/(π l/n)
        Lanczos = "lanczos",
    }
}

choice! {
    /// Weight of spheres of one object that cover each other.
    pub(crate) enum Overlap {
        /// each in full: a direction behind k spheres is blocked k times [Guerrero2007, eq. 4.7]
        Independent = "independent",
        /// each by the share of the silhouette that is its own: about once
        Shared = "shared",
        /// each by a power of that share, from 0 to 1 as more of them cover each other
        Balanced = "balanced",
    }
}

choice! {
    /// Which spheres of a hierarchy are taken.
    pub(crate) enum Levels {
        /// the leaves, everywhere
        Leaves = "leaves",
        /// one level of each object per receiver cluster [Guerrero2007, 4.2]
        Cluster = "cluster",
        /// a cut through the tree per receiver cluster [Ren2006]
        Tree = "tree",
    }
}

choice! {
    /// Whether coarse spheres are scaled to what finer ones give at the centre of a receiver cluster.
    pub(crate) enum Ratios {
        /// in shadows alone, to the next finer ones [Guerrero2007, eq. 4.9]
        Shadows = "shadows",
        /// in shadows alone, to the leaves
        Leaves = "leaves",
        /// also what they reflect, by eq. 4.34 upside down: as printed it leads away from the finer ones
        On = "on",
        /// not at all
        Off = "off",
    }
}

choice! {
    /// Spheres of one object that intersect, in reflections.
    pub(crate) enum Intersections {
        /// they don't cover each other, their colours know who covers whom [Guerrero2007, 4.3.3]
        Precomputed = "precomputed",
        /// the nearer one covers the other
        Ordered = "ordered",
    }
}

choice! {
    /// The order in which spheres cover each other.
    pub(crate) enum Order {
        /// by the distance of their centres [Guerrero2007, 4.3.3]
        Center = "center",
        /// by power distance d² - r²: their radical planes cut intersecting spheres apart
        Power = "power",
    }
}

choice! {
    /// How sums over nearer spheres are found.
    pub(crate) enum Walk {
        /// from a running sum
        Linear = "linear",
        /// one by one
        Quadratic = "quadratic",
    }
}

choice! {
    /// How light at sample points and colour become a radiance vector.
    pub(crate) enum Projection {
        /// their product, projected
        Direct = "direct",
        /// an SH product [Guerrero2007, eq. 4.20]
        Product = "product",
    }
}

choice! {
    /// The weight of a receiver's directions in the average over a sphere.
    pub(crate) enum FormFactor for form_factor::Weighting {
        /// the cosine on the sphere's surface [Guerrero2007, eq. 4.24]
        Cosine = "cosine",
        /// the solid angle at the receiver
        SolidAngle = "solid-angle",
    }
}

choice! {
    /// The part of a sphere over which what it radiates is averaged.
    pub(crate) enum Average {
        /// what is seen of it, whoever looks [Guerrero2007, eq. 4.25]
        Sphere = "sphere",
        /// what lies above the receiver's horizon, by the receiver's cosine
        Receiver = "receiver",
    }
}

choice! {
    /// Treatment of suns, and of small bright parts of a map.
    pub(crate) enum SmallLights {
        /// by their projection, as all distant light: their shadows are as soft as the last band
        Projected = "projected",
        /// by how much of their discs spheres cover, as spherical lights are always
        Apart = "apart",
    }
}

choice! {
    /// How a receiver knows what its own object hides from it.
    pub(crate) enum OwnOcclusion {
        /// by the object's spheres, as by any others [Guerrero2007, 4.2]
        Spheres = "spheres",
        /// by its mesh, once per vertex; of objects that deform by their spheres
        Baked = "baked",
    }
}

choice! {
    /// Treatment of objects without spheres.
    pub(crate) enum GroundMode {
        /// ignored by all others
        Ignored = "ignored",
        /// seen by all others, to block and to reflect
        Seen = "seen",
    }
}

/// Where it errs, from what is found last to what is found first.
pub(crate) const STAGES: &[Stage] = &[
    Stage { name: "hierarchy", exact: "levels=leaves" },
    Stage { name: "own occlusion", exact: "own=baked" },
    Stage { name: "small lights", exact: "sun=apart" },
    Stage { name: "exponential and overlap", exact: "exp=traced" },
    Stage { name: "bands", exact: "bands=8" },
];

settings! {
    /// All parameters: of shadows, of the sphere hierarchy, of reflections.
    pub(crate) struct Settings {
        /// how blockers combine
        "exp" => combination: Combination = Combination::Hybrid, levels ["optimal-linear", "hybrid"];
        /// bands of visibility
        "bands" => bands: usize = 4, in 1..=8, levels ["2", "3", "4", "5", "6", "8"];
        /// hybrid, quadratic, series: magnitude at which squaring starts; 0: 8/bands² for the hybrid, else 1
        "magnitude-limit" => magnitude_limit: f64 = 0.0, in 0.0..=100.0;
        /// hybrid, quadratic, series: how one squaring more sets in
        "squaring" => squaring: Squaring = Squaring::Continuous;
        /// shares: points per sphere that ask how many others cover them
        "points" => points: usize = 8, in 1..=64;
        /// traced: directions in which the nearest sphere is looked for
        "directions" => directions: usize = 2048, in 64..=65_536;
        /// series: highest power
        "terms" => terms: u32 = 9, in 1..=16;
        /// series: whether to scale and square as the hybrid does; it diverges for many blockers if not
        "scaling" => scaling: Switch = Switch::On;
        /// against ringing
        "window" => window: Window = Window::None;
        /// smallest eigenvalue that the logarithm takes
        "clip" => clip: f64 = logarithm::DEFAULT_CLIP, in 1e-6..=0.5;
        /// spheres that cut the tangent plane
        "rule" => rule: Rule = Rule::Continuous;
        /// spheres of one object that cover each other
        "overlap" => overlap: Overlap = Overlap::Balanced, levels ["independent", "balanced"];
        /// spheres of the hierarchy that a receiver sees
        "levels" => levels: Levels = Levels::Leaves, levels ["tree", "leaves"];
        /// children per parent in the hierarchy
        "branching" => branching: usize = 4, in 2..=16;
        /// largest angular radius, in degrees, of a sphere that stands for finer ones
        "cut-angle" => cut_angle: f64 = 15.0, in 0.0..=90.0;
        /// coarse spheres are scaled to what finer ones give at the cluster's centre
        "ratios" => ratios: Ratios = Ratios::Leaves;
        /// most diffuse bounces, if the scene asks for more; 0: shadows alone
        "bounces" => bounces: usize = MAX_BOUNCES, in 0..=MAX_BOUNCES;
        /// reflections: the exponential of the summed logarithms
        "reflection-exp" => reflection_form: ExponentialForm = ExponentialForm::Hybrid;
        /// reflections: magnitude at which squaring starts; 0: as for shadows
        "reflection-limit" => reflection_limit: f64 = 4.8, in 0.0..=100.0;
        /// reflections: spheres of one object that intersect
        "intersections" => intersections: Intersections = Intersections::Ordered;
        /// reflections: what is nearer
        "order" => order: Order = Order::Center;
        /// reflections: how sums over nearer spheres are found
        "walk" => walk: Walk = Walk::Linear;
        /// reflections: how light at sample points and colour become a radiance vector
        "projection" => projection: Projection = Projection::Direct;
        /// reflections: bands of what each sphere radiates, at most those of visibility; 0: as many
        "radiance-bands" => radiance_bands: usize = 0, in 0..=8;
        /// reflections: weight of directions in the average over a sphere
        "form-factor" => form_factor: FormFactor = FormFactor::SolidAngle;
        /// reflections: what the average over a sphere knows of the receiver
        "average" => average: Average = Average::Receiver;
        /// reflections: 10n² + 2 sample points around each sphere
        "sample-divisions" => sample_divisions: usize = 2, in 1..=6;
        /// suns, and small bright parts of a map
        "sun" => small_lights: SmallLights = SmallLights::Apart;
        /// sun=apart: most small bright parts that are taken out of a map
        "lamps" => lamps: usize = 4, in 0..=16;
        /// what a receiver's own object hides from it
        "own" => own: OwnOcclusion = OwnOcclusion::Baked;
        /// own=baked: directions in which each vertex looks for its own mesh, and a quarter of those for lamps
        "own-directions" => own_directions: usize = 256, in 16..=4096;
        /// objects without spheres
        "ground" => ground: GroundMode = GroundMode::Seen;
        /// ground=seen: directions that every object looks into
        "ground-directions" => ground_directions: usize = 128, in 16..=4096;
        /// hold direct light between 0 and unshadowed, and what is reflected at 0 or more
        "clamp" => clamp: Switch = Switch::Off;
        /// cells from the centre of the table over normals to its side
        "normals" => normals: usize = 32, in 2..=128;
    }
}

/// Values under one name.
pub(crate) const PRESETS: &[Preset] = &[AS_PUBLISHED, SPHERES_ALONE];

const AS_PUBLISHED: Preset = Preset {
    name: "as-published",
    summary: "[Guerrero2007, 4]: clusters with one level of each object, intersections precomputed, every nearer sphere summed, \
              nothing from meshes, suns projected",
    settings: "rule=published,overlap=independent,squaring=published,magnitude-limit=4.8,levels=cluster,ratios=on,reflection-limit=4.8,\
               intersections=precomputed,order=center,walk=quadratic,projection=product,form-factor=cosine,average=sphere,\
               own=spheres,sun=projected,ground=ignored",
};

const SPHERES_ALONE: Preset = Preset {
    name: "spheres-alone",
    summary: "nothing from meshes, suns projected, no ground: what spheres and harmonics do alone, by our rules",
    settings: "own=spheres,sun=projected,ground=ignored",
};

impl Switch {
    pub(crate) fn is_on(self) -> bool {
        self == Self::On
    }
}

impl Settings {
    /// Whether a scene may have lights that are handled apart.
    pub(crate) fn has_lamps(&self, scene: &Scene) -> bool {
        let Environment { base, sun } = &scene.environment;
        let may_hold = self.lamps > 0 && matches!(base, DistantLight::Map(_));
        !scene.lights.is_empty() || self.small_lights == SmallLights::Apart && (may_hold || sun.is_some())
    }

    /// The exponential of shadows or of reflections; a `limit` of 0 asks for the form's own.
    pub(crate) fn exponential(&self, form: ExponentialForm, limit: f64) -> Exponential {
        let limit = if limit == 0.0 { form.default_magnitude_limit(self.bands) } else { limit };
        let method = match form {
            ExponentialForm::Series => {
                Method::Series { terms: self.terms, magnitude_limit: self.scaling.is_on().then_some(limit) }
            }
            ExponentialForm::OptimalLinear => Method::OptimalLinear,
            ExponentialForm::Hybrid => Method::Hybrid { magnitude_limit: limit },
            ExponentialForm::Quadratic => Method::Quadratic { magnitude_limit: limit },
        };
        let exponential = Exponential::new(self.bands, method, self.clip);
        match self.squaring {
            Squaring::Published => exponential,
            Squaring::Continuous => exponential.blended(),
        }
    }
}

impl ExponentialForm {
    /// Magnitude limit if none is asked for.
    ///
    /// The optimal-linear form lacks the square: up to `f̂*f̂/2`, which is at most `bands/√4π |f̂|²/2` because a vector of bands n
    /// is nowhere larger than `n/√4π` times its magnitude. Squared back, 2^p such errors make about `n |f̂| limit`; and `|f̂|` of
    /// the same small blockers grows with n itself. So that error doesn't grow with the bands the limit must fall as 1/n²; at
    /// 4 bands 0.5 is within a tenth of the full series. The series and the quadratic form have the square.
    fn default_magnitude_limit(self, bands: usize) -> f64 {
        match self {
            Self::Hybrid => 8.0 / (bands * bands) as f64,
            Self::Series | Self::OptimalLinear | Self::Quadratic => 1.0,
        }
    }
}
