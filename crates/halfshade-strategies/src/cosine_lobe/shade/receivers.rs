//! The sum over lights of the radiance that a receiver reflects of each [Meunier2009, 4.3 and 5.4].

use super::{
    counts::Counts,
    reflectance::{Horizon, MOST_LOBES, ReflectanceLobe, ReflectanceLobes},
    shared_masks::{Cubes, Masks},
    stages::{Repetition, Stage},
    surroundings::Covers,
    visibility::{Hidden, Visibility},
};
use crate::cosine_lobe::{
    bake::tables::Tables,
    kernel::{
        cell_lobes::{CellLobes, Shape, light_lobe},
        fractions::fraction_above,
        receiver::Receiver,
        spheres::{BoundingSphere, Spheres},
        square::Square,
    },
    prepare::{frame::FrameData, light::Light, surroundings::Surroundings},
    settings::{Order, Settings},
};
use glam::Vec3;
use halfshade_scene::{RadianceMut, Receivers, light::cap_irradiance};
use halfshade_sh::lobe::{Lobe, Lobe8};
use wide::f32x8;

/// Receivers for which the spheres in the way of a light are looked up together, and those for whom they are looked up
/// again among these.
const GROUP: usize = 64;
const SUBGROUP: usize = 8;

/// Finest level at which a glossy receiver sees an unblocked light.
const FINEST_HIGHLIGHT: usize = 3;

/// Working memory of one call.
pub(crate) struct Shading<'a, R> {
    settings: &'a Settings,
    tables: &'a Tables,
    frame: &'a FrameData,
    in_the_way: Vec<InTheWay>,
    repetition: R,
    visibility: Visibility<'a, R>,
    masks: Masks,
    highlight: CellLobes,
    covers: Covers,
    counts: Counts,
}

/// Spheres that may be in the way of one light.
#[derive(Debug, Clone)]
struct InTheWay {
    /// Those for a group of receivers, and for a subgroup.
    group: Spheres,
    subgroup: Spheres,
    cubes: Option<Cubes>,
}

impl<'a, R: Repetition> Shading<'a, R> {
    pub(crate) fn new(settings: &'a Settings, tables: &'a Tables, frame: &'a FrameData, repetition: R) -> Self {
        let in_the_way = |light: &Light| InTheWay {
            group: Spheres::default(),
            subgroup: Spheres::default(),
            cubes: Cubes::new(settings.share * light.half_width(&frame.bounds).min(2.0 * frame.bounds.radius)),
        };
        Self {
            settings,
            tables,
            frame,
            in_the_way: frame.lights.iter().map(in_the_way).collect(),
            repetition,
            visibility: Visibility::new(settings, tables, repetition),
            masks: Masks::new(settings.share > 0.0),
            highlight: CellLobes::default(),
            covers: Covers::default(),
            counts: Counts::default(),
        }
    }

    /// Shades receivers; returns what was counted.
    pub(crate) fn run(mut self, receivers: Receivers<'_>, mut out: RadianceMut<'_>) -> Counts {
        let (repetition, frame) = (self.repetition, self.frame);
        let mut positions = [[0.0; 3]; GROUP];
        for start in (0..receivers.len()).step_by(GROUP) {
            let count = (receivers.len() - start).min(GROUP);
            for (i, position) in positions[..count].iter_mut().enumerate() {
                *position = frame.local(receivers.position_at(start + i));
            }
            repetition.run(Stage::Mask, || {
                self.each_light(&positions[..count], |way, receivers, light| {
                    frame.spheres.keep_between(receivers, light, &mut way.group);
                });
            });
            for (subgroup, positions) in positions[..count].chunks(SUBGROUP).enumerate() {
                repetition.run(Stage::Mask, || {
                    self.each_light(positions, |way, receivers, light| {
                        way.group.keep_between(receivers, light, &mut way.subgroup);
                    });
                });
                let start = start + SUBGROUP * subgroup;
                for (i, &position) in positions.iter().enumerate() {
                    let receiver = Receiver { position, normal: receivers.normal_at(start + i).to_array() };
                    out.set(start + i, self.radiance(&receivers, start + i, &receiver));
                }
            }
        }
        self.counts
    }

