//! The bounding volume hierarchy that rays walk on the GPU, built by `obvhs` on the CPU and threaded for a walk without a stack.
//!
//! Nodes stand in depth-first order, and each knows where to go on when its box is missed. So a kernel needs no stack, no depth
//! of the tree can overflow, and a walk may begin at any node.

use std::collections::HashSet;
use std::ops::Range;

use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::{Bvh2, builder::build_bvh2};

/// Triangles in one leaf at most; the count has to fit into the leaf's low bits.
const MAX_LEAF: u32 = 4;
const LEAF_BITS: u32 = 3;

/// One node as the kernels read it.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct BvhNode {
    /// Lower corner of the box.
    pub low: [f32; 3],
    /// The node to go on with when the box is missed or a leaf is done; the number of nodes ends the walk.
    pub skip: u32,
    /// Upper corner of the box.
    pub high: [f32; 3],
    /// 0 for an inner node, else `first triangle << 3 | count`.
    pub leaf: u32,
}

impl BvhNode {
    /// What stands in a leaf; empty for an inner node.
    pub(crate) fn leaf_range(&self) -> Range<usize> {
        let first = (self.leaf >> LEAF_BITS) as usize;
        first..first + (self.leaf & ((1 << LEAF_BITS) - 1)) as usize
    }
}

/// A hierarchy and the order of triangles that its leaves refer to.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Bvh {
    /// Nodes in depth-first order; empty without triangles.
    pub nodes: Vec<BvhNode>,
    /// For each triangle of the new order its index in the old.
    pub order: Vec<u32>,
    /// Its expected work when it was built; a refit is judged by it.
    pub built_cost: f64,
}

impl Bvh {
    /// Builds a hierarchy over finite triangles.
    #[must_use]
    pub fn build(triangles: &[[[f32; 3]; 3]]) -> Self {
        if triangles.is_empty() {
            return Self::default();
        }
        let boxes: Vec<Aabb> = triangles.iter().map(|t| Aabb::from_points(&t.map(Vec3A::from))).collect();
        let mut bvh = Self {
            nodes: Vec::with_capacity(2 * boxes.len()),
            order: Vec::with_capacity(boxes.len()),
            built_cost: 0.0,
        };
        let distinct: HashSet<[u32; 6]> = boxes.iter().map(box_bits).collect();
        if distinct.len() < boxes.len() / 2 {
            // Equal boxes cannot be told apart: the builder would search for minutes and gain nothing.
            bvh.halve(&boxes, 0..boxes.len());
        } else {
            let mut params = BvhBuildParams::medium_build();
            params.max_prims_per_leaf = MAX_LEAF;
            bvh.thread(&build_bvh2(&boxes, params, &mut std::time::Duration::default()));
        }
        bvh.built_cost = cost(&bvh.nodes);
        bvh
    }

    /// A balanced tree over the triangles in their given order; the recursion is as deep as the logarithm of their number.
    fn halve(&mut self, boxes: &[Aabb], range: Range<usize>) {
        let around = boxes[range.clone()].iter().fold(Aabb::empty(), |all, b| all.union(b));
        let (low, high) = (around.min.to_array(), around.max.to_array());
        let position = self.nodes.len();
        self.nodes.push(BvhNode { low, skip: 0, high, leaf: 0 });
        if range.len() <= MAX_LEAF as usize {
            self.nodes[position].leaf = (self.order.len() as u32) << LEAF_BITS | range.len() as u32;
            self.order.extend(range.map(|index| index as u32));
        } else {
            let middle = range.start + range.len() / 2;
            self.halve(boxes, range.start..middle);
            self.halve(boxes, middle..range.end);
        }
        self.nodes[position].skip = self.nodes.len() as u32;
    }

    /// Copies the tree in depth-first order. The stack lives on the heap: a degenerate tree may be as deep as it is long.
    fn thread(&mut self, tree: &Bvh2) {
        enum Step {
            Enter(u32),
            Close(usize),
        }
        let mut stack = vec![Step::Enter(0)];
        while let Some(step) = stack.pop() {
            match step {
                Step::Close(position) => self.nodes[position].skip = self.nodes.len() as u32,
                Step::Enter(index) => {
                    let node = tree.nodes[index as usize];
                    let position = self.nodes.len();
                    let mut leaf = 0;
                    if node.prim_count > 0 {
                        leaf = (self.order.len() as u32) << LEAF_BITS | node.prim_count;
                        let first = node.first_index as usize;
                        self.order.extend(&tree.primitive_indices[first..first + node.prim_count as usize]);
                    }
                    self.nodes.push(BvhNode {
                        low: node.aabb.min.to_array(),
                        skip: 0,
                        high: node.aabb.max.to_array(),
                        leaf,
                    });
                    stack.push(Step::Close(position));
                    if leaf == 0 {
                        stack.push(Step::Enter(node.first_index + 1));
                        stack.push(Step::Enter(node.first_index));
                    }
                }
            }
        }
    }
}

/// Boxes anew, bottom-up, for a tree whose triangles have moved; `leaf_box` bounds what stands in a leaf. In depth-first order
/// children follow their parents, so one backward walk meets them first.
pub(crate) fn refit(nodes: &mut [BvhNode], leaf_box: impl Fn(Range<usize>) -> Aabb) {
    for index in (0..nodes.len()).rev() {
        let node = nodes[index];
        let around = if node.leaf == 0 {
            let mut around = Aabb::empty();
            let mut child = index + 1;
            while child < node.skip as usize {
                around = around.union(&box_of(&nodes[child]));
                child = nodes[child].skip as usize;
            }
            around
        } else {
            leaf_box(node.leaf_range())
        };
        (nodes[index].low, nodes[index].high) = (around.min.to_array(), around.max.to_array());
    }
}

