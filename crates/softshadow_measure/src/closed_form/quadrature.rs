//! One-dimensional integrals whose integrands have square-root ends.

use std::f64::consts::FRAC_PI_2;

/// Beyond |t| = 3.5 the weights are below 1e-20 of the largest.
const REACH: f64 = 3.5;
const STEPS_AT_FIRST: i32 = 7;
const MOST_REFINEMENTS: i32 = 7;
const TOLERANCE: f64 = 1e-14;

/// The integral of `f` over `[a, b]` by the tanh-sinh rule (Takahasi and Mori 1974), refined until two levels agree.
///
/// Its nodes crowd doubly exponentially at both ends, so a square root there costs no accuracy; kinks inside must be made
/// ends by the caller (see [`integrate_between`]).
pub(crate) fn integrate(f: &impl Fn(f64) -> f64, a: f64, b: f64) -> f64 {
    let half = (b - a) / 2.0;
    let mut step = REACH / f64::from(STEPS_AT_FIRST);
    let mut sum = FRAC_PI_2 * f(a + half);
    let mut steps = STEPS_AT_FIRST;
    for k in 1..=steps {
        sum += pair(f, a, b, step * f64::from(k));
    }
    let mut estimate = sum * step * half;
    for _ in 0..MOST_REFINEMENTS {
        // Halving the step keeps every old node; only the odd multiples of the new step are missing.
        step /= 2.0;
        steps *= 2;
        for k in (1..=steps).step_by(2) {
            sum += pair(f, a, b, step * f64::from(k));
        }
        let refined = sum * step * half;
        if (refined - estimate).abs() <= TOLERANCE * refined.abs() {
            return refined;
        }
        estimate = refined;
    }
    estimate
}

/// The two nodes at ±t with their common weight. `to_end` is 1 − tanh without its cancellation.
fn pair(f: &impl Fn(f64) -> f64, a: f64, b: f64, t: f64) -> f64 {
    let s = FRAC_PI_2 * t.sinh();
    let to_end = (b - a) / 2.0 / (s.exp() * s.cosh());
    let weight = FRAC_PI_2 * t.cosh() / (s.cosh() * s.cosh());
    weight * (f(a + to_end) + f(b - to_end))
}

/// The integral of `f` over `[a, b]`, split at those `breaks` that lie inside.
pub(crate) fn integrate_between(f: &impl Fn(f64) -> f64, a: f64, b: f64, breaks: &[f64]) -> f64 {
    let mut ends: Vec<f64> = breaks.iter().copied().filter(|at| (a..b).contains(at)).collect();
    ends.extend([a, b]);
    ends.sort_by(f64::total_cmp);
    ends.windows(2).filter(|panel| panel[0] < panel[1]).map(|panel| integrate(f, panel[0], panel[1])).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrals_with_square_root_ends_are_exact_to_rounding() {
        let half_disc = integrate(&|x: f64| (1.0 - x * x).max(0.0).sqrt(), -1.0, 1.0);
        assert!((half_disc - FRAC_PI_2).abs() < 1e-13, "{half_disc}");
        let polynomial = integrate(&|x: f64| x * x * x, 0.0, 2.0);
        assert!((polynomial - 4.0).abs() < 1e-13, "{polynomial}");
    }

    #[test]
    fn a_kink_is_resolved_only_when_it_is_named() {
        let kink = |x: f64| (x - 0.3).abs().sqrt();
        let exact = 2.0 / 3.0 * (0.3_f64.powf(1.5) + 0.7_f64.powf(1.5));
        let named = integrate_between(&kink, 0.0, 1.0, &[0.3, 7.0]);
        let unnamed = integrate_between(&kink, 0.0, 1.0, &[]);
        assert!((named - exact).abs() < 1e-13);
        assert!((unnamed - exact).abs() > 1e-9, "{unnamed}");
    }
}
