//! Reports as text and as files.

use super::{
    contents::{data, page},
    format::Format,
    html::Read,
};
use crate::{HarnessError, Results};
use std::path::{Path, PathBuf};

/// Writes bytes to a path below the results.
pub type Write<'a> = dyn FnMut(&Path, &[u8]) -> Result<(), HarnessError> + 'a;

/// The page in `format`, for HTML with the pictures that `read` finds: for CSV every number of every run, for LaTeX the tables, else tables, plots and pictures.
pub fn report(results: &Results, format: Format, read: &Read<'_>) -> String {
    match format {
        Format::Csv => data(results).write(format, read),
        Format::Markdown | Format::Latex | Format::Html | Format::Text => page(results).write(format, read),
    }
}

/// Writes `results.json`, `results.csv`, the plots, `report.md`, and `report.html` with the pictures that `read` finds. A part of
/// an experiment has nothing to show before it is joined with the others: only its results are written.
pub fn write_all(results: &Results, write: &mut Write<'_>, read: &Read<'_>) -> Result<(), HarnessError> {
    write(Path::new("results.json"), results.to_json()?.as_bytes())?;
    if results.part.is_some() {
        return Ok(());
    }
    write(Path::new("results.csv"), report(results, Format::Csv, read).as_bytes())?;
    write_plots(results, write)?;
    write(Path::new("report.html"), report(results, Format::Html, read).as_bytes())?;
    write(Path::new("report.md"), report(results, Format::Markdown, read).as_bytes())
}

/// Files that [`write_all`] writes.
pub fn files_written(results: &Results) -> Vec<PathBuf> {
    let pages = ["results.json", "results.csv", "report.html", "report.md"].map(PathBuf::from);
    let page = page(results);
    let plots = page.plots().flat_map(|plot| ["svg", "png"].map(|it| Path::new(&plot.file).with_added_extension(it)));
    pages.into_iter().chain(plots).collect()
}

/// Draws the plots of `results`, into `plots`.
pub fn write_plots(results: &Results, write: &mut Write<'_>) -> Result<(), HarnessError> {
    for plot in page(results).plots() {
        let path = Path::new(&plot.file);
        let fail = |problem: String| HarnessError::in_file(path, format!("cannot be drawn: {problem}"));
        let (svg, png) = (plot.svg().map_err(fail)?, plot.png().map_err(fail)?);
        write(&path.with_added_extension("svg"), svg.as_bytes())?;
        write(&path.with_added_extension("png"), &png)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::tests::example;

    #[test]
    fn hostile_names_are_shown_and_not_obeyed() {
        let mut results = example();
        let name = super::super::format::tests::HOSTILE;
        results.runs.iter_mut().for_each(|run| run.scene = name.into());
        results.scenes[0].name = name.into();
        results.differences.iter_mut().for_each(|it| (it.scene, it.first) = (name.into(), name.into()));
        results.pictures = vec![crate::results::PictureFiles {
            scene: name.into(),
            frame: 0,
            label: name.into(),
            exr: "a.exr".into(),
            png: "a.png".into(),
            error_png: None,
            flip_png: None,
            exposure: 1.0,
        }];
        let markdown = report(&results, Format::Markdown, &|_| None);
        let shown = super::super::markdown::escape(name);
        assert!(markdown.contains(&format!("\n## {shown}, frame 0, vertices\n")), "{markdown}");
        assert!(markdown.contains(&format!("| {shown} | ![{shown}](a.png) |")), "{markdown}");
        let html = report(&results, Format::Html, &|_| None);
        assert!(!html.contains("<i>") && html.contains("&lt;i&gt;f"), "{html}");
        assert!(!report(&results, Format::Latex, &|_| None).contains("<i>"));
        let csv = report(&results, Format::Csv, &|_| None);
        let record = ::csv::Reader::from_reader(csv.as_bytes()).records().next().unwrap().unwrap();
        assert_eq!(&record[0], name);
    }

    #[test]
    fn everything_is_written_and_can_be_written_again_from_what_is_stored() {
        let folder = tempfile::tempdir().unwrap();
        let mut write = |file: &Path, bytes: &[u8]| {
            std::fs::create_dir_all(folder.path().join(file).parent().unwrap()).unwrap();
            crate::output::write_atomically(&folder.path().join(file), bytes)
        };
        write_all(&example(), &mut write, &|_| None).unwrap();
        for name in ["results.json", "results.csv", "report.md", "report.html"] {
            assert!(folder.path().join(name).exists(), "{name}");
        }
        let stored = Results::load(folder.path()).unwrap();
        let page = report(&stored, Format::Markdown, &|_| None);
        assert_eq!(page, std::fs::read_to_string(folder.path().join("report.md")).unwrap());
        let plot = page.split("](").nth(1).unwrap().split(')').next().unwrap();
        assert!(folder.path().join(plot).exists(), "{plot}");
        assert!(report(&stored, Format::Latex, &|_| None).starts_with("% halfshade 0.1.0: experiment example"));
        assert!(report(&stored, Format::Html, &|_| None).ends_with("</html>\n"));
        assert_eq!(report(&stored, Format::Csv, &|_| None).lines().count(), 4);
    }
}
