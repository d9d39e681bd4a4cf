//! Formats by name and by file ending, and what messages and documents say of all of them.

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

    /// The file endings, without the dot, that mean this format; empty for the second form of an ending.
    pub fn extensions(self) -> &'static [&'static str] {
        self.descriptor().extensions
    }

    /// The file endings that such files have, also those of another form of the format.
    pub fn endings(self) -> &'static [&'static str] {
        self.family().extensions()
    }

    /// What is read of such a file, in words; empty if nothing is.
    pub fn reads(self) -> &'static str {
        self.descriptor().reads
    }

    /// What is written into such a file, in words; empty if nothing is.
    pub fn writes(self) -> &'static str {
        self.descriptor().writes
    }

    /// What of such a file stays as it was when the shape is written in the same format, in words.
    pub fn keeps(self) -> &'static str {
        self.descriptor().keeps
    }

    /// What such a file cannot hold, or what is not read of it, in words.
    pub fn loses(self) -> &'static str {
        self.descriptor().loses
    }

    /// Tells if it can be read.
    pub fn can_read(self) -> bool {
        !self.descriptor().reads.is_empty()
    }

    /// Tells if it can be written.
    pub fn can_write(self) -> bool {
        !self.descriptor().writes.is_empty()
    }

    /// Axis that points up in files of this format, if all of them agree: z for the heights of LAS, LAZ and EPT, and for the top of the
    /// head in the spaces of GIFTI and FreeSurfer.
    pub fn up_axis(self) -> Option<Axis> {
        let is_z_up = matches!(self, Self::Las | Self::Laz | Self::Ept | Self::Gifti | Self::FreeSurfer);
        is_z_up.then_some(Axis::Z)
    }

    /// Tells if a file of it has a shape together with any fields of its vertices, by their names.
    pub fn holds_fields(self) -> bool {
        self.descriptor().holds_fields
    }

    /// Tells if it has room for the [`Provenance`](crate::Provenance) of a shape, beside its content.
    pub fn holds_provenance(self) -> bool {
        self.descriptor().provenance == ProvenanceRoom::Metadata
    }

    /// Tells if the [`Provenance`](crate::Provenance) can stand in a comment, beside its content.
    pub fn holds_provenance_comment(self) -> bool {
        matches!(self.descriptor().provenance, ProvenanceRoom::Comment { .. })
    }

    /// Tells if it holds faces, so that a mesh remains one.
    pub fn holds_faces(self) -> bool {
        self.descriptor().content == ContentKind::Mesh
    }

    /// Tells if it holds graphs, without coordinates too.
    pub fn holds_graphs(self) -> bool {
        self.descriptor().content == ContentKind::Graph
    }

    /// The binary or text form that stands for both: `ply` for `ply-ascii`.
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

    /// The format of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::all().find(|format| format.name().eq_ignore_ascii_case(name))
    }

    /// The format that the file's ending means, with or without `.gz` after it.
    pub fn from_path(path: &Path) -> Option<Self> {
        Self::all().find(|format| format.descriptor().matches_name(path))
    }

    /// The table of all formats in Markdown, as it stands in the documents.
    ///
    /// ```
    /// let table = adwave_io::Format::table();
    /// assert!(table.starts_with("| format | endings | read | written | keeps of its own file | does not hold |\n"));
    /// assert_eq!(table.lines().count(), 2 + adwave_io::Format::all().count());
    /// ```
    pub fn table() -> String {
        let mut table =
            String::from("| format | endings | read | written | keeps of its own file | does not hold |\n");
        table += "|---|---|---|---|---|---|\n";
        for format in Self::all() {
            let own = format.endings().iter();
            let endings = own.map(|e| format!("`.{e}`")).collect::<Vec<_>>().join(" ");
            let endings = if endings.is_empty() { "–".to_owned() } else { endings };
            let cell = |text: &'static str| if text.is_empty() { "–" } else { text };
            let (reads, writes) = (cell(format.reads()), cell(format.writes()));
            let (keeps, loses) = (cell(format.keeps()), cell(format.loses()));
            table +=
                &format!("| {} | {endings} | {reads} | {writes} | {keeps} | {loses} |\n", format.title());
        }
        table
    }

    /// The format that a file to be written gets by the ending of its name.
    ///
    /// # Errors
    /// [`WriteError::UnknownFormat`] if the ending means no format.
    pub fn of_output(path: &Path) -> Result<Self, WriteError> {
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
