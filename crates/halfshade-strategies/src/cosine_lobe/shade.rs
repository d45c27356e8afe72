//! The sum over lights of what a receiver reflects of each [Meunier2009, 4.3 and 5.4].

use super::{
    blockers::{Ball, Receiver, Spheres},
    environment,
    light::Light,
    lobes::{CellLobes, Shape},
    moment::Moment,
    reflectance::{Horizon, MOST_TERMS, Term, Terms},
    settings::{Order, Settings, Stage},
    shared::{Cubes, Masks},
    square::Square,
    tables::Tables,
    visibility::{Hidden, Visibility},
    weights::light_lobe,
};
use glam::Vec3;
use halfshade_scene::{RadianceMut, Receivers, light::cap_irradiance};
use halfshade_sh::lobe::Lobe8;
use std::f32::consts::{FRAC_1_PI, FRAC_PI_2};
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

/// Working memory of one call.
pub(super) struct Shading<'a> {
    settings: &'a Settings,
    tables: &'a Tables,
    moment: &'a Moment,
    before: Vec<Before>,
    visibility: Visibility<'a>,
    masks: Masks,
    highlight: CellLobes,
    around: environment::Work,
    pub(super) counts: Counts,
}

/// What is before one light.
#[derive(Debug, Clone)]
struct Before {
    /// Spheres in the way of a group of receivers, and of a subgroup.
    group: Spheres,
    subgroup: Spheres,
    cubes: Option<Cubes>,
}

impl<'a> Shading<'a> {
    pub(super) fn new(settings: &'a Settings, tables: &'a Tables, moment: &'a Moment) -> Self {
        let before = |light: &Light| Before {
            group: Spheres::default(),
            subgroup: Spheres::default(),
            cubes: Cubes::new(settings.share * light.half_width(&moment.ball).min(2.0 * moment.ball.radius)),
        };
        Self {
            settings,
            tables,
            moment,
            before: moment.lights.iter().map(before).collect(),
            visibility: Visibility::new(settings, tables),
            masks: Masks::new(settings.share > 0.0),
            highlight: CellLobes::default(),
            around: environment::Work::default(),
            counts: Counts::default(),
        }
    }

    pub(super) fn run(&mut self, receivers: Receivers<'_>, mut out: RadianceMut<'_>) {
        let (settings, moment) = (self.settings, self.moment);
        let mut positions = [[0.0; 3]; GROUP];
        for start in (0..receivers.len()).step_by(GROUP) {
            let count = (receivers.len() - start).min(GROUP);
            for (i, position) in positions[..count].iter_mut().enumerate() {
                *position = moment.local(receivers.position_at(start + i));
            }
            settings.stage(Stage::Mask, || {
                self.each_light(&positions[..count], |before, receivers, light| {
                    moment.spheres.keep_between(receivers, light, &mut before.group);
                });
            });
            for (subgroup, positions) in positions[..count].chunks(SUBGROUP).enumerate() {
                settings.stage(Stage::Mask, || {
                    self.each_light(positions, |before, receivers, light| {
                        before.group.keep_between(receivers, light, &mut before.subgroup);
                    });
                });
                let start = start + SUBGROUP * subgroup;
                for (i, &position) in positions.iter().enumerate() {
                    let receiver = Receiver { position, normal: receivers.normal_at(start + i).to_array() };
                    out.set(start + i, self.radiance(&receivers, start + i, &receiver));
                }
            }
        }
    }

    /// Calls with what is before each light, a ball around points, and one around the light as seen from there.
    fn each_light(&mut self, points: &[[f32; 3]], keep: impl Fn(&mut Before, &Ball, &Ball)) {
        for (light, before) in self.moment.lights.iter().zip(&mut self.before) {
            let receivers = before.receivers(points);
            keep(before, &receivers, &light.ball(&receivers, &self.moment.ball));
        }
    }

    fn radiance(&mut self, receivers: &Receivers<'_>, i: usize, receiver: &Receiver) -> Vec3 {
        let (settings, tables, moment) = (self.settings, self.tables, self.moment);
        let terms =
            settings.stage(Stage::Reflectance, || Terms::of(receivers, i, moment.eye_lobes.as_ref(), tables.products));
        let mut radiance = (0..moment.lights.len()).map(|light| self.reflected(receiver, &terms, light)).sum();
        if let Some(surroundings) = &moment.surroundings {
            let (rule, table) = (settings.rule.into(), tables.products);
            radiance +=
                surroundings.reflected(receiver, &terms, (&moment.spheres, None), rule, table, &mut self.around);
        }
        radiance
    }

