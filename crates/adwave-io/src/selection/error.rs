//! Reasons for which a selection cannot be applied.

use adwave::{ClassifiedError, ErrorKind};

use super::FieldCondition;
use crate::{NamedSignalError, ReadError, ShapeFileError};

/// Reasons for which a selection cannot be applied.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SelectionError {
    /// A condition names a field that does not exist.
    #[error("there is no field for the condition '{condition}'; {}", use_one_of(available))]
    UnknownField {
        /// Condition.
        condition: String,
        /// Names of the fields that can be used.
        available: Vec<String>,
    },
    /// A condition names a field of faces.
    #[error(
        "the condition '{condition}' needs a field of vertices, and this one has a number per face; {}",
        use_one_of(available)
    )]
    FieldOfFaces {
        /// Condition.
        condition: String,
        /// Names of the fields that can be used.
        available: Vec<String>,
    },
    /// A condition names a field with several channels.
    #[error(
        "the condition '{condition}' needs a field with one number per vertex, and this one has {n_channels}; {}",
        use_one_of(available)
    )]
    Channels {
        /// Condition.
        condition: String,
        /// Numbers per vertex.
        n_channels: usize,
        /// Names of the fields that can be used.
        available: Vec<String>,
    },
    /// No vertex fulfills a condition.
    #[error("no vertex fulfills {condition}; the values of the field are {least} to {greatest}")]
    Nothing {
        /// Condition.
        condition: String,
        /// Least value.
        least: f64,
        /// Greatest value.
        greatest: f64,
    },
    /// No vertex has a value for a condition.
    #[error("no vertex fulfills {condition}, since all values of the field are NaN; choose another field")]
    NoValues {
        /// Condition.
        condition: String,
    },
    /// No vertex fulfills all conditions.
    #[error("no vertex takes part: none fulfills {selection}; widen the selection")]
    NothingLeft {
        /// Conditions and the mask.
        selection: String,
    },
    /// The mask does not have one number per vertex.
    #[error(
        "the mask {mask} must have a number for each of {n_rows} vertices, got {found} rows; use one of this shape"
    )]
    MaskLength {
        /// Name of the file.
        mask: String,
        /// Number of its rows.
        found: usize,
        /// Number of vertices in the file of the shape.
        n_rows: usize,
    },
    /// The mask has several numbers per vertex.
    #[error(
        "the mask {mask} must have one number per vertex, got {n_channels}; select a column with {mask}:NAME"
    )]
    MaskChannels {
        /// Name of the file.
        mask: String,
        /// Numbers per vertex.
        n_channels: usize,
    },
    /// The mask of an image or a volume has other places.
    #[error(
        "the mask {mask} must have the places of the file that it is for: {what}; resample it to that grid"
    )]
    MaskGrid {
        /// Name of the file.
        mask: String,
        /// The difference.
        what: String,
    },
    /// There is no such file.
    #[error("there is no mask file '{mask}'; give a .npy, .csv, .gii, .label or .annot file")]
    NoMask {
        /// Name of the file.
        mask: String,
    },
    /// The mask cannot be read.
    #[error(transparent)]
    Read(#[from] NamedSignalError),
    /// A label or annotation cannot be read.
    #[error(transparent)]
    ReadMask(#[from] ReadError),
    /// Nothing is left of the shape.
    #[error(transparent)]
    Shape(#[from] ShapeFileError),
}

fn use_one_of(available: &[String]) -> String {
    match available {
        [] => "the shape has no fields".to_owned(),
        names => format!("use {}", names.join(", ")),
    }
}

impl SelectionError {
    pub(super) fn unknown(condition: String, is_of_faces: bool, available: Vec<String>) -> Self {
        if is_of_faces {
            Self::FieldOfFaces { condition, available }
        } else {
            Self::UnknownField { condition, available }
        }
    }

    /// Error for a condition that no value fulfills.
    pub(super) fn nothing(condition: &FieldCondition, values: &[f64]) -> Self {
        let condition = condition.to_string();
        let present = || values.iter().copied().filter(|x| !x.is_nan());
        let (least, greatest) =
            (present().fold(f64::INFINITY, f64::min), present().fold(f64::NEG_INFINITY, f64::max));
        if least > greatest {
            Self::NoValues { condition }
        } else {
            Self::Nothing { condition, least, greatest }
        }
    }
}

impl ClassifiedError for SelectionError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Read(error) => error.kind(),
            Self::ReadMask(error) => error.kind(),
            _ => ErrorKind::Input,
        }
    }
}
