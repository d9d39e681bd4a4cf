//! Writer of small COPC and LAS files for tests and fuzzing: points on a spiral, three levels, with extra bytes and a
//! coordinate system.

use laz::laszip::{ChunkTable, ChunkTableEntry};
use laz::record::{LayeredPointRecordCompressor, RecordCompressor as _};
use laz::{LazItemRecordBuilder, LazVlr, LazVlrBuilder};
use std::collections::BTreeMap;

/// Size of a record in bytes: point format 6 and a 32-bit float.
pub(crate) const RECORD: usize = 34;
/// Size of a step of the coordinates.
pub(crate) const SCALE: f64 = 0.01;
/// Coordinates of step 0.
pub(crate) const OFFSET: [f64; 3] = [1000.0, 2000.0, 0.0];
/// Lowest corner of the octree.
pub(crate) const LOW: [f64; 3] = [990.0, 1990.0, -10.0];
/// Side of its cube.
pub(crate) const SIDE: f64 = 20.0;
/// Spacing of level 0.
pub(crate) const SPACING: f64 = 4.0;
/// Coordinate system.
pub(crate) const WKT: &str = "LOCAL_CS[\"somewhere\",UNIT[\"metre\",1]]";

/// Level, x, y and z of a node.
pub(crate) type Key = [u32; 4];

/// Point `i`, in steps.
pub(crate) fn steps(i: usize) -> [i32; 3] {
    let t = i as f64;
    [(900.0 * (0.37 * t).cos()) as i32, (900.0 * (0.37 * t).sin()) as i32, ((i * 37) % 1800) as i32 - 900]
}

/// Point `i`, in model units.
pub(crate) fn point(i: usize) -> [f64; 3] {
    let steps = steps(i);
    [0, 1, 2].map(|a| f64::from(steps[a]) * SCALE + OFFSET[a])
}

/// Node of point `i`: one in eight in level 0, one in eight in level 1, the others in level 2.
pub(crate) fn node(i: usize) -> Key {
    let depth = [0, 1, 2, 2, 2, 2, 2, 2][i % 8];
    let place = [0, 1, 2].map(|a| ((point(i)[a] - LOW[a]) / SIDE * f64::from(1 << depth)) as u32);
    [depth, place[0], place[1], place[2]]
}

/// Record of point `i`: its intensity is `i`, its extra bytes are `i / 2`.
pub(crate) fn record(i: usize) -> [u8; RECORD] {
    let mut record = [0; RECORD];
    for (a, steps) in steps(i).into_iter().enumerate() {
        record[4 * a..4 * a + 4].copy_from_slice(&steps.to_le_bytes());
    }
    record[12..14].copy_from_slice(&(i as u16).to_le_bytes());
    record[14] = 0b1_0001;
    record[30..].copy_from_slice(&(i as f32 / 2.0).to_le_bytes());
    record
}

/// Points `0..n` by their nodes.
pub(crate) fn nodes(n: usize) -> BTreeMap<Key, Vec<usize>> {
    let mut nodes: BTreeMap<Key, Vec<usize>> = BTreeMap::new();
    (0..n).for_each(|i| nodes.entry(node(i)).or_default().push(i));
    nodes
}

fn variable_record(user: &str, id: u16, content: &[u8]) -> Vec<u8> {
    let mut record = vec![0; 54];
    record[2..2 + user.len()].copy_from_slice(user.as_bytes());
    record[18..20].copy_from_slice(&id.to_le_bytes());
    record[20..22].copy_from_slice(&(content.len() as u16).to_le_bytes());
    record.extend(content);
    record
}

/// Records of the coordinate system and the extra bytes.
fn descriptions() -> Vec<Vec<u8>> {
    let mut extra = vec![0; 192];
    extra[2] = 9;
    extra[4..13].copy_from_slice(b"amplitude");
    let wkt = [WKT.as_bytes(), &[0]].concat();
    vec![variable_record("LASF_Projection", 2112, &wkt), variable_record("LASF_Spec", 4, &extra)]
}

/// Header of version 1.4 for these points, followed by the records.
fn head(points: &[usize], records: &[Vec<u8>], is_compressed: bool) -> Vec<u8> {
    let mut head = vec![0; 375];
    let mut put = |at: usize, bytes: &[u8]| head[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, b"LASF");
    put(6, &[16]);
    put(24, &[1, 4]);
    put(94, &375_u16.to_le_bytes());
    let start = 375 + records.iter().map(Vec::len).sum::<usize>();
    put(96, &(start as u32).to_le_bytes());
    put(100, &(records.len() as u32).to_le_bytes());
    put(104, &[if is_compressed { 6 | 0x80 } else { 6 }]);
    put(105, &(RECORD as u16).to_le_bytes());
    for (a, offset) in OFFSET.iter().enumerate() {
        let coordinates = || points.iter().map(|&i| point(i)[a]);
        put(131 + 8 * a, &SCALE.to_le_bytes());
        put(155 + 8 * a, &offset.to_le_bytes());
        put(179 + 16 * a, &coordinates().fold(f64::NEG_INFINITY, f64::max).to_le_bytes());
        put(187 + 16 * a, &coordinates().fold(f64::INFINITY, f64::min).to_le_bytes());
    }
    put(247, &(points.len() as u64).to_le_bytes());
    put(255, &(points.len() as u64).to_le_bytes());
    head.extend(records.iter().flatten());
    head
}

