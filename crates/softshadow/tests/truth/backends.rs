//! The adapter that was chosen, and Vulkan beside GL.

use softshadow::{
    Context, DeviceChoice, DeviceKind, Options, Ramp, Receivers, SampleSpread, Visibility, adapters, visibility,
};

use crate::common::{
    Random, depth_complexity, hard_shadow_map, occlusion_camera, penumbra_map, ray_traced, shipped, surface_points,
};
use crate::spreads::both;

/// Set where Mesa's drivers are installed, so that a missing adapter fails instead of being skipped.
const EXPECT: &str = "SOFTSHADOW_EXPECT_ADAPTER";

fn lavapipe_is_expected() -> bool {
    std::env::var(EXPECT).is_ok_and(|name| name == "lavapipe")
}

#[test]
fn the_expected_adapter_is_chosen() {
    let adapter = crate::common::context().adapter();
    println!("adapter: {adapter:?}");
    let has_gpu = adapters().iter().any(|a| a.device_type == DeviceKind::Gpu);
    match std::env::var("SOFTSHADOW_DEVICE").as_deref() {
        Err(_) if !has_gpu => assert_eq!(adapter.device_type, DeviceKind::Native, "nothing else was asked for"),
        Ok("software") if lavapipe_is_expected() => {
            assert_eq!((adapter.backend.as_str(), adapter.device_type), ("vulkan", DeviceKind::Software));
        }
        _ => {}
    }
    if adapter.device_type != DeviceKind::Native {
        let listed = &adapters()[adapter.index];
        let known = [&listed.name, &listed.backend];
        assert_eq!(known, [&adapter.name, &adapter.backend], "its index is its place in the list");
    }
    let beyond = Context::new(&DeviceChoice::Index(1000)).err().map(|error| error.to_string());
    assert!(beyond.is_some_and(|words| words.contains("1000")), "a number that no adapter has is refused");
}

/// Receivers whose values differ by more than `tolerance`, and valid ones in all.
fn differing(a: &Visibility, b: &Visibility, tolerance: f32) -> (usize, usize) {
    let pairs = a.values.iter().zip(&b.values).zip(a.valid.iter().zip(&b.valid));
    pairs.fold((0, 0), |(different, all), ((a, b), (valid_a, valid_b))| {
        let differs = valid_a != valid_b || *valid_a && (a - b).abs() > tolerance;
        (different + usize::from(differs), all + usize::from(*valid_a || *valid_b))
    })
}

/// A device of either kind, where there are both.
fn vulkan_and_gl(test: &str) -> Option<[Context; 2]> {
    let of = |backend: &str| adapters().into_iter().find(|a| a.backend == backend).map(|a| a.index);
    let (Some(vulkan), Some(gl)) = (of("vulkan"), of("gl")) else {
        assert!(!lavapipe_is_expected(), "{EXPECT} is set, but Vulkan or GL is missing");
        println!("skipped 1 test: {test} needs both a Vulkan and a GL adapter");
        return None;
    };
    let contexts = [vulkan, gl].map(|index| Context::new(&DeviceChoice::Index(index)).unwrap());
    assert_eq!(contexts.each_ref().map(|c| c.adapter().backend.clone()), ["vulkan", "gl"]);
    Some(contexts)
}

#[test]
fn maps_of_six_faces_are_the_same_on_gl() {
    let Some(contexts) = vulkan_and_gl("maps_of_six_faces_are_the_same_on_gl") else { return };
    let (scene, light, camera) = shipped("toruses", [96, 72]);
    let (light, receivers) = ([light], Receivers::Camera(camera));
    for technique in [hard_shadow_map(256), penumbra_map(256, Ramp::Light)] {
        let [a, b] = contexts.each_ref().map(|context| {
            visibility(context, &scene, &light, &receivers, &technique, &Options::default(), &mut |_, _| true).unwrap()
        });
        assert!(a.info.plan.contains("draw depth 5"), "{}", a.info.plan);
        let (different, all) = differing(&a, &b, 1e-3);
        println!("Vulkan and GL, six faces, {}: {different} of {all} receivers differ", technique.name());
        // Texels next to outlines may be drawn a rounding apart.
        assert!(different * 1000 < all, "{}: {different} of {all}", technique.name());
    }
}

#[test]
fn the_occlusion_camera_is_refused_on_gl() {
    let Some([_, gl]) = vulkan_and_gl("the_occlusion_camera_is_refused_on_gl") else { return };
    let (scene, light, camera) = shipped("toruses", [16, 12]);
    let technique = occlusion_camera(64);
    let receivers = Receivers::Camera(camera);
    let error = visibility(&gl, &scene, &[light], &receivers, &technique, &Options::default(), &mut |_, _| true);
    let words = error.unwrap_err().to_string();
    assert!(words.contains("rgba32float targets, which this device does not do"), "{words}");
}

#[test]
fn vulkan_and_gl_agree() {
    let Some(contexts) = vulkan_and_gl("vulkan_and_gl_agree") else { return };
    let (scene, light, camera) = shipped("hall", [160, 120]);
    let mut faults = Vec::new();
    let floor = Random(4).points(20_000, [-4.0, 4.0], [0.0, 0.0], [-5.0, 5.0]);
    let [apart, interleaved] = [both(64, SampleSpread::Decorrelated), both(64, SampleSpread::Interleaved)];
    let shared = [ray_traced(64), hard_shadow_map(1024), penumbra_map(1024, Ramp::Light), depth_complexity(64)];
    for technique in shared.into_iter().chain(apart).chain(interleaved) {
        for (name, receivers) in
            [("camera", Receivers::Camera(camera)), ("points", surface_points(floor.clone(), [0.0, 1.0, 0.0]))]
        {
            if technique.interleaves() && name == "points" {
                continue;
            }
            let [a, b] = contexts.each_ref().map(|context| {
                let light = std::slice::from_ref(&light);
                let options = Options::default();
                visibility(context, &scene, light, &receivers, &technique, &options, &mut |_, _| true).unwrap()
            });
            // Counts of samples are equal although the two place receivers a rounding apart. Areas follow the receiver: next to an
            // occluder its place moves them by up to 1e-4.
            // Penumbra maps follow the surface in the texel, whose depth is a rounding apart.
            let tolerance = match technique.name() {
                "depth_complexity" => 2e-4,
                "penumbra_map" => 1e-3,
                _ => 1e-6,
            };
            let (different, all) = differing(&a, &b, tolerance);
            println!("Vulkan and GL, {}, {name}: {different} of {all} receivers differ", technique.name());
            let too_many = different * 10_000 > all;
            faults.extend(too_many.then(|| format!("{}, {name}: {different} of {all}", technique.name())));
            assert!(all > 10_000);
            // A comparison that cannot tell one receiver from its neighbour proves nothing.
            let mut spoilt = b.clone();
            spoilt.values.rotate_left(1);
            spoilt.valid.rotate_left(1);
            assert!(differing(&a, &spoilt, tolerance).0 * 1000 > all);
        }
    }
    assert!(faults.is_empty(), "Vulkan and GL differ: {faults:?}");
}
