//! Encoding of the numbers in an array of a GIFTI.

use std::io::Write;

use adwave::Progress;
use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;
use flate2::Compression;
use flate2::write::ZlibEncoder;

use crate::model::field::{ByteOrder, Number, with_values};
use crate::{FieldValues, ValueType, WriteError};

/// Encoding of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    /// Decimal numbers.
    Text,
    /// Bytes in Base64.
    Base64,
    /// Bytes compressed by zlib, in Base64.
    ZlibBase64,
}

/// Storage of an array.
#[derive(Clone, Copy, Debug)]
pub(super) struct Numbers {
    pub(super) kind: ValueType,
    pub(super) order: ByteOrder,
    pub(super) encoding: Encoding,
    /// True if the first index runs fastest.
    pub(super) by_column: bool,
    pub(super) rows: usize,
    pub(super) columns: usize,
}

/// Numbers converted between two checks for cancellation.
const NUMBERS_PER_STEP: usize = 8192;

impl Numbers {
    /// Writes the element with the numbers; `value(i)` is number i by rows.
    pub(super) fn write(
        &self,
        out: &mut dyn Write,
        progress: Progress<'_>,
        value: impl Fn(usize) -> f64,
    ) -> Result<(), WriteError> {
        out.write_all(b"<Data>")?;
        match self.encoding {
            Encoding::Text => self.write_all(out, progress, value)?,
            Encoding::Base64 => {
                let mut base64 = EncoderWriter::new(&mut *out, &STANDARD);
                self.write_all(&mut base64, progress, value)?;
                base64.finish()?;
            }
            Encoding::ZlibBase64 => {
                let base64 = EncoderWriter::new(&mut *out, &STANDARD);
                let mut zlib = ZlibEncoder::new(base64, Compression::default());
                self.write_all(&mut zlib, progress, value)?;
                zlib.finish()?.finish()?;
            }
        }
        Ok(out.write_all(b"</Data>")?)
    }

    fn write_all(
        &self,
        out: &mut dyn Write,
        progress: Progress<'_>,
        value: impl Fn(usize) -> f64,
    ) -> Result<(), WriteError> {
        let n = self.rows * self.columns;
        let at = |k: usize| if self.by_column { k % self.rows * self.columns + k / self.rows } else { k };
        let mut bytes = Vec::new();
        for first in (0..n).step_by(NUMBERS_PER_STEP) {
            progress.step(first as u64, n as u64)?;
            let mut numbers = self.kind.empty();
            let chunk = first..(first + NUMBERS_PER_STEP).min(n);
            with_values!(&mut numbers, v => for k in chunk {
                v.push(Number::from_f64(value(at(k))));
            });
            bytes.clear();
            for i in 0..numbers.len() {
                if self.encoding == Encoding::Text {
                    numbers.write_text(i, &mut bytes);
                    bytes.push(if (first + i + 1).is_multiple_of(self.columns) { b'\n' } else { b' ' });
                } else {
                    numbers.write_bytes(i, self.order, &mut bytes);
                }
            }
            out.write_all(&bytes)?;
        }
        Ok(())
    }
}
