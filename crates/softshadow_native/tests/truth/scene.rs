//! A scene, one light, and the float64 truth about both.

use glam::{DVec2, DVec3};
use softshadow_measure::{OcclusionTracer, ProjectedSample, ProjectedView, Receiver as TrueReceiver, Target, Triangle};
use softshadow_native::depth_complexity::{Coverage, DepthComplexity, Receiver, Seen};
use softshadow_scene::occluders::{LightBoundary, Occluders};
use softshadow_scene::{
    Light, LightFrame, LightKind, LightSamples, LightSampling, LightShape, LocalFrame, SamplePattern, sample_positions,
};

/// Local float32 triangles.
pub(crate) type Soup = Vec<[[f32; 3]; 3]>;

pub(crate) struct Setup {
    pub(crate) triangles: Soup,
    pub(crate) exact: Vec<Triangle>,
    pub(crate) opacity: fn(usize) -> f32,
    pub(crate) occluders: Occluders,
    pub(crate) local: LocalFrame,
    pub(crate) light: Light,
    pub(crate) frame: LightFrame,
    pub(crate) parameters: LightSamples,
    pub(crate) samples: Vec<[f32; 2]>,
    pub(crate) tracer: OcclusionTracer,
}

pub(crate) fn opaque(_: usize) -> f32 {
    1.0
}

impl Setup {
    /// Triangles that are local already, under a light of the same coordinates.
    pub(crate) fn new(triangles: Soup, light: Light, samples: u32) -> Self {
        Self::in_frame(triangles, LocalFrame::around(None), light, samples, opaque)
    }

    pub(crate) fn in_frame(
        triangles: Soup,
        local: LocalFrame,
        light: Light,
        samples: u32,
        opacity: fn(usize) -> f32,
    ) -> Self {
        let frame = LightFrame::new(&light, &local);
        let parameters =
            LightSamples::new(&light, &local, &LightSampling::correlated(SamplePattern::Stratified, samples, 1))
                .unwrap();
        let exact: Vec<Triangle> = triangles.iter().map(|t| t.map(|v| v.map(f64::from))).collect();
        Self {
            occluders: Occluders::new(&triangles, opacity, &frame.boundary).unwrap(),
            samples: frame.samples(&light, &parameters),
            tracer: OcclusionTracer::new(&exact).unwrap(),
            triangles,
            exact,
            opacity,
            local,
            light,
            frame,
            parameters,
        }
    }

    pub(crate) fn technique<'a>(&'a self, coverage: Coverage<'a>, exact_area: bool) -> DepthComplexity<'a> {
        DepthComplexity { occluders: &self.occluders, light: &self.frame, samples: &self.samples, coverage, exact_area }
    }

    pub(crate) fn see(&self, receiver: &Receiver) -> Seen<1> {
        self.technique(Coverage::Exact, false).see(receiver)
    }

    /// Whether the receiver sees the light at all; `Some(visible)` where it sees none or, inside it, all of it.
    pub(crate) fn foregone(&self, receiver: &Receiver) -> Option<bool> {
        let p = DVec3::from(receiver.position.map(f64::from));
        match self.frame.boundary {
            LightBoundary::Plane { point, normal } => {
                (DVec3::from(normal).dot(p - DVec3::from(point)) <= 0.0).then_some(false)
            }
            LightBoundary::Ball { center, radius } => (p.distance(DVec3::from(center)) <= radius).then_some(true),
            LightBoundary::None => None,
        }
    }

    /// Where the samples are, exactly, for a receiver with a view of the light.
    pub(crate) fn targets(&self, receiver: &Receiver) -> Vec<Target> {
        let place = self.light.local(&self.local);
        let parameters = self.parameters.parameters.iter().map(|p| DVec2::from(p.map(f64::from)));
        let on_plane = |x: f64, y: f64| {
            let s = place.length_scale;
            Target::Point((place.center + place.x_axis * (x * s) + place.y_axis * (y * s)).to_array())
        };
        match self.light.shape() {
            LightShape::Rectangle { width, height } => {
                parameters.map(|p| on_plane(p.x * width * 0.5, p.y * height * 0.5)).collect()
            }
            LightShape::Disc { radius } => parameters.map(|p| on_plane(p.x * radius, p.y * radius)).collect(),
            LightShape::Polygon { .. } => parameters.map(|p| on_plane(p.x, p.y)).collect(),
            LightShape::Sun { angular_diameter } => {
                let cap = 1.0 - (angular_diameter * 0.5).cos();
                parameters
                    .map(|p| {
                        let share = p.length_squared() * cap;
                        let reach = (cap * (2.0 - share)).sqrt() / (1.0 - share);
                        Target::Direction(
                            (-place.emission + (place.x_axis * p.x + place.y_axis * p.y) * reach).to_array(),
                        )
                    })
                    .collect()
            }
            LightShape::Sphere { .. } => {
                let p = DVec3::from(receiver.position.map(f64::from));
                let positions = sample_positions(&self.light, &self.local, &self.parameters.records, p).unwrap();
                positions.iter().map(|(s, _)| Target::Point(s.to_array())).collect()
            }
        }
    }

    pub(crate) fn true_receiver(receiver: &Receiver) -> TrueReceiver {
        TrueReceiver {
            origin: receiver.position.map(f64::from),
            normal: receiver.normal.map(|n| n.map(f64::from)),
            excluded_triangle: receiver.triangle.map(|t| t as usize),
        }
    }

