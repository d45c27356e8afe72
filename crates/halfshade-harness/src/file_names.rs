//! Names of files after scenes, strategies and their parameters.
//!
//! A name of lower-case letters, digits, `-` and `_` is a file name as it stands. Any other keeps what can be read of it
//! and gains `--` and a hash of the whole, so that two names never become one file: neither where case is ignored or
//! Unicode is normalized, nor where a name was cut or is one that Windows reserves.

/// Bytes of a name that are kept at most.
const LONGEST: usize = 80;

/// Before the hash; no name with it is kept as it stands.
const MARK: &str = "--";

/// Digits of the hash: one name in 2^64 is another's twin.
const DIGITS: usize = 16;

/// The picture of what is called `label` at a frame of a scene: its path below the results, without an ending.
pub fn picture(scene: &str, frame: usize, label: &str) -> String {
    format!("pictures/{}/{}", file_name(&format!("{scene}-{frame:04}")), file_name(label))
}

/// The plot of a scene's errors against time: its path below the results, without an ending.
pub fn plot(scene: &str, frame: usize, receivers: &str) -> String {
    format!("plots/{}", file_name(&format!("error-time-{scene}-{frame:04}-{receivers}")))
}

/// The plot of what stages contribute to errors: its path below the results, without an ending.
pub fn plot_of_stages(scene: &str, frame: usize, receivers: &str) -> String {
    format!("plots/{}", file_name(&format!("stages-{scene}-{frame:04}-{receivers}")))
}

/// The plot of a scene's errors and times over frames: its path below the results, without an ending.
pub fn plot_over_frames(scene: &str, receivers: &str) -> String {
    format!("plots/{}", file_name(&format!("over-frames-{scene}-{receivers}")))
}

/// The file name, without an ending, of what is called `name`: at most 98 ASCII bytes, without a dot.
pub fn file_name(name: &str) -> String {
    let is_plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || matches!(c, '-' | '_');
    let begins_well = name.starts_with(|c: char| c.is_ascii_alphanumeric());
    if begins_well && name.len() <= LONGEST && !name.contains(MARK) && name.chars().all(is_plain) && !is_reserved(name)
    {
        return name.to_owned();
    }
    let mut readable = String::new();
    for c in name.chars() {
        match c {
            'a'..='z' | 'A'..='Z' | '0'..='9' => readable.push(c),
            '-' if !readable.is_empty() && !readable.ends_with('-') => readable.push(c),
            _ if !readable.ends_with('_') => readable.push('_'),
            _ => {}
        }
        if readable.len() == LONGEST {
            break;
        }
    }
    let readable = match readable.trim_end_matches('-') {
        "" => "_",
        readable => readable,
    };
    format!("{readable}{MARK}{}", &blake3::hash(name.as_bytes()).to_hex()[..DIGITS])
}

/// Whether `name`, which somebody chose, can be a folder's name everywhere as it stands.
pub fn is_folder_name(name: &str) -> bool {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    let lower = name.to_ascii_lowercase();
    // Windows looks at what stands before the first dot.
    let device = lower.split('.').next().unwrap_or_default();
    (1..=LONGEST).contains(&name.len())
        && name.chars().all(is_plain)
        && !name.starts_with(['.', '-'])
        && !name.ends_with('.')
        && !is_reserved(device)
}

/// Whether Windows takes the lower-case `name` for a device.
fn is_reserved(name: &str) -> bool {
    let numbered = |device: &str| name.strip_prefix(device).is_some_and(|rest| rest.len() == 1);
    matches!(name, "con" | "prn" | "aux" | "nul") || numbered("com") || numbered("lpt")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    #[test]
    fn plain_names_stay_and_others_can_still_be_read() {
        for name in ["vases", "squirrel-and-balls-0030", "my_scene", "7", "console", "com10", "lpt"] {
            assert_eq!(file_name(name), name);
        }
        assert!(file_name("toy:mode=a/b,n=2").starts_with("toy_mode_a_b_n_2--"));
        assert!(file_name("Vase").starts_with("Vase--"));
    }

    #[test]
    fn different_names_are_different_files_on_every_file_system() {
        let long = |end: &str| "a".repeat(259) + end;
        let names = [
            "", " ", ".", "..", "a", "A", "a.", "a ", " a", "a.error", "a/b", "a\\b", "a_b", "a:b", "a--b", "a-b",
            "-a", "_a", "__a", "vase", "Vase", "VASE", "con", "CON", "nul", "com1", "lpt9", "nul.txt", "東京", "大阪",
            "é", "e\u{301}", "ß", "ss", "a\0b", "a\nb", "~", "$HOME", "%20", "a,1", "a,2", "İ", "i\u{307}", "K",
            "\u{212a}",
        ];
        let mut seen: HashMap<String, String> = HashMap::new();
        let names = names.map(str::to_owned).into_iter().chain([long(""), long("b"), long("c"), "é".repeat(130)]);
        // A name's file name is itself a name, of another file.
        let names: Vec<String> = names.flat_map(|name| [file_name(&name), name]).collect();
        for name in names {
            let file = file_name(&name);
            assert!(file.len() <= LONGEST + MARK.len() + DIGITS && file.is_ascii(), "{name:?}: {file}");
            assert!(!file.contains(['.', '/', '\\', ':', ' ', '~', '%', '$']) && !file.starts_with('-'), "{file}");
            assert!(!is_reserved(&file.to_lowercase()), "{name:?}: {file}");
            if let Some(other) = seen.insert(file.to_lowercase(), name.clone()) {
                assert_eq!(other, name, "both are {file}");
            }
        }
    }
}
