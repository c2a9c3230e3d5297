//! One call on the device, and float64 rays about it: the same stored receivers, the same samples, sample by sample.

use std::ops::AddAssign;

use glam::{DVec2, DVec3};
use softshadow::measure::{
    OcclusionTracer, ProjectedSample, ProjectedView, Receiver, Target, Triangle, needed_roundings,
};
use softshadow::{DepthComplexity, Light, LightShape, Receivers, Scene, Technique, Visibility, light_points};
use softshadow_scene::occluders::LightBoundary;
use softshadow_scene::{LightFrame, LightKind, LocalScene};

use crate::common::see;

/// One word of samples a receiver.
pub(crate) const SAMPLES: u32 = 64;

/// Roundings of an edge's determinant, counted where the model of the kernel is judged: `real_meshes.rs` of `softshadow_native`.
const ROUNDINGS: f64 = 28.0;

/// What a comparison found. A sample that differs is grazing where the bound of its determinants says so, else wrong.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Found {
    pub(crate) samples: usize,
    pub(crate) hidden: usize,
    pub(crate) grazing: usize,
    pub(crate) wrong: usize,
}

impl AddAssign for Found {
    fn add_assign(&mut self, other: Self) {
        self.samples += other.samples;
        self.hidden += other.hidden;
        self.grazing += other.grazing;
        self.wrong += other.wrong;
    }
}

/// Settings of all hard cases: samples alone, so that every bit has an oracle.
pub(crate) fn settings() -> DepthComplexity {
    DepthComplexity { samples: SAMPLES, exact_area: false, ..DepthComplexity::default() }
}

/// What the device answered and what it was asked, in local float32 numbers, which float64 holds exactly.
#[derive(Clone)]
pub(crate) struct Case {
    pub(crate) seen: Visibility,
    light: Light,
    frame: LightFrame,
    triangles: Vec<Triangle>,
    receivers: Vec<Receiver>,
    /// One row for all receivers, or one for each.
    targets: Vec<Target>,
    /// Those of another seed.
    others: Vec<Target>,
    /// What the device hides, one bit a sample.
    hidden: Vec<u64>,
}

impl Case {
    pub(crate) fn run(scene: &Scene, light: &Light, receivers: &Receivers) -> Self {
        Self::with(scene, light, receivers, settings())
    }

    pub(crate) fn with(scene: &Scene, light: &Light, receivers: &Receivers, settings: DepthComplexity) -> Self {
        let seeds = [settings.sampling(0), DepthComplexity { seed: settings.seed + 1, ..settings.clone() }.sampling(0)];
        let seen = see(scene, std::slice::from_ref(light), receivers, &Technique::DepthComplexity(settings));
        let local = LocalScene::new(scene, None, u64::MAX / 2);
        let (placed, masks) = (seen.placed.as_ref().unwrap(), seen.masks.as_ref().unwrap());
        assert_eq!(masks.words, 2);
        let single = |world| local.frame.local_from_world(world).as_vec3().to_array().map(f64::from);
        let own = |id: i64| local.caller_ids.iter().position(|of| i64::from(*of) == id);
        let valid: Vec<usize> = (0..seen.receivers).filter(|i| seen.valid[*i]).collect();
        let asked = valid.iter().map(|&i| Receiver {
            origin: single(placed.positions[i]),
            normal: (placed.normals[i] != [0.0; 3]).then(|| placed.normals[i].map(f64::from)),
            excluded_triangle: own(placed.triangles[i]),
        });
        let is_sphere = matches!(light.shape(), LightShape::Sphere { .. });
        let [targets, others] = seeds.map(|sampling| {
            let at = light_points(scene, light, &sampling, &placed.positions, 0).unwrap();
            let row = |i: usize| if at.rows == 1 { 0..0 } else { i * SAMPLES as usize..(i + 1) * SAMPLES as usize };
            let kept: Vec<usize> = match at.rows {
                1 => (0..SAMPLES as usize).collect(),
                _ => valid.iter().flat_map(|&i| row(i)).collect(),
            };
            let place = |i: usize| match (at.at_infinity, is_sphere) {
                (true, _) => Target::Direction(at.positions[i]),
                // A sphere's samples are completed on the device; of the others it was given these float32 numbers.
                (_, true) => Target::Point(local.frame.local_from_world(at.positions[i]).to_array()),
                _ => Target::Point(single(at.positions[i])),
            };
            kept.into_iter().map(place).collect::<Vec<_>>()
        });
        let word = |i: usize| u64::from(masks.bits[2 * i]) | u64::from(masks.bits[2 * i + 1]) << 32;
        Self {
            light: light.clone(),
            frame: LightFrame::new(light, &local.frame),
            triangles: local.triangles().map(|t| t.map(|v| v.map(f64::from))).collect(),
            receivers: asked.collect(),
            targets,
            others,
            hidden: valid.iter().map(|&i| word(i)).collect(),
            seen,
        }
    }

    fn targets_of(&self, index: usize) -> &[Target] {
        let count = SAMPLES as usize;
        if self.targets.len() == count { &self.targets } else { &self.targets[index * count..(index + 1) * count] }
    }

