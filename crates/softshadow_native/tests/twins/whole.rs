//! Whole calls: lists and folds together, each engine with its own lists.

use softshadow_scene::{Material, Mesh, SampleSpread, Scene};
use softshadow_techniques::depth_complexity::Silhouettes;
use softshadow_techniques::{DepthComplexity, Technique};

use crate::harness::{Call, Same, shipped};

/// What a caller gets. Areas are within a unit of their fixed point, and what passes glass within the driver's `exp2`.
fn results(label: &str) -> Same {
    match label {
        "visibility" | "sample transmittance" => Same::Within(2e-6),
        "blocked samples" | "receivers" => Same::Bits,
        _ => Same::Apart("is no result"),
    }
}

fn call(scene: &Scene, name: &str, settings: DepthComplexity) -> Call {
    let (_, light, camera) = shipped(name, [61, 47]);
    Call::new(Technique::DepthComplexity(settings), scene, vec![light], camera)
}

#[test]
fn edges_give_the_same_visibility() {
    for name in ["fork", "hall", "toruses"] {
        let scene = shipped(name, [8, 8]).0;
        for silhouettes in [Silhouettes::Accurate, Silhouettes::Standard] {
            call(&scene, name, DepthComplexity { silhouettes, ..DepthComplexity::default() }).compare(results);
        }
    }
}

#[test]
fn glass_and_sets_of_samples_give_the_same_visibility() {
    let glass = |mesh: &Mesh| {
        let material = Material { opacity: 0.4, ..mesh.material };
        Mesh::new(mesh.name.clone(), mesh.vertices.clone(), mesh.triangles.clone(), material).unwrap()
    };
    let scene = Scene::new(shipped("fork", [8, 8]).0.meshes().iter().map(glass).collect()).unwrap();
    for spread in [SampleSpread::Correlated, SampleSpread::Decorrelated, SampleSpread::Interleaved] {
        call(&scene, "fork", DepthComplexity { spread, ..DepthComplexity::default() }).compare(results);
    }
}
