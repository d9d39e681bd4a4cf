//! Tests of streaming against the readers and writers of whole files.

use std::path::{Path, PathBuf};

use adwave::Progress;
use adwave::shape::Polygons;

use super::{MeshReader, rewrite_mesh};
use crate::{Field, FieldValues, Format, ReadError, ReadLimits, ShapeFile, read_path, write_bytes};

/// Reads a file in blocks.
fn portions(path: &Path) -> Result<(Vec<[f64; 3]>, Polygons), ReadError> {
    let (mut points, mut faces) = (Vec::new(), Polygons::new());
    let mut reader = MeshReader::open(path)?;
    while reader.vertices(&mut points)? {}
    let mut reader = MeshReader::open(path)?;
    while reader.faces(points.len() as u64, &mut faces)? {}
    Ok((points, faces))
}

const TEXT: &str = "ply\r\nformat ascii 1.0\r\ncomment by hand\r\nobj_info and so on\r\nelement note 2\r\nproperty list uchar int words\r\n\
element vertex 5\r\nproperty uchar red\r\nproperty float x\r\nproperty float y\r\nproperty double z\r\nproperty list uchar int tags\r\n\
element face 4\r\nproperty float quality\r\nproperty list uchar int vertex_indices\r\nelement edge 1\r\nproperty int vertex1\r\n\
property int vertex2\r\nelement tristrips 1\r\nproperty list int int vertex_indices\r\nend_header\r\n3 1 2 3\r\n0\r\n\
1 0.10 0 -0 0\r\n2 1.50\t0 0 2 7 8\r\n3 1 1.000 1e0 1 5\r\n4 0 1 .5 0\n5 -7 8 9 0\r\n\
0.5 3 0 1 2\r\n0.25 4 0 1 2 3\r\n  1 2 0 1\r\n2 0\r\n3 4\r\n7 0 1 2 3 -1 4 0\r\n";

const OBJ: &str = "# a comment that ends in \\\nmtllib a.mtl\no one\nv 0.10 0 0\nv 1.50 0 -0 0.5 0.25 1 # red\nvt 0 0\nvt 1 0\nvn 0 0 1\nv 1 \\\n 1.000 1e0\n\
f 1/1/1 2/2/1 3/1/1\nusemtl x\nv 0 1 .5\nf -1 -2 \\\n  1 2\ng more\nf 5 1 2\nl 1 2\nv 9 9 9\ns off\n";

/// The rows of `TEXT` as numbers in one of the two byte orders, without lists of vertices if `is_fixed`.
fn binary(is_big: bool, is_fixed: bool) -> Vec<u8> {
    let order = if is_big { "big" } else { "little" };
    let tags = if is_fixed { "" } else { "property list uchar short tags\n" };
    let mut bytes = format!(
        "ply\nformat binary_{order}_endian 1.0\ncomment by hand\nelement note 3\nproperty float n\nelement vertex 40\nproperty uchar red\n\
property double x\nproperty double y\nproperty double z\n{tags}property float wavelet_2\nelement face 30\nproperty list uchar uint vertex_index\n\
property uchar flag\nend_header\n"
    )
    .into_bytes();
    let double = |x: f64| if is_big { x.to_be_bytes() } else { x.to_le_bytes() };
    let word = |x: u32| if is_big { x.to_be_bytes() } else { x.to_le_bytes() };
    bytes.extend([1, 2, 3].map(word).as_flattened());
    for i in 0..40_u8 {
        bytes.push(i);
        let point = [f64::from(i) / 3.0, -0.0, f64::from(i % 7)];
        bytes.extend(point.map(double).as_flattened());
        if !is_fixed {
            bytes.push(i % 3);
            (0..i % 3).for_each(|k| bytes.extend([k, i]));
        }
        bytes.extend(word(7));
    }
    for f in 0..30_u32 {
        let n = [3, 3, 4, 1, 0, 5][f as usize % 6];
        bytes.push(n as u8);
        (0..n).for_each(|k| bytes.extend(word((f + 3 * k) % 40)));
        bytes.push(f as u8);
    }
    bytes
}

