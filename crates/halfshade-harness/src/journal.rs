//! The journal of a run in progress: one line of JSON per fact, flushed at once, so that interruption loses nothing
//! that was measured.
//!
//! A line is an array of two: a checksum over it and all lines before it, and the fact. The first line says what is being
//! run. An interrupted write leaves a last line without its end: it is cut off when the journal is opened again. Damage
//! anywhere else, lines that are gone or change places among it, is refused.

use crate::{
    HarnessError, Part,
    image_metrics::Similarity,
    inputs,
    results::{PictureFiles, Run, Sample},
};
use halfshade_scene::{InputFile, text};
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use std::{
    fs::{File, OpenOptions},
    io::{Seek, SeekFrom, Write},
    path::{Path, PathBuf},
};

/// Identity of a run; a journal can only be continued by the same one.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    /// [`SCHEMA`].
    pub schema: String,
    /// Hash of the experiment file.
    pub experiment_hash: String,
    /// The part of the experiment.
    #[serde(default)]
    pub part: Part,
    /// Whether with `--quick`.
    pub quick: bool,
    /// Threads: times on other counts are other times.
    pub threads: usize,
    /// Version and commit of the program.
    pub revision: String,
    /// Hash of the program itself, which changes more often than its commit; empty if it isn't known.
    pub program: String,
    /// The files that the experiment's scenes are read from.
    pub inputs: Vec<InputFile>,
}

impl Header {
    /// Why what `self` began can't go on as `now`, if it can't.
    pub fn difference(&self, now: &Self) -> Option<String> {
        // Without `..`: what is added must be compared.
        let Self { schema, experiment_hash, part, quick, threads, revision, program, inputs } = self;
        let is_known = !program.is_empty() && !now.program.is_empty();
        if *schema != now.schema || *revision != now.revision || (is_known && *program != now.program) {
            return Some("it was started by another version of the program".to_owned());
        }
        if *experiment_hash != now.experiment_hash {
            return Some("the experiment file has changed since".to_owned());
        }
        if *part != now.part {
            return Some(format!("it was started for another part of the experiment, {part}"));
        }
        if *quick != now.quick {
            return Some("it was started with another --quick".to_owned());
        }
        if *threads != now.threads {
            return Some(format!("it was started with another number of threads, {threads}"));
        }
        let changes = inputs::changes(inputs, &now.inputs);
        (!changes.is_empty()).then(|| changes.join(", "))
    }
}

/// The name and version of the journal's layout.
pub const SCHEMA: &str = "halfshade.journal/2";

/// Hexadecimal digits of a checksum.
const DIGITS: usize = 32;

/// One fact.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Entry {
    /// A strategy was scored against every reference; its time may still lack samples.
    Scored(Vec<Run>),
    /// A frame of the strategy with this key was timed.
    Timed {
        /// [`Run::key`].
        key: String,
        /// How long it took.
        sample: Sample,
    },
    /// Pictures of one strategy were written; with the similarity of the key's run to the truth.
    Pictured {
        /// [`Run::key`], or nothing for the truth's.
        key: Option<String>,
        /// The files.
        files: PictureFiles,
        /// Similarity with the truth; nothing for other pictures.
        similarity: Similarity,
    },
}

impl Entry {
    /// The first figure that is not finite, by its place: JSON has no word for it.
    fn not_finite(&self) -> Option<String> {
        match self {
            Self::Scored(runs) => runs.iter().find_map(|run| Some(format!("{} of {}", run.not_finite()?, run.key()))),
            Self::Timed { key, sample } => (!sample.sum_secs().is_finite()).then(|| format!("time of {key}")),
            Self::Pictured { files, similarity: Similarity { flip, ssim }, .. } => {
                let is_finite = [flip, ssim].into_iter().flatten().all(|value| value.is_finite());
                files.not_finite().or_else(|| (!is_finite).then(|| format!("similarity of {}", files.png)))
            }
        }
    }
}

/// A journal open for appending.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    length: u64,
    chain: Chain,
}

/// Checksums of lines, each over all that came before it.
#[derive(Debug, Clone, Default)]
struct Chain(blake3::Hasher);

impl Chain {
    /// The line of a fact in JSON.
    fn line(&mut self, json: &str) -> String {
        format!("[\"{}\",{json}]\n", self.next(json))
    }

