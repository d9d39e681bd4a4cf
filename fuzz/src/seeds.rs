//! Seeds of the fuzzer: small files of every format from our own writers, and handwritten ones for content that these
//! do not write. `cargo run -p adwave-fuzz -- --write-seeds` writes them below `fuzz/seeds/`.

use crate::copc_file::copc;
use adwave::shape::Polygons;
use adwave_io::{
    ArrayValues, CoordinatePrecision, Direction, Edges, Field, FieldValues, Format, GRID_VALUES, GridLayout,
    ShapeFile, write_bytes, write_npy,
};
use base64::Engine;
use std::error::Error;
use std::io::{Cursor, Write};
use std::path::Path;

type SeedOutcome<T> = Result<T, Box<dyn Error>>;

/// Text seeds: folder, name, content.
const TEXTS: &[(&str, &str, &str)] = &[
    (
        "obj",
        "corners",
        "o a\nmtllib a.mtl\nv 0 0 0\nv 1 0 0 1\nv 0 1 0\nvt 0 0\nvt 1 0\nvn 0 0 1\ng b\nusemtl c\nf 1/1/1 2/2/1 3//1\nf -1 -2 \\\n -3\nl 1 2 3\np 1\ns off\n",
    ),
    (
        "obj",
        "colors",
        "\u{feff}# c \\\nv 0 0 0 0.5 0.5 1\r\nv 1 0 0 1 0 0\r\nv 0 1e0 -.5 0 0 0\r\nf 1 2 3\r\n",
    ),
    (
        "ply",
        "strips",
        "ply\nformat ascii 1.0\ncomment c\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty list uchar int more\nelement tristrips 1\nproperty list int int vertex_indices\nelement edge 1\nproperty int vertex1\nproperty int vertex2\nproperty uchar red\nelement other 1\nproperty double a\nend_header\n0 0 0 0\n1 0 0 1 5\n0 1 0 0\n1 1 0 2 1 2\n6 0 1 2 -1 1 2\n0 1 255\n3.5\n",
    ),
    (
        "off",
        "coff",
        "COFF\n# c\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 0 255 0 255\n0 1 0 0 0 255 255\n3 0 1 2 128 128 128\n",
    ),
    ("off", "stoff", "STNOFF 3 1 0\n0 0 0 0 0 1 0 0\n1 0 0 0 0 1 1 0\n0 1 0 0 0 1 0 1\n3 0 1 2 7\n"),
    (
        "stl",
        "solids",
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\nsolid b\nfacet\nouter loop\nvertex 0 0 1\nvertex 1 0 1\nvertex 0 1 1\nendloop\nendfacet\nendsolid b\n",
    ),
    ("xyz", "named", "# x y z nx ny nz quality\n0 0 0 0 0 1 0.5\n1 0 0 0 1 0 nan\n0 1 0 1 0 0 1.#IND\n"),
    ("xyz", "plain", "0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 255\n"),
    ("xyz", "old", "0 0 0\r1 0 0\r0 1 0\r"),
    ("pts", "count", "3\n0 0 0 -5 1 2 3\n1 0 0 7 4 5 6\n0 1 0 8 7 8 9\n"),
    ("pts", "normals", "2\n0 0 0\n1 0 0\n0 0 1\n0 1 0\n"),
    ("csv", "points", "y;x;z;red;green;blue;label\n0;1;2;1;2;3;a\n"),
    ("csv", "numbers", "x,y,z,\"a, b\"\n0,1,2,\n1,2,3,NA\n"),
    (
        "pcd",
        "text",
        "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb hist\nSIZE 4 4 8 4 2\nTYPE F F F U I\nCOUNT 1 1 1 1 2\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ascii\n0 0 0 255 1 2\n1 0 nan 65280 3 4\n",
    ),
    (
        "mtx",
        "general",
        "%%MatrixMarket matrix coordinate real general\n% c\n3 3 3\n1 2 0.5\n2 1 0.5\n3 3 1\n",
    ),
    ("mtx", "pattern", "%%MatrixMarket matrix coordinate pattern symmetric\n3 3 2\n2 1\n3 2\n"),
    (
        "materials",
        "two",
        "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 3/1 2/2 1/3\n|newmtl a\nmap_Kd -s 1 1 1 a.png\nnewmtl b\nKd 1 0 0\nmap_Kd a.png\n",
    ),
    ("off", "words", "OFF 3 1 0 0 0 0 1 0 0\n0 1 0 3\n0 1 # c\n2"),
    ("off", "dimension", "4OFF\n2 0 0\n2 4 6 2\n1 1 1 1\n"),
    ("obj", "plane", "v 0 0\nv 1 0\nv 0 1\nl 1 2 3\n"),
    (
        "pcd",
        "missing",
        "version .7\nfields X Y Z\nWIDTH 3\nHEIGHT 1\nDATA ascii\n0 0 0\nnan nan nan\n1 0 0\n",
    ),
    (
        "msh",
        "two",
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n20 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n3\n1 1 2 0 1 1 20\n2 4 2 7 1 1 20 3 4\n3 2 2 7 2 1 20 3\n$EndElements\n$NodeData\n1\n\"a\"\n1\n0\n3\n0\n1\n1\n3 0.5\n$EndNodeData\n",
    ),
    (
        "msh",
        "four",
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n1 0 0 0 1 1 1 1 5 0\n$EndEntities\n$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n$ElementData\n1\n\"b\"\n0\n3\n0\n2\n1\n1 1 2\n$EndElementData\n",
    ),
    (
        "medit",
        "all",
        "MeshVersionFormatted 2\nDimension 3\nVertices 5\n0 0 0 1\n1 0 0 1\n1 1 0 1\n0 1 0 1\n0 0 1 2\nTriangles 1\n1 2 5 7\nQuadrilaterals 1\n1 2 3 4 9\nTetrahedra 1\n1 2 3 5 0\nEnd\n",
    ),
    ("medit", "flat", "MeshVersionFormatted 1 Dimension 2 Vertices 3 0 0 0 1 0 0 0 1 0 Edges 1 1 2 0"),
    (
        "amf",
        "placed",
        "<amf><object id=\"1\"><mesh><vertices><vertex><coordinates><x>0</x><y>0</y><z>0</z></coordinates><color><r>1</r><g>0</g><b>0</b></color></vertex><vertex><coordinates><x>1</x><y>0</y><z>0</z></coordinates></vertex><vertex><coordinates><x>0</x><y>1</y><z>0</z></coordinates></vertex></vertices><volume><triangle><v1>0</v1><v2>1</v2><v3>2</v3></triangle></volume></mesh></object><constellation id=\"2\"><instance objectid=\"1\"><deltax>1</deltax><rz>90</rz></instance></constellation></amf>",
    ),
    ("dmat", "cloud", "3 2\n0\n1\n2\n3\n4\n5\n"),
    ("tgf", "places", "a 0 0 0\nb 1 0 0\n#\na b 0.5\n"),
    ("tgf", "names", "1 a\n2\n#\n1 2 likes\n#\n3\n"),
    ("edgelist", "snap", "# Nodes: 4 Edges: 2\n0\t1\n3\t1\n"),
    ("edgelist", "networkx", "a b {'weight': 0.5}\nb c {}\n"),
    (
        "graphml",
        "all",
        "<graphml><key id=\"x\" for=\"node\" attr.name=\"pos\" attr.type=\"string\"/><key id=\"w\" for=\"edge\" attr.name=\"weight\" attr.type=\"double\"/><key id=\"a\" for=\"node\" attr.name=\"age\" attr.type=\"int\"><default>1</default></key><graph edgedefault=\"directed\"><node id=\"1\"><data key=\"x\">[0, 1]</data><data key=\"a\">3</data></node><node id=\"2\"><data key=\"x\">1 2 3</data></node><edge source=\"1\" target=\"2\"><data key=\"w\">2</data></edge></graph></graphml>",
    ),
    ("geomview", "grid", "4uvMESH\n2 2\n0 0 0 1\n2 0 0 2\n0 1 0 1\n1 1 0 1\n"),
    (
        "geomview",
        "list",
        "{ LIST { appearance { a } { = CNMESH 1 2 0 0 0 0 0 1 1 0 0 1 1 0 0 0 0 1 1 0 0 1 } } { OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n} { QUAD 0 0 0 1 0 0 1 1 0 0 1 0 } { SKEL 2 1 0 0 0 1 1 1 2 0 1 } { VECT 1 2 0 2 0 0 0 0 1 1 1 } }",
    ),
    (
        "recipe",
        "levels",
        "levels = 4\nfield = 'coords'\n[[layer]]\npreset = 'suppress'\nregion = 'ball:vertex=3,radius=5%'\n",
    ),
    (
        "recipe",
        "steps",
        "steps = [1, 2.5, 9]\n[[layer]]\ngains = [3.0, 2.0, 1.0]\nregion.half-space = { point = [0.0, 0.0, 0.0], normal = [1.0, 0.0, 0.0] }\n[[layer]]\npreset = 'enhance'\n",
    ),
    (
        "recipe",
        "lengths",
        "lengths = [0.01, 0.02]\n[[layer]]\ngains = [0, 1]\nregion = '!(box:min=0 0 0,max=1 1 1 & field:name=gaze,low=0.5)'\n",
    ),
    (
        "vtk-xml",
        "text",
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\">\n<PolyData>\n<FieldData><DataArray type=\"Float64\" Name=\"TimeValue\" format=\"ascii\">1</DataArray></FieldData>\n<Piece NumberOfPoints=\"4\" NumberOfVerts=\"1\" NumberOfLines=\"1\" NumberOfStrips=\"1\" NumberOfPolys=\"1\">\n<PointData Scalars=\"a\"><DataArray type=\"Int8\" Name=\"a\" NumberOfComponents=\"2\" format=\"ascii\">1 2 3 4 5 6 7 8</DataArray></PointData>\n<CellData><DataArray type=\"Float32\" Name=\"c\" format=\"ascii\">nan nan 1 2</DataArray></CellData>\n<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 1 1 0</DataArray></Points>\n<Verts><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0</DataArray><DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">1</DataArray></Verts>\n<Lines><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 3</DataArray><DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">2</DataArray></Lines>\n<Strips><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2 3</DataArray><DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">4</DataArray></Strips>\n<Polys><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2</DataArray><DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3</DataArray></Polys>\n</Piece>\n</PolyData>\n</VTKFile>\n",
    ),
    (
        "vtk-xml",
        "cells",
        "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"5\" NumberOfCells=\"2\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\">0 0 0 1 0 0 0 1 0 0 0 1 1 1 1</DataArray></Points><Cells><DataArray type=\"Int64\" Name=\"connectivity\">0 1 2 3 1 2 3 4</DataArray><DataArray type=\"Int64\" Name=\"offsets\">4 8</DataArray><DataArray type=\"UInt8\" Name=\"types\">10 42</DataArray><DataArray type=\"Int64\" Name=\"faces\">4 3 1 2 3 3 1 2 4 3 1 3 4 3 2 3 4</DataArray><DataArray type=\"Int64\" Name=\"faceoffsets\">-1 17</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>",
    ),
    (
        "vtk-xml",
        "image",
        "<VTKFile type=\"ImageData\" header_type=\"UInt64\"><ImageData WholeExtent=\"0 1 0 1 0 2\" Origin=\"0 0 1\" Spacing=\"1 2 3\" Direction=\"1 0 0 0 1 0 0 0 -1\"><Piece Extent=\"0 1 0 1 0 1\"><PointData><DataArray type=\"Bit\" Name=\"b\" format=\"ascii\">0 1 0 1 0 1 0 1</DataArray></PointData></Piece><Piece Extent=\"0 1 0 1 1 2\"><PointData><DataArray type=\"UInt8\" Name=\"b\" format=\"binary\">CAAAAAAAAAABAgMEBQYHCA==</DataArray></PointData></Piece></ImageData></VTKFile>",
    ),
    (
        "vtk-xml",
        "appended",
        "<VTKFile type=\"RectilinearGrid\" byte_order=\"BigEndian\"><RectilinearGrid WholeExtent=\"0 1 0 0 0 0\"><Piece Extent=\"0 1 0 0 0 0\"><Coordinates><DataArray type=\"Int8\" format=\"appended\" offset=\"0\"/><DataArray type=\"UInt8\" format=\"appended\" offset=\"8\"/><DataArray type=\"UInt8\" format=\"appended\" offset=\"8\"/></Coordinates></Piece></RectilinearGrid><AppendedData encoding=\"base64\">_AAAAAgECAAAAAQM=</AppendedData></VTKFile>",
    ),
    (
        "vtk",
        "polydata",
        "# vtk DataFile Version 1.0\nold\nASCII\nDATASET POLYDATA\nPOINTS 4 int\n0 0 0 1 0 0\n1 1 0 0 1 0\nLINES 1 4\n3 0 1 2\nTRIANGLE_STRIPS 1 5\n4 0 1 3 2\nPOLYGONS 1 4\n3 2 3 0\nVERTICES 1 2\n1 0\nCELL_DATA 4\nSCALARS part int\nLOOKUP_TABLE default\n0 0 5 6\nPOINT_DATA 4\nNORMALS n float\n0 0 1 0 0 1 0 0 1 0 0 1\nCOLOR_SCALARS rgb 3\n0 0 0 1 1 1 0.2 0.4 0.6 0 0 1\n",
    ),
    (
        "vtk",
        "cells",
        "# vtk DataFile Version 5.1\nnew\nASCII\nDATASET UNSTRUCTURED_GRID\nFIELD FieldData 1\nTIME 1 1 double\n0.5\nPOINTS 5 double\n0 0 0 1 0 0 0 1 0 0 0 1 1 1 1\nMETADATA\nINFORMATION 0\n\nCELLS 3 8\nOFFSETS vtktypeint64\n0 4 8\nCONNECTIVITY vtktypeint64\n0 1 2 3\n1 2 3 4\nCELL_TYPES 2\n10\n10\nPOINT_DATA 5\nFIELD FieldData 2\na%20b 2 5 vtkIdType\n1 2 3 4 5 6 7 8 9 0\nwords 1 5 string\na\nb c\n\nd\ne\n",
    ),
    (
        "vtk",
        "grid",
        "# vtk DataFile Version 3.0\ngrid\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 2\nORIGIN 1 1 1\nSPACING 1 1 -2\nPOINT_DATA 8\nSCALARS s bit\nLOOKUP_TABLE mine\n0 1 0 1 0 1 1 1\nLOOKUP_TABLE mine 1\n0 0 0 1\n",
    ),
    ("region", "ball", "ball:vertex=12,radius=5%,falloff=0.25"),
    (
        "region",
        "many",
        "!(box:min=0 0 0,max=1 1 1 | half-space:point=0 0 0,normal=1 0 0) & field:name=gaze,low=0.5,high=2",
    ),
    ("region", "stroke", "stroke:path=1;2;0.5 0 1,radius=0.1 | vertices:indices=1;2;3,radius=0 | all"),
];

