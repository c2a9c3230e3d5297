//! Whatever can be wrong with a plan is found before any driver is asked, and is named. Every test spoils one thing of a plan
//! that passes; the kernels are the real ones.

mod bindings;
mod export;
mod limits;
mod memory;
mod order;
mod small_plan;
mod targets;
