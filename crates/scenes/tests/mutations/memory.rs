//! Counts the memory that the process holds.

#![allow(unsafe_code, reason = "an allocator is unsafe to write; this one hands everything on to the system's")]

use std::{
    alloc::{GlobalAlloc, Layout, System},
    sync::atomic::{AtomicUsize, Ordering::Relaxed},
};

struct Counting;

static HELD: AtomicUsize = AtomicUsize::new(0);
static BEFORE: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);

#[global_allocator]
static COUNTING: Counting = Counting;

// SAFETY: every request goes to the system's allocator as it is; the counters do not touch the memory.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        took(layout.size());
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        took(layout.size());
        // SAFETY: as the caller promises.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        HELD.fetch_sub(layout.size(), Relaxed);
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        took(size);
        HELD.fetch_sub(layout.size(), Relaxed);
        // SAFETY: as the caller promises.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

fn took(size: usize) {
    let held = HELD.fetch_add(size, Relaxed) + size;
    MOST.fetch_max(held, Relaxed);
}

/// From here on [`peak`] counts.
pub(crate) fn start() {
    let held = HELD.load(Relaxed);
    BEFORE.store(held, Relaxed);
    MOST.store(held, Relaxed);
}

/// The most that was held beyond what was held at [`start`].
pub(crate) fn peak() -> usize {
    MOST.load(Relaxed).saturating_sub(BEFORE.load(Relaxed))
}

#[test]
fn memory_is_counted() {
    let _alone = crate::alone();
    start();
    let large = std::hint::black_box(vec![1u8; 1 << 24]);
    let peak = peak();
    drop(large);
    assert!((1 << 24..1 << 25).contains(&peak), "{peak}");
}
