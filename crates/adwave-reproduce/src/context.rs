//! Context of all figures: models, size limits, progress.

use crate::models::{Model, ModelError, Models};
use adwave::Progress;
use adwave::sample::SAMPLE_NAMES;
use std::collections::HashMap;
use std::sync::{Arc, Mutex};

/// Models on which figures are made, and progress.
pub struct Context<'a> {
    /// Models of the user.
    pub models: Models,
    /// Progress and cancellation.
    pub progress: Progress<'a>,
    /// Largest number of vertices of built-in shapes; the models of the paper have up to 50 000.
    pub most_vertices: usize,
    made: Mutex<HashMap<(String, usize), Arc<Model>>>,
}

impl<'a> Context<'a> {
    /// Creates a context with the models of the user.
    pub fn new(models: Models, progress: Progress<'a>) -> Self {
        Self { models, progress, most_vertices: usize::MAX, made: Mutex::default() }
    }

    /// Limits the size of built-in shapes, for quick sketches of the figures.
    #[must_use]
    pub fn with_most_vertices(self, most_vertices: usize) -> Self {
        Self { most_vertices, ..self }
    }

    /// Returns the first of the named models that the user has.
    pub fn model(&self, names: &[&str]) -> Option<Arc<Model>> {
        names.iter().find_map(|name| self.models.get(name))
    }

    /// Returns the first of the named models that the user has, otherwise a built-in shape with about `n_vertices`
    /// vertices.
    ///
    /// # Errors
    /// [`ModelError::Sample`].
    pub fn model_or(
        &self,
        names: &[&str],
        sample: &str,
        n_vertices: usize,
    ) -> Result<Arc<Model>, ModelError> {
        self.model(names).map_or_else(|| self.built_in(sample, n_vertices), Ok)
    }

    /// Returns a built-in shape with about `n_vertices` vertices, which is generated once.
    ///
    /// # Errors
    /// [`ModelError::Sample`].
    pub fn built_in(&self, sample: &str, n_vertices: usize) -> Result<Arc<Model>, ModelError> {
        let fewest = SAMPLE_NAMES.iter().find(|s| s.name == sample).map_or(0, |s| s.min_vertices);
        let n = n_vertices.min(self.most_vertices.max(fewest));
        let mut made = self.made.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some(model) = made.get(&(sample.to_owned(), n)) {
            return Ok(Arc::clone(model));
        }
        let model = Arc::new(Model::built_in(sample, n)?);
        made.insert((sample.to_owned(), n), Arc::clone(&model));
        Ok(model)
    }
}