/// A LAS of these points.
pub(crate) fn las(points: &[usize]) -> Vec<u8> {
    let mut file = head(points, &descriptions(), false);
    file.extend(points.iter().flat_map(|&i| record(i)));
    file
}

/// COPC, and the start of its hierarchy: the entry of the root, entries (or, with `pages`, pages) of level 1, then
/// level 2.
pub(crate) struct Copc {
    pub(crate) bytes: Vec<u8>,
    pub(crate) hierarchy: usize,
}

/// Points `0..n` as a COPC; with `has_pages` each node of level 1 has a page of its own.
pub(crate) fn copc(n: usize, has_pages: bool) -> Copc {
    let items = LazItemRecordBuilder::default_for_point_format_id(6, 4).unwrap();
    let vlr = LazVlrBuilder::new(items).with_variable_chunk_size().build();
    let mut compression = Vec::new();
    LazVlr::write_to(&vlr, &mut compression).unwrap();
    let mut info = Vec::new();
    (0..3).for_each(|a| info.extend((LOW[a] + SIDE / 2.0).to_le_bytes()));
    info.extend([SIDE / 2.0, SPACING].iter().flat_map(|x| x.to_le_bytes()));
    info.resize(160, 0);
    let mut records =
        vec![variable_record("copc", 1, &info), variable_record("laszip encoded", 22204, &compression)];
    records.extend(descriptions());
    let mut bytes = head(&(0..n).collect::<Vec<_>>(), &records, true);
    let start = bytes.len();
    bytes.extend([0; 8]);
    let (mut table, mut entries) = (ChunkTable::default(), BTreeMap::new());
    for (key, points) in nodes(n) {
        let mut compressor = LayeredPointRecordCompressor::new(Vec::new());
        compressor.set_fields_from(vlr.items()).unwrap();
        for &i in &points {
            compressor.compress_next(&record(i)).unwrap();
        }
        compressor.done().unwrap();
        let chunk = compressor.into_inner();
        entries.insert(key, entry(key, bytes.len() as u64, chunk.len() as i32, points.len() as i32));
        table.push(ChunkTableEntry { point_count: points.len() as u64, byte_count: chunk.len() as u64 });
        bytes.extend(chunk);
    }
    let table_start = bytes.len() as u64;
    bytes[start..start + 8].copy_from_slice(&table_start.to_le_bytes());
    table.write_to(&mut bytes, &vlr).unwrap();
    let hierarchy = with_hierarchy(&mut bytes, entries, has_pages);
    Copc { bytes, hierarchy }
}

/// An entry of a hierarchy.
pub(crate) fn entry(key: Key, offset: u64, n_bytes: i32, n_points: i32) -> Vec<u8> {
    let mut entry: Vec<u8> = key.iter().flat_map(|k| k.to_le_bytes()).collect();
    entry.extend(offset.to_le_bytes());
    entry.extend(n_bytes.to_le_bytes());
    entry.extend(n_points.to_le_bytes());
    entry
}

/// Appends the extended record of the hierarchy; returns the start of its first page.
fn with_hierarchy(bytes: &mut Vec<u8>, entries: BTreeMap<Key, Vec<u8>>, has_pages: bool) -> usize {
    let record = bytes.len();
    let first = record + 60;
    let parent = |key: &Key| if key[0] < 2 { *key } else { [1, key[1] / 2, key[2] / 2, key[3] / 2] };
    // Nodes without points are listed if they have descendants.
    let mut entries = entries;
    for key in entries.keys().map(parent).collect::<Vec<_>>() {
        entries.entry(key).or_insert_with(|| entry(key, 0, 0, 0));
    }
    let mut pages: BTreeMap<Key, Vec<u8>> = BTreeMap::new();
    for (key, entry) in entries {
        let page = if has_pages { parent(&key) } else { [0; 4] };
        pages.entry(page).or_default().extend(entry);
    }
    // The first page has the root and a line for each of the others.
    let root = pages.remove(&[0; 4]).unwrap_or_default();
    let n_first = root.len() + 32 * pages.len();
    let (mut list, mut rest) = (root, Vec::<u8>::new());
    for (key, page) in &pages {
        list.extend(entry(*key, (first + n_first + rest.len()) as u64, page.len() as i32, -1));
        rest.extend(page);
    }
    list.extend(rest);
    let mut head = vec![0; 60];
    head[2..6].copy_from_slice(b"copc");
    head[18..20].copy_from_slice(&1000_u16.to_le_bytes());
    head[20..28].copy_from_slice(&(list.len() as u64).to_le_bytes());
    bytes.extend(head);
    bytes.extend(list);
    bytes[235..243].copy_from_slice(&(record as u64).to_le_bytes());
    bytes[243..247].copy_from_slice(&1_u32.to_le_bytes());
    bytes[469..477].copy_from_slice(&(first as u64).to_le_bytes());
    bytes[477..485].copy_from_slice(&(n_first as u64).to_le_bytes());
    first
}
