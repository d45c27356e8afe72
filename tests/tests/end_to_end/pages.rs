//! Pages of the repository, parts of which are made: figures by results, keys by declarations.

use std::{fs, path::PathBuf};

fn path(page: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..").join(page)
}

/// The text of a page.
pub(crate) fn read(page: &str) -> String {
    fs::read_to_string(path(page)).unwrap_or_else(|error| panic!("{page}: {error}"))
}

/// Holds the part of `page` behind the comment `mark` to `text`; writes it there if HALFSHADE_SPLICE is set.
pub(crate) fn splice(page: &str, mark: &str, text: &str) {
    let whole = read(page);
    let begin = format!("<!-- {mark} -->\n");
    let (before, rest) = whole.split_once(&begin).unwrap_or_else(|| panic!("{page} has no {begin}"));
    let (part, behind) = rest.split_once("<!-- end -->").expect("an end");
    if std::env::var_os("HALFSHADE_SPLICE").is_some() {
        fs::write(path(page), format!("{before}{begin}{text}<!-- end -->{behind}")).expect("written");
    } else {
        assert!(
            part == text,
            "{page}, {mark}: is no longer what it is made from; HALFSHADE_SPLICE=1 makes it anew:\n{text}"
        );
    }
}
