//! Writing files so that nothing half-written is ever seen.

use crate::HarnessError;
use halfshade_scene::InputFile;
use std::{fs, io::Write, path::Path};
use tempfile::{Builder, NamedTempFile};

/// Prefix of temporary files.
const TEMPORARY: &str = ".halfshade-";

/// Writes `bytes` to `path`: to a temporary file beside it, flushed to the disk, then renamed. On any error the old
/// file, if there was one, is untouched. A link stays, and what it leads to is written. What exists and is no plain file
/// (a terminal, a pipe) is written to directly.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), HarnessError> {
    let fail = |source| HarnessError::io(path, "write", source);
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let old = fs::metadata(&target);
    if old.as_ref().is_ok_and(|metadata| !metadata.is_file()) {
        return fs::OpenOptions::new().write(true).open(path).and_then(|mut file| file.write_all(bytes)).map_err(fail);
    }
    let mut file = temporary(folder_of(&target)).map_err(fail)?;
    file.write_all(bytes).and_then(|()| file.as_file().sync_all()).map_err(fail)?;
    if let Ok(old) = old {
        file.as_file().set_permissions(old.permissions()).map_err(fail)?;
    }
    file.persist(target).map_err(|error| fail(error.error))?;
    Ok(())
}

/// A file in `folder` that goes away unless it is renamed, open to whom files made there are open to.
fn temporary(folder: &Path) -> std::io::Result<NamedTempFile> {
    open_to_others(Builder::new().prefix(TEMPORARY), folder)
}

/// The same under a name that no file has yet.
pub(crate) fn temporary_called(name: &str, folder: &Path) -> std::io::Result<NamedTempFile> {
    open_to_others(Builder::new().prefix(name).rand_bytes(0), folder)
}

fn open_to_others(builder: &mut Builder<'_, '_>, folder: &Path) -> std::io::Result<NamedTempFile> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // As far as the user's mask lets it.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Makes `folder` and proves that files can be written there, before hours of work are spent. The proof has no name, so
/// that nothing of it stays.
pub fn prepare_folder(folder: &Path) -> Result<(), HarnessError> {
    fs::create_dir_all(folder).map_err(|source| HarnessError::io(folder, "create this folder", source))?;
    let probe = || -> std::io::Result<()> {
        let mut file = tempfile::tempfile_in(folder)?;
        // A full disk shows itself only when blocks are really allocated.
        file.write_all(&[0x5a; 1 << 16])?;
        file.sync_all()
    };
    probe().map_err(|source| HarnessError::io(folder, "write into this folder", source))
}

/// Writes files, by path within it, into a new folder: all of them, or none and no folder. One that exists and isn't
/// empty is refused.
pub fn write_folder(folder: &Path, files: &[(String, Vec<u8>)]) -> Result<(), HarnessError> {
    check_new_folder(folder)?;
    let fail = |source| HarnessError::io(folder, "write this folder", source);
    let target = fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned());
    let mut builder = Builder::new();
    builder.prefix(TEMPORARY);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // As far as the user's mask lets it.
        builder.permissions(fs::Permissions::from_mode(0o777));
    }
    let temporary = builder.tempdir_in(folder_of(&target)).map_err(fail)?;
    let write = |(name, bytes): &(String, Vec<u8>)| -> std::io::Result<()> {
        let path = temporary.path().join(name);
        fs::create_dir_all(folder_of(&path))?;
        let mut file = fs::File::create_new(path)?;
        file.write_all(bytes)?;
        file.sync_all()
    };
    files.iter().try_for_each(write).map_err(fail)?;
    if target.is_dir() {
        // Only if it is still empty.
        fs::remove_dir(&target).map_err(fail)?;
    }
    fs::rename(temporary.path(), &target).map_err(fail)?;
    // Moved away: nothing is left to remove.
    let _ = temporary.keep();
    Ok(())
}

