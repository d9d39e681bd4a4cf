//! Tests of invalid selections, and of COPC files with a damaged hierarchy.

use crate::cloud_part::copc_file::{Copc, copc, entry};
use crate::cloud_part::{BOX, N, parts, read};
use adwave::Progress;
use adwave_io::{
    CloudPart, ReadError, ReadLimits, ShapeFile, read_cloud_part, read_cloud_part_with, write_path,
};
use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;

fn boxed() -> CloudPart {
    CloudPart::default().with_bounds(BOX.0, BOX.1)
}

/// Reads a box of the file, which must fail with these words.
fn refused(bytes: &[u8], words: &str) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.copc.laz");
    fs::write(&path, bytes).unwrap();
    says(&path, &boxed(), words);
}

fn says(path: &Path, part: &CloudPart, words: &str) {
    let error = read(path, part).map(|shape| shape.n_vertices()).unwrap_err();
    assert!(error.contains(words), "{error}");
    assert!(!error.contains('\n') && error.matches("a.copc.laz").count() == 1, "{error}");
}

/// Replaces entry `k` of the file's hierarchy.
fn with_entry(file: &Copc, k: usize, entry: &[u8]) -> Vec<u8> {
    let mut bytes = file.bytes.clone();
    bytes[file.hierarchy + 32 * k..][..32].copy_from_slice(entry);
    bytes
}

#[test]
fn boxes_and_resolutions_that_are_none() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.copc.laz");
    fs::write(&path, copc(N, true).bytes).unwrap();
    let of = |low, high| CloudPart::default().with_bounds(low, high);
    says(&path, &of([0.0, 2.0, 0.0], [1.0, 1.0, 1.0]), "along y, got 2.0 to 1.0");
    says(&path, &of([0.0; 3], [1.0, 1.0, f64::NAN]), "along z, got 0.0 to NaN");
    for resolution in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        says(&path, &boxed().with_resolution(resolution), "must be a length above 0");
    }
    says(
        &path,
        &of([0.0; 3], [1.0; 3]),
        "the box from (0.0, 0.0, 0.0) to (1.0, 1.0, 1.0) contains no points; its points lie from (991.",
    );
    // Between the points of a node.
    says(&path, &of([1000.0, 2000.0, 0.0], [1000.001, 2000.001, 0.0001]), "contains no points");
    let mesh = folder.path().join("b.ply");
    write_path(&ShapeFile::from_cloud(vec![[0.0; 3]]), &mesh, None).unwrap();
    let error = read(&mesh, &boxed()).unwrap_err();
    assert!(error.contains("parts can be read of LAS, LAZ, COPC and EPT only"), "{error}");
    assert!(read(&folder.path().join("c.laz"), &boxed()).unwrap_err().contains("cannot be read"));
    assert!(
        read(folder.path(), &boxed())
            .unwrap_err()
            .contains("parts can be read of LAS, LAZ, COPC and EPT only")
    );
}

#[test]
fn a_broken_hierarchy_is_an_error() {
    let (paged, flat) = (copc(N, true), copc(N, false));
    let n = paged.bytes.len() as u64;
    let first = paged.hierarchy as u64;
    let root = |offset, n_bytes, n_points| with_entry(&paged, 0, &entry([0; 4], offset, n_bytes, n_points));
    refused(&root(first, 32, -1), "refers back to itself");
    refused(&root(500, 10, -2), "has -2 points");
    refused(&root(500, -10, 2), "has -10 bytes");
    refused(&root(n - 1, 100, 75), "outside the file");
    refused(&root(u64::MAX - 5, 100, 75), "outside the file");
    refused(&root(100, 100, 75), "outside the file");
    refused(&root(3000, 100, 601), "exceed the 600 points of the cloud");
    refused(&with_entry(&paged, 0, &entry([2, 4, 0, 0], 0, 0, 1)), "invalid node 2 4 0 0");
    refused(&with_entry(&paged, 0, &entry([u32::MAX, 0, 0, 0], 0, 0, 1)), "invalid node -1 0 0 0");
    refused(&with_entry(&paged, 0, &entry([31, 0, 0, 0], 0, 0, 1)), "invalid node 31 0 0 0");
    // A page that is listed for a second node, and one that refers to itself.
    let second = paged.bytes[paged.hierarchy + 32..][..32].to_vec();
    refused(&with_entry(&paged, 0, &second), "has two lists");
    let copied = flat.bytes[flat.hierarchy + 32..][..32].to_vec();
    refused(&with_entry(&flat, 2, &copied), "is listed twice");
    for (at, words) in [(469, "outside the file"), (477, "which is invalid")] {
        let mut bytes = paged.bytes.clone();
        bytes[at..at + 8].copy_from_slice(&u64::MAX.to_le_bytes());
        refused(&bytes, words);
    }
    for at in [453, 461] {
        for number in [f64::NAN, 0.0, -1.0, f64::INFINITY] {
            let mut bytes = paged.bytes.clone();
            bytes[at..at + 8].copy_from_slice(&number.to_le_bytes());
            refused(&bytes, "or spacing");
        }
    }
}

