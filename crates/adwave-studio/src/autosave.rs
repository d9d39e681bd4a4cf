//! The edit of a shape, kept between visits.

use crate::answer::Refused;
use crate::document::Document;
use crate::session::Opened;
use adwave::LevelSpec;
use adwave_io::{Recipe, atomic_write, parse_recipe, recipe_to_text};
use serde::{Deserialize, Serialize};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};

/// A file for the edits of one shape, by its path and its positions.
#[derive(Clone, Debug)]
pub(crate) struct Autosave {
    path: PathBuf,
}

/// What is kept: the levels as a recipe has them, and the edit.
#[derive(Serialize, Deserialize)]
struct Kept {
    levels: String,
    edit: Document,
}

impl Autosave {
    /// None for a shape that comes from no file, and where there is no place to keep anything.
    pub(crate) fn of(opened: &Opened, folder: Option<&Path>) -> Option<Self> {
        let path = opened.path.as_ref()?.canonicalize().ok()?;
        let mut hasher = DefaultHasher::new();
        path.hash(&mut hasher);
        for c in opened.shape.points()?.as_flattened() {
            c.to_bits().hash(&mut hasher);
        }
        Some(Self { path: folder?.join(format!("{:016x}.json", hasher.finish())) })
    }

    /// The edit of the last visit, where there is one that can be read.
    pub(crate) fn read(&self) -> Option<(LevelSpec, Document)> {
        let kept: Kept = serde_json::from_slice(&std::fs::read(&self.path).ok()?).ok()?;
        Some((parse_recipe(&kept.levels).ok()?.levels, kept.edit))
    }

    /// Keeps an edit; what was kept before stays until all of it is written.
    pub(crate) fn write(&self, levels: &LevelSpec, edit: &Document) -> Result<(), Refused> {
        let recipe = Recipe { levels: levels.clone(), ..Recipe::default() };
        let kept = Kept { levels: recipe_to_text(&recipe), edit: edit.clone() };
        let refused = |e: &dyn std::fmt::Display| {
            let told = "the edit holds for this visit, but is not kept for the next";
            Refused::new(axum::http::StatusCode::INSUFFICIENT_STORAGE, format!("{told}: {e}"))
        };
        if let Some(folder) = self.path.parent() {
            std::fs::create_dir_all(folder).map_err(|e| refused(&e))?;
        }
        let text = serde_json::to_vec(&kept).map_err(|e| refused(&e))?;
        atomic_write(&self.path, |file| Ok(file.write_all(&text)?)).map_err(|e| refused(&e))
    }
}

/// Where a program keeps what it would not lose.
pub(crate) fn folder() -> Option<PathBuf> {
    let of = |name: &str| std::env::var_os(name).filter(|v| !v.is_empty()).map(PathBuf::from);
    let home = || of("HOME").map(|home| home.join(".local/state"));
    let place = of("XDG_STATE_HOME").or_else(|| of("LOCALAPPDATA")).or_else(home)?;
    Some(place.join("adwave/studio"))
}
