//! Reads and writes `results.json`.

use super::{Results, Run, SCHEMA};
use crate::HarnessError;
use halfshade_scene::text;
use std::path::Path;

impl Results {
    /// Reads a `results.json`, or the one in a folder.
    pub fn load(path: &Path) -> Result<Self, HarnessError> {
        let path = if path.is_dir() { path.join("results.json") } else { path.to_owned() };
        let text = text::read(&path)?;
        let results: Self = serde_json::from_str(&text).map_err(|error| {
            let problem = format!("not results of Halfshade, or damaged: {error}; run the experiment again");
            HarnessError::at_line(&path, error.line().max(1), problem)
        })?;
        if results.schema != SCHEMA {
            let problem = format!("schema `{}`; this program reads `{SCHEMA}`", results.schema);
            return Err(HarnessError::in_file(&path, problem));
        }
        // Each number is finite, or JSON would not have it; a sum of two may not be.
        if let Some(place) = results.not_finite() {
            let problem = format!("damaged: {place} is not finite; run the experiment again");
            return Err(HarnessError::in_file(&path, problem));
        }
        if let Some(what) = results.runs.iter().find_map(Run::contradiction) {
            return Err(HarnessError::in_file(&path, format!("damaged: {what}; run the experiment again")));
        }
        Ok(results)
    }

    /// The results as JSON, with a line break at the end. Numbers that are not finite are refused: JSON would make them
    /// `null`.
    pub fn to_json(&self) -> Result<String, HarnessError> {
        let fail = |problem: String| HarnessError::input(format!("results cannot be written as JSON: {problem}"));
        if let Some(place) = self.not_finite() {
            return Err(fail(format!("{place} is not finite")));
        }
        let mut text = serde_json::to_string_pretty(self).map_err(|error| fail(error.to_string()))?;
        text.push('\n');
        Ok(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::tests::example;

    #[test]
    fn a_mark_is_no_text_and_other_encodings_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.json");
        let text = example().to_json().unwrap();
        std::fs::write(&path, [text::MARK, text.as_bytes()].concat()).unwrap();
        assert_eq!(Results::load(&path).unwrap(), example());
        let wide: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        std::fs::write(&path, wide).unwrap();
        let error = Results::load(&path).unwrap_err().to_string();
        assert!(error.contains("results.json") && error.contains("UTF-16") && error.contains("save it as UTF-8"));
    }

    #[test]
    fn damaged_or_foreign_files_are_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.json");
        let whole = example().to_json().unwrap();
        std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
        let error = Results::load(folder.path()).unwrap_err().to_string();
        assert!(error.contains("results.json:") && error.contains("damaged"), "{error}");
        std::fs::write(&path, whole.replace(SCHEMA, "halfshade.results/9")).unwrap();
        let error = Results::load(&path).unwrap_err().to_string();
        assert!(error.contains("halfshade.results/9") && error.contains(SCHEMA), "{error}");
        assert!(Results::load(&folder.path().join("none.json")).unwrap_err().to_string().contains("cannot be read"));
    }
}
