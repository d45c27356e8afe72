//! The command, as a library for its own tests.
