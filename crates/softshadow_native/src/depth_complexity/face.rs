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

/// +1 where the receiver sees the face's canonical winding counter-clockwise on the light, −1 clockwise, 0 edge-on: such a face hides
/// nothing. Decided by the plane of the whole triangle, once for all its edges.
///
/// In the plane is whoever is no farther off it than the face's own corners are by rounding. So a receiver on a corner of a mesh sees
/// past the faces that meet there, as rays do: two of their edges have no image, and no side could be right for the third.
#[must_use]
pub fn side(view: &LightView, face: &Face) -> i32 {
    let height = Vec3::from(face.normal).dot(view.position - Vec3::from(face.point));
    i32::from(height > face.flatness) - i32::from(height < -face.flatness)
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