/// Writes all seeds.
pub(crate) fn write(folder: &Path) -> SeedOutcome<()> {
    let save = |target: &str, name: &str, bytes: &[u8]| -> SeedOutcome<()> {
        std::fs::create_dir_all(folder.join(target))?;
        Ok(std::fs::write(folder.join(target).join(name), bytes)?)
    };
    for (target, name, text) in TEXTS {
        save(target, name, text.as_bytes())?;
    }
    for (target, format, kind) in [
        ("obj", Format::OBJ, "mesh"),
        ("ply", Format::PLY, "mesh"),
        ("ply", Format::PLY_ASCII, "text"),
        ("off", Format::OFF, "mesh"),
        ("stl", Format::STL, "mesh"),
        ("xyz", Format::XYZ, "cloud"),
        ("csv", Format::CSV, "cloud"),
        ("pcd", Format::PCD, "cloud"),
        ("pcd", Format::PCD_COMPRESSED, "packed"),
        ("off", Format::OFF_BINARY, "binary"),
        ("msh", Format::MSH, "binary"),
        ("msh", Format::MSH_ASCII, "text"),
        ("meshb", Format::MEDIT_BINARY, "mesh"),
        ("3mf", Format::THREE_MF, "mesh"),
        ("dmat", Format::DMAT_BINARY, "binary"),
        ("vtk-xml", Format::VTP, "mesh"),
        ("vtk-xml", Format::VTU, "grid"),
        ("vtk", Format::VTK, "mesh"),
        ("freesurfer", Format::FREESURFER, "mesh"),
        ("glb", Format::GLB, "mesh"),
        ("gltf", Format::GLTF, "mesh"),
    ] {
        let mut bytes = Vec::new();
        write_bytes(&mesh()?, format, &mut bytes)?;
        save(target, kind, &bytes)?;
    }
    for (target, format, sizes) in [
        ("nifti", Format::NIFTI, &[2, 3, 4][..]),
        ("mrc", Format::MRC, &[2, 3, 4]),
        ("nrrd", Format::NRRD, &[2, 3, 4]),
        ("tiff", Format::TIFF, &[4, 6]),
        ("png", Format::PNG, &[4, 6]),
        ("esri-grid", Format::ESRI_GRID, &[4, 6]),
    ] {
        let mut bytes = Vec::new();
        write_bytes(&grid(sizes)?, format, &mut bytes)?;
        save(target, "grid", &bytes)?;
    }
    let edges = Edges { pairs: vec![[1, 0], [2, 1]], weights: vec![1.0, 0.5], direction: Direction::Both };
    let mut graph = Vec::new();
    write_bytes(&ShapeFile::from_graph(3, edges), Format::MTX, &mut graph)?;
    save("mtx", "weights", &graph)?;
    save("ply", "big", &big_endian_ply())?;
    save("e57", "scan", &e57_scan()?)?;
    save("freesurfer", "quads", b"\xff\xff\xff\0\0\x04\0\0\x01\0\0\0\0\0\0\0\x64\0\0\0\0\0\x64\0\x64\0\0\0\0\0\x64\0\0\0\0\0\0\0\x01\0\0\x02\0\0\x03")?;
    save(
        "surface-values",
        "curv",
        b"\xff\xff\xff\0\0\0\x03\0\0\0\x01\0\0\0\x01\x3f\0\0\0\xbf\0\0\0\x7f\xc0\0\0",
    )?;
    save(
        "surface-values",
        "annot",
        b"\0\0\0\x03\0\0\0\0\0\x03\x02\x01\0\0\0\x01\0\0\0\0\0\0\0\x02\0\x03\x02\x01\0\0\0\x01\xff\xff\xff\xfe\0\0\0\x01\0\0\0\x01c\0\0\0\x01\0\0\0\0\0\0\0\x02a\0\0\0\0\x01\0\0\0\x02\0\0\0\x03\0\0\0\0",
    )?;
    let mut mgh = [1_i32, 3, 1, 1, 2, 4].iter().flat_map(|n| n.to_be_bytes()).collect::<Vec<u8>>();
    mgh.resize(284, 0);
    mgh.extend([0, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6]);
    save("surface-values", "mgh", &mgh)?;
    save("surface-values", "cifti", &cifti())?;
    save("pcd", "compressed", &compressed_pcd())?;
    for format in [0, 3, 6, 7] {
        save("las", &format!("format{format}"), &las(format, false)?)?;
        save("laz", &format!("format{format}"), &las(format, true)?)?;
    }
    for (name, n, has_pages) in [("flat", 40, false), ("pages", 40, true), ("root", 1, true)] {
        save("copc", name, &copc(n, has_pages).bytes)?;
    }
    write_encoded(&save)?;
    write_arrays(folder)
}

