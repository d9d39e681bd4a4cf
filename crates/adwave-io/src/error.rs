//! What can go wrong in reading and writing. Every message is one line.

use std::io;

use adwave::{Cancelled, ClassifiedError, ErrorKind};

/// Why bytes are not read as a shape.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The error of a named file.
    #[error("{path}: {source}")]
    InFile {
        /// The file.
        path: String,
        /// What is wrong with it.
        source: Box<ReadError>,
    },
    /// The file cannot be opened or read.
    #[error("cannot be read ({0}); check that it is there and readable")]
    Io(#[from] io::Error),
    /// There is no byte.
    #[error("is empty; give a file that holds vertices")]
    Empty,
    /// Neither content nor name tells a format that can be read.
    #[error("is of an unknown format ({found}); formats that can be read: {readable}")]
    UnknownFormat {
        /// What it looks like.
        found: String,
        /// Names of the formats that can be read.
        readable: String,
    },
    /// A line of a text format is wrong.
    #[error("line {line}: {message}")]
    Line {
        /// Counted from 1.
        line: u64,
        /// What is wrong, and what to do.
        message: String,
    },
    /// A byte of a binary format is wrong.
    #[error("byte {byte}: {message}")]
    Byte {
        /// Counted from 0.
        byte: u64,
        /// What is wrong, and what to do.
        message: String,
    },
    /// The file ends before what its header promises.
    #[error("ends at byte {end} of {needed} needed, in element `{element}`, row {row}; get the whole file")]
    Truncated {
        /// How many bytes there are.
        end: u64,
        /// How many bytes there must be at least.
        needed: u64,
        /// Which part of the file is cut.
        element: String,
        /// The first row, counted from 0, that is not whole.
        row: u64,
    },
    /// A face names a vertex that is not there.
    #[error("{place}: face {face} names vertex {index}, but there are {n_vertices}; correct the face")]
    FaceIndex {
        /// `line 12` or `byte 345`.
        place: String,
        /// Counted from 0.
        face: u64,
        /// As the file counts: from 1 in OBJ, from 0 elsewhere; negative as it stands.
        index: i64,
        /// How many vertices there are.
        n_vertices: u64,
    },
    /// More than the limits allow.
    #[error("{what}: {found}, more than the limit of {limit}; raise the limit or split the file")]
    Limit {
        /// What there is too much of.
        what: &'static str,
        /// How much there is.
        found: u64,
        /// How much is allowed.
        limit: u64,
    },
    /// Something else about the file as a whole.
    #[error("{0}")]
    Whole(String),
    /// Reading was told to stop.
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

/// Content that is no text is the caller's to mend; all else of the system is the machine's.
pub(crate) fn kind_of_io(error: &io::Error) -> ErrorKind {
    match error.kind() {
        io::ErrorKind::InvalidData => ErrorKind::Input,
        io::ErrorKind::OutOfMemory => ErrorKind::Memory,
        _ => ErrorKind::Machine,
    }
}

impl ReadError {
    /// The error at byte `position` of a text.
    pub(crate) fn in_line(bytes: &[u8], position: usize, message: impl Into<String>) -> Self {
        Self::Line { line: crate::text::line_of(bytes, position), message: message.into() }
    }

    /// The error at byte `position` of a binary.
    pub(crate) fn at_byte(position: usize, message: impl Into<String>) -> Self {
        Self::Byte { byte: position as u64, message: message.into() }
    }

    /// The same error with the file's name before it.
    #[must_use]
    pub fn in_file(self, path: &std::path::Path) -> Self {
        Self::InFile { path: path.display().to_string(), source: Box::new(self) }
    }
}

/// Why a shape is not written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The error of a named file.
    #[error("{path}: {source}")]
    InFile {
        /// The file.
        path: String,
        /// What is wrong.
        source: Box<WriteError>,
    },
    /// Writing failed; an older file of that name is as it was.
    #[error("cannot be written ({0}); a file that was there before is unchanged")]
    Io(#[source] io::Error),
    /// Writing was told to stop; an older file of that name is as it was.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The folder is not there.
    #[error("the folder {folder} does not exist; make it first")]
    NoFolder {
        /// The folder.
        folder: String,
    },
    /// The name has no ending that tells a format.
    #[error("the name tells no format that can be written; use one of the endings {writable}")]
    UnknownFormat {
        /// Endings that can be written.
        writable: String,
    },
    /// The shape has nothing that the format can hold.
    #[error("{format} cannot hold {what}; choose another format")]
    CannotHold {
        /// The format.
        format: crate::Format,
        /// What it cannot hold.
        what: String,
    },
    /// The format is read only.
    #[error("{format} is read, and cannot hold what is to be written; choose another format")]
    ReadOnly {
        /// The format.
        format: crate::Format,
    },
    /// An array does not have the shape that it is said to have.
    #[error("array {name}: {found} values do not fill the shape {shape:?}; correct the shape")]
    ArrayShape {
        /// Its name.
        name: String,
        /// How many values there are.
        found: u64,
        /// The shape given.
        shape: Vec<usize>,
    },
}

impl From<io::Error> for WriteError {
    /// An error of the system, or the request to stop that came through a [`std::io::Write`].
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
            | Self::ReadOnly { .. }
            | Self::ArrayShape { .. } => ErrorKind::Input,
        }
    }
}

impl WriteError {
    /// The same error with the file's name before it.
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
