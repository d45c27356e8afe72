//! The sum over lights of what a receiver reflects of each [Meunier2009, 4.3 and 5.4].

use super::{
    Moment, Tables,
    blockers::{Ball, Receiver, Spheres},
    environment,
    lobes::{CellLobes, Shape},
    mask::{Cell, Disc, Mask, covered_fractions},
    parameters::{Leaves, Order, Settings, Stage, Weights},
    reflectance::{Horizon, MOST_TERMS, Term, Terms},
    square::{Square, disc},
    weights::light_lobe,
};
use glam::Vec3;
use halfshade_scene::{RadianceMut, Receivers, light::cap_irradiance};
use halfshade_sh::lobe::Lobe8;
use std::{
    f32::consts::{FRAC_1_PI, FRAC_PI_2},
    hint::black_box,
};
use wide::f32x8;

/// Receivers for which the spheres in the way of a light are looked up together, and those for whom they are looked up
/// again among these.
const GROUP: usize = 64;
const SUBGROUP: usize = 8;

/// Finest level at which a glossy receiver sees an unblocked light.
const FINEST_HIGHLIGHT: usize = 3;

/// What was done for how many.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Counts {
    /// Products found and left out.
    pub(super) products: [u64; 2],
    /// Pairs of receiver and light whose mask was built, and lobes of those masks.
    pub(super) masks: u64,
    pub(super) lobes: u64,
}

/// How much of a light spheres hide.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Hidden {
    Nothing,
    Part,
    All,
}

/// Working memory of one call.
pub(super) struct Shading<'a> {
    settings: &'a Settings,
    tables: &'a Tables,
    moment: &'a Moment,
    between: Vec<Spheres>,
    nearer: Vec<Spheres>,
    discs: Vec<Disc>,
    mask: Mask,
    partial: Vec<Cell>,
    lobes: CellLobes,
    highlight: CellLobes,
    around: environment::Work,
    pub(super) counts: Counts,
}

impl<'a> Shading<'a> {
    pub(super) fn new(settings: &'a Settings, tables: &'a Tables, moment: &'a Moment) -> Self {
        Self {
            settings,
            tables,
            moment,
            between: vec![Spheres::default(); moment.lights.len()],
            nearer: vec![Spheres::default(); moment.lights.len()],
            discs: Vec::new(),
            mask: Mask::new(settings.depth),
            partial: Vec::new(),
            lobes: CellLobes::default(),
            highlight: CellLobes::default(),
            around: environment::Work::default(),
            counts: Counts::default(),
        }
    }

    pub(super) fn run(&mut self, receivers: Receivers<'_>, mut out: RadianceMut<'_>) {
        let moment = self.moment;
        let mut positions = [[0.0; 3]; GROUP];
        for start in (0..receivers.len()).step_by(GROUP) {
            let count = (receivers.len() - start).min(GROUP);
            for (i, position) in positions[..count].iter_mut().enumerate() {
                *position = moment.local(receivers.position_at(start + i));
            }
            self.stage(Stage::Mask, |it| it.keep_between(&positions[..count]));
            for (subgroup, positions) in positions[..count].chunks(SUBGROUP).enumerate() {
                self.stage(Stage::Mask, |it| it.keep_nearer(positions));
                let start = start + SUBGROUP * subgroup;
                for (i, &position) in positions.iter().enumerate() {
                    let receiver = Receiver { position, normal: receivers.normal_at(start + i).to_array() };
                    out.set(start + i, self.radiance(&receivers, start + i, &receiver));
                }
            }
        }
    }

    /// The spheres between points and each light.
    fn keep_between(&mut self, points: &[[f32; 3]]) {
        let moment = self.moment;
        let ball = Ball::around(points);
        for (light, between) in moment.lights.iter().zip(&mut self.between) {
            moment.spheres.keep_between(&ball, &light.ball(&ball, &moment.ball), between);
        }
    }

    /// Those of them between some of the points and each light.
    fn keep_nearer(&mut self, points: &[[f32; 3]]) {
        let moment = self.moment;
        let ball = Ball::around(points);
        for ((light, between), nearer) in moment.lights.iter().zip(&self.between).zip(&mut self.nearer) {
            between.keep_between(&ball, &light.ball(&ball, &moment.ball), nearer);
        }
    }

    fn radiance(&mut self, receivers: &Receivers<'_>, i: usize, receiver: &Receiver) -> Vec3 {
        let moment = self.moment;
        let terms =
            self.stage(Stage::Reflectance, |it| Terms::of(receivers, i, moment.eye_lobes.as_ref(), it.tables.products));
        let mut radiance = (0..moment.lights.len()).map(|light| self.reflected(receiver, &terms, light)).sum();
        if let Some(surroundings) = &moment.surroundings {
            let (rule, table) = (self.settings.rule, self.tables.products);
            radiance += surroundings.reflected(receiver, &terms, &moment.spheres, rule, table, &mut self.around);
        }
        radiance
    }

