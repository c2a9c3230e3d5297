//! Slices, their tables and what receivers look up in them.

use softshadow_native::{NativeEngine, NativeSettings, Vectors};
use softshadow_scene::{Light, LightShape, Points, look_at};
use softshadow_techniques::Technique;
use softshadow_techniques::occlusion_layers::{Combine, Filter, Near, OcclusionLayers, Projection};

use crate::harness::{Call, Same, Source, Spoilt, shipped};

/// A list in any order, behind its count.
fn in_order(words: &[u32]) -> Vec<Vec<u32>> {
    let mut list = words[4..4 + words[0] as usize].to_vec();
    list.sort_unstable();
    vec![words[..4].to_vec(), list]
}

/// The planes that there are: behind them stands what a scene before left.
fn placed(words: &[u32]) -> Vec<Vec<u32>> {
    vec![words[..8 + words[5] as usize].to_vec()]
}

/// Bit for bit, but for lists in any order, and the last step: one value in a thousand comes out a unit of rounding away from the driver's.
fn same(label: &str) -> Same {
    match label {
        "layer places" => Same::Sorted(placed),
        "visibility" => Same::Within(1e-6),
        _ if label.starts_with("tall triangles") => Same::Sorted(in_order),
        _ => Same::Bits,
    }
}

fn layers(settings: OcclusionLayers) -> Technique {
    Technique::OcclusionLayers(settings)
}

fn above(shape: LightShape, height: f64) -> Vec<Light> {
    vec![Light::new(shape, look_at([0.3, height, 0.2], [0.0, 0.0, 0.0], Some([0.0, 0.0, 1.0])).unwrap()).unwrap()]
}

#[test]
fn settings_of_every_kind() {
    let base = OcclusionLayers { slices: 8, resolution: 128, ..OcclusionLayers::default() };
    let settings = [
        base.clone(),
        OcclusionLayers { split: 1, near: Near::Fade, ..base.clone() },
        OcclusionLayers { split: 8, combine: Combine::Maximum, ..base.clone() },
        OcclusionLayers { slices: 33, combine: Combine::Sum, near: Near::Fade, ..base.clone() },
        OcclusionLayers { projection: Projection::Parallel, repair_leaks: true, ..base.clone() },
        OcclusionLayers { slices: 128, resolution: 64, ..base },
    ];
    for name in ["fork", "canopy", "hall"] {
        for settings in &settings {
            let (scene, light, camera) = shipped(name, [40, 32]);
            Call::new(layers(settings.clone()), &scene, vec![light], camera).compare(same);
        }
    }
}

/// The filters of the paper: a single slice, groups of four that are not full, kernels larger than all texels (of a fork below a wide sun).
#[test]
fn filters_for_comparison() {
    for (filter, name, slices, near, split) in [
        (Filter::Nbuffer, "canopy", 8, Near::Rays, 2),
        (Filter::Nbuffer, "fork", 5, Near::Fade, 1),
        (Filter::Mipmap, "fork", 6, Near::Fade, 1),
        (Filter::Mipmap, "hall", 1, Near::Rays, 2),
    ] {
        let settings = OcclusionLayers { slices, resolution: 64, filter, near, split, ..OcclusionLayers::default() };
        let (scene, light, camera) = shipped(name, [40, 32]);
        let wide = above(LightShape::Sun { angular_diameter: 2.4 }, 5.0).remove(0);
        Call::new(layers(settings), &scene, vec![light, wide], camera).compare(same);
    }
}

#[test]
fn lights_of_every_shape() {
    let outline = vec![[-0.6, -0.4], [0.7, -0.5], [0.5, 0.6], [-0.2, 0.3]];
    let settings = OcclusionLayers { slices: 8, resolution: 128, split: 3, ..OcclusionLayers::default() };
    for (name, height) in [("canopy", 5.0), ("toruses", 6.0)] {
        for shape in [
            LightShape::Rectangle { width: 1.5, height: 0.7 },
            LightShape::Disc { radius: 0.6 },
            LightShape::Polygon { outline: outline.clone() },
            LightShape::Sphere { radius: 0.5 },
            LightShape::Sun { angular_diameter: 0.1 },
        ] {
            let (scene, _, camera) = shipped(name, [40, 32]);
            Call::new(layers(settings.clone()), &scene, above(shape, height), camera).compare(same);
        }
    }
}

#[test]
fn points_without_a_horizon_and_several_blocks() {
    let at = |k: usize| [(k % 41) as f64 * 0.05 - 1.0, (k % 7) as f64 * 0.3, (k % 37) as f64 * 0.05 - 0.9];
    let (scene, light, _) = shipped("canopy", [8, 8]);
    let points = Source::Points(Points::new((0..3000).map(at).collect(), None).unwrap());
    let settings = OcclusionLayers { slices: 16, resolution: 128, ..OcclusionLayers::default() };
    let mut call = Call::new(layers(settings), &scene, vec![light.clone(), light], points);
    call.block = 1300;
    call.compare(same);
}

#[test]
fn neither_threads_nor_vectors_matter() {
    let (scene, light, camera) = shipped("canopy", [40, 32]);
    let call = Call::new(layers(OcclusionLayers::default()), &scene, vec![light], camera);
    let engines = [
        NativeSettings { threads: Some(1), vectors: Vectors::Baseline },
        NativeSettings { threads: Some(3), vectors: Vectors::Widest },
    ]
    .map(NativeEngine::new);
    assert_eq!(call.difference_between([&engines[0], &engines[1]], None, &same), None);
}

#[test]
fn a_spoilt_table_is_noticed() {
    let native = NativeEngine::new(NativeSettings::default());
    for filter in [Filter::SummedArea, Filter::Nbuffer] {
        let settings = OcclusionLayers { slices: 4, resolution: 64, filter, ..OcclusionLayers::default() };
        let (scene, light, camera) = shipped("fork", [16, 16]);
        let call = Call::new(layers(settings), &scene, vec![light], camera);
        for label in ["slice bits", "layer tables"] {
            let spoilt = Spoilt { engine: &native, label };
            let words = call.difference(&spoilt, None, &same).expect("a difference");
            assert!(words.contains(label), "{words}");
        }
    }
}