    fn next(&mut self, json: &str) -> String {
        self.0.update(json.as_bytes()).update(b"\n");
        self.0.finalize().to_hex()[..DIGITS].to_owned()
    }

    /// The fact of a line without its end.
    fn read<T: DeserializeOwned>(&mut self, line: &str) -> Result<T, String> {
        let split = line.strip_prefix("[\"").and_then(|rest| rest.split_at_checked(DIGITS));
        let (sum, json) = split
            .and_then(|(sum, rest)| Some((sum, rest.strip_prefix("\",")?.strip_suffix(']')?)))
            .ok_or("no checksum")?;
        if self.next(json) != sum {
            return Err("the checksum does not match".to_owned());
        }
        serde_json::from_str(json).map_err(|error| error.to_string())
    }
}

impl Journal {
    /// Sets the journal at `path` aside, under a name that nothing has: `journal.old`, `journal.2.old`, ..
    pub fn set_aside(path: &Path) -> Result<PathBuf, HarnessError> {
        let mut old = path.with_extension("old");
        let mut number = 2;
        while std::fs::symlink_metadata(&old).is_ok() {
            old = path.with_extension(format!("{number}.old"));
            number += 1;
        }
        std::fs::rename(path, &old).map_err(|source| HarnessError::io(path, "rename", source))?;
        Ok(old)
    }

    /// Starts a new journal at `path`, where nothing may be.
    pub fn create(path: &Path, header: &Header) -> Result<Self, HarnessError> {
        let fail = |source| HarnessError::io(path, "write", source);
        let file = OpenOptions::new().create_new(true).append(true).open(path).map_err(fail)?;
        let mut journal = Self { path: path.to_owned(), file, length: 0, chain: Chain::default() };
        journal.append_line(header)?;
        Ok(journal)
    }

