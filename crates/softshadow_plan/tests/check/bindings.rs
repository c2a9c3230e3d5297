//! Bindings and kernels.

use softshadow_plan::{
    ContentKey, Host, Origin, Over, Plan, PlanError, Shape, TextureFormat, VertexSource, Work, check,
};
use softshadow_shaders::ShaderError;

use crate::small_plan::{error, kernel, pass, raster_of, rebind, resource, small_plan};

fn binding(pass: &str, binding: &str, problem: &str) -> PlanError {
    PlanError::Binding { pass: pass.into(), binding: binding.into(), problem: problem.into() }
}

#[test]
fn a_binding_is_bound_exactly_once() {
    let missing = error(|plan| pass(plan, "choose").bindings.retain(|(name, _)| *name != "probe_image"));
    assert_eq!(missing, binding("choose", "probe_image", "must be bound exactly once"));
    let twice = error(|plan| {
        let again = pass(plan, "choose").bindings[0];
        pass(plan, "choose").bindings.push(again);
    });
    assert_eq!(twice, binding("choose", "sampling", "must be bound exactly once"));
    let foreign = error(|plan| {
        let decided = plan.find("decided").unwrap();
        pass(plan, "choose").bind("visibility", decided);
    });
    assert_eq!(foreign, binding("choose", "visibility", "the kernel uses no such binding"));
    let in_raster = error(|plan| pass(plan, "draw").bindings.clear());
    assert_eq!(in_raster, binding("draw", "camera_clip", "must be bound exactly once"));
}

#[test]
fn kinds_have_to_fit() {
    let texture = error(|plan| rebind(plan, "choose", "receivers", "triangle ids"));
    assert_eq!(texture, binding("choose", "receivers", "a buffer meets a texture: 'triangle ids'"));
    let buffer = error(|plan| rebind(plan, "place", "triangle_ids", "corners"));
    assert_eq!(buffer, binding("place", "triangle_ids", "a buffer meets a texture: 'corners'"));
    let depth = error(|plan| rebind(plan, "place", "triangle_ids", "depth"));
    assert_eq!(depth, binding("place", "triangle_ids", "the shader's texture type does not fit 'depth'"));
    for format in [TextureFormat::R32Float, TextureFormat::Rgba32Float] {
        let floats =
            error(|plan| resource(plan, "triangle ids").shape = Shape::Texture { format, size: [8, 4], layers: 1 });
        assert_eq!(floats, binding("place", "triangle_ids", "the shader's texture type does not fit 'triangle ids'"));
    }
    let format = TextureFormat::R32Uint;
    let layers =
        error(|plan| resource(plan, "triangle ids").shape = Shape::Texture { format, size: [8, 4], layers: 2 });
    assert_eq!(layers, binding("place", "triangle_ids", "the shader's texture type does not fit 'triangle ids'"));
    let target = error(|plan| raster_of(plan).colors[0].texture = plan_find("receivers"));
    assert_eq!(target, binding("draw", "receivers", "is drawn to but is a buffer"));
}

fn plan_find(label: &str) -> softshadow_plan::ResourceId {
    small_plan().find(label).unwrap()
}

#[test]
fn uniforms_have_the_exact_size() {
    for (given, fits) in [(7, false), (8, true), (9, false)] {
        let mut plan = small_plan();
        resource(&mut plan, "probe image").shape = Shape::Buffer { bytes: given };
        let expected = binding("choose", "probe_image", &format!("the uniform has 8 bytes, 'probe image' has {given}"));
        assert_eq!(check(&plan, &Host::default()), if fits { Ok(()) } else { Err(expected) });
    }
}

#[test]
fn uniforms_are_parameters() {
    for origin in [Origin::Transient, Origin::Persistent, Origin::External, Origin::Uploaded(ContentKey(7))] {
        let foreign = error(|plan| resource(plan, "probe image").origin = origin);
        assert_eq!(foreign, binding("choose", "probe_image", "a uniform is a parameter, 'probe image' is none"));
    }
    let in_raster = error(|plan| resource(plan, "camera clip").origin = Origin::Persistent);
    assert_eq!(in_raster, binding("draw", "camera_clip", "a uniform is a parameter, 'camera clip' is none"));
    // Only uniforms have to be: a kernel may also read a parameter as an array.
    let mut plan = small_plan();
    resource(&mut plan, "blocked").origin = Origin::Parameter;
    assert_eq!(check(&plan, &Host::default()), Ok(()));
}

