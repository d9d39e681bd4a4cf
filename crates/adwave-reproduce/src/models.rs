//! Models of the paper, found by name in folders of the user.

use adwave::sample::{Sample, SampleError};
use adwave::shape::{Shape, triangulate};
use adwave::{ClassifiedError, ErrorKind};
use adwave_io::{Format, ReadError, ReadLimits, ShapeFile, ShapeFileError, ShapeKind, read_path};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use thiserror::Error;

/// Names of the models that figures use, each with alternative names of its files.
pub const MODELS: [(&str, &[&str]); 15] = [
    ("armadillo", &[]),
    ("dinosaur", &["dino"]),
    ("skull", &[]),
    ("horse", &[]),
    ("kitten", &[]),
    ("face", &[]),
    ("bunny", &[]),
    ("spot", &[]),
    ("gargoyle", &[]),
    ("buddha", &[]),
    ("hand", &[]),
    ("pegaso", &["pegasus"]),
    ("cow", &[]),
    ("sphere", &[]),
    ("dragon", &[]),
];

/// Largest depth of the search.
const MAX_DEPTH: usize = 12;
/// Largest number of files and folders that are searched in each folder of the user.
const MAX_ENTRIES: usize = 200_000;

/// Failure to find or read models.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ModelError {
    /// A folder does not exist or cannot be read.
    #[error("the folder of models {folder} cannot be read: {source}")]
    Folder {
        /// Path of the folder.
        folder: String,
        /// Reason.
        source: std::io::Error,
    },
    /// No model was found in the folders.
    #[error("there is no model of the paper in {folders}; file names must contain one of {}", names())]
    None {
        /// Paths of the folders.
        folders: String,
    },
    /// The file of a model is malformed.
    #[error("the model '{name}' cannot be read: {source}")]
    Read {
        /// Name of the model.
        name: &'static str,
        /// Reason, which names the file.
        source: Box<ReadError>,
    },
    /// The file of a model has no shape.
    #[error("the model '{name}' in {path} cannot be used: {source}")]
    Shape {
        /// Name of the model.
        name: &'static str,
        /// Path of its file.
        path: String,
        /// Reason.
        source: ShapeFileError,
    },
    /// A built-in shape cannot be generated.
    #[error(transparent)]
    Sample(#[from] SampleError),
}

impl ClassifiedError for ModelError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Folder { .. }
            | Self::None { .. }
            | Self::Read { .. }
            | Self::Shape { .. }
            | Self::Sample(_) => ErrorKind::Input,
        }
    }
}

fn names() -> String {
    MODELS.map(|(name, _)| name).join(", ")
}

/// Shape on which figures are made.
#[derive(Clone, Debug)]
pub struct Model {
    /// Name, such as `armadillo` or `built-in creature`.
    pub name: String,
    /// Content of the model's file, or a built-in shape.
    pub file: ShapeFile,
    /// Path of the model's file; `None` for a built-in shape.
    pub path: Option<PathBuf>,
    /// Shape of the model: a mesh if the file has faces, otherwise a cloud.
    pub shape: Shape,
    /// Triangulated faces.
    pub triangles: Vec<[u32; 3]>,
}

impl Model {
    /// Generates a built-in shape with about `n_vertices` vertices.
    ///
    /// # Errors
    /// [`ModelError::Sample`].
    pub fn built_in(sample: &str, n_vertices: usize) -> Result<Self, ModelError> {
        let made = Sample::from_name(sample, Some(n_vertices))?;
        let name = format!("built-in {sample}");
        Self::new(name, ShapeFile::from_mesh(made.points, made.faces), None)
            .map_err(|source| ModelError::Shape { name: "built-in", path: sample.to_owned(), source })
    }

    /// Returns a copy with other positions of the vertices, in model units.
    ///
    /// # Panics
    /// If there is not one finite position per vertex.
    #[must_use]
    pub fn with_points(&self, name: &str, points: Vec<[f64; 3]>) -> Self {
        let mut file = self.file.clone();
        file.set_points(points).expect("one position per vertex");
        Self::new(name.to_owned(), file, None).expect("as many finite points with the same faces")
    }

    /// Returns the vertices as a cloud.
    ///
    /// # Panics
    /// Never: the points of a shape are those of a cloud.
    #[must_use]
    pub fn cloud(&self) -> Self {
        let file = ShapeFile::from_cloud(self.points().to_vec());
        Self::new(format!("{} as a cloud", self.name), file, self.path.clone())
            .expect("finite points are a cloud")
    }

    /// Creates a model from a shape that was assembled in memory.
    ///
    /// # Errors
    /// [`ShapeFileError`].
    pub fn from_file(name: &str, file: ShapeFile) -> Result<Self, ShapeFileError> {
        Self::new(name.to_owned(), file, None)
    }

    fn new(name: String, file: ShapeFile, path: Option<PathBuf>) -> Result<Self, ShapeFileError> {
        let kind = if file.faces().is_empty() { ShapeKind::Cloud } else { ShapeKind::Mesh };
        let shape = file.to_shape_as(kind)?;
        let triangles = triangulate(file.points(), file.faces());
        Ok(Self { name, file, path, shape, triangles })
    }

    /// Positions of the vertices, in model units.
    pub fn points(&self) -> &[[f64; 3]] {
        self.file.points()
    }

    /// Positions of the vertices as a signal of three channels, row-major.
    pub fn coordinates(&self) -> &[f64] {
        self.points().as_flattened()
    }

    /// True for a model that was not read from a file.
    pub fn is_built_in(&self) -> bool {
        self.path.is_none()
    }

    /// Name with the number of vertices, such as `armadillo (43243 vertices)`.
    pub fn label(&self) -> String {
        format!("{} ({} vertices)", self.name, self.points().len())
    }
}

