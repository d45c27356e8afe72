//! Shadow fields.

mod end_to_end;