/// How much work a random line that meets the root can expect (MacDonald and Booth 1990): a step for every node and one for every
/// triangle of a leaf, weighed by the surfaces of their boxes.
pub(crate) fn cost(nodes: &[BvhNode]) -> f64 {
    let area = |node: &BvhNode| {
        let d = [0, 1, 2].map(|k| f64::from(node.high[k]) - f64::from(node.low[k]));
        d[0] * d[1] + d[1] * d[2] + d[2] * d[0]
    };
    let work = |node: &BvhNode| area(node) * (1 + node.leaf_range().len()) as f64;
    let root = nodes.first().map_or(0.0, area);
    if root > 0.0 { nodes.iter().map(work).sum::<f64>() / root } else { 0.0 }
}

fn box_of(node: &BvhNode) -> Aabb {
    Aabb::new(node.low.into(), node.high.into())
}

/// The box around points.
pub(crate) fn box_around<'a>(points: impl Iterator<Item = &'a [f32; 3]>) -> Aabb {
    points.fold(Aabb::empty(), |mut all, point| *all.extend(Vec3A::from(*point)))
}

fn box_bits(b: &Aabb) -> [u32; 6] {
    let (low, high) = (b.min.to_array(), b.max.to_array());
    [low[0], low[1], low[2], high[0], high[1], high[2]].map(f32::to_bits)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn soup(count: usize, spread: f32) -> Vec<[[f32; 3]; 3]> {
        let mut state = 1u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        (0..count)
            .map(|_| {
                let c = [next() * spread, next() * spread, next() * spread];
                [0; 3].map(|_: u32| c.map(|x| x + next() * 0.1))
            })
            .collect()
    }

    /// Every triangle stands in one leaf, inside the boxes of that leaf and of all its ancestors.
    fn check(triangles: &[[[f32; 3]; 3]], bvh: &Bvh) -> Result<(), String> {
        let mut seen = vec![0; triangles.len()];
        let mut open: Vec<usize> = Vec::new();
        for (index, node) in bvh.nodes.iter().enumerate() {
            open.retain(|&o| bvh.nodes[o].skip as usize > index);
            open.push(index);
            if node.skip as usize <= index || node.skip as usize > bvh.nodes.len() {
                return Err(format!("node {index} skips to {}", node.skip));
            }
            for slot in node.leaf_range() {
                let triangle = bvh.order[slot] as usize;
                seen[triangle] += 1;
                for v in triangles[triangle] {
                    for o in &open {
                        let b = bvh.nodes[*o];
                        if (0..3).any(|k| v[k] < b.low[k] || v[k] > b.high[k]) {
                            return Err(format!("triangle {triangle} leaves node {o}"));
                        }
                    }
                }
            }
        }
        if seen.iter().any(|&s| s != 1) {
            return Err("a triangle is missing or stands twice".into());
        }
        Ok(())
    }

    #[test]
    fn every_triangle_is_inside_all_its_boxes() {
        for count in [1, 2, 5, 1000] {
            let triangles = soup(count, 5.0);
            check(&triangles, &Bvh::build(&triangles)).unwrap();
        }
        let triangles = soup(300, 5.0);
        let mut spoilt = Bvh::build(&triangles);
        let leaf = spoilt.nodes.iter().position(|n| n.leaf != 0).unwrap();
        spoilt.nodes[leaf].high[1] -= 0.05;
        assert!(check(&triangles, &spoilt).is_err(), "a box that is too small is seen");
    }

    /// A tree over other triangles in the same places.
    fn refitted(bvh: &Bvh, triangles: &[[[f32; 3]; 3]]) -> Bvh {
        let mut moved = bvh.clone();
        let corners = |slots: Range<usize>| bvh.order[slots].iter().flat_map(|&old| &triangles[old as usize]);
        refit(&mut moved.nodes, |slots| box_around(corners(slots)));
        moved
    }

    #[test]
    fn a_refit_bounds_what_moved_and_tells_what_it_costs() {
        let triangles = soup(1000, 5.0);
        let built = Bvh::build(&triangles);
        assert_eq!(refitted(&built, &triangles), built, "nothing moved");
        let doubled: Vec<_> = triangles.iter().map(|t| t.map(|v| v.map(|x| 2.0 * x))).collect();
        assert_eq!(cost(&refitted(&built, &doubled).nodes), built.built_cost, "a scale changes no share");

        let elsewhere: Vec<_> = soup(1500, 5.0).into_iter().skip(500).collect();
        let moved = refitted(&built, &elsewhere);
        check(&elsewhere, &moved).unwrap();
        assert!(check(&elsewhere, &built).is_err(), "boxes of the first frame");
        let anew = cost(&Bvh::build(&elsewhere).nodes);
        assert!(cost(&moved.nodes) > 5.0 * anew, "neighbours went apart: {} against {anew}", cost(&moved.nodes));
        assert_eq!(cost(&[]), 0.0);
    }

    #[test]
    fn identical_centroids_and_empty_scenes_build() {
        let same = vec![soup(1, 1.0)[0]; 100_000];
        check(&same, &Bvh::build(&same)).unwrap();
        assert!(Bvh::build(&[]).nodes.is_empty());
    }
}
