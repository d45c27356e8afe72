//! What people read: a page of tables, plots and pictures, from stored results.

use crate::{
    HarnessError, Results, file_names, plot,
    table::{self, Format, Table},
};
use std::path::{Path, PathBuf};

/// Where the numbers come from, in one line.
pub fn provenance(results: &Results) -> String {
    format!(
        "halfshade {}: experiment {}{}, {} threads of {}, {}",
        results.revision,
        results.experiment,
        if results.quick { " (quick: not for publication)" } else { "" },
        results.machine.threads,
        results.machine.cpu,
        results.machine.os
    )
}

/// All tables, scene by scene.
pub fn tables(results: &Results) -> Vec<Table> {
    table::groups(results)
        .iter()
        .flat_map(|(scene, frame, receivers)| {
            let first = table::scene_table(results, scene, *frame, receivers);
            std::iter::once(first).chain(further_tables(results, scene, *frame, receivers))
        })
        .collect()
}

/// Those that follow the first of a scene, as far as there is anything to tell.
fn further_tables(results: &Results, scene: &str, frame: usize, receivers: &str) -> impl Iterator<Item = Table> {
    let by_class = table::error_by_class(results, scene, frame, receivers);
    let split = table::error_split(results, scene, frame, receivers);
    let differences = table::differences(results, scene, frame, receivers);
    let details = table::details(results, scene, frame, receivers);
    [by_class, split, differences, details].into_iter().flatten()
}

/// Writes bytes to a path below the results.
pub type Write<'a> = dyn FnMut(&Path, &[u8]) -> Result<(), HarnessError> + 'a;

/// Writes `results.json`, `results.csv`, the plots and `report.md`.
pub fn write_all(results: &Results, write: &mut Write<'_>) -> Result<(), HarnessError> {
    write(Path::new("results.json"), results.to_json()?.as_bytes())?;
    write(Path::new("results.csv"), table::results_csv(results).as_bytes())?;
    write_plots(results, write)?;
    write(Path::new("report.md"), report(results, Format::Markdown).as_bytes())
}

/// Draws the plots of `results`, into `plots`.
pub fn write_plots(results: &Results, write: &mut Write<'_>) -> Result<(), HarnessError> {
    for (scene, frame, receivers) in table::groups(results) {
        let Some(plot) = plot::error_against_time(results, &scene, frame, &receivers) else { continue };
        let path = PathBuf::from(file_names::plot(&scene, frame, &receivers));
        let (svg, png) = plot.map_err(|problem| HarnessError::in_file(&path, format!("cannot be drawn: {problem}")))?;
        write(&path.with_added_extension("svg"), svg.as_bytes())?;
        write(&path.with_added_extension("png"), &png)?;
    }
    Ok(())
}

/// The page in `format`: for CSV every number of every run, for LaTeX the tables, else tables, plots and pictures.
pub fn report(results: &Results, format: Format) -> String {
    let provenance = provenance(results);
    match format {
        Format::Csv => table::results_csv(results),
        Format::Latex => tables(results).iter().map(|table| table.write(format, &provenance) + "\n").collect(),
        Format::Markdown => {
            let escape = table::markdown::escape;
            let [name, claim, provenance] = [&results.experiment, &results.claim, &provenance].map(|text| escape(text));
            let mut page = format!("# {name}\n\n{claim}\n\n{provenance}.\n");
            for (scene, frame, receivers) in table::groups(results) {
                page += &format!("\n## {}, frame {frame}, {receivers}\n\n", escape(&scene));
                page += &table::scene_table(results, &scene, frame, &receivers).write(format, &provenance);
                if plot::error_against_time(results, &scene, frame, &receivers).is_some() {
                    page += &format!("\n![error against time]({}.svg)\n", file_names::plot(&scene, frame, &receivers));
                }
                for table in further_tables(results, &scene, frame, &receivers) {
                    page += &format!("\n{}", table.write(format, &provenance));
                }
                page += &pictures_markdown(results, &scene, frame);
            }
            page
        }
        Format::Html => {
            let escape = table::html::escape;
            let mut page = format!(
                "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{0}</title>\n<style>{STYLE}</style>\n\
                 </head>\n<body>\n<h1>{0}</h1>\n<p>{1}</p>\n<p>{2}.</p>\n",
                escape(&results.experiment),
                escape(&results.claim),
                escape(&provenance)
            );
            for (scene, frame, receivers) in table::groups(results) {
                page += &format!("<h2>{}, frame {frame}, {receivers}</h2>\n", escape(&scene));
                page += &table::scene_table(results, &scene, frame, &receivers).write(format, &provenance);
                if let Some(Ok((svg, _))) = plot::error_against_time(results, &scene, frame, &receivers) {
                    page += &svg;
                }
                for table in further_tables(results, &scene, frame, &receivers) {
                    page += &table.write(format, &provenance);
                }
                page += "<div class=\"pictures\">\n";
                for files in results.pictures.iter().filter(|files| files.scene == scene && files.frame == frame) {
                    let error =
                        files.error_png.as_ref().map(|path| format!("<img src=\"{}\" alt=\"error\">", escape(path)));
                    page += &format!(
                        "<figure><img src=\"{}\" alt=\"{1}\">{2}<figcaption>{1}</figcaption></figure>\n",
                        escape(&files.png),
                        escape(&files.label),
                        error.unwrap_or_default()
                    );
                }
                page += "</div>\n";
            }
            page + "</body>\n</html>\n"
        }
    }
}

