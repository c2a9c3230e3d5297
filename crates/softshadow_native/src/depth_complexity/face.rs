//! On which side of a face the receiver is, and what that makes of an edge.

use glam::Vec3;
use softshadow_scene::occluders::{Face, OPAQUE, OccluderEdge, Occluders};

use super::view::{LightView, Receiver};

/// How many layers, opaque and in attenuation units: of a point of the light, or by how many it changes at an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Layers {
    /// Opaque faces.
    pub opaque: i32,
    /// Attenuation units of semi-opaque faces. They are integers so that what is added on one side of a face is taken away on the
    /// other, to the last bit.
    pub attenuation: i64,
}

impl Layers {
    /// None.
    pub const NONE: Self = Self { opaque: 0, attenuation: 0 };

    /// `times` crossings of a face.
    #[must_use]
    pub fn of(face: &Face, times: i32) -> Self {
        match face.attenuation {
            OPAQUE => Self { opaque: times, attenuation: 0 },
            units => Self { opaque: 0, attenuation: i64::from(units) * i64::from(times) },
        }
    }

    /// Both.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self { opaque: self.opaque + other.opaque, attenuation: self.attenuation + other.attenuation }
    }

    /// The opposite.
    #[must_use]
    pub fn negated(self) -> Self {
        Self { opaque: -self.opaque, attenuation: -self.attenuation }
    }
}

/// Roundings of a height over a face's plane: the normal, the way, a product, two sums; in units of 2^-24 of the sum of the absolute
/// products.
const HEIGHT_ROUNDINGS: f32 = 5.0 * 5.960_464_5e-8;

/// +1 where the receiver sees the face's canonical winding counter-clockwise on the light, −1 clockwise, 0 edge-on: such a face hides
/// nothing. Decided by the plane of the whole triangle, once for all its edges.
///
/// Edge-on is whatever rounding cannot tell from it. So a receiver on a corner or an edge of a mesh, where the faces around it have no
/// image at all, sees past these faces as rays do, instead of taking a side that no edge confirms.
#[must_use]
pub fn side(view: &LightView, face: &Face) -> i32 {
    let normal = Vec3::from(face.normal);
    let way = view.position - Vec3::from(face.point);
    let height = normal.dot(way);
    let noise = HEIGHT_ROUNDINGS * normal.abs().dot(way.abs());
    i32::from(height > noise) - i32::from(height < -noise)
}

/// `D` left of an edge minus `D` right of it.
#[must_use]
pub fn weight(view: &LightView, occluders: &Occluders, edge: &OccluderEdge, receiver: &Receiver) -> Layers {
    let first = edge.first_incidence as usize;
    let incidences = &occluders.incidences[first..first + edge.incidence_count as usize];
    incidences.iter().fold(Layers::NONE, |sum, incidence| {
        let face = &occluders.faces[(incidence >> 1) as usize];
        if Some(face.triangle) == receiver.triangle {
            return sum;
        }
        let left = side(view, face) * if incidence & 1 == 0 { 1 } else { -1 };
        sum.plus(Layers::of(face, left))
    })
}
