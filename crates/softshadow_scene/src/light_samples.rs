//! Light samples: the same for every technique and every host, made here and uploaded.
//!
//! Samples are equal shares of the light (of its area; of solid angle for sphere and sun), so visibility is a count. They come
//! in a progressive order: a prefix is spread over the whole light, which is what probes need.

use glam::{DVec2, DVec3};

use crate::error::SceneError;
use crate::frame::LocalFrame;
use crate::light::{Light, LightShape, LocalLight, triangulate};
use crate::sample_sets::LightSampling;

/// The most samples of one set: kernels that loop over a set stay below the 65,535 steps after which Mesa's software driver ends
/// loops. More come as progressive passes.
pub const MAX_SAMPLES: u32 = 1 << 15;

/// How the unit square is sampled before it is mapped to the light.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SamplePattern {
    /// One jittered sample in each of `n` cells of equal area.
    #[default]
    Stratified,
    /// The first points of an Owen-scrambled Sobol sequence (Burley 2020).
    LowDiscrepancy,
}

/// Sets of samples on one light, in the local frame of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct LightSamples {
    /// Where each sample lies on the light: `[-1, 1]²` on a rectangle, the unit disc on disc, sphere and sun, light-local
    /// world units on a polygon.
    pub parameters: Vec<[f32; 2]>,
    /// What the kernels read: a position and 1, a direction towards the sun and 0, or the sphere's parameter and 1.
    pub records: Vec<[f32; 4]>,
    /// Relative radiance of each sample: the texture's value, 1 without a texture.
    pub radiance: Vec<[f32; 3]>,
}

/// `count` points of the unit square in progressive order, the same for equal arguments on every machine.
///
/// # Errors
/// [`SceneError::Invalid`] for no samples or more than [`MAX_SAMPLES`].
pub fn unit_square(pattern: SamplePattern, count: u32, seed: u32) -> Result<Vec<[f64; 2]>, SceneError> {
    if count == 0 || count > MAX_SAMPLES {
        return Err(SceneError::invalid("samples", format!("must lie between 1 and {MAX_SAMPLES}, got {count}")));
    }
    Ok(match pattern {
        SamplePattern::LowDiscrepancy => (0..count).map(|index| sobol(index, seed)).collect(),
        SamplePattern::Stratified => {
            let cells = Cells::new(count);
            let order = progressive_order(&cells, count);
            order.into_iter().map(|cell| cells.jittered(cell, hash2(cell, seed))).collect()
        }
    })
}

/// A point of the Owen-scrambled sequence, which is 2^16 long: more than MAX_SAMPLES.
pub(crate) fn sobol(index: u32, seed: u32) -> [f64; 2] {
    [0, 1].map(|axis| f64::from(sobol_burley::sample(index, axis, seed)))
}

/// The unit square cut into `n` cells of equal area: rows of equal cells, each row as high as its share of the cells.
pub(crate) struct Cells {
    /// First cell of each row, and `n` at the end.
    row_starts: Vec<u32>,
}

impl Cells {
    pub(crate) fn new(count: u32) -> Self {
        // 32 = 8 × 4 and 128 = 16 × 8; a count without such a pair of factors gets rows that differ by one cell.
        let rows = (1..=count)
            .take_while(|r| r * r <= count)
            .filter(|r| count.is_multiple_of(*r) && count / r <= 2 * r)
            .last()
            .unwrap_or_else(|| f64::from(count).sqrt().round() as u32);
        let row_starts = (0..=rows).map(|r| (u64::from(r) * u64::from(count) / u64::from(rows)) as u32).collect();
        Self { row_starts }
    }

    fn count(&self) -> u32 {
        self.row_starts[self.row_starts.len() - 1]
    }

    fn cell_at(&self, [u, v]: [f64; 2]) -> u32 {
        let count = self.count();
        let below = v * f64::from(count);
        let row =
            self.row_starts.partition_point(|&start| f64::from(start) <= below).clamp(1, self.row_starts.len() - 1);
        let (start, end) = (self.row_starts[row - 1], self.row_starts[row]);
        start + ((u * f64::from(end - start)) as u32).min(end - start - 1)
    }

    pub(crate) fn jittered(&self, cell: u32, [du, dv]: [f64; 2]) -> [f64; 2] {
        let row = self.row_starts.partition_point(|&start| start <= cell);
        let (start, end) = (self.row_starts[row - 1], self.row_starts[row]);
        let width = f64::from(end - start);
        [(f64::from(cell - start) + du) / width, (f64::from(start) + dv * width) / f64::from(self.count())]
    }
}

