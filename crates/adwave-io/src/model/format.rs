//! Identity of a format and the description that each format's folder gives of itself.

use std::fmt;
use std::hash::{Hash, Hasher};
use std::path::Path;

use crate::model::context::{ReadContext, WriteContext};
use crate::model::file_head::FileHead;
use crate::model::texture::TextureFn;
use crate::{Field, ReadError, ShapeFile, WriteError};

/// A format of shapes. Binary and text forms that share a file ending are formats of their own.
///
/// Constants such as [`Format::PLY`] stand in the folder of their format.
#[derive(Clone, Copy)]
pub struct Format(&'static FormatDescriptor);

/// Kind of content that files of a format hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ContentKind {
    /// Points with faces or lines; regular grids are read as their surface.
    Mesh,
    /// Points alone.
    Cloud,
    /// Edges, with or without points.
    Graph,
    /// Values at the vertices of a shape in another file.
    Values,
}

/// Room for the [`Provenance`](crate::Provenance) of a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ProvenanceRoom {
    None,
    /// Metadata that the writer fills.
    Metadata,
    /// A line that begins with `begin`, after the first `lines_before` lines of the text.
    Comment {
        begin: &'static str,
        lines_before: usize,
    },
}

/// Confidence that bytes are of a format, lowest first. The greatest one decides, among equals the order of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Evidence {
    /// The first lines are rows of numbers.
    Numbers,
    /// The ending of the name says so, and the content does not speak against it.
    Name,
    /// The first word is a statement of the format.
    Statement,
    /// The first lines follow the layout of the format. From here on the content counts more than that of the
    /// kinds of files which are known and not read.
    Layout,
    /// The ending of the name says so, and any content is possible.
    NameAlone,
    /// The first word is reserved for the format.
    Keyword,
    /// The length is the one that the header promises.
    Length,
    /// Bytes at fixed places.
    Signature,
}

/// A small file for tests and for the fuzzer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    /// File name, with the ending that readers may need.
    pub(crate) name: &'static str,
    pub(crate) bytes: &'static [u8],
}

