//! COPC 1.0 reader: a LAZ whose chunks are the nodes of an octree, with a hierarchy in pages of 32-byte entries.
//!
//! The first record after the header of 375 bytes has the user `copc`, the number 1 and 160 bytes: the center and
//! half the side of the root's cube, the spacing of its points, and the location of the first page. Source:
//! <https://copc.io>.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use adwave::Progress;
use rayon::prelude::*;

use crate::formats::las::part::image::Image;
use crate::formats::las::part::octree::{Entry, Key, Node, Root, chosen, runs, wrong};
use crate::formats::las::part::selection::Selection;
use crate::formats::las::read::{LEAST_HEADER, compression, f64_at, records, u32_at, u64_at};
use crate::formats::las::stream::LasReader;
use crate::formats::las::stream::coding::Coding;
use crate::{Format, ReadError, ReadLimits, ShapeFile};

/// Size of the header in bytes; the information record follows immediately.
const HEADER: usize = 375;
/// Offset of the content of that record.
const INFO: usize = HEADER + 54;
/// Size of a hierarchy entry in bytes.
const ENTRY: usize = 32;
/// Largest size of the nodes in memory, compressed and decompressed, in bytes; one more node may exceed it.
const MOST_WAITING: u64 = 1 << 26;
/// Nodes per thread in one batch, so that all threads end at about the same time.
const NODES_PER_THREAD: usize = 4;

/// Byte range in the file: start and length.
type Place = (u64, u64);

/// Description of the octree in the file.
pub(super) struct Info {
    pub(super) root: Root,
    first_page: Place,
}

impl Info {
    /// Reads the description from a COPC; `None` for another LAS or LAZ.
    pub(super) fn of(reader: &LasReader) -> Result<Option<Self>, ReadError> {
        let (head, header) = reader.head();
        let has_record = header.bytes == HEADER
            && header.bytes > LEAST_HEADER
            && head.len() >= INFO + 160
            && head[HEADER + 2..].starts_with(b"copc\0")
            && head[HEADER + 18..HEADER + 22] == [1, 0, 160, 0];
        if !has_record || !header.is_compressed {
            return Ok(None);
        }
        let number = |k: usize| f64_at(head, INFO + 8 * k).unwrap_or(f64::NAN);
        let whole = |k: usize| u64_at(head, INFO + 8 * k).unwrap_or(0);
        let half = number(3);
        let root = Root {
            low: [0, 1, 2].map(|axis| number(axis) - half),
            high: [0, 1, 2].map(|axis| number(axis) + half),
            spacing: number(4),
            rounding: header.scale,
        };
        if !root.is_valid() {
            let message = format!(
                "the octree has an invalid cube (half its side {half:?}) or spacing {:?}; get an undamaged \
                file",
                root.spacing
            );
            return Err(ReadError::at_byte(INFO, message));
        }
        Ok(Some(Self { root, first_page: (whole(5), whole(6)) }))
    }
}

/// Reads the selected part.
pub(super) fn read(
    path: &Path,
    reader: &LasReader,
    info: &Info,
    selection: &Selection,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let mut file = File::open(path)?;
    let nodes = nodes(&mut file, reader, info, selection, limits, progress)?;
    let mut image = Image::new(reader.head().0, &mut file, limits, progress)?;
    let coding = coding(reader)?;
    let (size, n) = (reader.layout().record_bytes as u64, nodes.len() as u64);
    for node in &nodes {
        // Both are allocated for a node.
        limits.check_bytes(node.n_points.saturating_mul(size).max(node.place.1))?;
    }
    let most = NODES_PER_THREAD * rayon::current_num_threads().max(1);
    let mut done = 0;
    for run in runs(&nodes, most, MOST_WAITING, |node| node.n_points * size + node.place.1) {
        progress.step(done, n)?;
        let packed = run.iter().map(|node| bytes_at(&mut file, node.place));
        let packed = packed.collect::<Result<Vec<_>, _>>()?;
        let unpacked: Vec<_> = run
            .par_iter()
            .zip(packed)
            .map(|(node, packed)| {
                let mut rows = unpacked(&coding, node, &packed)?;
                selection.retain(&mut rows, image.header());
                Ok(rows)
            })
            .collect();
        unpacked.into_iter().try_for_each(|rows: Result<_, ReadError>| image.add(&rows?))?;
        done += run.len() as u64;
    }
    if image.is_empty() {
        return Err(selection.empty(reader.layout().bounds.or(Some((info.root.low, info.root.high)))));
    }
    image.into_shape(Format::LAZ, limits, progress)
}

