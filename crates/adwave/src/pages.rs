//! Large vectors in large pages, values that are fetched ahead of their use, and return of freed memory to the system.
//! For the crates of this workspace.
#![allow(unsafe_code)]

/// A vector of `len` zeros, in pages of 2 MiB if the system supports them. The first touch of a gigabyte in pages
/// of 4 KiB takes longer than all products of a transform, and address translation for such pages takes as long as
/// reading them.
///
/// ```
/// assert_eq!(adwave::pages::zeros::<f64>(3), [0.0; 3]);
/// ```
pub fn zeros<T: Clone + Default>(len: usize) -> Vec<T> {
    let vector = vec![T::default(); len];
    prefer_large_pages(vector.as_ptr().cast(), size_of_val(vector.as_slice()));
    vector
}

/// An empty vector with room for `len` values, in large pages as [`zeros`] has them.
///
/// ```
/// assert!(adwave::pages::with_capacity::<f64>(3).capacity() >= 3);
/// ```
pub fn with_capacity<T>(len: usize) -> Vec<T> {
    let vector: Vec<T> = Vec::with_capacity(len);
    prefer_large_pages(vector.as_ptr().cast(), vector.capacity() * size_of::<T>());
    vector
}

/// Size in bytes of a cache line.
#[cfg(target_arch = "x86_64")]
const LINE: usize = 64;

/// Asks the processor for the cache lines of `values[index]`, which will be read soon, for loops that read in an order
/// that no hardware prefetcher follows. Does nothing if there is no such value, and on processors other than x86-64.
///
/// ```
/// let values = [1.0, 2.0];
/// (0..3).for_each(|i| adwave::pages::prefetch(&values, i));
/// assert_eq!(values, [1.0, 2.0]);
/// ```
#[expect(clippy::inline_always, reason = "a call in the innermost loop takes longer than the instruction")]
#[inline(always)]
pub fn prefetch<T>(values: &[T], index: usize) {
    #[cfg(target_arch = "x86_64")]
    if let Some(value) = values.get(index) {
        let start: *const i8 = std::ptr::from_ref(value).cast();
        for line in (0..size_of::<T>()).step_by(LINE) {
            // SAFETY: the instruction is a hint; it neither reads nor writes for the program, whatever the address.
            unsafe {
                use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
                _mm_prefetch::<_MM_HINT_T0>(start.wrapping_add(line));
            }
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (values, index);
}

/// Returns freed memory to the system if the C library keeps it, after work that frees gigabytes in small pieces
/// and before work that needs as much in large pieces. Takes milliseconds per gigabyte; does nothing except on
/// Linux with glibc.
pub fn release_freed() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: the function takes no pointer and touches no memory in use.
    unsafe {
        libc::malloc_trim(0);
    }
}

/// Size in bytes below which large pages have no advantage.
#[cfg(target_os = "linux")]
const LARGE: usize = 4 << 20;

#[cfg(target_os = "linux")]
fn prefer_large_pages(start: *const u8, bytes: usize) {
    const PAGE: usize = 4096;
    if bytes < LARGE {
        return;
    }
    let skip = start.align_offset(PAGE);
    let len = (bytes - skip) / PAGE * PAGE;
    // SAFETY: the callers own the `bytes` from `start`, and `skip` is less than PAGE and so less than LARGE ≤
    // bytes: the range lies within them. The advice changes no byte of it, and a system that cannot follow it
    // reports that in a result that can be ignored.
    unsafe {
        libc::madvise(start.add(skip).cast_mut().cast(), len, libc::MADV_HUGEPAGE);
    }
}

#[cfg(not(target_os = "linux"))]
fn prefer_large_pages(_: *const u8, _: usize) {}

#[cfg(test)]
mod tests {
    #[test]
    fn values_of_any_size_and_place_can_be_fetched_ahead() {
        let (rows, units) = ([[1.0_f64; 32]; 3], [(); 2]);
        for index in [0, 2, 3, usize::MAX] {
            super::prefetch(&rows, index);
            super::prefetch(&units, index);
            super::prefetch::<u8>(&[], index);
        }
        assert_eq!(rows, [[1.0; 32]; 3]);
    }

    #[test]
    fn small_and_large_vectors_are_zero_and_can_be_written() {
        for len in [0, 1, 1000, 1 << 20] {
            let mut vector = super::zeros::<f64>(len);
            assert_eq!(vector.len(), len);
            assert!(vector.iter().all(|&v| v == 0.0));
            vector.fill(1.0);
            assert_eq!(vector.iter().sum::<f64>(), len as f64);
            assert!(super::zeros::<u32>(len).iter().all(|&v| v == 0));
        }
    }
}
