//! What is asked of a choice.

/// Largest error, time and size; at least one of the first two.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Bounds {
    /// Relative RMSE.
    pub error: Option<f64>,
    /// Seconds of a frame: preparing and shading.
    pub frame_secs: Option<f64>,
    /// Bytes of baked data.
    pub bytes: Option<f64>,
}

/// Figures of a candidate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figures {
    /// Relative RMSE.
    pub error: f64,
    /// Seconds of a frame.
    pub frame_secs: f64,
    /// Bytes of baked data.
    pub bytes: f64,
}

impl Bounds {
    /// The largest share of a bound that is used: up to 1 all are met.
    pub fn strain(&self, figures: &Figures) -> f64 {
        let share = |bound: Option<f64>, value: f64| bound.map_or(0.0, |bound| value / bound);
        [share(self.error, figures.error), share(self.frame_secs, figures.frame_secs), share(self.bytes, figures.bytes)]
            .into_iter()
            .fold(0.0, f64::max)
    }

    /// Whether all are met.
    pub fn are_met(&self, figures: &Figures) -> bool {
        self.strain(figures) <= 1.0
    }

    /// What is made as small as it can be: the time where the error is bounded, else the error.
    pub fn cost(&self, figures: &Figures) -> f64 {
        if self.error.is_some() { figures.frame_secs } else { figures.error }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tightest_bound_counts() {
        let figures = Figures { error: 0.02, frame_secs: 0.003, bytes: 100.0 };
        let bounds = Bounds { error: Some(0.04), frame_secs: Some(0.004), bytes: None };
        assert_eq!(bounds.strain(&figures), 0.75);
        assert!(bounds.are_met(&figures) && !Bounds { bytes: Some(99.0), ..bounds }.are_met(&figures));
        assert_eq!((bounds.cost(&figures), Bounds { error: None, ..bounds }.cost(&figures)), (0.003, 0.02));
    }
}
