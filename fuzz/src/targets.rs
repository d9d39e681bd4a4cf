//! Fuzz targets and the properties that hold for any input.

use crate::words::{
    ESRI_GRID, GEOMVIEW, GLTF, GRAPHML, MANUFACTURING, MEDIT, MSH, NRRD, OBJ, PCD, PLY, RECIPE, REGION, VTK,
    VTK_XML, XML,
};
use adwave::region::parse_region;
use adwave::shape::Polygons;
use adwave::{ClassifiedError, Progress};
use adwave_io::{
    CloudPart, Field, Format, GRID_VALUES, LasReader, MeshReader, ReadError, ReadLimits, ShapeFile,
    cloud_levels, parse_csv_fields, parse_gifti_fields, parse_recipe, parse_surface_values, read_bytes,
    read_cloud_part, read_edge_rows, read_matrix_market, read_npy_bytes, recipe_to_text, rewrite_mesh,
    texture_colors, write_bytes,
};
use std::error::Error;
use std::path::Path;

/// Reader or parser under test.
pub(crate) struct Target {
    pub(crate) name: &'static str,
    /// Folder of its seeds.
    pub(crate) seeds: &'static str,
    /// Words of its language.
    pub(crate) words: &'static [&'static str],
    /// Returns `ok …` or the text of the reader's error; `Err` if the input violates a property.
    pub(crate) check: fn(&[u8]) -> Result<String, String>,
}

/// An E57 with correct checksums of its pages; otherwise mutations would seldom get past them.
fn with_checksums(bytes: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for page in bytes.chunks_exact_mut(1024) {
        let sum = crc32c::crc32c(&page[..1020]);
        page[1020..].copy_from_slice(&sum.to_be_bytes());
    }
    bytes
}

/// All targets.
pub(crate) fn all() -> Vec<Target> {
    let mut targets = shape_targets();
    targets.extend(other_targets());
    targets
}

