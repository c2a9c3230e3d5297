//! Exact areas against exact unions of polygons, and the samples that decide whether to believe them.

use glam::{DVec2, DVec3};
use softshadow_measure::{RectangleLight, disc_over_disc, rectangle_visibility};
use softshadow_native::depth_complexity::{Coverage, Receiver, Seen};
use softshadow_scene::LightShape;

use crate::scene::{Random, Setup, Soup};
use crate::shapes::{above, aimed, ball, bracket, leaves, plate, soup, square, torus};

const WHOLE: f64 = 1e-5;

/// Corners `[low, high]` of the rectangles that a light consists of.
pub(crate) type Parts = &'static [([f64; 2], [f64; 2])];

fn see(setup: &Setup, receiver: &Receiver) -> Seen<1> {
    setup.technique(Coverage::Exact, true).see(receiver)
}

/// A rectangle `[low, high]` of a light's own plane, as the exact union knows it.
fn part(setup: &Setup, low: [f64; 2], high: [f64; 2]) -> RectangleLight {
    let place = setup.light.local(&setup.local);
    let (low, high) = (DVec2::from(low) * place.length_scale, DVec2::from(high) * place.length_scale);
    let (middle, half) = ((low + high) * 0.5, (high - low) * 0.5);
    let center = place.center + place.x_axis * middle.x + place.y_axis * middle.y;
    let [u, v] = [place.x_axis * half.x, place.y_axis * half.y];
    RectangleLight::new(center.into(), u.into(), v.into(), place.emission.into()).unwrap()
}

/// The exact visibility of a light made of rectangles.
fn exact(setup: &Setup, parts: Parts, receiver: &Receiver) -> f64 {
    let receiver = Setup::true_receiver(receiver);
    let area = |(low, high): &([f64; 2], [f64; 2])| (high[0] - low[0]) * (high[1] - low[1]);
    let seen = |p: &([f64; 2], [f64; 2])| {
        rectangle_visibility(&part(setup, p.0, p.1), &setup.exact, &receiver).unwrap() * area(p)
    };
    parts.iter().map(seen).sum::<f64>() / parts.iter().map(area).sum::<f64>()
}

/// What came of the receivers in the penumbra.
#[derive(Debug, Default)]
pub(crate) struct Answers {
    pub(crate) penumbra: usize,
    /// Where areas answered.
    pub(crate) by_area: usize,
    /// Where they were wrong by more than 1e-5: layers overlap between the samples.
    pub(crate) fooled: usize,
    /// Where they were wrong by more than 0.01, and by more than 0.03.
    pub(crate) over: [usize; 2],
    pub(crate) worst: f64,
    /// Sums of squared errors where areas answered: of the areas, and of the samples in their place.
    pub(crate) squared: f64,
    pub(crate) squared_sampled: f64,
    worst_sampled: f64,
}

impl Answers {
    pub(crate) fn plus(self, other: Self) -> Self {
        Self {
            penumbra: self.penumbra + other.penumbra,
            by_area: self.by_area + other.by_area,
            fooled: self.fooled + other.fooled,
            over: [0, 1].map(|k| self.over[k] + other.over[k]),
            worst: self.worst.max(other.worst),
            squared: self.squared + other.squared,
            squared_sampled: self.squared_sampled + other.squared_sampled,
            worst_sampled: self.worst_sampled.max(other.worst_sampled),
        }
    }

    pub(crate) fn share_over(&self, level: usize) -> f64 {
        self.over[level] as f64 / self.by_area as f64
    }

    pub(crate) fn share_fooled(&self) -> f64 {
        self.fooled as f64 / self.by_area as f64
    }

    /// Root mean square error by area, over that of the samples.
    pub(crate) fn gain(&self) -> f64 {
        (self.squared / self.squared_sampled).sqrt()
    }
}

/// What one receiver adds.
pub(crate) fn judge_area(setup: &Setup, parts: Parts, receiver: &Receiver) -> Answers {
    let seen = see(setup, receiver);
    // Whoever sees all or nothing by far more samples is not in the penumbra: an exact union there would only take time.
    if seen.silhouettes == 0 && (seen.hidden[0] == 0 || seen.hidden[0] == !0) {
        return Answers::default();
    }
    let truth = exact(setup, parts, receiver);
    if !(0.002..0.998).contains(&truth) {
        return Answers::default();
    }
    let sampled = (f64::from(seen.sampled) - truth).abs();
    let mut answers = Answers { penumbra: 1, worst_sampled: sampled, ..Answers::default() };
    if let Some(area) = seen.by_area {
        let error = (f64::from(area) - truth).abs();
        answers.by_area = 1;
        answers.fooled = usize::from(error > WHOLE);
        answers.over = [0.01, 0.03].map(|level| usize::from(error > level));
        answers.worst = error;
        answers.squared = error * error;
        answers.squared_sampled = sampled * sampled;
    }
    answers
}

fn judge(setup: &Setup, parts: Parts, random: &mut Random, count: usize) -> Answers {
    let at = |random: &mut Random| random.point([-1.0, -1.0, -0.9], [1.0, 1.0, -0.6]);
    (0..count)
        .map(|_| judge_area(setup, parts, &Receiver { position: at(random), ..Receiver::default() }))
        .fold(Answers::default(), Answers::plus)
}

/// A square light of size 1.
pub(crate) const SQUARE: Parts = &[([-0.5, -0.5], [0.5, 0.5])];

