//! Progress reports and cancellation checks of readers and writers: once per several thousand rows, or per mebibyte.

use std::io::{self, Write};
use std::ops::Range;

use adwave::pages::with_capacity;
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// Rows between two checks: some milliseconds of the slowest format.
const ROWS_PER_STEP: u64 = 8192;
/// Bytes written between two checks: compressing them takes some milliseconds.
const WRITTEN_PER_STEP: usize = 1 << 18;
/// Rows processed in parallel between two checks.
const ROWS_PER_BLOCK: usize = 1 << 17;
/// Largest number of rows that the calling thread processes alone, without starting a thread pool.
pub(crate) const SERIAL: usize = 4096;
/// Bytes read, written or searched between two checks.
pub(crate) const BYTES_PER_STEP: usize = 1 << 20;

/// Reports row `row` of `n_rows` periodically; called before each row.
#[inline]
pub(crate) fn report_row(progress: Progress<'_>, row: u64, n_rows: u64) -> Result<(), Cancelled> {
    if row.is_multiple_of(ROWS_PER_STEP) { progress.step(row, n_rows) } else { Ok(()) }
}

/// Appends `value(i)` for each `i` in `0..n`, on all threads of the pool if there are many.
pub(crate) fn extend<T: Send>(
    values: &mut Vec<T>,
    n: usize,
    progress: Progress<'_>,
    value: impl Fn(usize) -> T + Sync + Send,
) -> Result<(), Cancelled> {
    values.reserve_exact(n);
    if n <= SERIAL {
        progress.check()?;
        values.extend((0..n).map(value));
        return Ok(());
    }
    extend_by_chunks(values, n, progress, &|rows| rows.map(&value).collect())
}

/// Appends the values of each chunk of `0..n`, in order.
///
/// The work is called through a pointer, so this is compiled once per type of value. Compiled once per caller, the
/// loops of the thread pool were a third of the time in which this crate is built.
fn extend_by_chunks<T: Send>(
    values: &mut Vec<T>,
    n: usize,
    progress: Progress<'_>,
    chunk: &(dyn Fn(Range<usize>) -> Vec<T> + Sync),
) -> Result<(), Cancelled> {
    let mut first = 0;
    while first < n {
        progress.step(first as u64, n as u64)?;
        let end = (first + ROWS_PER_BLOCK).min(n);
        let chunks: Vec<Vec<T>> = map_items((end - first).div_ceil(SERIAL), |k| {
            let start = first + k * SERIAL;
            chunk(start..(start + SERIAL).min(end))
        });
        for mut part in chunks {
            values.append(&mut part);
        }
        first = end;
    }
    Ok(())
}

/// Results of `work(i)` for each `i` in `0..n`, in order, on all threads of the pool.
fn map_items<R: Send>(n: usize, work: impl Fn(usize) -> R + Sync) -> Vec<R> {
    let work: &(dyn Fn(usize) -> R + Sync) = &work;
    (0..n).into_par_iter().map(work).collect()
}

/// Collects the values `value(i)` for each `i` in `0..n`; see [`extend`].
pub(crate) fn collect<T: Send>(
    n: usize,
    progress: Progress<'_>,
    value: impl Fn(usize) -> T + Sync + Send,
) -> Result<Vec<T>, Cancelled> {
    let mut values = with_capacity(n);
    extend(&mut values, n, progress, value)?;
    Ok(values)
}

/// True if the predicate holds for all `0..n`; evaluated in blocks.
pub(crate) fn all(
    n: usize,
    progress: Progress<'_>,
    holds: impl Fn(usize) -> bool + Sync + Send,
) -> Result<bool, Cancelled> {
    if n <= SERIAL {
        return Ok((0..n).all(holds));
    }
    let mut first = 0;
    while first < n {
        progress.check()?;
        let end = (first + 8 * ROWS_PER_BLOCK).min(n);
        let chunks = map_items((end - first).div_ceil(SERIAL), |k| {
            let start = first + k * SERIAL;
            (start..(start + SERIAL).min(end)).all(&holds)
        });
        if chunks.contains(&false) {
            return Ok(false);
        }
        first = end;
    }
    Ok(true)
}

/// Writer that stops when the call is cancelled; it checks after a number of bytes, regardless of the size of single
/// writes.
pub(crate) struct CancellableWriter<'a> {
    out: &'a mut dyn Write,
    progress: Progress<'a>,
    since: usize,
}

impl<'a> CancellableWriter<'a> {
    pub(crate) fn new(out: &'a mut dyn Write, progress: Progress<'a>) -> Self {
        Self { out, progress, since: 0 }
    }
}

impl Write for CancellableWriter<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.since >= WRITTEN_PER_STEP {
            self.since = 0;
            // `io::Error` is the only error type of `write`; `WriteError` extracts the cause.
            self.progress.check().map_err(io::Error::other)?;
        }
        let n = self.out.write(&bytes[..bytes.len().min(WRITTEN_PER_STEP)])?;
        self.since += n;
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::AtomicBool;

    #[test]
    fn large_and_small_lists_are_the_same_values_in_order() {
        for n in [0, 1, SERIAL, SERIAL + 1, 3 * ROWS_PER_BLOCK + 5] {
            assert_eq!(
                collect(n, Progress::none(), |i| 3 * i).unwrap(),
                (0..n).map(|i| 3 * i).collect::<Vec<_>>()
            );
            assert_eq!(all(n, Progress::none(), |i| i < n), Ok(true));
            assert_eq!(all(n, Progress::none(), |i| i + 1 < n), Ok(n == 0));
        }
    }

    #[test]
    fn one_large_write_stops_too() {
        let stop = AtomicBool::new(true);
        let mut bytes = Vec::new();
        let mut out = CancellableWriter::new(&mut bytes, Progress::none().with_cancel(&stop));
        let error = out.write_all(&vec![0; 1 << 24]).unwrap_err();
        assert!(matches!(crate::WriteError::from(error), crate::WriteError::Cancelled(Cancelled)));
        assert_eq!(bytes.len(), WRITTEN_PER_STEP);
    }
}
