//! Small scenes with real traces, for tests of what the truth's noise does to figures.

use crate::{Weighting, errors::Reference, weights::ReceiverWeights};
use glam::Vec3;
use halfshade_scene::{
    Environment, Frame, Motion, Pose, RadianceBuffer, ReceiverBuffer, Scene, SphereLight, builtin,
    light::{EnvironmentMap, Sun},
    progress::Silent,
};
use halfshade_truth::{Hider, Options, Tracer, Transport, estimate, hiders};
use std::sync::{Arc, LazyLock};

/// Every so many vertices of a scene are receivers.
const STRIDE: usize = 23;

/// A scene, some of its vertices, and what is known of them exactly enough.
pub(crate) struct Traced {
    pub(crate) name: &'static str,
    scene: Scene,
    receivers: ReceiverBuffer,
    weights: Arc<ReceiverWeights>,
    hiders: Arc<[Hider]>,
    /// The truth from many samples.
    pub(crate) exact: RadianceBuffer,
    /// The same without shadows.
    pub(crate) unshadowed: RadianceBuffer,
}

impl Traced {
    /// Grey light, coloured light from a map and a sun, and two lamps.
    pub(crate) fn all() -> &'static [Self] {
        static ALL: LazyLock<[Traced; 3]> = LazyLock::new(Traced::trace_all);
        &*ALL
    }

    fn trace_all() -> [Self; 3] {
        let coloured = (0..32 * 16).map(|i| {
            let wave = |n: usize| (0.7 * (i * n % 97) as f32).sin().max(0.0).powi(4);
            Vec3::new(wave(3), wave(5), wave(7)) + 0.05
        });
        let sun = Sun { direction: Vec3::new(0.5, 0.8, 0.2), angular_radius: 0.2, radiance: Vec3::new(9.0, 6.0, 2.0) };
        let map = EnvironmentMap::new(32, 16, coloured.collect()).map(Environment::map);
        let coloured = Environment { sun: Some(sun), ..map.unwrap_or_else(|| Environment::constant(Vec3::ONE)) };
        let lamp = |x: f32, color: Vec3| {
            let light = SphereLight { center: Vec3::new(x, 3.0, 1.0), radius: 0.3, radiance: 40.0 * color };
            (light, Motion::Still(Pose::IDENTITY))
        };
        let lamps = vec![lamp(-1.5, Vec3::new(1.0, 0.8, 0.5)), lamp(2.0, Vec3::splat(0.5))];
        [
            Self::new("grey light", "vases", Environment::constant(Vec3::ONE), Vec::new()),
            Self::new("coloured light", "one-sphere", coloured, Vec::new()),
            Self::new("lamps", "vases", Environment::constant(Vec3::ZERO), lamps),
        ]
    }

    fn new(name: &'static str, built_in: &str, environment: Environment, lights: Vec<(SphereLight, Motion)>) -> Self {
        let scene = Scene { environment, lights, ..builtin::scene(built_in).expect("built in") };
        let frame = scene.frame(0);
        let vertices = ReceiverBuffer::vertices(&frame);
        let places: Vec<u32> = (0..vertices.len() as u32).step_by(STRIDE).collect();
        let receivers = ReceiverBuffer::gathered(vertices.view(), &places);
        let areas = ReceiverWeights::by_area(&frame, &vertices);
        let own = places.iter().map(|&place| areas.values()[place as usize]).collect();
        let weights = Arc::new(ReceiverWeights::of(Weighting::Area, own).expect("vertices with area"));
        let trace = |transport| {
            let options = Options { samples: 8192, seed: 1 << 40, transport, ..Options::default() };
            estimate(&Tracer::new(&frame), receivers.view(), &options, &Silent).radiance
        };
        let (exact, unshadowed) = (trace(Transport::Shadowed), trace(Transport::Unshadowed));
        let hiders = hiders(&Tracer::new(&frame), receivers.view(), &Silent).into();
        drop(frame);
        Self { name, hiders, receivers, weights, exact, unshadowed, scene }
    }

    /// The truth as 64 samples and a seed show it.
    pub(crate) fn reference(&self, seed: u64) -> Reference {
        self.sampled(64, seed)
    }

    /// The same of as many samples as are asked for.
    fn sampled(&self, samples: usize, seed: u64) -> Reference {
        let frame: Frame<'_> = self.scene.frame(0);
        let tracer = Tracer::new(&frame);
        let options = Options { samples, seed, ..Options::default() };
        let found = estimate(&tracer, self.receivers.view(), &options, &Silent);
        let unshadowed_mean = self.weights.mean(|i| f64::from(found.unshadowed[i]));
        Reference {
            standard_error: found.standard_error,
            draws: found.draws,
            hiders: self.hiders.clone(),
            unshadowed: found.unshadowed.into(),
            ..Reference::exact(found.radiance, unshadowed_mean, self.weights.clone())
        }
    }

    /// The truth of the receivers at `places`, which may repeat, as so many samples and a seed show it; and what each of `all` has
    /// there.
    pub(crate) fn drawn(
        &self,
        samples: usize,
        seed: u64,
        places: &[u32],
        all: &[RadianceBuffer],
    ) -> (Reference, Vec<RadianceBuffer>) {
        let own = places.iter().map(|&place| self.weights.values()[place as usize]).collect();
        let weights = ReceiverWeights::of(Weighting::Area, own).expect("vertices with area");
        let part = Self {
            receivers: ReceiverBuffer::gathered(self.receivers.view(), places),
            weights: Arc::new(weights),
            hiders: Arc::default(),
            scene: self.scene.clone(),
            exact: RadianceBuffer::zeros(0),
            unshadowed: RadianceBuffer::zeros(0),
            name: self.name,
        };
        let of = |buffer: &RadianceBuffer| RadianceBuffer {
            channels: buffer
                .channels
                .each_ref()
                .map(|values| places.iter().map(|&place| values[place as usize]).collect()),
        };
        (Reference { draws: Vec::new(), ..part.sampled(samples, seed) }, all.iter().map(of).collect())
    }

    /// The truth without noise.
    pub(crate) fn without_noise(&self) -> Reference {
        let unshadowed = self.unshadowed.channels.each_ref();
        let unshadowed: Arc<[f32]> =
            (0..self.exact.len()).map(|i| unshadowed.map(|c| c[i]).iter().sum::<f32>() / 3.0).collect();
        let mean = self.weights.mean(|i| f64::from(unshadowed[i]));
        Reference { unshadowed, ..Reference::exact(self.exact.clone(), mean, self.weights.clone()) }
    }

    /// How many receivers there are.
    pub(crate) fn len(&self) -> usize {
        self.exact.len()
    }

    /// Strategies that err in different ways, by name: without shadows, too light in shadows, too bright by a tenth,
    /// ringing by receiver and channel, and hardly at all.
    pub(crate) fn strategies(&self) -> Vec<(&'static str, RadianceBuffer)> {
        let mixed = |value: &dyn Fn(f32, f32, usize) -> f32| RadianceBuffer {
            channels: std::array::from_fn(|c| {
                let both = self.exact.channels[c].iter().zip(&self.unshadowed.channels[c]).enumerate();
                both.map(|(i, (exact, unshadowed))| value(*exact, *unshadowed, 3 * i + c)).collect()
            }),
        };
        vec![
            ("no-shadows", mixed(&|_, unshadowed, _| unshadowed)),
            ("light", mixed(&|exact, unshadowed, _| 0.7 * exact + 0.3 * unshadowed)),
            ("bright", mixed(&|exact, _, _| 1.1 * exact)),
            ("ringing", mixed(&|exact, unshadowed, i| exact + 0.1 * unshadowed * (1.7 * i as f32).sin())),
            ("exact", mixed(&|exact, _, _| 1.001 * exact)),
        ]
    }
}