/// Readers of shapes, each with seeds of its own name.
fn shape_targets() -> Vec<Target> {
    let shape = |name, words, check| Target { name, seeds: name, words, check };
    vec![
        shape("obj", OBJ, |b| mesh_file(b, "a.obj")),
        shape("ply", PLY, |b| mesh_file(b, "a.ply")),
        shape("off", &["OFF", "C", "N", "ST", "4", "n", " BINARY\n", "#", "\r\n"], |b| {
            shape_file(b, "a.off")
        }),
        shape(
            "stl",
            &["solid", "facet", "normal", "vertex", "outer", "loop", "endloop", "endfacet", "endsolid"],
            |b| shape_file(b, "a.stl"),
        ),
        shape("xyz", &["#", "//", ",", ";", "\t", "nan", "x y z\n", "\r"], |b| shape_file(b, "a.xyz")),
        shape("pts", &["#", ",", "\r\n"], |b| shape_file(b, "a.pts")),
        shape("csv", &[",", ";", "\"", "x,y,z\n", "red", "nx"], |b| shape_file(b, "a.csv")),
        shape("pcd", PCD, |b| shape_file(b, "a.pcd")),
        shape("las", &[], |b| las_file(b, "a.las")),
        shape("laz", &[], |b| las_file(b, "a.laz")),
        Target { name: "copc", seeds: "copc", words: &["copc\0", "\u{ff}\u{ff}"], check: cloud_part },
        shape("mtx", &["general", "symmetric", "pattern", "real", "coordinate", "%"], |b| {
            shape_file(b, "a.mtx")
        }),
        shape("msh", MSH, |b| shape_file(b, "a.msh")),
        shape("medit", MEDIT, |b| shape_file(b, "a.mesh")),
        shape("meshb", &[], |b| shape_file(b, "a.meshb")),
        shape("amf", MANUFACTURING, |b| shape_file(b, "a.amf")),
        shape("3mf", MANUFACTURING, |b| shape_file(b, "a.3mf")),
        shape("dmat", &["0 0\n", "3 ", "nan"], |b| shape_file(b, "a.dmat")),
        shape("tgf", &["#\n", "1 ", "nan"], |b| shape_file(b, "a.tgf")),
        shape("edgelist", &["# Nodes: ", "{'weight': ", "%", ","], |b| shape_file(b, "a.edges")),
        Target {
            name: "edge-rows",
            seeds: "edgelist",
            words: &["# Nodes: ", "{'weight': ", "%", ","],
            check: edge_rows,
        },
        Target { name: "matrix-rows", seeds: "mtx", words: &["general", "pattern"], check: matrix_rows },
        shape("graphml", GRAPHML, |b| shape_file(b, "a.graphml")),
        shape("geomview", GEOMVIEW, |b| shape_file(b, "a.list")),
        shape("gifti", XML, |b| shape_file(b, "a.gii")),
        shape("glb", GLTF, |b| shape_file(b, "a.glb")),
        shape("gltf", GLTF, |b| shape_file(b, "a.gltf")),
        shape("e57", &[], |b| shape_file(&with_checksums(b), "a.e57")),
        shape("vtk-xml", VTK_XML, |b| shape_file(b, "a.vtp")),
        shape("vtk", VTK, |b| shape_file(b, "a.vtk")),
        shape("freesurfer", &["created by a\n\n", "\u{0}\u{0}\u{0}\u{2}"], |b| shape_file(b, "lh.white")),
        shape("gzip", &[], |b| shape_file(b, "a.obj.gz")),
        shape("nifti", &["n+1\0", "n+2\0\r\n\u{1a}\n"], |b| shape_file(b, "a.nii")),
        shape("tiff", &["II*\0", "MM\0*", "-9999\0"], |b| shape_file(b, "a.tif")),
        shape("png", &["IHDR", "PLTE", "tRNS", "IDAT"], |b| shape_file(b, "a.png")),
        shape("esri-grid", ESRI_GRID, |b| shape_file(b, "a.asc")),
        shape("mrc", &["MAP ", "\u{1}\0\0\0"], |b| shape_file(b, "a.mrc")),
        shape("nrrd", NRRD, |b| shape_file(b, "a.nrrd")),
        shape("fits", &["NSIDE   = ", "TFORM1  = '", "EXPLICIT", "NESTED  '", "TNULL1  = "], |b| {
            shape_file(b, "a.fits")
        }),
        shape("netcdf", &["vertex_of_cell", "verticesOnCell", "_FillValue", "start_index"], |b| {
            shape_file(b, "a.nc")
        }),
    ]
}

/// Readers of fields, arrays, materials and pictures, and parsers of recipes and regions.
fn other_targets() -> Vec<Target> {
    let target = |name, words, check| Target { name, seeds: name, words, check };
    vec![
        Target {
            name: "surface-values",
            seeds: "surface-values",
            words: &[
                "IndexOffset=\"",
                "IndexCount=\"",
                "SurfaceNumberOfVertices=\"",
                "CIFTI_INDEX_TYPE_SERIES",
                "LEFT",
                "0 1 2",
            ],
            check: |b| fields(parse_surface_values(b, Some("CortexLeft"), 3, &LIMITS)),
        },
        Target {
            name: "gifti-fields",
            seeds: "gifti",
            words: XML,
            check: |b| fields(parse_gifti_fields(b, &LIMITS)),
        },
        Target {
            name: "csv-fields",
            seeds: "csv",
            words: &[",", ";", "\t", "\"", "NA"],
            check: |b| fields(parse_csv_fields(b, &LIMITS)),
        },
        target(
            "npy",
            &["'descr'", "'fortran_order'", "'shape'", "True", "False", "<f8", ">i2", "|u1", "(", ")", ","],
            npy,
        ),
        target(
            "materials",
            &["newmtl ", "map_Kd ", "-s 1 1 1 ", "a.png", "usemtl ", "vt ", "f ", "|"],
            materials,
        ),
        target("picture", &[], picture),
        target("recipe", RECIPE, recipe),
        target("region", REGION, region),
    ]
}

const LIMITS: ReadLimits = ReadLimits { max_bytes: 1 << 26, max_points: 1 << 22 };

