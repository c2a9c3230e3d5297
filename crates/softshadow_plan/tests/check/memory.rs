//! Bytes by resource are exact, and what people read agrees with them.

use softshadow_plan::{Content, Origin, Plan, Shape, TextureFormat};

use crate::small_plan::small_plan;

/// Every kind of resource with the bytes that a person counts.
fn counted() -> (Plan, Vec<(&'static str, u64)>) {
    let mut plan = Plan::new("counted");
    plan.buffer("transient", 1_234_567);
    plan.persistent("persistent", (1 << 33) + 4);
    plan.parameter("parameter", 16);
    // Contents are padded to whole words.
    plan.uploaded("uploaded", &Content::new(&[1; 13]));
    let texture = |plan: &mut Plan, label: &str, format, size, layers| {
        plan.resource(label, Shape::Texture { format, size, layers }, Origin::Transient);
    };
    texture(&mut plan, "ids", TextureFormat::R32Uint, [3, 5], 1);
    texture(&mut plan, "values", TextureFormat::R32Float, [3, 5], 7);
    texture(&mut plan, "moments", TextureFormat::Rgba32Float, [3, 5], 2);
    texture(&mut plan, "largest", TextureFormat::Rgba32Float, [16_384, 16_384], 256);
    plan.texture("depth", TextureFormat::Depth32Float, [1920, 1080], Origin::External);
    let bytes = vec![
        ("transient", 1_234_567),
        ("persistent", 8_589_934_596),
        ("parameter", 16),
        ("uploaded", 16),
        ("ids", 60),
        ("values", 420),
        ("moments", 480),
        ("largest", 1_099_511_627_776),
        ("depth", 8_294_400),
    ];
    (plan, bytes)
}

#[test]
fn bytes_are_exact_for_buffers_and_textures() {
    let (plan, bytes) = counted();
    assert_eq!(plan.memory(), bytes);
    let (mut spoilt, _) = counted();
    spoilt.resources[5].shape = Shape::Texture { format: TextureFormat::R32Float, size: [3, 5], layers: 8 };
    assert_ne!(spoilt.memory(), bytes, "one layer more is seen");
}

#[test]
fn the_explanation_gives_a_reason_a_pass_and_the_same_bytes() {
    let plan = small_plan();
    let text = plan.explain();
    for pass in &plan.passes {
        assert!(text.contains(&format!("  {}: {}\n", pass.label, pass.why)), "{text}");
    }
    for (label, bytes) in plan.memory() {
        let rows = text.lines().filter(|row| row.contains(&format!(" {bytes} bytes  [{label}] "))).count();
        assert_eq!(rows, 1, "{label} in\n{text}");
    }
    // 48 corners, two images of 128, two uniforms of 64, 8, 32 and 8; 1024 receivers and three buffers of 128.
    assert!(text.ends_with(" 1888 bytes in all\n"), "{text}");
}

#[test]
fn equal_bytes_have_equal_keys() {
    assert_eq!(Content::new(&[1, 2, 3]).key, Content::new(&[1, 2, 3]).key);
    assert_ne!(Content::new(&[1, 2, 3]).key, Content::new(&[1, 2, 4]).key);
    assert_ne!(Content::new(&[1, 2, 3]).key, Content::new(&[1, 2, 3, 0]).key, "padding is no content");
    let plan = small_plan();
    assert_eq!(plan.content_keys().collect::<Vec<_>>(), [Content::new(&[7; 48]).key]);
}
