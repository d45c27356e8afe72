//! Journals: whose lines carry checksums, behind which no fuzzer would ever come by chance.

use halfshade_harness::journal::{Header, SCHEMA};

/// Hexadecimal digits of a line's checksum.
const DIGITS: usize = 32;

/// The header of the journals that the target goes on with.
pub fn journal_header() -> Header {
    Header {
        schema: SCHEMA.into(),
        experiment_hash: "ab".into(),
        quick: false,
        threads: 2,
        revision: "1".into(),
        program: String::new(),
        inputs: Vec::new(),
    }
}

/// Lines of JSON as a journal has them: each with the checksum over it and all before it.
pub fn with_checksums(lines: &[u8]) -> Vec<u8> {
    let mut hasher = blake3::Hasher::new();
    let mut journal = Vec::new();
    for line in lines.split_inclusive(|byte| *byte == b'\n') {
        let json = line.strip_suffix(b"\n").unwrap_or(line);
        hasher.update(json).update(b"\n");
        let sum = &hasher.finalize().to_hex()[..DIGITS];
        journal.extend([b"[\"", sum.as_bytes(), b"\",", json, b"]"].concat());
        if line.ends_with(b"\n") {
            journal.push(b'\n');
        }
    }
    journal
}