/// All cells once, in the order in which an unscrambled Sobol sequence visits them, so that every prefix is spread out.
pub(crate) fn progressive_order(cells: &Cells, count: u32) -> Vec<u32> {
    let mut seen = vec![false; count as usize];
    let mut order = Vec::with_capacity(count as usize);
    let mut visit = |cell: u32, order: &mut Vec<u32>| {
        if !std::mem::replace(&mut seen[cell as usize], true) {
            order.push(cell);
        }
    };
    for index in 0..count.saturating_mul(4) {
        visit(cells.cell_at(plain_sobol(index)), &mut order);
    }
    for cell in 0..count {
        visit(cell, &mut order);
    }
    order
}

/// The first two dimensions of the Sobol sequence: bit reversal, and its image under Pascal's triangle modulo 2.
fn plain_sobol(index: u32) -> [f64; 2] {
    let mut second = 0u32;
    let mut column = 1u32 << 31;
    let mut rest = index;
    while rest != 0 {
        if rest & 1 == 1 {
            second ^= column;
        }
        rest >>= 1;
        column ^= column >> 1;
    }
    [index.reverse_bits(), second].map(|bits| f64::from(bits) / 2f64.powi(32))
}

/// Two uniform numbers in `[0, 1)` from a cell and a seed (splitmix64).
pub(crate) fn hash2(cell: u32, seed: u32) -> [f64; 2] {
    // Mixed before it is stepped: neighbouring cells must not walk through each other's numbers.
    let mut state = splitmix(u64::from(seed) << 32 | u64::from(cell));
    [0; 2].map(|_: u32| {
        state = state.wrapping_add(GOLDEN);
        (splitmix(state) >> 11) as f64 / 2f64.powi(53)
    })
}

const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

pub(crate) fn splitmix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// The seed of a progressive pass: pass 0 has the caller's, and no pass that of another pass or of a neighbouring seed.
#[must_use]
pub fn pass_seed(seed: u32, pass: u32) -> u32 {
    if pass == 0 {
        return seed;
    }
    (splitmix((u64::from(seed) << 32 | u64::from(pass)).wrapping_add(GOLDEN)) >> 32) as u32
}

/// Square to disc with equal areas and neighbours kept (Shirley and Chiu 1997).
fn concentric_disc([u, v]: [f64; 2]) -> DVec2 {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    if a == 0.0 && b == 0.0 {
        return DVec2::ZERO;
    }
    let quarter = std::f64::consts::FRAC_PI_4;
    let (radius, angle) = if a.abs() > b.abs() { (a, quarter * (b / a)) } else { (b, quarter * (2.0 - a / b)) };
    DVec2::from_angle(angle) * radius
}

impl LightSamples {
    /// The samples of all sets on `light` in the local frame, set after set.
    ///
    /// # Errors
    /// As [`LightSampling::squares`].
    pub fn new(light: &Light, frame: &LocalFrame, sampling: &LightSampling) -> Result<Self, SceneError> {
        let square = sampling.squares()?;
        let place = light.local(frame);
        let parameters: Vec<DVec2> = match light.shape() {
            LightShape::Rectangle { .. } => square.iter().map(|s| DVec2::from(*s) * 2.0 - 1.0).collect(),
            LightShape::Disc { .. } | LightShape::Sphere { .. } | LightShape::Sun { .. } => {
                square.iter().map(|s| concentric_disc(*s)).collect()
            }
            LightShape::Polygon { outline } => polygon_points(outline, &square)?,
        };
        let records = parameters.iter().map(|p| record(light.shape(), &place, *p)).collect();
        let radiance = parameters.iter().map(|p| light.texture().map_or([1.0; 3], |t| t.at(p.x, p.y))).collect();
        Ok(Self { parameters: parameters.iter().map(|p| p.as_vec2().to_array()).collect(), records, radiance })
    }
}

