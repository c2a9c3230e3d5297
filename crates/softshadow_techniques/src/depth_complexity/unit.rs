//! What of the occluders is folded: their silhouette edges, or their triangles one by one.

use serde::{Deserialize, Serialize};

use crate::parts::occluder_buffers::OccluderContents;

/// What is folded into the masks of a receiver. The masks are the same; areas answer over edges only.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OccluderUnit {
    /// Triangles where a scene is a soup of them, else edges.
    #[default]
    Auto,
    /// Silhouette edges: for bodies and sheets, whose silhouettes are few.
    Edges,
    /// Triangles: for foliage, where every border is an edge.
    Triangles,
}

/// What a light's occluders are folded as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Unit {
    Edges,
    Triangles,
}

/// Borders that a light's occluders have at most where edges are folded: those of a list of average length. A border is a silhouette
/// from everywhere, whatever its triangle faces.
const MOST_BORDERS: u32 = 1920;

impl OccluderUnit {
    pub(super) fn of(self, occluders: &OccluderContents) -> Unit {
        // More borders than faces: on the average a triangle shares fewer than two of its sides.
        let is_soup = occluders.border_count > MOST_BORDERS.max(occluders.face_count);
        match self {
            Self::Edges => Unit::Edges,
            Self::Triangles => Unit::Triangles,
            Self::Auto => {
                if is_soup {
                    Unit::Triangles
                } else {
                    Unit::Edges
                }
            }
        }
    }

    /// What a light's occluders are folded as, in a word; `none` where nothing can hide it.
    #[must_use]
    pub fn used(self, occluders: &OccluderContents) -> &'static str {
        match self.of(occluders) {
            _ if occluders.edge_count == 0 => "none",
            Unit::Edges => "edges",
            Unit::Triangles => "triangles",
        }
    }
}
