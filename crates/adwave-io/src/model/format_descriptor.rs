//! The description that each format's folder gives of itself.

use std::path::Path;

use adwave::vector::Axis;

use crate::model::context::{ReadContext, WriteContext};
use crate::model::file_head::FileHead;
use crate::model::texture::TextureFn;
use crate::model::units::UnitRoom;
use crate::{Field, Format, ReadError, ReadLimits, ShapeFile, WriteError};

/// Kind of content that files of a format hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ContentKind {
    /// Points with faces or lines; regular grids are read as their surface.
    Mesh,
    /// Points alone.
    Cloud,
    /// Edges, with or without points.
    Graph,
    /// Values at the places of a regular grid: images and volumes.
    Grid,
    /// Values of the parts of a brain: of surfaces in other files, and of voxels.
    Brain,
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

/// Number type in which coordinates are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CoordinateType {
    /// 64-bit floats, text, or integers with a scale.
    Double,
    /// 32-bit floats.
    Single,
    /// The number type of the shape.
    OfShape,
}

/// Confidence that bytes are of a format, lowest first. The greatest one decides, among equals the order of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Evidence {
    /// The first lines are rows of numbers.
    Numbers,
    /// The ending of the name is that of the format, and the content does not speak against it.
    Name,
    /// The first word is a statement of the format.
    Statement,
    /// The first lines follow the layout of the format. Evidence from here on outweighs the signature of a kind of file
    /// that is known but not read.
    Layout,
    /// The ending of the name is that of the format, and any content is possible.
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
pub(crate) struct SampleFile {
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

/// Reader of a file as a mask of the vertices of a surface.
pub(crate) type ReadMaskFn = fn(&[u8], &MaskRequest<'_>, &ReadContext<'_>) -> Result<VertexMask, ReadError>;

/// Reader of the fields in a file, without a shape.
pub(crate) type ReadFieldsFn = fn(&Path, &ReadLimits) -> Result<Vec<Field>, ReadError>;

/// The surface that values are read for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfaceSize<'a> {
    /// Part of the anatomy, such as `CortexLeft`.
    pub(crate) structure: Option<&'a str>,
    pub(crate) n_vertices: usize,
}

/// New values for a file of values, whose other content stays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ValuesEdit<'a> {
    pub(crate) size: SurfaceSize<'a>,
    /// Values of all columns of the file, in its order.
    pub(crate) field: &'a Field,
    /// Path of the new file, whose name selects its kind.
    pub(crate) path: &'a Path,
}

/// Bytes of a file of values with new numbers; `None` if these do not fit the file.
pub(crate) type RewriteValuesFn = fn(&[u8], &ValuesEdit<'_>) -> Result<Option<Vec<u8>>, WriteError>;
/// The surface that a mask is read for, and the parts of the file that are asked for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MaskRequest<'a> {
    /// Name of the file, whose words may describe its list.
    pub(crate) name: &'a str,
    /// Names of regions, with commas between them; `None` for the usual meaning of the file.
    pub(crate) regions: Option<&'a str>,
    pub(crate) n_vertices: usize,
}

/// Vertices that take part according to a file that names them.
#[derive(Clone, Debug)]
pub(crate) struct VertexMask {
    /// One entry per vertex.
    pub(crate) takes_part: Vec<bool>,
    /// Clause that says what was assumed.
    pub(crate) meaning: String,
}

