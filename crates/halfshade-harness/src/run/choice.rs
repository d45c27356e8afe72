//! Choice of an experiment's strategies that are pictured, and of those that are compared with each other.

use crate::{Device, Experiment, HarnessError, Variant};
use halfshade_scene::keys::Spanned;
use halfshade_strategy::Strategy;

/// Finds strategies by their SPECs.
pub(super) struct VariantChoice<'a> {
    pub(super) experiment: &'a Experiment,
    pub(super) strategies: &'a [Box<dyn Strategy>],
    pub(super) devices: &'a [Device],
    pub(super) variants: &'a [Variant],
}

impl VariantChoice<'_> {
    /// Keys of the variants of which pictures are drawn.
    pub(super) fn pictured(&self) -> Result<Vec<String>, HarnessError> {
        let Some(settings) = &self.experiment.pictures else { return Ok(Vec::new()) };
        let Some(specs) = &settings.strategies else { return Ok(self.variants.iter().map(Variant::key).collect()) };
        let mut pictured: Vec<String> = Vec::new();
        for spec in specs {
            let found = &self.variants[self.place_of(spec)?];
            let keys: Vec<String> = self.devices.iter().map(|&device| found.on(device).key()).collect();
            if keys.iter().any(|key| pictured.contains(key)) {
                let problem = format!("`{}` is pictured already; name each once", spec.get_ref());
                return Err(self.experiment.error_at(spec.span(), problem));
            }
            pictured.extend(keys);
        }
        Ok(pictured)
    }

    /// Places of the two variants whose difference is drawn.
    pub(super) fn difference(&self) -> Result<Option<[usize; 2]>, HarnessError> {
        let settings = self.experiment.pictures.as_ref();
        settings.and_then(|settings| settings.difference.as_ref()).map(|specs| self.pair_of(specs)).transpose()
    }

    /// Place of the variant that all others are compared with in verdicts, on the first device.
    pub(super) fn baseline(&self) -> Result<Option<usize>, HarnessError> {
        self.experiment.baseline.as_ref().map(|spec| self.place_of(spec)).transpose()
    }

    /// Places of the pairs that are compared with each other: those that are named, on the first device, and the same on
    /// several devices.
    pub(super) fn pairs(&self) -> Result<Vec<[usize; 2]>, HarnessError> {
        let mut pairs: Vec<[usize; 2]> = self.device_pairs();
        for specs in &self.experiment.compare {
            let pair = self.pair_of(specs)?;
            if pairs.contains(&pair) {
                let problem = "`compare` has this pair already; name each once";
                return Err(self.experiment.error_at(specs[0].span(), problem));
            }
            pairs.push(pair);
        }
        Ok(pairs)
    }

    /// Every variant on other devices beside itself on the first; variants lie side by side, device by device.
    fn device_pairs(&self) -> Vec<[usize; 2]> {
        let count = self.devices.len();
        let of_one = |first: usize| (first + 1..first + count).map(move |other| [other, first]);
        (0..self.variants.len()).step_by(count.max(1)).flat_map(of_one).collect()
    }

    fn pair_of(&self, [a, b]: &[Spanned<String>; 2]) -> Result<[usize; 2], HarnessError> {
        let pair = [self.place_of(a)?, self.place_of(b)?];
        if pair[0] == pair[1] {
            return Err(self.experiment.error_at(a.span(), "this compares a strategy with itself: name two"));
        }
        Ok(pair)
    }

    fn place_of(&self, spec: &Spanned<String>) -> Result<usize, HarnessError> {
        let error = |problem| self.experiment.error_at(spec.span(), problem);
        let device = self.devices.first().copied().unwrap_or_default();
        let key = Variant::parse(self.strategies, spec.get_ref()).map_err(error)?.on(device).key();
        let unknown = || error(format!("`{}` is named here but not among the strategies", spec.get_ref()));
        self.variants.iter().position(|variant| variant.key() == key).ok_or_else(unknown)
    }
}