/// Checks that the text of an error is one line, and returns it.
fn one_line(error: &(impl Error + ?Sized)) -> Result<String, String> {
    let text = error.to_string();
    if text.is_empty() || text.contains(['\n', '\r']) {
        return Err(format!("an error message with several lines: {text:?}"));
    }
    Ok(text)
}

fn error(error: &impl ClassifiedError) -> Result<String, String> {
    let _ = error.kind();
    one_line(error)
}

/// Reads a shape and checks that it is in range, can be written in any format, and is unchanged after a round trip
/// through its own format.
///
/// It is written in its own format and in one more, chosen by the input's bytes: writing all two dozen formats for
/// each input would leave little time for reading.
fn shape_file(bytes: &[u8], name: &str) -> Result<String, String> {
    let file = match read_bytes(bytes.to_vec(), Some(name), &LIMITS) {
        Ok(file) => file,
        Err(e) => return error(&e),
    };
    in_range(&file)?;
    let own = file.format().ok_or("the shape has no format")?;
    let formats: Vec<Format> = Format::all().collect();
    let other = formats[(crate::hash(bytes) % formats.len() as u64) as usize];
    for format in formats.into_iter().filter(|&f| f == own || f == other) {
        let mut written = Vec::new();
        match write_bytes(&file, format, &mut written) {
            Ok(_) if format == own => unchanged(&file, &written, name)?,
            Ok(_) => {}
            Err(e) => drop(error(&e)?),
        }
    }
    match file.to_shape() {
        Ok(shape) => {
            let points = shape.points().unwrap_or_default().as_flattened();
            if points.iter().any(|x| !x.is_finite()) {
                return Err("a coordinate is not finite".into());
            }
        }
        Err(e) => drop(error(&e)?),
    }
    let names: Vec<&str> = file.field_names();
    Ok(format!(
        "ok {own} {} {} {names:?} {:?}",
        file.faces().is_empty(),
        file.edges().pairs.is_empty(),
        file.extras()
    ))
}

/// Reads a part of a COPC, chosen by the input's bytes, and checks that all points lie in the box.
fn cloud_part(bytes: &[u8]) -> Result<String, String> {
    let (low, high) = ([990.0, 1990.0, -10.0], [1003.0, 2010.0, 4.0]);
    let part = match crate::hash(bytes) % 4 {
        0 => CloudPart::default().with_resolution(2.0),
        1 => CloudPart::default().with_bounds(low, high).with_resolution(2.0),
        2 => CloudPart::default().with_bounds(low, high),
        _ => CloudPart::default().with_bounds([f64::NEG_INFINITY; 3], [f64::INFINITY; 3]),
    };
    let path = std::env::temp_dir().join(format!("adwave-fuzz-{}-part", std::process::id()));
    std::fs::write(&path, bytes).map_err(|e| e.to_string())?;
    // The path differs from run to run.
    let own = |e: &ReadError| error(e).map(|text| text.replace(&*path.to_string_lossy(), "a"));
    let levels = match cloud_levels(&path, &LIMITS) {
        Ok(levels) => format!("{:?}", levels.map(|levels| levels.n_points.len())),
        Err(e) => own(&e)?,
    };
    let file = match read_cloud_part(&path, &part, &LIMITS) {
        Ok(file) => file,
        Err(e) => return own(&e),
    };
    in_range(&file)?;
    if let Some((low, high)) = part.bounds {
        let is_inside = |p: &[f64; 3]| (0..3).all(|a| low[a] <= p[a] && p[a] <= high[a]);
        if !file.points().iter().all(is_inside) {
            return Err("a point lies outside the box".into());
        }
    }
    let mut written = Vec::new();
    match write_bytes(&file, Format::LAZ, &mut written) {
        Ok(_) => {
            let again = read_bytes(written, Some("a.laz"), &LIMITS).map_err(|e| e.to_string())?;
            if again.n_vertices() != file.n_vertices() {
                return Err(format!(
                    "{} points became {} when written",
                    file.n_vertices(),
                    again.n_vertices()
                ));
            }
        }
        Err(e) => drop(error(&e)?),
    }
    Ok(format!("ok {} {levels}", file.n_vertices()))
}