    /// The projection that the edges of a receiver go through, in float64, with what its terms come to before they cancel.
    pub(crate) fn exact_view(&self, receiver: &Receiver) -> ProjectedView {
        let p = DVec3::from(receiver.position.map(f64::from));
        let c = DVec2::from(self.frame.reference.map(f64::from));
        let double = |v: [f32; 3]| DVec3::from(v.map(f64::from));
        let of = |rows: [DVec3; 3], magnitudes: [DVec3; 3]| ProjectedView {
            rows: rows.map(|r| r.to_array()),
            magnitudes: magnitudes.map(|m| m.to_array()),
        };
        match self.frame.kind {
            LightKind::Flat { origin, rows, .. } => {
                let [x, y, z] = rows.map(double);
                let way = p - double(origin);
                let size = p.abs() + double(origin).abs();
                let [ax, ay, az] = [x, y, z].map(DVec3::abs);
                let (height, across) = (z.dot(way), |axis: DVec3, c: f64| axis.dot(way) - c);
                let rows = [x * height - z * across(x, c.x), y * height - z * across(y, c.y), -z];
                let largest = |axis: DVec3, abs: DVec3, c: f64| axis * az.dot(size) + az * (abs.dot(size) + c.abs());
                of(rows, [largest(ax, ax, c.x), largest(ay, ay, c.y), az])
            }
            LightKind::Sun { axes, tangent } => angular(axes.map(double), f64::from(tangent), c, 1.0, &of),
            LightKind::Sphere { center, radius } => {
                let way = double(center) - p;
                let sine = f64::from(radius) / way.length();
                let towards = way.normalize();
                let (x, y) = towards.any_orthonormal_pair();
                // The axis is a difference of positions, and its rounding turns the whole frame.
                let turn = 1.0 + (p.abs() + double(center).abs()).max_element() / way.length();
                let tangent = sine / (1.0 - sine * sine).sqrt();
                angular([x, -y, towards], tangent, c, turn, &of)
            }
        }
    }

    /// A sample in that projection.
    pub(crate) fn exact_sample(&self, view: &ProjectedView, receiver: &Receiver, target: Target) -> ProjectedSample {
        let p = DVec3::from(receiver.position.map(f64::from));
        let way = match target {
            Target::Point(s) => DVec3::from(s) - p,
            Target::Direction(d) => DVec3::from(d),
        };
        let [x, y, z] = view.rows.map(|r| DVec3::from(r).dot(way));
        let c = self.frame.reference.map(|c| f64::from(c.abs()));
        let at = [x / z, y / z];
        ProjectedSample { at, magnitude: [at[0].abs() + c[0], at[1].abs() + c[1]], target }
    }

    /// Hidden samples of the first word, by float64 rays.
    pub(crate) fn hidden_by_rays(&self, receiver: &Receiver) -> u64 {
        let count = self.samples.len().min(64);
        match self.foregone(receiver) {
            Some(true) => return 0,
            Some(false) => return !0 >> (64 - count),
            None => {}
        }
        let hidden = self.tracer.hidden(&Self::true_receiver(receiver), &self.targets(receiver)[..count]);
        hidden.iter().enumerate().fold(0, |mask, (bit, h)| mask | u64::from(*h) << bit)
    }
}

fn angular(
    [x, y, towards]: [DVec3; 3],
    tangent: f64,
    c: DVec2,
    turn: f64,
    of: &dyn Fn([DVec3; 3], [DVec3; 3]) -> ProjectedView,
) -> ProjectedView {
    let depth = towards * tangent;
    let all = DVec3::splat(turn);
    let magnitudes = [all * (1.0 + tangent * c.x), all * (1.0 + tangent * c.y), all * tangent];
    of([x - depth * c.x, y - depth * c.y, depth], magnitudes)
}

/// SplitMix64 (Steele, Lea and Flood 2014).
#[derive(Clone)]
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    pub(crate) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }

    pub(crate) fn point(&mut self, low: [f64; 3], high: [f64; 3]) -> [f32; 3] {
        std::array::from_fn(|k| self.within(low[k], high[k]) as f32)
    }

    pub(crate) fn direction(&mut self) -> DVec3 {
        loop {
            let v = DVec3::new(self.within(-1.0, 1.0), self.within(-1.0, 1.0), self.within(-1.0, 1.0));
            if v.length_squared() > 1e-6 && v.length_squared() <= 1.0 {
                return v.normalize();
            }
        }
    }
}

/// A receiver on a triangle: at a random place, lifted off it on the side of `towards` as every technique does.
pub(crate) fn on_triangle(
    random: &mut Random,
    triangle: &[[f32; 3]; 3],
    index: usize,
    towards: DVec3,
    extent: f32,
) -> Option<Receiver> {
    let [a, b, c] = triangle.map(|v| DVec3::from(v.map(f64::from)));
    let (u, v) = (random.within(0.0, 1.0), random.within(0.0, 1.0));
    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
    let place = (a + (b - a) * u + (c - a) * v).as_vec3();
    let normal = (b - a).cross(c - a).try_normalize()?;
    let normal = if normal.dot(towards - place.as_dvec3()) < 0.0 { -normal } else { normal }.as_vec3();
    // 14 u (|p| + largest |vertex|), as the receiver stage does.
    let lift = 14.0 * 5.960_464_5e-8 * (place.abs().max_element() + extent);
    Some(Receiver {
        position: (place + normal * lift).to_array(),
        normal: Some(normal.to_array()),
        triangle: Some(index as u32),
    })
}
