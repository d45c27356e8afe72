//! Groups of runs that are shown together.

use crate::results::{Results, Run, Status};

/// One frame of one scene, over one kind of receivers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Group {
    /// Scene name.
    pub scene: String,
    /// Frame number.
    pub frame: usize,
    /// `vertices` or `pixels`.
    pub receivers: String,
}

impl Group {
    /// Every group there is, in order.
    pub fn all(results: &Results) -> Vec<Self> {
        let mut groups: Vec<Self> = Vec::new();
        for run in &results.runs {
            let group = Self { scene: run.scene.clone(), frame: run.frame, receivers: run.receivers.clone() };
            if !groups.contains(&group) {
                groups.push(group);
            }
        }
        groups
    }

    /// Scene and frame, for people.
    pub(super) fn place(&self) -> String {
        format!("{}, frame {}", self.scene, self.frame)
    }

    /// Whether a scene, frame and kind of receivers are this group's.
    pub(super) fn has(&self, scene: &str, frame: usize, receivers: &str) -> bool {
        self.scene == scene && self.frame == frame && self.receivers == receivers
    }

    /// Its runs, against all references.
    pub(super) fn runs<'a>(&'a self, results: &'a Results) -> impl Iterator<Item = &'a Run> {
        results.runs.iter().filter(|run| self.has(&run.scene, run.frame, &run.receivers))
    }

    /// The reference that errors are told against first.
    pub(super) fn first_reference<'a>(&'a self, results: &'a Results) -> &'a str {
        self.runs(results).map(Run::reference).find(|reference| !reference.is_empty()).unwrap_or("mesh")
    }

    /// One run of each strategy: against the first reference, or with the reason why it wasn't measured.
    pub(super) fn strategies<'a>(&'a self, results: &'a Results) -> Vec<&'a Run> {
        let reference = self.first_reference(results);
        self.runs(results)
            .filter(|run| !run.is_reference() && (run.reference() == reference || run.status != Status::Ok))
            .collect()
    }
}

impl std::fmt::Display for Group {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}, frame {}, {}", self.scene, self.frame, self.receivers)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// The only group of [`crate::results::tests::example`].
    pub(in crate::report) fn only() -> Group {
        Group { scene: "vases".into(), frame: 0, receivers: "vertices".into() }
    }
}