/// Writes seeds whose content is encoded or compressed.
fn write_encoded(save: &impl Fn(&str, &str, &[u8]) -> SeedOutcome<()>) -> SeedOutcome<()> {
    save("gifti", "text", gifti("ASCII", |numbers, _| numbers.join(" ")).as_bytes())?;
    let encode = |bytes: &[u8]| base64::engine::general_purpose::STANDARD.encode(bytes);
    save("gifti", "base64", gifti("Base64Binary", |_, bytes| encode(bytes)).as_bytes())?;
    let packed = |bytes: &[u8]| {
        let mut zlib = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
        zlib.write_all(bytes).and_then(|()| zlib.finish()).unwrap_or_default()
    };
    save("gifti", "zlib", gifti("GZipBase64Binary", |_, bytes| encode(&packed(bytes))).as_bytes())?;
    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    gzip.write_all(TEXTS[0].2.as_bytes())?;
    save("gzip", "obj", &gzip.finish()?)?;
    save("picture", "png", &picture())?;
    let mut jpeg = Vec::new();
    image::RgbImage::new(8, 8).write_to(&mut Cursor::new(&mut jpeg), image::ImageFormat::Jpeg)?;
    save("picture", "jpeg", &jpeg)?;
    Ok(())
}

/// Writes NPY arrays.
fn write_arrays(folder: &Path) -> SeedOutcome<()> {
    std::fs::create_dir_all(folder.join("npy"))?;
    write_npy(&folder.join("npy/doubles"), &[2, 3], ArrayValues::F64(&[0.0, 1.0, 2.0, f64::NAN, 4.0, 5.0]))?;
    write_npy(&folder.join("npy/whole"), &[4], ArrayValues::U32(&[0, 1, 2, 3]))?;
    let header = "{'descr': '>i2', 'fortran_order': True, 'shape': (2, 2), }\n";
    let fortran =
        [b"\x93NUMPY\x01\x00", &(header.len() as u16).to_le_bytes()[..], header.as_bytes(), &[0; 8]];
    Ok(std::fs::write(folder.join("npy/fortran"), fortran.concat())?)
}

