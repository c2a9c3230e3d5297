//! How far a float32 kernel's determinants can be from exact ones.
//!
//! The kernel under test rounds `a = v0 − p`, `b = v1 − p`, `d = s − p`, `e1 = v1 − v0`, `e2 = v2 − v0`, `e3 = v2 − v1` to
//! float32 and computes, in float32,
//!
//! ```text
//! E01 = d·(a×e1)   E12 = d·(b×e3)   E02 = d·(a×e2)   T = a·(e1×e2)   D = d·(e1×e2)
//! blocked iff  E01, E12, −E02 all >= 0 or all <= 0,  T ≠ 0,  D ≠ 0,  sign T = sign D,  |T| < |D| (points only)
//! ```
//!
//! `d·(a×e1) = d·(a×b)` and `e1×e2 = a×b + b×c + c×a`; but every determinant has an edge of the triangle for a factor, so
//! that rounding is in proportion to the triangle. At a distance L an edge is known to K·u·L across, however short it is.
//!
//! A computed sum of products differs from the exact one by at most `k·u` of the sum of absolute products, where k is the
//! number of roundings that any one product passes through and u = 2^-24 (Higham, *Accuracy and Stability of Numerical
//! Algorithms*, 3.1). The sum of the absolute products of a 3×3 determinant is the permanent of the absolute values. The
//! bounds hold in any order of evaluation and with fused multiply-adds, which only leave roundings out; they assume
//! coordinate differences between about 1e-12 and 1e12, so that no product of three underflows or overflows float32.

/// Half the distance from 1 to the next float32, 2^-24: the relative error of one rounding.
pub const UNIT_ROUNDOFF: f64 = 1.0 / 16_777_216.0;

/// Roundings that one of the six products of a triple product passes through: three differences, of corners, receiver or
/// sample; the product of two; the subtraction inside the cross product; the product with the third; two additions.
pub const DETERMINANT_ROUNDINGS: f64 = 8.0;

/// `n·(s − p)` with n, s and p exact: one difference, one product, two additions.
pub const HORIZON_ROUNDINGS: f64 = 4.0;

/// `n·(v − p)` for a stored unit normal n of a triangle: the length of the normal is in none of its signs, so that storing
/// it, one difference, one product and two additions remain; and one for where the corner itself was rounded.
pub const PLANE_ROUNDINGS: f64 = 6.0;

/// The k·u of the bound, with a factor that covers both the terms of order u² and the rounding of the float64 evaluation.
pub(crate) fn relative_bound(roundings: f64) -> f64 {
    const SECOND_ORDER: f64 = 1.0 + 1.0 / 524_288.0;
    roundings * UNIT_ROUNDOFF * SECOND_ORDER
}
