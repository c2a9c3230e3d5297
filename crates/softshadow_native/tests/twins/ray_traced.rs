//! Shadow rays: the masks, the candidates and what passes, bit for bit, up to where they are resolved.

use softshadow_native::{NativeEngine, NativeSettings, Vectors};
use softshadow_scene::{Light, LightShape, Points, SamplePattern, SampleSpread, Scene, look_at};
use softshadow_techniques::{RayTraced, Technique};

use crate::harness::{Call, Same, Source, shipped};

/// Candidates come in no particular order, and what lies behind them in the buffer is of no account.
fn rows(list: &[u32]) -> Vec<Vec<u32>> {
    let (header, items) = list.split_at(4);
    let listed = items.chunks(3).take(header[0] as usize);
    [header].into_iter().chain(listed).map(<[u32]>::to_vec).collect()
}

fn same(label: &str) -> Same {
    if label.starts_with("gathered") || label.starts_with("candidates") { Same::Sorted(rows) } else { Same::Bits }
}

fn call(settings: RayTraced, scene: &Scene, lights: Vec<Light>, receivers: Source) -> Call {
    let call = Call::new(Technique::RayTraced(settings), scene, lights, receivers);
    Call { until: Some("resolve"), without: &["resolve"], ..call }
}

fn agrees(call: &Call, case: &str) {
    let native = NativeEngine::new(NativeSettings::default());
    assert_eq!(call.difference(&native, None, &same), None, "{case}");
}

/// A light where that of the fork is.
fn above_fork(shape: LightShape) -> Light {
    Light::new(shape, look_at([-1.7, 1.5, 0.2], [0.0, 0.0, 0.3], None).unwrap()).unwrap()
}

