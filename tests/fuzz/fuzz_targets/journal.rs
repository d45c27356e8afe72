#![no_main]
//! Journals of runs that were interrupted: as they are, or with checksums that fit; read, gone on with, and read again.

use halfshade_fuzz::{file, journal_header, with_checksums};
use halfshade_harness::journal::Journal;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Some((&kind, bytes)) = bytes.split_first() else { return };
    let path = file("journal.jsonl", &if kind & 1 == 0 { bytes.to_vec() } else { with_checksums(bytes) });
    let Ok(Some((mut journal, entries))) = Journal::resume(&path, &journal_header()) else { return };
    let count = entries.len();
    for entry in &entries {
        journal.append(entry).expect("what was read can be written");
    }
    drop(journal);
    let again = Journal::resume(&path, &journal_header()).expect("what was written can be read");
    assert_eq!(again.map(|(_, again)| again.len()), Some(2 * count));
});