    /// What a receiver reflects of one light.
    fn reflected(&mut self, receiver: &Receiver, terms: &Terms, number: usize) -> Vec3 {
        let light = &self.moment.lights[number];
        let Some(square) = light.square(receiver.position) else {
            // From within a light everything is light, and nothing is between.
            let all = terms.iter().map(|term| term.lobe.integral().to_array()[0] * term.color).sum::<Vec3>();
            return if light.has_inside() { light.radiance * all } else { Vec3::ZERO };
        };
        let above = Vec3::from(square.axis()).dot(Vec3::from(receiver.normal));
        if above <= -square.sine {
            return Vec3::ZERO;
        }
        let mut factors = [(Lobe8::splat(&NOTHING), 0.0); MOST_TERMS];
        self.stage(Stage::Light, |it| {
            for (term, factor) in terms.iter().zip(&mut factors) {
                *factor = it.unblocked(term, &square, above);
            }
        });
        let sum = |hidden: &dyn Fn(usize) -> f32| {
            let visible = |(i, term): (usize, &Term)| (factors[i].1 - hidden(i)).max(0.0) * term.color;
            light.radiance * terms.iter().enumerate().map(visible).sum::<Vec3>()
        };
        let all = sum(&|_| 0.0);
        if all == Vec3::ZERO {
            return Vec3::ZERO;
        }
        match self.stage(Stage::Mask, |it| it.find_mask(receiver, &square, number)) {
            Hidden::Nothing => return all,
            Hidden::All => return Vec3::ZERO,
            Hidden::Part => self.counts.masks += 1,
        }
        self.stage(Stage::MaskLobes, |it| it.find_lobes(&square));
        let hidden = self.stage(Stage::Integrals, |it| it.hidden(terms, &factors, &square));
        sum(&|i| hidden[i])
    }

    /// What the mask hides of each term, as [`Self::unblocked`] has it.
    fn hidden(&mut self, terms: &Terms, factors: &[(Lobe8, f32); MOST_TERMS], square: &Square) -> [f32; MOST_TERMS] {
        // Of the brightest channel.
        let strength = |color: Vec3| color.max_element();
        let total: f32 = terms.iter().zip(factors).map(|(term, factor)| strength(term.color) * factor.1).sum();
        let published = self.settings.order == Order::Published;
        let mut hidden = [0.0; MOST_TERMS];
        for ((term, (factor, _)), hidden) in terms.iter().zip(factors).zip(&mut hidden) {
            *hidden = match &self.tables.sampler {
                None => {
                    // A leaf's share of a diffuse surface's light is its solid angle: nothing is small beside the others.
                    let tests = self.settings.threshold > 0.0 && (term.horizon != Horizon::Diffuse || published);
                    let limit = tests.then(|| self.settings.threshold * total / strength(term.color));
                    self.lobes.integral(factor, self.tables.products, limit, &mut self.counts.products)
                }
                Some(sampler) => {
                    let light = published.then(|| light_lobe(square, &self.tables.caps));
                    sampler.sum(factor, light.as_ref(), &self.lobes)
                }
            };
        }
        hidden
    }

    /// The lobe that is multiplied with the mask's, and what the term reflects of the unblocked light, per its colour and
    /// the light's radiance. The lobe is the product with the light's in the published order, but the term's if sampled.
    fn unblocked(&mut self, term: &Term, square: &Square, above: f32) -> (Lobe8, f32) {
        let end = match term.horizon {
            Horizon::None => fraction_above(above / square.sine),
            Horizon::Diffuse | Horizon::Cosine => 1.0,
        };
        let end_lobe = |lobe: Lobe8| Lobe8 { scale: lobe.scale * f32x8::splat(end), ..lobe };
        match self.settings.order {
            Order::Published if let Some(sampler) = &self.tables.sampler => {
                let lobe = end_lobe(term.lobe);
                (lobe, sampler.integral_of_lanes(&lobe, &light_lobe(square, &self.tables.caps)))
            }
            Order::Published => {
                let product = self.tables.products.product8(&term.lobe, &light_lobe(square, &self.tables.caps));
                let product = end_lobe(product);
                (product, product.integral().to_array()[0])
            }
            Order::LightFirst if term.horizon == Horizon::Diffuse => {
                // A closed form.
                let irradiance = if above >= square.sine {
                    std::f32::consts::PI * square.sine * square.sine * above
                } else {
                    cap_irradiance(above.into(), square.sine.into()) as f32
                };
                (term.lobe, irradiance)
            }
            Order::LightFirst => {
                let lobe = end_lobe(term.lobe);
                (lobe, self.highlight(&lobe, square))
            }
        }
    }

