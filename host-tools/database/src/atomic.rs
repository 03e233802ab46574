//! Files that appear whole or not at all.

use std::fs::File;
use std::io::Write;
use std::path::Path;

use crate::DatabaseError;

/// Writes `bytes` to `path`: into a hidden temporary file of the same directory, flushed to the disk, then renamed.
///
/// A reader sees the old file or the new one, never a part; a crash leaves at most a hidden `.tmp` file behind.
///
/// # Errors
/// [`DatabaseError::Io`] when the directory cannot be written.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), DatabaseError> {
    let directory = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".tmp");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // A temporary file is private by default; a result is as readable as the user's umask lets it be.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = builder
        .tempfile_in(directory)
        .map_err(DatabaseError::io("create a file in", directory))?;
    file.write_all(bytes).map_err(DatabaseError::io("write", path))?;
    file.as_file().sync_all().map_err(DatabaseError::io("write", path))?;
    file.persist(path)
        .map_err(|e| DatabaseError::io("write", path)(e.error))?;
    sync(directory)
}

/// Brings what was renamed in `directory` onto the disk.
pub(crate) fn sync(directory: &Path) -> Result<(), DatabaseError> {
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
}
