//! A binary hierarchy of boxes over triangles, split where the surface area heuristic says (MacDonald and Booth 1990; in
//! bins, Wald 2007). The same triangles give the same hierarchy.

use std::ops::Range;

use super::beam::Beam;
use crate::vector::Vec3;

const LEAF_SIZE: usize = 4;

/// Enough that more bins gain nothing measurable.
const BINS: usize = 16;

/// Below this depth every split halves, so that a walk needs a stack of no more than `DEEPEST`.
const DEEPEST_UNEVEN: usize = 40;

/// 2^32 triangles in halves.
const DEEPEST: usize = DEEPEST_UNEVEN + 32;

#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds {
    pub(super) low: Vec3,
    pub(super) high: Vec3,
}

impl Bounds {
    const EMPTY: Self = Self { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };

    pub(super) fn around(points: &[Vec3]) -> Self {
        points.iter().fold(Self::EMPTY, |bounds, point| bounds.and(&Self { low: *point, high: *point }))
    }

    fn and(&self, other: &Self) -> Self {
        Self {
            low: std::array::from_fn(|axis| self.low[axis].min(other.low[axis])),
            high: std::array::from_fn(|axis| self.high[axis].max(other.high[axis])),
        }
    }

    fn center(&self) -> Vec3 {
        std::array::from_fn(|axis| 0.5 * (self.low[axis] + self.high[axis]))
    }

    fn extent(&self) -> Vec3 {
        std::array::from_fn(|axis| self.high[axis] - self.low[axis])
    }

    fn half_area(&self) -> f64 {
        let [x, y, z] = self.extent();
        x * y + y * z + z * x
    }

    pub(super) fn largest_coordinate(&self) -> f64 {
        self.low.iter().chain(&self.high).fold(0.0, |largest, x| x.abs().max(largest))
    }
}

/// A leaf of `count` entries from `first` on, or with a count of 0 the parent of the nodes `first` and `first + 1`.
#[derive(Debug, Clone)]
struct Node {
    bounds: Bounds,
    first: u32,
    count: u32,
}

#[derive(Debug, Clone)]
pub(super) struct Hierarchy {
    nodes: Vec<Node>,
}

impl Hierarchy {
    /// The hierarchy and the order of the boxes in its leaves.
    pub(super) fn over(boxes: &[Bounds]) -> (Self, Vec<usize>) {
        let mut order: Vec<usize> = (0..boxes.len()).collect();
        let mut nodes = Vec::with_capacity(boxes.len());
        if !boxes.is_empty() {
            nodes.push(leaf(boxes, &order, 0));
            let mut open = vec![(0, 0..boxes.len(), 0)];
            while let Some((node, range, depth)) = open.pop() {
                if range.len() <= LEAF_SIZE {
                    continue;
                }
                let middle = range.start + split(boxes, &mut order[range.clone()], depth);
                let first = nodes.len();
                nodes[node] = Node { bounds: nodes[node].bounds, first: as_u32(first), count: 0 };
                for (child, part) in [(first, range.start..middle), (first + 1, middle..range.end)] {
                    nodes.push(leaf(boxes, &order[part.clone()], part.start));
                    open.push((child, part, depth + 1));
                }
            }
        }
        (Self { nodes }, order)
    }

    /// The box of everything, `None` without any triangles.
    pub(super) fn bounds(&self) -> Option<Bounds> {
        self.nodes.first().map(|root| root.bounds)
    }

    /// Calls `visit` with every leaf that the beam can enter, nearer children first, until it says true; whether it did.
    #[inline]
    pub(super) fn any(&self, beam: &impl Beam, mut visit: impl FnMut(Range<usize>) -> bool) -> bool {
        let enters = |node: &Node| beam.entry(&node.bounds.low, &node.bounds.high);
        let Some(mut node) = self.nodes.first().filter(|root| enters(root).is_some()) else {
            return false;
        };
        let mut waiting = [0_u32; DEEPEST];
        let mut count = 0;
        loop {
            let first = node.first as usize;
            if node.count > 0 {
                if visit(first..first + node.count as usize) {
                    return true;
                }
            } else {
                let [left, right] = [&self.nodes[first], &self.nodes[first + 1]];
                match (enters(left), enters(right)) {
                    (Some(at_left), Some(at_right)) => {
                        let left_first = at_left <= at_right;
                        waiting[count] = node.first + u32::from(left_first);
                        count += 1;
                        node = if left_first { left } else { right };
                        continue;
                    }
                    (Some(_), None) => {
                        node = left;
                        continue;
                    }
                    (None, Some(_)) => {
                        node = right;
                        continue;
                    }
                    (None, None) => {}
                }
            }
            if count == 0 {
                return false;
            }
            count -= 1;
            node = &self.nodes[waiting[count] as usize];
        }
    }

