//! Storage of edits between sessions.

use crate::document::Document;
use crate::response::ApiError;
use adwave::LevelSpec;
use adwave_io::{Recipe, atomic_write, parse_recipe, recipe_to_text};
use serde::{Deserialize, Serialize};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};

/// File that stores the edit of one shape or grid, named after a hash of its path and its positions or values.
#[derive(Clone, Debug)]
pub(crate) struct Autosave {
    path: PathBuf,
}

/// Content of the file: the levels in the syntax of a recipe, and the edit.
#[derive(Serialize, Deserialize)]
struct AutosaveContent {
    levels: String,
    edit: Document,
}

impl Autosave {
    /// Derives the file for the edit of what was read from `path`, in `folder`; `None` without a folder or a path.
    /// `numbers` are the positions or values, which tell one content of the file from another.
    pub(crate) fn new(path: Option<&Path>, numbers: &[f64], folder: Option<&Path>) -> Option<Self> {
        let path = path?.canonicalize().ok()?;
        let mut hasher = DefaultHasher::new();
        path.hash(&mut hasher);
        for x in numbers {
            x.to_bits().hash(&mut hasher);
        }
        Some(Self { path: folder?.join(format!("{:016x}.json", hasher.finish())) })
    }

    /// Reads the edit of the last session; `None` if there is none or it cannot be read.
    pub(crate) fn read(&self) -> Option<(LevelSpec, Document)> {
        let content: AutosaveContent = serde_json::from_slice(&std::fs::read(&self.path).ok()?).ok()?;
        Some((parse_recipe(&content.levels).ok()?.levels, content.edit))
    }

    /// Folder of the files whose values were added to the shape.
    fn fields_folder(&self) -> PathBuf {
        self.path.with_extension("fields")
    }

    /// Lists the files whose values were added to the shape, by name.
    pub(crate) fn field_files(&self) -> Vec<PathBuf> {
        let entries = std::fs::read_dir(self.fields_folder()).into_iter().flatten().flatten();
        let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
        paths.sort();
        paths
    }

    /// Stores a file of values for the next session.
    pub(crate) fn write_field_file(&self, name: &str, content: &[u8]) -> Result<(), ApiError> {
        let write = || {
            create_private_folder(&self.fields_folder())?;
            let path = self.fields_folder().join(name);
            std::fs::write(&path, content)?;
            make_private(&path)
        };
        write().map_err(|e| {
            let message = "the field cannot be stored for the next session";
            ApiError::new(axum::http::StatusCode::INSUFFICIENT_STORAGE, format!("{message}: {e}"))
        })
    }

    /// Writes an edit atomically: the previous content remains until the new one is complete.
    pub(crate) fn write(&self, levels: &LevelSpec, edit: &Document) -> Result<(), ApiError> {
        let recipe = Recipe { levels: levels.clone(), ..Recipe::default() };
        let content = AutosaveContent { levels: recipe_to_text(&recipe), edit: edit.clone() };
        let to_error = |e: &dyn std::fmt::Display| {
            let message = "the edit is applied, but cannot be stored for the next session";
            ApiError::new(axum::http::StatusCode::INSUFFICIENT_STORAGE, format!("{message}: {e}"))
        };
        if let Some(folder) = self.path.parent() {
            create_private_folder(folder).map_err(|e| to_error(&e))?;
        }
        let text = serde_json::to_vec(&content).map_err(|e| to_error(&e))?;
        atomic_write(&self.path, |file| Ok(file.write_all(&text)?)).map_err(|e| to_error(&e))?;
        make_private(&self.path).map_err(|e| to_error(&e))
    }
}

/// Creates a folder that only its owner can open, with those above it; existing ones stay as they are.
fn create_private_folder(folder: &Path) -> std::io::Result<()> {
    let mut builder = std::fs::DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(folder)
}

/// Lets only the owner read a file.
#[cfg_attr(not(unix), allow(clippy::unnecessary_wraps))]
fn make_private(path: &Path) -> std::io::Result<()> {
    #[cfg(unix)]
    std::fs::set_permissions(path, std::os::unix::fs::PermissionsExt::from_mode(0o600))?;
    #[cfg(not(unix))]
    let _ = path;
    Ok(())
}

/// Default folder of stored edits, by the conventions of the operating system.
pub(crate) fn default_folder() -> Option<PathBuf> {
    let variable = |name: &str| std::env::var_os(name).filter(|v| !v.is_empty()).map(PathBuf::from);
    let home = || variable("HOME").map(|home| home.join(".local/state"));
    let base = variable("XDG_STATE_HOME").or_else(|| variable("LOCALAPPDATA")).or_else(home)?;
    Some(base.join("adwave/studio"))
}
