//! Properties that must hold for every strategy on every scene.

use crate::{
    parameters::Subject,
    random::Random,
    receivers::{self, Place, Places, described},
    ringing,
    scene::Drawn,
    tolerances::{self, WELL_CONDITIONED},
};
use glam::{DVec3, Quat, Vec3};
use halfshade_scene::{Pose, RadianceBuffer, ReceiverBuffer, Receivers, progress::Silent};
use halfshade_strategy::{Baked, Prepared, StrategyError};

/// One property that doesn't hold.
#[derive(Debug)]
pub(crate) struct Failure {
    pub(crate) property: &'static str,
    pub(crate) message: String,
}

/// Radiances between which products of light with anything stay normal numbers.
const NORMAL_RADIANCE: [f32; 2] = [1e-28, 1e28];

/// Halvings of a path on which a jump is looked for.
const HALVINGS: usize = 22;

/// Something that a strategy can't do, as it says itself, is no failure.
fn possible<T>(outcome: Result<T, StrategyError>) -> Result<Option<T>, Failure> {
    match outcome {
        Ok(done) => Ok(Some(done)),
        Err(StrategyError::Unsupported(_)) => Ok(None),
        Err(StrategyError::Failed(message)) => Err(Failure { property: "works", message }),
    }
}

type Shaded = Result<Option<Vec<RadianceBuffer>>, Failure>;

/// Shades a scene; `None` if the strategy can't model it.
fn shaded(subject: &Subject<'_>, drawn: &Drawn, receivers: &[ReceiverBuffer]) -> Shaded {
    match possible(subject.strategy.bake(&drawn.scene, &subject.params, &Silent))? {
        Some(mut baked) => shaded_by(baked.as_mut(), drawn, Quat::IDENTITY, receivers),
        None => Ok(None),
    }
}

/// The same of a scene whose objects are those that were baked, with its environment turned.
fn shaded_by(baked: &mut dyn Baked, drawn: &Drawn, turn: Quat, receivers: &[ReceiverBuffer]) -> Shaded {
    let prepared = possible(baked.prepare(&drawn.frame(turn)))?;
    Ok(prepared.map(|prepared| receivers.iter().map(|receivers| shade(prepared.as_ref(), receivers)).collect()))
}

fn shade(prepared: &dyn Prepared, receivers: &ReceiverBuffer) -> RadianceBuffer {
    // Whoever writes nothing is found out.
    let mut out = RadianceBuffer::zeros(receivers.len());
    out.channels.iter_mut().for_each(|channel| channel.fill(f32::NAN));
    prepared.shade(receivers.view(), out.view_mut());
    out
}

/// Everything that is checked of one strategy on one scene.
pub(crate) struct Check<'a> {
    pub(crate) subject: &'a Subject<'a>,
    pub(crate) unshadowed: &'a Subject<'a>,
    pub(crate) drawn: &'a Drawn,
}

/// Radiance of one scene, and what it is measured by.
struct Known {
    receivers: [ReceiverBuffer; 2],
    found: Vec<RadianceBuffer>,
    /// Per receiver: how far it may ring.
    room: Option<[Vec<Vec3>; 2]>,
    /// Per receiver: its own unshadowed radiance, the mean, or how far it may ring, whichever is largest.
    levels: [Vec<f32>; 2],
}

