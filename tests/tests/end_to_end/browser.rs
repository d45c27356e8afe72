//! The page that a run writes, used in Chromium: on a desk and on a phone, dark and light.

use crate::common::{folder, halfshade, skipped, stdout, write};
use std::{fs, path::Path, process::Command};

const EXPERIMENT: &str = "name = \"small\"\nclaim = \"The page can be used.\"\nreceivers = [\"pixels\"]\n[truth]\nsamples = 16\n\
    [timing]\nwarm_up = 0\nrepeats = 1\n[pictures]\nresolution = [32, 24]\n\
    [[scene]]\nname = \"one-sphere\"\nresolution = [32, 24]\n[[scene]]\nname = \"five-blockers\"\nresolution = [32, 24]\n\
    [[strategy]]\nname = \"unshadowed\"\n[[strategy]]\nname = \"sh-exp\"\n[[strategy]]\nname = \"mask\"\ndirections = [16, 64]\n";

/// The program, by its name where it is installed.
fn chromium() -> Option<&'static str> {
    let is_there =
        |name: &&str| Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success());
    let found = ["chromium", "chromium-browser", "google-chrome"].into_iter().find(is_there);
    if found.is_none() {
        skipped("there is no chromium (apt install chromium)");
    }
    found
}

/// The report of the page `used.html` of a folder on itself where it is so wide, after `browser.js` has used it.
fn told(program: &str, here: &Path, width: u32, is_dark: bool) -> String {
    let profile = folder();
    // No window is as narrow as a phone.
    let around = format!(
        "<script>onmessage = told => document.body.append(Object.assign(document.createElement(\"pre\"), {{ textContent: told.data }}))\
         </script>\n<iframe src=\"used.html\" width=\"{width}\" height=\"800\" style=\"border: 0\"></iframe>\n"
    );
    write(here, "around.html", around);
    let dump = || {
        let output = Command::new(program)
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--virtual-time-budget=60000"])
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .arg(format!("--blink-settings=preferredColorScheme={}", u8::from(!is_dark)))
            .args(["--window-size=1500,900", "--dump-dom", &format!("file://{}/around.html", here.display())])
            .output();
        String::from_utf8_lossy(&output.expect("chromium runs").stdout).into_owned()
    };
    let told = |dumped: String| Some(dumped.split_once("<pre>")?.1.split_once("</pre>")?.0.to_owned());
    // Virtual time doesn't wait for pictures that are being decoded: one page in ten has told nothing when it ends.
    (0..10).find_map(|_| told(dump())).expect("what the page tells")
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
        let told = told(program, here.path(), width, is_dark);
        assert_eq!(told, format!("{width} wide, 7 tables, 2 plots, 2 viewers"), "dark: {is_dark}");
    }
}
