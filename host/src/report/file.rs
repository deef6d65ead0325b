//! Files that are either the old one or the new one, never half of it.

use std::fmt;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A file that could not be written; the old one, if any, is untouched.
#[derive(Debug)]
pub struct WriteError {
    /// The file that was to be written.
    pub path: PathBuf,
    /// What the system said.
    pub source: io::Error,
}

impl fmt::Display for WriteError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let path = self.path.display();
        write!(formatter, "cannot write {path}: {}", self.source)?;
        match self.source.kind() {
            io::ErrorKind::NotFound => write!(formatter, "; create its directory first"),
            io::ErrorKind::PermissionDenied => {
                write!(formatter, "; choose a directory you may write to")
            }
            io::ErrorKind::IsADirectory => write!(formatter, "; name a file, not a directory"),
            io::ErrorKind::StorageFull => write!(formatter, "; free some space there"),
            _ => Ok(()),
        }
    }
}

impl std::error::Error for WriteError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.source)
    }
}

/// Writes `bytes` to `path` under a temporary name in the same directory and
/// renames it, so that a reader, or a run that is interrupted, never sees a
/// part of it. The directory must exist.
///
/// # Errors
/// [`WriteError`] with the path where the system refuses; nothing is left behind.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    write_and_rename(path, bytes).map_err(|source| WriteError {
        path: path.to_path_buf(),
        source,
    })
}

fn write_and_rename(path: &Path, bytes: &[u8]) -> io::Result<()> {
    // A bare file name has the empty path as its parent.
    let directory = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".isolux-");
    // Temporary files are private to their owner by default; a result has the
    // permissions of any new file (the umask still applies).
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(directory)?;
    file.write_all(bytes)?;
    file.flush()?;
    file.persist(path)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_whole_and_nothing_else_is_left() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("table.txt");
        write_file(&path, b"first").unwrap();
        write_file(&path, b"2nd").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"2nd");
        assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_refusal_names_the_file_and_the_remedy() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("missing").join("table.txt");
        let message = write_file(&path, b"").unwrap_err().to_string();
        assert!(message.contains("table.txt"), "{message}");
        assert!(message.contains("create its directory"), "{message}");

        // A directory of that name stays, and no temporary file with it.
        let taken = directory.path().join("taken");
        std::fs::create_dir(&taken).unwrap();
        assert!(write_file(&taken, b"x").is_err());
        assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn a_result_has_the_permissions_of_any_new_file() {
        use std::os::unix::fs::PermissionsExt;
        let directory = tempfile::tempdir().unwrap();
        let ours = directory.path().join("ours");
        let plain = directory.path().join("plain");
        write_file(&ours, b"x").unwrap();
        std::fs::write(&plain, b"x").unwrap();
        let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }
}