    /// What no ray has to say: nothing is seen from behind a flat light, all of it from within a ball of light.
    fn foregone(&self, receiver: &Receiver) -> Option<u64> {
        let p = DVec3::from(receiver.origin);
        match self.frame.boundary {
            LightBoundary::Plane { point, normal } => {
                (DVec3::from(normal).dot(p - DVec3::from(point)) <= 0.0).then_some(!0)
            }
            LightBoundary::Ball { center, radius } => (p.distance(DVec3::from(center)) <= radius).then_some(0),
            LightBoundary::None => None,
        }
    }

    fn rays(&self, tracer: &OcclusionTracer, index: usize) -> u64 {
        let receiver = &self.receivers[index];
        self.foregone(receiver).unwrap_or_else(|| {
            let hidden = tracer.hidden(receiver, self.targets_of(index));
            hidden.iter().enumerate().fold(0, |mask, (bit, hidden)| mask | u64::from(*hidden) << bit)
        })
    }

    /// Every sample of every receiver, or all until `most` are wrong.
    fn found_up_to(&self, most: usize) -> Found {
        let tracer = OcclusionTracer::new(&self.triangles).unwrap();
        let mut found = Found::default();
        for index in 0..self.receivers.len() {
            let rays = self.rays(&tracer, index);
            found.samples += SAMPLES as usize;
            found.hidden += rays.count_ones() as usize;
            let differing = rays ^ self.hidden[index];
            for bit in (0..SAMPLES).filter(|bit| differing >> bit & 1 == 1) {
                let is_grazing = self.is_within_rounding(index, bit as usize);
                found.grazing += usize::from(is_grazing);
                found.wrong += usize::from(!is_grazing);
                if found.wrong >= most {
                    return found;
                }
            }
        }
        found
    }

    pub(crate) fn found(&self) -> Found {
        self.found_up_to(usize::MAX)
    }

    /// Whether a kernel of float32 edges may decide either way. On lights that are not flat nothing is excused.
    fn is_within_rounding(&self, index: usize, sample: usize) -> bool {
        let LightKind::Flat { origin, rows, .. } = self.frame.kind else {
            return false;
        };
        let (receiver, target) = (&self.receivers[index], self.targets_of(index)[sample]);
        let (p, c) = (DVec3::from(receiver.origin), DVec2::from(self.frame.reference.map(f64::from)));
        let double = |v: [f32; 3]| DVec3::from(v.map(f64::from));
        // The rows of `frame.wgsl` in float64, and what their terms come to before they cancel.
        let [x, y, z] = rows.map(double);
        let (way, size) = (p - double(origin), p.abs() + double(origin).abs());
        let (height, tall) = (z.dot(way), z.abs().dot(size));
        let row = |axis: DVec3, c: f64| (axis * height - z * (axis.dot(way) - c)).to_array();
        let terms = |axis: DVec3, c: f64| (axis.abs() * tall + z.abs() * (axis.abs().dot(size) + c.abs())).to_array();
        let view = ProjectedView {
            rows: [row(x, c.x), row(y, c.y), (-z).to_array()],
            magnitudes: [terms(x, c.x), terms(y, c.y), z.abs().to_array()],
        };
        let Target::Point(point) = target else {
            return false;
        };
        let to = DVec3::from(point) - p;
        let [x, y, z] = view.rows.map(|row| DVec3::from(row).dot(to));
        let at = [x / z, y / z];
        let magnitude = [at[0].abs() + c.x.abs(), at[1].abs() + c.y.abs()];
        let sample = ProjectedSample { at, magnitude, target };
        needed_roundings(&self.triangles, receiver, &view, &sample, ROUNDINGS).is_some()
    }

    /// Some of its receivers alone.
    fn only(&self, chosen: &[usize]) -> Self {
        let count = SAMPLES as usize;
        let rows = |all: &[Target]| match all.len() == count {
            true => all.to_vec(),
            false => chosen.iter().flat_map(|i| all[i * count..(i + 1) * count].to_vec()).collect(),
        };
        Self {
            receivers: chosen.iter().map(|i| self.receivers[*i]).collect(),
            hidden: chosen.iter().map(|i| self.hidden[*i]).collect(),
            targets: rows(&self.targets),
            others: rows(&self.others),
            ..self.clone()
        }
    }

    fn is_red(&self) -> bool {
        self.found_up_to(1).wrong > 0
    }

