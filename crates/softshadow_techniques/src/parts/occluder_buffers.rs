//! What hides one light, as the kernels read it: faces, edges, and a hierarchy over the faces.

use softshadow_plan::Content;
use softshadow_scene::occluders::{
    BoundaryEffect, Face, LightBoundary, NO_SIDE, OPAQUE, OccluderEdge, Occluders, TouchingTriangle,
};
use softshadow_scene::{BvhNode, Corner, Light, LightFrame, LocalScene, Rebuild, SceneError};

/// `Face` of `occluders.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct FaceRecord {
    normal: [f32; 3],
    triangle: u32,
    point: [f32; 3],
    flatness: f32,
    sides: [u32; 4],
}

/// `OccluderEdge` of `occluders.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct EdgeRecord {
    low: [f32; 3],
    first_incidence: u32,
    high: [f32; 3],
    incidence_count: u32,
}

/// `IncidentFace` of `occluders.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct IncidentFace {
    normal: [f32; 3],
    reference: u32,
    point: [f32; 3],
    flatness: f32,
}

/// Set in the count of an edge's faces where these differ in opacity.
pub const UNEQUAL_FACES: u32 = 1 << 31;

/// Triangles that touch a ball of light.
#[derive(Debug, Clone)]
pub struct TouchingContents {
    /// Three corners each.
    pub corners: Content,
    /// How many there are.
    pub count: u32,
}

impl TouchingContents {
    fn new(triangles: &[TouchingTriangle]) -> Option<Self> {
        let corners = |t: &TouchingTriangle| t.corners.map(|position| Corner { position, triangle: t.triangle });
        let corners: Vec<Corner> = triangles.iter().flat_map(corners).collect();
        let count = triangles.len() as u32;
        (count > 0).then(|| Self { corners: Content::new(bytemuck::cast_slice(&corners)), count })
    }
}

/// Everything that can hide one light, and the bytes that go to the device.
#[derive(Debug, Clone)]
pub struct OccluderContents {
    /// The light's boundary that it was cut with; lights with the same share it.
    pub boundary: LightBoundary,
    /// Faces.
    pub faces: Content,
    /// Four corners of each, in the order of its sides; a triangle comes back to its first.
    pub face_corners: Content,
    /// Their hierarchy.
    pub face_tree: Content,
    /// Edges.
    pub edges: Content,
    /// Faces at the edges, each edge's together.
    pub incident_faces: Content,
    /// Triangles that touch a ball of light, where there are any: no edge says where their shadows end.
    pub touching: Option<TouchingContents>,
    /// How many edges there are.
    pub edge_count: u32,
    /// Whether some faces let light through.
    pub is_semi_opaque: bool,
    /// How many of them have one face only.
    pub border_count: u32,
    /// How many faces there are.
    pub face_count: u32,
    /// Triangles that the light's plane cut.
    pub cut_triangles: usize,
    /// Triangles behind the light.
    pub triangles_behind: usize,
    /// What the bytes were made of, for the next frame of a scene that moves.
    occluders: Occluders,
}

/// Where a light makes geometry stop; nowhere when all of it is in front, so that lights share what is made of a scene.
#[must_use]
pub fn boundary_of(local: &LocalScene, light: &Light) -> LightBoundary {
    let boundary = LightFrame::new(light, &local.frame).boundary;
    if boundary.effect(local).is_none() { LightBoundary::None } else { boundary }
}

impl OccluderContents {
    /// Cuts a scene at a light's boundary and lays it out.
    ///
    /// # Errors
    /// [`SceneError::TooLarge`] for too many triangles, and [`SceneError::Invalid`] where triangles touch a ball of light and something is
    /// semi-opaque.
    pub fn new(local: &LocalScene, boundary: LightBoundary) -> Result<Self, SceneError> {
        let triangles: Vec<[[f32; 3]; 3]> = local.triangles().collect();
        let occluders = Occluders::new(&triangles, |triangle| local.opacity(triangle), &boundary)?;
        let is_opaque = occluders.faces.iter().all(|face| face.attenuation == OPAQUE)
            && occluders.touching.iter().all(|triangle| triangle.attenuation == OPAQUE);
        if !occluders.touching.is_empty() && !is_opaque {
            let count = occluders.touching.len();
            let reason =
                format!("{count} triangles touch it, and some are semi-opaque; move them apart, or trace rays");
            return Err(SceneError::Invalid { what: "sphere light".into(), reason });
        }
        Ok(Self::lay_out(local, occluders, boundary))
    }

