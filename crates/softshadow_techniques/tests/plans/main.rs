//! Every technique over a grid of requests: plans pass their check, weigh what a person counts, are equal where requests are,
//! and hold nothing that nobody asked for.

mod bytes;
mod depth_complexity;
mod lean;
mod limits;
mod program;
mod requests;
mod snapshots;
mod soups;