/// A square of a quadrilateral and a triangle, with fields of several types.
/// An image or a volume of bytes.
fn grid(sizes: &[usize]) -> SeedOutcome<ShapeFile> {
    let mut grid = ShapeFile::from_grid(GridLayout::new(sizes, &vec![0.5; sizes.len()]))?;
    let values = (0..grid.n_vertices()).map(|k| (k * 37 % 251) as u8).collect();
    grid.add_vertex_field(Field::new(GRID_VALUES, 1, FieldValues::U8(values)))?;
    Ok(grid)
}

fn mesh() -> SeedOutcome<ShapeFile> {
    let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.25], [1.0, 1.0, 0.0], [0.0, 1.0, 0.5], [0.5, 2.0, 0.0]];
    let faces: Polygons = [&[0_u32, 1, 2, 3][..], &[3, 2, 4]].into_iter().collect();
    let mut mesh = ShapeFile::from_mesh(points, faces);
    mesh.set_precision(CoordinatePrecision::F32);
    mesh.add_vertex_field(Field::new("quality", 1, FieldValues::F64(vec![0.0, 0.1, -0.2, 0.3, f64::NAN])))?;
    mesh.add_vertex_field(Field::new("color", 3, FieldValues::U8((0..15).collect())))?;
    mesh.add_vertex_field(Field::new("normal", 3, FieldValues::F32([0.0, 0.0, 1.0].repeat(5))))?;
    mesh.add_face_field(Field::new("part", 1, FieldValues::U16(vec![7, 9])))?;
    Ok(mesh)
}

