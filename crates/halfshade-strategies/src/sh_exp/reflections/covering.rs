//! How spheres cover each other in the second pass [Guerrero2007, 4.3.3].

/// In which order spheres cover each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Order {
    /// By the distance of their centres [Guerrero2007, 4.3.3].
    Center,
    /// By power distance `d² - r²`: spheres that intersect are cut apart by their radical plane, and this is the order in
    /// which the pieces cover each other.
    Power,
}

/// What of spheres of one object that intersect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Intersections {
    /// They don't cover each other here: the colours know [Guerrero2007, 4.3.3].
    Precomputed,
    /// The nearer one covers the other.
    Ordered,
}

/// How sums over nearer spheres are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Walk {
    /// One by one.
    Quadratic,
    /// From a running sum.
    Linear,
}
