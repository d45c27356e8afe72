//! Writing files so that nothing half-written is ever seen.

use crate::HarnessError;
use std::{fs, io::Write, path::Path};

/// Writes `bytes` to `path`: to a temporary file beside it, flushed to the disk, then renamed. On any error the old
/// file, if there was one, is untouched. What exists and is no plain file (a terminal, a pipe) is written to directly.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), HarnessError> {
    let fail = |source| HarnessError::io(path, "write", source);
    if fs::metadata(path).is_ok_and(|metadata| !metadata.is_file()) {
        return fs::OpenOptions::new().write(true).open(path).and_then(|mut file| file.write_all(bytes)).map_err(fail);
    }
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut file = tempfile::Builder::new().prefix(".halfshade-").tempfile_in(folder).map_err(fail)?;
    file.write_all(bytes).and_then(|()| file.as_file().sync_all()).map_err(fail)?;
    set_usual_permissions(file.path()).map_err(fail)?;
    file.persist(path).map_err(|error| fail(error.error))?;
    Ok(())
}

/// Temporary files are private; results are for everyone the folder is open to.
#[cfg(unix)]
fn set_usual_permissions(path: &Path) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    fs::set_permissions(path, fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn set_usual_permissions(_path: &Path) -> std::io::Result<()> {
    Ok(())
}

/// Makes `folder` and proves that files can be written there, before hours of work are spent.
pub fn prepare_folder(folder: &Path) -> Result<(), HarnessError> {
    fs::create_dir_all(folder).map_err(|source| HarnessError::io(folder, "create this folder", source))?;
    let probe = || -> std::io::Result<()> {
        let mut file = tempfile::Builder::new().prefix(".halfshade-").tempfile_in(folder)?;
        // A full disk shows itself only when blocks are really allocated.
        file.write_all(&[0x5a; 1 << 16])?;
        file.as_file().sync_all()
    };
    probe().map_err(|source| HarnessError::io(folder, "write into this folder", source))
}

/// Checks that `path` can be written later, before work is spent on its content.
pub fn check_writable(path: &Path) -> Result<(), HarnessError> {
    if let Ok(metadata) = fs::metadata(path) {
        if metadata.is_dir() {
            return Err(HarnessError::in_file(path, "is a folder; give a file name"));
        }
        if !metadata.is_file() {
            return Ok(());
        }
    }
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    tempfile::Builder::new()
        .prefix(".halfshade-")
        .tempfile_in(folder)
        .map(drop)
        .map_err(|source| HarnessError::io(path, "write", source))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replaces_whole_files_and_leaves_nothing_beside_them() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        write_atomically(&path, b"first").unwrap();
        write_atomically(&path, b"second").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"second");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, "x").unwrap();
        let error = prepare_folder(&file.join("out")).unwrap_err().to_string();
        assert!(error.contains("file/out") && error.contains("cannot create"), "{error}");
        assert!(check_writable(folder.path()).is_err());
        assert!(check_writable(&folder.path().join("missing/out.exr")).is_err());
    }
}
