//! What hides one light, prepared for silhouette edges: faces, their edges, and a hierarchy over each.
//!
//! Everything a silhouette needs is a sign, and every sign is decided once: a face has one plane, an edge one direction (from the
//! corner that comes first by position to the other), and all who share them read the same numbers. So meshes may be open,
//! non-manifold, wound at random, doubled or unwelded.

mod build;
mod cut;
mod effect;
mod moved;
#[cfg(test)]
mod tests;

pub use effect::BoundaryEffect;

use crate::bvh::Bvh;

pub use build::attenuation;

/// Attenuation of a face that lets nothing through.
pub const OPAQUE: u32 = u32::MAX;

/// Attenuation units in one halving of the light: `2^-(units / 4096)` passes.
pub const UNITS_PER_HALVING: f64 = 4096.0;

/// An end of [`Face::sides`] for a face with three sides.
pub const NO_SIDE: u32 = u32::MAX;

/// Where geometry stops to be in front of the light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightBoundary {
    /// Nowhere: a light at infinity.
    None,
    /// A plane, in local float64; `normal` is the direction of emission.
    Plane {
        /// A point of the plane.
        point: [f64; 3],
        /// Unit normal towards the scene.
        normal: [f64; 3],
    },
    /// A ball, in local float64.
    Ball {
        /// Its centre.
        center: [f64; 3],
        /// Its radius.
        radius: f64,
    },
}

/// A triangle, or the part of one in front of the light: a convex polygon of three or four corners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Face {
    /// Unit normal of the whole triangle, by its corners in canonical order. One sign of `normal·(p − point)` serves all sides.
    pub normal: [f32; 3],
    /// Index of the triangle this is, or is a part of.
    pub triangle: u32,
    /// First corner of the whole triangle.
    pub point: [f32; 3],
    /// [`OPAQUE`], or the units of one crossing.
    pub attenuation: u32,
    /// How far rounding puts the whole triangle's own corners off its plane: the largest `|normal·(corner − point)|` in float32. What is
    /// no higher over the plane than that is in it.
    pub flatness: f32,
    /// Sides in the order of the canonical winding: `edge << 1 | backward`; [`NO_SIDE`] after the last. Backward: the winding runs
    /// from the edge's high corner to its low one.
    pub sides: [u32; 4],
}

/// An edge with the faces that share it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OccluderEdge {
    /// The corner that comes first by position.
    pub low: [f32; 3],
    /// First of its incidences.
    pub first_incidence: u32,
    /// The other corner.
    pub high: [f32; 3],
    /// How many there are.
    pub incidence_count: u32,
}

/// A face at an edge: `face << 1 | backward`, backward as in [`Face::sides`].
pub type Incidence = u32;

/// Everything that can hide one light.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Occluders {
    /// Faces in the order of the leaves of their hierarchy.
    pub faces: Vec<Face>,
    /// Hierarchy over the faces. Its leaves count in `faces`; its `order` is empty.
    pub face_tree: Bvh,
    /// Edges in the order of the leaves of their hierarchy.
    pub edges: Vec<OccluderEdge>,
    /// Hierarchy over the edges. Its leaves count in `edges`; its `order` is empty.
    pub edge_tree: Bvh,
    /// Incidences of all edges, each edge's together, in the order of the edges and ascending.
    pub incidences: Vec<Incidence>,
    /// Triangles that touch a ball of light, as they are: where they dip into it no edge says so.
    pub touching: Vec<TouchingTriangle>,
    /// How many triangles the light's plane cut.
    pub cut: usize,
    /// How many triangles lie wholly behind it and were left out.
    pub behind: usize,
}

/// A triangle that touches a ball of light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TouchingTriangle {
    /// Corners in canonical order.
    pub corners: [[f32; 3]; 3],
    /// Index of the triangle.
    pub triangle: u32,
    /// As in [`Face::attenuation`].
    pub attenuation: u32,
}
