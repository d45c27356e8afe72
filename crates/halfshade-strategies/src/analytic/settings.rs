//! Everything that can be set.

use halfshade_strategy::{choice, settings};

choice! {
    /// Use of an object's own spheres for the receivers on it.
    pub(crate) enum Own {
        /// left out: an object hides no light from itself
        Ignored = "ignored",
        /// as for receivers on other objects
        Spheres = "spheres",
    }
}

settings! {
    /// Everything that can be set.
    pub(crate) struct Settings {
        /// hiding of light by a receiver's own object
        "own" => own: Own = Own::Ignored;
        /// small bright parts of an environment map that become lamps, at most
        "env-lamps" => environment_lamps: usize = 2, in 0..=8;
    }
}
