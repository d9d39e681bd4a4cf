//! Large vectors come from the system and go back to it as soon as they are freed.
//!
//! The C library keeps freed vectors of up to 32 MiB for later, which a program that holds on to an interpreter for hours sees as
//! memory that `del` does not free: up to 700 MB after five calls at a million vertices.

#[cfg(target_os = "linux")]
#[allow(unsafe_code)]
mod linux {
    use std::alloc::{GlobalAlloc, Layout, System};
    use std::ptr;

    /// Vectors of so many bytes have pages of their own.
    const LARGE: usize = 1 << 20;
    /// Vectors of so many bytes are whole pages of 2 MiB, whose first touch costs less than that of as much in pages of 4 KiB: at most
    /// half as much memory again.
    const HUGE: usize = 3 << 20;
    const HUGE_PAGE: usize = 2 << 20;
    /// Pages are aligned to at least so many bytes on every system.
    const PAGE: usize = 4096;

    struct LargeToSystem;

    #[global_allocator]
    static ALLOCATOR: LargeToSystem = LargeToSystem;

    fn is_large(layout: Layout) -> bool {
        layout.size() >= LARGE && layout.align() <= PAGE
    }

    /// Bytes of the mapping of a vector. The system lays mappings at the start of a large page where they are so many large pages;
    /// any other would begin and end in small ones, up to 1022 of them.
    fn mapped(n_bytes: usize) -> usize {
        // Layouts are at most `isize::MAX` bytes long: nothing overflows.
        if n_bytes >= HUGE { n_bytes.next_multiple_of(HUGE_PAGE) } else { n_bytes }
    }

    fn map(n_bytes: usize) -> *mut u8 {
        let n_bytes = mapped(n_bytes);
        // SAFETY: a new private mapping touches no memory that anyone uses.
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
            // SAFETY: the range is the mapping; the advice changes no byte, and a system that cannot follow it says so in a result
            // that does not matter.
            unsafe { libc::madvise(start, n_bytes, libc::MADV_HUGEPAGE) };
        }
        start.cast()
    }

    // SAFETY: `alloc`, `dealloc` and `realloc` choose by the layout, which is the same for one vector in all of them, so that each
    // vector is freed by who made it; mappings are at least as large as asked for, aligned to pages and zeroed.
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
                unsafe { libc::munmap(start.cast(), mapped(layout.size())) };
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
                    let (old, new) = (mapped(layout.size()), mapped(n_bytes));
                    // SAFETY: `start` came from `map` with the old size.
                    let moved = unsafe { libc::mremap(start.cast(), old, new, libc::MREMAP_MAYMOVE) };
                    if moved == libc::MAP_FAILED { ptr::null_mut() } else { moved.cast() }
                }
                _ => {
                    // SAFETY: as for `alloc`.
                    let moved = unsafe { self.alloc(new) };
                    if !moved.is_null() {
                        // SAFETY: both are at least so long, and the new one overlaps nothing.
                        unsafe {
                            ptr::copy_nonoverlapping(start, moved, layout.size().min(n_bytes));
                            self.dealloc(start, layout);
                        }
                    }
                    moved
                }
            }
        }
    }
}