fn record(shape: &LightShape, place: &LocalLight, p: DVec2) -> [f32; 4] {
    let on_plane = |x: f64, y: f64| {
        let s = place.length_scale;
        (place.center + place.x_axis * (x * s) + place.y_axis * (y * s)).as_vec3().extend(1.0).to_array()
    };
    match shape {
        LightShape::Rectangle { width, height } => on_plane(p.x * width * 0.5, p.y * height * 0.5),
        LightShape::Disc { radius } => on_plane(p.x * radius, p.y * radius),
        LightShape::Polygon { .. } => on_plane(p.x, p.y),
        LightShape::Sphere { .. } => [p.x as f32, p.y as f32, 0.0, 1.0],
        LightShape::Sun { angular_diameter } => {
            // Uniform in solid angle, as in `sample_positions`: `share` of the cap lies inside this sample's cone.
            let cap = 1.0 - (angular_diameter * 0.5).cos();
            let reach = cap_reach(cap, p.length_squared());
            let towards = -place.emission + (place.x_axis * p.x + place.y_axis * p.y) * reach;
            towards.as_vec3().extend(0.0).to_array()
        }
    }
}

/// The factor by which a point of the unit disc is moved off the axis, at distance 1, so that equal areas of the disc become equal
/// solid angles of a cap of height `cap` = 1 − cosine; `share` is the point's squared radius.
pub(crate) fn cap_reach(cap: f64, share: f64) -> f64 {
    (cap * (2.0 - share * cap)).sqrt() / (1.0 - share * cap)
}

/// Points of equal share on a polygon: the first coordinate chooses a triangle by area and is stretched over it again.
fn polygon_points(outline: &[[f64; 2]], square: &[[f64; 2]]) -> Result<Vec<DVec2>, SceneError> {
    let triangles = triangulate(outline)?;
    let corner = |i: usize| DVec2::from(outline[i]);
    let mut ends: Vec<f64> = Vec::with_capacity(triangles.len());
    for t in &triangles {
        let area = (corner(t[1]) - corner(t[0])).perp_dot(corner(t[2]) - corner(t[0])).abs();
        ends.push(ends.last().copied().unwrap_or(0.0) + area);
    }
    let total = ends[ends.len() - 1];
    let point = |s: &[f64; 2]| {
        let along = s[0] * total;
        let chosen = ends.partition_point(|end| *end <= along).min(ends.len() - 1);
        let start = if chosen == 0 { 0.0 } else { ends[chosen - 1] };
        let within = ((along - start) / (ends[chosen] - start)).clamp(0.0, 1.0);
        let t = triangles[chosen];
        let (a, b, c) = (corner(t[0]), corner(t[1]), corner(t[2]));
        // sqrt spreads the points evenly although the triangle narrows towards `a`.
        let root = within.sqrt();
        a + (b - a) * (root * (1.0 - s[1])) + (c - a) * (root * s[1])
    };
    Ok(square.iter().map(point).collect())
}

