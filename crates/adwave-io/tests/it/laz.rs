//! Tests of LAS and LAZ generated here, because no small compressed file can be distributed: points of formats 3 and
//! 7, complete, truncated, and with modified bytes.

use std::io::Cursor;

use adwave_io::{FieldValues, Format, ReadLimits, read_bytes};
use laz::{LasZipCompressor, LazItemRecordBuilder, LazVlr};

const N: usize = 300;
const N_POINTS: i32 = 300;

/// Records of `N` points and the size of each.
fn records(format: u8) -> (Vec<u8>, u16) {
    let size: u16 = if format == 3 { 34 } else { 36 };
    let mut all = Vec::new();
    for i in 0..N_POINTS {
        let mut record = vec![0; size.into()];
        for (axis, x) in [i, 2 * i, -i].into_iter().enumerate() {
            record[4 * axis..4 * axis + 4].copy_from_slice(&x.to_le_bytes());
        }
        record[12..14].copy_from_slice(&(i as u16 * 3).to_le_bytes());
        record[14] = if format == 3 { 0b0000_1001 } else { 0b0001_0001 };
        let color = if format == 3 { 28 } else { 30 };
        record[color..color + 2].copy_from_slice(&(i as u16 + 7).to_le_bytes());
        all.extend(record);
    }
    (all, size)
}

/// File with 100 points per chunk, so that there are several chunks.
fn file(format: u8, is_compressed: bool) -> Vec<u8> {
    let (points, size) = records(format);
    let items = LazItemRecordBuilder::default_for_point_format_id(format, 0).unwrap();
    let description = laz::LazVlrBuilder::new(items).with_fixed_chunk_size(100).build();
    let mut record = Vec::new();
    if is_compressed {
        let mut content = Vec::new();
        LazVlr::write_to(&description, &mut content).unwrap();
        record.extend([0, 0]);
        record.extend(b"laszip encoded\0\0");
        record.extend(22204_u16.to_le_bytes());
        record.extend((content.len() as u16).to_le_bytes());
        record.resize(54, 0);
        record.extend(content);
    }
    let header_size: u16 = if format == 3 { 227 } else { 375 };
    let mut bytes = vec![0; header_size.into()];
    let start = u32::from(header_size) + record.len() as u32;
    bytes[..4].copy_from_slice(b"LASF");
    bytes[24..26].copy_from_slice(&[1, if format == 3 { 2 } else { 4 }]);
    bytes[94..96].copy_from_slice(&header_size.to_le_bytes());
    bytes[96..100].copy_from_slice(&start.to_le_bytes());
    bytes[100..104].copy_from_slice(&u32::from(is_compressed).to_le_bytes());
    bytes[104] = format | if is_compressed { 0x80 } else { 0 };
    bytes[105..107].copy_from_slice(&size.to_le_bytes());
    bytes[107..111].copy_from_slice(&(N as u32).to_le_bytes());
    for (axis, offset) in [10.0, 20.0, 30.0_f64].into_iter().enumerate() {
        bytes[131 + 8 * axis..139 + 8 * axis].copy_from_slice(&0.5_f64.to_le_bytes());
        bytes[155 + 8 * axis..163 + 8 * axis].copy_from_slice(&offset.to_le_bytes());
    }
    if format >= 6 {
        bytes[247..255].copy_from_slice(&(N as u64).to_le_bytes());
    }
    bytes.extend(record);
    if is_compressed {
        let mut out = Cursor::new(bytes);
        out.set_position(start.into());
        let mut compressor = LasZipCompressor::new(&mut out, description).unwrap();
        compressor.compress_many(&points).unwrap();
        compressor.done().unwrap();
        drop(compressor);
        out.into_inner()
    } else {
        bytes.extend(points);
        bytes
    }
}

#[test]
fn compressed_and_plain_points_are_the_same() {
    for format in [3, 7] {
        let plain = read_bytes(file(format, false), None, &ReadLimits::default()).unwrap();
        let packed = read_bytes(file(format, true), None, &ReadLimits::default()).unwrap();
        assert_eq!((plain.format(), packed.format()), (Some(Format::LAS), Some(Format::LAZ)));
        assert_eq!(plain.points()[4], [12.0, 24.0, 28.0]);
        assert_eq!(plain.points(), packed.points());
        assert_eq!(plain.vertex_fields(), packed.vertex_fields());
        assert_eq!(plain.field("intensity").unwrap().get(5, 0), 15.0);
        assert_eq!(plain.field("color").unwrap().get(5, 0), 12.0);
        assert_eq!(plain.field("return_number").unwrap().values, FieldValues::U8(vec![1; N]));
        assert_eq!(plain.field("number_of_returns").unwrap().values, FieldValues::U8(vec![1; N]));
    }
}

#[test]
fn broken_files_give_one_line() {
    for format in [3, 7] {
        for is_compressed in [false, true] {
            let whole = file(format, is_compressed);
            for end in (0..whole.len()).step_by(7) {
                survives(whole[..end].to_vec());
            }
            for at in 0..whole.len() {
                let mut changed = whole.clone();
                changed[at] ^= 0xff;
                survives(changed);
            }
        }
    }
}

fn survives(bytes: Vec<u8>) {
    // Sizes in the file must not make the reader take more memory than this.
    let limits = ReadLimits { max_bytes: 1 << 26, ..ReadLimits::default() };
    if let Err(error) = read_bytes(bytes, Some("a.laz"), &limits) {
        let message = error.to_string();
        assert!(!message.contains('\n'), "{message:?}");
    }
}

#[test]
fn a_chunk_that_claims_more_points_than_it_has_hides_no_broken_chunk_behind_it() {
    // Their first chunk of ten points states 266; the second states a layer of over a gigabyte.
    let files: [&[u8]; 2] = [
        include_bytes!("../../../../fuzz/seeds/laz/chunk-claims-more-points.laz"),
        include_bytes!("../../../../fuzz/seeds/laz/chunks-smaller-than-they-claim.laz"),
    ];
    for bytes in files {
        let error =
            read_bytes(bytes.to_vec(), Some("a.laz"), &ReadLimits::default()).unwrap_err().to_string();
        assert!(error.contains("a layer is larger than the file"), "{error}");
    }
}