    /// `∫ c` over the light for a lobe c, the light in parts of half the lobe's width or less.
    fn highlight(&mut self, lobe: &Lobe8, square: &Square) -> f32 {
        let exponent = lobe.exponent.to_array()[0];
        let width = 2.0 * square.sine * exponent.sqrt();
        let level = (1..FINEST_HIGHLIGHT).find(|&level| width <= (1 << level) as f32).unwrap_or(FINEST_HIGHLIGHT);
        let level = level.min(self.settings.depth);
        self.highlight.clear();
        let cells = &self.tables.cells;
        cells.level(level).for_each(|&cell| self.highlight.push(cell, level, 1.0, square, Shape::Part));
        self.highlight.flush(square, Shape::Part);
        match &self.tables.sampler {
            None => self.highlight.integral(lobe, self.tables.products, None, &mut self.counts.products),
            Some(sampler) => sampler.sum(lobe, None, &self.highlight),
        }
    }

    /// One stage of the work, as often as is asked for. What it leaves is the same.
    #[inline(always)]
    fn stage<T>(&mut self, stage: Stage, mut work: impl FnMut(&mut Self) -> T) -> T {
        if self.settings.twice == Some(stage) {
            black_box(work(self));
        }
        work(self)
    }

    /// The cells that the spheres in the way cover.
    fn find_mask(&mut self, receiver: &Receiver, square: &Square, light: usize) -> Hidden {
        if !self.find_discs(receiver, square, light) {
            return Hidden::All;
        }
        if self.discs.is_empty() {
            return Hidden::Nothing;
        }
        self.mask.clear();
        self.discs.iter().for_each(|disc| self.mask.splat(disc));
        if self.settings.leaves == Leaves::Conservative {
            self.mask.cover_touched();
        }
        if self.mask.join(&self.tables.cells.unlit) { Hidden::All } else { Hidden::Part }
    }

    /// The spheres in the way. `false` if one of them hides the light.
    fn find_discs(&mut self, receiver: &Receiver, square: &Square, light: usize) -> bool {
        self.discs.clear();
        for (center, radius) in self.nearer[light].groups() {
            let (offset, radius) = receiver.adjusted(&center, radius, self.settings.rule);
            let (found, meets) = square.splat(&offset, radius);
            let mut bits = meets.to_bitmask();
            if bits == 0 {
                continue;
            }
            let [x, y, r] = found.map(f32x8::to_array);
            while bits != 0 {
                let lane = bits.trailing_zeros() as usize;
                let (disc, hides) = disc(x[lane], y[lane], r[lane]);
                if hides {
                    return false;
                }
                self.discs.push(disc);
                bits &= bits - 1;
            }
        }
        true
    }

    /// The lobes of the mask.
    fn find_lobes(&mut self, square: &Square) {
        let (settings, tables) = (self.settings, self.tables);
        let shape = match (settings.order, settings.weights) {
            (Order::LightFirst, _) => Shape::Part,
            (Order::Published, Weights::Fitted | Weights::Umbra) => Shape::Bounding(&tables.caps),
            (Order::Published, Weights::SolidAngle) => Shape::SolidAngle(&tables.caps),
        };
        let distance = square.distance();
        let weight = |level: usize| match settings.order {
            Order::LightFirst => 1.0,
            Order::Published => tables.weights.at(level, distance),
        };
        self.lobes.clear();
        let (lobes, counts) = (&mut self.lobes, &mut self.counts);
        self.mask.each_leaf(&tables.cells.unlit, |cell| {
            lobes.push(tables.cells.at(cell), cell.level, weight(cell.level), square, shape);
            counts.lobes += 1;
        });
        if settings.leaves == Leaves::Fraction {
            let of_level = weight(settings.depth);
            let partial = &mut self.partial;
            partial.clear();
            self.mask.each_partial(|cell| partial.push(cell));
            for cells in partial.chunks(8) {
                let mut eight = [cells[0]; 8];
                eight[..cells.len()].copy_from_slice(cells);
                let fractions = covered_fractions(&eight, &self.discs).to_array();
                for (&cell, fraction) in cells.iter().zip(fractions).filter(|(_, fraction)| *fraction > 0.0) {
                    lobes.push(tables.cells.at(cell), cell.level, of_level * fraction, square, shape);
                    counts.lobes += 1;
                }
            }
        }
        lobes.flush(square, shape);
    }
}

const NOTHING: halfshade_sh::lobe::Lobe = halfshade_sh::lobe::Lobe { axis: [0.0, 1.0, 0.0], exponent: 0.0, scale: 0.0 };

/// The fraction of a disc above a line at `height` radii below its centre: [0, 1].
fn fraction_above(height: f32) -> f32 {
    let x = height.clamp(-1.0, 1.0);
    FRAC_1_PI * (x * (1.0 - x * x).sqrt() + x.asin() + FRAC_PI_2)
}
