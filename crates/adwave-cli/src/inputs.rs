//! Files that a run has read, for the provenance of its results.

use crate::error::CliError;
use adwave::Progress;
use adwave_io::ProvenanceInput;
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

/// Sources that a run has read.
pub(crate) struct Inputs {
    /// True if results carry their provenance in comments too.
    pub(crate) in_comments: bool,
    sources: Mutex<Vec<InputSource>>,
    /// Remarks about the sources that have not been printed.
    remarks: Mutex<Vec<String>>,
    /// Words for a place of an image or a volume, if the first source is one.
    row_words: OnceLock<[&'static str; 2]>,
}

#[derive(PartialEq, Eq)]
enum InputSource {
    /// A file, hashed only if a result carries its provenance.
    File(PathBuf),
    /// A source that can be read once only, or that has no hash.
    ShapeFeatures(ProvenanceInput),
}

impl Inputs {
    pub(crate) fn new(in_comments: bool) -> Self {
        Self { in_comments, sources: Mutex::default(), remarks: Mutex::default(), row_words: OnceLock::new() }
    }

    fn sources(&self) -> MutexGuard<'_, Vec<InputSource>> {
        self.sources.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Keeps a remark about a source until work on it begins, so that an error stands alone.
    pub(crate) fn add_remark(&self, text: String) {
        self.remarks.lock().unwrap_or_else(PoisonError::into_inner).push(text);
    }

    /// Takes the remarks that have not been printed.
    pub(crate) fn take_remarks(&self) -> Vec<String> {
        std::mem::take(&mut *self.remarks.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Sets the words for a place of the first source and for several.
    pub(crate) fn set_row_words(&self, words: [&'static str; 2]) {
        let _ = self.row_words.set(words); // those of further sources do not count
    }

    /// A message about the sources in the words of the first: the libraries speak of vertices, which an image does not
    /// have. Names, options and keys with a vertex in them stay.
    pub(crate) fn in_row_words(&self, text: &str) -> String {
        let Some(&[one, many]) = self.row_words.get() else { return text.to_owned() };
        let is_part = |c: char| c.is_alphanumeric() || "-_=:./'`".contains(c);
        let mut told = String::new();
        for word in text.split_inclusive(|c: char| !is_part(c)) {
            let name = word.trim_end_matches(|c: char| !is_part(c) || c == '.' || c == ':');
            let replaced = match name {
                "vertex" => one,
                "vertices" => many,
                name => name,
            };
            told += replaced;
            told += &word[name.len()..];
        }
        told
    }

    fn add(&self, source: InputSource) {
        let mut sources = self.sources();
        if !sources.contains(&source) {
            sources.push(source);
        }
    }

    /// Adds a file.
    pub(crate) fn add_file(&self, path: &Path) {
        self.add(InputSource::File(path.to_owned()));
    }

    /// Adds the file that a signal comes from, if it comes from one (`FILE` or `FILE:COLUMN`), and a texture.
    pub(crate) fn add_signal(&self, name: &str, texture: Option<&Path>) {
        let before_column = name.rsplit_once(':').map(|(file, _)| file);
        let file =
            [Some(name), before_column].into_iter().flatten().map(Path::new).find(|file| file.is_file());
        file.into_iter().chain(texture).for_each(|path| self.add_file(path));
    }

    /// Adds bytes that are no file, with their hash.
    pub(crate) fn add_bytes(&self, name: &str, bytes: &[u8]) {
        let sha256 = Some(hexadecimal(Sha256::digest(bytes)));
        self.add(InputSource::ShapeFeatures(ProvenanceInput { name: name.to_owned(), sha256 }));
    }

    /// Adds a built-in shape, or a file that is read in part, by its name without folders.
    pub(crate) fn add_unhashed(&self, name: &str) {
        let name = last_component(name).to_owned();
        self.add(InputSource::ShapeFeatures(ProvenanceInput { name, sha256: None }));
    }

    /// All sources with their hashes. Reads the files again.
    pub(crate) fn describe(&self, progress: Progress<'_>) -> Result<Vec<ProvenanceInput>, CliError> {
        let describe = |source: &InputSource| match source {
            InputSource::ShapeFeatures(input) => Ok(input.clone()),
            InputSource::File(path) => {
                let name = last_component(&path.to_string_lossy()).to_owned();
                Ok(ProvenanceInput { name, sha256: hash_file(path, progress)? })
            }
        };
        self.sources().iter().map(describe).collect()
    }
}

/// The SHA-256 of a regular file; none of pipes and devices, which can be read once only.
fn hash_file(path: &Path, progress: Progress<'_>) -> Result<Option<String>, CliError> {
    if !path.metadata().is_ok_and(|m| m.is_file()) {
        return Ok(None);
    }
    let failed = |e: std::io::Error| {
        CliError::Environment(format!("{}: the file cannot be read again: {e}", path.display()))
    };
    let mut file = File::open(path).map_err(failed)?;
    let (mut sum, mut buffer) = (Sha256::new(), vec![0; 1 << 20]);
    loop {
        progress.check().map_err(|_| CliError::Cancelled)?;
        match file.read(&mut buffer).map_err(failed)? {
            0 => return Ok(Some(hexadecimal(sum.finalize()))),
            n => sum.update(&buffer[..n]),
        }
    }
}

fn hexadecimal(bytes: impl AsRef<[u8]>) -> String {
    bytes.as_ref().iter().fold(String::new(), |text, byte| text + &format!("{byte:02x}"))
}

/// The last component of a path that is given as text.
pub(crate) fn last_component(path: &str) -> &str {
    path.rsplit(['/', std::path::MAIN_SEPARATOR]).find(|part| !part.is_empty()).unwrap_or(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_on_images_speak_of_pixels() {
        let inputs = Inputs::new(false);
        let text =
            "vertices of vertex.tif: vertex 3 of 'ball:vertex=3'; (the vertices), --vertices, per vertex.";
        assert_eq!(inputs.in_row_words(text), text);
        inputs.set_row_words(["pixel", "pixels"]);
        inputs.set_row_words(["vertex", "vertices"]);
        let told = "pixels of vertex.tif: pixel 3 of 'ball:vertex=3'; (the pixels), --vertices, per pixel.";
        assert_eq!(inputs.in_row_words(text), told);
    }
}
