//! The float64 tracer on exactly the float32 triangles, receivers and samples that the device used, sample by sample.
//!
//! Everything is done in local coordinates: a local float32 value is a float64 value, so nothing is rounded twice.

use std::collections::HashMap;
use std::ops::AddAssign;

use softshadow::measure::{RayReference, Receiver, Target};
use softshadow::{Light, LightShape, RayTraced, Scene, Visibility, light_points};
use softshadow_scene::LocalScene;

use crate::shapes::{Point, Triangle, add, dot, length, sub};

/// Half the distance from 1 to the next float32.
const U: f64 = 1.0 / 16_777_216.0;

/// How many samples were compared and how they came out.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Agreement {
    pub(crate) samples: usize,
    /// Where float32 rounding may fall to either side.
    pub(crate) grazing: usize,
    /// Of those, how many did.
    pub(crate) grazing_differing: usize,
    /// Elsewhere: each is a fault.
    pub(crate) differing: usize,
    /// Samples that are hidden, so that an empty scene does not pass for agreement.
    pub(crate) hidden: usize,
}

impl AddAssign for Agreement {
    fn add_assign(&mut self, other: Self) {
        self.samples += other.samples;
        self.grazing += other.grazing;
        self.grazing_differing += other.grazing_differing;
        self.differing += other.differing;
        self.hidden += other.hidden;
    }
}

/// What float64 says about one sample.
#[derive(Clone, Copy)]
struct Verdict {
    visible: bool,
    grazing: bool,
}

/// A scene as the device reads it.
pub(crate) struct Truth {
    pub(crate) local: LocalScene,
    reference: RayReference,
    index_of_caller_id: HashMap<i64, usize>,
}

impl Truth {
    pub(crate) fn of(scene: &Scene) -> Self {
        Self::with(scene, |_| {})
    }

    /// With triangles that the device does not know, to show that differences are seen.
    pub(crate) fn with(scene: &Scene, spoil: impl Fn(&mut [Triangle])) -> Self {
        let local = LocalScene::new(scene, None, 128 << 20);
        let mut triangles: Vec<Triangle> = local.triangles().map(|t| t.map(|p| p.map(f64::from))).collect();
        spoil(&mut triangles);
        let index_of_caller_id = local.caller_ids.iter().enumerate().map(|(i, id)| (i64::from(*id), i)).collect();
        Self { local, reference: RayReference::new(&triangles).unwrap(), index_of_caller_id }
    }

    /// The float32 value behind a world position that the library returned; the way through the world rounds in float64.
    fn local_point(&self, world: Point) -> Point {
        self.local.frame.local_from_world(world).as_vec3().to_array().map(f64::from)
    }

    /// Compares the masks of the call's only light.
    pub(crate) fn compare(&self, scene: &Scene, light: &Light, settings: &RayTraced, seen: &Visibility) -> Agreement {
        let placed = seen.placed.as_ref().unwrap();
        let masks = seen.masks.as_ref().unwrap();
        let count = settings.samples as usize;
        let width = seen.image.map_or(0, |[width, _]| width);
        let at = light_points(scene, light, &settings.sampling(0), &placed.positions, width).unwrap();
        let mut total = Agreement::default();
        for index in (0..seen.receivers).filter(|i| seen.valid[*i]) {
            let normal = placed.normals[index];
            let receiver = Receiver {
                origin: self.local_point(placed.positions[index]),
                normal: (normal != [0.0; 3]).then(|| normal.map(f64::from)),
                excluded_triangle: self.index_of_caller_id.get(&placed.triangles[index]).copied(),
            };
            let first = if at.rows == 1 { 0 } else { index * count };
            let place = |p: &Point| match at.at_infinity {
                true => Target::Direction(*p),
                false if is_sphere(light) => Target::Point(self.local.frame.local_from_world(*p).to_array()),
                false => Target::Point(self.local_point(*p)),
            };
            let targets: Vec<Target> = at.positions[first..first + count].iter().map(place).collect();
            let verdicts = self.verdicts(light, &receiver, &targets);
            for (sample, verdict) in (0..count).zip(verdicts) {
                let blocked = masks.bits[index * masks.words + sample / 32] >> (sample % 32) & 1 == 1;
                let differs = blocked == verdict.visible;
                total += Agreement {
                    samples: 1,
                    grazing: usize::from(verdict.grazing),
                    grazing_differing: usize::from(verdict.grazing && differs),
                    differing: usize::from(!verdict.grazing && differs),
                    hidden: usize::from(!verdict.visible),
                };
            }
        }
        total
    }

    fn verdicts(&self, light: &Light, receiver: &Receiver, targets: &[Target]) -> Vec<Verdict> {
        let place = light.local(&self.local.frame);
        let as_f32 = |v: [f64; 3]| v.map(|x| f64::from(x as f32));
        let (center, emission) = (as_f32(place.center.to_array()), as_f32(place.emission.to_array()));
        if matches!(light.shape(), LightShape::Rectangle { .. } | LightShape::Disc { .. } | LightShape::Polygon { .. })
        {
            // The kernel's one dot product that decides about the whole light, and four roundings of it.
            let way = sub(receiver.origin, center);
            let height = dot(way, emission);
            let bound = 4.1 * U * dot(way.map(f64::abs), emission.map(f64::abs));
            if height <= bound {
                return vec![Verdict { visible: false, grazing: height > -bound }; targets.len()];
            }
        }
        let trace = |targets: &[Target]| self.reference.trace_receiver(receiver, targets).unwrap();
        let middle = trace(targets);
        let mut verdicts: Vec<Verdict> =
            middle.iter().map(|v| Verdict { visible: v.visible, grazing: v.grazing }).collect();
        if is_sphere(light) {
            // A sphere's samples are completed on the device in float32. Their positions are known to within the roundings
            // of two square roots, three divisions and a few products: 64 u is more than all of them. A sample is judged
            // only where the verdict is the same all around its position.
            let reach = targets.iter().map(|t| length(sub(point(t), center))).fold(0.0, f64::max);
            let largest = center.iter().chain(&receiver.origin).fold(0.0, |m: f64, x| m.max(x.abs()));
            let step = 64.0 * U * (reach + largest);
            for direction in around(sub(center, receiver.origin)) {
                let moved: Vec<Target> =
                    targets.iter().map(|t| Target::Point(add(point(t), direction.map(|x| x * step)))).collect();
                for (verdict, other) in verdicts.iter_mut().zip(trace(&moved)) {
                    verdict.grazing |= other.grazing || other.visible != verdict.visible;
                }
            }
        }
        verdicts
    }
}

fn is_sphere(light: &Light) -> bool {
    matches!(light.shape(), LightShape::Sphere { .. })
}

fn point(target: &Target) -> Point {
    match target {
        Target::Point(p) | Target::Direction(p) => *p,
    }
}

/// Eight unit vectors across `axis`.
fn around(axis: Point) -> Vec<Point> {
    let (x, y) = (glam::DVec3::from(axis).normalize()).any_orthonormal_pair();
    (0..8)
        .map(|i| {
            let (sine, cosine) = (std::f64::consts::FRAC_PI_4 * f64::from(i)).sin_cos();
            (x * cosine + y * sine).to_array()
        })
        .collect()
}
