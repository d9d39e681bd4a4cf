//! The formats and their names.

mod table;

use adwave::vector::Axis;
use std::fmt;
use std::path::Path;

use table::Row;
use table::TABLE;

/// A format of shapes. Binary and text forms that share a file ending are told apart here.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// Wavefront OBJ.
    Obj,
    /// PLY, binary.
    Ply,
    /// PLY, text.
    PlyAscii,
    /// Object file format with its variants (COFF, NOFF, STOFF, …), text.
    Off,
    /// Object file format, binary.
    OffBinary,
    /// Stereolithography, binary.
    Stl,
    /// Stereolithography, text.
    StlAscii,
    /// Rows of numbers, one a point: XYZ, TXT, ASC.
    Xyz,
    /// Rows of numbers after a count: PTS, PWN.
    Pts,
    /// Comma-separated values with a row of names.
    Csv,
    /// Point Cloud Library, binary.
    Pcd,
    /// Point Cloud Library, text.
    PcdAscii,
    /// Point Cloud Library, compressed.
    PcdCompressed,
    /// LAS, uncompressed.
    Las,
    /// LAS, compressed.
    Laz,
    /// Entwine point tiles: a folder, read only.
    Ept,
    /// MatrixMarket coordinate matrix, read as a weighted graph.
    Mtx,
    /// GIFTI surface.
    Gifti,
    /// ASTM E57, read only.
    E57,
    /// glTF 2.0 as one binary file.
    Glb,
    /// glTF 2.0 as text.
    Gltf,
    /// VTK XML PolyData.
    Vtp,
    /// VTK XML UnstructuredGrid.
    Vtu,
    /// VTK XML ImageData, read as its surface.
    Vti,
    /// VTK XML RectilinearGrid, read as its surface.
    Vtr,
    /// VTK XML StructuredGrid, read as its surface.
    Vts,
    /// Legacy VTK, text and binary.
    Vtk,
    /// FreeSurfer surface.
    FreeSurfer,
    /// Gmsh, binary.
    Msh,
    /// Gmsh, text.
    MshAscii,
    /// Medit of INRIA, text.
    Medit,
    /// Medit of INRIA, binary.
    MeditBinary,
    /// Additive manufacturing file, XML.
    Amf,
    /// 3D manufacturing format, an archive of XML.
    ThreeMf,
    /// Matrix of libigl, text.
    Dmat,
    /// Matrix of libigl, binary.
    DmatBinary,
    /// Trivial graph format.
    Tgf,
    /// List of edges, as SNAP and NetworkX have it.
    EdgeList,
    /// GraphML.
    GraphMl,
    /// Objects of Geomview, read only.
    Geomview,
}

impl Format {
    /// Every format.
    pub fn all() -> impl Iterator<Item = Self> {
        TABLE.iter().map(|row| row.format)
    }