/// Models that were found in folders of the user.
#[derive(Clone, Debug, Default)]
pub struct Models {
    found: BTreeMap<&'static str, PathBuf>,
    read: BTreeMap<&'static str, Arc<Model>>,
}

impl Models {
    /// Searches folders recursively; earlier folders have precedence. A file is a model if one word of its name is the
    /// name of the model. A file whose name equals that of the model is preferred, then the larger file.
    ///
    /// # Errors
    /// [`ModelError::Folder`] if a folder cannot be read, [`ModelError::None`] if no file is a model.
    pub fn search(folders: &[PathBuf]) -> Result<Self, ModelError> {
        let mut files = Vec::new();
        for folder in folders {
            let entries = std::fs::read_dir(folder)
                .map_err(|source| ModelError::Folder { folder: folder.display().to_string(), source })?;
            let mut stack: Vec<(PathBuf, usize)> = entries.flatten().map(|e| (e.path(), 0)).collect();
            let (first, mut n_entries) = (files.len(), 0);
            while let Some((path, depth)) = stack.pop() {
                n_entries += 1;
                if n_entries > MAX_ENTRIES {
                    break;
                }
                // Links to folders are not followed, since they may form a cycle.
                let Ok(kind) = std::fs::symlink_metadata(&path) else { continue };
                if kind.is_dir() && depth < MAX_DEPTH {
                    let inner = std::fs::read_dir(&path).into_iter().flatten().flatten();
                    stack.extend(inner.map(|e| (e.path(), depth + 1)));
                } else if !kind.is_dir() && Format::from_path(&path).is_some_and(Format::can_read) {
                    let size = std::fs::metadata(&path).map_or(0, |m| m.len());
                    files.push((path, size));
                }
            }
            files[first..].sort();
        }
        let mut found = BTreeMap::new();
        for (name, others) in MODELS {
            let names = || std::iter::once(&name).chain(others);
            // The first of the best, so that earlier folders have precedence.
            let best = files
                .iter()
                .rev()
                .filter(|(path, _)| names().any(|n| matches_name(path, n)))
                .max_by_key(|(path, size)| (names().any(|n| stem(path) == *n), *size));
            if let Some((path, _)) = best {
                found.insert(name, path.clone());
            }
        }
        if found.is_empty() {
            let folders = folders.iter().map(|f| f.display().to_string()).collect::<Vec<_>>().join(", ");
            return Err(ModelError::None { folders });
        }
        Ok(Self { found, read: BTreeMap::new() })
    }

    /// Reads those of the named models that were found, so that a broken file is reported before any long computation.
    ///
    /// # Errors
    /// [`ModelError::Read`] or [`ModelError::Shape`], which name the model and its file.
    pub fn read(&mut self, names: &[&str]) -> Result<(), ModelError> {
        for (&name, path) in &self.found {
            if !names.contains(&name) || self.read.contains_key(name) {
                continue;
            }
            let file = read_path(path, &ReadLimits::default())
                .map_err(|source| ModelError::Read { name, source: Box::new(source) })?;
            let model = Model::new(name.to_owned(), file, Some(path.clone()))
                .map_err(|source| ModelError::Shape { name, path: path.display().to_string(), source })?;
            self.read.insert(name, Arc::new(model));
        }
        Ok(())
    }

    /// Returns a model that was read; `None` if there is none of this name.
    pub fn get(&self, name: &str) -> Option<Arc<Model>> {
        self.read.get(name).cloned()
    }

    /// Iterates over the models that were found, with their files.
    pub fn files(&self) -> impl Iterator<Item = (&'static str, &Path)> {
        self.found.iter().map(|(&name, path)| (name, path.as_path()))
    }
}

/// File name without extensions, in lower case.
fn stem(path: &Path) -> String {
    let name = path.file_name().map_or_else(String::new, |n| n.to_string_lossy().to_lowercase());
    name.split('.').next().unwrap_or_default().to_owned()
}

fn matches_name(path: &Path, name: &str) -> bool {
    stem(path).split(|c: char| !c.is_alphabetic()).any(|word| word == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

    #[test]
    fn a_word_of_the_file_name_decides_the_model() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        };
        write("a/b/Stanford-Bunny.OBJ", TRIANGLE);
        write("surface.obj", TRIANGLE);
        write("face_low.obj", &format!("# the larger file, but not the name alone\n{TRIANGLE}"));
        write("face.obj", TRIANGLE);
        write("dino.ply", "ply\n");
        write("horse.txt.bak", TRIANGLE);
        let mut models = Models::search(&[folder.path().to_owned()]).unwrap();
        let found: Vec<_> = models.files().map(|(name, path)| (name, stem(path))).collect();
        let expected = [("bunny", "stanford-bunny"), ("dinosaur", "dino"), ("face", "face")];
        assert_eq!(found, expected.map(|(a, b)| (a, b.to_owned())));
        models.read(&["bunny", "face"]).unwrap();
        assert_eq!(models.get("bunny").unwrap().label(), "bunny (3 vertices)");
        assert!(models.get("dinosaur").is_none());
        let error = models.read(&["dinosaur"]).unwrap_err().to_string();
        assert!(error.contains("'dinosaur'") && error.contains("dino.ply"), "{error}");
    }

    #[test]
    fn the_error_for_a_folder_without_models_lists_their_names() {
        let folder = tempfile::tempdir().unwrap();
        let error = Models::search(&[folder.path().to_owned()]).unwrap_err().to_string();
        assert!(error.contains("armadillo") && error.contains("kitten"), "{error}");
        let missing = folder.path().join("nowhere");
        assert!(Models::search(&[missing]).unwrap_err().to_string().contains("nowhere"));
    }
}
