//! Visibility by silhouette edges: depth complexity sampling, scalar float32.
//!
//! V. Forest, L. Barthe, M. Paulin, "Accurate Shadows by Depth Complexity Sampling", Computer Graphics Forum 27(2), 2008.
//!
//! **What it computes.** `D(s, p)`, the number of triangles between receiver p and light sample s; s is visible iff it is 0. Not by
//! rays: `D` is known at one reference point c of the light, and changes only where the way from c to s crosses the image of an
//! edge on the light,
//!
//! ```text
//! D(s) = D(c) − Σ over edges crossed of λ(e)·w(e, p),
//! λ(e) = +1 if c lies left of the edge's image, else −1,
//! w(e, p) = Σ over the edge's faces of +1 if the face lies left of the edge as seen from p, else −1.
//! ```
//!
//! `w` is 0 where two faces continue each other, so only silhouettes count; nothing is asked of the mesh.
//!
//! **Why it gives the answer of rays.** Every sign is taken once and shared, so that rounding moves an edge but does not tear the image.
//! The images of corners are rounded once; what follows from them, in which order directions stand and on which side of an edge c lies, is
//! decided exactly ([`edge`]). It decides both whether a crossing lies towards the sample and whether c is covered
//! ([`depth_of_reference`]). A face's side decides for all its edges and for its own cover ([`face`]). What is left to rounding is the one
//! comparison of a sample with a line, and only samples within a few roundings of it can fall to the other side.
//!
//! **Parameters.** [`Coverage`]: exact, or the paper's tables; whether areas are wanted ([`area`]).
//!
//! **When it is wrong.** Tables move samples by up to a table cell. Areas are wrong where layers overlap between all samples.
//! A receiver exactly on an edge of a face, told neither normal nor triangle, may take that face for either side of it.
//!
//! | file | holds |
//! |---|---|
//! | [`view`] | the projection of one receiver: `g = rows·(v − p)`, relative to c, homogeneous |
//! | [`face`] | a face's side, an edge's weight |
//! | [`edge`] | an edge's image: line, directions of its ends |
//! | [`coverage`] | which samples the way from c crosses an edge to |
//! | [`counters`] | `D` of 64 samples at a time, bit by bit |
//! | [`area`] | how much of the light lies beyond an edge |
//! | [`reach`] | which faces and edges can matter to a receiver |
//! | [`touching`] | triangles that dip into a ball of light, one by one |
//! | [`evaluate`] | all of it for one receiver |

pub mod area;
pub mod counters;
pub mod coverage;
pub mod depth_of_reference;
pub mod edge;
pub mod evaluate;
pub mod face;
pub mod reach;
pub mod touching;
pub mod view;

pub use coverage::{Coverage, CoverageTables};
pub use evaluate::{DepthComplexity, Seen};
pub use view::{LightView, Receiver};