/// Positions of samples, given by their records, as one receiver sees them, in local float64: positions with `true`, directions with `false`.
///
/// For a sphere these are points of the surface that the receiver sees, uniform in solid angle; the kernels compute
/// the same in float32 (`shaders_wgsl/shared/light.wgsl`). `None` for a receiver inside the sphere.
#[must_use]
pub fn sample_positions(
    light: &Light,
    frame: &LocalFrame,
    records: &[[f32; 4]],
    receiver: DVec3,
) -> Option<Vec<(DVec3, bool)>> {
    let LightShape::Sphere { radius } = light.shape() else {
        let as_f64 = |r: &[f32; 4]| (DVec3::new(f64::from(r[0]), f64::from(r[1]), f64::from(r[2])), r[3] != 0.0);
        return Some(records.iter().map(as_f64).collect());
    };
    let center = light.local(frame).center;
    let axis = center - receiver;
    let sine = frame.local_length(*radius) / axis.length();
    if sine >= 1.0 {
        return None;
    }
    let cap = sine * sine / (1.0 + (1.0 - sine * sine).sqrt());
    let (x_axis, y_axis) = (axis / axis.length()).any_orthonormal_pair();
    let place = |r: &[f32; 4]| {
        let (x, y) = (f64::from(r[0]), f64::from(r[1]));
        let (share, reach) = (x * x + y * y, cap_reach(cap, x * x + y * y));
        let to_disc = axis + (x_axis * x + y_axis * y) * (reach * axis.length());
        // From the disc through the centre back to the surface.
        let outside = 1.0 - sine * sine;
        let to_surface = outside / (1.0 + (1.0 - (1.0 + reach * reach * share) * outside).max(0.0).sqrt());
        (receiver + to_disc * to_surface, true)
    };
    Some(records.iter().map(place).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::look_at;

    /// The largest difference between the share of points below a corner and the corner's area.
    fn star_discrepancy(points: &[[f64; 2]]) -> f64 {
        let n = points.len() as f64;
        let corners = (1..=20).flat_map(|i| (1..=20).map(move |j| [f64::from(i) / 20.0, f64::from(j) / 20.0]));
        corners
            .map(|c| (points.iter().filter(|p| p[0] < c[0] && p[1] < c[1]).count() as f64 / n - c[0] * c[1]).abs())
            .fold(0.0, f64::max)
    }

    #[test]
    fn every_cell_holds_one_sample() {
        for count in [1, 2, 3, 7, 16, 32, 37, 64, 100, 128, 256, 1009] {
            let cells = Cells::new(count);
            let mut hit = vec![0; count as usize];
            for s in unit_square(SamplePattern::Stratified, count, 9).unwrap() {
                assert!(s.iter().all(|x| (0.0..1.0).contains(x)));
                hit[cells.cell_at(s) as usize] += 1;
            }
            assert!(hit.iter().all(|&h| h == 1), "{count}");
        }
        assert_eq!(Cells::new(32).row_starts, [0, 8, 16, 24, 32]);
        assert_eq!(Cells::new(128).row_starts.len(), 9);
    }

    #[test]
    fn prefixes_are_spread_and_seeds_differ() {
        for pattern in [SamplePattern::Stratified, SamplePattern::LowDiscrepancy] {
            let set = unit_square(pattern, 256, 3).unwrap();
            assert!(star_discrepancy(&set) < 0.03, "{pattern:?} {}", star_discrepancy(&set));
            assert!(star_discrepancy(&set[..16]) < 0.16, "{pattern:?} {}", star_discrepancy(&set[..16]));
            assert_ne!(set, unit_square(pattern, 256, 4).unwrap());
            assert_eq!(set, unit_square(pattern, 256, 3).unwrap());
        }
        let clumped: Vec<_> =
            unit_square(SamplePattern::Stratified, 256, 3).unwrap().iter().map(|s| s.map(|x| x * x)).collect();
        assert!(star_discrepancy(&clumped) > 0.1, "the measure sees a distribution that is not uniform");
    }

    #[test]
    fn polygon_samples_share_the_area() {
        // An L of three unit squares: each square gets a third of the samples.
        let outline = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
        let square = unit_square(SamplePattern::LowDiscrepancy, 4096, 1).unwrap();
        let points = polygon_points(&outline, &square).unwrap();
        let share = |test: &dyn Fn(&DVec2) -> bool| points.iter().filter(|p| test(p)).count() as f64 / 4096.0;
        assert!((share(&|p| p.x > 1.0) - 1.0 / 3.0).abs() < 0.01);
        assert!((share(&|p| p.y > 1.0) - 1.0 / 3.0).abs() < 0.01);
        assert_eq!(share(&|p| p.x > 1.0 && p.y > 1.0), 0.0);
    }

    #[test]
    fn sphere_samples_lie_on_the_tangent_cone_and_share_solid_angle() {
        let pose = look_at([0.0, 0.0, 3.0], [0.0; 3], None).unwrap();
        let light = Light::new(LightShape::Sphere { radius: 2.0 }, pose).unwrap();
        let frame = LocalFrame::around(None);
        let samples =
            LightSamples::new(&light, &frame, &LightSampling::correlated(SamplePattern::LowDiscrepancy, 4096, 5))
                .unwrap();
        let positions = sample_positions(&light, &frame, &samples.records, DVec3::ZERO).unwrap();
        let cos_edge = (1.0 - 4.0 / 9.0f64).sqrt();
        let cosines: Vec<f64> = positions.iter().map(|(s, _)| s.normalize().z).collect();
        assert!(cosines.iter().all(|c| *c >= cos_edge - 1e-6));
        let mean = cosines.iter().sum::<f64>() / 4096.0;
        assert!((mean - (1.0 + cos_edge) * 0.5).abs() < 1e-4, "uniform in the cosine: {mean}");
        assert!(
            sample_positions(&light, &frame, &samples.records, DVec3::new(0.0, 0.0, 2.0)).is_none(),
            "inside the light"
        );
    }

    #[test]
    fn counts_out_of_range_are_refused() {
        assert!(unit_square(SamplePattern::Stratified, 0, 0).is_err());
        assert!(unit_square(SamplePattern::Stratified, MAX_SAMPLES + 1, 0).is_err());
    }
}
