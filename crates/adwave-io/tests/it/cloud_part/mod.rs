//! Tests of parts of clouds by box and resolution: COPC and EPT written here, LAS and LAZ.

#[allow(dead_code)] // the fuzzer uses it too
mod copc_file;
mod ept;
mod hostile;

use adwave_io::{
    CloudPart, Format, ReadLimits, ShapeFile, cloud_levels, read_bytes, read_cloud_part, write_path,
};
use copc_file::{copc, las, node, nodes, point};
use std::fs;
use std::path::Path;

const N: usize = 600;

/// Box with a quarter of the points.
const BOX: ([f64; 3], [f64; 3]) = ([1000.0, 1995.0, -10.0], [1020.0, 2003.5, 4.0]);

pub(crate) fn within(i: usize, (low, high): ([f64; 3], [f64; 3])) -> bool {
    let p = point(i);
    (0..3).all(|a| low[a] <= p[a] && p[a] <= high[a])
}

/// Points that a part must have, in their order.
pub(crate) fn expected(part: &CloudPart, n_levels: u32) -> Vec<usize> {
    let by_node = nodes(N).into_iter().filter(|(key, _)| key[0] < n_levels);
    by_node.flat_map(|(_, points)| points).filter(|&i| part.bounds.is_none_or(|b| within(i, b))).collect()
}

/// Identifies the points of a shape by their intensity, and checks all their other values.
pub(crate) fn numbers(shape: &ShapeFile) -> Vec<usize> {
    let (intensity, amplitude) = (shape.field("intensity").unwrap(), shape.field("amplitude").unwrap());
    let all: Vec<usize> = (0..shape.n_vertices()).map(|k| intensity.get(k, 0) as usize).collect();
    for (k, &i) in all.iter().enumerate() {
        assert_eq!(shape.points()[k], point(i));
        assert_eq!(amplitude.get(k, 0), i as f64 / 2.0);
    }
    all
}

pub(crate) fn read(path: &Path, part: &CloudPart) -> Result<ShapeFile, String> {
    read_cloud_part(path, part, &ReadLimits::default()).map_err(|error| error.to_string())
}

pub(crate) fn parts() -> [(CloudPart, u32); 6] {
    let (low, high) = BOX;
    let boxed = CloudPart::default().with_bounds(low, high);
    let everywhere = CloudPart::default().with_bounds([f64::NEG_INFINITY; 3], [f64::INFINITY; 3]);
    [
        (everywhere, 3),
        (boxed, 3),
        (CloudPart::default().with_resolution(4.0), 1),
        (CloudPart::default().with_resolution(3.9), 2),
        (boxed.with_resolution(2.0), 2),
        (boxed.with_resolution(0.001), 3),
    ]
}

#[test]
fn a_part_of_a_copc_is_its_points_by_level_and_node() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("any-name");
    for has_pages in [false, true] {
        fs::write(&path, copc(N, has_pages).bytes).unwrap();
        for (part, n_levels) in parts() {
            let shape = read(&path, &part).unwrap();
            let expected = expected(&part, n_levels);
            assert!(expected.len() > 5 && (part.bounds.is_none() || expected.len() <= N), "{part:?}");
            assert_eq!(numbers(&shape), expected, "{part:?}");
            assert_eq!(shape.format(), Some(Format::LAZ));
        }
        let levels = cloud_levels(&path, &ReadLimits::default()).unwrap().unwrap();
        assert_eq!((levels.spacing, levels.n_points), (4.0, vec![75, 75, 450]));
    }
    // The whole file is read in its own order, which is that of the nodes here.
    let whole = read(&path, &CloudPart::default()).unwrap();
    assert_eq!(numbers(&whole), expected(&CloudPart::default(), 3));
    assert!((0..N).any(|i| node(i)[0] == 0 && !within(i, BOX)));
}

#[test]
fn any_number_of_threads_gives_the_same_points() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.copc.laz");
    fs::write(&path, copc(N, true).bytes).unwrap();
    for n_threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
        let (part, n_levels) = parts()[1];
        assert_eq!(numbers(&pool.install(|| read(&path, &part)).unwrap()), expected(&part, n_levels));
    }
}

