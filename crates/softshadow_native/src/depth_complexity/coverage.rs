//! Which samples the way from the reference point crosses an edge to.
//!
//! A way c→s crosses the edge iff s lies between the directions of its ends (in its *sector*) and beyond its line. Both can be taken
//! sample by sample, or from tables over directions and lines, as in the paper (section 4.3; its cube map of directions is a
//! one-dimensional table here, because a sector needs a direction only).
//!
//! Neighbouring edges read the same entry for the corner they share, so sectors tile the light without gaps whatever the resolution.

use glam::{DVec2, Vec2};

use super::edge::ProjectedEdge;

/// One bit a sample.
pub type Mask<const W: usize> = [u64; W];

/// How crossings are found.
#[derive(Debug, Clone, Copy)]
pub enum Coverage<'a> {
    /// Sample by sample.
    Exact,
    /// From tables: fast, and a sample may be taken for its neighbour within a cell. Samples of a sphere move from receiver to
    /// receiver, so there every crossing is found exactly.
    Tables(&'a CoverageTables),
}

/// Samples with c→s across the edge, exactly: those whose direction changes sides between the two ends in the sense that c's side of
/// the line demands, and that lie beyond the line.
#[must_use]
pub fn crossed_exactly<const W: usize>(edge: &ProjectedEdge, [from, to]: [DVec2; 2], samples: &[[f32; 2]]) -> Mask<W> {
    let line = edge.line;
    let left = edge.has_reference_left;
    let line_left = edge.line_has_reference_left([from, to]);
    let mut mask = [0; W];
    for (word, chunk) in mask.iter_mut().zip(samples.chunks(64)) {
        for (bit, [x, y]) in chunk.iter().enumerate() {
            // The side of a direction does not know which edge asks, and is exact: so is the side of c.
            let s = DVec2::new(f64::from(*x), f64::from(*y));
            let left_of_from = from.perp_dot(s) >= 0.0;
            let left_of_to = to.perp_dot(s) >= 0.0;
            let beyond = (line.x * x + line.y * y + line.z >= 0.0) != line_left;
            let crossed = (left_of_from != left_of_to) & (left_of_from == left) & beyond;
            *word |= u64::from(crossed) << bit;
        }
    }
    mask
}

/// Tables for one set of samples of a light whose samples stand still.
#[derive(Debug, Clone, PartialEq)]
pub struct CoverageTables {
    words: usize,
    directions: usize,
    angles: usize,
    distances: usize,
    farthest: f32,
    /// For each direction the samples before it, counted from the direction of +x.
    before: Vec<u64>,
    /// For each direction and distance the samples beyond the line that lies so far in that direction.
    beyond: Vec<u64>,
}

/// The angle of a direction as a number in [0, 4): its place on the border of the square |x| + |y| = 1.
fn pseudo_angle(v: Vec2) -> f32 {
    let across = v.y / (v.x.abs() + v.y.abs()).max(f32::MIN_POSITIVE);
    if v.x < 0.0 {
        2.0 - across
    } else if v.y < 0.0 {
        4.0 + across
    } else {
        across
    }
}

/// The direction of a pseudo angle, on |x| + |y| = 1.
fn direction_of(angle: f32) -> Vec2 {
    let turn = angle.rem_euclid(4.0);
    let x = (turn - 2.0).abs() - 1.0;
    let y = 1.0 - x.abs();
    Vec2::new(x, if turn < 2.0 { y } else { -y })
}

