#![no_main]
//! Results, up to every page, table and plot that is made of them, and to a check against themselves.

use halfshade_fuzz::file;
use halfshade_harness::{
    Results, check,
    report::{self, Format},
};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(results) = Results::load(&file("results.json", bytes)) else { return };
    for format in [Format::Markdown, Format::Csv, Format::Latex, Format::Html, Format::Text] {
        let _ = report::report(&results, format, &|_| None);
    }
    let _ = report::write_plots(&results, &mut |_, _| Ok(()));
    let _ = check::compare(&results, &results);
    let text = results.to_json().expect("what was read can be written");
    let again = Results::load(&file("results.json", text.as_bytes())).expect("what was written can be read");
    assert_eq!(again.to_json().expect("JSON"), text);
});
