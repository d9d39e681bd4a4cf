//! All scans of a file as one cloud, placed by their poses.

use std::cell::Cell;
use std::io::{self, Cursor, Read, Seek, SeekFrom};
use std::rc::Rc;

use adwave::Progress;
use e57::{E57Reader, PointCloud, Quaternion};

use super::record::{RecordLayout, ScanColumns};
use crate::model::shape_file::SCAN;
use crate::progress::report_row;
use crate::text::one_line;
use crate::{CoordinatePrecision, Field, FieldValues, FileRows, Format, ReadError, ReadLimits, ShapeFile};

/// Bytes that may be read ahead of their points: packets have up to 64 KiB.
const AHEAD: u64 = 1 << 22;

fn wrong(error: &e57::Error) -> ReadError {
    ReadError::Whole(format!("the E57 is damaged ({}); get the whole file", one_line(error)))
}

/// Reader of the bytes of a file that stops if one stream is read too far ahead of the others.
struct LookaheadReader {
    bytes: Cursor<Vec<u8>>,
    read: Rc<Cell<u64>>,
    most: Rc<Cell<u64>>,
}

impl Read for LookaheadReader {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        if self.read.get() > self.most.get() {
            return Err(io::Error::other("one of the streams is far ahead of the others"));
        }
        let n = self.bytes.read(into)?;
        self.read.set(self.read.get() + n as u64);
        Ok(n)
    }
}

impl Seek for LookaheadReader {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.bytes.seek(to)
    }
}

/// Reads an E57.
pub(crate) fn read_e57(
    bytes: Vec<u8>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let (read, most) = (Rc::new(Cell::new(0)), Rc::new(Cell::new(u64::MAX)));
    let watched =
        LookaheadReader { bytes: Cursor::new(bytes), read: Rc::clone(&read), most: Rc::clone(&most) };
    let mut file = E57Reader::new(watched).map_err(|e| wrong(&e))?;
    let scans = file.pointclouds();
    if scans.is_empty() {
        return Err(ReadError::Whole("the file contains no scan; export one with points".into()));
    }
    let mut shape = ShapeFile::empty();
    shape.format = Some(Format::E57);
    shape.precision = CoordinatePrecision::F32;
    let (mut points, mut columns, mut of_scan) = (Vec::new(), ScanColumns::default(), Vec::new());
    let (mut kept, mut n_before) = (Vec::new(), 0_u64);
    for (k, scan) in scans.iter().enumerate() {
        let layout = RecordLayout::new(scan, k)?;
        limits.check_points((points.len() as u64).saturating_add(scan.records))?;
        let pose = pose(scan);
        shape.viewpoints.push(pose.as_ref().map_or([0.0; 3], |pose| pose.shift));
        if pose.is_some() || !layout.is_single(scan) {
            shape.precision = CoordinatePrecision::F64;
        }
        let bits = layout.bits_of_a_point();
        let first = points.len();
        read.set(0);
        most.set(AHEAD);
        let places = columns.begin_scan(&layout);
        let records = file.pointcloud_raw(scan).map_err(|e| wrong(&e))?;
        for (row, record) in records.enumerate() {
            report_row(progress, row as u64, scan.records)?;
            let record = record.map_err(|e| wrong(&e))?;
            // The fraction of the pages used by checksums is small.
            most.set(AHEAD + (row as u64 + 1).saturating_mul(bits) / 7);
            if let Some(point) = layout.point(&record) {
                points.push(pose.as_ref().map_or(point, |pose| pose.place(point)));
                columns.push(&layout, &places, &record);
                of_scan.push(k as u32);
                kept.push((n_before + row as u64) as u32);
                if points.len() % (1 << 16) == 0 {
                    limits.check_bytes(points.len() as u64 * (24 + columns.bytes_of_a_row()))?;
                }
            }
        }
        columns.end_scan(points.len());
        n_before = n_before.saturating_add(scan.records);
        let n_left = scan.records.saturating_sub((points.len() - first) as u64);
        if n_left > 0 {
            shape.extras.push(format!("{n_left} records without a position in scan {k}"));
        }
    }
    shape.n_vertices = points.len();
    if n_before > kept.len() as u64 && u32::try_from(n_before).is_ok() {
        shape.rows = Some(std::sync::Arc::new(FileRows::new(n_before as usize, kept)));
    }
    shape.points = points.into();
    shape.vertex_fields = columns.into_fields(shape.n_vertices);
    if scans.len() > 1 {
        shape.vertex_fields.push(Field::new(SCAN, 1, FieldValues::U32(of_scan)));
        shape.extras.push(format!("the poses of {} scans", scans.len()));
    } else {
        shape.viewpoints.clear();
        if scans[0].transform.is_some() {
            shape.extras.push("the pose of the scan".into());
        }
    }
    match file.images().len() {
        0 => {}
        1 => shape.extras.push("1 picture".into()),
        n => shape.extras.push(format!("{n} pictures")),
    }
    Ok(shape)
}

