//! Errors of reading and writing. Every message is one line.

use std::io;

use adwave::{Cancelled, ClassifiedError, ErrorKind};

/// Reasons for which bytes cannot be read as a shape.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// Error in a named file.
    #[error("{path}: {source}")]
    InFile {
        /// Path of the file.
        path: String,
        /// Error in the file.
        source: Box<ReadError>,
    },
    /// The file cannot be opened or read.
    #[error("the file cannot be read ({0}); check that it exists and is readable")]
    Io(#[from] io::Error),
    /// The file has no bytes.
    #[error("the file is empty; it must contain a shape, an image or a volume")]
    Empty,
    /// Neither content nor name identifies a format that can be read.
    #[error("is of an unknown format ({found}); formats that can be read: {readable}")]
    UnknownFormat {
        /// Description of the content.
        found: String,
        /// Names of the formats that can be read.
        readable: String,
    },
    /// A line of a text format is wrong.
    #[error("line {line}: {message}")]
    Line {
        /// Line number, counted from 1.
        line: u64,
        /// Reason and remedy.
        message: String,
    },
    /// A byte of a binary format is wrong.
    #[error("byte {byte}: {message}")]
    Byte {
        /// Byte offset, counted from 0.
        byte: u64,
        /// Reason and remedy.
        message: String,
    },
    /// The file is shorter than its header states.
    #[error(
        "the file ends at byte {end} of {needed}, in element `{element}`, row {row}; get the whole \
            file"
    )]
    Truncated {
        /// Number of bytes in the file.
        end: u64,
        /// Least number of bytes needed.
        needed: u64,
        /// Part of the file that is truncated.
        element: String,
        /// First incomplete row, counted from 0.
        row: u64,
    },
    /// A face names a vertex that does not exist.
    #[error("{place}: face {face} names vertex {index}, but there are {n_vertices}; correct the face")]
    FaceIndex {
        /// `line 12` or `byte 345`.
        place: String,
        /// Index of the face, counted from 0.
        face: u64,
        /// Vertex index in the file's own numbering: from 1 in OBJ, from 0 elsewhere; negative as in the file.
        index: i64,
        /// Number of vertices.
        n_vertices: u64,
    },
    /// The content exceeds the limits.
    #[error(
        "{what}: {found} exceeds the limit of {limit}; split the file, or raise the limit, which for bytes is by default a quarter of the memory that is free"
    )]
    Limit {
        /// Limited quantity.
        what: &'static str,
        /// Amount found.
        found: u64,
        /// Amount allowed.
        limit: u64,
    },
    /// Any other error of the file as a whole.
    #[error("{0}")]
    Whole(String),
    /// The caller cancelled the reading.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ClassifiedError for ReadError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::InFile { source, .. } => source.kind(),
            Self::Io(error) => kind_of_io(error),
            Self::Limit { .. } => ErrorKind::Memory,
            Self::Cancelled(error) => error.kind(),
            Self::Empty
            | Self::UnknownFormat { .. }
            | Self::Line { .. }
            | Self::Byte { .. }
            | Self::Truncated { .. }
            | Self::FaceIndex { .. }
            | Self::Whole(_) => ErrorKind::Input,
        }
    }
}

/// Content that is not text is an input error; all other system errors are errors of the machine.
pub(crate) fn kind_of_io(error: &io::Error) -> ErrorKind {
    match error.kind() {
        io::ErrorKind::InvalidData => ErrorKind::Input,
        io::ErrorKind::OutOfMemory => ErrorKind::Memory,
        _ => ErrorKind::Machine,
    }
}

impl ReadError {
    /// Creates the error at byte `position` of a text.
    pub(crate) fn line_error(bytes: &[u8], position: usize, message: impl Into<String>) -> Self {
        Self::Line { line: crate::text::line_of(bytes, position), message: message.into() }
    }

    /// Creates the error at byte `position` of a binary file.
    pub(crate) fn byte_error(position: usize, message: impl Into<String>) -> Self {
        Self::Byte { byte: position as u64, message: message.into() }
    }

    /// Prefixes the error with the file's name.
    #[must_use]
    pub fn in_file(self, path: &std::path::Path) -> Self {
        Self::InFile { path: path.display().to_string(), source: Box::new(self) }
    }
}

