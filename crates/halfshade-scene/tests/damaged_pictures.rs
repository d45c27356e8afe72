//! Pictures damaged at random, in a process of their own, whose memory is measured.

mod picture_files;

use halfshade_scene::light::{ProbeOptions, Projection, load_probe};
use picture_files::{radiance_picture, stored, written};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Bytes of the peak of this process's memory, where the system tells.
fn peak_memory() -> Option<usize> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.split_whitespace().next()?.parse::<usize>().ok().map(|kilobytes| kilobytes << 10)
}

/// Bytes changed, cut out, doubled and written over by others, mostly in headers: an answer or an error, no panic, and no
/// memory beyond what such short files may stand for. HALFSHADE_MUTATIONS says how many are tried of each file.
#[test]
fn damaged_pictures_are_answered() {
    let rounds = std::env::var("HALFSHADE_MUTATIONS").ok().and_then(|n| n.parse().ok()).unwrap_or(150);
    let folder = tempfile::tempdir().unwrap();
    let mut sound: Vec<(String, Vec<u8>)> = std::fs::read_dir(stored(""))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .map(|path| (path.file_name().unwrap().to_string_lossy().into_owned(), std::fs::read(&path).unwrap()))
        .collect();
    sound.sort();
    sound.push(("new.hdr".into(), radiance_picture("EXPOSURE=2\nPRIMARIES=.64 .33 .29 .6 .15 .06 .333 .333")));
    let mut flat = b"#?RGBE\nFORMAT=32-bit_rle_rgbe\n\n+X 16 -Y 8\n".to_vec();
    flat.extend([[130, 128, 9, 129], [1, 1, 1, 7]].concat().repeat(16));
    sound.push(("old.hdr".into(), flat));
    let mut rng = Pcg64Mcg::seed_from_u64(11);
    let (mut read, mut refused) = (0, 0);
    for (name, bytes) in &sound {
        for _ in 0..rounds {
            let mut damaged = bytes.clone();
            for _ in 0..rng.random_range(1..4) {
                let within = if rng.random_bool(0.6) { damaged.len().min(400) } else { damaged.len() };
                let at = rng.random_range(0..within);
                let end = (at + rng.random_range(1..24)).min(damaged.len());
                match rng.random_range(0..6) {
                    0 => damaged[at] = rng.random(),
                    1 => damaged[at] ^= 1 << rng.random_range(0..8),
                    2 => damaged[at..(at + 4).min(end)]
                        .fill(*[0, 0x7f, 0x80, 0xff].get(rng.random_range(0..4)).unwrap_or(&0)),
                    3 => damaged.truncate(at.max(1)),
                    4 => drop(damaged.drain(at..end - usize::from(end - at == damaged.len()))),
                    _ => {
                        let piece = damaged[at..end].to_vec();
                        let place = rng.random_range(0..damaged.len());
                        damaged.splice(place..place, piece);
                    }
                }
                if damaged.is_empty() {
                    break;
                }
            }
            let options = ProbeOptions { projection: Some(Projection::LatLong), ..ProbeOptions::default() };
            match load_probe(&written(&folder, name, &damaged), &options) {
                Ok((map, _)) => {
                    assert!(map.texels().iter().all(|texel| texel.is_finite() && texel.min_element() >= 0.0));
                    read += 1;
                }
                Err(error) => {
                    assert!(error.to_string().contains(name.as_str()), "{error}");
                    refused += 1;
                }
            }
        }
    }
    assert!(read > 0 && refused > 0, "{read} {refused}");
    // 4096 texels of 12 bytes for each of a thousand bytes, a block and its compressed form, and the test itself.
    assert!(peak_memory().is_none_or(|bytes| bytes < 1 << 30), "{:?}", peak_memory());
}