#[test]
fn one_convex_body_is_never_fooled() {
    let mut random = Random(31);
    for (name, mesh) in [("ball", soup(&ball([0.0; 3], 0.35, 3))), ("plate", plate([0.1, 0.0, 0.0], 0.3))] {
        let setup = Setup::new(mesh, aimed(square(1.0), [0.3, 0.4, 3.0], [0.0; 3]), 64);
        let answers = judge(&setup, SQUARE, &mut random, 3000);
        assert!(answers.penumbra > 300, "{name}: {answers:?}");
        assert_eq!((answers.fooled, answers.by_area), (0, answers.penumbra), "{name}: {answers:?}");
        assert!(answers.worst_sampled > 0.02, "samples are far worse: {answers:?}");
    }
}

#[test]
fn layers_between_the_samples_fool_some_and_cost_little() {
    let mut random = Random(32);
    // Largest share of areas that are fooled, and largest error by area relative to that of 64 samples in the same places.
    let cases: [(&str, Soup, f64, f64); 3] = [
        ("torus", soup(&torus([0.0, 0.0, 0.1], 0.35, 0.12, 40, 20)), 0.1, 0.01),
        (
            "two balls",
            [soup(&ball([-0.2, 0.0, 0.0], 0.25, 3)), soup(&ball([0.2, 0.1, 0.3], 0.25, 3))].concat(),
            0.1,
            0.1,
        ),
        ("leaves", leaves(&mut Random(33), 60, 0.25, [-0.5, -0.5, -0.2], [0.5, 0.5, 0.6]), 0.6, 0.5),
    ];
    for (name, mesh, most_fooled, most_error) in cases {
        let setup = Setup::new(mesh, aimed(square(1.0), [0.3, 0.4, 3.0], [0.0; 3]), 64);
        let answers = judge(&setup, SQUARE, &mut random, 3000);
        assert!(answers.by_area * 2 > answers.penumbra, "{name}: {answers:?}");
        assert!(answers.share_fooled() < most_fooled && answers.gain() < most_error, "{name}: {answers:?}");
        // What the sampler's bound allows: 2·64^-3/4, beside the samples' own error.
        assert!(answers.worst < 0.0884 + answers.worst_sampled, "{name}: {answers:?}");
    }
}

#[test]
fn concave_lights_are_sums_of_their_sides() {
    let mut random = Random(34);
    let setup = Setup::new(soup(&ball([0.0; 3], 0.35, 3)), aimed(bracket(1.0), [0.3, 0.4, 3.0], [0.0; 3]), 64);
    let parts = &[([-0.5, -0.5], [0.6, -0.15]), ([-0.5, -0.15], [-0.1, 0.45])];
    let answers = judge(&setup, parts, &mut random, 3000);
    assert!(answers.by_area > 200 && answers.fooled == 0, "{answers:?}");
}

#[test]
fn discs_have_arcs() {
    // A disc of many corners over a disc of light, receiver far below, both on one axis or off it.
    let corners = 4000;
    let occluder = |radius: f64| -> Soup {
        let at = |i: usize| {
            let angle = i as f64 / f64::from(corners) * std::f64::consts::TAU;
            [(angle.cos() * radius) as f32, (angle.sin() * radius) as f32, 0.0]
        };
        (1..corners as usize - 1).map(|i| [at(0), at(i), at(i + 1)]).collect()
    };
    let light = above(LightShape::Disc { radius: 0.4 }, [0.0, 0.0, 1.0]);
    for radius in [0.05, 0.2, 0.35] {
        let setup = Setup::new(occluder(radius), light.clone(), 64);
        for step in 0..60 {
            let x = f64::from(step) * 0.013;
            let receiver = Receiver { position: [x as f32, 0.0, -1.0], ..Receiver::default() };
            let seen = see(&setup, &receiver);
            // From z = −1 the occluder at 0 is twice as large on the light at 1, and its centre moves by −x.
            let truth = disc_over_disc(x, radius * 2.0, 0.4).unwrap();
            let area = seen.by_area.expect("one layer");
            // A polygon of n corners is smaller than its circle by 2 π² / (3 n²).
            assert!((f64::from(area) - truth).abs() < 2e-5, "{radius} {x}: {area} {truth}");
        }
    }
}

#[test]
fn areas_are_silent_where_they_would_be_wrong() {
    let mesh = || soup(&ball([0.0; 3], 0.3, 2));
    let under = Receiver { position: [0.1, 0.05, -0.8], ..Receiver::default() };
    let lit = |shape| Setup::new(mesh(), aimed(shape, [0.3, 0.4, 3.0], [0.0; 3]), 64);
    assert!(see(&lit(square(1.0)), &under).by_area.is_some());
    assert!(see(&lit(LightShape::Sphere { radius: 0.5 }), &under).by_area.is_none(), "solid angle is no area");
    assert!(see(&lit(LightShape::Sun { angular_diameter: 0.3 }), &under).by_area.is_none(), "nor on a wide sun");
    assert!(see(&lit(LightShape::Sun { angular_diameter: 0.0093 }), &under).by_area.is_some());
    // A receiver whose own plane crosses the light.
    let normal = Some(DVec3::new(0.99, 0.0, -0.08).normalize().as_vec3().to_array());
    let tilted = see(&lit(square(1.0)), &Receiver { normal, ..under });
    assert!(tilted.hidden[0].count_ones() > 0 && tilted.by_area.is_none());
    // Two layers that overlap.
    let two = [plate([0.0, 0.0, 0.0], 0.2), plate([0.1, 0.1, 0.3], 0.2)].concat();
    let setup = Setup::new(two, above(square(1.0), [0.0, 0.0, 3.0]), 64);
    let overlapped = see(&setup, &Receiver { position: [0.0, 0.0, -0.9], ..Receiver::default() });
    assert!(overlapped.by_area.is_none() && overlapped.sampled < 0.9);
}
