//! The plan that the tests spoil: a camera's receivers, and the choice of those that need more samples.

use softshadow_plan::{
    Blend, ColorTarget, Compare, Content, DepthTarget, Host, Kernel, Origin, Over, Pass, Plan, PlanError, Raster,
    RasterKernel, ResourceId, TextureFormat, VertexSource, Work, check,
};

/// Pixels of the plan's image.
pub(crate) const SIZE: [u32; 2] = [8, 4];
pub(crate) const PIXELS: u64 = 32;

pub(crate) fn small_plan() -> Plan {
    let mut plan = Plan::new("small");
    let corners = plan.uploaded("corners", &Content::new(&[7; 48]));
    let ids = plan.texture("triangle ids", TextureFormat::R32Uint, SIZE, Origin::Transient);
    let depth = plan.texture("depth", TextureFormat::Depth32Float, SIZE, Origin::Transient);
    let clip = plan.parameter("camera clip", 64);
    let rays = plan.parameter("camera rays", 64);
    let sub_scene = plan.parameter("sub-scene", 8);
    let sampling = plan.parameter("sampling", 32);
    let probe_image = plan.parameter("probe image", 8);
    let receivers = plan.buffer("receivers", PIXELS * 32);
    let blocked = plan.persistent("blocked", PIXELS * 4);
    let decided = plan.buffer("decided", PIXELS * 4);
    let kept = plan.buffer("kept", PIXELS * 4);
    plan.raster("draw", "finds the triangle that each pixel sees", raster(corners, ids, depth))
        .bind("camera_clip", clip);
    plan.compute("place", "puts receivers on triangles", kernel("receivers/place_on_triangles.wgsl", "place"), ITEMS)
        .bind("camera_rays", rays)
        .bind("sub_scene", sub_scene)
        .bind("triangle_ids", ids)
        .bind("corners", corners)
        .bind("receivers", receivers);
    plan.clear("reset", "nothing is decided yet", decided);
    plan.compute("choose", "finds who needs more samples", kernel("ray_traced/choose.wgsl", "choose"), ITEMS)
        .bind("sampling", sampling)
        .bind("probe_image", probe_image)
        .bind("receivers", receivers)
        .bind("blocked", blocked)
        .bind("decided", decided);
    plan.copy("keep", "the caller reads a copy", [decided, kept], PIXELS * 4);
    plan.outputs.push(kept);
    plan
}

pub(crate) const ITEMS: Over = Over::Items { count: PIXELS as u32, work_per_item: 1 };

pub(crate) fn kernel(file: &'static str, entry: &'static str) -> Kernel {
    Kernel { file, entry }
}

fn raster(corners: ResourceId, ids: ResourceId, depth: ResourceId) -> Raster {
    Raster {
        kernel: RasterKernel { file: "receivers/draw_triangle_ids.wgsl", vertex: "draw", fragment: Some("write_id") },
        vertices: VertexSource::Corners { buffer: corners, count: 3 },
        colors: vec![ColorTarget { texture: ids, layer: 0, clear: Some(0.0), blend: Blend::Replace }],
        depth: Some(DepthTarget { texture: depth, layer: 0, clear: Some(0.0), compare: Compare::Greater }),
    }
}

/// The error of the small plan after `spoil`, on the default host.
pub(crate) fn error(spoil: impl FnOnce(&mut Plan)) -> PlanError {
    let mut plan = small_plan();
    spoil(&mut plan);
    check(&plan, &Host::default()).expect_err("the spoilt plan passed")
}

pub(crate) fn pass<'a>(plan: &'a mut Plan, label: &str) -> &'a mut Pass {
    plan.passes.iter_mut().find(|p| p.label == label).unwrap()
}

pub(crate) fn raster_of(plan: &mut Plan) -> &mut Raster {
    let Work::Raster(raster) = &mut pass(plan, "draw").work else { panic!("'draw' is a raster pass") };
    raster
}

/// Binds `name` of a pass to the resource with this label instead.
pub(crate) fn rebind(plan: &mut Plan, label: &str, name: &str, to: &str) {
    let to = plan.find(to).unwrap();
    pass(plan, label).bindings.iter_mut().find(|(n, _)| *n == name).unwrap().1 = to;
}

pub(crate) fn resource<'a>(plan: &'a mut Plan, label: &str) -> &'a mut softshadow_plan::Resource {
    let at = plan.find(label).unwrap().index();
    &mut plan.resources[at]
}

#[test]
fn the_untouched_plan_passes() {
    check(&small_plan(), &Host::default()).unwrap();
}
