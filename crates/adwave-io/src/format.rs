//! The formats and their names.

use std::fmt;
use std::path::Path;

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

/// One row of the table of formats: the source of names, endings, messages and documents.
struct Row {
    format: Format,
    name: &'static str,
    title: &'static str,
    /// Without the dot; empty for the second form of an ending.
    extensions: &'static [&'static str],
    /// What is read; empty where nothing is.
    reads: &'static str,
    /// What is written; empty where nothing is.
    writes: &'static str,
    /// What stays as it was when a file is written in the format that it was read from.
    keeps: &'static str,
    /// What the format cannot hold, or what is not read of it.
    loses: &'static str,
}

/// In the order of the messages. Forms of one ending stand together, the one that its name means first.
const TABLE: &[Row] = &[
    Row {
        format: Format::Obj,
        name: "obj",
        title: "Wavefront OBJ",
        extensions: &["obj"],
        reads: "points, faces, lines, texture coordinates, normals, vertex colours",
        writes: "the same",
        keeps: "all text but coordinates and normals that moved",
        loses: "fields other than normals, colours and texture coordinates; curved surfaces",
    },
    Row {
        format: Format::Ply,
        name: "ply",
        title: "PLY, binary",
        extensions: &["ply"],
        reads: "all elements and properties, both byte orders",
        writes: "all fields",
        keeps: "header, elements, properties, byte order",
        loses: "",
    },
    Row {
        format: Format::PlyAscii,
        name: "ply-ascii",
        title: "PLY, text",
        extensions: &[],
        reads: "all elements and properties",
        writes: "all fields",
        keeps: "header, elements, properties",
        loses: "",
    },
    Row {
        format: Format::Off,
        name: "off",
        title: "Object file format, text",
        extensions: &["off", "coff", "noff", "cnoff", "stoff"],
        reads: "OFF, COFF, NOFF, STOFF, nOFF and their mixtures, by lines or by words; 4OFF divided by the fourth coordinate",
        writes: "points, faces, colours, normals, texture coordinates",
        keeps: "all text but coordinates that moved",
        loses: "other fields",
    },
    Row {
        format: Format::OffBinary,
        name: "off-binary",
        title: "Object file format, binary",
        extensions: &[],
        reads: "big-endian, as Geomview has it, with the same variants",
        writes: "points in 32-bit floats, faces, fields of 32-bit floats that it has",
        keeps: "all bytes but coordinates that moved",
        loses: "other fields",
    },
    Row {
        format: Format::Stl,
        name: "stl",
        title: "Stereolithography, binary",
        extensions: &["stl"],
        reads: "triangles, normals, attributes",
        writes: "triangles in 32-bit floats",
        keeps: "header, attributes, normals of triangles that did not move",
        loses: "which triangles share a vertex (found again by equal coordinates), vertex fields",
    },
    Row {
        format: Format::StlAscii,
        name: "stl-ascii",
        title: "Stereolithography, text",
        extensions: &[],
        reads: "triangles, normals, solids",
        writes: "triangles, solids",
        keeps: "names of solids, normals of triangles that did not move",
        loses: "which triangles share a vertex, other fields",
    },
    Row {
        format: Format::Xyz,
        name: "xyz",
        title: "rows of numbers, one a point",
        extensions: &["xyz", "txt", "asc", "xyzn", "xyzrgb", "tsv"],
        reads: "points and columns, with a row of names or without",
        writes: "points and fields",
        keeps: "all text but coordinates that moved",
        loses: "faces",
    },
    Row {
        format: Format::Pts,
        name: "pts",
        title: "rows of numbers after a count",
        extensions: &["pts", "pwn"],
        reads: "points and columns",
        writes: "points, intensity, colours",
        keeps: "all text but coordinates that moved",
        loses: "faces",
    },
    Row {
        format: Format::Csv,
        name: "csv",
        title: "comma-separated values with a row of names",
        extensions: &["csv"],
        reads: "points and columns",
        writes: "points and fields",
        keeps: "all text but coordinates that moved",
        loses: "faces",
    },
    Row {
        format: Format::Pcd,
        name: "pcd",
        title: "Point Cloud Library, binary",
        extensions: &["pcd"],
        reads: "points and fields; points without a place are left out",
        writes: "points and fields",
        keeps: "view point, width and height, points without a place",
        loses: "faces",
    },
    Row {
        format: Format::PcdAscii,
        name: "pcd-ascii",
        title: "Point Cloud Library, text",
        extensions: &[],
        reads: "points and fields",
        writes: "points and fields",
        keeps: "all text but coordinates that moved",
        loses: "faces",
    },
    Row {
        format: Format::PcdCompressed,
        name: "pcd-compressed",
        title: "Point Cloud Library, compressed",
        extensions: &[],
        reads: "as binary",
        writes: "points and fields",
        keeps: "view point, width and height, points without a place",
        loses: "faces",
    },
    Row {
        format: Format::Las,
        name: "las",
        title: "LAS, uncompressed",
        extensions: &["las"],
        reads: "versions 1.0 to 1.4, all dimensions, extra bytes",
        writes: "all dimensions, fields as extra bytes",
        keeps: "header, records, what no field shows",
        loses: "faces",
    },
    Row {
        format: Format::Laz,
        name: "laz",
        title: "LAS, compressed",
        extensions: &["laz"],
        reads: "as LAS, also COPC",
        writes: "as LAS",
        keeps: "header, records, what no field shows",
        loses: "faces",
    },
    Row {
        format: Format::Mtx,
        name: "mtx",
        title: "MatrixMarket",
        extensions: &["mtx"],
        reads: "coordinate matrices as weighted graphs",
        writes: "edges with weights",
        keeps: "",
        loses: "points, faces, fields",
    },
    Row {
        format: Format::Gifti,
        name: "gifti",
        title: "GIFTI",
        extensions: &["gii"],
        reads: "surfaces with their fields; fields alone with `--field`",
        writes: "surfaces and fields in 32-bit floats",
        keeps: "metadata, encodings, all other text",
        loses: "faces of more than three corners",
    },
    Row {
        format: Format::E57,
        name: "e57",
        title: "ASTM E57",
        extensions: &["e57"],
        reads: "all scans where their poses put them, in Cartesian or spherical coordinates, with all their records",
        writes: "",
        keeps: "",
        loses: "records without a place, pictures",
    },
    Row {
        format: Format::Glb,
        name: "glb",
        title: "glTF 2.0, binary",
        extensions: &["glb", "vrm"],
        reads: "meshes, lines and points where the scene's nodes put them, all attributes, sparse and quantised ones too",
        writes: "triangles, lines, points and fields in 32-bit floats and whole numbers up to 16 bits",
        keeps: "materials, pictures, nodes, animations, all else; only positions and fields that changed are replaced",
        loses: "polygons (cut into triangles), face fields, weights of edges; compression by Draco or meshopt is not read",
    },
    Row {
        format: Format::Gltf,
        name: "gltf",
        title: "glTF 2.0, text",
        extensions: &["gltf"],
        reads: "as GLB; buffers in the text or beside the file",
        writes: "as GLB, with buffers and pictures in the text",
        keeps: "as GLB",
        loses: "as GLB",
    },
    Row {
        format: Format::Vtp,
        name: "vtp",
        title: "VTK XML PolyData",
        extensions: &["vtp"],
        reads: "points, polygons, strips, lines, all arrays; text, base64 and appended data, by zlib or plain",
        writes: "points, faces, lines, all fields",
        keeps: "",
        loses: "field data, values of lines",
    },
    Row {
        format: Format::Vtu,
        name: "vtu",
        title: "VTK XML UnstructuredGrid",
        extensions: &["vtu"],
        reads: "as VTP; of volumes the boundary, cells of higher order by their corners",
        writes: "points, faces, lines, all fields",
        keeps: "",
        loses: "volumes and the points inside them, field data, values of lines",
    },
    Row {
        format: Format::Vti,
        name: "vti",
        title: "VTK XML ImageData",
        extensions: &["vti"],
        reads: "flat images as quadrilaterals, others as their boundary, with all arrays",
        writes: "",
        keeps: "",
        loses: "what is inside",
    },
    Row {
        format: Format::Vtr,
        name: "vtr",
        title: "VTK XML RectilinearGrid",
        extensions: &["vtr"],
        reads: "as VTI",
        writes: "",
        keeps: "",
        loses: "what is inside",
    },
    Row {
        format: Format::Vts,
        name: "vts",
        title: "VTK XML StructuredGrid",
        extensions: &["vts"],
        reads: "as VTI",
        writes: "",
        keeps: "",
        loses: "what is inside",
    },
    Row {
        format: Format::Vtk,
        name: "vtk",
        title: "legacy VTK",
        extensions: &["vtk"],
        reads: "text and binary up to version 5.1, all that VTP, VTU, VTI, VTR and VTS hold",
        writes: "points, faces, lines, all fields, binary",
        keeps: "",
        loses: "what is inside volumes, field data, tables of colours, values of lines",
    },
    Row {
        format: Format::FreeSurfer,
        name: "freesurfer",
        title: "FreeSurfer surface",
        extensions: &["white", "pial", "inflated", "sphere", "orig", "smoothwm"],
        reads: "triangles and both forms of quadrangles; values alone (curv, annot, MGH, MGZ) with `--field`",
        writes: "triangles in 32-bit floats",
        keeps: "creator, volume information",
        loses: "fields, faces of more than three corners",
    },
    Row {
        format: Format::Msh,
        name: "msh",
        title: "Gmsh, binary",
        extensions: &["msh"],
        reads: "versions 2 and 4, both byte orders: triangles, quadrilaterals, higher orders by their corners, else the boundary of \
                volume cells, else lines; tags and fields",
        writes: "version 2.2 with all fields",
        keeps: "all sections, cells and bytes but coordinates that moved and fields that changed",
        loses: "polygons of more than four corners, edges beside faces",
    },
    Row {
        format: Format::MshAscii,
        name: "msh-ascii",
        title: "Gmsh, text",
        extensions: &[],
        reads: "as binary",
        writes: "version 2.2 with all fields",
        keeps: "all text but coordinates that moved and fields that changed",
        loses: "as binary",
    },
    Row {
        format: Format::Medit,
        name: "medit",
        title: "Medit, text",
        extensions: &["mesh"],
        reads: "triangles, quadrilaterals, else the boundary of volume cells, else edges; references",
        writes: "points, triangles, quadrilaterals or edges, references",
        keeps: "all text but coordinates that moved",
        loses: "other fields, polygons of more than four corners, the order of triangles among quadrilaterals",
    },
    Row {
        format: Format::MeditBinary,
        name: "meshb",
        title: "Medit, binary",
        extensions: &["meshb"],
        reads: "versions 1 to 4, both byte orders, as text",
        writes: "as text",
        keeps: "all bytes but coordinates that moved",
        loses: "as text",
    },
    Row {
        format: Format::Amf,
        name: "amf",
        title: "Additive manufacturing file",
        extensions: &["amf"],
        reads: "objects placed by constellations, plain or zipped; colours of vertices, triangles, volumes and materials",
        writes: "one object of triangles, colours of vertices and faces",
        keeps: "",
        loses: "other fields, metadata, materials, the unit of length",
    },
    Row {
        format: Format::ThreeMf,
        name: "3mf",
        title: "3D manufacturing format",
        extensions: &["3mf"],
        reads: "what is built, with components of all parts, transforms and units; colours of vertices or faces",
        writes: "one object of triangles, colours of vertices or faces in bytes",
        keeps: "",
        loses: "other fields, metadata, materials, textures, the unit of length",
    },
    Row {
        format: Format::Dmat,
        name: "dmat",
        title: "DMAT of libigl, text",
        extensions: &["dmat"],
        reads: "matrices of three columns as points, others with `--field`",
        writes: "points",
        keeps: "",
        loses: "faces, fields",
    },
    Row {
        format: Format::DmatBinary,
        name: "dmat-binary",
        title: "DMAT of libigl, binary",
        extensions: &[],
        reads: "as text",
        writes: "points",
        keeps: "",
        loses: "faces, fields",
    },
    Row {
        format: Format::Tgf,
        name: "tgf",
        title: "Trivial graph format",
        extensions: &["tgf"],
        reads: "graphs; labels of three numbers as points, of edges as weights",
        writes: "points, edges with weights",
        keeps: "",
        loses: "faces, fields, other labels",
    },
    Row {
        format: Format::EdgeList,
        name: "edgelist",
        title: "list of edges",
        extensions: &["edgelist", "edges", "el"],
        reads: "graphs, as SNAP and NetworkX write them; weights",
        writes: "edges with weights",
        keeps: "",
        loses: "points, faces, fields, names",
    },
    Row {
        format: Format::GraphMl,
        name: "graphml",
        title: "GraphML",
        extensions: &["graphml"],
        reads: "graphs; points from `x`, `y`, `z` or `pos`, weights, numbers of nodes as fields",
        writes: "points, edges with weights, vertex fields",
        keeps: "",
        loses: "faces, texts of nodes, other attributes of edges",
    },
    Row {
        format: Format::Geomview,
        name: "geomview",
        title: "Geomview",
        extensions: &["oogl", "list", "quad", "vect", "skel"],
        reads: "MESH grids, QUAD, VECT, SKEL, OFF, and lists of these; normals, colours; the fourth coordinate divides",
        writes: "",
        keeps: "",
        loses: "appearance, transforms, curved surfaces",
    },
];

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
            Self::Xyz | Self::Pts | Self::Csv | Self::Pcd | Self::Las | Self::Laz | Self::E57 | Self::Dmat
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
