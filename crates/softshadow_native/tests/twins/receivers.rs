//! Receivers of cameras and of points.

use softshadow_native::{NativeEngine, NativeSettings};
use softshadow_scene::Points;
use softshadow_techniques::{RayTraced, Technique};

use crate::harness::{Call, Same, Source, Spoilt, shipped};

fn rays() -> Technique {
    Technique::RayTraced(RayTraced::default())
}

#[test]
fn a_camera_sees_the_same_triangles_at_the_same_places() {
    for (name, size) in [("hall", [61, 43]), ("fork", [64, 48]), ("canopy", [40, 40])] {
        let (scene, light, camera) = shipped(name, size);
        Call::new(rays(), &scene, vec![light], camera).compare_first(1, |_| Same::Bits);
    }
}

#[test]
fn sub_scenes_keep_what_is_nearest() {
    let (scene, light, camera) = shipped("hall", [50, 30]);
    let mut call = Call::new(rays(), &scene, vec![light], camera);
    call.cut_scene(&scene, 40_000);
    assert!(call.scene.local.sub_scenes.len() > 2);
    call.compare_first(call.scene.local.sub_scenes.len(), |_| Same::Bits);
}

#[test]
fn points_are_lifted_alike() {
    let (scene, light, _) = shipped("fork", [8, 8]);
    let at = |k: usize| [(k % 17) as f64 * 0.1, 0.3, (k % 23) as f64 * -0.07];
    for normals in [None, Some(vec![[0.6, 0.0, 0.8]; 3000])] {
        let points = Points::new((0..3000).map(at).collect(), normals).unwrap();
        Call::new(rays(), &scene, vec![light.clone()], Source::Points(points)).compare_first(1, |_| Same::Bits);
    }
}

#[test]
fn a_spoilt_result_is_noticed() {
    let (scene, light, camera) = shipped("fork", [16, 16]);
    let call = Call::new(rays(), &scene, vec![light], camera);
    let native = NativeEngine::new(NativeSettings::default());
    let spoilt = Spoilt { engine: &native, label: "receivers" };
    let words = call.difference(&spoilt, Some((0, 1)), &|_| Same::Bits).expect("a difference");
    assert!(words.contains("after 'place receivers 0': 'receivers', word 0"), "{words}");
}
