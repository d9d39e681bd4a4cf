//! Loops over the vertices of a shape: by all threads of the pool on a large shape, by the calling thread alone on
//! a small one.
//!
//! All results have the same bits on any number of threads: work is cut into chunks whose size does not depend on
//! the number of threads, and partial results are combined in the order of the chunks. Up to [`SERIAL`] rows no
//! thread pool is used or started. Every loop checks its [`Progress`] before each chunk, so a call stops within the
//! time of one chunk.
//!
//! Work on a chunk is called through a pointer that knows only the number of the chunk, so the two loops of the thread
//! pool are compiled once. Compiled per caller or per type of result, they were a quarter of this crate.

use crate::pages::zeros;
use crate::{Cancelled, Progress};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Number of rows up to which the calling thread works alone: handing the work over would take longer, and a
/// process that only handles small shapes starts no threads.
pub(crate) const SERIAL: usize = 4096;

/// Number of rows at a time up to which a row costs so much that a few of them are worth several threads.
const COSTLY: usize = 64;

/// Number of values of a row from which more of them count as more rows.
const WIDEST: usize = 16;

/// Number of values up to which the calling thread sorts alone: a mesh of [`SERIAL`] vertices has six times as many
/// edges.
const SORTED_SERIALLY: usize = 8 * SERIAL;

/// Number of terms that a thread sums before partial sums are added in order.
const TERMS_AT_A_TIME: usize = 8192;

/// Sum of term(i) for i in `0..n`, with the same bits on any number of threads.
pub(crate) fn sum(n: usize, term: impl Fn(usize) -> f64 + Sync) -> f64 {
    let chunk = |range: Range<usize>| range.map(&term).sum::<f64>();
    map_chunks(n, TERMS_AT_A_TIME, chunk).into_iter().sum()
}

/// Largest term(i) for i in `0..n`, or `floor` if no term is larger.
pub(crate) fn max(n: usize, floor: f64, term: impl Fn(usize) -> f64 + Sync) -> f64 {
    let chunk = |range: Range<usize>| range.map(&term).fold(floor, f64::max);
    map_chunks(n, TERMS_AT_A_TIME, chunk).into_iter().fold(floor, f64::max)
}

/// Range of the given chunk of `0..n`.
fn nth(n: usize, at_a_time: usize, chunk: usize) -> Range<usize> {
    chunk * at_a_time..((chunk + 1) * at_a_time).min(n)
}

/// Calls `work(chunk)` for each chunk, on all threads of the pool or, if there is little to do, on this one alone.
/// Stops if the call is cancelled.
fn each_chunk(
    n_chunks: usize,
    is_small: bool,
    progress: Progress<'_>,
    work: &(dyn Fn(usize) + Sync),
) -> Result<(), Cancelled> {
    let asked = |chunk| progress.check().map(|()| work(chunk));
    if is_small {
        (0..n_chunks).try_for_each(asked)
    } else {
        (0..n_chunks).into_par_iter().with_max_len(1).try_for_each(asked)
    }
}

/// Work on a chunk with its own scratch data.
type Worker<'a> = Box<dyn FnMut(usize) + 'a>;

/// [`each_chunk`] with workers; one worker per thread is created, or a few more.
fn each_chunk_by_workers<'a>(
    n_chunks: usize,
    is_small: bool,
    progress: Progress<'_>,
    worker: &(dyn Fn() -> Worker<'a> + Sync),
) -> Result<(), Cancelled> {
    let asked = |worker: &mut Worker<'a>, chunk| progress.check().map(|()| worker(chunk));
    if is_small {
        let mut worker = worker();
        (0..n_chunks).try_for_each(|chunk| asked(&mut worker, chunk))
    } else {
        (0..n_chunks).into_par_iter().try_for_each_init(worker, asked)
    }
}

/// Locks a slot that only one chunk reads and writes, so that no thread waits.
fn lock_slot<T>(slot: &Mutex<T>) -> MutexGuard<'_, T> {
    slot.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Results by chunk.
struct Slots<R>(Vec<Mutex<Option<R>>>);