/// Reader of a whole file.
pub(crate) type ReadFn = fn(Vec<u8>, &ReadContext<'_>) -> Result<ShapeFile, ReadError>;
/// Reader of a folder; `None` if the path is not of the format.
pub(crate) type ReadFolderFn = fn(&Path, &ReadContext<'_>) -> Option<Result<ShapeFile, ReadError>>;
/// Writer of a new file.
pub(crate) type WriteFn = fn(&ShapeFile, &mut WriteContext<'_>) -> Result<(), WriteError>;
/// Reader of values for a surface: the bytes, the part of the anatomy and the number of vertices.
pub(crate) type ReadValuesFn = fn(&[u8], &SurfaceSize<'_>, &ReadContext<'_>) -> Result<Vec<Field>, ReadError>;

/// The surface that values are read for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfaceSize<'a> {
    /// Part of the anatomy, such as `CortexLeft`.
    pub(crate) structure: Option<&'a str>,
    pub(crate) n_vertices: usize,
}

/// Everything that other modules know about a format: the source of names, endings, messages, documents and dispatch.
///
/// A format's folder ends in its descriptors, each of which begins with `..FormatDescriptor::NEW`.
pub(crate) struct FormatDescriptor {
    /// Name on the command line and in messages: `ply-ascii`.
    pub(crate) name: &'static str,
    /// Name in full: `PLY, text`.
    pub(crate) title: &'static str,
    /// File endings without the dot; empty for the second form of an ending.
    pub(crate) extensions: &'static [&'static str],
    /// The format whose ending this one shares, if it is the second form of it.
    pub(crate) form_of: Option<&'static FormatDescriptor>,
    pub(crate) content: ContentKind,
    /// What is read, in words; empty if nothing is.
    pub(crate) reads: &'static str,
    /// What is written, in words; empty if nothing is.
    pub(crate) writes: &'static str,
    /// What stays as it was when a file is written in the format that it was read from, in words.
    pub(crate) keeps: &'static str,
    /// What the format cannot hold, or what is not read of it, in words.
    pub(crate) loses: &'static str,
    /// A file has a shape together with any fields of its vertices, by their names.
    pub(crate) holds_fields: bool,
    /// Coordinates are always written as 32-bit floats.
    pub(crate) is_single_precision: bool,
    pub(crate) provenance: ProvenanceRoom,
    /// Evidence that a file is of this format. Of two forms of an ending only the first is asked.
    pub(crate) recognize: fn(&FileHead<'_>) -> Option<Evidence>,
    /// Name of a related kind of file that is not read as a shape, for the message.
    pub(crate) name_foreign: fn(&FileHead<'_>) -> Option<&'static str>,
    /// Tells if the bytes are text in lines, whose line ends may be those of the old Macintosh.
    pub(crate) has_lines: fn(&[u8]) -> bool,
    pub(crate) read: Option<ReadFn>,
    pub(crate) read_folder: Option<ReadFolderFn>,
    pub(crate) read_values: Option<ReadValuesFn>,
    pub(crate) write: Option<WriteFn>,
    /// Colors of the pictures that a file names, at the vertices.
    pub(crate) texture: Option<TextureFn>,
    pub(crate) samples: &'static [Sample],
}

impl FormatDescriptor {
    /// A mesh format that can do nothing yet.
    pub(crate) const NEW: Self = Self {
        name: "",
        title: "",
        extensions: &[],
        form_of: None,
        content: ContentKind::Mesh,
        reads: "",
        writes: "",
        keeps: "",
        loses: "",
        holds_fields: false,
        is_single_precision: false,
        provenance: ProvenanceRoom::None,
        recognize: |_| None,
        name_foreign: |_| None,
        has_lines: |_| false,
        read: None,
        read_folder: None,
        read_values: None,
        write: None,
        texture: None,
        samples: &[],
    };
}

impl Format {
    /// The format that a descriptor describes.
    pub(crate) const fn new(descriptor: &'static FormatDescriptor) -> Self {
        Self(descriptor)
    }

    pub(crate) fn descriptor(self) -> &'static FormatDescriptor {
        self.0
    }

    /// The name on the command line and in messages: `ply-ascii`.
    pub fn name(self) -> &'static str {
        self.0.name
    }

    /// The name in full: `PLY, text`.
    pub fn title(self) -> &'static str {
        self.0.title
    }

    /// The file endings, without the dot, that mean this format; empty for the second form of an ending.
    pub fn extensions(self) -> &'static [&'static str] {
        self.0.extensions
    }

    /// The file endings that such files have, also those of another form of the format.
    pub fn endings(self) -> &'static [&'static str] {
        self.family().extensions()
    }

    /// What is read of such a file, in words; empty if nothing is.
    pub fn reads(self) -> &'static str {
        self.0.reads
    }

    /// What is written into such a file, in words; empty if nothing is.
    pub fn writes(self) -> &'static str {
        self.0.writes
    }

    /// What of such a file stays as it was when the shape is written in the same format, in words.
    pub fn keeps(self) -> &'static str {
        self.0.keeps
    }

    /// What such a file cannot hold, or what is not read of it, in words.
    pub fn loses(self) -> &'static str {
        self.0.loses
    }

    /// Tells if it can be read.
    pub fn can_read(self) -> bool {
        !self.0.reads.is_empty()
    }

    /// Tells if it can be written.
    pub fn can_write(self) -> bool {
        !self.0.writes.is_empty()
    }

    /// Tells if a file of it has a shape together with any fields of its vertices, by their names.
    pub fn holds_fields(self) -> bool {
        self.0.holds_fields
    }

    /// Tells if it has room for the [`Provenance`](crate::Provenance) of a shape, beside its content.
    pub fn holds_provenance(self) -> bool {
        self.0.provenance == ProvenanceRoom::Metadata
    }

    /// Tells if the [`Provenance`](crate::Provenance) can stand in a comment, beside its content.
    pub fn holds_provenance_comment(self) -> bool {
        matches!(self.0.provenance, ProvenanceRoom::Comment { .. })
    }

    /// Tells if it holds faces, so that a mesh remains one.
    pub fn holds_faces(self) -> bool {
        self.0.content == ContentKind::Mesh
    }

    /// Tells if it holds graphs, without coordinates too.
    pub fn holds_graphs(self) -> bool {
        self.0.content == ContentKind::Graph
    }

    /// The binary or text form that stands for both: `ply` for `ply-ascii`.
    pub(crate) fn family(self) -> Self {
        Self(self.0.form_of.unwrap_or(self.0))
    }

    /// Tells if the ending of a file's name, with or without `.gz` after it, means this format.
    pub(crate) fn matches_name(self, path: &Path) -> bool {
        let Some(name) = path.file_name() else { return false };
        let name = name.to_string_lossy().to_ascii_lowercase();
        let name = name.strip_suffix(".gz").unwrap_or(&name);
        name.rsplit_once('.').is_some_and(|(_, ending)| self.0.extensions.contains(&ending))
    }

    /// Small files of the format, by name, for tests and for the fuzzer.
    #[doc(hidden)]
    pub fn samples(self) -> impl Iterator<Item = (&'static str, &'static [u8])> {
        self.0.samples.iter().map(|sample| (sample.name, sample.bytes))
    }
}

impl PartialEq for Format {
    fn eq(&self, other: &Self) -> bool {
        self.0.name == other.0.name
    }
}

impl Eq for Format {}

impl PartialOrd for Format {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Format {
    /// By name.
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.name.cmp(other.0.name)
    }
}

impl Hash for Format {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.0.name.hash(state);
    }
}

impl fmt::Debug for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.name)
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.name)
    }
}
