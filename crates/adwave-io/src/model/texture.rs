//! Requests for the colors of textures, and the reasons for which there are none.

use std::path::Path;

use adwave::{ClassifiedError, ErrorKind};

use crate::{Field, ReadError, ReadLimits, ShapeFile};

/// A request for the colors of a texture at the vertices of a shape.
#[derive(Clone, Copy)]
pub(crate) struct TextureRequest<'a> {
    /// The file of the shape.
    pub(crate) path: &'a Path,
    /// The picture that takes the place of those that the file names.
    pub(crate) image: Option<&'a Path>,
    pub(crate) limits: &'a ReadLimits,
}

/// Sampler of a format whose files name their own pictures.
pub(crate) type TextureFn = fn(&ShapeFile, &TextureRequest<'_>) -> Result<Field, TextureError>;

impl TextureRequest<'_> {
    /// The name of the shape's file.
    pub(crate) fn name(&self) -> String {
        self.path.display().to_string()
    }

    /// The error of a shape whose file names no picture.
    pub(crate) fn missing(&self, shape: &ShapeFile) -> TextureError {
        match shape.field("texcoord") {
            None => TextureError::NoCoordinates { shape: self.name() },
            Some(_) => TextureError::NoTexture { shape: self.name() },
        }
    }
}

/// Reasons for which there are no colors.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TextureError {
    /// The file of the shape, or of its materials, cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The shape has no texture coordinates.
    #[error("{shape} has no texture coordinates (UVs), which a texture needs; export the shape with UVs")]
    NoCoordinates {
        /// File of the shape.
        shape: String,
    },
    /// No picture is named.
    #[error(
        "{shape} names no texture (no map_Kd or baseColorTexture in its materials); choose one with \
        --texture FILE.png"
    )]
    NoTexture {
        /// File of the shape.
        shape: String,
    },
    /// A picture does not exist or is invalid.
    #[error("the texture {path} cannot be read ({cause}); check the name, or convert it to PNG or JPEG")]
    Picture {
        /// File of the picture.
        path: String,
        /// Cause of the failure.
        cause: String,
        /// Kind of the error: the input or the machine.
        kind: ErrorKind,
    },
}

impl ClassifiedError for TextureError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Read(error) => error.kind(),
            Self::NoCoordinates { .. } | Self::NoTexture { .. } => ErrorKind::Input,
            Self::Picture { kind, .. } => *kind,
        }
    }
}