    /// Calls with the spheres before each light, a sphere around points, and one around the light as seen from there.
    fn each_light(&mut self, points: &[[f32; 3]], keep: impl Fn(&mut InTheWay, &BoundingSphere, &BoundingSphere)) {
        for (light, way) in self.frame.lights.iter().zip(&mut self.in_the_way) {
            let receivers = way.receivers(points);
            keep(way, &receivers, &light.bounds(&receivers, &self.frame.bounds));
        }
    }

    fn radiance(&mut self, receivers: &Receivers<'_>, i: usize, receiver: &Receiver) -> Vec3 {
        let (repetition, frame, table) = (self.repetition, self.frame, self.tables.products);
        let lobes = || ReflectanceLobes::of(receivers, i, frame.eye_lobes.as_ref(), table);
        let reflectance = repetition.run(Stage::Reflectance, lobes);
        let mut radiance = (0..frame.lights.len()).map(|light| self.reflected(receiver, &reflectance, light)).sum();
        if let Some(surroundings) = &frame.surroundings {
            radiance += self.surrounding(surroundings, receiver, &reflectance, None);
        }
        radiance
    }

    /// The radiance that a receiver reflects of its surroundings, which end at `end`.
    fn surrounding(
        &mut self,
        surroundings: &Surroundings,
        receiver: &Receiver,
        reflectance: &ReflectanceLobes,
        end: Option<&BoundingSphere>,
    ) -> Vec3 {
        let (rule, table, spheres) = (self.settings.rule.into(), self.tables.products, &self.frame.spheres);
        self.covers.reflected(surroundings, receiver, reflectance, (spheres, end), rule, table)
    }