/// Refuses a folder that [`write_folder`] can't write later, before work is spent on its content.
pub fn check_new_folder(folder: &Path) -> Result<(), HarnessError> {
    match fs::read_dir(folder).map(|mut entries| entries.next().is_none()) {
        Ok(true) => {}
        Ok(false) => return Err(HarnessError::in_file(folder, "is there already and not empty; give a new folder")),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound && fs::symlink_metadata(folder).is_err() => {}
        Err(source) => return Err(HarnessError::io(folder, "write this folder", source)),
    }
    let target = fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned());
    let fail = |source| HarnessError::io(folder, "write this folder", source);
    Builder::new().prefix(TEMPORARY).tempdir_in(folder_of(&target)).map(drop).map_err(fail)
}

/// Checks that `path` can be written later, before work is spent on its content. True if that replaces a file.
pub fn check_writable(path: &Path) -> Result<bool, HarnessError> {
    let fail = |source| HarnessError::io(path, "write", source);
    match (fs::symlink_metadata(path), fs::metadata(path)) {
        (Ok(_), Ok(metadata)) if metadata.is_dir() => {
            return Err(HarnessError::in_file(path, "is a folder; give a file name"));
        }
        (Ok(_), Ok(metadata)) if !metadata.is_file() => return Ok(false),
        (Ok(_), Err(_)) => return Err(HarnessError::in_file(path, "is a link that leads nowhere; remove it")),
        // Also a name that is too long, which a temporary file wouldn't show.
        (Err(error), _) if error.kind() != std::io::ErrorKind::NotFound => return Err(fail(error)),
        _ => {}
    }
    let target = fs::canonicalize(path);
    let folder = folder_of(target.as_deref().unwrap_or(path));
    temporary(folder).map_err(fail)?;
    Ok(target.is_ok())
}

/// Refuses to write to `path` if that is one of the files that were read.
pub fn check_no_input(path: &Path, inputs: &[InputFile]) -> Result<(), HarnessError> {
    let Ok(target) = fs::canonicalize(path) else { return Ok(()) };
    if inputs.iter().any(|input| fs::canonicalize(&input.path).is_ok_and(|input| input == target)) {
        return Err(HarnessError::in_file(path, "is read as input and would be lost; give another file name"));
    }
    Ok(())
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
        assert!(check_writable(&path).unwrap() && !check_writable(&folder.path().join("b.json")).unwrap());
        let input = InputFile { path: folder.path().join("./a.json"), blake3: String::new() };
        assert!(check_no_input(&path, &[input]).unwrap_err().to_string().contains("read as input"));
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_permissions_kept() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let [file, link, nowhere] = ["file", "link", "nowhere"].map(|name| folder.path().join(name));
        fs::write(&file, "first").unwrap();
        fs::set_permissions(&file, fs::Permissions::from_mode(0o600)).unwrap();
        symlink("file", &link).unwrap();
        symlink("nothing", &nowhere).unwrap();
        assert!(check_writable(&link).unwrap());
        write_atomically(&link, b"second").unwrap();
        assert!(link.is_symlink());
        assert_eq!(fs::read(&file).unwrap(), b"second");
        assert_eq!(fs::metadata(&file).unwrap().permissions().mode() & 0o777, 0o600);
        assert!(check_writable(&nowhere).unwrap_err().to_string().contains("leads nowhere"));
        assert!(check_writable(&folder.path().join("n".repeat(300))).is_err());
    }

    #[test]
    fn a_folder_is_written_whole_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let files = |names: &[&str]| names.iter().map(|name| ((*name).to_owned(), b"x".to_vec())).collect::<Vec<_>>();
        let (new, empty, used) = (folder.path().join("new"), folder.path().join("empty"), folder.path().join("used"));
        fs::create_dir(&empty).unwrap();
        for place in [&new, &empty] {
            write_folder(place, &files(&["a", "b/c", "b/d"])).unwrap();
            assert_eq!(fs::read(place.join("b/d")).unwrap(), b"x");
            let error = write_folder(place, &files(&["e"])).unwrap_err().to_string();
            assert!(error.contains("not empty") && !place.join("e").exists(), "{error}");
        }
        // A file can't lie in another.
        assert!(write_folder(&used, &files(&["a", "a/b"])).is_err());
        assert!(check_new_folder(&new.join("a")).is_err() && check_new_folder(&used.join("b/c")).is_err());
        check_new_folder(&used).unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
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
