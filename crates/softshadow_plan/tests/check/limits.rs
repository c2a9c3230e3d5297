//! Sizes at the limit of the host, one below and one above, and abilities that it lacks.

use softshadow_plan::{Blend, Host, Plan, PlanError, Shape, TextureFormat, Work, check};

use crate::small_plan::{PIXELS, error, pass, raster_of, resource, small_plan};

/// Checks the plan on hosts whose limit is one more than needed, exactly that, and one less.
fn at_the_limit(plan: &Plan, needed: u64, set: impl Fn(&mut Host, u64), expected: impl Fn(u64) -> PlanError) {
    for limit in [needed + 1, needed] {
        let mut host = Host::default();
        set(&mut host, limit);
        assert_eq!(check(plan, &host), Ok(()), "{needed} fit {limit}");
    }
    let mut host = Host::default();
    set(&mut host, needed - 1);
    assert_eq!(check(plan, &host), Err(expected(needed - 1)));
}

fn too_large(what: &'static str, needed: u64) -> impl Fn(u64) -> PlanError {
    move |limit| PlanError::TooLarge { what: what.into(), needed, limit }
}

#[test]
fn buffers() {
    let needed = PIXELS * 32;
    at_the_limit(&small_plan(), needed, |host, n| host.limits.buffer_bytes = n, too_large("receivers", needed));
    let bound = |limit: u64| PlanError::Binding {
        pass: "place".into(),
        binding: "receivers".into(),
        problem: format!("'receivers' has {needed} bytes, the host binds at most {limit}"),
    };
    at_the_limit(&small_plan(), needed, |host, n| host.limits.storage_binding_bytes = n, bound);
}

#[test]
fn textures() {
    let set = |host: &mut Host, n: u64| host.limits.texture_size = n as u32;
    at_the_limit(&small_plan(), 8, set, too_large("triangle ids", 8));
    let mut tall = small_plan();
    resource(&mut tall, "depth").shape =
        Shape::Texture { format: TextureFormat::Depth32Float, size: [4, 11], layers: 1 };
    at_the_limit(&tall, 11, set, too_large("depth", 11));
    let mut deep = small_plan();
    resource(&mut deep, "depth").shape =
        Shape::Texture { format: TextureFormat::Depth32Float, size: [8, 4], layers: 6 };
    at_the_limit(&deep, 6, |host, n| host.limits.texture_layers = n as u32, too_large("depth", 6));
}

#[test]
fn bindings_and_targets_of_a_pass() {
    // 'place' binds two storage buffers, 'choose' three.
    let set = |host: &mut Host, n: u64| host.limits.storage_buffers = n as u32;
    at_the_limit(&small_plan(), 3, set, too_large("choose", 3));
    let mut plan = small_plan();
    let second = plan.texture("second", TextureFormat::R32Uint, [8, 4], softshadow_plan::Origin::Transient);
    let again = softshadow_plan::ColorTarget { texture: second, ..raster_of(&mut plan).colors[0] };
    raster_of(&mut plan).colors.push(again);
    at_the_limit(&plan, 2, |host, n| host.limits.color_targets = n as u32, too_large("draw", 2));
    // Two targets of four bytes; depth is no colour.
    let bytes = too_large("draw, bytes of a pixel", 8);
    at_the_limit(&plan, 8, |host, n| host.limits.color_bytes = n as u32, bytes);
}

#[test]
fn layers_that_exist() {
    let format = TextureFormat::Depth32Float;
    for (layer, fits) in [(2, true), (3, false), (4, false)] {
        let mut plan = small_plan();
        resource(&mut plan, "depth").shape = Shape::Texture { format, size: [8, 4], layers: 3 };
        raster_of(&mut plan).depth.as_mut().unwrap().layer = layer;
        let expected = PlanError::TooLarge { what: "depth".into(), needed: u64::from(layer) + 1, limit: 3 };
        assert_eq!(check(&plan, &Host::default()), if fits { Ok(()) } else { Err(expected) });
    }
}

#[test]
fn copies_within_their_buffers() {
    let whole = PIXELS * 4;
    let longer = error(|plan| {
        let Work::Copy { bytes, .. } = &mut pass(plan, "keep").work else { panic!("'keep' copies") };
        *bytes += 4;
    });
    assert_eq!(longer, too_large("keep", whole + 4)(whole));
    let narrow = error(|plan| resource(plan, "kept").shape = Shape::Buffer { bytes: whole - 4 });
    assert_eq!(narrow, too_large("keep", whole)(whole - 4));
}

#[test]
fn abilities() {
    let missing = |feature| Err(PlanError::MissingFeature { pass: "draw".into(), feature });
    let mut host = Host::default();
    host.features.raster = false;
    assert_eq!(check(&small_plan(), &host), missing("raster"));
    for blend in [Blend::Add, Blend::Min, Blend::Max] {
        let mut plan = small_plan();
        raster_of(&mut plan).colors[0].blend = blend;
        let mut host = Host::default();
        assert_eq!(check(&plan, &host), missing("float32-blendable"), "{blend:?}");
        host.features.float32_blendable = true;
        assert_eq!(check(&plan, &host), Ok(()), "{blend:?}");
    }
    let mut plan = small_plan();
    let target = raster_of(&mut plan).colors[0].texture;
    let mut host = Host::default();
    host.features.float32_drawable = false;
    assert_eq!(check(&plan, &host), Ok(()));
    if let Shape::Texture { format, .. } = &mut plan.resources[target.index()].shape {
        *format = TextureFormat::Rgba32Float;
    }
    assert_eq!(check(&plan, &host), missing("rgba32float colour targets"));
}
