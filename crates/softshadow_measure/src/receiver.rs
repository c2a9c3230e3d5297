//! Who asks (receivers), about what (targets on the light), past what (triangles).

use crate::MeasureError;
use crate::error::require_finite;
use crate::vector::{Vec3, sub};

/// Three corners in world space; two-sided, in any winding.
pub type Triangle = [[f64; 3]; 3];

/// A point that may or may not see the light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Receiver {
    /// World position.
    pub origin: [f64; 3],
    /// Surface normal, any length. Light below its horizon counts as hidden; `None` means no horizon.
    pub normal: Option<[f64; 3]>,
    /// Index of the triangle that the receiver lies on, which never shadows it.
    pub excluded_triangle: Option<usize>,
}

impl Receiver {
    /// A free point: no horizon, no excluded triangle.
    #[must_use]
    pub fn at(origin: [f64; 3]) -> Self {
        Self { origin, normal: None, excluded_triangle: None }
    }

    pub(crate) fn check(&self, index: usize) -> Result<(), MeasureError> {
        require_finite("receiver", index, &self.origin)?;
        require_finite("receiver normal", index, &self.normal.unwrap_or_default())
    }
}

/// One light sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Target {
    /// A point of the light, in world space: only what lies strictly between it and the receiver blocks.
    Point([f64; 3]),
    /// A direction towards a light at infinity, any length: everything ahead of the receiver blocks.
    Direction([f64; 3]),
}

impl Target {
    /// The way from `origin` to it, and whether it is at infinity.
    pub(crate) fn seen_from(&self, origin: Vec3) -> (Vec3, bool) {
        match self {
            Self::Point(point) => (sub(*point, origin), false),
            Self::Direction(direction) => (*direction, true),
        }
    }

    pub(crate) fn check(&self, index: usize) -> Result<(), MeasureError> {
        match self {
            Self::Point(point) => require_finite("target point", index, point),
            Self::Direction(direction) => require_finite("target direction", index, direction),
        }
    }
}

pub(crate) fn check_triangles(triangles: &[Triangle]) -> Result<(), MeasureError> {
    triangles
        .iter()
        .enumerate()
        .try_for_each(|(index, triangle)| require_finite("triangle", index, triangle.as_flattened()))
}