    /// The mutation check of every case: a bit, a triangle, a receiver's own triangle and the samples, each spoilt alone, are noticed.
    pub(crate) fn goes_red_when_spoilt(&self, name: &str) {
        let facing: Vec<usize> =
            (0..self.receivers.len()).filter(|i| self.foregone(&self.receivers[*i]).is_none()).collect();
        let every = facing.len().div_ceil(48);
        let few: Vec<usize> = facing.iter().copied().step_by(every.max(1)).collect();
        assert!(!few.is_empty() && !self.only(&few).is_red(), "{name}: what is not spoilt agrees");

        let flipped = |at: &usize| {
            let mut spoilt = self.only(&[*at]);
            spoilt.hidden[0] ^= 1 << (at % SAMPLES as usize);
            spoilt.is_red()
        };
        assert!(few.iter().any(flipped), "{name}: a flipped bit is noticed");

        // One triangle stands in the way to a sample that is seen, or is missing where it alone hides one.
        let across = facing.iter().find_map(|&at| (self.hidden[at] != !0).then(|| self.moved_across(at)));
        let alone = self.hidden_by_one_triangle(&facing);
        let is_missed = |&(at, triangle): &(usize, usize)| {
            let mut spoilt = self.only(&[at]);
            spoilt.triangles.remove(triangle);
            // The index of the receiver's own triangle may have moved.
            let own = &mut spoilt.receivers[0].excluded_triangle;
            *own = own.map(|own| own - usize::from(own > triangle));
            spoilt.is_red()
        };
        let missing = (!alone.is_empty()).then(|| alone.iter().any(is_missed));
        assert!(across.is_some() || missing.is_some(), "{name}: some triangle can be spoilt");
        assert!(across.unwrap_or(true) && missing.unwrap_or(true), "{name}: {across:?} {missing:?}");

        let is_mistaken = |&(at, triangle): &(usize, usize)| {
            let mut spoilt = self.only(&[at]);
            spoilt.receivers[0].excluded_triangle = Some(triangle);
            spoilt.is_red()
        };
        assert!(alone.is_empty() || alone.iter().any(is_mistaken), "{name}: a wrong own triangle is noticed");

        let partly: Vec<usize> =
            facing.iter().copied().filter(|i| ![0, !0].contains(&self.hidden[*i])).take(64).collect();
        if !partly.is_empty() {
            let mut spoilt = self.only(&partly);
            spoilt.targets = spoilt.others.clone();
            assert!(spoilt.is_red(), "{name}: samples of another seed are noticed");
        }
    }

    /// Whether it is noticed that the triangle which shows most of itself to a visible sample stands before that.
    fn moved_across(&self, at: usize) -> bool {
        let mut spoilt = self.only(&[at]);
        let sample = self.hidden[at].trailing_ones() as usize;
        let origin = DVec3::from(self.receivers[at].origin);
        let way = match spoilt.targets_of(0)[sample] {
            Target::Point(point) => DVec3::from(point) - origin,
            Target::Direction(direction) => DVec3::from(direction),
        };
        let own = spoilt.receivers[0].excluded_triangle;
        let shown = |t: &Triangle| {
            let [a, b, c] = t.map(DVec3::from);
            (b - a).cross(c - a).dot(way).abs()
        };
        let most = spoilt.triangles.iter().enumerate().filter(|(index, _)| own != Some(*index));
        let (chosen, _) = most.max_by(|a, b| shown(a.1).total_cmp(&shown(b.1))).unwrap();
        let corners = &mut spoilt.triangles[chosen];
        let middle = corners.iter().map(|v| DVec3::from(*v)).sum::<DVec3>() / 3.0;
        let shift = origin + way * 0.5 - middle;
        *corners = corners.map(|v| (DVec3::from(v) + shift).to_array());
        spoilt.is_red()
    }

    /// Some receivers with a sample that exactly one triangle hides, and that. One of them alone may stand within rounding of it.
    fn hidden_by_one_triangle(&self, facing: &[usize]) -> Vec<(usize, usize)> {
        let tracer = OcclusionTracer::new(&self.triangles).unwrap();
        let shaded = facing.iter().copied().filter(|i| self.hidden[*i] != 0);
        let every = (facing.len() / 400).max(1);
        let witnesses = shaded.step_by(every).filter_map(|at| {
            let receiver = &self.receivers[at];
            let bit = self.hidden[at].trailing_zeros() as usize;
            let target = self.targets_of(at)[bit];
            let is_above = receiver.normal.is_none_or(|n| {
                let way = match target {
                    Target::Point(point) => DVec3::from(point) - DVec3::from(receiver.origin),
                    Target::Direction(direction) => DVec3::from(direction),
                };
                DVec3::from(n).dot(way) > 0.0
            });
            match tracer.crossings(receiver, &target)[..] {
                [triangle] if is_above => Some((at, triangle)),
                _ => None,
            }
        });
        witnesses.take(8).collect()
    }

    pub(crate) fn light(&self) -> &Light {
        &self.light
    }
}

/// Nothing wrong in at least 10^5 pairs of receiver and sample, enough of them hidden to mean something, and every call seen to go red.
pub(crate) fn expect_rays(name: &str, calls: impl IntoIterator<Item = Case>) -> Found {
    let mut total = Found::default();
    for (number, case) in calls.into_iter().enumerate() {
        let found = case.found();
        assert_eq!(found.wrong, 0, "{name}, call {number}, {:?}: {found:?}", case.light().shape());
        case.goes_red_when_spoilt(name);
        total += found;
    }
    println!("hard case {name:<44} {total:?}");
    assert!(total.samples >= 100_000 && total.hidden > 1000, "{name}: {total:?}");
    assert!(total.grazing * 100_000 <= total.samples, "{name}: grazing samples are rare: {total:?}");
    total
}
