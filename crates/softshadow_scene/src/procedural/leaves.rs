//! A crown of leaves: an open soup whose depth complexity no counter of a few bits holds.

use std::f64::consts::TAU;

use serde::Deserialize;

use super::shapes::Surface;

/// Rectangles of s by s/2, uniform in a ball, uniform over all orientations.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Leaves {
    /// How many.
    pub count: u32,
    /// Of the random numbers; equal seeds give equal leaves.
    pub seed: u64,
    /// Of the ball that holds the leaves' centres.
    pub center: [f64; 3],
    /// Of the same ball.
    pub radius: f64,
    /// Between which s is uniform.
    pub size: [f64; 2],
}

impl Leaves {
    pub(super) fn checked_triangle_count(&self) -> Result<u64, String> {
        let [smallest, largest] = self.size;
        if self.count == 0 || self.radius <= 0.0 || smallest <= 0.0 || largest < smallest {
            return Err("leaves: count, radius and size must be positive, size from small to large".into());
        }
        Ok(2 * u64::from(self.count))
    }
}

pub(super) fn add(surface: &mut Surface, leaves: &Leaves) {
    let mut random = SplitMix64(leaves.seed);
    for _ in 0..leaves.count {
        let centre = random.in_unit_ball();
        let [along, across] = random.two_axes();
        let [smallest, largest] = leaves.size;
        let size = smallest + (largest - smallest) * random.unit();
        let corner = |u: f64, v: f64| {
            [0, 1, 2].map(|k| {
                leaves.center[k] + leaves.radius * centre[k] + size * (u / 2.0 * along[k] + v / 4.0 * across[k])
            })
        };
        surface.add_quad([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
    }
}

/// Steele, Lea and Flood 2014, "Fast splittable pseudorandom number generators".
struct SplitMix64(u64);

impl SplitMix64 {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in 0..1.
    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn in_unit_ball(&mut self) -> [f64; 3] {
        loop {
            let point = [(); 3].map(|()| 2.0 * self.unit() - 1.0);
            if point.iter().map(|x| x * x).sum::<f64>() <= 1.0 {
                return point;
            }
        }
    }

    /// The first two columns of a uniformly random rotation: Shoemake 1992, "Uniform random rotations".
    fn two_axes(&mut self) -> [[f64; 3]; 2] {
        let [u, v, t] = [self.unit(), self.unit(), self.unit()];
        let ((sin_v, cos_v), (sin_t, cos_t)) = ((TAU * v).sin_cos(), (TAU * t).sin_cos());
        let [a, b] = [(1.0 - u).sqrt(), u.sqrt()];
        let [x, y, z, w] = [a * sin_v, a * cos_v, b * sin_t, b * cos_t];
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)],
            [2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)],
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reference values of the algorithm's published C code for the seed 1234567.
    #[test]
    fn splitmix64_follows_its_reference() {
        let mut random = SplitMix64(1_234_567);
        let expected = [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423];
        assert_eq!([random.next(), random.next(), random.next()], expected);
    }

    #[test]
    fn axes_are_orthonormal_and_cover_all_directions() {
        let mut random = SplitMix64(1);
        let mut second_moments = [0.0; 3];
        let count = 20_000;
        for _ in 0..count {
            let [a, b] = random.two_axes();
            let dot = |p: [f64; 3], q: [f64; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
            assert!((dot(a, a) - 1.0).abs() < 1e-12 && (dot(b, b) - 1.0).abs() < 1e-12 && dot(a, b).abs() < 1e-12);
            // The leaf's normal decides how much light it hides.
            let normal = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
            for (moment, x) in second_moments.iter_mut().zip(normal) {
                *moment += x * x / f64::from(count);
            }
        }
        // Uniform directions have 1/3 each, with a standard error of sqrt(4/45/20000) = 0.0021.
        assert!(second_moments.iter().all(|m| (m - 1.0 / 3.0).abs() < 0.009), "{second_moments:?}");
    }
}
