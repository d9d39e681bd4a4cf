//! The studio: an equalizer for shapes in the browser.
//!
//! [`serve`] opens a server on the loopback that keeps the bands of a shape and the edit that is made of it, and gives the page in `web`
//! what it draws; what both say to each other is in `PROTOCOL.md`. `guard` says who may ask, `session` is one shape, `document` its edit,
//! `assets` the page itself.
//!
//! The page computes what it shows while a slider is dragged. What is saved is computed here, in double precision, by the object that
//! the command's `filter` uses, so that a saved shape has the bits of the recipe replayed.

mod answer;
mod assets;
mod autosave;
mod compare;
mod document;
mod fields;
mod guard;
mod page;
mod prepared;
mod report;
mod routes;
mod save;
mod server;
mod session;
mod work;

pub use document::Document;
pub use server::{Finished, Served, StudioParams, serve};
pub use session::Opened;

use adwave::{ClassifiedError, ErrorKind};
use thiserror::Error;

/// Why there is no studio, or not any more.
#[derive(Debug, Error)]
pub enum StudioError {
    /// The shape has no positions that could be shown.
    #[error(
        "{0}: a graph has no positions to show; give a mesh or a cloud, or its bands as numbers to `adwave transform`"
    )]
    NoPositions(String),
    /// More vertices than a browser can keep.
    #[error(
        "{name}: {n} vertices are more than the {most} that a browser keeps; `adwave simplify` makes a shape of fewer"
    )]
    TooLarge {
        /// The shape.
        name: String,
        /// Vertices that it has.
        n: usize,
        /// Vertices that are shown at the most.
        most: usize,
    },
    /// Something of the method.
    #[error("{text}")]
    Of {
        /// Who can do something about it.
        kind: ErrorKind,
        /// What is wrong.
        text: String,
    },
    /// No port, no thread, no random numbers.
    #[error("the studio cannot start: {0}")]
    Machine(#[from] std::io::Error),
}

impl StudioError {
    pub(crate) fn of(error: &impl ClassifiedError) -> Self {
        Self::Of { kind: error.kind(), text: error.to_string() }
    }
}

impl ClassifiedError for StudioError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NoPositions(_) | Self::TooLarge { .. } => ErrorKind::Input,
            Self::Of { kind, .. } => *kind,
            Self::Machine(_) => ErrorKind::Machine,
        }
    }
}
