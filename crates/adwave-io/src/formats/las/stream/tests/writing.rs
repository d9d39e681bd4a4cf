//! Tests of files written in blocks.

use std::path::Path;

use super::{Chunks, Folder, head, las, laz, read_whole, rows};
use crate::formats::las::read::{Record, parse_header, records, u32_at, u64_at};
use crate::formats::las::stream::{LasReader, LasWriter};
use crate::formats::las::write::{put, variable_record};
use crate::{Provenance, ReadLimits, read_bytes};

fn extended(user: &[u8], id: u16, content: &[u8]) -> Vec<u8> {
    let mut record = vec![0; 60];
    record[2..2 + user.len()].copy_from_slice(user);
    put(&mut record, 18, id.to_le_bytes());
    put(&mut record, 20, (content.len() as u64).to_le_bytes());
    record.extend(content);
    record
}

/// A file with records before and after its points.
fn rich(n: usize) -> Vec<u8> {
    let old = Provenance { program: "old".into(), ..Provenance::default() };
    let records = [
        variable_record(b"copc", 1, &[1; 160]),
        variable_record(b"LASF_Projection", 2112, b"PROJCS[\"x\"]"),
        variable_record(b"adwave", 1, old.to_json().as_bytes()),
        variable_record(b"somebody", 7, b"anything"),
    ];
    let mut head = head(7, n, &records, false);
    head[6] |= 2;
    head[8..24].copy_from_slice(b"0123456789abcdef");
    head[90..94].copy_from_slice(&[200, 0, 0xe8, 7]);
    let points = rows(7, n);
    let tail = [
        extended(b"LASF_Spec", 65535, &[5; 500]),
        extended(b"LASF_Projection", 2112, b"a longer text"),
        extended(b"copc", 1000, &[1; 32]),
    ];
    let after = (head.len() + points.len()) as u64;
    put(&mut head, 227, after.to_le_bytes());
    put(&mut head, 235, after.to_le_bytes());
    put(&mut head, 243, 3_u32.to_le_bytes());
    [head, points, tail.concat()].concat()
}

fn with_fields(rows: &[u8], size: usize, fields: impl Fn(usize) -> [f32; 2]) -> Vec<u8> {
    let add = |(i, row): (usize, &[u8])| {
        let [a, b] = fields(i);
        [row, &a.to_le_bytes(), &b.to_le_bytes()].concat()
    };
    rows.chunks_exact(size).enumerate().flat_map(add).collect()
}

#[test]
fn what_is_written_is_read_with_all_that_the_file_had() {
    let (folder, n) = (Folder::new(), 600);
    let bytes = rich(n);
    let like = LasReader::open(&folder.file("like.las", &bytes)).unwrap();
    let size = like.layout().record_bytes;
    let values = |i: usize| [i as f32 * 0.5, -(i as f32)];
    let points = with_fields(&rows(7, n), size, values);
    let made = Provenance { program: "adwave".into(), command: "split".into(), inputs: Vec::new() };
    for name in ["a.las", "a.laz"] {
        let path = folder.0.path().join(name);
        let fields = ["height".to_owned(), "intensity".to_owned()];
        let mut writer = LasWriter::create(&path, &like, &fields, Some(&made)).unwrap();
        assert_eq!(writer.fields(), ["height", "intensity_2"]);
        assert_eq!(writer.layout().record_bytes, size + 8);
        for portion in points.chunks(123 * (size + 8)) {
            writer.write(portion).unwrap();
        }
        writer.finish().unwrap();
        assert!(read_whole(&path, 250) == points, "{name}");
        let written = std::fs::read(&path).unwrap();
        // Version, creation date, identifiers; wave packets are no longer inside.
        assert!(
            written[4..96] == {
                let mut own = bytes[4..96].to_vec();
                own[2] &= !2;
                own
            }
        );
        assert_eq!((u32_at(&written, 107), u64_at(&written, 247)), (Some(0), Some(n as u64)));
        let by_return: Vec<_> = (0..4).map(|k| u64_at(&written, 255 + 8 * k).unwrap()).collect();
        assert_eq!(by_return, [200, 200, 200, 0]);
        let header = parse_header(&written).unwrap();
        let kept = records(&written, &header);
        let own = |r: &Record<'_>| (String::from_utf8_lossy(r.user).trim_end_matches('\0').to_owned(), r.id);
        let kept: Vec<_> = kept.iter().filter(|r| !r.is_compression()).map(own).collect();
        let named = |name: &str, id: u16| (name.to_owned(), id);
        let expected =
            [named("LASF_Projection", 2112), named("somebody", 7), named("LASF_Spec", 4), named("adwave", 1)];
        assert_eq!(kept, expected);
        let tail = extended(b"LASF_Projection", 2112, b"a longer text");
        assert_eq!((u64_at(&written, 227), u32_at(&written, 243)), (Some(0), Some(1)));
        assert_eq!(u64_at(&written, 235), Some((written.len() - tail.len()) as u64));
        assert!(written.ends_with(&tail));
        let shape = read_bytes(written, Some(name), &ReadLimits::default()).unwrap();
        assert_eq!(shape.provenance(), Some(&made));
        for (name, own) in [("height", 0), ("intensity_2", 1)] {
            let field = shape.field(name).unwrap();
            assert!((0..n).all(|i| field.get(i, 0) == f64::from(values(i)[own])), "{name}");
        }
        let bound = |of: fn(f64, f64) -> f64| {
            [0, 1, 2].map(|axis| shape.points().iter().map(|p| p[axis]).reduce(of).unwrap())
        };
        let bounds = LasReader::open(&path).unwrap().layout().bounds;
        assert_eq!(bounds, Some((bound(f64::min), bound(f64::max))));
    }
}