/// A plan that looks up depth in an array of textures.
fn looks_up(format: TextureFormat, layers: u32) -> Plan {
    let mut plan = Plan::new("look up");
    let light = plan.parameter("light", 80);
    let views = plan.parameter("views", 400);
    let map = plan.resource("map", Shape::Texture { format, size: [16; 2], layers }, Origin::External);
    let receivers = plan.resource("receivers", Shape::Buffer { bytes: 32 }, Origin::External);
    let visibility = plan.buffer("visibility", 4);
    let over = Over::Items { count: 1, work_per_item: 1 };
    plan.compute("look up", "compares with the map", kernel("hard_shadow_map/look_up.wgsl", "look_up"), over)
        .bind("light", light)
        .bind("shadow_views", views)
        .bind("depth_map", map)
        .bind("receivers", receivers)
        .bind("visibility", visibility);
    plan
}

#[test]
fn depth_is_read_as_floats_and_integers_are_not() {
    let looks_up = |format, layers| check(&looks_up(format, layers), &Host::default());
    for format in [TextureFormat::Depth32Float, TextureFormat::R32Float, TextureFormat::Rgba32Float] {
        assert_eq!((looks_up(format, 1), looks_up(format, 6)), (Ok(()), Ok(())), "{format:?}");
    }
    let wrong = binding("look up", "depth_map", "the shader's texture type does not fit 'map'");
    assert_eq!(looks_up(TextureFormat::R32Uint, 6), Err(wrong));
}

#[test]
fn what_is_uploaded_is_never_written_and_nothing_is_empty() {
    for label in ["corners", "sampling"] {
        let error = error(|plan| rebind(plan, "choose", "decided", label));
        assert_eq!(error, binding("choose", "decided", &format!("'{label}' is uploaded and must not be written")));
    }
    let empty = error(|plan| resource(plan, "blocked").shape = Shape::Buffer { bytes: 0 });
    assert_eq!(empty, binding("choose", "blocked", "'blocked' is empty"));
}

#[test]
fn only_passes_over_items_have_slices() {
    let slice = error(|plan| {
        let blocked = plan.find("blocked").unwrap();
        let file = kernel("ray_traced/choose.wgsl", "choose");
        pass(plan, "choose").work = Work::Compute { kernel: file, over: Over::Indirect(blocked) };
    });
    assert_eq!(slice, binding("choose", "slice", "passes over items, and only they, have a kernel with this uniform"));
    let bound = error(|plan| {
        let probe_image = plan.find("probe image").unwrap();
        pass(plan, "choose").bind("slice", probe_image);
    });
    assert_eq!(bound, binding("choose", "slice", "the kernel uses no such binding"));
}

#[test]
fn unknown_kernels_are_named() {
    let unknown = |file: &'static str, entry: &'static str| {
        error(|plan| {
            pass(plan, "choose").work = Work::Compute { kernel: kernel(file, entry), over: crate::small_plan::ITEMS };
        })
    };
    let shader = |pass: &str, file: &str| PlanError::Shader {
        pass: pass.into(),
        error: ShaderError::UnknownFile { file: file.into() },
    };
    assert_eq!(unknown("nowhere.wgsl", "choose"), shader("choose", "nowhere.wgsl"));
    assert_eq!(unknown("ray_traced/choose.wgsl", "chose"), shader("choose", "ray_traced/choose.wgsl:chose"));
    let draw = "receivers/draw_triangle_ids.wgsl";
    assert_eq!(unknown(draw, "draw"), shader("choose", &format!("{draw}:draw")), "a vertex shader computes nothing");
    let no_fragment = error(|plan| raster_of(plan).kernel.fragment = Some("draw"));
    assert_eq!(no_fragment, shader("draw", &format!("{draw}:draw")), "a vertex shader shades no fragment");
}

#[test]
fn labels_stand_once() {
    let twice = PlanError::DuplicateLabel { label: "decided".into() };
    assert_eq!(error(|plan| resource(plan, "kept").label = "decided".into()), twice);
    let twice = PlanError::DuplicateLabel { label: "place".into() };
    assert_eq!(error(|plan| pass(plan, "choose").label = "place".into()), twice);
}

#[test]
fn messages_name_the_pass_and_the_binding() {
    let words = error(|plan| rebind(plan, "place", "corners", "depth")).to_string();
    assert_eq!(words, "pass 'place', binding 'corners': a buffer meets a texture: 'depth'");
    let unread = error(|plan| {
        resource(plan, "corners").origin = Origin::Transient;
        raster_of(plan).vertices = VertexSource::Generated(softshadow_plan::Count::Fixed(3));
    });
    assert_eq!(unread.to_string(), "pass 'place' reads 'corners' before anything is written to it");
}
