//! Memory limits, interruptions and lost devices: results do not depend on them, and the next call works.

use softshadow::{
    Context, DeviceChoice, Error, Light, Options, RayTraced, Receivers, Scene, Technique, Visibility, visibility,
};

use crate::common::{Random, bits, context, depth_complexity, hard_shadow_map, rays, shipped, surface_points};

fn limited(
    scene: &Scene,
    light: &Light,
    receivers: &Receivers,
    technique: &Technique,
    memory_limit_bytes: u64,
) -> Result<Visibility, Error> {
    let options =
        Options { memory_limit_bytes, standard_error: true, receivers: true, sample_masks: true, ..Options::default() };
    let lights = [light.clone(), light.clone().with_radiance([2.0; 3]).unwrap()];
    visibility(context(), scene, &lights, receivers, technique, &options, &mut |_, _| true)
}

fn require_same(whole: &Visibility, parts: &Visibility) {
    assert!(bits(whole) == bits(parts));
    assert_eq!((&whole.valid, &whole.standard_error.is_some()), (&parts.valid, &parts.standard_error.is_some()));
    let error_bits = |v: &Visibility| -> Vec<u32> { v.standard_error.iter().flatten().map(|e| e.to_bits()).collect() };
    assert!(error_bits(whole) == error_bits(parts));
    let ids = |v: &Visibility| v.placed.as_ref().unwrap().triangles.clone();
    assert_eq!(ids(whole), ids(parts));
}

#[test]
fn a_small_memory_limit_changes_no_bit() {
    let (scene, light, camera) = shipped("hall", [96, 64]);
    let floor = Random(2).points(100_000, [-4.0, 4.0], [0.0, 0.0], [-5.0, 5.0]);
    let camera = Receivers::Camera(camera);
    let floor = surface_points(floor, [0.0, 1.0, 0.0]);
    let plain = Technique::RayTraced(RayTraced { passes: 2, ..rays(40) });
    let probed = Technique::RayTraced(RayTraced { probes: 8, ..rays(40) });
    for (receivers, technique, limit) in [
        (&camera, &plain, 150_000),
        (&camera, &probed, 60_000),
        (&camera, &hard_shadow_map(512), 50_000),
        (&floor, &plain, 1_000_000),
        (&floor, &hard_shadow_map(512), 900_000),
        (&camera, &depth_complexity(40), 250_000),
        (&floor, &depth_complexity(128), 5_000_000),
    ] {
        let whole = limited(&scene, &light, receivers, technique, 1 << 30).unwrap();
        let parts = limited(&scene, &light, receivers, technique, limit).unwrap();
        println!("{} in {} blocks instead of {}", technique.name(), parts.info.blocks, whole.info.blocks);
        assert_eq!(whole.info.blocks, 1);
        assert!(parts.info.blocks > 3, "{}", parts.info.blocks);
        require_same(&whole, &parts);
    }
    // Another image is not the same.
    let other = limited(&scene, &light, &camera, &Technique::RayTraced(RayTraced { seed: 1, ..rays(40) }), 1 << 30);
    let first = limited(&scene, &light, &camera, &Technique::RayTraced(rays(40)), 1 << 30).unwrap();
    assert!(bits(&first) != bits(&other.unwrap()));
}

#[test]
fn a_limit_that_holds_no_row_is_too_small() {
    let (scene, light, camera) = shipped("hall", [96, 64]);
    let camera = Receivers::Camera(camera);
    let probed = Technique::RayTraced(RayTraced { probes: 8, ..rays(40) });
    let Err(Error::TooLarge { needed, limit, .. }) = limited(&scene, &light, &camera, &probed, 10_000) else {
        panic!("10 kB hold three rows of 96 receivers");
    };
    assert!(limit == 10_000 && needed > limit);
    // What is needed suffices, and a byte less does not.
    let exact = limited(&scene, &light, &camera, &probed, needed).unwrap();
    require_same(&limited(&scene, &light, &camera, &probed, 1 << 30).unwrap(), &exact);
    assert!(matches!(limited(&scene, &light, &camera, &probed, needed - 1), Err(Error::TooLarge { .. })));
}

#[test]
fn an_interrupted_call_says_so_and_the_next_one_works() {
    let (scene, light, camera) = shipped("hall", [96, 64]);
    let receivers = Receivers::Camera(camera);
    let technique = Technique::RayTraced(RayTraced { passes: 8, ..rays(32) });
    let lights = [light];
    let run = |on_progress: softshadow::Progress<'_>| {
        visibility(context(), &scene, &lights, &receivers, &technique, &Options::default(), on_progress)
    };
    let expected = run(&mut |_, _| true).unwrap();
    for allowed in [0, 1, 5] {
        let mut asked = 0;
        let stopped = run(&mut |done, total| {
            assert!(done <= total);
            asked += 1;
            asked <= allowed
        });
        assert_eq!(stopped.err(), Some(Error::Interrupted), "after {allowed}");
        assert_eq!(asked, allowed + 1, "nobody is asked again who said stop");
        assert!(bits(&run(&mut |_, _| true).unwrap()) == bits(&expected));
    }
    let mut last = (0, 0);
    run(&mut |done, total| {
        last = (done, total);
        true
    })
    .unwrap();
    assert_eq!(last, (8, 8), "the last report says that all is done");
}

#[test]
fn a_lost_device_is_opened_again() {
    let own = Context::new(&DeviceChoice::Auto).unwrap();
    let (scene, light, camera) = shipped("hall", [96, 64]);
    let (lights, receivers) = ([light], Receivers::Camera(camera));
    let technique = Technique::RayTraced(RayTraced { passes: 8, ..rays(32) });
    let run = |on_progress: softshadow::Progress<'_>| {
        visibility(&own, &scene, &lights, &receivers, &technique, &Options::default(), on_progress)
    };
    let expected = run(&mut |_, _| true).unwrap();
    for _ in 0..2 {
        own.lose_device();
        match run(&mut |_, _| true) {
            Ok(seen) => assert!(bits(&seen) == bits(&expected)),
            Err(error) => assert!(matches!(error, Error::Gpu(_)), "{error:?}"),
        }
        assert!(bits(&run(&mut |_, _| true).unwrap()) == bits(&expected), "the call after that works");
    }
    // Lost while a call is under way: a typed error, or an honest result; never a wrong one.
    let mut asked = 0;
    let outcome = run(&mut |_, _| {
        asked += 1;
        if asked == 3 {
            own.lose_device();
        }
        true
    });
    println!("lost in the middle: {:?}", outcome.as_ref().err());
    match outcome {
        Ok(seen) => assert!(bits(&seen) == bits(&expected)),
        Err(error) => assert!(matches!(error, Error::Gpu(_)), "{error:?}"),
    }
    assert!(bits(&run(&mut |_, _| true).unwrap()) == bits(&expected));
}
