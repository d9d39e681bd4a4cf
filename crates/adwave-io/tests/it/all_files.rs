//! Tests on all input files: each gives a shape or an error of one line, in limited time, and a shape can be written
//! and read again.

use crate::common;

use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use adwave::shape::triangulate;
use adwave_io::{CoordinatePrecision, Format, ReadLimits, ShapeFile, read_bytes, read_path, write_bytes};
use adwave_test_data::data_test;

/// Far more than any of the files, of a few megabytes, should take on a busy machine.
const LONGEST: Duration = Duration::from_secs(30);

fn files(folder: &Path, all: &mut Vec<PathBuf>) {
    let mut entries: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            files(&path, all);
        } else {
            all.push(path);
        }
    }
}

fn all_files() -> Vec<(PathBuf, PathBuf)> {
    let root = common::test_inputs();
    let mut all = Vec::new();
    for folder in ["messy", "paper", "pointclouds", "fields", "benchmarks"] {
        files(&root.join(folder), &mut all);
    }
    all.into_iter().map(|p| (p.clone(), p.strip_prefix(root).unwrap().to_path_buf())).collect()
}

/// Files that no reader can interpret.
const BROKEN: &[&str] = &[
    "messy/tinyobjloader/models/invalid-relative-texture-index.obj",
    "messy/tinyobjloader/models/invalid-relative-vertex-index.obj",
    "messy/tinyobjloader/models/issue-140-zero-face-idx.obj",
    "messy/vtkio/assets/field.vtk",
];

#[data_test]
fn every_file_gives_a_shape_or_an_error_of_one_line() {
    let mut outcomes = BTreeMap::new();
    for (path, name) in all_files() {
        let start = Instant::now();
        let outcome = match read_path(&path, &ReadLimits::default()) {
            // Pictures of textures and arrays of values; `grids.rs` has the tests of grids.
            Ok(shape) if shape.grid().is_some() => format!("GRID {}", shape.format().unwrap()),
            Ok(shape) => {
                for field in shape.vertex_fields() {
                    assert_eq!(field.len(), shape.n_vertices(), "{} {}", name.display(), field.name);
                }
                for field in shape.face_fields() {
                    assert_eq!(field.len(), shape.faces().len(), "{} {}", name.display(), field.name);
                }
                assert!(shape.faces().corners().iter().all(|&c| (c as usize) < shape.n_vertices()));
                format!(
                    "{} {} v {} f {:?}",
                    shape.format().unwrap(),
                    shape.n_vertices(),
                    shape.faces().len(),
                    shape.field_names()
                )
            }
            Err(error) => {
                let message = error.to_string();
                assert!(!message.contains('\n'), "{message}");
                assert!(message.starts_with(&path.display().to_string()), "{message}");
                format!("ERROR {}", message.rsplit_once(&format!("{}: ", path.display())).unwrap().1)
            }
        };
        assert!(start.elapsed() < LONGEST, "{} took {:?}", name.display(), start.elapsed());
        println!("{}: {outcome}", name.display());
        outcomes.insert(name, outcome);
    }
    // The regular grids of VTK are images and volumes.
    let is_vtk = |name: &Path| name.extension().is_some_and(|ending| ending == "vti" || ending == "vtk");
    let shape = |name: &Path| {
        let no = if is_vtk(name) { &["ERROR"][..] } else { &["ERROR", "GRID"] };
        !no.iter().any(|no| outcomes[name].starts_with(no))
    };
    // Supported formats must be read from every valid file; the broken files are listed.
    for name in outcomes.keys() {
        let ending = name.extension().and_then(|e| e.to_str()).unwrap_or("");
        let ours = matches!(ending, "obj" | "ply" | "off" | "stl" | "pcd" | "las" | "xyz" | "pwn")
            || matches!(ending, "vtk" | "vtp" | "vtu" | "vti" | "vtr" | "vts");
        // A GIFTI of values only is a field, not a shape.
        let file = name.file_name().and_then(|f| f.to_str()).unwrap_or("");
        let is_surface = ["flat", "infl", "pial", "sphere", "white"].iter().any(|s| file.starts_with(s));
        let ours = ours || (file.ends_with(".gii.gz") && is_surface);
        // These compressions have no maintained library.
        let is_packed = file.contains("lz4") || file.contains("lzma");
        let broken = is_packed || BROKEN.iter().any(|b| Path::new(b) == name);
        assert_eq!(shape(name), ours && !broken, "{}: {}", name.display(), outcomes[name]);
    }
}

