//! Clipping convex polygons, and the area of a union of them.

/// The part of a convex polygon where the linear function `side` is not negative (Sutherland and Hodgman 1974).
///
/// Vertices may have any number of coordinates: homogeneous ones are clipped before they are divided.
pub(crate) fn clip<const N: usize>(polygon: &[[f64; N]], side: impl Fn(&[f64; N]) -> f64) -> Vec<[f64; N]> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (index, from) in polygon.iter().enumerate() {
        let to = &polygon[(index + 1) % polygon.len()];
        let (at_from, at_to) = (side(from), side(to));
        if at_from >= 0.0 {
            kept.push(*from);
        }
        if (at_from > 0.0 && at_to < 0.0) || (at_from < 0.0 && at_to > 0.0) {
            let t = at_from / (at_from - at_to);
            kept.push(std::array::from_fn(|axis| from[axis] + (to[axis] - from[axis]) * t));
        }
    }
    kept
}

/// A polygon's side that is not vertical, running from low x to high x.
struct Side {
    polygon: usize,
    from: [f64; 2],
    to: [f64; 2],
}

impl Side {
    fn y_at(&self, x: f64) -> f64 {
        let t = (x - self.from[0]) / (self.to[0] - self.from[0]);
        self.from[1] + (self.to[1] - self.from[1]) * t
    }

    /// The x at which two sides cross, from their distances at both ends of the x-range they share.
    fn crossing(&self, other: &Self) -> Option<f64> {
        let left = self.from[0].max(other.from[0]);
        let right = self.to[0].min(other.to[0]);
        if left >= right {
            return None;
        }
        let at_left = self.y_at(left) - other.y_at(left);
        let at_right = self.y_at(right) - other.y_at(right);
        (at_left * at_right < 0.0)
            .then(|| left + (right - left) * at_left / (at_left - at_right))
            .filter(|x| left < *x && *x < right)
    }
}

/// Area of the union of convex polygons, in any winding, overlapping in any way.
///
/// The plane is cut into vertical slabs at every vertex and at every crossing. Inside a slab no two sides cross, so the
/// covered length is linear in x and its value in the middle times the slab's width is the covered area. There is no
/// topology that rounding could break: a crossing misplaced by δ moves the area by O(δ²) of the sides' difference in slope.
/// Time grows with (number of slabs) × (number of polygons).
pub(crate) fn area_of_union(polygons: &[Vec<[f64; 2]>]) -> f64 {
    let sides = sides_of(polygons);
    let mut cuts: Vec<f64> = polygons.iter().flatten().map(|vertex| vertex[0]).collect();
    for (index, side) in sides.iter().enumerate() {
        // Sides are sorted by where they begin, so later ones can be left out together.
        for other in &sides[index + 1..] {
            if other.from[0] >= side.to[0] {
                break;
            }
            if other.polygon != side.polygon {
                cuts.extend(side.crossing(other));
            }
        }
    }
    cuts.sort_unstable_by(f64::total_cmp);
    cuts.dedup();

    let mut active: Vec<&Side> = Vec::new();
    let mut waiting = sides.iter().peekable();
    let mut area = 0.0;
    for slab in cuts.windows(2) {
        let middle = slab[0] + (slab[1] - slab[0]) / 2.0;
        while let Some(side) = waiting.next_if(|side| side.from[0] <= slab[0]) {
            active.push(side);
        }
        active.retain(|side| side.to[0] >= slab[1]);
        area += (slab[1] - slab[0]) * covered_length(&active, middle);
    }
    area
}

fn sides_of(polygons: &[Vec<[f64; 2]>]) -> Vec<Side> {
    let mut sides = Vec::new();
    for (polygon, vertices) in polygons.iter().enumerate() {
        for (index, &a) in vertices.iter().enumerate() {
            let b = vertices[(index + 1) % vertices.len()];
            let (from, to) = if a[0] <= b[0] { (a, b) } else { (b, a) };
            if from[0] < to[0] {
                sides.push(Side { polygon, from, to });
            }
        }
    }
    sides.sort_by(|a, b| a.from[0].total_cmp(&b.from[0]));
    sides
}

/// Length of the vertical line at `x` that the polygons of the `active` sides cover.
fn covered_length(active: &[&Side], x: f64) -> f64 {
    let mut heights: Vec<(usize, f64)> = active.iter().map(|side| (side.polygon, side.y_at(x))).collect();
    heights.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut intervals: Vec<[f64; 2]> = heights
        .chunk_by(|a, b| a.0 == b.0)
        .map(|of_polygon| [of_polygon[0].1, of_polygon[of_polygon.len() - 1].1])
        .collect();
    intervals.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
    let mut length = 0.0;
    let mut reached = f64::NEG_INFINITY;
    for [low, high] in intervals {
        length += (high - low.max(reached)).max(0.0);
        reached = reached.max(high);
    }
    length
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rectangle(x: [f64; 2], y: [f64; 2]) -> Vec<[f64; 2]> {
        vec![[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]]
    }

    fn rotated(polygon: &[[f64; 2]], angle: f64) -> Vec<[f64; 2]> {
        let (sin, cos) = angle.sin_cos();
        polygon.iter().map(|p| [cos * p[0] - sin * p[1], sin * p[0] + cos * p[1]]).collect()
    }

    #[test]
    fn overlaps_count_once_at_every_angle() {
        // A cross of two bars, one of them twice: 3 + 3 − 1.
        let bars = [
            rectangle([-1.5, 1.5], [-0.5, 0.5]),
            rectangle([-0.5, 0.5], [-1.5, 1.5]),
            rectangle([-0.5, 0.5], [-1.5, 1.5]),
        ];
        for step in 0..64 {
            let angle = f64::from(step) * 0.1;
            let turned: Vec<_> = bars.iter().map(|bar| rotated(bar, angle)).collect();
            let area = area_of_union(&turned);
            assert!((area - 5.0).abs() < 1e-12, "{area} at {angle}");
        }
    }

    #[test]
    fn a_shifted_bar_changes_the_area() {
        let apart = [rectangle([0.0, 1.0], [0.0, 1.0]), rectangle([1.001, 2.0], [0.0, 1.0])];
        assert!((area_of_union(&apart) - 1.999).abs() < 1e-12);
        assert_eq!(area_of_union(&[]), 0.0);
    }

    #[test]
    fn clipping_keeps_the_positive_side() {
        let kept = clip(&rectangle([0.0, 1.0], [0.0, 1.0]), |p| 0.25 - p[0]);
        assert!((area_of_union(&[kept]) - 0.25).abs() < 1e-15);
        let gone = clip(&rectangle([0.0, 1.0], [0.0, 1.0]), |p| -1.0 - p[0]);
        assert!(gone.is_empty());
    }
}
