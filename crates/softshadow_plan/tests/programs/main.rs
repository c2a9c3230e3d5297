//! Four programs that are hard to say, said with the types of this crate and walked with a simulated device. Their kernels need
//! not exist: what is tested is that a plan, its parameters and a few integers read back are enough to write them.

mod adaptive_packing;
mod animated_texture;
mod many_points;
mod progressive_rays;
mod walk;
