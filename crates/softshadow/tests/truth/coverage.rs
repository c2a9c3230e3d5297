//! Do estimates lie within their own standard errors of the truth?
//!
//! The truth is an interval: a point for a closed form that describes the scene exactly, a range where the scene holds a
//! polygon or polyhedron between two round shapes. Judged are the receivers in the penumbra; in the umbra and in full light
//! an estimate has to be exact.
//!
//! A mean of n samples knows nothing below one sample: the standard error is never taken for less than 1/n. Where fewer than ten
//! samples are expected to see the light, or to miss it, their number is skewed, and multiples of a standard error have no
//! meaning: such slivers have to be right to 25 samples, which a Poisson number of mean ten exceeds by chance in a millionth.

use softshadow::{Light, RayTraced, SamplePattern, Scene, Technique};

use crate::common::{Random, points, rays, see, surface_points};
use crate::shapes::Point;

const SAMPLES: u32 = 64;
/// Student's t with 63 degrees of freedom exceeds 3 in 0.4 % of all cases and 5 in 0.0005 %.
const PASSES: u32 = 64;
/// Receivers of a call share their samples, so they err together; each group has its own seeds.
const GROUPS: usize = 32;

#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct Coverage {
    pub(crate) receivers: usize,
    pub(crate) in_penumbra: usize,
    pub(crate) within_two: usize,
    pub(crate) beyond_three: usize,
    pub(crate) worst: f64,
    /// Receivers in umbra or full light that were not exactly 0 or 1, and slivers that were not right to 25 samples.
    pub(crate) inexact: usize,
    pub(crate) mean_error: f64,
}

impl Coverage {
    /// At least 99 % of the penumbra within three standard errors, all of it within five, and nothing inexact outside.
    pub(crate) fn holds(&self) -> bool {
        self.in_penumbra >= 100 && self.beyond_three * 100 <= self.in_penumbra && self.worst <= 5.0 && self.inexact == 0
    }

    pub(crate) fn add(&mut self, value: f64, standard_error: f64, [low, high]: [f64; 2]) {
        self.receivers += 1;
        let error = (value - high).max(0.0) - (low - value).max(0.0);
        if high <= 0.0 || low >= 1.0 {
            self.inexact += usize::from(error != 0.0);
            return;
        }
        let floor = 1.0 / f64::from(SAMPLES * PASSES);
        if low.min(1.0 - high) < 10.0 * floor {
            self.inexact += usize::from(error.abs() > 25.0 * floor);
            return;
        }
        let errors = error.abs() / standard_error.max(floor);
        self.in_penumbra += 1;
        self.within_two += usize::from(errors <= 2.0);
        self.beyond_three += usize::from(errors > 3.0);
        self.worst = self.worst.max(errors);
        self.mean_error += (error - self.mean_error) / self.in_penumbra as f64;
    }
}

/// One scene with a known truth.
pub(crate) struct Case<'a> {
    pub(crate) name: &'a str,
    pub(crate) scene: Scene,
    pub(crate) light: Light,
    /// Where receivers lie, in the plane z = 0.
    pub(crate) x: [f64; 2],
    pub(crate) y: [f64; 2],
    pub(crate) normal: Option<Point>,
    pub(crate) pattern: SamplePattern,
}

impl Case<'_> {
    /// Estimates at random receivers, judged by `truth`.
    pub(crate) fn judge(&self, truth: &dyn Fn(Point) -> [f64; 2]) -> Coverage {
        let mut coverage = Coverage::default();
        let mut random = Random(11);
        for group in 0..GROUPS {
            let positions = random.points(64, self.x, self.y, [0.0, 0.0]);
            let receivers = match self.normal {
                Some(normal) => surface_points(positions.clone(), normal),
                None => points(positions.clone()),
            };
            let settings =
                RayTraced { passes: PASSES, pattern: self.pattern, seed: 1000 * group as u32, ..rays(SAMPLES) };
            let light = std::slice::from_ref(&self.light);
            let seen = see(&self.scene, light, &receivers, &Technique::RayTraced(settings));
            let errors = seen.standard_error.unwrap();
            for ((position, value), error) in positions.iter().zip(&seen.values).zip(&errors) {
                coverage.add(f64::from(*value), f64::from(*error), truth(*position));
            }
        }
        println!("{:<44} {coverage:?}", self.name);
        coverage
    }

    /// The truth holds, and that of receivers a fiftieth of a unit further on does not.
    pub(crate) fn require(&self, truth: impl Fn(Point) -> [f64; 2]) {
        let coverage = self.judge(&truth);
        assert!(coverage.holds(), "{}: {coverage:?}", self.name);
        let spoilt = Case {
            name: "  spoilt: truth of receivers 0.02 aside",
            scene: self.scene.clone(),
            light: self.light.clone(),
            ..*self
        };
        let coverage = spoilt.judge(&|p| truth([p[0] + 0.02, p[1] + 0.02, p[2]]));
        assert!(!coverage.holds(), "{}: a shifted truth passes", self.name);
    }
}

#[test]
fn estimates_outside_their_error_are_refused() {
    let mut coverage = Coverage::default();
    (0..1000).for_each(|_| coverage.add(0.5, 0.01, [0.5, 0.5]));
    assert!(coverage.holds());
    let mut rest = coverage;
    (0..11).for_each(|_| rest.add(0.531, 0.01, [0.5, 0.5]));
    assert!(!rest.holds(), "11 of 1011 beyond three errors are too many");
    let mut gross = coverage;
    gross.add(0.551, 0.01, [0.5, 0.5]);
    assert!(!gross.holds(), "one beyond five errors is too many");
    let mut leak = coverage;
    leak.add(0.001, 0.01, [0.0, 0.0]);
    assert!(!leak.holds(), "light in the umbra is too much, whatever the standard error says");
    assert!(!Coverage::default().holds(), "nothing measured proves nothing");
}
