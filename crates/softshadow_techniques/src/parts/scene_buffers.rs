//! The scene on the device: corners and hierarchy of every sub-scene, uploaded once and kept.

use softshadow_plan::{Content, Plan, ResourceId};
use softshadow_scene::LocalScene;

use crate::parts::opacity::OpacityContents;
use crate::parts::shading;

/// A local scene and the bytes that go to the device.
#[derive(Debug, Clone)]
pub struct SceneContents {
    /// The scene in its local frame.
    pub local: LocalScene,
    /// Corners of each sub-scene.
    pub corners: Vec<Content>,
    /// Hierarchy of each sub-scene.
    pub nodes: Vec<Content>,
    /// Material index of each triangle.
    pub triangle_materials: Content,
    /// Materials.
    pub materials: Content,
    /// Opacities, where not all triangles are opaque.
    pub opacity: Option<OpacityContents>,
}

impl SceneContents {
    /// Lays a scene out as the kernels read it.
    #[must_use]
    pub fn new(local: LocalScene) -> Self {
        let corners = local.sub_scenes.iter().map(|s| Content::new(bytemuck::cast_slice(&s.corners))).collect();
        let nodes = local.sub_scenes.iter().map(|s| Content::new(bytemuck::cast_slice(&s.nodes))).collect();
        let triangle_materials = Content::new(bytemuck::cast_slice(&local.mesh_ids));
        let materials = shading::material_content(&local.materials);
        let opacity = OpacityContents::new(&local);
        Self { local, corners, nodes, triangle_materials, materials, opacity }
    }

    /// All contents, for an engine to upload by key.
    pub fn contents(&self) -> impl Iterator<Item = &Content> {
        let opacity = self.opacity.iter().flat_map(OpacityContents::contents);
        self.corners.iter().chain(&self.nodes).chain([&self.triangle_materials, &self.materials]).chain(opacity)
    }
}

/// The corners of every sub-scene, added where the plan does not have them yet.
pub fn append_corners(plan: &mut Plan, scene: &SceneContents) -> Vec<ResourceId> {
    append_once(plan, "corners", &scene.corners)
}

/// The hierarchy of every sub-scene, added where the plan does not have it yet.
pub fn append_nodes(plan: &mut Plan, scene: &SceneContents) -> Vec<ResourceId> {
    append_once(plan, "hierarchy", &scene.nodes)
}

fn append_once(plan: &mut Plan, name: &str, contents: &[Content]) -> Vec<ResourceId> {
    let mut add = |(index, content): (usize, &Content)| {
        let label = format!("{name} {index}");
        plan.find(&label).unwrap_or_else(|| plan.uploaded(label, content))
    };
    contents.iter().enumerate().map(&mut add).collect()
}
