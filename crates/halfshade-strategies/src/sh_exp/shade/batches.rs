//! Eight receivers at a time: visibility, then the light that it leaves.

use crate::sh_exp::{
    bake::{Tables, Visibility, ground::GroundTables, reflections::ReflectionTables},
    kernel::{
        Blocker, Blockers, OwnSpheres, Receivers8,
        gather::{Gather, Radiating},
        ground::{GroundField, visible_reflectance},
        lamps::LampViews,
        log_sum::log_sum,
        own::OwnOcclusion,
        product::product,
        shares::Exposure,
        traced::Traced,
    },
    prepare::frame::FrameData,
};
use halfshade_scene::{RadianceMut, Receivers};
use halfshade_sh::kernel::{self, LANES, ShBatch};
use wide::f32x8;

/// Batches of receivers, and the memory that they share.
pub(super) struct Batches<'a, const N: usize> {
    tables: &'a Tables,
    data: &'a FrameData,
    finder: Finder<'a, N>,
    /// Where anything radiates: log blockers, and memory.
    reflections: Option<Reflected<'a, N>>,
    lamps: LampViews,
    /// Rows of the rotation into light space.
    rotation: [f32x8; 9],
}

/// The way in which visibility is found.
#[expect(clippy::large_enum_variant, reason = "there is one for a whole call")]
enum Finder<'a, const N: usize> {
    Product,
    Shares(Exposure),
    Traced(Traced<N>),
    Exponential(&'a kernel::BatchExponential),
}

/// The spheres that radiate, and the memory to gather them.
struct Reflected<'a, const N: usize> {
    tables: &'a ReflectionTables,
    radiating: Radiating<'a>,
    gather: Gather<N>,
}

impl<'a, const N: usize> Batches<'a, N> {
    pub(super) fn new(tables: &'a Tables, data: &'a FrameData) -> Self {
        let most = data.cuts.largest();
        Self {
            tables,
            data,
            finder: match &tables.visibility {
                Visibility::Product => Finder::Product,
                Visibility::Shares { points } => Finder::Shares(Exposure::new(*points, most, data.blockers_from_light)),
                Visibility::Traced { directions } => Finder::Traced(Traced::new(directions, most)),
                Visibility::Exponential(exponential) => Finder::Exponential(exponential),
            },
            reflections: (tables.reflections.as_ref()).filter(|_| !data.radiance.is_dark()).map(|tables| Reflected {
                tables,
                radiating: radiating(tables, data),
                gather: Gather::new(tables.surfaces.len(), most),
            }),
            lamps: LampViews::new(),
            rotation: data.space.rotation.transpose().to_cols_array().map(|value| f32x8::splat(value as f32)),
        }
    }

    /// Shades receivers that see the same spheres, and lie on the same object if the ground or own occlusion is known; `place` says where in
    /// `out` each one belongs.
    pub(super) fn shade(
        &mut self,
        receivers: Receivers<'_>,
        list: &[Blocker],
        out: &mut RadianceMut<'_>,
        place: impl Fn(usize) -> usize,
    ) {
        let Self { tables, data, .. } = *self;
        let own = tables.own.as_ref().and_then(|own| OwnOcclusion::of(own, &data.own, *receivers.object.first()?));
        let own_spheres = own.as_ref().map_or(OwnSpheres::default(), |own| own.spheres);
        let blockers = Blockers { list, table: &tables.blockers, rule: tables.rule, own: own_spheres };
        for start in (0..receivers.len()).step_by(LANES) {
            let lanes = (receivers.len() - start).min(LANES);
            let load = |values: &[f32]| -> [f32; LANES] {
                let values = &values[start..start + lanes];
                values.first_chunk().copied().unwrap_or_else(|| std::array::from_fn(|i| values[i.min(lanes - 1)]))
            };
            let position = self.turn(std::array::from_fn(|axis| {
                // In double precision, because a scene may lie far from the origin.
                f32x8::from(load(receivers.position[axis]).map(|x| (f64::from(x) - data.space.origin[axis]) as f32))
            }));
            let normal = self.turn(receivers.normal.map(|axis| f32x8::from(load(axis))));
            let surface = |k: usize| receivers.surface[start + k.min(lanes - 1)];
            let past_own = own.as_ref().map(|own| own.visibility::<N>(surface));
            let (knows_own, past_own) = past_own.unwrap_or((f32x8::ZERO, None));
            let eight = Receivers8 { position, normal, knows_own };
            let mut visibility = self.visibility(&blockers, &eight);
            if let Some(past_own) = &past_own {
                visibility = kernel::product(&visibility, past_own);
                kernel::limit_to_visibility(&mut visibility);
            }
            let mut radiance = data.light.by_normal.dot(&normal, &visibility, tables.clamp);
            self.add_ground(receivers.object[start], &eight, &visibility, &mut radiance);
            self.add_reflected(&eight, past_own.as_ref(), &mut radiance);
            if !data.lamps.is_empty() {
                let open = |direction: &[f32x8; 3]| own.as_ref().map_or(f32x8::ONE, |own| own.open(direction, surface));
                let constant = || data.light.by_normal.constant_share(&normal, &visibility, tables.clamp);
                let lit = self.lamps.radiance(&data.lamps, &blockers, &eight, open, constant);
                radiance.iter_mut().zip(lit).for_each(|(sum, value)| *sum += value);
            }
            for (channel, values) in radiance.into_iter().enumerate() {
                let values = (values * f32x8::from(load(receivers.albedo[channel]))).to_array();
                for (lane, value) in values.into_iter().enumerate().take(lanes) {
                    out.channels[channel][place(start + lane)] = value;
                }
            }
        }
    }