#[test]
fn a_box_of_a_las_or_laz_is_what_a_filter_leaves() {
    let folder = tempfile::tempdir().unwrap();
    let plain = folder.path().join("a.las");
    fs::write(&plain, las(&(0..N).collect::<Vec<_>>())).unwrap();
    let packed = folder.path().join("a.laz");
    write_path(&read(&plain, &CloudPart::default()).unwrap(), &packed, None).unwrap();
    let (low, high) = BOX;
    let part = CloudPart::default().with_bounds(low, high);
    let inside: Vec<usize> = (0..N).filter(|&i| within(i, BOX)).collect();
    for (path, format) in [(&plain, Format::LAS), (&packed, Format::LAZ)] {
        let shape = read(path, &part).unwrap();
        assert_eq!(numbers(&shape), inside);
        assert_eq!(shape.format(), Some(format));
        let error = read(path, &part.with_resolution(1.0)).unwrap_err();
        assert!(error.contains("has no levels") && !error.contains('\n'), "{error}");
        assert_eq!(cloud_levels(path, &ReadLimits::default()).unwrap(), None);
    }
}

#[test]
fn a_face_of_the_box_belongs_to_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.copc.laz");
    fs::write(&path, copc(N, true).bytes).unwrap();
    let shape = read(&path, &CloudPart::default().with_bounds(point(77), point(77))).unwrap();
    assert_eq!(numbers(&shape), [77]);
}

#[test]
fn a_part_is_written_with_all_that_the_file_says_of_it() {
    let folder = tempfile::tempdir().unwrap();
    let [path, again] = ["a.copc.laz", "b.laz"].map(|name| folder.path().join(name));
    fs::write(&path, copc(N, true).bytes).unwrap();
    let (part, n_levels) = parts()[1];
    let shape = read(&path, &part).unwrap();
    let report = write_path(&shape, &again, None).unwrap();
    assert!(report.not_written.is_empty(), "{:?}", report.not_written);
    let bytes = fs::read(&again).unwrap();
    let has = |text: &[u8]| bytes.windows(text.len()).any(|own| own == text);
    assert!(has(copc_file::WKT.as_bytes()) && has(b"amplitude"));
    // Statements about the layout of the whole file would be false here.
    assert!(!has(b"copc\0"));
    let expected = expected(&part, n_levels);
    let again = read_bytes(bytes.clone(), None, &ReadLimits::default()).unwrap();
    assert_eq!(numbers(&again), expected);
    let n = |at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap());
    assert_eq!([n(247), n(255)], [expected.len() as u64; 2]);
    for a in 0..3 {
        let greatest = expected.iter().map(|&i| point(i)[a]).fold(f64::NEG_INFINITY, f64::max);
        assert_eq!(f64::from_bits(n(179 + 16 * a)), greatest);
    }
}

#[test]
fn a_copc_that_is_written_again_does_not_say_that_it_is_one() {
    let folder = tempfile::tempdir().unwrap();
    let [path, again] = ["a.copc.laz", "b.laz"].map(|name| folder.path().join(name));
    fs::write(&path, copc(N, true).bytes).unwrap();
    write_path(&read(&path, &CloudPart::default()).unwrap(), &again, None).unwrap();
    assert_eq!(cloud_levels(&again, &ReadLimits::default()).unwrap(), None);
    assert_eq!(read(&again, &CloudPart::default()).unwrap().n_vertices(), N);
}

#[test]
fn extended_records_stay() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.copc.laz");
    let mut bytes = copc(N, true).bytes;
    let mut record = vec![0; 60];
    record[2..9].copy_from_slice(b"someone");
    record[20] = 5;
    record.extend(b"hello");
    bytes.extend(record);
    bytes[243] = 2;
    fs::write(&path, bytes).unwrap();
    let mut written = Vec::new();
    let shape = read(&path, &parts()[1].0).unwrap();
    adwave_io::write_bytes(&shape, Format::LAS, &mut written).unwrap();
    let start = u64::from_le_bytes(written[235..243].try_into().unwrap()) as usize;
    assert_eq!((&written[start + 2..start + 9], written[243]), (&b"someone"[..], 1));
    assert!(written.ends_with(b"hello"));
}