/// Pose of a scan: a rotation followed by a translation.
struct Pose {
    turned: [[f64; 3]; 3],
    shift: [f64; 3],
}

impl Pose {
    fn place(&self, p: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|i| {
            let row = self.turned[i];
            row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + self.shift[i]
        })
    }
}

/// Pose of a scan; `None` if it is the identity.
fn pose(scan: &PointCloud) -> Option<Pose> {
    let transform = scan.transform.as_ref()?;
    let Quaternion { w, x, y, z } = transform.rotation;
    let shift = [transform.translation.x, transform.translation.y, transform.translation.z];
    // In some files the quaternion is 0 or not of length 1.
    let length = (w * w + x * x + y * y + z * z).sqrt();
    let [w, x, y, z] = if length > 0.0 && length.is_finite() {
        [w, x, y, z].map(|c| c / length)
    } else {
        [1.0, 0.0, 0.0, 0.0]
    };
    if [w, x, y, z] == [1.0, 0.0, 0.0, 0.0] && shift == [0.0; 3] {
        return None;
    }
    let turned = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
        [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
    ];
    Some(Pose { turned, shift })
}

#[cfg(test)]
mod tests {
    use super::*;
    use e57::{E57Writer, Record, RecordDataType, RecordName, RecordValue, Transform, Translation};

    /// A file with one scan in memory.
    fn file(prototype: &[Record], rows: &[Vec<RecordValue>], transform: Option<Transform>) -> Vec<u8> {
        file_of_scans(prototype, &[(rows.to_vec(), transform)])
    }

