//! Why a shape is not simplified.

use adwave::{Cancelled, ClassifiedError, ErrorKind};
use thiserror::Error;

/// Why a shape is not simplified.
#[derive(Debug, Error, PartialEq)]
pub enum SimplifyError {
    /// A distance that cannot be aimed at.
    #[error("the error {0:?} is no length; it must be finite and not negative")]
    Length(f64),
    /// No vertices cannot be aimed at.
    #[error("0 vertices are no shape; ask for 1 or more")]
    NoVertices,
    /// A share that is none.
    #[error("the ratio {0:?} is no share of the vertices; it must be above 0 and at most 1")]
    Ratio(f64),
    /// Labels are not one per corner.
    #[error("there are {found} labels for {n_corners} corners of faces; give one for each")]
    Labels {
        /// How many labels were given.
        found: usize,
        /// How many corners the faces have.
        n_corners: usize,
    },
    /// There is no surface to measure on.
    #[error("no face has an area, so there is no surface to simplify; take the shape as a cloud")]
    NoSurface,
    /// Told to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ClassifiedError for SimplifyError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Cancelled(error) => error.kind(),
            _ => ErrorKind::Input,
        }
    }
}