/// A picture of four pixels.
pub(crate) fn picture() -> Vec<u8> {
    let mut bytes = Vec::new();
    let pixels = image::RgbImage::from_fn(2, 2, |x, y| image::Rgb([255 * x as u8, 255 * y as u8, 128]));
    pixels
        .write_to(&mut Cursor::new(&mut bytes), image::ImageFormat::Png)
        .expect("four pixels can be written into memory");
    bytes
}

/// A scan with integer, scaled and floating-point values, one of them without a position.
fn e57_scan() -> SeedOutcome<Vec<u8>> {
    use e57::{E57Writer, Record, RecordDataType, RecordName, RecordValue};
    let record = |name, data_type| Record { name, data_type };
    let scaled = || RecordDataType::ScaledInteger { min: -100, max: 100, scale: 0.5, offset: 1.0 };
    let prototype = vec![
        record(RecordName::CartesianX, scaled()),
        record(RecordName::CartesianY, RecordDataType::Single { min: None, max: None }),
        record(RecordName::CartesianZ, RecordDataType::Double { min: None, max: None }),
        record(RecordName::CartesianInvalidState, RecordDataType::Integer { min: 0, max: 2 }),
        record(RecordName::Intensity, RecordDataType::Integer { min: 0, max: 255 }),
    ];
    let mut bytes = Cursor::new(Vec::new());
    let mut writer = E57Writer::new(&mut bytes, "file")?;
    let mut scan = writer.add_pointcloud("scan", prototype)?;
    for k in 0..5_i8 {
        let state = if k == 3 { 2 } else { 0 };
        scan.add_point(vec![
            RecordValue::ScaledInteger(k.into()),
            RecordValue::Single(k.into()),
            RecordValue::Double(k.into()),
            RecordValue::Integer(state),
            RecordValue::Integer(i64::from(k) * 40),
        ])?;
    }
    scan.finalize()?;
    writer.finalize()?;
    drop(writer);
    Ok(bytes.into_inner())
}