    fn file_of_scans(prototype: &[Record], scans: &[(Vec<Vec<RecordValue>>, Option<Transform>)]) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        let mut writer = E57Writer::new(&mut bytes, "file").unwrap();
        for (k, (rows, transform)) in scans.iter().enumerate() {
            let mut scan = writer.add_pointcloud(&format!("scan {k}"), prototype.to_vec()).unwrap();
            scan.set_transform(transform.clone());
            for row in rows {
                scan.add_point(row.clone()).unwrap();
            }
            scan.finalize().unwrap();
        }
        writer.finalize().unwrap();
        drop(writer);
        bytes.into_inner()
    }

    fn record(name: RecordName, data_type: RecordDataType) -> Record {
        Record { name, data_type }
    }

    fn small() -> Vec<u8> {
        let scaled =
            || RecordDataType::ScaledInteger { min: -100_000, max: 100_000, scale: 0.001, offset: 10.0 };
        let byte = RecordDataType::Integer { min: 0, max: 255 };
        let prototype = vec![
            record(RecordName::CartesianX, scaled()),
            record(RecordName::CartesianY, scaled()),
            record(RecordName::CartesianZ, scaled()),
            record(RecordName::CartesianInvalidState, RecordDataType::Integer { min: 0, max: 2 }),
            record(RecordName::Intensity, RecordDataType::Single { min: None, max: None }),
            record(RecordName::ColorRed, byte.clone()),
            record(RecordName::ColorGreen, byte.clone()),
            record(RecordName::ColorBlue, byte),
        ];
        let row = |k: i64, state: i64| {
            let s = RecordValue::ScaledInteger;
            let i = RecordValue::Integer;
            vec![s(k), s(2 * k), s(-k), i(state), RecordValue::Single(k as f32 / 8.0), i(k % 256), i(1), i(2)]
        };
        let rows: Vec<_> = (0..300).map(|k| row(k, if k == 7 { 2 } else { 0 })).collect();
        // A quarter turn about z and a translation by one along z.
        let half = 0.5_f64.sqrt();
        let rotation = Quaternion { w: half, x: 0.0, y: 0.0, z: half };
        file(
            &prototype,
            &rows,
            Some(Transform { rotation, translation: Translation { x: 0.0, y: 0.0, z: 1.0 } }),
        )
    }

    #[test]
    fn records_become_points_and_fields_in_the_place_of_the_scan() {
        let shape = crate::read_bytes(small(), None, &ReadLimits::default()).unwrap();
        assert_eq!((shape.format(), shape.n_vertices()), (Some(Format::E57), 299));
        let (x, y, z) = (10.0 + 0.008, 10.0 + 0.016, 10.0 - 0.008);
        let p = shape.points()[7];
        assert!(p.iter().zip([-y, x, z + 1.0]).all(|(a, b)| (a - b).abs() < 1e-9), "{p:?}");
        assert_eq!(shape.field_names(), ["intensity", "color"]);
        assert_eq!(shape.field("intensity").unwrap().values.value_type(), crate::ValueType::F32);
        assert_eq!(shape.field("color").unwrap().values.value_type(), crate::ValueType::U8);
        assert_eq!(
            (shape.field("intensity").unwrap().get(7, 0), shape.field("color").unwrap().get(7, 0)),
            (1.0, 8.0)
        );
        assert_eq!(shape.extras(), ["1 records without a position in scan 0", "the pose of the scan"]);
    }

    #[test]
    fn points_of_several_scans_know_from_where_they_were_seen() {
        let double = || RecordDataType::Double { min: None, max: None };
        let names = [RecordName::CartesianX, RecordName::CartesianY, RecordName::CartesianZ];
        let prototype = names.map(|name| record(name, double()));
        let rows = |n: usize| vec![[1.0, 2.0, 3.0].map(RecordValue::Double).to_vec(); n];
        let at = |z: f64| {
            let rotation = Quaternion { w: 1.0, x: 0.0, y: 0.0, z: 0.0 };
            Some(Transform { rotation, translation: Translation { x: 0.0, y: 0.0, z } })
        };
        let viewpoints = |scans: &[_]| {
            let bytes = file_of_scans(&prototype, scans);
            crate::read_bytes(bytes, None, &ReadLimits::default()).unwrap().viewpoints()
        };
        let seen = [[0.0; 3], [0.0; 3], [0.0, 0.0, 5.0]];
        assert_eq!(viewpoints(&[(rows(2), None), (rows(1), at(5.0))]), Some(seen.to_vec()));
        assert_eq!(viewpoints(&[(rows(2), at(5.0))]), None);
        assert_eq!(viewpoints(&[(rows(2), at(5.0)), (rows(1), at(5.0))]), None);
    }

    #[test]
    fn every_cut_is_an_error_and_changed_bytes_give_a_line_or_a_shape() {
        let whole = small();
        for end in (0..whole.len()).step_by(7) {
            assert!(crate::read_bytes(whole[..end].to_vec(), Some("a.e57"), &ReadLimits::default()).is_err());
        }
        // Checksums protect the pages, so they are recomputed after the change.
        let mut state = 3_u64;
        for _ in 0..300 {
            let mut bytes = whole.clone();
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let at = (state >> 33) as usize % bytes.len();
            bytes[at] = (state >> 20) as u8;
            for page in bytes.chunks_exact_mut(1024) {
                let sum = crc32c::crc32c(&page[..1020]);
                page[1020..].copy_from_slice(&sum.to_be_bytes());
            }
            if let Err(error) = crate::read_bytes(bytes, Some("a.e57"), &ReadLimits::default()) {
                assert!(!error.to_string().contains('\n'), "{error}");
            }
        }
    }

    #[test]
    fn scans_that_the_library_would_not_end_with_are_refused() {
        let whole = small();
        for (from, to) in [("maximum=\"2\"", "minimum=\"9\""), ("minimum=\"-100000\"", "minimum=\"+900000\"")]
        {
            assert_eq!(from.len(), to.len());
            let at = whole.windows(from.len()).position(|w| w == from.as_bytes()).unwrap();
            let mut bytes = whole.clone();
            bytes[at..at + to.len()].copy_from_slice(to.as_bytes());
            for page in bytes.chunks_exact_mut(1024) {
                let sum = crc32c::crc32c(&page[..1020]);
                page[1020..].copy_from_slice(&sum.to_be_bytes());
            }
            let error = crate::read_bytes(bytes, Some("a.e57"), &ReadLimits::default()).unwrap_err();
            assert!(!error.to_string().contains('\n'), "{error}");
        }
    }
}
