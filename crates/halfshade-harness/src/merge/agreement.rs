//! Parts that may be joined: of one experiment, one program, one set of files.

use super::loaded::Loaded;
use crate::{HarnessError, Part, inputs};

/// Refuses `part` where it doesn't belong with `first`.
pub(super) fn check_agreement(first: &Loaded, part: &Loaded) -> Result<(), HarnessError> {
    let Some(what) = difference(first, part) else { return Ok(()) };
    let problem = format!("doesn't belong with {}: {what}", first.folder.display());
    Err(HarnessError::in_file(&part.folder, problem))
}

/// The first difference that matters, for people.
fn difference(first: &Loaded, part: &Loaded) -> Option<String> {
    let (a, b) = (&first.results, &part.results);
    if a.experiment != b.experiment {
        return Some(format!("it is of experiment {}, not {}", b.experiment, a.experiment));
    }
    if a.experiment_hash != b.experiment_hash {
        return Some("the experiment file was another, or another part of it was named by --only".into());
    }
    if a.revision != b.revision {
        return Some(format!("it was made by halfshade {}, not {}", b.revision, a.revision));
    }
    if a.quick != b.quick {
        return Some("one was made with --quick, one without".into());
    }
    if first.facts.devices != part.facts.devices {
        return Some("it ran on other devices".into());
    }
    if let (Part::Errors(one), Part::Errors(other)) = (first.facts.part, part.facts.part)
        && one.count != other.count
    {
        return Some(format!("it is one of {} shards, not of {}", other.count, one.count));
    }
    let changes = inputs::changes(a.inputs.as_deref().unwrap_or_default(), b.inputs.as_deref().unwrap_or_default());
    (!changes.is_empty()).then(|| format!("its scenes were read from other files: {}", changes.join(", ")))
}