fn files() -> Vec<(&'static str, Vec<u8>)> {
    let mut files = vec![("text.ply", TEXT.as_bytes().to_vec()), ("a.obj", OBJ.as_bytes().to_vec())];
    for (is_big, is_fixed) in [(false, false), (false, true), (true, false), (true, true)] {
        files.push(("binary.ply", binary(is_big, is_fixed)));
    }
    files.push(("plane.obj", b"v 1 2\nv 3 4\nv 5 6\nf 1 2 3\n".to_vec()));
    files
}

#[test]
fn portions_are_the_whole() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files() {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        let whole = read_path(&path, &ReadLimits::default()).unwrap();
        let (points, faces) = portions(&path).unwrap();
        assert_eq!(points, whole.points(), "{name}");
        assert_eq!(&faces, whole.faces(), "{name}");
    }
}

#[test]
fn what_is_cut_or_wrong_is_an_error_in_one_line_as_it_is_for_the_whole() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files() {
        let path = folder.path().join(name);
        for end in 4..bytes.len() {
            std::fs::write(&path, &bytes[..end]).unwrap();
            match (read_path(&path, &ReadLimits::default()), portions(&path)) {
                (Ok(whole), portions) => {
                    assert_eq!(
                        portions.unwrap(),
                        (whole.points().to_vec(), whole.faces().clone()),
                        "{name} {end}"
                    );
                }
                (Err(_), Ok(_)) => assert!(name == "a.obj" || name == "text.ply", "{name} cut at {end}"),
                (Err(_), Err(error)) => assert!(!error.to_string().contains('\n'), "{error}"),
            }
        }
    }
    for (name, from, to, what) in [
        ("text.ply", "4 0 1 2 3", "4 0 1 2 9", "line 30: face 1 names vertex 9, but there are 5"),
        ("text.ply", "3 1 1.000", "3 x 1.000", "line 26: expected a float, got \"x\""),
        ("text.ply", "7 0 1 2 3", "7 0 1 2 6", "line 34: face 0 names vertex 6"),
        ("text.ply", "0.25 4 0", "0.25 -4 0", "line 30: the length of a list is invalid: -4"),
        ("text.ply", "0.25 4 0", "0.25 2000000 0", "get the whole file"),
        ("a.obj", "f 5 1 2", "f 8 1 2", "line 17: face 2 names vertex 8, but there are 5"),
        ("a.obj", "f 5 1 2", "f -9 1 2", "line 17: face 2 names vertex -9"),
        ("a.obj", "v 9 9 9", "v 9 9", "line 19: a vertex needs 3 numbers, got 2"),
        ("a.obj", "v 0 1 .5", "v 0 a .5", "line 13: a vertex must have numbers, got \"a\""),
    ] {
        let text = if name == "a.obj" { OBJ } else { TEXT };
        let path = folder.path().join(name);
        std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
        let (whole, portions) = (
            read_path(&path, &ReadLimits::default()).unwrap_err().to_string(),
            portions(&path).unwrap_err().to_string(),
        );
        assert!(portions.contains(what), "{portions}");
        assert!(portions == whole || what.contains("whole file"), "{portions} for {whole}");
    }
}