fn shapes() -> [(&'static str, LightShape); 5] {
    let corners = [[-1.0, -1.0], [1.2, -1.0], [1.2, -0.3], [-0.2, -0.3], [-0.2, 0.9], [-1.0, 0.9]];
    [
        ("rectangle", LightShape::Rectangle { width: 0.7, height: 0.5 }),
        ("disc", LightShape::Disc { radius: 0.4 }),
        ("polygon", LightShape::Polygon { outline: corners.map(|p| p.map(|x| x * 0.4)).to_vec() }),
        ("sphere", LightShape::Sphere { radius: 0.4 }),
        ("sun", LightShape::Sun { angular_diameter: 0.2 }),
    ]
}

/// Points all around, some of them behind the light and inside it.
fn scattered(count: usize, with_normals: bool) -> Source {
    // Fractions of multiples of irrational numbers fill the box evenly.
    let part = |k: usize, ratio: f64| (k as f64 * ratio).fract();
    let at =
        |k: usize| [part(k, 0.754_877) * 3.0 - 2.2, part(k, 0.569_840) * 1.9 - 0.1, part(k, 0.430_159) * 2.0 - 0.8];
    let turned = |k: usize| [part(k, 0.618_034) - 0.5, part(k, 0.414_214) - 0.1, part(k, 0.732_051) - 0.5];
    let normals = with_normals.then(|| (0..count).map(turned).collect());
    Source::Points(Points::new((0..count).map(at).collect(), normals).unwrap())
}

#[test]
fn every_light_is_hidden_from_the_same_pixels() {
    for (name, shape) in shapes() {
        for probes in [0, 5] {
            let (scene, _, camera) = shipped("fork", [61, 43]);
            let settings = RayTraced { probes, ..RayTraced::default() };
            let call = call(settings, &scene, vec![above_fork(shape.clone())], camera);
            agrees(&call, &format!("{name}, {probes} probes"));
        }
    }
}

#[test]
fn points_behind_a_light_and_inside_it_see_the_same() {
    let (scene, ..) = shipped("fork", [8, 8]);
    for (name, shape) in shapes() {
        for with_normals in [false, true] {
            let light = above_fork(shape.clone());
            let call = call(RayTraced::default(), &scene, vec![light], scattered(3000, with_normals));
            agrees(&call, &format!("{name}, normals {with_normals}"));
        }
    }
}

#[test]
fn samples_are_taken_from_the_same_sets() {
    for spread in [SampleSpread::Correlated, SampleSpread::Decorrelated, SampleSpread::Interleaved] {
        for (samples, probes) in [(1, 0), (33, 0), (64, 40), (100, 7)] {
            let (scene, _, camera) = shipped("fork", [40, 30]);
            let settings = RayTraced { samples, probes, spread, passes: 2, tile: 3, ..RayTraced::default() };
            let call = call(settings, &scene, vec![above_fork(LightShape::Disc { radius: 0.3 })], camera);
            agrees(&call, &format!("{spread:?}, {samples} samples, {probes} probes"));
        }
    }
    let (scene, _, _) = shipped("fork", [8, 8]);
    let spread = SampleSpread::Decorrelated;
    let settings = RayTraced { samples: 24, pattern: SamplePattern::LowDiscrepancy, spread, ..RayTraced::default() };
    call(settings, &scene, vec![above_fork(LightShape::Sphere { radius: 0.3 })], scattered(999, true)).compare(same);
}

#[test]
fn blocks_sub_scenes_and_several_lights_agree() {
    for probes in [0, 8] {
        let (scene, light, camera) = shipped("hall", [64, 40]);
        let other = above_fork(LightShape::Sphere { radius: 0.5 });
        let settings = RayTraced { probes, passes: 2, ..RayTraced::default() };
        let mut call = call(settings, &scene, vec![light, other], camera);
        call.block = 1000;
        call.cut_scene(&scene, 40_000);
        assert!(call.scene.local.sub_scenes.len() > 2);
        call.compare(same);
    }
}

/// The scene with triangles of several opacities, opaque ones among them.
fn semi_opaque(scene: &Scene) -> Scene {
    let meshes = scene.meshes().iter().map(|mesh| {
        let opacities = [0.5, 1.0, 0.25, 0.9, 0.0, 0.5, 0.75];
        mesh.clone().with_opacities((0..mesh.triangles.len()).map(|k| opacities[k % 7]).collect()).unwrap()
    });
    Scene::new(meshes.collect()).unwrap()
}

#[test]
fn the_same_share_passes_semi_opaque_triangles() {
    for probes in [0, 8] {
        let (scene, light, camera) = shipped("hall", [48, 32]);
        let scene = semi_opaque(&scene);
        let settings = RayTraced { probes, passes: 2, ..RayTraced::default() };
        call(settings.clone(), &scene, vec![light.clone()], camera).compare(same);
        let (_, _, camera) = shipped("hall", [48, 32]);
        let mut call = call(settings, &scene, vec![light], camera);
        call.cut_scene(&scene, 40_000);
        call.compare(same);
    }
    let (scene, ..) = shipped("fork", [8, 8]);
    for (name, shape) in shapes() {
        let light = above_fork(shape);
        agrees(&call(RayTraced::default(), &semi_opaque(&scene), vec![light], scattered(2000, true)), name);
    }
}

#[test]
fn walks_that_are_too_long_end_alike() {
    // A light that fills half of the sky lies behind most boxes; a thin one behind many boxes without any triangle.
    let sun = |angular_diameter: f64| {
        let pose = look_at([0.0, 9.0, 0.0], [0.0; 3], Some([1.0, 0.0, 0.0])).unwrap();
        Light::new(LightShape::Sun { angular_diameter }, pose).unwrap()
    };
    let (scene, _, camera) = shipped("canopy", [40, 40]);
    let settings = RayTraced { samples: 8, ..RayTraced::default() };
    call(settings, &scene, vec![sun(2.5), sun(0.01)], camera).compare(same);
}

#[test]
fn nothing_depends_on_threads_or_the_width_of_vectors() {
    let narrow = NativeEngine::new(NativeSettings { threads: Some(1), vectors: Vectors::Baseline });
    let wide = NativeEngine::new(NativeSettings::default());
    let (scene, light, camera) = shipped("hall", [64, 48]);
    let settings = RayTraced { probes: 8, ..RayTraced::default() };
    let call = call(settings, &scene, vec![light], camera);
    // Not even the order of the candidates.
    assert_eq!(call.difference_between([&narrow, &wide], None, &|_| Same::Bits), None);
}