impl<R> Slots<R> {
    fn new(n_chunks: usize) -> Self {
        Self((0..n_chunks).map(|_| Mutex::new(None)).collect())
    }

    fn set(&self, chunk: usize, result: R) {
        *lock_slot(&self.0[chunk]) = Some(result);
    }

    /// The results in the order of the chunks, each of which has been set.
    fn into_results(self) -> Vec<R> {
        let result = |slot: Mutex<Option<R>>| slot.into_inner().unwrap_or_else(PoisonError::into_inner);
        self.0.into_iter().map(|slot| result(slot).expect("each chunk sets its result")).collect()
    }
}

/// Results of `work(rows)` for each chunk of the rows `0..n`, in order.
pub(crate) fn map_chunks<R: Send>(
    n: usize,
    at_a_time: usize,
    work: impl Fn(Range<usize>) -> R + Sync + Send,
) -> Vec<R> {
    map_items(n, n.div_ceil(at_a_time), |chunk| work(nth(n, at_a_time, chunk)))
}

/// [`map_chunks`] with scratch data created once per thread; stops if the call is cancelled.
pub(crate) fn try_map_chunks<S, R: Send>(
    n: usize,
    at_a_time: usize,
    progress: Progress<'_>,
    scratch: impl Fn() -> S + Sync + Send,
    work: impl Fn(&mut S, Range<usize>) -> R + Sync + Send,
) -> Result<Vec<R>, Cancelled> {
    let n_chunks = n.div_ceil(at_a_time);
    let results = Slots::new(n_chunks);
    let worker = || -> Worker<'_> {
        let mut own = scratch();
        let (work, results) = (&work, &results);
        Box::new(move |chunk| results.set(chunk, work(&mut own, nth(n, at_a_time, chunk))))
    };
    each_chunk_by_workers(n_chunks, n <= SERIAL && at_a_time > COSTLY, progress, &worker)?;
    Ok(results.into_results())
}

/// Calls `work(first row, rows)` for each chunk of the rows of `values`, with `width` values per row.
pub(crate) fn visit_rows<T: Send>(
    values: &mut [T],
    width: usize,
    at_a_time: usize,
    work: impl Fn(usize, &mut [T]) + Sync + Send,
) {
    let done = try_visit_rows(values, width, at_a_time, Progress::none(), work);
    debug_assert!(done.is_ok(), "nobody can stop this");
}

/// [`visit_rows`]; stops if the call is cancelled.
pub(crate) fn try_visit_rows<T: Send>(
    values: &mut [T],
    width: usize,
    at_a_time: usize,
    progress: Progress<'_>,
    work: impl Fn(usize, &mut [T]) + Sync + Send,
) -> Result<(), Cancelled> {
    try_map_rows(values, width, at_a_time, progress, work).map(|_: Vec<()>| ())
}

/// [`try_map_rows`] that nothing can stop.
pub(crate) fn map_rows<T: Send, R: Send>(
    values: &mut [T],
    width: usize,
    at_a_time: usize,
    work: impl Fn(usize, &mut [T]) -> R + Sync + Send,
) -> Vec<R> {
    expect_not_cancelled(try_map_rows(values, width, at_a_time, Progress::none(), work))
}

/// Results of `work(first row, rows)` for each chunk of the rows of `values`, with `width` values per row, in the
/// order of the chunks.
pub(crate) fn try_map_rows<T: Send, R: Send>(
    values: &mut [T],
    width: usize,
    at_a_time: usize,
    progress: Progress<'_>,
    work: impl Fn(usize, &mut [T]) -> R + Sync + Send,
) -> Result<Vec<R>, Cancelled> {
    let is_small = values.len() <= SERIAL * width.min(WIDEST);
    let parts: Vec<Mutex<&mut [T]>> = values.chunks_mut((at_a_time * width).max(1)).map(Mutex::new).collect();
    let results = Slots::new(parts.len());
    each_chunk(parts.len(), is_small, progress, &|chunk| {
        results.set(chunk, work(chunk * at_a_time, &mut lock_slot(&parts[chunk])));
    })?;
    Ok(results.into_results())
}