#[test]
fn a_laz_is_written_as_the_whole_file_writer_does() {
    let (folder, n) = (Folder::new(), 120_000);
    for format in [1, 6] {
        let empty = laz(format, n, Chunks::Fixed(50_000));
        let bytes = las(format, n);
        let like = LasReader::open(&folder.file("a.las", &bytes)).unwrap();
        let path = folder.0.path().join("b.laz");
        let mut writer = LasWriter::create(&path, &like, &[], None).unwrap();
        rows(format, n).chunks(7001 * like.layout().record_bytes).for_each(|own| writer.write(own).unwrap());
        writer.finish().unwrap();
        let written = std::fs::read(&path).unwrap();
        let start = u32_at(&written, 96).unwrap() as usize;
        assert!(written[start..] == empty[start..], "format {format}");
    }
}

#[test]
fn a_writer_that_is_dropped_leaves_the_old_file() {
    let folder = Folder::new();
    let like = LasReader::open(&folder.file("a.las", &las(6, 20))).unwrap();
    let path = folder.file("b.laz", b"old");
    let mut writer = LasWriter::create(&path, &like, &[], None).unwrap();
    writer.write(&rows(6, 20)).unwrap();
    let n_files = || std::fs::read_dir(folder.0.path()).unwrap().count();
    assert_eq!(n_files(), 3);
    drop(writer);
    assert_eq!((n_files(), std::fs::read(&path).unwrap()), (2, b"old".to_vec()));
    // Over its template file, and without points.
    for (name, n) in [("a.las", 10), ("b.laz", 0), ("c.las", 0)] {
        let path = folder.0.path().join(name);
        let mut writer = LasWriter::create(&path, &like, &[], None).unwrap();
        writer.write(&rows(6, n)).unwrap();
        writer.finish().unwrap();
        assert_eq!(LasReader::open(&path).unwrap().layout().n_points, n as u64);
        assert!(read_whole(&path, 100) == rows(6, n), "{name}");
    }
}

#[test]
fn what_cannot_be_written_is_one_line() {
    let folder = Folder::new();
    let like = LasReader::open(&folder.file("a.las", &las(3, 20))).unwrap();
    let refusal = |name: &str, fields: &[String]| {
        let refused = LasWriter::create(&folder.0.path().join(name), &like, fields, None);
        let message = refused.err().unwrap().to_string();
        assert!(message.contains(name) && !message.contains('\n'), "{message}");
        message
    };
    assert!(refusal("a.ply", &[]).contains("the name tells no format"));
    assert!(refusal("a.laz.gz", &[]).contains("the name tells no format"));
    assert!(refusal("missing/a.laz", &[]).contains("does not exist"));
    let many: Vec<String> = (0..400).map(|k| format!("f{k}")).collect();
    assert!(refusal("b.laz", &many).contains("no room"));
    let mut writer = LasWriter::create(&folder.0.path().join("b.laz"), &like, &[], None).unwrap();
    let error = writer.write(&[0; 5]).unwrap_err().to_string();
    assert!(error.contains("5 bytes of points in records of 37"), "{error}");
    assert!(writer.write(&[]).is_err() && writer.finish().is_err());
}

#[adwave_test_data::data_test]
fn real_scans_are_the_same_in_portions() {
    let folder = Folder::new();
    for name in ["autzen/autzen-thin.las", "las/1.2-with-color.las"] {
        let path = Path::new(adwave_test_data::folder!()).join("pointclouds/PDAL-test").join(name);
        let like = LasReader::open(&path).unwrap();
        let points = read_whole(&path, 1000);
        assert_eq!(points.len() as u64, like.layout().n_points * like.layout().record_bytes as u64);
        let packed = folder.0.path().join("a.laz");
        let mut writer = LasWriter::create(&packed, &like, &[], None).unwrap();
        writer.write(&points).unwrap();
        writer.finish().unwrap();
        assert!(read_whole(&packed, 777) == points);
        let read = |path: &Path| crate::read_path(path, &ReadLimits::default()).unwrap();
        let (whole, again) = (read(&path), read(&packed));
        assert_eq!((whole.points(), whole.vertex_fields()), (again.points(), again.vertex_fields()));
    }
}
