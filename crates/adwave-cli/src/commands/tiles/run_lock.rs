//! A lock that keeps two runs out of one work folder.

use crate::error::CliError;
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};

/// Name of the file that is locked.
const NAME: &str = "run.lock";

/// The right to run a job in a work folder, which ends when it is dropped or when the process ends.
#[derive(Debug)]
pub(super) struct RunLock {
    path: PathBuf,
    /// The folder, if this run made it.
    made: Option<PathBuf>,
    file: File,
}

impl RunLock {
    /// Makes the folder if it is missing, and locks it.
    ///
    /// # Errors
    /// Another run has the lock, or the folder cannot be written.
    pub(super) fn acquire(folder: &Path, output: &Path) -> Result<Self, CliError> {
        let failed = |e: std::io::Error| CliError::Environment(format!("{}: {e}", folder.display()));
        let made = (!folder.exists()).then(|| folder.to_owned());
        std::fs::create_dir_all(folder).map_err(failed)?;
        let path = folder.join(NAME);
        let file = File::options().create(true).append(true).open(&path).map_err(failed)?;
        match file.try_lock() {
            Ok(()) => Ok(Self { path, made, file }),
            Err(TryLockError::WouldBlock) => Err(CliError::Environment(format!(
                "another run is at work on {}; wait until it ends, or name another output",
                output.display()
            ))),
            Err(TryLockError::Error(e)) => Err(failed(e)),
        }
    }
}

impl Drop for RunLock {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.path);
        let _ = self.file.unlock();
        // A folder with anything in it stays.
        if let Some(folder) = &self.made {
            let _ = std::fs::remove_dir(folder);
        }
    }
}