    /// What a receiver reflects of one light.
    fn reflected(&mut self, receiver: &Receiver, terms: &Terms, number: usize) -> Vec3 {
        let (settings, light) = (self.settings, &self.moment.lights[number]);
        let Some(square) = light.square(receiver.position) else {
            // From within, everything is light.
            return match (light.around(receiver.position), &self.moment.everywhere) {
                (Some(end), Some(everywhere)) => {
                    let (rule, table, before) =
                        (settings.rule.into(), self.tables.products, (&self.moment.spheres, Some(&end)));
                    light.radiance * everywhere.reflected(receiver, terms, before, rule, table, &mut self.around)
                }
                _ => Vec3::ZERO,
            };
        };
        let above = Vec3::from(square.axis()).dot(Vec3::from(receiver.normal));
        if above <= -square.sine {
            return Vec3::ZERO;
        }
        let mut factors = [(Lobe8::splat(&NOTHING), 0.0); MOST_TERMS];
        settings.stage(Stage::Light, || {
            for (term, factor) in terms.iter().zip(&mut factors) {
                *factor = self.unblocked(term, &square, above);
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
        let slot = self.find(receiver, &square, number);
        match self.masks.at(slot).hidden {
            Hidden::Nothing => return all,
            Hidden::All => return Vec3::ZERO,
            Hidden::Part => {}
        }
        let hue = light.radiance / light.radiance.max_element();
        let hidden = settings.stage(Stage::Integrals, || self.hidden((terms, hue), &factors, &square, slot));
        sum(&|i| hidden[i])
    }

    /// Finds what hides the light from a receiver, unless that was found for a neighbour, and where it is kept.
    fn find(&mut self, receiver: &Receiver, square: &Square, number: usize) -> usize {
        let before = &self.before[number];
        let shared = before.cubes.and_then(|cubes| {
            let key = cubes.key(receiver, number);
            let place = cubes.place(&key);
            // A place within the light sees no square: the receiver keeps to its own.
            self.moment.lights[number].square(place.position).map(|square| (key, (place, square)))
        });
        let (slot, is_known) = self.masks.slot(shared.map(|(key, _)| key));
        if is_known {
            return slot;
        }
        let (receiver, square) = shared.map_or((*receiver, *square), |(_, seen)| seen);
        let entry = self.masks.at_mut(slot);
        entry.hidden = self.visibility.find(&receiver, &square, &before.subgroup, &mut entry.lobes);
        if entry.hidden == Hidden::Part {
            self.counts.masks += 1;
            self.counts.lobes += entry.lobes.len() as u64;
        }
        slot
    }

    /// What a mask hides of each term, as [`Self::unblocked`] has it, of a light of this hue.
    fn hidden(
        &mut self,
        (terms, hue): (&Terms, Vec3),
        factors: &[(Lobe8, f32); MOST_TERMS],
        square: &Square,
        slot: usize,
    ) -> [f32; MOST_TERMS] {
        let lobes = &self.masks.at(slot).lobes;
        // Of the brightest channel.
        let strength = |color: Vec3| (color * hue).max_element();
        let total: f32 = terms.iter().zip(factors).map(|(term, factor)| strength(term.color) * factor.1).sum();
        let published = self.settings.order == Order::Published;
        let mut hidden = [0.0; MOST_TERMS];
        for ((term, (factor, _)), hidden) in terms.iter().zip(factors).zip(&mut hidden) {
            *hidden = match &self.tables.sampler {
                None => {
                    // A leaf's share of a diffuse surface's light is its solid angle: nothing is small beside the others.
                    let tests = self.settings.threshold > 0.0 && (term.horizon != Horizon::Diffuse || published);
                    let limit = tests.then(|| self.settings.threshold * total / strength(term.color));
                    lobes.integral(factor, self.tables.products, limit, &mut self.counts.products)
                }
                Some(sampler) => {
                    let light = published.then(|| light_lobe(square, &self.tables.caps));
                    sampler.sum(factor, light.as_ref(), lobes)
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
}

impl Before {
    /// A ball around receivers, and the places whose masks they share.
    fn receivers(&self, points: &[[f32; 3]]) -> Ball {
        let ball = Ball::around(points);
        Ball { radius: ball.radius + self.cubes.map_or(0.0, |cubes| cubes.reach()), ..ball }
    }
}

const NOTHING: halfshade_sh::lobe::Lobe = halfshade_sh::lobe::Lobe { axis: [0.0, 1.0, 0.0], exponent: 0.0, scale: 0.0 };

/// The fraction of a disc above a line at `height` radii below its centre: [0, 1].
fn fraction_above(height: f32) -> f32 {
    let x = height.clamp(-1.0, 1.0);
    FRAC_1_PI * (x * (1.0 - x * x).sqrt() + x.asin() + FRAC_PI_2)
}