impl Check<'_> {
    /// Properties that fail; nothing if the strategy can't model the scene.
    pub(crate) fn run(&self, random: &mut Random) -> Option<Vec<Failure>> {
        let mut failures = Vec::new();
        let places = Places::draw(self.drawn, random);
        let receivers = places.receivers(&self.drawn.frame(Quat::IDENTITY));
        let mut baked = match possible(self.subject.strategy.bake(&self.drawn.scene, &self.subject.params, &Silent)) {
            Ok(baked) => baked?,
            Err(failure) => return Some(vec![failure]),
        };
        let baked = baked.as_mut();
        let found = match shaded_by(baked, self.drawn, Quat::IDENTITY, &receivers) {
            Ok(found) => found?,
            Err(failure) => return Some(vec![failure]),
        };
        let frame = self.drawn.frame(Quat::IDENTITY);
        let room = tolerances::of(self.subject, self.drawn).rings.map(|bands| {
            let room = |receivers: Receivers<'_>, i| ringing::room(&frame, bands, receivers, i);
            receivers.each_ref().map(|of| (0..of.len()).map(|i| room(of.view(), i)).collect::<Vec<_>>())
        });
        let mut levels = self.levels(&receivers, &found);
        for (level, room) in levels.iter_mut().zip(room.iter().flatten()) {
            level.iter_mut().zip(room).for_each(|(level, room)| *level = level.max(room.max_element()));
        }
        let known = Known { receivers, found, room, levels };
        let mut note = |outcome: Result<(), Failure>| failures.extend(outcome.err());
        let finite = self.finite(&known);
        let is_finite = finite.is_ok();
        note(finite);
        if is_finite {
            note(self.bounded(&known));
            let power = random.pick(&[-20, -9, 7, 20]);
            note(self.moved("unchanged by a power of two", baked, &known, &places, scaling(2_f32.powi(power))));
            let translation = self.drawn.extent * random.between(0.1, 2.0) * random.direction();
            let scale = random.log_between(1e-3, 1e3);
            let pose = Pose { scale, rotation: random.rotation(), translation: scale * translation };
            note(self.moved("unchanged by moving, turning and scaling", baked, &known, &places, pose));
            note(self.linear(baked, &known, random));
            note(self.darker(&known, random));
            note(self.continuous(baked, &known, random));
        }
        Some(failures)
    }

    fn levels(&self, receivers: &[ReceiverBuffer; 2], found: &[RadianceBuffer]) -> [Vec<f32>; 2] {
        let is_glossy = self.drawn.scene.is_glossy();
        // Light that bands or texels spread reaches receivers that see none.
        let is_spread = ["shadow-field", "prt"].contains(&self.subject.name);
        let open = self.drawn.open();
        let unshadowed = match shaded(self.unshadowed, &open, receivers) {
            Ok(Some(unshadowed)) if !is_glossy => unshadowed,
            // Gloss has no closed form: what the strategy itself finds, and what it finds without blockers.
            _ => shaded(self.subject, &open, receivers).ok().flatten().unwrap_or_else(|| found.to_vec()),
        };
        let mut all: Vec<Vec<f32>> = (unshadowed.iter().zip(found))
            .map(|(open, own)| {
                let own = |i: usize| if is_glossy || is_spread { own.at(i).abs().max_element() } else { 0.0 };
                (0..open.len()).map(|i| open.at(i).max_element().max(own(i))).collect()
            })
            .collect();
        let values: Vec<f64> = all.iter().flatten().map(|x| f64::from(*x)).filter(|x| x.is_finite()).collect();
        let mean = (values.iter().sum::<f64>() / values.len().max(1) as f64) as f32;
        all.iter_mut().flatten().for_each(|level| *level = level.max(mean));
        let mut all = all.into_iter();
        [all.next().unwrap_or_default(), all.next().unwrap_or_default()]
    }

    fn finite(&self, known: &Known) -> Result<(), Failure> {
        for (receivers, found) in known.receivers.iter().zip(&known.found) {
            if let Some(i) = (0..receivers.len()).find(|&i| !found.at(i).is_finite()) {
                return fail("finite", format!("{} at the {}", found.at(i), described(receivers.view(), i)));
            }
        }
        Ok(())
    }

    fn bounded(&self, known: &Known) -> Result<(), Failure> {
        let tolerances = tolerances::of(self.subject, self.drawn);
        // Reflections between surfaces come on top of the unshadowed light.
        if self.drawn.scene.bounces > 0 {
            return Ok(());
        }
        let Some(open) = shaded(self.subject, &self.drawn.open(), &known.receivers)? else {
            return Ok(());
        };
        // Ringing is about a part of the unshadowed light, which isn't all positive itself.
        let bounds = |batch: usize, i: usize| match &known.room {
            Some(room) => {
                let (open, room) = (open[batch].at(i), room[batch][i]);
                [open.min(Vec3::ZERO) - room, open.max(Vec3::ZERO) + room]
            }
            None => [Vec3::ZERO, open[batch].at(i)],
        };
        if let Ok(below) = tolerances.below {
            self.each(known, "not below zero", below, |batch, i| bounds(batch, i)[0] - known.found[batch].at(i))?;
        }
        if let Ok(above) = tolerances.above {
            self.each(known, "not above unshadowed", above, |batch, i| known.found[batch].at(i) - bounds(batch, i)[1])?;
        }
        Ok(())
    }

    fn moved(
        &self,
        property: &'static str,
        baked: &mut dyn Baked,
        known: &Known,
        places: &Places,
        pose: Pose,
    ) -> Result<(), Failure> {
        let tolerances = tolerances::of(self.subject, self.drawn);
        // Scales between keys are powers, which are rounded.
        let is_exact = pose == scaling(pose.scale) && self.drawn.is_still();
        let moved = self.drawn.moved(&pose);
        // In what touches, the last digit decides who hides what; and so it does where digits are few.
        let rounding = self.drawn.rounding().max(moved.rounding());
        if !is_exact && (self.drawn.is_touching || rounding > WELL_CONDITIONED) {
            return Ok(());
        }
        let Ok(allowed) = (if is_exact { tolerances.scaled } else { tolerances.turned }) else { return Ok(()) };
        let receivers = places.receivers(&moved.frame(pose.rotation));
        let Some(found) = shaded_by(baked, &moved, pose.rotation, &receivers)? else { return Ok(()) };
        self.each(known, property, allowed, |batch, i| (found[batch].at(i) - known.found[batch].at(i)).abs())
    }

    fn linear(&self, baked: &mut dyn Baked, known: &Known, random: &mut Random) -> Result<(), Failure> {
        let Ok(allowed) = tolerances::of(self.subject, self.drawn).linear else { return Ok(()) };
        let power = random.pick(&[-90, -60, -20, 20, 60, 90]);
        let factor = 2_f32.powi(power);
        let brightest = known.levels.iter().flatten().copied().fold(0.0, f32::max);
        let is_normal = |x: f32| (NORMAL_RADIANCE[0]..NORMAL_RADIANCE[1]).contains(&x);
        if !(is_normal(brightest) && is_normal(brightest * factor)) {
            return Ok(());
        }
        let brighter = self.drawn.brighter(factor);
        let Some(found) = shaded_by(baked, &brighter, Quat::IDENTITY, &known.receivers)? else { return Ok(()) };
        self.each(known, "linear in light", allowed, |batch, i| {
            (found[batch].at(i) / factor - known.found[batch].at(i)).abs()
        })
    }

    fn darker(&self, known: &Known, random: &mut Random) -> Result<(), Failure> {
        let more = self.drawn.with_blocker(random);
        let Ok(allowed) = tolerances::of(self.subject, self.drawn).brightened else { return Ok(()) };
        if self.drawn.scene.bounces > 0 {
            return Ok(());
        }
        let Some(found) = shaded(self.subject, &more, &known.receivers)? else { return Ok(()) };
        self.each(known, "not brighter for a blocker more", allowed, |batch, i| {
            found[batch].at(i) - known.found[batch].at(i)
        })
    }

    /// Paths across a triangle are halved where radiance changes most, until receivers lie a few roundings apart.
    fn continuous(&self, baked: &mut dyn Baked, known: &Known, random: &mut Random) -> Result<(), Failure> {
        let Ok(allowed) = tolerances::of(self.subject, self.drawn).jump else { return Ok(()) };
        if self.drawn.is_touching || self.drawn.rounding() > WELL_CONDITIONED {
            return Ok(());
        }
        let frame = self.drawn.frame(Quat::IDENTITY);
        let Some(prepared) = possible(baked.prepare(&frame))? else { return Ok(()) };
        let level = known.levels[1].iter().copied().fold(0.0, f32::max);
        for _ in 0..2 {
            let Some(start) = receivers::place(self.drawn, random) else { return Ok(()) };
            let mut corner = || f64::from(random.between(0.05, 1.0));
            let weights = DVec3::new(corner(), corner(), corner());
            let (mut from, mut to) = (start.weights, weights / weights.element_sum());
            for halving in 0..=HALVINGS {
                let path: Vec<Place> =
                    (0..=8).map(|i| Place { weights: from.lerp(to, f64::from(i) / 8.0), ..start }).collect();
                let receivers = receivers::at(&frame, &path);
                let found = shade(prepared.as_ref(), &receivers);
                let change = |i: usize| (found.at(i + 1) - found.at(i)).abs().max_element();
                let steepest = (0..8).max_by(|&a, &b| change(a).total_cmp(&change(b))).unwrap_or(0);
                let step = receivers.view().position_at(steepest).distance(receivers.view().position_at(steepest + 1));
                let reach = receivers.view().position_at(steepest).abs().max_element();
                let is_last = halving == HALVINGS || step < 32.0 * f32::EPSILON * reach;
                if change(steepest) <= allowed * level {
                    break;
                }
                if is_last {
                    let message = format!(
                        "from {} to {} (level {level}) over {step}, {:e} of the scene, at the {}",
                        found.at(steepest),
                        found.at(steepest + 1),
                        step / self.drawn.extent,
                        described(receivers.view(), steepest)
                    );
                    return fail("continuous", message);
                }
                (from, to) = (path[steepest].weights, path[steepest + 1].weights);
            }
        }
        Ok(())
    }

    /// Whether `excess` of every receiver is at most `allowed` times its level.
    fn each(
        &self,
        known: &Known,
        property: &'static str,
        allowed: f32,
        excess: impl Fn(usize, usize) -> Vec3,
    ) -> Result<(), Failure> {
        let mut worst: Option<(f32, String)> = None;
        for (batch, receivers) in known.receivers.iter().enumerate() {
            for i in 0..receivers.len() {
                let (over, level) = (excess(batch, i).max_element(), known.levels[batch][i]);
                let limit = allowed * level + f32::MIN_POSITIVE;
                if over.is_nan() || over > limit {
                    let share = over / level;
                    if worst.as_ref().is_none_or(|(other, _)| share > *other) {
                        let what = ["vertex", "point"][batch];
                        let message = format!(
                            "by {share} of {level} ({allowed} allowed) where {} was found: {what} {}",
                            known.found[batch].at(i),
                            described(receivers.view(), i)
                        );
                        worst = Some((share, message));
                    }
                }
            }
        }
        match worst {
            Some((_, message)) => fail(property, message),
            None => Ok(()),
        }
    }
}

fn scaling(scale: f32) -> Pose {
    Pose { scale, ..Pose::IDENTITY }
}

fn fail(property: &'static str, message: String) -> Result<(), Failure> {
    Err(Failure { property, message })
}
