//! Eight at a time: vectors of three whose components are eight lanes wide.
//!
//! Eight whatever the processor has, because receivers come in bundles of eight: so no result depends on the width of its vectors. Nothing
//! is fused or reordered either. Lanes that do not take part compute along, and what they find is masked.
//!
//! Vectors are computed in loops, not in closures given to `map` or `from_fn`: those are compiled on their own, without the processor's
//! instructions, and every operation in them becomes a call (lists took three times as long).

use fearless_simd::{f32x8, mask32x8, prelude::*, u32x8};
use glam::Vec3;

/// Lanes.
pub(crate) const LANES: usize = 8;

/// Eight vectors of three.
#[derive(Clone, Copy)]
pub(crate) struct Vec3x8<S: Simd> {
    pub(crate) x: f32x8<S>,
    pub(crate) y: f32x8<S>,
    pub(crate) z: f32x8<S>,
}

impl<S: Simd> Vec3x8<S> {
    #[inline(always)]
    pub(crate) fn new(x: f32x8<S>, y: f32x8<S>, z: f32x8<S>) -> Self {
        Self { x, y, z }
    }

    /// One vector in all lanes.
    #[inline(always)]
    pub(crate) fn splat(simd: S, v: Vec3) -> Self {
        Self { x: f32x8::splat(simd, v.x), y: f32x8::splat(simd, v.y), z: f32x8::splat(simd, v.z) }
    }

    /// Lane by lane.
    #[inline(always)]
    pub(crate) fn from_fn(simd: S, f: impl Fn(usize) -> Vec3) -> Self {
        let v: [Vec3; LANES] = std::array::from_fn(f);
        Self {
            x: f32x8::from_fn(simd, |k| v[k].x),
            y: f32x8::from_fn(simd, |k| v[k].y),
            z: f32x8::from_fn(simd, |k| v[k].z),
        }
    }

    /// One lane.
    #[inline(always)]
    pub(crate) fn lane(&self, k: usize) -> Vec3 {
        Vec3::new(self.x.as_slice()[k], self.y.as_slice()[k], self.z.as_slice()[k])
    }

    #[inline(always)]
    pub(crate) fn dot(self, other: Self) -> f32x8<S> {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    #[inline(always)]
    pub(crate) fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    #[inline(always)]
    pub(crate) fn scale(self, by: f32x8<S>) -> Self {
        Self { x: self.x * by, y: self.y * by, z: self.z * by }
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        Self { x: self.x.abs(), y: self.y.abs(), z: self.z.abs() }
    }

    /// Sum of the components.
    #[inline(always)]
    pub(crate) fn sum(self) -> f32x8<S> {
        self.x + self.y + self.z
    }

    /// The smallest of all lanes.
    #[inline(always)]
    pub(crate) fn reduce_min(self) -> Vec3 {
        Vec3::new(self.x.reduce_min(), self.y.reduce_min(), self.z.reduce_min())
    }

    /// The largest of all lanes.
    #[inline(always)]
    pub(crate) fn reduce_max(self) -> Vec3 {
        Vec3::new(self.x.reduce_max(), self.y.reduce_max(), self.z.reduce_max())
    }

    #[inline(always)]
    pub(crate) fn over(self, by: f32x8<S>) -> Self {
        Self { x: self.x / by, y: self.y / by, z: self.z / by }
    }

    /// The largest of the components' sizes.
    #[inline(always)]
    pub(crate) fn largest_component(self) -> f32x8<S> {
        self.x.abs().max(self.y.abs().max(self.z.abs()))
    }

    #[inline(always)]
    pub(crate) fn min(self, other: Self) -> Self {
        Self { x: self.x.min(other.x), y: self.y.min(other.y), z: self.z.min(other.z) }
    }

    #[inline(always)]
    pub(crate) fn max(self, other: Self) -> Self {
        Self { x: self.x.max(other.x), y: self.y.max(other.y), z: self.z.max(other.z) }
    }

    #[inline(always)]
    pub(crate) fn select(mask: mask32x8<S>, yes: Self, no: Self) -> Self {
        Self { x: mask.select(yes.x, no.x), y: mask.select(yes.y, no.y), z: mask.select(yes.z, no.z) }
    }
}

impl<S: Simd> std::ops::Add for Vec3x8<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl<S: Simd> std::ops::Sub for Vec3x8<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}

impl<S: Simd> std::ops::Mul for Vec3x8<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self { x: self.x * other.x, y: self.y * other.y, z: self.z * other.z }
    }
}

/// Eight records of eight words, word by word: lane `k` of vector `i` is word `i` of record `k`.
#[inline(always)]
pub(crate) fn transposed<S: Simd>(simd: S, record: impl Fn(usize) -> [u32; LANES]) -> [u32x8<S>; LANES] {
    let mut words = [u32x8::splat(simd, 0); LANES];
    for (k, row) in words.iter_mut().enumerate() {
        *row = u32x8::load_array(simd, record(k));
    }
    // Three times halves are zipped: word `i` of record `k` moves from place 8k + i to 8i + k.
    for _ in 0..3 {
        let before = words;
        for i in 0..LANES / 2 {
            words[2 * i] = before[i].zip_low(before[i + 4]);
            words[2 * i + 1] = before[i].zip_high(before[i + 4]);
        }
    }
    words
}
