//! What can be cleared, copied, drawn to and handed out, and what a texture has to be.

use softshadow_plan::{
    ContentKey, DepthTarget, Host, Origin, Plan, PlanError, ResourceId, Shape, TextureFormat, Work, check,
};

use crate::small_plan::{PIXELS, error, pass, raster_of, resource, small_plan};

const TEXTURE: &str = "is a texture where a buffer is needed";
const PARAMETER: &str = "is a parameter and must not be written or read back";
const UPLOADED: &str = "is uploaded and must not be written or read back";
const COPIES: &str = "copies go from one buffer to another, in multiples of four bytes";
const FORMATS: &str = "depth goes to a depth texture, colour to another";

fn binding(pass: &str, binding: &str, problem: &str) -> PlanError {
    PlanError::Binding { pass: pass.into(), binding: binding.into(), problem: problem.into() }
}

fn find(label: &str) -> ResourceId {
    small_plan().find(label).unwrap()
}

/// What the checks say after a change that may be a good one.
fn after(change: impl FnOnce(&mut Plan)) -> Result<(), PlanError> {
    let mut plan = small_plan();
    change(&mut plan);
    check(&plan, &Host::default())
}

#[test]
fn only_buffers_that_passes_write_are_cleared() {
    let clear = |label: &str| after(|plan| pass(plan, "reset").work = Work::Clear { target: find(label) });
    for label in ["decided", "blocked", "kept"] {
        assert_eq!(clear(label), Ok(()), "{label}");
    }
    for (label, problem) in [("triangle ids", TEXTURE), ("sampling", PARAMETER), ("corners", UPLOADED)] {
        assert_eq!(clear(label), Err(binding("reset", label, problem)));
    }
}

#[test]
fn copies_go_between_two_buffers_in_whole_words() {
    let copy = |source: &str, target: &str, bytes: u64| {
        after(|plan| {
            plan.outputs = vec![find("decided")];
            pass(plan, "keep").work = Work::Copy { source: find(source), target: find(target), bytes };
        })
    };
    for (source, target, bytes) in [("decided", "kept", 128), ("decided", "blocked", 4), ("receivers", "kept", 0)] {
        assert_eq!(copy(source, target, bytes), Ok(()), "{source} to {target}");
    }
    for (source, target, named, problem) in [
        ("triangle ids", "kept", "triangle ids", TEXTURE),
        ("sampling", "kept", "sampling", PARAMETER),
        ("corners", "kept", "corners", UPLOADED),
        ("decided", "triangle ids", "triangle ids", TEXTURE),
        ("decided", "sampling", "sampling", PARAMETER),
        ("decided", "corners", "corners", UPLOADED),
        ("decided", "decided", "copy", COPIES),
    ] {
        assert_eq!(copy(source, target, 8), Err(binding("keep", named, problem)), "{source} to {target}");
    }
    for bytes in [1, 2, 3, 126, 127] {
        assert_eq!(copy("decided", "kept", bytes), Err(binding("keep", "copy", COPIES)), "{bytes} bytes");
    }
}

#[test]
fn only_buffers_of_the_device_are_handed_out() {
    let output = |label: &str| after(|plan| plan.outputs.push(find(label)));
    let decision = |label: &str| after(|plan| plan.decision = Some(find(label)));
    for label in ["kept", "blocked", "receivers"] {
        assert_eq!((output(label), decision(label)), (Ok(()), Ok(())), "{label}");
    }
    for (label, problem) in
        [("triangle ids", TEXTURE), ("depth", TEXTURE), ("sampling", PARAMETER), ("corners", UPLOADED)]
    {
        let refused = Err(binding("output", label, problem));
        assert_eq!((output(label), decision(label)), (refused.clone(), refused));
    }
}

#[test]
fn depth_and_colour_go_to_textures_of_their_own() {
    let other = |format| move |plan: &mut Plan| plan.texture("other", format, [8, 4], Origin::Transient);
    let color = |format| {
        after(|plan| {
            let texture = other(format)(plan);
            let again = softshadow_plan::ColorTarget { texture, ..raster_of(plan).colors[0] };
            raster_of(plan).colors.push(again);
        })
    };
    let depth = |format| {
        after(|plan| {
            let texture = other(format)(plan);
            let target = raster_of(plan).depth.unwrap();
            raster_of(plan).depth = Some(DepthTarget { texture, ..target });
        })
    };
    let wrong = Err(binding("draw", "other", FORMATS));
    for format in [TextureFormat::R32Uint, TextureFormat::R32Float, TextureFormat::Rgba32Float] {
        assert_eq!((color(format), depth(format)), (Ok(()), wrong.clone()), "{format:?}");
    }
    let format = TextureFormat::Depth32Float;
    assert_eq!((color(format), depth(format)), (wrong, Ok(())));
    let buffer = error(|plan| raster_of(plan).depth.as_mut().unwrap().texture = find("receivers"));
    assert_eq!(buffer, binding("draw", "receivers", "is drawn to but is a buffer"));
}

#[test]
fn textures_have_texels_that_a_pass_draws() {
    let shaped = |size: [u32; 2], layers: u32| {
        after(|plan| {
            resource(plan, "depth").shape = Shape::Texture { format: TextureFormat::Depth32Float, size, layers };
        })
    };
    assert_eq!((shaped([1, 1], 1), shaped([8, 4], 2)), (Ok(()), Ok(())));
    for (size, layers) in [([0, 4], 1), ([8, 0], 1), ([0, 0], 1), ([8, 4], 0)] {
        assert_eq!(shaped(size, layers), Err(binding("resources", "depth", "has no texel")), "{size:?} × {layers}");
    }
    let from = |origin| after(|plan| resource(plan, "depth").origin = origin);
    for origin in [Origin::Transient, Origin::Persistent, Origin::External] {
        assert_eq!(from(origin), Ok(()), "{origin:?}");
    }
    for origin in [Origin::Uploaded(ContentKey(7)), Origin::Parameter] {
        assert_eq!(from(origin), Err(binding("resources", "depth", "only buffers are uploaded")), "{origin:?}");
    }
}

#[test]
fn a_decision_may_also_be_an_output() {
    assert_eq!(after(|plan| plan.decision = plan.outputs.first().copied()), Ok(()));
    let unwritten = error(|plan| {
        let late = plan.buffer("late", PIXELS * 4);
        plan.outputs.push(late);
        plan.decision = Some(late);
    });
    assert_eq!(unwritten, PlanError::ReadBeforeWrite { pass: "output".into(), resource: "late".into() });
}

#[test]
fn counts_and_corners_fit_their_buffers() {
    let indirect = |bytes: u64| {
        after(|plan| {
            let counts = plan.persistent("counts", bytes);
            raster_of(plan).vertices =
                softshadow_plan::VertexSource::Generated(softshadow_plan::Count::Indirect(counts));
        })
    };
    assert_eq!(indirect(16), Ok(()));
    assert!(matches!(indirect(12), Err(PlanError::Binding { binding, .. }) if binding == "counts"));
    let corners = |bytes: u64, count: u32| {
        after(|plan| {
            let buffer = plan.persistent("other corners", bytes);
            raster_of(plan).vertices = softshadow_plan::VertexSource::Corners { buffer, count };
        })
    };
    assert_eq!(corners(96, 6), Ok(()));
    for (bytes, count) in [(80, 6), (0, 0)] {
        let refused = corners(bytes, count);
        assert!(matches!(refused, Err(PlanError::Binding { binding, .. }) if binding == "other corners"), "{bytes}");
    }
}
