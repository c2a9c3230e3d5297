//! What of the occluders is folded: their silhouette edges, or their triangles one by one.

use serde::{Deserialize, Serialize};
use softshadow_scene::SampleSpread;

use super::values::is_attenuated;
use super::{DepthComplexity, Evaluation};
use crate::parts::occluder_buffers::OccluderContents;
use crate::request::Request;

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

impl DepthComplexity {
    /// Whether triangles may be folded at all: opaque ones, for samples that all receivers share, in tiles' place.
    fn may_fold_triangles(&self, is_semi_opaque: bool) -> bool {
        self.evaluation == Evaluation::Tiled && self.spread == SampleSpread::Correlated && !is_semi_opaque
    }

    fn unit(&self, occluders: &OccluderContents, is_semi_opaque: bool) -> Unit {
        // More borders than faces: on the average a triangle shares fewer than two of its sides.
        let is_soup = occluders.border_count > MOST_BORDERS.max(occluders.face_count);
        let folds_triangles = match self.unit {
            OccluderUnit::Edges => false,
            OccluderUnit::Triangles => true,
            OccluderUnit::Auto => is_soup,
        };
        if folds_triangles && self.may_fold_triangles(is_semi_opaque) { Unit::Triangles } else { Unit::Edges }
    }

    /// What a light's occluders are folded as, in a word; `none` where nothing can hide it.
    #[must_use]
    pub fn unit_used(&self, occluders: &OccluderContents) -> &'static str {
        match self.unit(occluders, occluders.is_semi_opaque) {
            _ if occluders.edge_count == 0 => "none",
            Unit::Edges => "edges",
            Unit::Triangles => "triangles",
        }
    }
}

/// What is folded for a request.
pub(super) fn unit_of(request: &Request<'_>, settings: &DepthComplexity, occluders: &OccluderContents) -> Unit {
    settings.unit(occluders, is_attenuated(request))
}
