//! The real engine on wgpu's backend without a driver: everything is validated and nothing computed, so what is tested is that
//! plans are accepted, split, timed and read back, and that whatever fails is a value after which the engine works on.
//!
//! Only copies and clears have an effect there: outputs have the right size and hold zeros.

mod failures;
mod foreign;
mod lost;
mod programs;
mod runs;
mod schedule;
mod techniques;