    /// The radiance that a receiver reflects of one light.
    fn reflected(&mut self, receiver: &Receiver, reflectance: &ReflectanceLobes, number: usize) -> Vec3 {
        let (repetition, frame) = (self.repetition, self.frame);
        let light = &frame.lights[number];
        let Some(square) = light.square(receiver.position) else {
            // From within, everything is light.
            return match (light.around(receiver.position), &frame.everywhere) {
                (Some(end), Some(everywhere)) => {
                    light.radiance * self.surrounding(everywhere, receiver, reflectance, Some(&end))
                }
                _ => Vec3::ZERO,
            };
        };
        let above = Vec3::from(square.axis()).dot(Vec3::from(receiver.normal));
        if above <= -square.sine {
            return Vec3::ZERO;
        }
        let mut factors = [(Lobe8::splat(&NOTHING), 0.0); MOST_LOBES];
        repetition.run(Stage::Light, || {
            for (lobe, factor) in reflectance.iter().zip(&mut factors) {
                *factor = self.unblocked(lobe, &square, above);
            }
        });
        let sum = |hidden: &dyn Fn(usize) -> f32| {
            let visible = |(i, lobe): (usize, &ReflectanceLobe)| (factors[i].1 - hidden(i)).max(0.0) * lobe.color;
            light.radiance * reflectance.iter().enumerate().map(visible).sum::<Vec3>()
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
        let hidden = repetition.run(Stage::Integrals, || self.hidden((reflectance, hue), &factors, &square, slot));
        sum(&|i| hidden[i])
    }

    /// Finds what hides the light from a receiver, unless that was found for a neighbour, and where it is kept.
    fn find(&mut self, receiver: &Receiver, square: &Square, number: usize) -> usize {
        let way = &self.in_the_way[number];
        let shared = way.cubes.and_then(|cubes| {
            let key = cubes.key(receiver, number);
            let place = cubes.place(&key);
            // A place within the light sees no square: the receiver keeps to its own.
            self.frame.lights[number].square(place.position).map(|square| (key, (place, square)))
        });
        let (slot, is_known) = self.masks.slot(shared.map(|(key, _)| key));
        if is_known {
            return slot;
        }
        let (receiver, square) = shared.map_or((*receiver, *square), |(_, seen)| seen);
        let entry = self.masks.at_mut(slot);
        entry.hidden = self.visibility.find(&receiver, &square, &way.subgroup, &mut entry.lobes);
        if entry.hidden == Hidden::Part {
            self.counts.masks += 1;
            self.counts.lobes += entry.lobes.len() as u64;
        }
        slot
    }

    /// The part of [`Self::unblocked`] that a mask hides, lobe by lobe, of a light of this hue.
    fn hidden(
        &mut self,
        (reflectance, hue): (&ReflectanceLobes, Vec3),
        factors: &[(Lobe8, f32); MOST_LOBES],
        square: &Square,
        slot: usize,
    ) -> [f32; MOST_LOBES] {
        let lobes = &self.masks.at(slot).lobes;
        // By the brightest channel.
        let strength = |color: Vec3| (color * hue).max_element();
        let total: f32 = reflectance.iter().zip(factors).map(|(lobe, factor)| strength(lobe.color) * factor.1).sum();
        let published = self.settings.order == Order::Published;
        let mut hidden = [0.0; MOST_LOBES];
        for ((lobe, (factor, _)), hidden) in reflectance.iter().zip(factors).zip(&mut hidden) {
            *hidden = match &self.tables.sampler {
                None => {
                    // A leaf's share of a diffuse surface's light is its solid angle: nothing is small beside the others.
                    let tests = self.settings.threshold > 0.0 && (lobe.horizon != Horizon::Diffuse || published);
                    let limit = tests.then(|| self.settings.threshold * total / strength(lobe.color));
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

    /// The lobe that is multiplied with the mask's, and the unblocked light that a lobe of the reflectance reflects, per its
    /// colour and the light's radiance. The former is the product with the light's in the published order, but the
    /// reflectance's if sampled.
    fn unblocked(&mut self, part: &ReflectanceLobe, square: &Square, above: f32) -> (Lobe8, f32) {
        let end = match part.horizon {
            Horizon::None => fraction_above(above / square.sine),
            Horizon::Diffuse | Horizon::Cosine => 1.0,
        };
        let end_lobe = |lobe: Lobe8| Lobe8 { scale: lobe.scale * f32x8::splat(end), ..lobe };
        match self.settings.order {
            Order::Published if let Some(sampler) = &self.tables.sampler => {
                let lobe = end_lobe(part.lobe);
                (lobe, sampler.integral_of_lanes(&lobe, &light_lobe(square, &self.tables.caps)))
            }
            Order::Published => {
                let product = self.tables.products.product8(&part.lobe, &light_lobe(square, &self.tables.caps));
                let product = end_lobe(product);
                (product, product.integral().to_array()[0])
            }
            Order::LightFirst if part.horizon == Horizon::Diffuse => {
                // A closed form.
                let irradiance = if above >= square.sine {
                    std::f32::consts::PI * square.sine * square.sine * above
                } else {
                    cap_irradiance(above.into(), square.sine.into()) as f32
                };
                (part.lobe, irradiance)
            }
            Order::LightFirst => {
                let lobe = end_lobe(part.lobe);
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

impl InTheWay {
    /// A sphere around receivers, and the places whose masks they share.
    fn receivers(&self, points: &[[f32; 3]]) -> BoundingSphere {
        let bounds = BoundingSphere::around(points);
        BoundingSphere { radius: bounds.radius + self.cubes.map_or(0.0, |cubes| cubes.reach()), ..bounds }
    }
}

const NOTHING: Lobe = Lobe { axis: [0.0, 1.0, 0.0], exponent: 0.0, scale: 0.0 };