fn big_endian_ply() -> Vec<u8> {
    let header = "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty double x\nproperty float y\n\
                  property short z\nproperty int64 id\nelement face 2\nproperty uchar flag\n\
                  property list ushort uint vertex_index\nproperty float area\nelement edge 1\n\
                  property int vertex1\nproperty int vertex2\nend_header\n";
    let mut bytes = header.as_bytes().to_vec();
    for v in 0..3_u8 {
        bytes.extend(f64::from(v).to_be_bytes());
        bytes.extend(f32::from(v).to_be_bytes());
        bytes.extend(i16::from(v).to_be_bytes());
        bytes.extend(i64::from(v).to_be_bytes());
    }
    for corners in [&[0_u32, 1, 2][..], &[2, 1, 0, 1]] {
        bytes.push(1);
        bytes.extend((corners.len() as u16).to_be_bytes());
        bytes.extend(corners.iter().flat_map(|c| c.to_be_bytes()));
        bytes.extend(0.5_f32.to_be_bytes());
    }
    bytes.extend([0, 0, 0, 0, 0, 0, 0, 2]);
    bytes
}

/// Two of the three vertices of a surface with values in two columns.
fn cifti() -> Vec<u8> {
    let xml = "<CIFTI Version=\"2\"><Matrix><MatrixIndicesMap AppliesToMatrixDimension=\"0\" \
               IndicesMapToDataType=\"CIFTI_INDEX_TYPE_SCALARS\"><NamedMap><MapName>a</MapName></NamedMap><NamedMap/>\
               </MatrixIndicesMap><MatrixIndicesMap AppliesToMatrixDimension=\"1\" \
               IndicesMapToDataType=\"CIFTI_INDEX_TYPE_BRAIN_MODELS\"><BrainModel IndexOffset=\"0\" IndexCount=\"2\" \
               ModelType=\"CIFTI_MODEL_TYPE_SURFACE\" BrainStructure=\"CIFTI_STRUCTURE_CORTEX_LEFT\" \
               SurfaceNumberOfVertices=\"3\"><VertexIndices>0 2</VertexIndices></BrainModel></MatrixIndicesMap></Matrix></CIFTI>";
    let size = (xml.len() + 8).next_multiple_of(16);
    let start = 544 + size;
    let mut bytes = vec![0; start];
    bytes[..4].copy_from_slice(&540_i32.to_le_bytes());
    bytes[4..12].copy_from_slice(b"n+2\0\r\n\x1a\n");
    bytes[12] = 16;
    for (k, n) in [6_u8, 1, 1, 1, 1, 2, 2, 1].into_iter().enumerate() {
        bytes[16 + 8 * k] = n;
    }
    bytes[168..176].copy_from_slice(&(start as u64).to_le_bytes());
    bytes[540] = 1;
    bytes[544..548].copy_from_slice(&(size as u32).to_le_bytes());
    bytes[548] = 32;
    bytes[552..552 + xml.len()].copy_from_slice(xml.as_bytes());
    bytes.extend([1.0_f32, 2.0, 3.0, 4.0].iter().flat_map(|x| x.to_le_bytes()));
    bytes
}