/// Everything that other modules know about a format: the source of names, endings, messages, documents and dispatch.
///
/// A format's folder ends in its descriptors, each of which begins with `..FormatDescriptor::NEW`.
#[expect(clippy::struct_excessive_bools, reason = "each is a fact about the format")]
pub(crate) struct FormatDescriptor {
    pub(crate) format: Format,
    /// Name in full: `PLY, text`.
    pub(crate) title: &'static str,
    /// File endings without the dot; empty for the second form of an ending.
    pub(crate) extensions: &'static [&'static str],
    /// File endings that mean this format for a grid, and a format of shapes for shapes.
    pub(crate) shared_extensions: &'static [&'static str],
    /// Endings of the whole name, such as `.dscalar.nii`, that mean another kind of file.
    pub(crate) foreign_endings: &'static [&'static str],
    /// The format whose ending this one shares, if it is the second form of it.
    pub(crate) form_of: Option<Format>,
    pub(crate) content: ContentKind,
    /// Description of the content that is read; empty if the format cannot be read.
    pub(crate) reads: &'static str,
    /// Description of the content that is written; empty if the format cannot be written.
    pub(crate) writes: &'static str,
    /// Description of the content that stays unchanged when a file is written in its own format.
    pub(crate) keeps: &'static str,
    /// Description of the content that the format cannot store or that is not read.
    pub(crate) loses: &'static str,
    /// A file has a shape together with any fields of its vertices, by their names.
    pub(crate) holds_fields: bool,
    /// A file also has any fields of its faces, by their names.
    pub(crate) holds_face_fields: bool,
    /// Names of vertices are written, or reported by the writer.
    pub(crate) holds_names: bool,
    /// Points without a position are written, as NaN, so that rows keep their numbers.
    pub(crate) holds_missing: bool,
    /// A file also has values of its own, by their names, that belong to no vertex.
    pub(crate) holds_field_data: bool,
    /// Texture coordinates of face corners are written.
    pub(crate) holds_corner_texcoords: bool,
    /// Readers of the format expect colors in bytes.
    pub(crate) has_byte_colors: bool,
    /// Number type in which coordinates are written.
    pub(crate) coordinates: CoordinateType,
    pub(crate) unit: UnitRoom,
    /// Points have a classification and flags by which their producer takes them out: LAS and its relatives.
    pub(crate) flags_points: bool,
    /// Axis that points up in all files of the format, if they agree.
    pub(crate) up_axis: Option<Axis>,
    pub(crate) provenance: ProvenanceRoom,
    /// Evidence that a file is of this format. Of two forms of an ending only the first is asked.
    pub(crate) recognize: fn(&FileHead<'_>) -> Option<Evidence>,
    /// Name of a related kind of file that is not read as a shape, for the message.
    pub(crate) name_foreign: fn(&FileHead<'_>) -> Option<&'static str>,
    /// True if the bytes are text in lines, whose line ends may be those of the old Macintosh.
    pub(crate) has_lines: fn(&[u8]) -> bool,
    pub(crate) read: Option<ReadFn>,
    pub(crate) read_folder: Option<ReadFolderFn>,
    pub(crate) read_values: Option<ReadValuesFn>,
    /// Reader of a mask, for files that name vertices instead of having a number for each.
    pub(crate) read_mask: Option<ReadMaskFn>,
    /// Reader of the fields in a file with an ending of the format, without a shape.
    pub(crate) read_fields: Option<ReadFieldsFn>,
    pub(crate) rewrite_values: Option<RewriteValuesFn>,
    pub(crate) write: Option<WriteFn>,
    /// Colors of the pictures that a file names, at the vertices.
    pub(crate) texture: Option<TextureFn>,
    pub(crate) samples: &'static [SampleFile],
}

impl FormatDescriptor {
    /// A mesh format that can do nothing yet.
    pub(crate) const NEW: Self = Self {
        format: Format::new(""),
        title: "",
        extensions: &[],
        shared_extensions: &[],
        foreign_endings: &[],
        form_of: None,
        content: ContentKind::Mesh,
        reads: "",
        writes: "",
        keeps: "",
        loses: "",
        holds_fields: false,
        holds_face_fields: false,
        holds_names: false,
        holds_missing: false,
        holds_field_data: false,
        holds_corner_texcoords: false,
        has_byte_colors: false,
        coordinates: CoordinateType::Double,
        unit: UnitRoom::None,
        flags_points: false,
        up_axis: None,
        provenance: ProvenanceRoom::None,
        recognize: |_| None,
        name_foreign: |_| None,
        has_lines: |_| false,
        read: None,
        read_folder: None,
        read_values: None,
        read_mask: None,
        read_fields: None,
        rewrite_values: None,
        write: None,
        texture: None,
        samples: &[],
    };

    /// True if the ending of a file's name, with or without `.gz` after it, means this format.
    pub(crate) fn matches_name(&self, path: &Path) -> bool {
        self.matches_ending(path, |ending| self.extensions.contains(&ending))
    }

    /// True if the ending of the name of a grid means this format.
    pub(crate) fn matches_grid_name(&self, path: &Path) -> bool {
        let is_own =
            |ending: &str| self.extensions.contains(&ending) || self.shared_extensions.contains(&ending);
        self.content == ContentKind::Grid && self.matches_ending(path, is_own)
    }

    fn matches_ending(&self, path: &Path, is_own: impl Fn(&str) -> bool) -> bool {
        let Some(name) = path.file_name() else { return false };
        let name = name.to_string_lossy().to_ascii_lowercase();
        let name = name.strip_suffix(".gz").unwrap_or(&name);
        name.match_indices('.').any(|(dot, _)| is_own(&name[dot + 1..]))
            && !self.foreign_endings.iter().any(|ending| name.ends_with(ending))
    }
}
