//! An allocator that returns large vectors to the system as soon as they are freed.
//!
//! The C library keeps freed vectors of up to 32 MiB for reuse. In an interpreter that runs for hours this looks like
//! memory that `del` does not free: up to 700 MB after five calls with a million vertices.

#[cfg(target_os = "linux")]
#[allow(unsafe_code)]
mod linux {
    use std::alloc::{GlobalAlloc, Layout, System};
    use std::ptr;

    /// Size in bytes from which vectors have their own pages.
    const LARGE: usize = 1 << 20;
    /// Size in bytes from which vectors fill pages of 2 MiB, whose first touch costs less than that of pages of 4 KiB.
    /// This takes at most half as much memory again.
    const HUGE: usize = 3 << 20;
    const HUGE_PAGE: usize = 2 << 20;
    /// Smallest alignment of pages in bytes, on every system.
    const PAGE: usize = 4096;

    struct LargeToSystem;

    #[global_allocator]
    static ALLOCATOR: LargeToSystem = LargeToSystem;

    fn is_large(layout: Layout) -> bool {
        layout.size() >= LARGE && layout.align() <= PAGE
    }

    /// Bytes of the mapping of a vector. The system aligns mappings whose size is a multiple of the large page; any
    /// other mapping would begin and end in up to 1022 small pages.
    fn mapping_size(n_bytes: usize) -> usize {
        // Layouts are at most `isize::MAX` bytes long, so this cannot overflow.
        if n_bytes >= HUGE { n_bytes.next_multiple_of(HUGE_PAGE) } else { n_bytes }
    }

    fn map(n_bytes: usize) -> *mut u8 {
        let n_bytes = mapping_size(n_bytes);
        // SAFETY: a new private mapping touches no existing memory.
        let start = unsafe {
            libc::mmap(
                ptr::null_mut(),
                n_bytes,
                libc::PROT_READ | libc::PROT_WRITE,
                libc::MAP_PRIVATE | libc::MAP_ANONYMOUS,
                -1,
                0,
            )
        };
        if start == libc::MAP_FAILED {
            return ptr::null_mut();
        }
        if n_bytes >= HUGE {
            // SAFETY: the range is the mapping, and the advice changes no byte; a failure does not matter.
            unsafe { libc::madvise(start, n_bytes, libc::MADV_HUGEPAGE) };
        }
        start.cast()
    }

    // SAFETY: `alloc`, `dealloc` and `realloc` choose by the layout, which is the same for one vector in all of them,
    // so that each vector is freed by its own allocator; mappings are at least as large as requested, aligned to pages
    // and zeroed.
    unsafe impl GlobalAlloc for LargeToSystem {
        unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
            if is_large(layout) {
                return map(layout.size());
            }
            // SAFETY: the caller's promises are those of this method.
            unsafe { System.alloc(layout) }
        }

        unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
            if is_large(layout) {
                return map(layout.size());
            }
            // SAFETY: as above.
            unsafe { System.alloc_zeroed(layout) }
        }

        unsafe fn dealloc(&self, start: *mut u8, layout: Layout) {
            if is_large(layout) {
                // SAFETY: `start` came from `map` with this size.
                unsafe { libc::munmap(start.cast(), mapping_size(layout.size())) };
                return;
            }
            // SAFETY: as above.
            unsafe { System.dealloc(start, layout) }
        }

        unsafe fn realloc(&self, start: *mut u8, layout: Layout, n_bytes: usize) -> *mut u8 {
            // SAFETY: the caller promises that the size does not overflow with this alignment.
            let new = unsafe { Layout::from_size_align_unchecked(n_bytes, layout.align()) };
            match (is_large(layout), is_large(new)) {
                // SAFETY: as above.
                (false, false) => unsafe { System.realloc(start, layout, n_bytes) },
                (true, true) => {
                    let (old, new) = (mapping_size(layout.size()), mapping_size(n_bytes));
                    // SAFETY: `start` came from `map` with the old size.
                    let new_start = unsafe { libc::mremap(start.cast(), old, new, libc::MREMAP_MAYMOVE) };
                    if new_start == libc::MAP_FAILED { ptr::null_mut() } else { new_start.cast() }
                }
                _ => {
                    // SAFETY: as for `alloc`.
                    let new_start = unsafe { self.alloc(new) };
                    if !new_start.is_null() {
                        // SAFETY: both are at least this long, and the new one does not overlap the old one.
                        unsafe {
                            ptr::copy_nonoverlapping(start, new_start, layout.size().min(n_bytes));
                            self.dealloc(start, layout);
                        }
                    }
                    new_start
                }
            }
        }
    }
}
