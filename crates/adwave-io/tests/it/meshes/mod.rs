//! Tests of mesh and graph formats: handwritten files, real ones with the counts of other programs, and damaged ones.

mod geomview;
mod graphs;
mod manufacturing;
mod medit;
mod msh;
mod oddities;

use adwave_io::{Format, ReadLimits, ShapeFile, read_bytes, write_bytes};

fn read(bytes: &[u8], name: &str) -> ShapeFile {
    read_bytes(bytes.to_vec(), Some(name), &ReadLimits::default()).unwrap()
}

fn error(bytes: &[u8], name: &str) -> String {
    read_bytes(bytes.to_vec(), Some(name), &ReadLimits::default()).unwrap_err().to_string()
}

fn written(file: &ShapeFile, format: Format) -> Vec<u8> {
    let mut out = Vec::new();
    write_bytes(file, format, &mut out).unwrap();
    out
}

/// Checks that every modification of a byte, and every truncation of the file, gives a shape or an error of one line.
/// Calls `cut` for the truncations that give a shape.
fn survives(bytes: &[u8], name: &str, cut: impl Fn(usize, ShapeFile)) {
    let one_line = |bytes: Vec<u8>| match read_bytes(bytes, Some(name), &ReadLimits::default()) {
        Ok(file) => Some(file),
        Err(error) => {
            assert!(!error.to_string().contains('\n'), "{error}");
            None
        }
    };
    for end in 0..bytes.len() {
        if let Some(file) = one_line(bytes[..end].to_vec()) {
            cut(end, file);
        }
    }
    for at in 0..bytes.len() {
        for other in [0, b'-', b'9', 255, bytes[at] ^ 1] {
            let mut broken = bytes.to_vec();
            broken[at] = other;
            one_line(broken);
        }
    }
}