fn pictures_markdown(results: &Results, scene: &str, frame: usize) -> String {
    let files: Vec<_> = results.pictures.iter().filter(|f| f.scene == scene && f.frame == frame).collect();
    if files.is_empty() {
        return String::new();
    }
    let mut text =
        String::from("\n| strategy | picture | error (blue: too dark, vermilion: too bright) |\n| --- | --- | --- |\n");
    for files in files {
        let error = files.error_png.as_ref().map(|path| format!("![error]({path})")).unwrap_or_default();
        text += &format!("| {0} | ![{0}]({1}) | {error} |\n", table::markdown::escape(&files.label), files.png);
    }
    let scale = crate::picture_colors::FULL_SCALE;
    text + &format!(
        "\nFull colour is an error of {scale} of the mean unshadowed radiance. The EXR files beside the pictures hold the \
         result, `truth` and `error` as layers.\n"
    )
}

const STYLE: &str = "body{font:16px/1.5 sans-serif;max-width:72rem;margin:2rem auto;padding:0 1rem;color:#222}\
table{border-collapse:collapse;font-size:14px}th,td{padding:.2rem .6rem;border-bottom:1px solid #ddd;text-align:left}\
td.number{text-align:right;font-variant-numeric:tabular-nums}.pictures{display:flex;flex-wrap:wrap;gap:1rem}\
figure{margin:0}figure img{max-width:22rem;display:block}";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::tests::example;

    #[test]
    fn hostile_names_are_shown_and_not_obeyed() {
        let mut results = example();
        let name = crate::table::tests::HOSTILE;
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
            exposure: 1.0,
        }];
        let markdown = report(&results, Format::Markdown);
        let shown = table::markdown::escape(name);
        assert!(markdown.contains(&format!("\n## {shown}, frame 0, vertices\n")), "{markdown}");
        assert!(markdown.contains(&format!("| {shown} | ![{shown}](a.png) |")), "{markdown}");
        let html = report(&results, Format::Html);
        assert!(!html.contains("<i>") && html.contains("&lt;i&gt;f"), "{html}");
        assert!(!report(&results, Format::Latex).contains("<i>"));
        let csv = report(&results, Format::Csv);
        let record = csv::Reader::from_reader(csv.as_bytes()).records().next().unwrap().unwrap();
        assert_eq!(&record[0], name);
    }

    #[test]
    fn everything_is_written_and_can_be_written_again_from_what_is_stored() {
        let folder = tempfile::tempdir().unwrap();
        let mut write = |file: &Path, bytes: &[u8]| {
            std::fs::create_dir_all(folder.path().join(file).parent().unwrap()).unwrap();
            crate::output::write_atomically(&folder.path().join(file), bytes)
        };
        write_all(&example(), &mut write).unwrap();
        for name in ["results.json", "results.csv", "report.md"] {
            assert!(folder.path().join(name).exists(), "{name}");
        }
        let stored = Results::load(folder.path()).unwrap();
        let page = report(&stored, Format::Markdown);
        assert_eq!(page, std::fs::read_to_string(folder.path().join("report.md")).unwrap());
        let plot = page.split("](").nth(1).unwrap().split(')').next().unwrap();
        assert!(folder.path().join(plot).exists(), "{plot}");
        assert!(report(&stored, Format::Latex).starts_with("% halfshade 0.1.0: experiment example"));
        assert!(report(&stored, Format::Html).ends_with("</html>\n"));
        assert_eq!(report(&stored, Format::Csv).lines().count(), 4);
    }
}