    #[cfg(test)]
    pub(super) fn shrink_boxes(&mut self, factor: f64) {
        for Node { bounds, .. } in &mut self.nodes {
            let center = bounds.center();
            let shrunk =
                |corner: Vec3| std::array::from_fn(|axis| center[axis] + factor * (corner[axis] - center[axis]));
            *bounds = Bounds { low: shrunk(bounds.low), high: shrunk(bounds.high) };
        }
    }
}

fn as_u32(index: usize) -> u32 {
    u32::try_from(index).expect("meshes have fewer than 2^31 triangles")
}

fn leaf(boxes: &[Bounds], order: &[usize], first: usize) -> Node {
    let bounds = order.iter().fold(Bounds::EMPTY, |bounds, index| bounds.and(&boxes[*index]));
    Node { bounds, first: as_u32(first), count: as_u32(order.len()) }
}

/// Orders the boxes into two parts that are not empty; the length of the first.
fn split(boxes: &[Bounds], order: &mut [usize], depth: usize) -> usize {
    let centers = order.iter().fold(Bounds::EMPTY, |all, index| all.and(&Bounds::around(&[boxes[*index].center()])));
    let cheapest = (0..3)
        .filter(|axis| depth < DEEPEST_UNEVEN && centers.extent()[*axis] > 0.0)
        .filter_map(|axis| cheapest_cut(boxes, order, &Bins::new(&centers, axis)))
        .min_by(|a, b| a.cost.total_cmp(&b.cost));
    let Some(cut) = cheapest else {
        let axis = (0..3).max_by(|a, b| centers.extent()[*a].total_cmp(&centers.extent()[*b])).unwrap_or(0);
        order.sort_by(|a, b| boxes[*a].center()[axis].total_cmp(&boxes[*b].center()[axis]).then(a.cmp(b)));
        return order.len() / 2;
    };
    let (below, above): (Vec<usize>, Vec<usize>) =
        order.iter().partition(|index| cut.bins.of(&boxes[**index]) < cut.at);
    order[..below.len()].copy_from_slice(&below);
    order[below.len()..].copy_from_slice(&above);
    below.len()
}

#[derive(Clone, Copy)]
struct Bins {
    axis: usize,
    low: f64,
    per_length: f64,
}

impl Bins {
    fn new(centers: &Bounds, axis: usize) -> Self {
        Self { axis, low: centers.low[axis], per_length: BINS as f64 / centers.extent()[axis] }
    }

    fn of(&self, bounds: &Bounds) -> usize {
        (((bounds.center()[self.axis] - self.low) * self.per_length) as usize).min(BINS - 1)
    }
}

struct Cut {
    bins: Bins,
    /// The first bin of the second part.
    at: usize,
    cost: f64,
}

fn cheapest_cut(boxes: &[Bounds], order: &[usize], bins: &Bins) -> Option<Cut> {
    let mut filled = [(Bounds::EMPTY, 0_usize); BINS];
    for index in order {
        let (bounds, count) = &mut filled[bins.of(&boxes[*index])];
        *bounds = bounds.and(&boxes[*index]);
        *count += 1;
    }
    let join = |parts: &[(Bounds, usize)]| {
        parts.iter().fold((Bounds::EMPTY, 0), |(bounds, count), part| (bounds.and(&part.0), count + part.1))
    };
    let cost = |(bounds, count): (Bounds, usize)| bounds.half_area() * count as f64;
    (1..BINS)
        .map(|at| (at, join(&filled[..at]), join(&filled[at..])))
        .filter(|(_, below, above)| below.1 > 0 && above.1 > 0)
        .map(|(at, below, above)| Cut { bins: *bins, at, cost: cost(below) + cost(above) })
        .min_by(|a, b| a.cost.total_cmp(&b.cost))
}