    /// What becomes of these contents of `from` in `to`, a later frame of it, for a light with this boundary and effect on `to`.
    ///
    /// # Errors
    /// [`Rebuild`] says why they have to be made anew.
    pub fn moved(
        &self,
        from: &LocalScene,
        to: &LocalScene,
        boundary: LightBoundary,
        effect: &BoundaryEffect,
    ) -> Result<Self, Rebuild> {
        Ok(Self::lay_out(to, self.occluders.moved(from, to, effect)?, boundary))
    }

    fn lay_out(local: &LocalScene, occluders: Occluders, boundary: LightBoundary) -> Self {
        let face = |f: &Face| FaceRecord {
            normal: f.normal,
            triangle: f.triangle,
            point: f.point,
            flatness: f.flatness,
            sides: f.sides,
        };
        let edge = |e: &OccluderEdge| EdgeRecord {
            low: e.low,
            first_incidence: e.first_incidence,
            high: e.high,
            incidence_count: e.incidence_count | if is_unequal(local, &occluders, e) { UNEQUAL_FACES } else { 0 },
        };
        let incident = |i: &u32| {
            let f = &occluders.faces[(i >> 1) as usize];
            IncidentFace { normal: f.normal, reference: f.triangle << 1 | i & 1, point: f.point, flatness: f.flatness }
        };
        let mut faces: Vec<FaceRecord> = occluders.faces.iter().map(face).collect();
        let mut face_corners: Vec<[[f32; 3]; 4]> =
            occluders.faces.iter().map(|f| corners(f, &occluders.edges)).collect();
        let mut edges: Vec<EdgeRecord> = occluders.edges.iter().map(edge).collect();
        let mut incident_faces: Vec<IncidentFace> = occluders.incidences.iter().map(incident).collect();
        let mut nodes = occluders.face_tree.nodes.clone();
        // A binding must not be empty: a face without sides covers nothing, and a box inside out is never met.
        if faces.is_empty() {
            faces.push(FaceRecord { sides: [NO_SIDE; 4], ..bytemuck::Zeroable::zeroed() });
            face_corners.push([[0.0; 3]; 4]);
            edges.push(bytemuck::Zeroable::zeroed());
            incident_faces.push(bytemuck::Zeroable::zeroed());
            nodes.push(BvhNode { low: [1e30; 3], skip: 1, high: [-1e30; 3], leaf: 0 });
        }
        Self {
            boundary,
            faces: Content::new(bytemuck::cast_slice(&faces)),
            face_corners: Content::new(bytemuck::cast_slice(&face_corners)),
            face_tree: Content::new(bytemuck::cast_slice(&nodes)),
            edges: Content::new(bytemuck::cast_slice(&edges)),
            incident_faces: Content::new(bytemuck::cast_slice(&incident_faces)),
            touching: TouchingContents::new(&occluders.touching),
            edge_count: occluders.edges.len() as u32,
            is_semi_opaque: occluders.faces.iter().any(|face| face.attenuation != OPAQUE),
            border_count: occluders.edges.iter().filter(|e| e.incidence_count == 1).count() as u32,
            face_count: occluders.faces.len() as u32,
            cut_triangles: occluders.cut,
            triangles_behind: occluders.behind,
            occluders,
        }
    }

    /// All contents, for an engine to upload by key.
    pub fn contents(&self) -> impl Iterator<Item = &Content> {
        [&self.faces, &self.face_corners, &self.face_tree, &self.edges, &self.incident_faces]
            .into_iter()
            .chain(self.touching.as_ref().map(|touching| &touching.corners))
    }
}

/// Whether the faces of an edge differ in opacity: what one adds the other does not take away, whichever sides they are on.
fn is_unequal(local: &LocalScene, occluders: &Occluders, edge: &OccluderEdge) -> bool {
    let first = edge.first_incidence as usize;
    let incidences = &occluders.incidences[first..first + edge.incidence_count as usize];
    let opacity = |incidence: &u32| local.opacity(occluders.faces[(incidence >> 1) as usize].triangle as usize);
    incidences.windows(2).any(|pair| opacity(&pair[0]) != opacity(&pair[1]))
}

/// Where a face's sides begin.
fn corners(face: &Face, edges: &[OccluderEdge]) -> [[f32; 3]; 4] {
    let start = |side: u32| {
        let edge = &edges[(side >> 1) as usize];
        if side & 1 == 0 { edge.low } else { edge.high }
    };
    face.sides.map(|side| start(if side == NO_SIDE { face.sides[0] } else { side }))
}
