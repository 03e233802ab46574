//! Files that are written whole or not at all, alone or together.

use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use crate::DatabaseError;

/// Writes `bytes` to `path`: into a hidden temporary file of the same directory, flushed to the disk, then renamed.
///
/// A reader sees the old file or the new one, never a part; a crash leaves at most a hidden `.tmp` file behind.
///
/// # Errors
/// [`DatabaseError::Io`] when the directory cannot be written.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), DatabaseError> {
    let directory = parent(path);
    let mut builder = hidden();
    #[cfg(unix)]
    builder.permissions(readable(0o666));
    let mut file = builder
        .tempfile_in(directory)
        .map_err(DatabaseError::io("create a file in", directory))?;
    file.write_all(bytes).map_err(DatabaseError::io("write", path))?;
    file.as_file().sync_all().map_err(DatabaseError::io("write", path))?;
    file.persist(path)
        .map_err(|e| DatabaseError::io("write", path)(e.error))?;
    sync(directory)
}

/// Files and folders that are written together: each is written into a hidden folder next to its target, and
/// [`Staging::finish`] renames all of them. An unfinished staging leaves nothing behind.
///
/// Links are followed. A device or a pipe cannot be renamed over: it receives the content of the file.
#[derive(Debug, Default)]
pub struct Staging {
    staged: Vec<Staged>,
}

#[derive(Debug)]
struct Staged {
    /// Removes its remaining content when it is dropped.
    _hidden: TempDir,
    place: PathBuf,
    target: PathBuf,
}

impl Staging {
    /// The path at which to write the file, or create the folder, that is meant for `target`. It has the target's name.
    ///
    /// Folders that lead to the target need not exist. The content of a folder is added to that of a folder which is
    /// there, and replaces files of the same names.
    ///
    /// # Errors
    /// [`DatabaseError::Io`] when the folder of the target cannot be written.
    pub fn place(&mut self, target: &Path) -> Result<PathBuf, DatabaseError> {
        // The paths `.` and `..` have no name.
        let name = target
            .file_name()
            .or_else(|| target.is_dir().then_some("folder".as_ref()));
        let name = name.ok_or_else(|| DatabaseError::io("write", target)(ErrorKind::InvalidFilename.into()))?;
        let followed = followed(target);
        let beside = if is_special(target) {
            std::env::temp_dir()
        } else if followed.is_dir() {
            followed.clone()
        } else {
            existing(parent(&followed)).to_path_buf()
        };
        let mut builder = hidden();
        #[cfg(unix)]
        builder.permissions(readable(0o777));
        let hidden = builder
            .tempdir_in(&beside)
            .map_err(DatabaseError::io("create a folder in", &beside))?;
        let place = hidden.path().join(name);
        self.staged.push(Staged {
            _hidden: hidden,
            place: place.clone(),
            target: if is_special(target) {
                target.to_path_buf()
            } else {
                followed
            },
        });
        Ok(place)
    }

    /// The files that [`Staging::finish`] makes or replaces.
    ///
    /// # Errors
    /// [`DatabaseError::Io`] for a file that was not written.
    pub fn targets(&self) -> Result<Vec<PathBuf>, DatabaseError> {
        Ok(self.files()?.into_iter().map(|(_, target)| target).collect())
    }

    /// Flushes all files to the disk and moves them to their targets.
    ///
    /// # Errors
    /// [`DatabaseError::Io`] for a file that was not written, for a file where a folder is or the other way round, and
    /// for errors of the system. Nothing is renamed unless all files are on the disk.
    pub fn finish(self) -> Result<(), DatabaseError> {
        let files = self.files()?;
        for (place, target) in &files {
            let there = std::fs::OpenOptions::new().write(true).open(place);
            there
                .and_then(|file| file.sync_all())
                .map_err(DatabaseError::io("write", target))?;
            if target.is_dir() {
                return Err(DatabaseError::io("write", target)(ErrorKind::IsADirectory.into()));
            }
        }
        let (special, ordinary): (Vec<_>, Vec<_>) = self.staged.iter().partition(|staged| is_special(&staged.target));
        for Staged { place, target, .. } in special {
            let bytes = std::fs::read(place).map_err(DatabaseError::io("read", place))?;
            std::fs::write(target, bytes).map_err(DatabaseError::io("write", target))?;
        }
        for Staged { place, target, .. } in ordinary {
            let directory = parent(target);
            std::fs::create_dir_all(directory).map_err(DatabaseError::io("create", directory))?;
            relocate(place, target)?;
        }
        Ok(())
    }

