//! Version and commit of the program.

/// Version and, where it is known, the commit: `0.1.0 (0123abc)`.
pub const REVISION: &str = env!("HALFSHADE_REVISION");