/// Reads a LAS file at once, and one input in eight in blocks too, which need a file.
fn las_file(bytes: &[u8], name: &str) -> Result<String, String> {
    /// A few bytes can encode any number of equal points.
    const MAX_POINTS: usize = 200_000;
    let outcome = shape_file(bytes, name)?;
    if !crate::hash(bytes).is_multiple_of(8) {
        return Ok(outcome);
    }
    let path = std::env::temp_dir().join(format!("adwave-fuzz-{}-{name}", std::process::id()));
    std::fs::write(&path, bytes).map_err(|e| e.to_string())?;
    let mut records = Vec::new();
    let in_blocks = LasReader::open(&path).and_then(|mut reader| {
        while records.len() < MAX_POINTS * reader.layout().record_bytes && reader.read(999, &mut records)? > 0
        {
        }
        Ok((records.len() / reader.layout().record_bytes, reader.layout().n_points))
    });
    // Skipping without decoding must arrive at the same last point.
    let n_before = (records.len() / record_bytes(bytes)).saturating_sub(1);
    if in_blocks.is_ok() && n_before > 0 {
        let mut last = Vec::new();
        let skipped = LasReader::open(&path).and_then(|mut reader| {
            reader.skip(n_before as u64)?;
            reader.read(1, &mut last)
        });
        let size = record_bytes(bytes);
        if skipped.is_err() || last != records[n_before * size..][..size] {
            return Err("the last point differs after skipping others".to_owned());
        }
    }
    let blocks = match in_blocks {
        Ok((n, promised)) if n as u64 == promised || n >= MAX_POINTS => "ok".to_owned(),
        Ok((n, promised)) => return Err(format!("{n} points in blocks, expected {promised}")),
        // The path differs from run to run.
        Err(e) => error(&e)?.replace(&*path.to_string_lossy(), "a"),
    };
    let whole = read_bytes(bytes.to_vec(), Some(name), &LIMITS);
    match whole {
        Ok(file) if blocks == "ok" && file.n_file_rows() != records.len() / record_bytes(bytes) => {
            Err(format!("{} points at once, {} bytes in blocks", file.n_file_rows(), records.len()))
        }
        _ => Ok(format!("{outcome}; {blocks}")),
    }
}

/// Reads a mesh file at once, and one input in eight in blocks too, which need a file; both must agree and reproduce
/// the file.
fn mesh_file(bytes: &[u8], name: &str) -> Result<String, String> {
    let outcome = shape_file(bytes, name)?;
    if !crate::hash(bytes).is_multiple_of(8) {
        return Ok(outcome);
    }
    let path = std::env::temp_dir().join(format!("adwave-fuzz-{}-{name}", std::process::id()));
    std::fs::write(&path, bytes).map_err(|e| e.to_string())?;
    let (mut points, mut faces, mut again) = (Vec::new(), Polygons::new(), Vec::new());
    let mut in_blocks = || -> Result<(), Box<dyn Error>> {
        let mut reader = MeshReader::open(&path)?;
        while reader.vertices(&mut points)? {}
        let mut reader = MeshReader::open(&path)?;
        while reader.faces(points.len() as u64, &mut faces)? {}
        rewrite_mesh::<Box<dyn Error>>(&path, &[], &mut again, Progress::none(), &mut |_, _| Ok(()))?;
        Ok(())
    };
    let blocks = match in_blocks() {
        Ok(()) => "ok".to_owned(),
        // The path differs from run to run.
        Err(e) => one_line(&*e)?.replace(&*path.to_string_lossy(), "a"),
    };
    // An OBJ is recognized by its name alone.
    let is_mesh = |f| match f {
        Some(Format::PLY | Format::PLY_ASCII) => true,
        Some(Format::OBJ) => Path::new(name).extension().is_some_and(|e| e == "obj"),
        _ => false,
    };
    match read_bytes(bytes.to_vec(), Some(name), &LIMITS) {
        // Compressed files and files with Macintosh line ends are read only at once.
        Ok(whole)
            if is_mesh(whole.format())
                && !bytes.starts_with(&[0x1f, 0x8b])
                && (bytes.contains(&b'\n') || !bytes.contains(&b'\r')) =>
        {
            let bits =
                |points: &[[f64; 3]]| points.as_flattened().iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            // Points without a position are left out of a whole cloud.
            let points: Vec<[f64; 3]> = match whole.file_rows() {
                Some(rows) if rows.n_rows() == points.len() => {
                    rows.vertex_rows().iter().map(|&row| points[row as usize]).collect()
                }
                _ => points,
            };
            if blocks != "ok"
                || bits(&points) != bits(whole.points())
                || &faces != whole.faces()
                || again != bytes
            {
                return Err(format!("blocks differ from the whole: {blocks}"));
            }
            Ok(format!("{outcome}; {blocks}"))
        }
        _ => Ok(format!("{outcome}; {blocks}")),
    }
}

