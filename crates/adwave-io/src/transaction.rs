//! Several files that take their places together.

use crate::WriteError;
use crate::files::atomic::{PREFIX, SUFFIX, check_replaceable, keep_owner, resolve, with_temporaries};
use std::fs::{self, OpenOptions};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Files that are put in their places when all of them are written: if one fails (a full disk) every old file is as it
/// was, and no new one is there. Dropped without [`commit`](Self::commit), it leaves nothing.
///
/// ```
/// use adwave_io::{Transaction, atomic_write};
/// let folder = tempfile::tempdir().unwrap();
/// let path = folder.path().join("a.txt");
/// let files = Transaction::new();
/// files.write(&path, |staged| atomic_write(staged, |w| Ok(w.write_all(b"whole")?))).unwrap();
/// assert!(!path.exists());
/// files.commit().unwrap();
/// assert_eq!(std::fs::read(&path).unwrap(), b"whole");
/// ```
#[derive(Debug, Default)]
pub struct Transaction {
    /// Files that wait for [`commit`](Self::commit); `None` if each file takes its place at once.
    staged: Option<Mutex<Vec<StagedFile>>>,
}

/// A complete file on the disk, in a folder of its own beside its final place.
#[derive(Debug)]
struct StagedFile {
    _folder: TemporaryFolder,
    staged: PathBuf,
    target: PathBuf,
    /// The name that the caller gave.
    path: PathBuf,
}

/// A folder that is deleted with all that is in it.
#[derive(Debug)]
struct TemporaryFolder(PathBuf);

impl Drop for TemporaryFolder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
        with_temporaries(|paths| paths.remove(&self.0));
    }
}

impl Transaction {
    /// A transaction without files.
    pub fn new() -> Self {
        Self { staged: Some(Mutex::default()) }
    }

    /// A transaction whose files take their places one by one, as soon as each is written.
    pub fn immediate() -> Self {
        Self { staged: None }
    }

    /// Writes one file by `write`, which gets the path to write to. Its name is that of `path`; a pipe or a device is
    /// written directly.
    ///
    /// # Errors
    /// The folder is missing, the old file may not be replaced, or the error of `write`; each with the name of `path`.
    pub fn write<T>(
        &self,
        path: &Path,
        write: impl FnOnce(&Path) -> Result<T, WriteError>,
    ) -> Result<T, WriteError> {
        self.write_with(path, |staged| write(staged).map_err(|e| e.about_file(path)))
    }

    /// [`write`](Self::write) for other errors, which are passed on as they are.
    ///
    /// # Errors
    /// As [`write`](Self::write); the error of `write` may name the staged file.
    pub fn write_with<T, E: From<WriteError>>(
        &self,
        path: &Path,
        write: impl FnOnce(&Path) -> Result<T, E>,
    ) -> Result<T, E> {
        let Some(all) = &self.staged else { return write(path) };
        let Some(file) = StagedFile::begin(path).map_err(|e| e.in_file(path))? else { return write(path) };
        let result = write(&file.staged)?;
        all.lock().unwrap_or_else(PoisonError::into_inner).push(file);
        Ok(result)
    }

    /// Size in bytes of a file that was written, also before it is in its place; `None` for a path that is no regular
    /// file.
    pub fn size(&self, path: &Path) -> Option<u64> {
        let staged = self.staged.as_ref().and_then(|all| {
            let all = all.lock().unwrap_or_else(PoisonError::into_inner);
            all.iter().rev().find(|file| file.path == path).map(|file| file.staged.clone())
        });
        let found = fs::metadata(staged.as_deref().unwrap_or(path)).ok()?;
        found.is_file().then_some(found.len())
    }

    /// Puts the files in their places, in the order in which they were written.
    ///
    /// # Errors
    /// A file cannot be renamed; those before it are in their places then.
    pub fn commit(self) -> Result<(), WriteError> {
        let staged = self.staged.map(|all| all.into_inner().unwrap_or_else(PoisonError::into_inner));
        for file in staged.into_iter().flatten() {
            file.put_in_place().map_err(|e| e.in_file(&file.path))?;
        }
        Ok(())
    }
}

impl StagedFile {
    /// Makes the folder; `None` for a path that is no regular file.
    fn begin(path: &Path) -> Result<Option<Self>, WriteError> {
        let target = resolve(path)?;
        let old = fs::metadata(&target).ok();
        if old.as_ref().is_some_and(|m| !m.is_file()) {
            return Ok(None);
        }
        let folder = check_replaceable(&target, old.is_some())?;
        let folder = tempfile::Builder::new().prefix(PREFIX).suffix(SUFFIX).tempdir_in(folder)?.keep();
        with_temporaries(|paths| paths.insert(folder.clone()));
        let staged = folder.join(path.file_name().unwrap_or_default());
        Ok(Some(Self { _folder: TemporaryFolder(folder), staged, target, path: path.to_path_buf() }))
    }

    fn put_in_place(&self) -> Result<(), WriteError> {
        if let Ok(old) = fs::metadata(&self.target) {
            let file = OpenOptions::new().write(true).open(&self.staged)?;
            keep_owner(&file, &old);
            file.set_permissions(old.permissions())?;
        }
        Ok(fs::rename(&self.staged, &self.target)?)
    }
}

impl WriteError {
    /// This error about another file, such as the one that a staged file will replace.
    #[must_use]
    pub fn about_file(self, path: &Path) -> Self {
        match self {
            Self::InFile { source, .. } => source.about_file(path),
            other => other.in_file(path),
        }
    }
}
