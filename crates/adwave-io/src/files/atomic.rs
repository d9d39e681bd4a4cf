//! Atomic replacement of files: a reader sees either the old bytes or the new ones, never a part.

use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, TryLockError};
use std::time::Duration;

use adwave::{BackgroundWork, Progress};

use crate::WriteError;

/// Temporary files that exist now.
static TEMPORARIES: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

pub(crate) fn with_temporaries<T>(change: impl FnOnce(&mut BTreeSet<PathBuf>) -> T) -> T {
    change(&mut TEMPORARIES.lock().unwrap_or_else(std::sync::PoisonError::into_inner))
}

/// Prefix and suffix of the names of temporary files.
pub(crate) const PREFIX: &str = ".adwave-";
pub(crate) const SUFFIX: &str = ".tmp";

/// Deletes the temporary files of all writes in progress. A program calls it when it ends before they are complete,
/// for instance in its Ctrl-C handler; those writes then fail, and the files that they would replace stay unchanged.
///
/// It never blocks: if another thread is changing the list, perhaps the one that is ending here, the files remain and
/// the next run deletes them.
pub fn remove_temporaries() {
    const TRIES: u32 = 50;
    for _ in 0..TRIES {
        match TEMPORARIES.try_lock() {
            Ok(mut paths) => return std::mem::take(&mut *paths).into_iter().for_each(remove),
            Err(TryLockError::Poisoned(paths)) => {
                return std::mem::take(&mut *paths.into_inner()).into_iter().for_each(remove);
            }
            Err(TryLockError::WouldBlock) => std::thread::sleep(Duration::from_millis(1)),
        }
    }
}

fn remove(path: PathBuf) {
    let _ = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
}

/// Entry of [`TEMPORARIES`], removed when the file is renamed or deleted.
struct TemporaryEntry(PathBuf);

impl Drop for TemporaryEntry {
    fn drop(&mut self) {
        with_temporaries(|paths| paths.remove(&self.0));
    }
}

/// Size above which a file is flushed by a separate thread, so that the wait can be cancelled; a system call cannot.
const WAITED_FOR: u64 = 1 << 23;

/// Flushes the file to the disk and closes it.
fn flush_to_disk(file: File, progress: Progress<'_>) -> Result<(), WriteError> {
    progress.check()?;
    if file.metadata()?.len() < WAITED_FOR {
        return Ok(file.sync_all()?);
    }
    let flush = move || {
        let flushed = file.sync_all();
        drop(file);
        flushed
    };
    let failed = |why| WriteError::from(io::Error::other(why));
    let started = BackgroundWork::start(flush).ok_or_else(|| failed("no thread can be started"))?;
    let flushed = started.finish(progress)?;
    Ok(flushed.ok_or_else(|| failed("the thread that flushes the file ended early"))??)
}

/// Writes a file atomically: into a temporary file in the same folder, flushed to the disk and renamed. An existing
/// file keeps its permissions, and a symbolic link its target; pipes and devices such as `/dev/null` are written
/// directly. On an error the old file is unchanged and no temporary file remains.
///
/// ```
/// let folder = tempfile::tempdir().unwrap();
/// let path = folder.path().join("a.txt");
/// adwave_io::atomic_write(&path, |w| Ok(w.write_all(b"whole")?)).unwrap();
/// assert_eq!(std::fs::read(&path).unwrap(), b"whole");
/// ```
///
/// # Errors
/// The folder is missing, a system call fails, or `write` fails; each error has the file's name.
pub fn atomic_write<T>(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> Result<T, WriteError>,
) -> Result<T, WriteError> {
    atomic_write_with(path, Progress::none(), write)
}

/// [`atomic_write`](crate::atomic_write) that can also be cancelled while the file is flushed to the disk; `write`
/// has to check for cancellation itself.
///
/// # Errors
/// The errors of [`atomic_write`](crate::atomic_write), and [`WriteError::Cancelled`]; the old file is unchanged then
/// too.
pub fn atomic_write_with<T>(
    path: &Path,
    progress: Progress<'_>,
    write: impl FnOnce(&mut dyn Write) -> Result<T, WriteError>,
) -> Result<T, WriteError> {
    replace(path, progress, write).map_err(|e| e.in_file(path))
}

fn replace<T>(
    path: &Path,
    progress: Progress<'_>,
    write: impl FnOnce(&mut dyn Write) -> Result<T, WriteError>,
) -> Result<T, WriteError> {
    // The link stays and its target is replaced; a dangling link creates its target.
    let target = resolve(path)?;
    let old = fs::metadata(&target).ok();
    if old.as_ref().is_some_and(|m| !m.is_file()) {
        let file = OpenOptions::new().write(true).open(&target)?;
        let mut out = BufWriter::with_capacity(1 << 18, file);
        let result = write(&mut out)?;
        out.flush()?;
        return Ok(result);
    }
    let mut pending = PendingFile::create_temporary(target, old)?;
    let result = write(&mut pending.out)?;
    pending.finish(progress)?;
    Ok(result)
}