    /// All files, and where they are to be.
    fn files(&self) -> Result<Vec<(PathBuf, PathBuf)>, DatabaseError> {
        let mut files = Vec::new();
        for Staged { place, target, .. } in &self.staged {
            walk(place, target, &mut files)?;
        }
        Ok(files)
    }
}

/// Collects the files at `place` and in it, with where they are to be.
fn walk(place: &Path, target: &Path, files: &mut Vec<(PathBuf, PathBuf)>) -> Result<(), DatabaseError> {
    if !place.is_dir() {
        files.push((place.to_path_buf(), target.to_path_buf()));
        return Ok(());
    }
    if target.exists() && !target.is_dir() {
        return Err(DatabaseError::io("create", target)(ErrorKind::NotADirectory.into()));
    }
    for name in names(place)? {
        walk(&place.join(&name), &target.join(&name), files)?;
    }
    Ok(())
}

/// Renames, entry by entry where both are folders.
fn relocate(place: &Path, target: &Path) -> Result<(), DatabaseError> {
    if !(place.is_dir() && target.is_dir()) {
        std::fs::rename(place, target).map_err(DatabaseError::io("write", target))?;
        return sync(parent(target));
    }
    for name in names(place)? {
        relocate(&place.join(&name), &target.join(&name))?;
    }
    Ok(())
}

/// The names of a folder's entries, in order.
fn names(folder: &Path) -> Result<Vec<std::ffi::OsString>, DatabaseError> {
    let entries = std::fs::read_dir(folder).map_err(DatabaseError::io("read", folder))?;
    let names = entries.map(|entry| Ok(entry?.file_name()));
    let mut names: Vec<_> = names
        .collect::<std::io::Result<_>>()
        .map_err(DatabaseError::io("read", folder))?;
    names.sort();
    Ok(names)
}

/// Whether a path is there, and neither a file nor a folder: a device, a pipe.
fn is_special(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir())
}

/// The absolute path without links and without `.` and `..`, as far as it is there. Two paths of one file or folder
/// agree in it, also when that is yet to be made.
#[must_use]
pub fn followed(path: &Path) -> PathBuf {
    let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    let follow = |there: &Path| {
        let canonical = there.canonicalize().ok()?;
        // Joining an empty rest would end the path with a separator.
        let rest = absolute.strip_prefix(there).ok()?;
        Some(if rest.as_os_str().is_empty() {
            canonical
        } else {
            canonical.join(rest)
        })
    };
    absolute
        .ancestors()
        .find_map(follow)
        .unwrap_or_else(|| absolute.clone())
}

/// The folder of a file.
fn parent(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// The nearest folder that is there, from `folder` upwards.
fn existing(folder: &Path) -> &Path {
    folder
        .ancestors()
        .find(|ancestor| ancestor.exists())
        .unwrap_or(Path::new("."))
}

fn hidden() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".tmp");
    builder
}

/// Temporary files are private by default; a result gets the permissions of the user's umask.
#[cfg(unix)]
fn readable(mode: u32) -> std::fs::Permissions {
    std::os::unix::fs::PermissionsExt::from_mode(mode)
}

