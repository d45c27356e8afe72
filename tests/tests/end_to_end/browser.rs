//! The page that a run writes, used in Chromium: on a desk and on a phone, dark and light.

use crate::common::{folder, halfshade, stdout, write};
use std::{fs, path::Path, process::Command};

const EXPERIMENT: &str = "name = \"small\"\nreceivers = [\"pixels\"]\n[truth]\nsamples = 16\n[pictures]\nresolution = [32, 24]\n\
    [[scene]]\nname = \"one-sphere\"\n[[scene]]\nname = \"two-lamps\"\n\
    [[strategy]]\nname = \"unshadowed\"\n[[strategy]]\nname = \"sh-exp\"\n[[strategy]]\nname = \"mask\"\ndirections = [16, 64]\n";

/// The program, by its name where it is installed.
#[expect(clippy::print_stderr, reason = "whoever reads the test's output should know that it tested nothing")]
fn chromium() -> Option<&'static str> {
    let is_there =
        |name: &&str| Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success());
    let found = ["chromium", "chromium-browser", "google-chrome"].into_iter().find(is_there);
    if found.is_none() {
        eprintln!("skipped: there is no chromium (apt install chromium)");
    }
    found
}

/// What the page tells of itself in a window so wide, after `browser.js` has used it.
fn told(program: &str, page: &Path, width: u32, is_dark: bool) -> String {
    let profile = folder();
    let output = Command::new(program)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--virtual-time-budget=60000"])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg(format!("--blink-settings=preferredColorScheme={}", u8::from(!is_dark)))
        .args([&format!("--window-size={width},900"), "--dump-dom", &format!("file://{}", page.display())])
        .output()
        .expect("chromium runs");
    let page = String::from_utf8_lossy(&output.stdout);
    let told = page.split_once("<pre id=\"faults\">").and_then(|(_, rest)| rest.split_once("</pre>"));
    told.unwrap_or_else(|| panic!("the page tells nothing: {}", String::from_utf8_lossy(&output.stderr))).0.to_owned()
}

#[test]
fn the_page_works_by_mouse_and_keyboard_on_desks_and_phones() {
    let Some(program) = chromium() else { return };
    let here = folder();
    write(here.path(), "small.toml", EXPERIMENT);
    stdout(halfshade(here.path()).args(["run", "small.toml", "--out", "out"]));
    let page = fs::read_to_string(here.path().join("out/report.html")).unwrap();
    // Without a network: nothing is loaded from anywhere.
    assert!(!["src=\"http", "url(http", "@import", "<link"].iter().any(|outside| page.contains(outside)));
    let used = page.replace("</body>", &format!("<script>\n{}</script>\n</body>", include_str!("browser.js")));
    write(here.path(), "used.html", used);
    for (width, is_dark) in [(1400, false), (1400, true), (360, false), (360, true)] {
        let told = told(program, &here.path().join("used.html"), width, is_dark);
        let (faults, counts) = told.trim_end().rsplit_once('\n').expect("two lines");
        assert!(faults.is_empty(), "{width} wide, dark: {is_dark}\n{told}");
        assert!(counts.ends_with("2 viewers"), "{counts}");
    }
}