/// Values at `0..n`, computed by chunks of rows.
pub(crate) fn collect<T: Clone + Default + Send>(
    n: usize,
    value: impl Fn(usize) -> T + Sync + Send,
) -> Vec<T> {
    let mut values = zeros(n);
    visit_rows(&mut values, 1, SERIAL, |first, rows| {
        for (x, slot) in (first..).zip(rows) {
            *slot = value(x);
        }
    });
    values
}

/// Results of `work(i)` for a few items `i` that each cost about as much as reading `n_rows` rows, in order.
pub(crate) fn map_items<R: Send>(
    n_rows: usize,
    n_items: usize,
    work: impl Fn(usize) -> R + Sync + Send,
) -> Vec<R> {
    let results = Slots::new(n_items);
    let done = each_chunk(n_items, n_rows <= SERIAL, Progress::none(), &|item| results.set(item, work(item)));
    expect_not_cancelled(done);
    results.into_results()
}

/// Values at `0..n`, computed by chunks of rows; stops if the call is cancelled.
pub(crate) fn try_collect<T: Clone + Default + Send>(
    n: usize,
    progress: Progress<'_>,
    value: impl Fn(usize) -> T + Sync + Send,
) -> Result<Vec<T>, Cancelled> {
    let mut values = zeros(n);
    try_visit_rows(&mut values, 1, SERIAL, progress, |first, rows| {
        for (x, slot) in (first..).zip(rows) {
            *slot = value(x);
        }
    })?;
    Ok(values)
}

/// [`sum`]; stops if the call is cancelled.
pub(crate) fn try_sum(
    n: usize,
    progress: Progress<'_>,
    term: impl Fn(usize) -> f64 + Sync + Send,
) -> Result<f64, Cancelled> {
    let chunk = |(): &mut (), range: Range<usize>| range.map(&term).sum::<f64>();
    Ok(try_map_chunks(n, TERMS_AT_A_TIME, progress, || (), chunk)?.into_iter().sum())
}

/// Results of `work(item)` for each of some items, which are parts of `n_rows` rows, in order; stops if the call is
/// cancelled.
pub(crate) fn try_map_owned<T: Send, R: Send>(
    items: Vec<T>,
    n_rows: usize,
    progress: Progress<'_>,
    work: impl Fn(T) -> R + Sync + Send,
) -> Result<Vec<R>, Cancelled> {
    let items: Vec<Mutex<Option<T>>> = items.into_iter().map(|item| Mutex::new(Some(item))).collect();
    let results = Slots::new(items.len());
    each_chunk(items.len(), n_rows <= SERIAL, progress, &|i| {
        let item = lock_slot(&items[i]).take().expect("each item is taken once");
        results.set(i, work(item));
    })?;
    Ok(results.into_results())
}

/// Calls `work(item)` for each of some items, which are parts of `n_rows` rows.
pub(crate) fn try_each<T: Send>(
    items: Vec<T>,
    n_rows: usize,
    progress: Progress<'_>,
    work: impl Fn(T) -> Result<(), Cancelled> + Sync + Send,
) -> Result<(), Cancelled> {
    try_map_owned(items, n_rows, progress, work)?.into_iter().collect()
}

/// Sums over i in `0..n` of what `add(i, sums)` adds to `n_sums` of them, with the same bits on any number of threads.
pub(crate) fn sums(n: usize, n_sums: usize, add: impl Fn(usize, &mut [f64]) + Sync + Send) -> Vec<f64> {
    let chunk = |range: Range<usize>| {
        let mut sums = vec![0.0; n_sums];
        range.for_each(|i| add(i, &mut sums));
        sums
    };
    let parts = map_chunks(n, TERMS_AT_A_TIME, chunk);
    (0..n_sums).map(|k| parts.iter().map(|part| part[k]).sum()).collect()
}

/// Result of a call with [`Progress::none`], which nothing can cancel.
pub(crate) fn expect_not_cancelled<T>(result: Result<T, Cancelled>) -> T {
    match result {
        Ok(value) => value,
        Err(Cancelled) => unreachable!("nobody can stop a call that was given Progress::none()"),
    }
}

