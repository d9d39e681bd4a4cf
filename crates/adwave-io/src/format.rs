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
    /// LAS, uncompressed.
    Las,
    /// LAS, compressed.
    Laz,
    /// MatrixMarket coordinate matrix, read as a weighted graph.
    Mtx,
    /// GIFTI surface.
    Gifti,
    /// VTK XML PolyData, written only.
    Vtp,
}

/// `(format, name, file endings)`, in the order of the messages.
const TABLE: &[(Format, &str, &[&str])] = &[
    (Format::Obj, "obj", &["obj"]),
    (Format::Ply, "ply", &["ply"]),
    (Format::PlyAscii, "ply-ascii", &[]),
    (Format::Off, "off", &["off", "coff", "noff", "cnoff", "stoff"]),
    (Format::Stl, "stl", &["stl"]),
    (Format::StlAscii, "stl-ascii", &[]),
    (Format::Xyz, "xyz", &["xyz", "txt", "asc", "xyzn", "xyzrgb", "tsv"]),
    (Format::Pts, "pts", &["pts", "pwn"]),
    (Format::Csv, "csv", &["csv"]),
    (Format::Pcd, "pcd", &["pcd"]),
    (Format::PcdAscii, "pcd-ascii", &[]),
    (Format::Las, "las", &["las"]),
    (Format::Laz, "laz", &["laz"]),
    (Format::Mtx, "mtx", &["mtx"]),
    (Format::Gifti, "gifti", &["gii"]),
    (Format::Vtp, "vtp", &["vtp"]),
];

impl Format {
    /// Every format.
    pub fn all() -> impl Iterator<Item = Self> {
        TABLE.iter().map(|row| row.0)
    }

    /// The name on the command line and in messages: `ply-ascii`.
    pub fn name(self) -> &'static str {
        TABLE.iter().find(|row| row.0 == self).map_or("", |row| row.1)
    }

    /// The format of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        TABLE.iter().find(|row| row.1.eq_ignore_ascii_case(name)).map(|row| row.0)
    }

    /// The file endings, without the dot, that mean this format; empty for the second form of an ending.
    pub fn extensions(self) -> &'static [&'static str] {
        TABLE.iter().find(|row| row.0 == self).map_or(&[], |row| row.2)
    }

    /// The format that the file's ending means, with or without `.gz` after it.
    pub fn from_path(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_string_lossy().to_ascii_lowercase();
        let name = name.strip_suffix(".gz").unwrap_or(&name);
        let (_, ending) = name.rsplit_once('.')?;
        TABLE.iter().find(|row| row.2.contains(&ending)).map(|row| row.0)
    }

    /// Whether it can be read.
    pub fn can_read(self) -> bool {
        self != Self::Vtp
    }

    /// The binary or text form that stands for both: `ply` for `ply-ascii`.
    pub(crate) fn family(self) -> Self {
        match self {
            Self::PlyAscii => Self::Ply,
            Self::StlAscii => Self::Stl,
            Self::PcdAscii => Self::Pcd,
            other => other,
        }
    }

    /// Names of all that can be read, for messages.
    pub(crate) fn readable_names() -> String {
        "OBJ, PLY, OFF, STL, XYZ/TXT/PTS/PWN/CSV, PCD, LAS/LAZ, GIFTI, MatrixMarket".into()
    }

    /// Endings of all that can be written, for messages.
    pub(crate) fn writable_names() -> String {
        ".obj, .ply, .off, .stl, .xyz, .pts, .csv, .pcd, .las, .laz, .mtx, .gii, .vtp (each also with .gz)"
            .into()
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