/// Folder of a file that is to be made or replaced; an error if it is missing, or if the file may not be written.
pub(crate) fn check_replaceable(target: &Path, exists: bool) -> Result<&Path, WriteError> {
    let folder = target.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        return Err(WriteError::NoFolder { folder: folder.display().to_string() });
    }
    clear(folder);
    // A file without write permission is not replaced either, though a rename could do so.
    if exists {
        OpenOptions::new().write(true).open(target)?;
    }
    Ok(folder)
}

/// File that is written beside the one it will replace; dropping it before [`finish`](Self::finish) deletes it.
pub(crate) struct PendingFile {
    pub(crate) out: BufWriter<File>,
    temporary: tempfile::TempPath,
    target: PathBuf,
    /// Metadata of the file to be replaced.
    old: Option<fs::Metadata>,
    listed: Option<TemporaryEntry>,
}

impl PendingFile {
    /// Creates a seekable file; a pipe or a device is an error.
    pub(crate) fn begin(path: &Path) -> Result<Self, WriteError> {
        let target = resolve(path)?;
        let old = fs::metadata(&target).ok();
        if old.as_ref().is_some_and(|m| !m.is_file()) {
            return Err(io::Error::other(
                "a regular file is needed here, because it is not written sequentially",
            )
            .into());
        }
        Self::create_temporary(target, old)
    }

    fn create_temporary(target: PathBuf, old: Option<fs::Metadata>) -> Result<Self, WriteError> {
        let folder = check_replaceable(&target, old.is_some())?;
        let mut listed = None;
        let temporary = tempfile::Builder::new().prefix(PREFIX).suffix(SUFFIX).make_in(folder, |path| {
            // Listed before it is created, so that none is missed, and with the default permissions of a new file.
            with_temporaries(|paths| paths.insert(path.to_path_buf()));
            let entry = TemporaryEntry(path.to_path_buf());
            let file = OpenOptions::new().write(true).create_new(true).open(path)?;
            listed = Some(entry);
            Ok(file)
        })?;
        let (file, temporary) = temporary.into_parts();
        let out = BufWriter::with_capacity(1 << 18, file);
        Ok(Self { out, temporary, target, old, listed })
    }

    /// Flushes the file to the disk and renames it to its final name.
    pub(crate) fn finish(mut self, progress: Progress<'_>) -> Result<(), WriteError> {
        self.out.flush()?;
        let file = self.out.into_inner().map_err(io::IntoInnerError::into_error)?;
        if let Some(old) = self.old {
            keep_owner(&file, &old);
            file.set_permissions(old.permissions())?;
        }
        flush_to_disk(file, progress)?;
        self.temporary.persist(&self.target).map_err(|e| e.error)?;
        drop(self.listed);
        Ok(())
    }
}

/// Age at which temporary files of a killed run are deleted.
const LEFT_OVER: Duration = Duration::from_secs(24 * 60 * 60);

/// Deletes temporary files that a killed run left in a folder, once per process.
fn clear(folder: &Path) {
    static CLEARED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    if !CLEARED.lock().unwrap_or_else(std::sync::PoisonError::into_inner).insert(folder.to_path_buf()) {
        return;
    }
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let is_ours = name.as_encoded_bytes().starts_with(PREFIX.as_bytes())
            && name.as_encoded_bytes().ends_with(SUFFIX.as_bytes());
        let age = || entry.metadata().ok()?.modified().ok()?.elapsed().ok();
        if is_ours && age().is_some_and(|age| age > LEFT_OVER) {
            remove(entry.path());
        }
    }
}

/// Keeps the owner of a file that root replaces.
#[cfg(unix)]
pub(crate) fn keep_owner(file: &File, old: &fs::Metadata) {
    use std::os::unix::fs::{MetadataExt, fchown};
    let is_other = file.metadata().is_ok_and(|new| (new.uid(), new.gid()) != (old.uid(), old.gid()));
    if is_other {
        // Other users cannot give files away; the new file belongs to them, like any file they write.
        let _ = fchown(file, Some(old.uid()), Some(old.gid()));
    }
}

#[cfg(not(unix))]
pub(crate) fn keep_owner(_: &File, _: &fs::Metadata) {}

/// Target of a chain of symbolic links; it need not exist.
pub(crate) fn resolve(path: &Path) -> io::Result<PathBuf> {
    const MAX_LINKS: usize = 40;
    let mut target = path.to_path_buf();
    for _ in 0..MAX_LINKS {
        if !fs::symlink_metadata(&target).is_ok_and(|m| m.is_symlink()) {
            return Ok(target);
        }
        let link = fs::read_link(&target)?;
        target = target.parent().map_or_else(|| link.clone(), |folder| folder.join(&link));
    }
    Err(io::Error::other("too many symbolic links"))
}