impl CoverageTables {
    /// Tables of a resolution: `directions` entries for sectors, `angles × distances` for lines, each at least one.
    #[must_use]
    pub fn new(samples: &[[f32; 2]], directions: usize, angles: usize, distances: usize) -> Self {
        let [directions, angles, distances] = [directions, angles, distances].map(|cells| cells.max(1));
        let words = samples.len().div_ceil(64);
        let points: Vec<Vec2> = samples.iter().map(|s| Vec2::from(*s)).collect();
        let mask = |holds: &dyn Fn(Vec2) -> bool| {
            points
                .chunks(64)
                .map(|chunk| {
                    chunk.iter().enumerate().fold(0u64, |word, (bit, point)| word | u64::from(holds(*point)) << bit)
                })
                .collect::<Vec<u64>>()
        };
        // Distances are measured along directions with |x| + |y| = 1.
        let farthest = points.iter().map(|p| p.x.abs().max(p.y.abs())).fold(f32::MIN_POSITIVE, f32::max);
        let before = (0..directions).flat_map(|entry| {
            let angle = (entry as f32 + 0.5) * 4.0 / directions as f32;
            mask(&|p| pseudo_angle(p) < angle)
        });
        let beyond = (0..angles * distances).flat_map(|entry| {
            let normal = direction_of(((entry / distances) as f32 + 0.5) * 4.0 / angles as f32);
            let distance = ((entry % distances) as f32 + 0.5) * farthest / distances as f32;
            mask(&|p| normal.dot(p) > distance)
        });
        Self { words, directions, angles, distances, farthest, before: before.collect(), beyond: beyond.collect() }
    }

    /// How many 64-bit words a mask takes.
    #[must_use]
    pub fn words(&self) -> usize {
        self.words
    }

    /// Bytes of both tables.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(self.before.as_slice()) + size_of_val(self.beyond.as_slice())
    }

    /// How far from a line a sample may be taken for one on its other side, and by what angle (in radians) a sector's border may be
    /// moved.
    #[must_use]
    pub fn discretisation(&self) -> [f32; 2] {
        // Half a cell of pseudo angle is 2 / cells along the square |x| + |y| = 1. There a direction turns by at most twice that,
        // and a normal changes by as much in each component. Normals are at least √½ long, so distances grow by at most √2.
        let half_cell = |cells: usize| 2.0 / cells as f32;
        let across = half_cell(self.angles) * 2.0 * self.farthest + 0.5 * self.farthest / self.distances as f32;
        [across * std::f32::consts::SQRT_2, 2.0 * half_cell(self.directions)]
    }

    /// Samples with c→s across the edge, by the tables.
    #[must_use]
    pub fn crossed<const W: usize>(&self, edge: &ProjectedEdge, [from, to]: [DVec2; 2]) -> Mask<W> {
        let left = edge.has_reference_left;
        let line = edge.line;
        // Away from c, across the line.
        let away_from_left = edge.line_has_reference_left([from, to]);
        let normal = if away_from_left { -line.truncate() } else { line.truncate() };
        let length = normal.x.abs() + normal.y.abs();
        let distance = line.z.abs() / length.max(f32::MIN_POSITIVE) * self.distances as f32 / self.farthest;
        if distance >= self.distances as f32 {
            return [0; W];
        }
        let angle = Self::cell(pseudo_angle(normal), self.angles);
        let beyond = &self.beyond[(angle * self.distances + distance as usize) * self.words..][..self.words];
        let [first, last] = (if left { [from, to] } else { [to, from] }).map(DVec2::as_vec2);
        let [first_before, last_before] = [first, last]
            .map(|d| &self.before[Self::cell(pseudo_angle(d), self.directions) * self.words..][..self.words]);
        // Whether the sector holds the direction from which the table counts is a matter of signs: comparing the angles could contradict
        // the side of c, and then half of all samples would be set.
        let wraps = first.y < 0.0 && last.y >= 0.0;
        let mut mask = [0; W];
        for (w, word) in mask.iter_mut().enumerate().take(self.words) {
            let sector = if wraps { last_before[w] | !first_before[w] } else { last_before[w] & !first_before[w] };
            *word = sector & beyond[w];
        }
        mask
    }

    fn cell(angle: f32, cells: usize) -> usize {
        ((angle * (cells as f32 * 0.25)) as usize).min(cells - 1)
    }
}