/// Two points, compressed by literals and one reference.
fn compressed_pcd() -> Vec<u8> {
    let header = "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\n\
                  POINTS 2\nDATA binary_compressed\n";
    // Eight bytes, then the same eight twice: 16 bytes from 8 back.
    let packed = [&[7_u8][..], &1.5_f32.to_le_bytes(), &(-2.0_f32).to_le_bytes(), &[7 << 5, 7, 7]].concat();
    let sizes = [(packed.len() as u32).to_le_bytes(), 24_u32.to_le_bytes()].concat();
    [header.as_bytes(), &sizes, &packed].concat()
}

/// Twelve points of a format, ten per chunk.
fn las(format: u8, is_compressed: bool) -> SeedOutcome<Vec<u8>> {
    const N: u32 = 12;
    let size: u16 = match format {
        0 => 20,
        3 => 34,
        6 => 30,
        _ => 36,
    };
    let mut points = Vec::new();
    for i in 0..N {
        let mut record: Vec<u8> =
            (0..size).map(|k| if k < 20 { (k as u8).wrapping_mul(i as u8) } else { 0 }).collect();
        record[..4].copy_from_slice(&(100 * i).to_le_bytes());
        points.extend(record);
    }
    let items = laz::LazItemRecordBuilder::default_for_point_format_id(format, 0)?;
    let description = laz::LazVlrBuilder::new(items).with_fixed_chunk_size(10).build();
    let mut record = Vec::new();
    if is_compressed {
        let mut content = Vec::new();
        laz::LazVlr::write_to(&description, &mut content)?;
        record.extend([0, 0]);
        record.extend(b"laszip encoded\0\0");
        record.extend(22204_u16.to_le_bytes());
        record.extend((content.len() as u16).to_le_bytes());
        record.resize(54, 0);
        record.extend(content);
    }
    let header_size: u16 = if format < 6 { 227 } else { 375 };
    let mut bytes = vec![0; header_size.into()];
    bytes[..4].copy_from_slice(b"LASF");
    bytes[24..26].copy_from_slice(&[1, if format < 6 { 2 } else { 4 }]);
    bytes[94..96].copy_from_slice(&header_size.to_le_bytes());
    bytes[96..100].copy_from_slice(&(u32::from(header_size) + record.len() as u32).to_le_bytes());
    bytes[100..104].copy_from_slice(&u32::from(is_compressed).to_le_bytes());
    bytes[104] = format | if is_compressed { 0x80 } else { 0 };
    bytes[105..107].copy_from_slice(&size.to_le_bytes());
    bytes[107..111].copy_from_slice(&N.to_le_bytes());
    for axis in 0..3 {
        bytes[131 + 8 * axis..139 + 8 * axis].copy_from_slice(&0.5_f64.to_le_bytes());
    }
    bytes.extend(record);
    if is_compressed {
        let mut target = Cursor::new(bytes);
        target.set_position(target.get_ref().len() as u64);
        let mut compressor = laz::LasZipCompressor::new(&mut target, description)?;
        compressor.compress_many(&points)?;
        compressor.done()?;
        drop(compressor);
        bytes = target.into_inner();
    } else {
        bytes.extend(points);
    }
    Ok(bytes)
}

