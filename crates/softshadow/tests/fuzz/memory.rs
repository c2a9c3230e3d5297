//! What a thread holds and how much it once held, counted where memory is given out.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

#[global_allocator]
static COUNTED: Counted = Counted;

struct Counted;

thread_local! {
    static HELD: Cell<i64> = const { Cell::new(0) };
    static MOST: Cell<i64> = const { Cell::new(0) };
}

fn add(bytes: i64) {
    // Threads that end give memory back after their counters are gone.
    let _ = HELD.try_with(|held| {
        held.set(held.get() + bytes);
        MOST.with(|most| most.set(most.get().max(held.get())));
    });
}

#[expect(unsafe_code, reason = "an allocator has no other form; each call is the system's own")]
// SAFETY: memory comes from the system's allocator and goes back to it with the same layout.
unsafe impl GlobalAlloc for Counted {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        add(layout.size() as i64);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        add(-(layout.size() as i64));
        unsafe { System.dealloc(place, layout) }
    }
}

/// What `work` gives, and the most bytes that this thread held at once while it ran, beyond those that it held before.
pub(crate) fn most_held<T>(work: impl FnOnce() -> T) -> (T, u64) {
    let before = HELD.get();
    MOST.set(before);
    let result = work();
    (result, (MOST.get() - before) as u64)
}

#[test]
fn what_is_given_back_still_counts() {
    let (length, most) = most_held(|| vec![0_u8; 1 << 20].len() + vec![0_u8; 1 << 10].len());
    assert_eq!(length, (1 << 20) + (1 << 10));
    assert!((1 << 20..1 << 21).contains(&most), "{most}");
    let (_, most) = most_held(|| Vec::<u64>::with_capacity(4).push(1));
    assert!(most < 1 << 10, "{most}");
}