    /// Opens the journal at `path` to go on, and returns what it holds; nothing if not even its first line was finished.
    pub fn resume(path: &Path, header: &Header) -> Result<Option<(Self, Vec<Entry>)>, HarnessError> {
        let bytes = std::fs::read(path).map_err(|source| HarnessError::io(path, "read", source))?;
        let whole = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |last| last + 1);
        let text = text::decode(&bytes[..whole]).map_err(|error| {
            let problem = format!("damaged: {}; run without --resume to start again", error.problem);
            HarnessError::at_line(path, error.line.unwrap_or(1), problem)
        })?;
        let damaged = |line: usize, problem: String| {
            let problem = format!("damaged: {problem}; run without --resume to start again");
            HarnessError::at_line(path, line + 1, problem)
        };
        let mut lines = text.split_terminator('\n').enumerate();
        let Some((_, first)) = lines.next() else { return Ok(None) };
        let mut chain = Chain::default();
        if first.contains("\"halfshade.journal/") && !first.contains(&format!("\"{SCHEMA}\"")) {
            let problem = "cannot resume: it was started by another version of the program; run without --resume to \
                           start again";
            return Err(HarnessError::in_file(path, problem));
        }
        let found: Header = chain.read(first).map_err(|problem| damaged(0, problem))?;
        if let Some(what) = found.difference(header) {
            let problem = format!("cannot resume: {what}; run without --resume to start again");
            return Err(HarnessError::in_file(path, problem));
        }
        let mut entries = Vec::new();
        for (number, line) in lines {
            let entry: Entry = chain.read(line).map_err(|problem| damaged(number, problem))?;
            if let Some(figure) = entry.not_finite() {
                return Err(damaged(number, format!("{figure} is not finite")));
            }
            entries.push(entry);
        }
        let fail = |source| HarnessError::io(path, "write", source);
        let mut file = OpenOptions::new().write(true).open(path).map_err(fail)?;
        file.set_len(whole as u64).and_then(|()| file.seek(SeekFrom::End(0)).map(drop)).map_err(fail)?;
        Ok(Some((Self { path: path.to_owned(), file, length: whole as u64, chain }, entries)))
    }

    /// Adds one fact.
    pub fn append(&mut self, entry: &Entry) -> Result<(), HarnessError> {
        if let Some(figure) = entry.not_finite() {
            return Err(HarnessError::in_file(&self.path, format!("{figure} is not finite")));
        }
        self.append_line(entry)
    }

    fn append_line(&mut self, value: &impl Serialize) -> Result<(), HarnessError> {
        let json = serde_json::to_string(value)
            .map_err(|error| HarnessError::in_file(&self.path, format!("cannot be written as JSON: {error}")))?;
        let line = self.chain.line(&json);
        if let Err(source) = self.file.write_all(line.as_bytes()) {
            // Earlier lines stay whole. An error of this cut would be the one already reported.
            let _ = self.file.set_len(self.length);
            return Err(HarnessError::io(&self.path, "write", source));
        }
        self.length += line.len() as u64;
        Ok(())
    }

    /// Removes the journal once everything it holds is in the results.
    pub fn finish(self) -> Result<(), HarnessError> {
        std::fs::remove_file(&self.path).map_err(|source| HarnessError::io(&self.path, "remove", source))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    fn header() -> Header {
        Header {
            schema: SCHEMA.into(),
            experiment_hash: "ab".into(),
            part: Part::Whole,
            quick: false,
            threads: 2,
            revision: "1".into(),
            program: "ff".into(),
            inputs: vec![InputFile { path: "scene.toml".into(), blake3: "cd".into() }],
        }
    }

    fn resume(path: &Path) -> Result<(Journal, Vec<Entry>), String> {
        let resumed = Journal::resume(path, &header()).map_err(|error| error.to_string());
        resumed.map(|journal| journal.expect("a journal with a first line"))
    }

    fn entries() -> Vec<Entry> {
        let run = results::tests::example().runs.remove(0);
        // Read without care for the last bit, the first of these would come back as its neighbour.
        let sample = Sample::new(3.3300000000000005e-7, 0.1 + 0.2);
        vec![Entry::Timed { key: run.key(), sample }, Entry::Scored(vec![run])]
    }

    #[test]
    fn what_was_appended_comes_back_to_the_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal.jsonl");
        let mut journal = Journal::create(&path, &header()).unwrap();
        for entry in entries() {
            journal.append(&entry).unwrap();
        }
        drop(journal);
        let (journal, found) = resume(&path).unwrap();
        assert_eq!(found, entries());
        journal.finish().unwrap();
        assert!(!path.exists());
    }

    #[test]
    fn a_journal_cut_anywhere_keeps_its_whole_lines_and_goes_on() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal.jsonl");
        let mut journal = Journal::create(&path, &header()).unwrap();
        for entry in entries() {
            journal.append(&entry).unwrap();
        }
        let bytes = std::fs::read(&path).unwrap();
        let first = bytes.iter().position(|&byte| byte == b'\n').unwrap() + 1;
        for cut in first..bytes.len() {
            std::fs::write(&path, &bytes[..cut]).unwrap();
            let whole = bytes[..cut].iter().filter(|&&byte| byte == b'\n').count() - 1;
            let (mut journal, found) = resume(&path).unwrap();
            assert_eq!(found, entries()[..whole]);
            journal.append(&entries()[0]).unwrap();
            let (_, found) = resume(&path).unwrap();
            assert_eq!(found.last(), entries().first());
        }
        for cut in 0..first {
            std::fs::write(&path, &bytes[..cut]).unwrap();
            assert!(Journal::resume(&path, &header()).unwrap().is_none());
        }
    }

    #[test]
    fn damage_and_changed_experiments_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal.jsonl");
        let mut journal = Journal::create(&path, &header()).unwrap();
        journal.append(&entries()[0]).unwrap();
        journal.append(&entries()[1]).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, text.replacen("timed", "tymed", 1)).unwrap();
        let error = resume(&path).unwrap_err();
        assert!(error.contains("journal.jsonl:2: damaged"), "{error}");
        std::fs::write(&path, text).unwrap();
        for (other, what) in [
            (Header { experiment_hash: "cd".into(), ..header() }, "experiment file has changed"),
            (Header { quick: true, ..header() }, "--quick"),
            (Header { part: Part::Times, ..header() }, "another part of the experiment, the whole"),
            (Header { threads: 1, ..header() }, "threads, 2"),
            (Header { revision: "2".into(), ..header() }, "another version"),
            (Header { program: "fe".into(), ..header() }, "another version"),
            (Header { schema: "halfshade.journal/1".into(), ..header() }, "another version"),
            (Header { inputs: Vec::new(), ..header() }, "`scene.toml` is no longer read"),
            (
                Header { inputs: vec![InputFile { blake3: "ce".into(), ..header().inputs[0].clone() }], ..header() },
                "`scene.toml` has changed",
            ),
        ] {
            let error = Journal::resume(&path, &other).unwrap_err().to_string();
            assert!(error.contains(what) && error.contains("without --resume"), "{what}: {error}");
        }
        assert!(Journal::resume(&path, &Header { program: String::new(), ..header() }).is_ok());
        assert!(Journal::create(&path, &header()).is_err());
        std::fs::write(folder.path().join("journal.2.old"), "precious").unwrap();
        for name in ["journal.old", "journal.3.old"] {
            let before = std::fs::read(&path).unwrap();
            assert_eq!(Journal::set_aside(&path).unwrap(), folder.path().join(name));
            assert_eq!(std::fs::read(folder.path().join(name)).unwrap(), before);
            Journal::create(&path, &header()).unwrap();
        }
        assert_eq!(std::fs::read(folder.path().join("journal.2.old")).unwrap(), b"precious");
        // The first line of an older layout.
        std::fs::write(&path, "{\"schema\":\"halfshade.journal/1\"}\n").unwrap();
        assert!(resume(&path).unwrap_err().contains("another version"));
    }

    /// Infinity would be written as `null`, which no number is read from; a time that overflows is none.
    #[test]
    fn figures_that_are_not_finite_are_neither_written_nor_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal.jsonl");
        let mut journal = Journal::create(&path, &header()).unwrap();
        let pictured = |exposure| Entry::Pictured {
            key: None,
            files: results::PictureFiles {
                scene: "vases".into(),
                frame: 0,
                label: "truth".into(),
                exr: "a.exr".into(),
                png: "a.png".into(),
                error_png: None,
                flip_png: None,
                exposure,
            },
            similarity: Similarity::default(),
        };
        let slow = Entry::Timed { key: "k".into(), sample: Sample::new(f64::MAX, f64::MAX) };
        for (entry, what) in [(pictured(f32::INFINITY), "exposure of a.png"), (slow.clone(), "time of k")] {
            let error = journal.append(&entry).unwrap_err().to_string();
            assert!(error.contains(what), "{error}");
        }
        let json = serde_json::to_string(&slow).unwrap();
        let line = journal.chain.line(&json);
        journal.file.write_all(line.as_bytes()).unwrap();
        let error = resume(&path).unwrap_err();
        assert!(error.contains("journal.jsonl:2: damaged: time of k is not finite"), "{error}");
    }

    /// Bytes changed, taken out, put in, doubled, and lines exchanged: what is accepted is what was written.
    #[test]
    fn of_a_journal_damaged_at_random_nothing_wrong_is_taken() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal.jsonl");
        let mut journal = Journal::create(&path, &header()).unwrap();
        let run = results::tests::example().runs.remove(0);
        let timed =
            |n: u32| Entry::Timed { key: run.key(), sample: Sample::new(f64::from(n) / 7.0, f64::from(n) / 3.0) };
        let written: Vec<Entry> = (0..9).map(timed).chain(entries()).collect();
        written.iter().for_each(|entry| journal.append(entry).unwrap());
        let sound = std::fs::read(&path).unwrap();
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        let mut random = |below: usize| rng.random_range(0..below.max(1));
        let mut refused = 0;
        for _ in 0..3000 {
            let mut bytes = sound.clone();
            for _ in 0..1 + random(3) {
                let place = random(bytes.len());
                match random(6) {
                    0 => bytes[place] ^= 1 << random(8),
                    1 => bytes[place] = b"\n0]\"[ "[random(6)],
                    2 => drop(bytes.remove(place)),
                    3 => bytes.insert(place, random(256) as u8),
                    4 => bytes.truncate(place.max(1)),
                    _ => {
                        let mut lines: Vec<&[u8]> = bytes.split_inclusive(|&byte| byte == b'\n').collect();
                        let (a, b) = (random(lines.len()), random(lines.len()));
                        if random(2) == 0 {
                            lines.swap(a, b);
                        } else {
                            lines.remove(a);
                        }
                        bytes = lines.concat();
                    }
                }
                if bytes.is_empty() {
                    break;
                }
            }
            std::fs::write(&path, &bytes).unwrap();
            match Journal::resume(&path, &header()) {
                Ok(Some((_, found))) => assert!(written.starts_with(&found), "{found:?}"),
                Ok(None) => {}
                Err(_) => refused += 1,
            }
        }
        assert!(refused > 1000, "{refused}");
    }
}
