//! Writing of the files of figures and of the page of all figures.

use crate::index::html;
use crate::{Outcome, ReproduceError, ReproducedFigure, Target, display_path};
use std::path::{Path, PathBuf};

/// Creates the folders and checks that they are writable.
pub(crate) fn check(target: &Target) -> Result<(), ReproduceError> {
    let mut folders = vec![target.folder.clone()];
    folders.extend(target.markdown.as_deref().and_then(Path::parent).map(Path::to_owned));
    for folder in folders.iter().filter(|f| !f.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(|e| failed(folder, e))?;
        let probe = folder.join(".adwave-probe.tmp");
        std::fs::write(&probe, b"")
            .and_then(|()| std::fs::remove_file(&probe))
            .map_err(|e| failed(folder, e))?;
    }
    match target.markdown.as_deref().filter(|path| path.is_dir()) {
        Some(path) => Err(failed(path, "it is a folder; name a file".to_owned())),
        None => Ok(()),
    }
}

/// Writes the files of one figure, and returns their paths.
pub(crate) fn figure(root: &Path, folder: &str, outcome: &Outcome) -> Result<Vec<PathBuf>, ReproduceError> {
    let folder = root.join(folder);
    std::fs::create_dir_all(&folder).map_err(|e| failed(&folder, e))?;
    let mut files = Vec::new();
    for picture in &outcome.pictures {
        files.push(folder.join(&picture.name));
        bytes(&folder.join(&picture.name), &picture.bytes)?;
    }
    for table in &outcome.tables {
        files.push(folder.join(&table.name));
        bytes(&folder.join(&table.name), table.csv().as_bytes())?;
    }
    Ok(files)
}

/// Replaces a file atomically.
pub(crate) fn bytes(path: &Path, content: &[u8]) -> Result<(), ReproduceError> {
    adwave_io::atomic_write(path, |out| Ok(out.write_all(content)?)).map_err(|e| failed(path, e))
}

pub(crate) fn failed(path: &Path, source: impl Into<crate::FigureError>) -> ReproduceError {
    ReproduceError::Write { path: display_path(path), source: source.into() }
}

/// Writes `index.html`.
pub(crate) fn index(root: &Path, made: &[ReproducedFigure]) -> Result<(), ReproduceError> {
    bytes(&root.join("index.html"), html(made).as_bytes())
}
