//! Lists that grow by chunks, taken from one stock for all threads.
//!
//! A list is written when it is known, so it takes its chunks all at once. Where the stock ends, `counts.chunks` says what was asked for.

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use super::super::tiles::{CHUNK, CHUNK_EDGES, count, first_chunk_word};
use crate::engine::atomic_words;

pub(super) struct Lists<'a> {
    pub(super) heads: &'a [AtomicU32],
    chunks: &'a [AtomicU32],
    pub(super) counts: &'a [AtomicU32],
}

/// A list as it stands in its chunks.
#[derive(Clone, Copy)]
pub(super) struct Written {
    /// The first chunk; 0 where there is none.
    pub(super) first: u32,
    /// Whether the stock ended before the list did.
    pub(super) full: bool,
}

impl<'a> Lists<'a> {
    pub(super) fn new(lists: &'a mut [u32], counts: &'a mut [u32], tile_count: u32) -> Self {
        let (heads, chunks) = atomic_words(lists).split_at(first_chunk_word(tile_count as usize));
        Self { heads, chunks, counts: atomic_words(counts) }
    }

    /// Adds to what the passes over the lists report; returns what it was.
    pub(super) fn add(&self, count: usize, more: u32) -> u32 {
        self.counts[count].fetch_add(more, Relaxed)
    }

    /// Writes a list, as far as there is room.
    pub(super) fn write(&self, entries: &[u32]) -> Written {
        if entries.is_empty() {
            return Written { first: 0, full: false };
        }
        let wanted = entries.len().div_ceil(CHUNK_EDGES);
        // The first chunk of all is left unused: 0 ends a list.
        let first = self.add(count::CHUNKS, wanted as u32) as usize + 1;
        let room = (self.chunks.len() / CHUNK).saturating_sub(first).min(wanted);
        for (k, entries) in entries.chunks(CHUNK_EDGES).take(room).enumerate() {
            let chunk = &self.chunks[(first + k) * CHUNK..][..CHUNK];
            let next = if k + 1 < room { first + k + 1 } else { 0 };
            chunk[0].store(next as u32, Relaxed);
            chunk[1].store(entries.len() as u32, Relaxed);
            for (word, entry) in chunk[2..].iter().zip(entries) {
                word.store(*entry, Relaxed);
            }
        }
        Written { first: if room > 0 { first as u32 } else { 0 }, full: room < wanted }
    }

    /// Appends what a list holds.
    pub(super) fn read(&self, first: u32, into: &mut Vec<u32>) {
        let mut chunk = first as usize;
        while chunk != 0 {
            let words = &self.chunks[chunk * CHUNK..][..CHUNK];
            let end = words[1].load(Relaxed) as usize;
            into.extend(words[2..2 + end].iter().map(|word| word.load(Relaxed)));
            chunk = words[0].load(Relaxed) as usize;
        }
    }
}