/// A triangle and a value per vertex, each array in text and in bytes.
fn gifti(encoding: &str, content: impl Fn(&[String], &[u8]) -> String) -> String {
    let floats = |values: &[f32]| {
        let text: Vec<String> = values.iter().map(f32::to_string).collect();
        content(&text, &values.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<_>>())
    };
    let corners: Vec<String> = (0..3).map(|c: i32| c.to_string()).collect();
    let triangle = content(&corners, &(0..3).flat_map(|c: i32| c.to_le_bytes()).collect::<Vec<_>>());
    let array = |intent: &str, kind: &str, dimensions: &str, data: &str| {
        format!(
            "<DataArray Intent=\"NIFTI_INTENT_{intent}\" DataType=\"NIFTI_TYPE_{kind}\" {dimensions} \
             ArrayIndexingOrder=\"RowMajorOrder\" Encoding=\"{encoding}\" Endian=\"LittleEndian\">\
             <MetaData><MD><Name>Name</Name><Value>a/{intent}</Value></MD></MetaData>\
             <Data>{data}</Data></DataArray>\n"
        )
    };
    let points = floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.5]);
    [
        "<?xml version=\"1.0\"?>\n<GIFTI Version=\"1.0\" NumberOfDataArrays=\"3\">\n".to_owned(),
        array("POINTSET", "FLOAT32", "Dimensionality=\"2\" Dim0=\"3\" Dim1=\"3\"", &points),
        array("TRIANGLE", "INT32", "Dimensionality=\"2\" Dim0=\"1\" Dim1=\"3\"", &triangle),
        array("SHAPE", "FLOAT32", "Dimensionality=\"1\" Dim0=\"3\"", &floats(&[0.1, -2.0, 3.5])),
        "</GIFTI>\n".to_owned(),
    ]
    .concat()
}