#[test]
fn numbers_of_points_that_lie_are_found() {
    let file = copc(N, false);
    let number = |at: usize| i32::from_le_bytes(file.bytes[at..at + 4].try_into().unwrap());
    let offset = u64::from_le_bytes(file.bytes[file.hierarchy + 16..][..8].try_into().unwrap());
    let (n_bytes, n_points) = (number(file.hierarchy + 24), number(file.hierarchy + 28));
    let lying = |n_bytes, n_points| with_entry(&file, 0, &entry([0; 4], offset, n_bytes, n_points));
    refused(&lying(n_bytes, n_points - 1), "it has 75 points, but the hierarchy states 74");
    refused(&lying(n_bytes - 20, n_points), "node 0-0-0-0 cannot be decompressed");
    refused(&lying(10, n_points), "it has 0 points");
    // Header, hierarchy and chunk agree on more points than fit into memory.
    let mut bytes = lying(n_bytes, i32::MAX);
    bytes[247..255].copy_from_slice(&u64::MAX.to_le_bytes());
    bytes[offset as usize + 34..][..4].copy_from_slice(&i32::MAX.to_le_bytes());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.copc.laz");
    fs::write(&path, bytes).unwrap();
    let limits = ReadLimits { max_bytes: 1 << 24, ..ReadLimits::default() };
    let error = read_cloud_part(&path, &boxed(), &limits).map(|shape| shape.n_vertices()).unwrap_err();
    assert!(error.to_string().contains("exceeds the limit"), "{error}");
}

#[test]
fn a_file_that_is_cut_or_changed_anywhere_is_read_or_refused() {
    let file = copc(60, true);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.copc.laz");
    let part = parts()[0].0;
    for end in (0..file.bytes.len()).step_by(53) {
        fs::write(&path, &file.bytes[..end]).unwrap();
        assert!(read(&path, &part).is_err(), "cut at {end}");
    }
    for at in (0..file.bytes.len()).step_by(11) {
        let mut bytes = file.bytes.clone();
        bytes[at] ^= 1 << (at % 8);
        fs::write(&path, bytes).unwrap();
        if let Err(error) = read(&path, &part) {
            assert!(!error.contains('\n'), "{error}");
        }
    }
}

#[test]
fn limits_hold_of_what_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.copc.laz");
    fs::write(&path, copc(N, true).bytes).unwrap();
    let part = parts()[0].0;
    for limits in [
        ReadLimits { max_points: 599, ..ReadLimits::default() },
        ReadLimits { max_bytes: 600 * 34, ..ReadLimits::default() },
    ] {
        let error = read_cloud_part(&path, &part, &limits).map(|shape| shape.n_vertices()).unwrap_err();
        assert!(error.to_string().contains("exceeds the limit"), "{error}");
        // Content outside the box does not matter.
        assert!(read_cloud_part(&path, &boxed(), &limits).is_ok());
    }
}

#[test]
fn reading_stops_when_it_is_told_to() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.copc.laz");
    fs::write(&path, copc(N, true).bytes).unwrap();
    let stop = AtomicBool::new(true);
    let progress = Progress::none().with_cancel(&stop);
    let result = read_cloud_part_with(&path, &boxed(), &ReadLimits::default(), progress);
    let Err(ReadError::InFile { source, .. }) = result else { panic!("it was read") };
    assert!(matches!(*source, ReadError::Cancelled(_)));
}
