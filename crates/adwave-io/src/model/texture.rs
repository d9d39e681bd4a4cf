//! Sampling of textures: what is asked for, and why there are no colors.

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

/// Why there are no colors.
#[derive(Debug, thiserror::Error)]
pub enum TextureError {
    /// The file of the shape, or of its materials, cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// No vertex says where in the picture it is.
    #[error("{shape} has no texture coordinates (UVs), so no texture can be sampled; export it with them")]
    NoCoordinates {
        /// The shape's file.
        shape: String,
    },
    /// Nothing names a picture.
    #[error(
        "{shape} names no texture (no map_Kd or baseColorTexture in its materials); name one with --texture FILE.png"
    )]
    NoTexture {
        /// The shape's file.
        shape: String,
    },
    /// A picture is not there or is no picture.
    #[error("the texture {path} cannot be read ({cause}); check the name, or convert it to PNG or JPEG")]
    Picture {
        /// The picture's file.
        path: String,
        /// Why.
        cause: String,
        /// Whether the picture or the machine is to blame.
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
