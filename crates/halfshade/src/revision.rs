//! Version and commit of the program.

/// Version and, where it is known, the commit.
pub fn revision() -> String {
    match env!("HALFSHADE_COMMIT") {
        "" => env!("CARGO_PKG_VERSION").to_owned(),
        commit => format!("{} ({commit})", env!("CARGO_PKG_VERSION")),
    }
}
