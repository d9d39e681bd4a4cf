//! Generated files of all point formats: complete, truncated, and with modified bytes.

mod writing;

use std::io::Cursor;
use std::path::{Path, PathBuf};

use adwave::Progress;
use laz::{LasZipCompressor, LazItemRecordBuilder, LazVlrBuilder};

use crate::ReadError;
use crate::formats::las::fields::record_bytes;
use crate::formats::las::read::{parse_header, u32_at, u64_at, unpacked};
use crate::formats::las::stream::LasReader;
use crate::formats::las::write::{compression_record, new_header, put};

/// Extra bytes of each record without a description.
const EXTRA: usize = 3;

fn rows(format: u8, n: usize) -> Vec<u8> {
    let size = record_bytes(format).unwrap() + EXTRA;
    let mut all = Vec::new();
    for i in 0..n as i32 {
        let mut row: Vec<u8> = (0..size).map(|k| (i as usize * (k % 3) / 50 + k) as u8).collect();
        for (axis, whole) in [i, 3 * i - 40, -(i % 17)].into_iter().enumerate() {
            put(&mut row, 4 * axis, whole.to_le_bytes());
        }
        // Return 1 + i % 3 of 3.
        row[14] = if format < 6 { (1 + i % 3) as u8 | 3 << 3 } else { (1 + i % 3) as u8 | 3 << 4 };
        all.extend(row);
    }
    all
}

/// Builds the content of a file before its points.
fn head(format: u8, n: usize, records: &[Vec<u8>], is_packed: bool) -> Vec<u8> {
    let size = record_bytes(format).unwrap() + EXTRA;
    let minor = if format < 6 { 2 } else { 4 };
    let mut head = new_header(minor, format, size as u16, [0.5, 0.25, 0.01], [10.0, -20.0, 30.0]);
    if format < 6 {
        put(&mut head, 107, (n as u32).to_le_bytes());
    } else {
        put(&mut head, 247, (n as u64).to_le_bytes());
    }
    let start = head.len() + records.iter().map(Vec::len).sum::<usize>();
    put(&mut head, 96, (start as u32).to_le_bytes());
    put(&mut head, 100, (records.len() as u32).to_le_bytes());
    head[104] |= if is_packed { 0x80 } else { 0 };
    head.extend(records.iter().flatten());
    head
}

fn las(format: u8, n: usize) -> Vec<u8> {
    [head(format, n, &[], false), rows(format, n)].concat()
}

#[derive(Clone, Copy, Debug)]
enum Chunks {
    Fixed(u32),
    Variable,
}

/// Builds a LAZ as written by another program.
fn laz(format: u8, n: usize, chunks: Chunks) -> Vec<u8> {
    let (points, size) = (rows(format, n), record_bytes(format).unwrap() + EXTRA);
    let items = LazItemRecordBuilder::default_for_point_format_id(format, EXTRA as u16).unwrap();
    let builder = LazVlrBuilder::new(items);
    let description = match chunks {
        Chunks::Fixed(n) => builder.with_fixed_chunk_size(n).build(),
        Chunks::Variable => builder.with_variable_chunk_size().build(),
    };
    let head = head(format, n, &[compression_record(&description)], true);
    let start = head.len();
    let mut out = Cursor::new(head);
    out.set_position(start as u64);
    let mut compressor = LasZipCompressor::new(&mut out, description).unwrap();
    match chunks {
        Chunks::Fixed(_) => compressor.compress_many(&points).unwrap(),
        Chunks::Variable => {
            let mut left = &points[..];
            for n in (1..).map(|k| 37 * (1 + k % 5) * size) {
                let (own, rest) = left.split_at(n.min(left.len()));
                compressor.compress_many(own).unwrap();
                left = rest;
                if left.is_empty() {
                    break;
                }
                compressor.finish_current_chunk().unwrap();
            }
        }
    }
    compressor.done().unwrap();
    drop(compressor);
    out.into_inner()
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn file(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }
}

