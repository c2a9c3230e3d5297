//! Masks triangle by triangle.

use softshadow_native::{NativeEngine, NativeSettings, Vectors};
use softshadow_scene::{Light, LightShape, Points, Scene, look_at};
use softshadow_techniques::depth_complexity::OccluderUnit;
use softshadow_techniques::parts::occluder_buffers::boundary_of;
use softshadow_techniques::{DepthComplexity, OccluderContents, Technique};

use crate::harness::{Call, Same, Source, shipped};

fn triangles(samples: u32) -> Technique {
    let settings = DepthComplexity { samples, unit: OccluderUnit::Triangles, ..DepthComplexity::default() };
    Technique::DepthComplexity(settings)
}

/// A light of this shape above a scene.
fn above(shape: LightShape, height: f64) -> Light {
    Light::new(shape, look_at([0.3, height, 0.2], [0.0; 3], Some([0.0, 0.0, -1.0])).unwrap()).unwrap()
}

fn compare(technique: Technique, scene: &Scene, light: Light, receivers: Source) {
    Call::new(technique, scene, vec![light], receivers).compare(same);
}

/// The driver turns 1 − (1 − h / k) into h / k where one pass's standard error is resolved.
fn same(label: &str) -> Same {
    if label == "standard error" { Same::Within(6e-8) } else { Same::Bits }
}

#[test]
fn shipped_scenes() {
    for (name, size) in [("fork", [64, 48]), ("cards", [40, 40]), ("canopy", [40, 40]), ("toruses", [48, 32])] {
        for samples in [33, 64, 256] {
            let (scene, light, camera) = shipped(name, size);
            compare(triangles(samples), &scene, light, camera);
        }
    }
}

/// A single sample gives the device no strips to pass anything by: on foliage it does not end there.
#[test]
fn a_single_sample() {
    for name in ["fork", "cards"] {
        let (scene, light, camera) = shipped(name, [40, 40]);
        compare(triangles(1), &scene, light, camera);
    }
}

#[test]
fn lights_of_every_shape() {
    let outline = vec![[-0.6, -0.4], [0.7, -0.5], [0.5, 0.6], [-0.2, 0.3]];
    let shapes = || {
        [
            LightShape::Rectangle { width: 1.5, height: 0.7 },
            LightShape::Disc { radius: 0.6 },
            LightShape::Polygon { outline: outline.clone() },
            LightShape::Sphere { radius: 0.5 },
            LightShape::Sun { angular_diameter: 0.1 },
        ]
    };
    for (name, height) in [("canopy", 5.0), ("fork", 4.0), ("toruses", 6.0)] {
        for shape in shapes() {
            let (scene, _, camera) = shipped(name, [40, 32]);
            compare(triangles(64), &scene, above(shape, height), camera);
        }
    }
}

fn points(count: usize) -> Source {
    let at = |k: usize| [(k % 41) as f64 * 0.05 - 1.0, (k % 7) as f64 * 0.3, (k % 37) as f64 * 0.05 - 0.9];
    Source::Points(Points::new((0..count).map(at).collect(), None).unwrap())
}

#[test]
fn points_in_a_crown() {
    let (scene, light, _) = shipped("canopy", [8, 8]);
    compare(triangles(64), &scene, light, points(1003));
    compare(triangles(64), &scene, above(LightShape::Sphere { radius: 0.4 }, 4.0), points(1003));
}

/// Above the crown, because in its midst the device ends some walks.
#[test]
fn triangles_that_touch_a_ball_of_light() {
    let (scene, ..) = shipped("canopy", [40, 32]);
    let at = look_at([0.1, 2.6, 0.1], [0.0; 3], Some([0.0, 0.0, -1.0])).unwrap();
    let ball = || Light::new(LightShape::Sphere { radius: 0.3 }, at).unwrap();
    for samples in [7, 64, 100] {
        let call = Call::new(triangles(samples), &scene, vec![ball()], shipped("canopy", [40, 32]).2);
        let local = &call.scene.local;
        assert!(OccluderContents::new(local, boundary_of(local, &ball())).unwrap().touching.is_some());
        call.compare(same);
    }
}

#[test]
fn several_blocks_and_passes() {
    let (scene, light, camera) = shipped("cards", [60, 40]);
    let Technique::DepthComplexity(settings) = triangles(64) else { unreachable!() };
    let technique = Technique::DepthComplexity(DepthComplexity { passes: 2, ..settings });
    Call { block: 700, ..Call::new(technique, &scene, vec![light], camera) }.compare(same);
}

#[test]
fn neither_threads_nor_vectors_matter() {
    let (scene, light, camera) = shipped("canopy", [40, 40]);
    let native = NativeEngine::new(NativeSettings { threads: Some(1), vectors: Vectors::Baseline });
    let difference = Call::new(triangles(64), &scene, vec![light], camera).difference(&native, None, &same);
    assert_eq!(difference, None);
}
