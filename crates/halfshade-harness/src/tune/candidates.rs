//! All that can be chosen: every strategy at every combination of its levels.

use crate::{HarnessError, Variant, run::Tools};

/// A strategy with a level of each of its parameters that have some.
#[derive(Debug, Clone)]
pub(super) struct Candidate {
    /// The strategy, its parameters and device.
    pub(super) variant: Variant,
    /// The same as a SPEC.
    pub(super) spec: String,
    /// Level of each parameter, from 0 on.
    levels: Vec<usize>,
}

impl Candidate {
    /// Whether it is of the same strategy and device as `other`, and no level of it is higher: `other` can't be cheaper.
    pub(super) fn is_below(&self, other: &Self) -> bool {
        let of_one_kind =
            self.variant.strategy == other.variant.strategy && self.variant.device == other.variant.device;
        of_one_kind && self.levels.iter().zip(&other.levels).all(|(own, other)| own <= other)
    }
}

/// Every candidate of the strategies of `variants` on their devices, those with the lowest levels first.
pub(super) fn candidates(tools: &Tools<'_>, variants: &[Variant]) -> Result<Vec<Candidate>, HarnessError> {
    let mut all = Vec::new();
    for Variant { strategy, device, .. } in variants {
        let info = tools.strategies[*strategy].info();
        let mut combined = vec![(info.name.to_owned(), Vec::new())];
        for parameter in info.parameters.iter().filter(|parameter| !parameter.levels.is_empty()) {
            let with_level = |(spec, levels): &(String, Vec<usize>)| {
                let separator = if levels.is_empty() { ':' } else { ',' };
                let (spec, levels) = (format!("{spec}{separator}{}", parameter.name), levels.clone());
                let add = move |(level, word): (usize, &&str)| {
                    (format!("{spec}={word}"), [levels.as_slice(), &[level]].concat())
                };
                parameter.levels.iter().enumerate().map(add).collect::<Vec<_>>()
            };
            combined = combined.iter().flat_map(with_level).collect();
        }
        for (spec, levels) in combined {
            let variant = Variant::parse(tools.strategies, &spec).map_err(HarnessError::input)?;
            all.push(Candidate { variant: variant.on(*device), spec, levels });
        }
    }
    all.sort_by_key(|candidate| candidate.levels.iter().sum::<usize>());
    Ok(all)
}