    /// The rotation into light space times a vector.
    #[inline(always)]
    fn turn(&self, v: [f32x8; 3]) -> [f32x8; 3] {
        let m = &self.rotation;
        std::array::from_fn(|axis| m[3 * axis].mul_add(v[0], m[3 * axis + 1].mul_add(v[1], m[3 * axis + 2] * v[2])))
    }

    /// V, and on the way the view of all spheres that radiate.
    #[inline(always)]
    fn visibility(&mut self, blockers: &Blockers<'_>, receivers: &Receivers8) -> ShBatch<N> {
        let logs = self.reflections.as_mut().map(|Reflected { tables, radiating, gather }| {
            gather.see(&Blockers { table: &tables.table, ..*blockers }, radiating, receivers)
        });
        match &mut self.finder {
            Finder::Exponential(exponential) => {
                exponential.evaluate(&logs.unwrap_or_else(|| log_sum::<N>(blockers, receivers)))
            }
            Finder::Product => product::<N>(blockers, receivers),
            Finder::Traced(traced) => traced.visibility(blockers, receivers),
            Finder::Shares(exposure) => exposure.visibility::<N>(blockers, receivers),
        }
    }

    /// Adds the light of objects without spheres to receivers on `object`, and takes the light away that they block.
    #[inline(always)]
    fn add_ground(
        &self,
        object: u32,
        Receivers8 { position, normal, .. }: &Receivers8,
        visibility: &ShBatch<N>,
        radiance: &mut [f32x8; 3],
    ) {
        let Self { tables, data, .. } = *self;
        let (Some(ground), Some(GroundTables { cosine, .. })) = (&data.ground, &tables.ground) else { return };
        let weights = visible_reflectance(normal, cosine, visibility);
        let of = |fields: &[Option<GroundField>]| {
            let field = fields.get(object as usize).and_then(Option::as_ref);
            field.map_or([f32x8::ZERO; 3], |field| field.radiance(position, &weights))
        };
        let seen = of(&ground.fields.seen);
        if !tables.clamp {
            radiance.iter_mut().zip(seen).for_each(|(sum, value)| *sum += value);
            return;
        }
        let taken = of(&ground.fields.taken);
        let mut open = [f32x8::ZERO; N];
        open[0] = f32x8::splat(kernel::FULL);
        let unshadowed = data.light.by_normal.dot(normal, &open, false);
        for (channel, sum) in radiance.iter_mut().enumerate() {
            let direct = (*sum + taken[channel]).max(f32x8::ZERO).min(unshadowed[channel]);
            *sum = direct + (seen[channel] - taken[channel]).max(f32x8::ZERO);
        }
    }

    /// Adds the light that spheres reflect, after [`Self::visibility`].
    #[inline(always)]
    fn add_reflected(&mut self, receivers: &Receivers8, past_own: Option<&ShBatch<N>>, radiance: &mut [f32x8; 3]) {
        let Some(Reflected { radiating, gather, .. }) = &mut self.reflections else { return };
        let reflected = match &mut self.finder {
            Finder::Traced(traced) => gather.radiance_of_traced(radiating, &receivers.normal, past_own, traced),
            Finder::Product | Finder::Shares(_) | Finder::Exponential(_) => {
                gather.radiance(radiating, &receivers.normal, past_own)
            }
        };
        let least = f32x8::splat(if self.tables.clamp { 0.0 } else { f32::NEG_INFINITY });
        radiance.iter_mut().zip(reflected).for_each(|(sum, value)| *sum += value.max(least));
    }
}

/// The spheres that radiate, as kernels read them.
pub(crate) fn radiating<'a>(reflections: &'a ReflectionTables, data: &'a FrameData) -> Radiating<'a> {
    Radiating {
        vectors: &data.radiance,
        form: &reflections.form,
        mean_normal: reflections.mean_normal.as_ref(),
        exponential: &reflections.exponential,
        cosine: &reflections.cosine,
        neighbours: &reflections.neighbours,
        walk: reflections.walk,
        order: reflections.order,
        intersections: reflections.intersections,
    }
}
