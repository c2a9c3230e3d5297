//! The next frame of a scene that moves: the order of its triangles and the shape of its hierarchies are kept, positions and boxes are
//! made anew.
//!
//! The frame, the rounding and the order of the corners are those of a scene made anew, so that every triangle has the same bits. Only
//! the order of the triangles is that of an earlier frame, and no result depends on it.

use crate::bvh::{box_around, cost, refit};
use crate::frame::LocalFrame;
use crate::local::{Corner, LocalScene, Row, extent, occluder_bounds, placed};
use crate::scene::Scene;

/// A hierarchy is built anew when its boxes have grown so that a ray can expect this many times the work that it had when it was built:
/// beyond half as much again, slower frames soon cost more than the hierarchy.
pub const STRETCH_LIMIT: f64 = 1.5;

/// Why a moved scene cannot keep what was made of an earlier frame. It is then made anew; the result is the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Rebuild {
    /// Another set of triangles casts shadows.
    #[error("triangles lost or gained their area")]
    Triangles,
    /// Another set of triangles shares edges.
    #[error("vertices that lay in one place parted, or others met")]
    Welding,
    /// [`STRETCH_LIMIT`] is exceeded.
    #[error("the boxes of a hierarchy grew into each other")]
    Stretched,
    /// The light's plane cuts triangles, or others are behind it.
    #[error("a light's plane cuts triangles, or leaves out others than before")]
    Boundary,
    /// The triangles of the scene have a new order, after a rebuild for another reason.
    #[error("the order of the triangles is new")]
    Order,
}

impl LocalScene {
    /// The same triangles in the places that `scene` gives them; it has to be of the same topology.
    ///
    /// # Errors
    /// [`Rebuild`] says why the scene has to be made anew.
    pub fn moved(&self, scene: &Scene) -> Result<Self, Rebuild> {
        let frame = LocalFrame::around(occluder_bounds(scene));
        let (rows, dropped) = placed(scene, &frame);
        let rows = self.in_order(rows, scene.triangle_count())?;
        let mut moved = Self { frame, extent: extent(&rows), dropped, ..self.clone() };
        moved.vertex_ids = rows.iter().map(|row| row.vertex_ids).collect();
        let mut rest = rows.as_slice();
        for sub_scene in &mut moved.sub_scenes {
            let (own, others) = rest.split_at(sub_scene.corners.len() / 3);
            rest = others;
            let corners = own.iter().zip(sub_scene.first_triangle..);
            sub_scene.corners =
                corners.flat_map(|(row, triangle)| row.corners.map(|position| Corner { position, triangle })).collect();
            refit(&mut sub_scene.nodes, |leaf| box_around(own[leaf].iter().flat_map(|row| &row.corners)));
            if cost(&sub_scene.nodes) > STRETCH_LIMIT * sub_scene.built_cost {
                return Err(Rebuild::Stretched);
            }
        }
        Ok(moved)
    }

    /// Rows in the order of this scene's triangles.
    fn in_order(&self, rows: Vec<Row>, triangles: usize) -> Result<Vec<Row>, Rebuild> {
        if rows.len() != self.triangle_count() {
            return Err(Rebuild::Triangles);
        }
        let mut row_of_caller = vec![None; triangles];
        for row in rows {
            row_of_caller[row.caller_id as usize] = Some(row);
        }
        let find = |id: &u32| row_of_caller.get(*id as usize).copied().flatten();
        self.caller_ids.iter().map(find).collect::<Option<_>>().ok_or(Rebuild::Triangles)
    }
}
