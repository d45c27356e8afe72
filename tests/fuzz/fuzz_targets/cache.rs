#![no_main]
//! Cache entries: as they are, and with a checksum that fits, so that what lies behind it is read too.

use halfshade_fuzz::{cache_entry, with_checksum};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Some((&kind, bytes)) = bytes.split_first() else { return };
    let entry = if kind & 1 == 0 { bytes.to_vec() } else { with_checksum(bytes) };
    cache_entry(kind >> 1, &entry);
});
