//! Formats by name and by file ending, and the lists of formats in messages and documents.

use adwave::vector::Axis;
use std::path::Path;
use std::str::FromStr;

use crate::formats::TABLE;
use crate::model::format_descriptor::{ContentKind, FormatDescriptor, ProvenanceRoom};
use crate::{Format, ReadError, WriteError};

impl Format {
    /// The description of the format.
    pub(crate) fn descriptor(self) -> &'static FormatDescriptor {
        let own = TABLE.iter().find(|descriptor| descriptor.format == self);
        own.expect("each constant of `Format` has its row in the table of formats")
    }

    /// The name in full: `PLY, text`.
    pub fn title(self) -> &'static str {
        self.descriptor().title
    }

    /// File extensions, without the dot, that select this format; empty for the second form of an extension.
    pub fn extensions(self) -> &'static [&'static str] {
        self.descriptor().extensions
    }

    /// File extensions of such files, including those of another form of the format.
    pub fn endings(self) -> &'static [&'static str] {
        self.family().extensions()
    }

    /// Description of the content that is read; empty if the format cannot be read.
    pub fn reads(self) -> &'static str {
        self.descriptor().reads
    }

    /// Description of the content that is written; empty if the format cannot be written.
    pub fn writes(self) -> &'static str {
        self.descriptor().writes
    }

    /// Description of the content that stays unchanged when the shape is written in the same format.
    pub fn keeps(self) -> &'static str {
        self.descriptor().keeps
    }

    /// Description of the content that the format cannot store or that is not read.
    pub fn loses(self) -> &'static str {
        self.descriptor().loses
    }

    /// True if files of this format can be read.
    pub fn can_read(self) -> bool {
        !self.descriptor().reads.is_empty()
    }

    /// True if files of this format can be written.
    pub fn can_write(self) -> bool {
        !self.descriptor().writes.is_empty()
    }

    /// Axis that points up in files of this format, if all of them agree: z for the heights of LAS, LAZ and EPT, and
    /// for the top of the head in the spaces of GIFTI and FreeSurfer.
    pub fn up_axis(self) -> Option<Axis> {
        self.descriptor().up_axis
    }

    /// True if points have a classification and flags by which their producer takes them out, as in LAS.
    pub(crate) fn flags_points(self) -> bool {
        self.descriptor().flags_points
    }

    /// True if a file of this format has a shape together with any fields of its vertices, by their names.
    pub fn holds_fields(self) -> bool {
        self.descriptor().holds_fields
    }

    /// True if a file of this format also has any fields of its faces, by their names.
    pub fn holds_face_fields(self) -> bool {
        self.descriptor().holds_face_fields
    }

    /// True if the format has room for the [`Provenance`](crate::Provenance) of a shape, beside its content.
    pub fn holds_provenance(self) -> bool {
        self.descriptor().provenance == ProvenanceRoom::Metadata
    }

    /// True if the [`Provenance`](crate::Provenance) can stand in a comment, beside the content.
    pub fn holds_provenance_comment(self) -> bool {
        matches!(self.descriptor().provenance, ProvenanceRoom::Comment { .. })
    }

    /// True if the format holds faces, so that a mesh remains a mesh.
    pub fn holds_faces(self) -> bool {
        self.descriptor().content == ContentKind::Mesh
    }

    /// True if the format holds graphs, including graphs without coordinates.
    pub fn holds_graphs(self) -> bool {
        self.descriptor().content == ContentKind::Graph
    }

    /// True if the format holds images and volumes: the values of grids, and no shapes.
    pub fn holds_grids(self) -> bool {
        self.descriptor().content == ContentKind::Grid
    }

    /// True if the format holds values of the parts of a brain, and no shapes.
    pub fn holds_brains(self) -> bool {
        self.descriptor().content == ContentKind::Brain
    }

    /// Form that represents both the binary and the text form: `ply` for `ply-ascii`.
    pub(crate) fn family(self) -> Self {
        self.descriptor().form_of.unwrap_or(self)
    }

    /// Small files of the format, by name, for tests and for the fuzzer.
    #[doc(hidden)]
    pub fn samples(self) -> impl Iterator<Item = (&'static str, &'static [u8])> {
        self.descriptor().samples.iter().map(|sample| (sample.name, sample.bytes))
    }

    /// Every format of shapes.
    pub fn all() -> impl Iterator<Item = Self> {
        let shapes = TABLE.iter().filter(|format| format.content != ContentKind::Values);
        shapes.map(|descriptor| descriptor.format)
    }

    /// Finds a format by its name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::all().find(|format| format.name().eq_ignore_ascii_case(name))
    }

    /// Finds the format by the file's extension, with or without a following `.gz`.
    pub fn from_path(path: &Path) -> Option<Self> {
        Self::all().find(|format| format.descriptor().matches_name(path))
    }

    /// Finds the format of an image or a volume by the file's extension, with or without a following `.gz`. Some
    /// extensions mean another format for shapes: `.asc` is an ESRI grid here, and points for [`from_path`].
    ///
    /// ```
    /// use adwave_io::Format;
    /// assert_eq!(Format::grid_from_path("dem.asc".as_ref()), Some(Format::ESRI_GRID));
    /// assert_eq!(Format::grid_from_path("bunny.ply".as_ref()), None);
    /// ```
    ///
    /// [`from_path`]: Self::from_path
    pub fn grid_from_path(path: &Path) -> Option<Self> {
        let own = TABLE.iter().find(|descriptor| descriptor.matches_grid_name(path));
        own.map(|descriptor| descriptor.format)
    }

    /// All formats in Markdown, with their extensions and the content read, written, kept and lost: a section of
    /// `docs/FORMATS.md`.
    ///
    /// ```
    /// let list = adwave_io::Format::markdown_list();
    /// assert!(list.starts_with("### Wavefront OBJ (`.obj`)\n\n* Read: points, faces, lines"));
    /// assert_eq!(list.matches("### ").count(), adwave_io::Format::all().count());
    /// assert!(list.lines().all(|line| line.chars().count() <= 120));
    /// ```
    pub fn markdown_list() -> String {
        let mut sections = Vec::new();
        for format in Self::all() {
            let endings: Vec<String> = format.endings().iter().map(|e| format!("`.{e}`")).collect();
            let endings =
                if endings.is_empty() { String::new() } else { format!(" ({})", endings.join(", ")) };
            let parts = [
                ("Read", format.reads()),
                ("Written", format.writes()),
                ("Kept of its own file", format.keeps()),
                ("Not held", format.loses()),
            ];
            let items: String = parts
                .iter()
                .filter(|(_, text)| !text.is_empty())
                .map(|(head, text)| list_item(head, text))
                .collect();
            sections.push(format!("### {}{endings}\n\n{items}", format.title()));
        }
        sections.join("\n")
    }

    /// The format that a file to be written gets by the ending of its name.
    ///
    /// # Errors
    /// [`WriteError::UnknownFormat`] if the ending means no format.
    pub fn from_output_path(path: &Path) -> Result<Self, WriteError> {
        Self::from_path(path).ok_or_else(unknown_ending)
    }
}