/// Number of bytes per record according to the header.
fn record_bytes(bytes: &[u8]) -> usize {
    bytes.get(105..107).map_or(1, |b| usize::from(u16::from_le_bytes([b[0], b[1]])).max(1))
}

fn in_range(file: &ShapeFile) -> Result<(), String> {
    let n = file.n_vertices();
    if !file.points().is_empty() && file.points().len() != n {
        return Err(format!("{} points, expected {n} vertices", file.points().len()));
    }
    let ends = file.faces().corners().iter().chain(file.edges().pairs.as_flattened());
    if let Some(v) = ends.copied().find(|&v| v as usize >= n) {
        return Err(format!("vertex {v}, expected below {n}"));
    }
    let weights = &file.edges().weights;
    if !weights.is_empty() && weights.len() != file.edges().pairs.len() {
        return Err(format!(
            "{} weights, expected {} (one per edge)",
            weights.len(),
            file.edges().pairs.len()
        ));
    }
    let of_faces = file.face_fields().iter().map(|f| (f, file.faces().len()));
    for (field, rows) in file.vertex_fields().iter().map(|f| (f, n)).chain(of_faces) {
        if field.n_channels == 0 || field.values.len() != rows * field.n_channels {
            return Err(format!(
                "a field of {} × {} values, expected {rows} rows",
                field.values.len(),
                field.n_channels
            ));
        }
    }
    Ok(())
}

/// Checks that a shape is unchanged after writing it in its own format and reading it again.
fn unchanged(file: &ShapeFile, written: &[u8], name: &str) -> Result<(), String> {
    let again = read_bytes(written.to_vec(), Some(name), &ReadLimits::default())
        .map_err(|e| format!("the written file cannot be read: {e}"))?;
    let same = |a: f64, b: f64| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
    let (old, new) = (file.points().as_flattened(), again.points().as_flattened());
    if old.len() != new.len() {
        return Err(format!("{} points after writing and reading, {} before", new.len() / 3, old.len() / 3));
    }
    if let Some((a, b)) = old.iter().zip(new).find(|&(&a, &b)| !same(a, b)) {
        return Err(format!("a coordinate changed in writing and reading: {a:e} became {b:e}"));
    }
    let values = |file: &ShapeFile| file.grid().and(file.field(GRID_VALUES)).map(Field::to_f64);
    let (old, new) = (values(file).unwrap_or_default(), values(&again).unwrap_or_default());
    if old.len() != new.len() || old.iter().zip(&new).any(|(a, b)| !same(*a, *b)) {
        return Err("other values of a grid after writing and reading".into());
    }
    // Triangles are all that an STL has.
    if !matches!(file.format(), Some(Format::STL | Format::STL_ASCII)) && file.faces() != again.faces() {
        return Err("other faces after writing and reading".into());
    }
    Ok(())
}

fn fields(read: Result<Vec<Field>, ReadError>) -> Result<String, String> {
    match read {
        Ok(fields)
            if fields.iter().all(|f| f.n_channels > 0 && f.to_f64().len() == f.len() * f.n_channels) =>
        {
            Ok(format!("ok {}", fields.len().min(4)))
        }
        Ok(_) => Err("a field without complete rows".into()),
        Err(e) => error(&e),
    }
}

/// A list of edges as a stream.
fn edge_rows(bytes: &[u8]) -> Result<String, String> {
    match read_edge_rows(bytes, 0, Progress::none()) {
        Ok(list) if list.n_repeated <= list.n_edges => Ok(format!("ok {}", list.n_edges.min(4))),
        Ok(_) => Err("more repeated edges than edges".into()),
        Err(e) => error(&e),
    }
}