/// Sorts by an order whose ties do not matter. A cancelled call leaves the values in any order.
pub(crate) fn sort_unstable_by<T: Send>(
    values: &mut [T],
    progress: Progress<'_>,
    compare: impl Fn(&T, &T) -> std::cmp::Ordering + Sync,
) -> Result<(), Cancelled> {
    if values.len() <= SORTED_SERIALLY {
        values.sort_unstable_by(compare);
    } else {
        // Once the call is cancelled all values compare equal, which ends any sort in one more pass.
        let compare =
            |a: &T, b: &T| if progress.is_cancelled() { std::cmp::Ordering::Equal } else { compare(a, b) };
        values.par_sort_unstable_by(compare);
    }
    progress.check()
}

/// Number of highest bits by which [`sort_by_key_bits`] distributes values.
const BUCKET_BITS: u32 = 12;

/// Number of values that a thread distributes at a time.
const DISTRIBUTED_AT_A_TIME: usize = 1 << 16;

/// Sorts by keys of `n_bits` bits; values with equal keys end up in any order. O(n log(n/4096)) if the highest bits
/// differ. A cancelled call leaves the values in any order.
pub(crate) fn sort_by_key_bits<T: Copy + Default + Send + Sync>(
    values: &mut [T],
    n_bits: u32,
    progress: Progress<'_>,
    key: impl Fn(&T) -> u64 + Sync,
) -> Result<(), Cancelled> {
    let n = values.len();
    if n <= SORTED_SERIALLY {
        values.sort_unstable_by_key(&key);
        return progress.check();
    }
    let shift = n_bits.saturating_sub(BUCKET_BITS);
    let bucket = |value: &T| ((key(value) >> shift) as usize).min((1 << BUCKET_BITS) - 1);
    let own = |range: Range<usize>| &values[range];
    let counts = try_map_chunks(
        n,
        DISTRIBUTED_AT_A_TIME,
        progress,
        || (),
        |(), range| {
            let mut counts = vec![0_u32; 1 << BUCKET_BITS];
            for value in own(range) {
                counts[bucket(value)] += 1;
            }
            counts
        },
    )?;
    // A list for each bucket of the parts that the chunks put into it.
    let mut sorted: Vec<T> = zeros(n);
    let mut places: Vec<Vec<&mut [T]>> =
        counts.iter().map(|_| Vec::with_capacity(1 << BUCKET_BITS)).collect();
    let mut rest = &mut sorted[..];
    for bucket in 0..1 << BUCKET_BITS {
        for (counts, places) in counts.iter().zip(&mut places) {
            let (place, after) = std::mem::take(&mut rest).split_at_mut(counts[bucket] as usize);
            places.push(place);
            rest = after;
        }
    }
    let jobs: Vec<_> = values.chunks(DISTRIBUTED_AT_A_TIME).zip(places).collect();
    try_each(jobs, n, progress, |(chunk, mut places)| {
        let mut filled = vec![0_u32; 1 << BUCKET_BITS];
        for value in chunk {
            let bucket = bucket(value);
            places[bucket][filled[bucket] as usize] = *value;
            filled[bucket] += 1;
        }
        Ok(())
    })?;
    let ends = (0..1 << BUCKET_BITS).scan(0, |end, bucket| {
        *end += counts.iter().map(|counts| counts[bucket] as usize).sum::<usize>();
        Some(*end)
    });
    // Neighboring buckets go to a thread together; one that holds nearly everything is sorted by all.
    let (mut jobs, mut rest, mut start) = (Vec::new(), (values, &mut sorted[..]), 0);
    for end in ends.collect::<Vec<_>>() {
        if end - start < DISTRIBUTED_AT_A_TIME / 4 && end < n {
            continue;
        }
        let (values, values_after) = rest.0.split_at_mut(end - start);
        let (sorted, sorted_after) = rest.1.split_at_mut(end - start);
        jobs.push((values, sorted));
        (rest, start) = ((values_after, sorted_after), end);
    }
    try_each(jobs, n, progress, |(values, sorted)| {
        for run in sorted.chunk_by_mut(|a, b| bucket(a) == bucket(b)) {
            if run.len() <= SORTED_SERIALLY {
                run.sort_unstable_by_key(&key);
            } else {
                sort_unstable_by(run, progress, |a, b| key(a).cmp(&key(b)))?;
            }
        }
        values.copy_from_slice(sorted);
        Ok(())
    })
}

