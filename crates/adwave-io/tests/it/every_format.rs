//! Laws that hold for every format of the table, checked on its sample files and on what it writes: a new format is
//! tested here without a line.

use adwave::shape::Polygons;
use adwave_io::{Edges, Format, ReadLimits, ShapeFile, read_bytes, write_bytes};

fn read(bytes: &[u8], name: &str) -> Result<ShapeFile, String> {
    read_bytes(bytes.to_vec(), Some(name), &ReadLimits::default()).map_err(|e| e.to_string())
}

/// Small shapes of each kind.
fn shapes() -> [ShapeFile; 3] {
    let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let faces = Polygons::from_triangles(&[[0, 1, 2], [1, 2, 3]]);
    let edges = Edges { pairs: vec![[0, 1], [1, 2], [2, 3]], ..Edges::default() };
    [
        ShapeFile::from_mesh(points.clone(), faces),
        ShapeFile::from_cloud(points),
        ShapeFile::from_graph(4, edges),
    ]
}

/// The samples of a format, and what it writes of a mesh, a cloud and a graph as far as it holds them.
fn files(format: Format) -> Vec<(String, Vec<u8>)> {
    let mut files: Vec<_> = format.samples().map(|(name, bytes)| (name.to_owned(), bytes.to_vec())).collect();
    if format.can_write() {
        let name = format.endings().first().map_or("a".to_owned(), |ending| format!("a.{ending}"));
        for shape in shapes() {
            let mut bytes = Vec::new();
            if write_bytes(&shape, format, &mut bytes).is_ok() {
                files.push((name.clone(), bytes));
            }
        }
    }
    files
}

#[test]
fn every_format_has_a_file_that_is_read_as_it() {
    for format in Format::all().filter(|format| format.can_read()) {
        let files = files(format);
        // Folders of tiles and scans of instruments have tests of their own.
        let has_own_tests = [Format::EPT, Format::E57].contains(&format);
        assert!(has_own_tests || !files.is_empty(), "{format} has no sample and writes nothing");
        for (name, bytes) in files {
            let shape = read(&bytes, &name).unwrap_or_else(|e| panic!("{format}: {e}"));
            assert_eq!(shape.format(), Some(format), "{name}");
            assert!(shape.n_vertices() > 0, "{format}");
        }
    }
}

#[test]
fn a_sample_is_recognized_without_its_name_or_refused() {
    for format in Format::all() {
        for (name, bytes) in format.samples() {
            if let Ok(shape) = read(bytes, "") {
                assert_eq!(shape.format().map(Format::endings), Some(format.endings()), "{name}");
            }
        }
    }
}

#[test]
fn every_truncation_is_a_shape_or_an_error_of_one_line() {
    for format in Format::all() {
        for (name, bytes) in files(format) {
            for end in 0..bytes.len() {
                if let Err(message) = read(&bytes[..end], &name) {
                    assert!(!message.is_empty() && !message.contains('\n'), "{format} {end}: {message}");
                }
            }
        }
    }
}

#[test]
fn what_is_kept_of_its_own_file_comes_back_byte_for_byte() {
    for format in Format::all().filter(|format| format.can_write() && !format.keeps().is_empty()) {
        for (name, bytes) in format.samples() {
            let shape = read(bytes, name).unwrap();
            let mut again = Vec::new();
            write_bytes(&shape, format, &mut again).unwrap();
            assert_eq!(String::from_utf8_lossy(&again), String::from_utf8_lossy(bytes), "{name}");
        }
    }
}

#[test]
fn names_lead_back_to_formats() {
    for format in Format::all() {
        assert_eq!(format.to_string().parse::<Format>().unwrap(), format);
    }
    assert!("blend".parse::<Format>().unwrap_err().to_string().contains("ply"));
}
