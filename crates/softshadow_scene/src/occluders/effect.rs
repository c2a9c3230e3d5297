//! What a light's boundary does to a scene. Lights that do the same can share what is made of it, wherever they are.

use glam::DVec3;

use super::LightBoundary;
use super::cut::{Front, TOUCH_MARGIN, in_front, touches};
use crate::bvh::BvhNode;
use crate::local::{LocalScene, SubScene};

/// Boxes that clear the boundary by less than this share of their coordinates are looked into: far above the few float64 roundings of a
/// height or a distance, so that what is skipped is what every triangle in the box would have said.
const BOX_MARGIN: f64 = 1e-12;

/// What a boundary leaves of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundaryEffect {
    /// The boundary, where it cuts or touches a triangle: what is left then depends on where exactly it lies. Else `None`.
    pub boundary: LightBoundary,
    /// Triangles wholly behind, where the boundary cuts none.
    pub behind: Vec<u32>,
}

/// What a boundary does to one triangle or to all in a box.
enum Found {
    Nothing,
    Behind,
    Meets,
}

impl BoundaryEffect {
    /// Nothing is cut, touched or left out.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.boundary == LightBoundary::None && self.behind.is_empty()
    }
}

impl LightBoundary {
    /// What it does to a scene, by a walk through the hierarchy: a light in front of everything costs one look at its root.
    #[must_use]
    pub fn effect(&self, local: &LocalScene) -> BoundaryEffect {
        let mut behind = Vec::new();
        if *self != Self::None {
            for sub_scene in &local.sub_scenes {
                if !self.walk(sub_scene, &mut behind) {
                    return BoundaryEffect { boundary: *self, behind: Vec::new() };
                }
            }
        }
        behind.sort_unstable();
        BoundaryEffect { boundary: Self::None, behind }
    }

    /// Adds the triangles behind; false once one is cut or touched.
    fn walk(&self, sub_scene: &SubScene, behind: &mut Vec<u32>) -> bool {
        let mut index = 0;
        while let Some(node) = sub_scene.nodes.get(index) {
            if self.clears(node) {
                index = node.skip as usize;
                continue;
            }
            for slot in node.leaf_range() {
                let corners = [0, 1, 2].map(|k| sub_scene.corners[3 * slot + k].position);
                match self.meets(&corners) {
                    Found::Nothing => (),
                    Found::Behind => behind.push(sub_scene.first_triangle + slot as u32),
                    Found::Meets => return false,
                }
            }
            index += 1;
        }
        true
    }

    fn meets(&self, corners: &[[f32; 3]; 3]) -> Found {
        match *self {
            Self::None => Found::Nothing,
            Self::Plane { point, normal } => match in_front(corners, point.into(), normal.into()) {
                Front::Behind => Found::Behind,
                Front::Whole => Found::Nothing,
                Front::Part(_) => Found::Meets,
            },
            Self::Ball { center, radius } if touches(corners, center.into(), radius) => Found::Meets,
            Self::Ball { .. } => Found::Nothing,
        }
    }

    /// Whether everything in a box is in front of the plane, or off the ball.
    fn clears(&self, node: &BvhNode) -> bool {
        let [low, high] = [node.low, node.high].map(|c| DVec3::from(c.map(f64::from)));
        let largest = low.abs().max(high.abs());
        match *self {
            Self::None => true,
            Self::Plane { point, normal } => {
                let (point, normal) = (DVec3::from(point), DVec3::from(normal));
                let nearest = (normal * (low - point)).min(normal * (high - point));
                nearest.element_sum() > BOX_MARGIN * normal.abs().dot(largest + point.abs())
            }
            Self::Ball { center, radius } => {
                let center = DVec3::from(center);
                let slack = BOX_MARGIN * (largest + center.abs()).element_sum();
                center.distance(center.clamp(low, high)) > radius * (1.0 + TOUCH_MARGIN) + slack
            }
        }
    }
}