/// Sorts stably: equal values keep their order. A cancelled call leaves the values in any order.
pub(crate) fn sort_by<T: Send>(
    values: &mut [T],
    progress: Progress<'_>,
    compare: impl Fn(&T, &T) -> std::cmp::Ordering + Sync,
) -> Result<(), Cancelled> {
    if values.len() <= SORTED_SERIALLY {
        values.sort_by(compare);
    } else {
        values.par_sort_by(
            |a, b| {
                if progress.is_cancelled() { std::cmp::Ordering::Equal } else { compare(a, b) }
            },
        );
    }
    progress.check()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

    #[test]
    fn small_and_large_loops_give_each_row_once_and_in_order() {
        for n in [0, 1, SERIAL, SERIAL + 1, 100_000] {
            assert_eq!(collect(n, |x| 2 * x), (0..n).map(|x| 2 * x).collect::<Vec<_>>());
            assert_eq!(map_chunks(n, 1000, |range| range).concat_len(), n);
            let mut pairs = vec![0_usize; 2 * n];
            visit_rows(&mut pairs, 2, 777, |first, rows| {
                for (x, row) in (first..).zip(rows.chunks_exact_mut(2)) {
                    row.copy_from_slice(&[x, x + 1]);
                }
            });
            assert!(pairs.chunks_exact(2).enumerate().all(|(x, row)| row == [x, x + 1]));
            let mut values: Vec<usize> = (0..n).rev().collect();
            assert_eq!(sort_unstable_by(&mut values, Progress::none(), Ord::cmp), Ok(()));
            assert!(values.is_sorted());
        }
    }

    #[test]
    fn values_are_sorted_by_keys_however_their_highest_bits_are_distributed() {
        let hash = |i: u64| i.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 1;
        for n in [0, 1, 1000, SORTED_SERIALLY + 1, 300_000] {
            // All over; in one bucket; in two; few different keys.
            for keys in [|h| h, |h| h >> 20, |h: u64| (h & 1) << 62 | h >> 30, |h| h % 7] {
                let mut values: Vec<(u64, u32)> = (0..n as u32).map(|i| (keys(hash(i.into())), i)).collect();
                let mut expected = values.clone();
                assert_eq!(sort_by_key_bits(&mut values, 63, Progress::none(), |value| value.0), Ok(()));
                assert!(values.is_sorted_by_key(|value| value.0));
                expected.sort_unstable();
                values.sort_unstable();
                assert!(values == expected, "{n}: a value was lost");
            }
        }
    }

    trait ConcatLen {
        fn concat_len(&self) -> usize;
    }

    impl ConcatLen for Vec<Range<usize>> {
        fn concat_len(&self) -> usize {
            let mut end = 0;
            for range in self {
                assert_eq!(range.start, end);
                end = range.end;
            }
            end
        }
    }

    #[test]
    fn loops_stop_when_told_to() {
        let (stop, done) = (AtomicBool::new(false), AtomicUsize::new(0));
        let progress = Progress::none().with_cancel(&stop);
        let mut values = vec![0_u8; 1_000_000];
        let stopped = try_visit_rows(&mut values, 1, 1000, progress, |_, _| {
            done.fetch_add(1, Ordering::Relaxed);
            stop.store(true, Ordering::Relaxed);
        });
        assert_eq!(stopped, Err(Cancelled));
        assert!(done.load(Ordering::Relaxed) < 100, "{done:?} of 1000 chunks");
        assert_eq!(try_map_chunks(1_000_000, 1000, progress, || (), |(), _| ()), Err(Cancelled));
        assert_eq!(sort_unstable_by(&mut values, progress, Ord::cmp), Err(Cancelled));
    }
}