/// Reasons for which a shape cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// Error in a named file.
    #[error("{path}: {source}")]
    InFile {
        /// Path of the file.
        path: String,
        /// Error in the file.
        source: Box<WriteError>,
    },
    /// Writing failed; an older file of that name is unchanged.
    #[error("the file cannot be written ({0}); an existing file is unchanged")]
    Io(#[source] io::Error),
    /// The caller cancelled the writing; an older file of that name is unchanged.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The folder does not exist.
    #[error("the folder {folder} does not exist; create it first")]
    NoFolder {
        /// Path of the folder.
        folder: String,
    },
    /// The extension of the name identifies no format.
    #[error("the name tells no format that can be written; use one of the endings {writable}")]
    UnknownFormat {
        /// Endings that can be written.
        writable: String,
    },
    /// The format cannot store any of the content.
    #[error("{format} cannot store {what}; choose another format")]
    CannotHold {
        /// Format of the file.
        format: crate::Format,
        /// Content that cannot be stored.
        what: String,
    },
    /// A value is beyond the numbers of an image or a volume.
    #[error(
        "the value {} at place {place} does not fit the {kind} numbers of the {format} file, which are from {} to {}; {}",
        digits(*.value), digits(*.low), digits(*.high), another_type(.kind)
    )]
    Misfit {
        /// Format of the file.
        format: crate::Format,
        /// The value.
        value: f64,
        /// Place, counted from 0, and channel if there are several.
        place: String,
        /// Name of the type of number.
        kind: &'static str,
        /// Least value that fits.
        low: f64,
        /// Greatest value that fits.
        high: f64,
    },
    /// The format is read-only.
    #[error("{format} is read-only and cannot store the content; choose another format")]
    ReadOnly {
        /// Format of the file.
        format: crate::Format,
    },
    /// The number of values of an array does not match its shape.
    #[error("array {name}: the shape {shape:?} does not match {found} values; correct the shape")]
    ArrayShape {
        /// Name of the array.
        name: String,
        /// Number of values.
        found: u64,
        /// Shape given.
        shape: Vec<usize>,
    },
    /// Frames are no animation of the shape.
    #[error("{0}")]
    Frames(String),
}

impl From<io::Error> for WriteError {
    /// Converts an error of the system, or a cancellation that came through a [`std::io::Write`].
    fn from(error: io::Error) -> Self {
        let is_cancelled =
            error.get_ref().is_some_and(<dyn std::error::Error + Send + Sync>::is::<Cancelled>);
        if is_cancelled { Self::Cancelled(Cancelled) } else { Self::Io(error) }
    }
}

impl ClassifiedError for WriteError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::InFile { source, .. } => source.kind(),
            Self::Io(error) => kind_of_io(error),
            Self::Cancelled(error) => error.kind(),
            Self::NoFolder { .. } => ErrorKind::Machine,
            Self::UnknownFormat { .. }
            | Self::CannotHold { .. }
            | Self::Misfit { .. }
            | Self::ReadOnly { .. }
            | Self::ArrayShape { .. }
            | Self::Frames(_) => ErrorKind::Input,
        }
    }
}

/// A number in digits, with an exponent if it has many.
fn digits(value: f64) -> String {
    if value.abs() < 1e15 { value.to_string() } else { format!("{value:e}") }
}

/// Advice on values beyond a type of number.
fn another_type(kind: &str) -> &'static str {
    if kind == "f32" {
        "write another type of number, such as f64, or bands as .npz"
    } else {
        "write another type of number, such as f32"
    }
}

impl WriteError {
    /// Prefixes the error with the file's name.
    #[must_use]
    pub fn in_file(self, path: &std::path::Path) -> Self {
        Self::InFile { path: path.display().to_string(), source: Box::new(self) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn kinds_say_who_can_do_something() {
        let missing = || io::Error::from(io::ErrorKind::NotFound);
        let limit = ReadError::Limit { what: "vertices", found: 2, limit: 1 };
        let path = Path::new("a.ply");
        for (error, kind) in [
            (ReadError::Empty, ErrorKind::Input),
            (ReadError::Whole("x".into()).in_file(path), ErrorKind::Input),
            (limit.in_file(path), ErrorKind::Memory),
            (ReadError::Io(missing()).in_file(path), ErrorKind::Machine),
            (ReadError::Cancelled(Cancelled).in_file(path).in_file(path), ErrorKind::Cancelled),
        ] {
            assert_eq!(error.kind(), kind, "{error}");
        }
        for (error, kind) in [
            (WriteError::UnknownFormat { writable: ".obj".into() }.in_file(path), ErrorKind::Input),
            (WriteError::from(missing()), ErrorKind::Machine),
            (WriteError::from(io::Error::other(Cancelled)).in_file(path), ErrorKind::Cancelled),
        ] {
            assert_eq!(error.kind(), kind, "{error}");
        }
    }
}