fn same_bits(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

fn same_points(a: &ShapeFile, b: &ShapeFile) -> bool {
    a.points().len() == b.points().len()
        && a.points().as_flattened().iter().zip(b.points().as_flattened()).all(|(&a, &b)| same_bits(a, b))
}

/// Corners of each face; an STL has three vertices of its own for each triangle.
fn same_content(name: &Path, format: Format, a: &ShapeFile, b: &ShapeFile) {
    let what = format!("{} as {format}", name.display());
    if matches!(format, Format::STL | Format::STL_ASCII) {
        let triangles = triangulate(a.points(), a.faces());
        let soup: Vec<[f64; 3]> = triangles.iter().flatten().map(|&v| a.points()[v as usize]).collect();
        assert_eq!(soup.len(), b.points().len(), "{what}");
        let single = format == Format::STL;
        for (x, y) in soup.as_flattened().iter().zip(b.points().as_flattened()) {
            let x = if single { f64::from(*x as f32) } else { *x };
            assert!(same_bits(x, *y), "{what}: {x} became {y}");
        }
        return;
    }
    if matches!(format, Format::GIFTI | Format::FREESURFER | Format::OFF_BINARY) {
        for (x, y) in a.points().as_flattened().iter().zip(b.points().as_flattened()) {
            assert!(same_bits(f64::from(*x as f32), *y), "{what}: {x} became {y}");
        }
        return;
    }
    if matches!(format, Format::GLB | Format::GLTF) {
        // Far from the origin the coordinates are relative to their center, with more digits than 32-bit floats have
        // there.
        let reach =
            a.points().as_flattened().iter().filter(|x| x.is_finite()).fold(0.0_f64, |r, x| r.max(x.abs()));
        let near = |x: f64, y: f64| (x - y).abs() <= 1e-7 * reach;
        for (x, y) in a.points().as_flattened().iter().zip(b.points().as_flattened()) {
            assert!(same_bits(f64::from(*x as f32), *y) || near(*x, *y), "{what}: {x} became {y}");
        }
        return;
    }
    let is_there = |p: &&[f64; 3]| p.iter().all(|x| x.is_finite());
    let n_there = a.points().iter().filter(is_there).count();
    if n_there > 0 && n_there < a.points().len() && b.file_rows().is_some() {
        // Points without a position are left out on reading.
        assert!(a.points().iter().filter(is_there).eq(b.points()), "{what}: points");
        return;
    }
    assert!(same_points(a, b), "{what}: points");
    if matches!(
        format,
        Format::OBJ | Format::OFF | Format::PLY | Format::PLY_ASCII | Format::VTP | Format::VTU | Format::VTK
    ) {
        assert_eq!(a.faces(), b.faces(), "{what}: faces");
    }
    if matches!(
        format,
        Format::OBJ | Format::PLY | Format::PLY_ASCII | Format::VTP | Format::VTU | Format::VTK
    ) {
        assert_eq!(a.edges().pairs, b.edges().pairs, "{what}: edges");
    }
}

#[data_test]
fn what_is_read_can_be_written_and_read_again() {
    for (path, name) in all_files() {
        let Ok(shape) = read_path(&path, &ReadLimits::default()) else { continue };
        if shape.grid().is_some() {
            continue;
        }
        for format in Format::all().filter(|f| f.can_read()) {
            let mut bytes = Vec::new();
            if let Err(error) = write_bytes(&shape, format, &mut bytes) {
                let message = error.to_string();
                assert!(message.contains("cannot store") && !message.contains('\n'), "{message}");
                continue;
            }
            // The names of text formats are not file extensions; the content must identify them.
            let hint = format!("a.{}", format.name());
            let again = read_bytes(bytes, Some(&hint), &ReadLimits::default())
                .unwrap_or_else(|e| panic!("{} as {format}: {e}", name.display()));
            if matches!(format, Format::LAS | Format::LAZ) {
                assert_eq!(again.n_vertices(), shape.n_vertices(), "{}", name.display());
            } else if !format.holds_graphs() {
                same_content(&name, format, &shape, &again);
            }
            if matches!(format, Format::PLY | Format::PLY_ASCII) {
                for (a, b) in shape.vertex_fields().iter().zip(again.vertex_fields()) {
                    assert_eq!((&a.name, a.n_channels), (&b.name, b.n_channels), "{}", name.display());
                    let (x, y) = (a.to_f64(), b.to_f64());
                    // Fractions of colors become bytes.
                    let full = a.full_intensity();
                    let is_byte = |x: f64, y: f64| a.name == "color" && (255.0 * x / full).round() == y;
                    assert!(
                        x.iter().zip(&y).all(|(&x, &y)| same_bits(x, y) || is_byte(x, y)),
                        "{} {}",
                        name.display(),
                        a.name
                    );
                }
                assert_eq!(shape.vertex_fields().len(), again.vertex_fields().len(), "{}", name.display());
            }
        }
    }
}

/// Formats that keep their text, and PLY, write exactly the bytes that were read.
#[data_test]
fn an_unchanged_shape_is_written_byte_for_byte() {
    let mut n = 0;
    for (path, name) in all_files() {
        let Ok(shape) = read_path(&path, &ReadLimits::default()) else { continue };
        let format = shape.format().unwrap();
        let kept = matches!(
            format,
            Format::OBJ
                | Format::PLY
                | Format::PLY_ASCII
                | Format::OFF
                | Format::XYZ
                | Format::PCD_ASCII
                | Format::GIFTI
        );
        if !kept || (format == Format::PLY && shape.n_vertices() == 0) {
            continue;
        }
        let mut bytes = Vec::new();
        let report = write_bytes(&shape, format, &mut bytes).unwrap();
        assert_eq!(report.not_written, [""; 0], "{}", name.display());
        let mut file = std::fs::read(&path).unwrap();
        if file.starts_with(&[0x1f, 0x8b]) {
            let mut plain = Vec::new();
            flate2::read::GzDecoder::new(file.as_slice()).read_to_end(&mut plain).unwrap();
            file = plain;
        }
        if bytes != file {
            // Only a PLY without a vertex element has no rows to keep.
            assert!(shape.n_vertices() == 0, "{} changed", name.display());
        }
        n += 1;
    }
    assert!(n > 100, "only {n} files");
}

#[data_test]
fn moved_points_keep_everything_else() {
    for (path, name) in all_files() {
        let Ok(mut shape) = read_path(&path, &ReadLimits::default()) else { continue };
        let format = shape.format().unwrap();
        if shape.points().is_empty() || !format.can_write() {
            continue;
        }
        let points: Vec<[f64; 3]> = shape.points().iter().map(|p| p.map(|x| x * 0.5 + 1.0)).collect();
        shape.set_points(points).unwrap();
        let mut bytes = Vec::new();
        write_bytes(&shape, format, &mut bytes).unwrap();
        let again = read_bytes(bytes, None, &ReadLimits::default()).unwrap();
        assert_eq!(again.format(), Some(format), "{}", name.display());
        for (x, y) in shape.points().as_flattened().iter().zip(again.points().as_flattened()) {
            let x = if shape.precision() == CoordinatePrecision::F32 { f64::from(*x as f32) } else { *x };
            // The coordinates of a LAS are integers in its steps.
            let is_near = format == Format::LAS && (x - y).abs() <= 0.005 * (1.0 + 1e-6);
            assert!(same_bits(x, *y) || is_near, "{}: {x} became {y}", name.display());
        }
        assert_eq!(shape.faces(), again.faces(), "{}", name.display());
        assert_eq!(shape.field_names(), again.field_names(), "{}", name.display());
        assert_eq!(shape.edges(), again.edges(), "{}", name.display());
    }
}