/// Flushes the renamed entries of `directory` to the disk.
fn sync(directory: &Path) -> Result<(), DatabaseError> {
    if cfg!(unix) {
        File::open(directory)
            .and_then(|d| d.sync_all())
            .map_err(DatabaseError::io("write", directory))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicBool, Ordering};

    #[test]
    fn a_reader_never_sees_a_part() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("file");
        write(&path, &[0; 100_000]).unwrap();
        let done = AtomicBool::new(false);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                for k in 1..=50u8 {
                    write(&path, &vec![k; 100_000]).unwrap();
                }
                done.store(true, Ordering::Release);
            });
            while !done.load(Ordering::Acquire) {
                let bytes = std::fs::read(&path).unwrap();
                assert_eq!(bytes.len(), 100_000);
                assert!(bytes.iter().all(|b| *b == bytes[0]));
            }
        });
        assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_missing_directory_is_named() {
        let error = write(Path::new("/nonexistent/directory/file"), &[1]).unwrap_err();
        assert!(error.to_string().contains("/nonexistent/directory"), "{error}");
    }

    /// Every file below a folder with its content, in order.
    fn content(folder: &Path) -> Vec<(String, String)> {
        let mut files = Vec::new();
        walk(folder, Path::new(""), &mut files).unwrap();
        let text =
            |(place, name): (PathBuf, PathBuf)| (name.display().to_string(), std::fs::read_to_string(place).unwrap());
        files.into_iter().map(text).collect()
    }

    fn listed(files: &[(&str, &str)]) -> Vec<(String, String)> {
        let owned = |(name, text): &(&str, &str)| ((*name).to_owned(), (*text).to_owned());
        files.iter().map(owned).collect()
    }

    /// A file, a new folder in a new folder, and a folder that is there, all staged.
    fn staged(root: &Path) -> Staging {
        std::fs::create_dir_all(root.join("old/inner")).unwrap();
        for file in ["table", "old/replaced", "old/kept", "old/inner/kept"] {
            std::fs::write(root.join(file), "old").unwrap();
        }
        let mut staging = Staging::default();
        std::fs::write(staging.place(&root.join("table")).unwrap(), "new").unwrap();
        let folder = staging.place(&root.join("deep/folder")).unwrap();
        std::fs::create_dir(&folder).unwrap();
        std::fs::write(folder.join("file"), "new").unwrap();
        let folder = staging.place(&root.join("old")).unwrap();
        std::fs::create_dir_all(folder.join("inner")).unwrap();
        for file in ["replaced", "inner/added"] {
            std::fs::write(folder.join(file), "new").unwrap();
        }
        staging
    }

    #[test]
    fn outputs_appear_together_and_folders_are_added_to() {
        let root = tempfile::tempdir().unwrap();
        staged(root.path()).finish().unwrap();
        let expected = [
            ("deep/folder/file", "new"),
            ("old/inner/added", "new"),
            ("old/inner/kept", "old"),
            ("old/kept", "old"),
            ("old/replaced", "new"),
            ("table", "new"),
        ];
        assert_eq!(content(root.path()), listed(&expected));
    }

    #[test]
    fn what_is_not_finished_leaves_nothing() {
        let root = tempfile::tempdir().unwrap();
        let before = [
            ("old/inner/kept", "old"),
            ("old/kept", "old"),
            ("old/replaced", "old"),
            ("table", "old"),
        ];
        drop(staged(root.path()));
        assert_eq!(content(root.path()), listed(&before));
        // A file is meant for a folder's place, and another was never written.
        for target in ["old", "absent"] {
            let mut staging = staged(root.path());
            let place = staging.place(&root.path().join(target)).unwrap();
            if target == "old" {
                std::fs::write(place, "a file").unwrap();
            }
            let error = staging.finish().unwrap_err().to_string();
            assert!(error.contains(target), "{error}");
            assert_eq!(content(root.path()), listed(&before));
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_devices_stay() {
        let root = tempfile::tempdir().unwrap();
        let at = |name: &str| root.path().join(name);
        std::fs::write(at("file"), "old").unwrap();
        std::os::unix::fs::symlink(at("file"), at("link")).unwrap();
        let mut staging = Staging::default();
        std::fs::write(staging.place(&at("link")).unwrap(), "new").unwrap();
        std::fs::write(staging.place(Path::new("/dev/null")).unwrap(), "new").unwrap();
        staging.finish().unwrap();
        assert!(at("link").is_symlink());
        assert_eq!(std::fs::read_to_string(at("file")).unwrap(), "new");
        assert!(is_special(Path::new("/dev/null")));
    }
}
