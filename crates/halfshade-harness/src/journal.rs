//! The journal of a run in progress: one line of JSON per fact, flushed at once, so that interruption loses nothing
//! that was measured.
//!
//! The first line says what is being run. An interrupted write leaves a last line without its end: it is cut off when
//! the journal is opened again. Damage anywhere else is refused.

use crate::{
    HarnessError,
    image_metrics::Similarity,
    results::{PictureFiles, Run, Sample},
};
use serde::{Deserialize, Serialize};
use std::{
    fs::{File, OpenOptions},
    io::{Seek, SeekFrom, Write},
    path::{Path, PathBuf},
};

/// What is being run; a journal can only be continued by the same.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    /// `halfshade.journal/1`.
    pub schema: String,
    /// Hash of the experiment file.
    pub experiment_hash: String,
    /// Whether with `--quick`.
    pub quick: bool,
    /// Threads: times on other counts are other times.
    pub threads: usize,
    /// Version and commit of the program.
    pub revision: String,
}

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

/// A journal open for appending.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    length: u64,
}

impl Journal {
    /// Starts a new journal at `path`. One that is already there is set aside as `*.old`.
    pub fn create(path: &Path, header: &Header) -> Result<Self, HarnessError> {
        let fail = |source| HarnessError::io(path, "write", source);
        if path.exists() {
            std::fs::rename(path, path.with_extension("jsonl.old")).map_err(fail)?;
        }
        let file = OpenOptions::new().create_new(true).append(true).open(path).map_err(fail)?;
        let mut journal = Self { path: path.to_owned(), file, length: 0 };
        journal.append_line(header)?;
        Ok(journal)
    }

    /// Opens the journal at `path` to go on, and returns what it holds.
    pub fn resume(path: &Path, header: &Header) -> Result<(Self, Vec<Entry>), HarnessError> {
        let bytes = std::fs::read(path).map_err(|source| HarnessError::io(path, "read", source))?;
        let whole = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |last| last + 1);
        let text = std::str::from_utf8(&bytes[..whole])
            .map_err(|_| HarnessError::in_file(path, "damaged: not text; delete it to start again"))?;
        let damaged = |line: usize, error: serde_json::Error| {
            HarnessError::at_line(path, line + 1, format!("damaged: {error}; delete the file to start again"))
        };
        let mut lines = text.lines().enumerate();
        let (_, first) = lines.next().ok_or_else(|| {
            HarnessError::in_file(path, "holds nothing to resume; run without --resume to start again")
        })?;
        let found: Header = serde_json::from_str(first).map_err(|error| damaged(0, error))?;
        if found != *header {
            let what = if found.experiment_hash != header.experiment_hash {
                "the experiment file has changed since"
            } else if found.quick != header.quick {
                "it was started with another --quick"
            } else if found.threads != header.threads {
                "it was started with another number of threads"
            } else {
                "it was started by another version of the program"
            };
            return Err(HarnessError::in_file(
                path,
                format!("cannot resume: {what}; run without --resume to start again"),
            ));
        }
        let mut entries = Vec::new();
        for (number, line) in lines {
            entries.push(serde_json::from_str(line).map_err(|error| damaged(number, error))?);
        }
        let fail = |source| HarnessError::io(path, "write", source);
        let mut file = OpenOptions::new().write(true).open(path).map_err(fail)?;
        file.set_len(whole as u64).and_then(|()| file.seek(SeekFrom::End(0)).map(drop)).map_err(fail)?;
        Ok((Self { path: path.to_owned(), file, length: whole as u64 }, entries))
    }

    /// Adds one fact.
    pub fn append(&mut self, entry: &Entry) -> Result<(), HarnessError> {
        self.append_line(entry)
    }

    fn append_line(&mut self, value: &impl Serialize) -> Result<(), HarnessError> {
        let mut line = serde_json::to_vec(value)
            .map_err(|error| HarnessError::in_file(&self.path, format!("cannot be written as JSON: {error}")))?;
        line.push(b'\n');
        if let Err(source) = self.file.write_all(&line) {
            // What was written before stays whole; the error of this cut, if any, is the one already reported.
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

    fn header() -> Header {
        Header {
            schema: "halfshade.journal/1".into(),
            experiment_hash: "ab".into(),
            quick: false,
            threads: 2,
            revision: "1".into(),
        }
    }

    fn entries() -> Vec<Entry> {
        let run = results::tests::example().runs.remove(0);
        let sample = Sample { prepare_secs: 0.001, shade_secs: 0.1 + 0.2 };
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
        let (journal, found) = Journal::resume(&path, &header()).unwrap();
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
            let (mut journal, found) = Journal::resume(&path, &header()).unwrap();
            assert_eq!(found, entries()[..whole]);
            journal.append(&entries()[0]).unwrap();
            let (_, found) = Journal::resume(&path, &header()).unwrap();
            assert_eq!(found.last(), entries().first());
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
        let error = Journal::resume(&path, &header()).unwrap_err().to_string();
        assert!(error.contains("journal.jsonl:2: damaged"), "{error}");
        std::fs::write(&path, text).unwrap();
        let other = Header { experiment_hash: "cd".into(), ..header() };
        assert!(Journal::resume(&path, &other).unwrap_err().to_string().contains("experiment file has changed"));
        let other = Header { threads: 1, ..header() };
        assert!(Journal::resume(&path, &other).unwrap_err().to_string().contains("threads"));
        Journal::create(&path, &header()).unwrap();
        assert!(folder.path().join("journal.jsonl.old").exists());
    }
}