/// A matrix as a stream; what is a graph has as many vertices as rows.
fn matrix_rows(bytes: &[u8]) -> Result<String, String> {
    let graph = read_bytes(bytes.to_vec(), Some("a.mtx"), &LIMITS);
    match (read_matrix_market(bytes, Progress::none()), graph) {
        (Ok(rows), Ok(graph)) if rows.n_rows() != graph.n_vertices() => {
            Err("another number of rows than of vertices".into())
        }
        (Ok(rows), _) => Ok(format!("ok {} {}", rows.n_rows().min(4), rows.n_columns().min(4))),
        (Err(e), _) => error(&e),
    }
}

fn npy(bytes: &[u8]) -> Result<String, String> {
    match read_npy_bytes(bytes) {
        Ok(array) => {
            let kind = format!("ok {} {:?}", array.shape.len(), array.values.value_type());
            let _ = array.into_field("a").to_f64();
            Ok(kind)
        }
        Err(e) => error(&e),
    }
}

/// Checks an OBJ and its materials, separated by `|`.
fn materials(bytes: &[u8]) -> Result<String, String> {
    let at = bytes.iter().position(|&b| b == b'|').unwrap_or(bytes.len());
    in_folder(|folder| {
        let (obj, library) = (folder.join("a.obj"), folder.join("a.mtl"));
        let rest = bytes.get(at + 1..).unwrap_or_default();
        std::fs::write(&obj, &bytes[..at])?;
        std::fs::write(library, rest)?;
        std::fs::write(folder.join("a.png"), crate::seeds::picture())?;
        Ok(colors(&bytes[..at], &obj, None))
    })
}

fn picture(bytes: &[u8]) -> Result<String, String> {
    const OBJ: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
    in_folder(|folder| {
        let image = folder.join("a.png");
        std::fs::write(&image, bytes)?;
        Ok(colors(OBJ, &folder.join("a.obj"), Some(&image)))
    })
}

fn colors(obj: &[u8], path: &Path, image: Option<&Path>) -> Result<String, String> {
    let file = match read_bytes(obj.to_vec(), Some("a.obj"), &LIMITS) {
        Ok(file) => file,
        Err(e) => return error(&e),
    };
    match texture_colors(&file, path, image, &LIMITS) {
        Ok(field) if field.to_f64().iter().all(|c| c.is_nan() || (0.0..=1.0).contains(c)) => Ok("ok".into()),
        Ok(_) => Err("a color outside [0, 1]".into()),
        // The name of the folder differs from run to run.
        Err(e) => error(&e).map(|text| text.split('(').next_back().unwrap_or_default().to_owned()),
    }
}

/// Runs a check in a temporary folder.
fn in_folder(run: impl FnOnce(&Path) -> std::io::Result<Result<String, String>>) -> Result<String, String> {
    let folder =
        tempfile::tempdir().map_err(|e| format!("cannot create a folder for temporary files: {e}"))?;
    run(folder.path()).map_err(|e| format!("temporary files: {e}"))?
}

fn recipe(bytes: &[u8]) -> Result<String, String> {
    let text = String::from_utf8_lossy(bytes);
    match parse_recipe(&text) {
        Ok(recipe) => {
            let written = recipe_to_text(&recipe);
            let again =
                parse_recipe(&written).map_err(|e| format!("the written file cannot be read: {e}"))?;
            // NaN differs from itself, so the texts are compared.
            if recipe_to_text(&again) != written {
                return Err("the recipe changed in writing and reading".into());
            }
            Ok(format!(
                "ok {}",
                written.split_whitespace().filter(|w| w.len() > 3).collect::<Vec<_>>().join(" ")
            ))
        }
        Err(e) => error(&e),
    }
}

fn region(bytes: &[u8]) -> Result<String, String> {
    match parse_region(&String::from_utf8_lossy(bytes)) {
        Ok(region) => Ok(format!("ok {region:?}")),
        Err(e) => one_line(&e),
    }
}
