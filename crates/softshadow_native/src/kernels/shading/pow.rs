//! Powers, eight at a time: of sums and products alone, so that they are the same on every machine.

use std::f32::consts::LN_2;

use fearless_simd::{Simd, f32x8, i32x8, prelude::*, u32x8};

/// 2/((2k + 1) ln 2): the series of log₂((1 + s)/(1 − s)) in s², which converges where it is used to 3·10⁻⁹ of its value.
const LOG2: [f32; 5] = [2.885_39, 0.961_796_7, 0.577_078, 0.412_198_6, 0.320_598_9];

/// (ln 2)^k/k!: the series of 2^f, which converges for |f| ≤ ½ to 6·10⁻⁹.
const EXP2: [f32; 8] =
    [1.0, LN_2, 0.240_226_5, 0.055_504_11, 0.009_618_129, 0.001_333_355_8, 0.000_154_035_3, 0.000_015_252_734];

/// The bits of √½: where a number is cut into its exponent and a factor near 1, so that nothing cancels near 1.
const ROOT_HALF: u32 = 0x3f35_04f3;

#[inline(always)]
fn series<S: Simd, const N: usize>(simd: S, coefficients: [f32; N], x: f32x8<S>) -> f32x8<S> {
    coefficients.into_iter().rev().fold(f32x8::splat(simd, 0.0), |sum, coefficient| sum * x + coefficient)
}

#[inline(always)]
fn log2<S: Simd>(simd: S, x: f32x8<S>) -> f32x8<S> {
    let exponent = (x.to_bits() - u32x8::splat(simd, ROOT_HALF)).bitcast::<i32x8<S>>() >> 23;
    let factor = f32x8::from_bits(x.to_bits() - (exponent << 23).bitcast::<u32x8<S>>());
    let s = (factor - 1.0) / (factor + 1.0);
    f32x8::float_from(exponent) + s * series(simd, LOG2, s * s)
}

#[inline(always)]
fn exp2<S: Simd>(simd: S, x: f32x8<S>) -> f32x8<S> {
    // Below the smallest normal number there is nothing to see.
    let x = x.max(f32x8::splat(simd, -126.0)).min(f32x8::splat(simd, 127.0));
    let whole = x.round_ties_even();
    let power = (i32x8::truncate_from(whole) + 127) << 23;
    power.bitcast::<f32x8<S>>() * series(simd, EXP2, x - whole)
}

/// x to the power of y, for positive normal x.
#[inline(always)]
pub(super) fn pow<S: Simd>(simd: S, x: f32x8<S>, y: f32) -> f32x8<S> {
    exp2(simd, log2(simd, x) * y)
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use super::*;

    #[test]
    fn powers_are_as_exact_as_their_exponents_allow() {
        let level = Level::new();
        for y in [0.0, 0.5, 1.0, 2.0, 31.0, 998.0, 4998.0] {
            for k in 0..20_000 {
                let x = 1e-6_f32.max(1.000_000_2 - (k as f32 / 20_000.0).powi(3));
                let found = dispatch!(level, simd => pow(simd, f32x8::splat(simd, x), y).as_slice()[0]);
                let wanted = f64::from(x).powf(f64::from(y));
                // The product is rounded, at most by half a step of its size.
                let product = (f64::from(x).log2() * f64::from(y)).abs();
                let within = wanted * (3e-7 + 1.5e-7 * product);
                assert!((f64::from(found) - wanted).abs() <= within.max(2e-38), "{x}^{y}: {found}, not {wanted}");
            }
        }
    }
}
