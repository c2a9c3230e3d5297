//! Every technique over a grid of requests: plans pass their check, weigh what a person counts, are equal where requests are,
//! and hold nothing that nobody asked for.

mod blended;
mod bytes;
mod depth_complexity;
mod lean;
mod limits;
mod program;
mod requests;
mod semi_opaque;
mod snapshots;
mod soups;
mod spreads;