#[test]
fn a_mesh_is_written_again_as_it_is_after_reading_it_whole() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files() {
        let path = folder.path().join(name);
        std::fs::write(&path, &bytes).unwrap();
        let mut whole: ShapeFile = read_path(&path, &ReadLimits::default()).unwrap();
        let mut same = Vec::new();
        rewrite_mesh(&path, &[], &mut same, Progress::none(), &mut |_, _| Ok::<(), Failure>(())).unwrap();
        assert!(same == bytes, "{name}: {}", String::from_utf8_lossy(&same));
        let n = whole.points().len();
        let moved: Vec<[f64; 3]> = whole.points().iter().map(|&[x, y, z]| [x + 0.1, y, z]).collect();
        let fields: &[String] = if name.ends_with("obj") { &[] } else { &["wavelet_2".into(), "w".into()] };
        for (k, name) in fields.iter().enumerate() {
            let values = FieldValues::F32((0..n).map(|i| i as f32 + 0.5 * k as f32).collect());
            whole.add_vertex_field(Field::new(name.clone(), 1, values)).unwrap();
        }
        whole.set_points(moved.clone()).unwrap();
        let mut expected = Vec::new();
        write_bytes(&whole, whole.format().unwrap(), &mut expected).unwrap();
        let (mut written, mut first) = (Vec::new(), 0);
        let n_written = rewrite_mesh(&path, fields, &mut written, Progress::none(), &mut |points, values| {
            for (i, point) in points.iter_mut().enumerate() {
                point[0] = moved[first + i][0];
                for (k, values) in values.iter_mut().enumerate() {
                    values[i] = (first + i) as f32 + 0.5 * k as f32;
                }
            }
            first += points.len();
            Ok::<(), Failure>(())
        });
        assert_eq!(n_written.unwrap(), n as u64);
        assert!(
            written == expected,
            "{name}: {}\n{}",
            String::from_utf8_lossy(&written),
            String::from_utf8_lossy(&expected)
        );
    }
}

type Failure = Box<dyn std::error::Error>;

#[test]
fn other_files_and_fields_of_an_obj_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    std::fs::write(&path, OBJ).unwrap();
    let refused = rewrite_mesh(&path, &["w".into()], &mut Vec::new(), Progress::none(), &mut |_, _| {
        Ok::<(), Failure>(())
    });
    assert!(refused.unwrap_err().to_string().contains("cannot store"));
    let path = folder.path().join("a.off");
    std::fs::write(&path, "OFF\n0 0 0\n").unwrap();
    assert!(MeshReader::open(&path).err().unwrap().to_string().contains("must be a PLY"));
    std::fs::write(&path, "").unwrap();
    assert!(MeshReader::open(&path).err().unwrap().to_string().contains("empty"));
    std::fs::write(&path, "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n")
        .unwrap();
    assert!(portions(&path).unwrap_err().to_string().contains("has no `y`"));
}

/// Files of other programs, except the largest.
#[adwave_test_data::data_test]
fn portions_are_the_whole_on_real_files() {
    const MOST_BYTES: u64 = 400_000;
    let limits = ReadLimits::default();
    let mut folders = vec![PathBuf::from(adwave_test_data::folder!())];
    let mut n = 0;
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap().flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let is_mesh = path.extension().is_some_and(|e| e == "ply" || e == "obj");
            if !is_mesh || entry.metadata().unwrap().len() > MOST_BYTES {
                continue;
            }
            let Ok(whole) = read_path(&path, &limits) else {
                if let Err(error) = portions(&path) {
                    assert!(!error.to_string().contains('\n'), "{error}");
                }
                continue;
            };
            // Some have the name of another format.
            if !whole.format().is_some_and(|f| matches!(f, Format::PLY | Format::PLY_ASCII | Format::OBJ)) {
                continue;
            }
            let (points, faces) = portions(&path).unwrap_or_else(|e| panic!("{e}"));
            let bits =
                |points: &[[f64; 3]]| points.as_flattened().iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert!(bits(&points) == bits(whole.points()) && &faces == whole.faces(), "{}", path.display());
            let mut same = Vec::new();
            let written =
                rewrite_mesh(&path, &[], &mut same, Progress::none(), &mut |_, _| Ok::<(), Failure>(()));
            assert_eq!(written.unwrap(), points.len() as u64);
            assert!(same == std::fs::read(&path).unwrap(), "{}", path.display());
            n += 1;
        }
    }
    assert!(n > 50, "{n} files");
}

#[test]
fn lines_of_the_old_macintosh_are_refused_and_not_taken_for_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    std::fs::write(&path, "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r").unwrap();
    let error = MeshReader::open(&path).err().unwrap().to_string();
    assert!(error.contains("carriage return alone"), "{error}");
}