    fn row(self) -> &'static Row {
        TABLE.iter().find(|row| row.format == self).unwrap_or(&TABLE[0])
    }

    /// The name on the command line and in messages: `ply-ascii`.
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// What it is called in full: `PLY, text`.
    pub fn title(self) -> &'static str {
        self.row().title
    }

    /// The format of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        TABLE.iter().find(|row| row.name.eq_ignore_ascii_case(name)).map(|row| row.format)
    }

    /// The file endings, without the dot, that mean this format; empty for the second form of an ending.
    pub fn extensions(self) -> &'static [&'static str] {
        self.row().extensions
    }

    /// The file endings that such files have, also those of another form of the format.
    pub fn endings(self) -> &'static [&'static str] {
        self.family().extensions()
    }

    /// What is read of such a file, in words; empty where nothing is.
    pub fn reads(self) -> &'static str {
        self.row().reads
    }

    /// What is written into such a file, in words; empty where nothing is.
    pub fn writes(self) -> &'static str {
        self.row().writes
    }

    /// What of such a file stays as it was when the shape is written in the same format, in words.
    pub fn keeps(self) -> &'static str {
        self.row().keeps
    }

    /// What such a file cannot hold, or what is not read of it, in words.
    pub fn loses(self) -> &'static str {
        self.row().loses
    }

    /// The format that the file's ending means, with or without `.gz` after it.
    pub fn from_path(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_string_lossy().to_ascii_lowercase();
        let name = name.strip_suffix(".gz").unwrap_or(&name);
        let (_, ending) = name.rsplit_once('.')?;
        TABLE.iter().find(|row| row.extensions.contains(&ending)).map(|row| row.format)
    }

    /// Whether it can be read.
    pub fn can_read(self) -> bool {
        !self.row().reads.is_empty()
    }

    /// Whether it can be written.
    pub fn can_write(self) -> bool {
        !self.row().writes.is_empty()
    }

    /// The axis that points up in files of this format, where all of them agree: z in LAS, LAZ and EPT, whose heights it is, and
    /// in the spaces of GIFTI and FreeSurfer, where it points to the top of the head.
    pub fn up_axis(self) -> Option<Axis> {
        let is_z_up = matches!(self, Self::Las | Self::Laz | Self::Ept | Self::Gifti | Self::FreeSurfer);
        is_z_up.then_some(Axis::Z)
    }

    /// Whether a file of it has a shape together with any fields of its vertices, by their names.
    pub fn holds_fields(self) -> bool {
        let is_cloud =
            matches!(self.family(), Self::Xyz | Self::Pcd | Self::Las | Self::Laz) || self == Self::GraphMl;
        let is_mesh = matches!(
            self.family(),
            Self::Ply | Self::Glb | Self::Gltf | Self::Vtp | Self::Vtu | Self::Vtk | Self::Msh
        );
        is_cloud || is_mesh
    }

    /// Whether it has room for the [`Provenance`](crate::Provenance) of a shape, beside its content.
    pub fn holds_provenance(self) -> bool {
        matches!(self, Self::Glb | Self::Gltf | Self::Vtp | Self::Vtu | Self::Las | Self::Laz)
    }

    /// Whether it holds faces, so that a mesh remains one.
    pub fn holds_faces(self) -> bool {
        let is_cloud = matches!(
            self.family(),
            Self::Xyz
                | Self::Pts
                | Self::Csv
                | Self::Pcd
                | Self::Las
                | Self::Laz
                | Self::Ept
                | Self::E57
                | Self::Dmat
        );
        !is_cloud && !self.holds_graphs()
    }

    /// Whether it holds graphs, without coordinates too.
    pub fn holds_graphs(self) -> bool {
        matches!(self, Self::Mtx | Self::Tgf | Self::EdgeList | Self::GraphMl)
    }

    /// The binary or text form that stands for both: `ply` for `ply-ascii`.
    pub(crate) fn family(self) -> Self {
        match self {
            Self::PlyAscii => Self::Ply,
            Self::OffBinary => Self::Off,
            Self::StlAscii => Self::Stl,
            Self::PcdAscii | Self::PcdCompressed => Self::Pcd,
            Self::MshAscii => Self::Msh,
            Self::DmatBinary => Self::Dmat,
            other => other,
        }
    }

    /// Names of all that can be read, for messages.
    pub(crate) fn readable_names() -> String {
        let own = Self::all().filter(|f| f.can_read() && f.family() == *f);
        own.map(Self::name).collect::<Vec<_>>().join(", ")
    }

    /// Endings of all that can be written, for messages.
    pub(crate) fn writable_names() -> String {
        let first = Self::all().filter(|f| f.can_write()).filter_map(|f| f.extensions().first().copied());
        let endings: Vec<String> = first.map(|ending| format!(".{ending}")).collect();
        format!("{} (each also with .gz)", endings.join(", "))
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
        for row in TABLE {
            let own = row.format.endings().iter();
            let endings = own.map(|e| format!("`.{e}`")).collect::<Vec<_>>().join(" ");
            let endings = if endings.is_empty() { "–".to_owned() } else { endings };
            let cell = |text: &'static str| if text.is_empty() { "–" } else { text };
            let (reads, writes) = (cell(row.reads), cell(row.writes));
            let (keeps, loses) = (cell(row.keeps), cell(row.loses));
            table += &format!("| {} | {endings} | {reads} | {writes} | {keeps} | {loses} |\n", row.title);
        }
        table
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
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
