//! The one place of the crate without the compiler's guarantee: words that several threads write.
#![expect(unsafe_code, reason = "words and atomic words have one layout; the standard library's own cast is unstable")]

use std::sync::atomic::AtomicU32;

/// The same words, for threads to share.
pub(crate) fn atomic_words(words: &mut [u32]) -> &[AtomicU32] {
    let (pointer, length) = (words.as_mut_ptr().cast::<AtomicU32>(), words.len());
    // SAFETY: `AtomicU32` has the size, alignment and valid values of `u32`, and the unique borrow of `words` lasts as long as the shared
    // one of what is returned.
    unsafe { std::slice::from_raw_parts(pointer, length) }
}

/// Reads a shared word.
pub(crate) fn shared(word: &AtomicU32) -> u32 {
    word.load(std::sync::atomic::Ordering::Relaxed)
}
