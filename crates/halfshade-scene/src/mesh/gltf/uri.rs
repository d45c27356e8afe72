//! Content of the URIs of a document: files beside it, or data within it.

use crate::SceneError;
use ::gltf::buffer::{Data, Source};
use std::path::Path;

/// A URI as messages call it.
pub(super) fn label(uri: &str) -> String {
    if uri.starts_with("data:") { "a data URI".to_owned() } else { format!("`{uri}`") }
}

/// The bytes that a URI stands for; the problem of an error doesn't name it.
pub(super) fn bytes(uri: &str, folder: &Path) -> Result<Vec<u8>, SceneError> {
    if uri.starts_with("data:") {
        return data(uri, folder);
    }
    let name = match uri.split_once(':') {
        Some(("file", path)) => path.strip_prefix("//").unwrap_or(path),
        // One letter is a drive.
        Some((scheme, _))
            if scheme.len() > 1 && scheme.bytes().all(|b| b.is_ascii_alphanumeric() || b"+-.".contains(&b)) =>
        {
            return Err(SceneError::new(format!("`{scheme}:` is not fetched"))
                .with_remedy("put the file beside the .gltf file and name it there"));
        }
        _ => uri,
    };
    let path = folder.join(decoded(name)?);
    crate::input::read(&path).map_err(|error| {
        SceneError::new(format!("{}: {error}", path.display()))
            .with_remedy("put the file there, or export everything into one .glb")
    })
}

/// Content of a data URI. The crate fills up to a multiple of four bytes, which is undone.
fn data(uri: &str, folder: &Path) -> Result<Vec<u8>, SceneError> {
    let Some((_, digits)) = uri.split_once(";base64,") else {
        return Err(SceneError::new("it is not base64").with_remedy("export again with files beside the .gltf file"));
    };
    let Data(mut bytes) = Data::from_source(Source::Uri(uri), Some(folder))
        .map_err(|error| SceneError::new(error.to_string()).with_remedy("the data was damaged: export it again"))?;
    bytes.truncate(digits.trim_end_matches('=').len() * 6 / 8);
    Ok(bytes)
}

/// A file name without percent escapes, which must spell UTF-8.
fn decoded(name: &str) -> Result<String, SceneError> {
    let bytes = name.as_bytes();
    let mut decoded = Vec::with_capacity(bytes.len());
    let mut i = 0;
    while let Some(&byte) = bytes.get(i) {
        let escaped =
            (byte == b'%').then(|| name.get(i + 1..i + 3)).flatten().and_then(|hex| u8::from_str_radix(hex, 16).ok());
        decoded.push(escaped.unwrap_or(byte));
        i += if escaped.is_some() { 3 } else { 1 };
    }
    String::from_utf8(decoded).map_err(|_| {
        SceneError::new(format!("the file name `{name}` is not UTF-8"))
            .with_remedy("rename the file, in the document too")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escapes_spell_utf8() {
        assert!(decoded("a%20b%FF.bin").is_err());
        assert_eq!(decoded("a%20b%C3%A4%.bin").unwrap(), "a bä%.bin");
    }

    #[test]
    fn data_is_as_long_as_its_digits_say() {
        for (digits, length) in [("", 0), ("AA==", 1), ("AAA=", 2), ("AAAA", 3), ("AAAAAA==", 4), ("AAAAAAA=", 5)] {
            let bytes = bytes(&format!("data:application/octet-stream;base64,{digits}"), Path::new("")).unwrap();
            assert_eq!(bytes, vec![0; length], "{digits}");
        }
        let problem = |uri| bytes(uri, Path::new("")).unwrap_err().to_string();
        assert!(problem("data:application/octet-stream;base64,A*AA").contains("export it again"));
        assert!(problem("data:,%00%00").contains("not base64"));
        assert!(problem("https://example.org/x.bin").contains("`https:` is not fetched"));
    }
}
