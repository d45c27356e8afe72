//! What has a twin: functions of arrays and numbers.

pub(crate) mod dot;