/// Reads all points in blocks, and the error at the end, if any.
fn read_all(path: &Path, most: usize) -> (Vec<u8>, Option<ReadError>) {
    let mut all = Vec::new();
    let mut reader = match LasReader::open(path) {
        Ok(reader) => reader,
        Err(error) => return (all, Some(error)),
    };
    let size = reader.layout().record_bytes;
    loop {
        let before = all.len();
        match reader.read(most, &mut all) {
            Ok(0) => return (all, None),
            Ok(n) => assert!(n <= most && all.len() == before + n * size),
            Err(error) => {
                assert!(reader.read(most, &mut all).is_err());
                return (all, Some(error));
            }
        }
        // A modified header may state an excessive number of points.
        if all.len() > 1 << 22 {
            return (all, None);
        }
    }
}

fn read_whole(path: &Path, most: usize) -> Vec<u8> {
    let (all, error) = read_all(path, most);
    assert!(error.is_none(), "{error:?}");
    all
}

#[test]
fn portions_are_the_points_of_the_whole_file() {
    let folder = Folder::new();
    for format in 0..=10 {
        let (n, expected) = (1234, rows(format, 1234));
        let files = [
            las(format, n),
            laz(format, n, Chunks::Fixed(100)),
            laz(format, n, Chunks::Fixed(617)),
            laz(format, n, Chunks::Fixed(50_000)),
            laz(format, n, Chunks::Variable),
        ];
        for (k, bytes) in files.iter().enumerate() {
            let header = parse_header(bytes).unwrap();
            let whole = unpacked(bytes, &header, Progress::none()).unwrap();
            assert_eq!(&whole[..expected.len()], expected);
            let path = folder.file("a.laz", bytes);
            for most in [7, 100, 1000, usize::MAX] {
                assert!(read_whole(&path, most) == expected, "format {format}, file {k}, {most} at a time");
            }
        }
    }
}

#[test]
fn points_that_are_skipped_are_those_that_would_have_been_read() {
    let folder = Folder::new();
    for format in [0, 3, 6, 8] {
        let (n, expected) = (1234, rows(format, 1234));
        let size = record_bytes(format).unwrap() + EXTRA;
        let fixed = laz(format, n, Chunks::Fixed(100));
        let mut tableless = fixed.clone();
        let start = parse_header(&fixed).unwrap().points_start;
        let table = u64_at(&fixed, start).unwrap() as usize;
        tableless.truncate(table);
        put(&mut tableless, start, (-1_i64).to_le_bytes());
        let files = [las(format, n), fixed, tableless, laz(format, n, Chunks::Variable)];
        for (k, bytes) in files.iter().enumerate() {
            let path = folder.file("a.laz", bytes);
            for (skip, read) in [(0, 5), (99, 2), (100, 1), (101, 150), (350, 3), (1234, 1), (5000, 1)] {
                let mut reader = LasReader::open(&path).unwrap();
                let (mut at, mut rows) = (0, Vec::new());
                while at < n {
                    let skipped = reader.skip(skip).unwrap() as usize;
                    assert_eq!(skipped, (skip as usize).min(n - at), "format {format}, file {k}");
                    at += skipped;
                    rows.clear();
                    let n_read = reader.read(read, &mut rows).unwrap();
                    assert!(rows == expected[at * size..][..n_read * size], "format {format}, file {k}");
                    at += n_read;
                    assert!(n_read == read || at == n);
                }
            }
        }
    }
}

#[test]
fn a_chunk_that_is_long_is_unpacked_step_by_step() {
    let folder = Folder::new();
    for format in [1, 7] {
        for chunks in [Chunks::Fixed(50_000), Chunks::Fixed(4000), Chunks::Variable] {
            let path = folder.file("a.laz", &laz(format, 9000, chunks));
            assert!(read_whole(&path, 1001) == rows(format, 9000), "format {format}, {chunks:?}");
        }
    }
}