impl FromStr for Format {
    type Err = ReadError;

    /// The format of that name.
    fn from_str(name: &str) -> Result<Self, ReadError> {
        Self::from_name(name).ok_or_else(|| unknown_content(format!("no format is named {name}")))
    }
}

/// `* Head: text.`, in lines of at most 118 characters.
fn list_item(head: &str, text: &str) -> String {
    const WIDTH: usize = 118;
    let mut item = format!("* {head}:");
    let mut length = item.chars().count();
    for word in text.split(' ') {
        let n_chars = word.chars().count();
        if length + 1 + n_chars > WIDTH {
            item += "\n  ";
            length = 2;
        } else {
            item.push(' ');
            length += 1;
        }
        item += word;
        length += n_chars;
    }
    item + ".\n"
}

/// The error of content that is of no format, with the formats that can be read.
pub(crate) fn unknown_content(found: impl Into<String>) -> ReadError {
    let readable = Format::all().filter(|format| format.can_read() && format.family() == *format);
    let readable = readable.map(Format::name).collect::<Vec<_>>().join(", ");
    ReadError::UnknownFormat { found: found.into(), readable }
}

/// The error of a name without an ending that means a format, with the endings that can be written.
pub(crate) fn unknown_ending() -> WriteError {
    let first = Format::all().filter(|f| f.can_write()).filter_map(|f| f.extensions().first().copied());
    let endings: Vec<String> = first.map(|ending| format!(".{ending}")).collect();
    WriteError::UnknownFormat { writable: format!("{} (each also with .gz)", endings.join(", ")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_endings_lead_back() {
        for format in Format::all() {
            assert_eq!(Format::from_name(format.name()), Some(format));
            for ending in format.extensions() {
                assert_eq!(Format::from_path(Path::new(&format!("a/B.{ending}"))), Some(format));
                assert_eq!(Format::from_path(Path::new(&format!("b.{ending}.GZ"))), Some(format));
            }
        }
        assert_eq!(Format::from_path(Path::new("shape")), None);
        assert_eq!(Format::from_path(Path::new("shape.blend")), None);
    }
}
