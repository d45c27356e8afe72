//! The list of all that runs wrote into a folder, by content.

use super::checks::{ELSEWHERE, is_absent};
use crate::HarnessError;
use halfshade_scene::text;
use serde::{Deserialize, Serialize};
use std::{collections::HashMap, fs, path::Path};

/// The first line of the list of what was written.
pub(super) const SCHEMA: &str = "halfshade.written/1";

/// Hashes of all contents that files were given, by path below the folder, with `/`.
#[derive(Debug, Default)]
pub(super) struct WrittenFiles(HashMap<String, Vec<String>>);

/// A line of the list.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Line {
    pub(super) path: String,
    pub(super) blake3: String,
}

/// Content of the place where a file is to be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    Free,
    /// A file that a run wrote.
    Ours,
    /// Anything else.
    Foreign,
}

impl WrittenFiles {
    pub(super) fn load(path: &Path) -> Result<Self, HarnessError> {
        let bytes = match fs::read(path) {
            Ok(bytes) => bytes,
            Err(error) if is_absent(&error) => return Ok(Self::default()),
            Err(source) => return Err(HarnessError::io(path, "read", source)),
        };
        if bytes.is_empty() {
            return Ok(Self::default());
        }
        let text = text::decode(&bytes).map_err(|error| error.in_file(path))?;
        let mut lines = text.lines();
        if lines.next() != Some(SCHEMA) {
            let problem = "not the list of files that this version writes; move it away: what earlier runs wrote is then \
                           taken for somebody else's";
            return Err(HarnessError::in_file(path, problem));
        }
        let mut written = Self::default();
        // A line that was damaged or cut off only makes a file look like somebody else's.
        lines.filter_map(|line| serde_json::from_str(line).ok()).for_each(|line: Line| written.note(&line));
        Ok(written)
    }

    /// Whether a file was given content with this hash.
    pub(super) fn knows(&self, blake3: &str) -> bool {
        self.0.values().flatten().any(|known| known == blake3)
    }

    pub(super) fn note(&mut self, line: &Line) {
        let hashes = self.0.entry(line.path.clone()).or_default();
        if !hashes.contains(&line.blake3) {
            hashes.push(line.blake3.clone());
        }
    }

    /// Looks up what lies at `file` below `folder`.
    pub(super) fn place(&self, folder: &Path, file: &Path) -> Result<Place, HarnessError> {
        let path = folder.join(file);
        // Folders on the way, which may be links.
        let above = file.ancestors().skip(1).map(|above| folder.join(above));
        for above in above {
            match (fs::symlink_metadata(&above), fs::metadata(&above)) {
                (Ok(_), Ok(metadata)) if metadata.is_dir() => {}
                (Ok(_), _) => {
                    let problem = format!("a folder is needed here, and this is none; {ELSEWHERE}");
                    return Err(HarnessError::in_file(&above, problem));
                }
                (Err(error), _) if is_absent(&error) => {}
                (Err(source), _) => return Err(HarnessError::io(&above, "read", source)),
            }
        }
        match fs::symlink_metadata(&path) {
            Ok(_) => {}
            Err(error) if is_absent(&error) => return Ok(Place::Free),
            Err(source) => return Err(HarnessError::io(&path, "write", source)),
        }
        // Also of a link that leads nowhere it isn't known where it should lead.
        let Some(hashes) = self.0.get(&name(file)).filter(|_| path.is_file()) else { return Ok(Place::Foreign) };
        let bytes = fs::read(&path).map_err(|source| HarnessError::io(&path, "read", source))?;
        let is_ours = hashes.contains(&blake3::hash(&bytes).to_hex().to_string());
        Ok(if is_ours { Place::Ours } else { Place::Foreign })
    }
}

/// A path below the folder, the same on every system.
pub(super) fn name(file: &Path) -> String {
    file.iter().map(|part| part.to_string_lossy()).collect::<Vec<_>>().join("/")
}