#[test]
fn a_missing_table_of_chunks_is_done_without() {
    let folder = Folder::new();
    for (format, chunks) in [(3, Chunks::Fixed(100)), (6, Chunks::Fixed(100)), (6, Chunks::Variable)] {
        let mut bytes = laz(format, 1234, chunks);
        let start = u32_at(&bytes, 96).unwrap() as usize;
        let table = u64_at(&bytes, start).unwrap() as usize;
        let expected = rows(format, 1234);
        // The position is at the end of the file, as from a program that could not seek back.
        let mut moved = [&bytes[..], &(table as u64).to_le_bytes()].concat();
        put(&mut moved, start, (-1_i64).to_le_bytes());
        assert!(read_whole(&folder.file("a.laz", &moved), 300) == expected);
        bytes.truncate(table);
        for position in [-1_i64, table as i64] {
            put(&mut bytes, start, position.to_le_bytes());
            assert!(read_whole(&folder.file("b.laz", &bytes), 300) == expected, "format {format}");
        }
        // An impossible number of chunks, and a chunk longer than the file.
        for broken in [[0xff; 16], [0, 0, 0, 0, 13, 0, 0, 0, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff]]
        {
            let bytes = [&bytes[..], &broken].concat();
            assert!(read_whole(&folder.file("c.laz", &bytes), 300) == expected, "format {format}");
        }
    }
    let mut bytes = laz(3, 1234, Chunks::Variable);
    let start = u32_at(&bytes, 96).unwrap() as usize;
    put(&mut bytes, start, (-1_i64).to_le_bytes());
    let error = LasReader::open(&folder.file("d.laz", &bytes)).err().unwrap().to_string();
    assert!(error.contains("the table of its chunks"), "{error}");
}

/// Point named in the message.
fn named_point(message: &str) -> Option<u64> {
    let at = message.find(" row ").map(|at| at + 5).or_else(|| message.find("at point ").map(|at| at + 9))?;
    message[at..].split(|c: char| !c.is_ascii_digit()).next()?.parse().ok()
}

#[test]
fn cut_files_name_the_point() {
    let folder = Folder::new();
    for format in [0, 3, 6, 8] {
        let expected = rows(format, 500);
        let size = record_bytes(format).unwrap() + EXTRA;
        for bytes in [las(format, 500), laz(format, 500, Chunks::Fixed(100))] {
            let start = u32_at(&bytes, 96).unwrap() as usize;
            let end =
                if bytes[104] & 0x80 == 0 { bytes.len() } else { u64_at(&bytes, start).unwrap() as usize };
            for cut in (start..end - 10).step_by(97) {
                let (read, error) = read_all(&folder.file("a.laz", &bytes[..cut]), 60);
                let message = error.unwrap().to_string();
                let point = named_point(&message).unwrap_or_else(|| panic!("{message}"));
                assert!(!message.contains('\n') && message.contains("a.laz"), "{message:?}");
                assert!(point < 500 && read.len() as u64 <= point * size as u64, "{message}");
                assert!(expected.starts_with(&read), "{message}");
                let is_plain = bytes[104] & 0x80 == 0;
                assert!(!is_plain || point == ((cut - start) / size) as u64, "{message}");
            }
            for cut in 0..start {
                assert!(LasReader::open(&folder.file("a.laz", &bytes[..cut])).is_err());
            }
        }
    }
}

#[test]
fn changed_bytes_give_one_line_or_points() {
    let folder = Folder::new();
    for format in [3, 7] {
        for bytes in [las(format, 60), laz(format, 60, Chunks::Fixed(20)), laz(format, 60, Chunks::Variable)]
        {
            let start = u32_at(&bytes, 96).unwrap() as usize;
            // All bytes that describe the points, and some bytes of the points.
            for at in (0..start + 8).chain((start + 8..bytes.len()).step_by(7)) {
                let mut changed = bytes.clone();
                changed[at] ^= 0xff;
                if let Some(error) = read_all(&folder.file("a.laz", &changed), 10_000).1 {
                    assert!(!error.to_string().contains('\n'), "{error}");
                }
            }
        }
    }
}

#[test]
fn a_promise_of_too_many_points_ends_where_the_points_do() {
    let folder = Folder::new();
    let many = 1_000_000_000_000_000_u64.to_le_bytes();
    for chunks in [Chunks::Fixed(100), Chunks::Fixed(50_000), Chunks::Variable] {
        let mut bytes = laz(6, 500, chunks);
        put(&mut bytes, 247, many);
        let path = folder.file("a.laz", &bytes);
        assert_eq!(LasReader::open(&path).unwrap().layout().n_points, u64::from_le_bytes(many));
        let (read, error) = read_all(&path, 60);
        let message = error.unwrap().to_string();
        assert!(named_point(&message).unwrap() >= 500 || matches!(chunks, Chunks::Fixed(_)), "{message}");
        assert!(read.len() < 1 << 16, "{}", read.len());
    }
    let mut bytes = las(6, 500);
    put(&mut bytes, 247, many);
    let message = LasReader::open(&folder.file("a.las", &bytes)).err().unwrap().to_string();
    assert_eq!(named_point(&message), Some(500), "{message}");
}