/// The chosen nodes, in their order.
pub(super) fn nodes(
    file: &mut File,
    reader: &LasReader,
    info: &Info,
    selection: &Selection,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<Vec<Node<Place>>, ReadError> {
    let (n_bytes, start) = (reader.n_bytes(), reader.head().1.points_start as u64);
    let mut n_listed = 0_u64;
    let page = |own: Key, place: Place| {
        // Pages are different parts of the file, so their total size cannot exceed it.
        n_listed = n_listed.saturating_add(place.1);
        if n_listed > n_bytes || !place.1.is_multiple_of(ENTRY as u64) {
            return Err(wrong(own, &format!("has a list of {} bytes, which is invalid", place.1)));
        }
        limits.check_bytes(n_listed)?;
        check_place(own, place, HEADER as u64, n_bytes)?;
        let bytes = bytes_at(file, place)?;
        let entries = bytes.chunks_exact(ENTRY).enumerate();
        entries.map(|(k, bytes)| entry(bytes, place.0 + (k * ENTRY) as u64)).collect()
    };
    let n_points = reader.layout().n_points;
    let nodes = chosen(&info.root, selection, n_points, info.first_page, page, progress)?;
    for node in &nodes {
        check_place(node.key, node.place, start, n_bytes)?;
    }
    Ok(nodes)
}

/// Parses the entry at that byte.
fn entry(bytes: &[u8], at: u64) -> Result<Entry<Place>, ReadError> {
    let number = |k: usize| i64::from(u32_at(bytes, k).map_or(0, u32::cast_signed));
    let (own, n_bytes) = ([0, 4, 8, 12].map(number), number(24));
    let Some(key) = Key::new(own) else {
        let [depth, x, y, z] = own;
        let message =
            format!("the hierarchy contains the invalid node {depth} {x} {y} {z}; get an undamaged file");
        return Err(ReadError::Byte { byte: at, message });
    };
    let Ok(n_bytes) = u64::try_from(n_bytes) else {
        return Err(wrong(key, &format!("has {n_bytes} bytes")));
    };
    Ok(Entry { key, count: number(28), place: (u64_at(bytes, 16).unwrap_or(0), n_bytes) })
}

/// Checks that the bytes of a node lie between the byte `first` and the end of the file.
fn check_place(key: Key, (start, n): Place, first: u64, n_bytes: u64) -> Result<(), ReadError> {
    let end = start.checked_add(n);
    if start >= first && end.is_some_and(|end| end <= n_bytes) {
        return Ok(());
    }
    Err(wrong(key, &format!("has {n} bytes from byte {start} on, outside the file of {n_bytes} bytes")))
}

fn bytes_at(file: &mut File, (start, n): Place) -> Result<Vec<u8>, ReadError> {
    let mut bytes = vec![0; n as usize];
    file.seek(SeekFrom::Start(start))?;
    file.read_exact(&mut bytes)?;
    Ok(bytes)
}

/// Compression of the points in the nodes.
fn coding(reader: &LasReader) -> Result<Coding, ReadError> {
    let (head, header) = reader.head();
    let start = header.points_start;
    let broken = |what: &str| {
        ReadError::at_byte(start, format!("the LAZ compression is damaged ({what}); get an undamaged file"))
    };
    let coding =
        Coding::of(compression(&records(head, header))?, header.record_bytes).map_err(|e| broken(&e))?;
    if coding.n_layers.is_none() {
        return Err(broken("the points of a COPC must be compressed in layers"));
    }
    Ok(coding)
}

/// Decompresses the records of a node.
fn unpacked(coding: &Coding, node: &Node<Place>, packed: &[u8]) -> Result<Vec<u8>, ReadError> {
    let broken = |what: &str| ReadError::Byte {
        byte: node.place.0,
        message: format!("node {} cannot be decompressed ({what}); get an undamaged file", node.key),
    };
    let stated = u32_at(packed, coding.record_bytes).map_or(0, u64::from);
    if stated != node.n_points {
        return Err(broken(&format!("it has {stated} points, but the hierarchy states {}", node.n_points)));
    }
    let mut rows = vec![0; node.n_points as usize * coding.record_bytes];
    coding.unpack(packed, &mut rows).map_err(|failure| broken(&failure.what()))?;
    Ok(rows)
}
