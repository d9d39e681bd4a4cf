//! Studio: an equalizer for shapes, graphs, images and volumes in the browser.
//!
//! [`serve`] starts a server on the loopback interface that holds the bands of a shape or a grid and its edit, and sends
//! the page in `web` the arrays that it draws. `PROTOCOL.md` describes the requests. `guard` is the access control,
//! `session` an open shape, `grid_session` an open image or volume, `workspace` and `band_edit` what both have,
//! `document` the edit, `assets` the files of the page.
//!
//! While a slider is dragged, the page computes the preview itself. Saved shapes are computed here in double precision,
//! with the same objects as the command `adwave filter`: a saved file is bit-identical to a replay of its recipe.

mod assets;
mod autosave;
mod band_edit;
mod compare;
mod deviation;
mod document;
mod export_page;
mod field_bands;
mod fields;
mod graph_layout;
mod grid_files;
mod grid_planes;
mod grid_session;
mod guard;
mod listed;
mod opened;
mod pose;
mod prepared_shape;
mod recipes;
mod region_weights;
mod report;
mod response;
mod routes;
mod save;
mod server;
mod session;
mod tasks;
mod tool_routes;
mod workspace;

pub use document::{Document, FieldEdit};
pub use server::{StudioAddress, StudioOutcome, StudioParams, serve};
pub use session::StudioInput;

use adwave::{ClassifiedError, ErrorKind};
use thiserror::Error;

/// Failure to start or run the studio.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StudioError {
    /// The shape has more vertices than a browser can hold.
    #[error(
        "{name}: the studio supports up to {max} vertices, got {n}; reduce the shape with `adwave simplify`"
    )]
    TooLarge {
        /// Name of the shape.
        name: String,
        /// Number of vertices.
        n: usize,
        /// Largest supported number of vertices.
        max: usize,
    },
    /// The image, volume or graph is of a kind that the studio does not show.
    #[error("{name}: {problem}")]
    Unsuitable {
        /// Name of what was to be opened.
        name: String,
        /// Sentence on the shapes that the studio shows, the one that was found, and the way out.
        problem: String,
    },
    /// An error of the method or of a file.
    #[error("{text}")]
    Method {
        /// Class of the error.
        kind: ErrorKind,
        /// Message.
        text: String,
    },
    /// No port, thread or random numbers were available.
    #[error("the studio cannot start: {0}")]
    Machine(#[from] std::io::Error),
}

impl StudioError {
    pub(crate) fn from_classified(error: &impl ClassifiedError) -> Self {
        Self::Method { kind: error.kind(), text: error.to_string() }
    }
}

impl ClassifiedError for StudioError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::TooLarge { .. } | Self::Unsuitable { .. } => ErrorKind::Input,
            Self::Method { kind, .. } => *kind,
            Self::Machine(_) => ErrorKind::Machine,
        }
    }
}
