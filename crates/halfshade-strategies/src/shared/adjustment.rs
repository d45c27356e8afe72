//! The parameter `rule`: what becomes of spheres that cut a receiver's tangent plane.

use halfshade_scene::spheres::AdjustRule;
use halfshade_strategy::choice;

choice! {
    /// Rules for spheres that cut a receiver's tangent plane.
    pub(crate) enum Rule for AdjustRule {
        /// one formula before and behind the plane
        Continuous = "continuous",
        /// they cover what is under them
        Covering = "covering",
        /// scaled only where their centre is behind the plane, which jumps
        Published = "published",
    }
}
