//! Wedges drawn over a camera's image against tiles of receivers: the same edges, the same samples, the same bits.

use softshadow::{
    Camera, Context, Counters, DepthComplexity, DeviceChoice, Evaluation, InitialCounts, Light, LightShape,
    LightTexture, Options, Receivers, Scene, Technique, Visibility, adapters, visibility,
};

use crate::common::{Random, bits, context, lamp, on_driver, points, rectangle, see, shipped};
use crate::depth_complexity::{bodies, lights};
use crate::shapes::{Triangle, plate, scene, sphere, torus};

fn tiled(samples: u32) -> DepthComplexity {
    DepthComplexity { samples, exact_area: false, ..DepthComplexity::default() }
}

fn blended(samples: u32, counters: Counters) -> DepthComplexity {
    DepthComplexity { evaluation: Evaluation::Blended, counters, ..tiled(samples) }
}

/// Samples in which two masks differ, and samples that the first hides.
fn differing(a: &Visibility, b: &Visibility, samples: u32) -> (u32, u32) {
    // Bits past the last sample mean nothing.
    let used = |at: usize| {
        let left = samples - 32 * (at as u32 % samples.div_ceil(32));
        if left >= 32 { !0 } else { !(!0u32 << left) }
    };
    let (a, b) = (&a.masks.as_ref().unwrap().bits, &b.masks.as_ref().unwrap().bits);
    assert_eq!(a.len(), b.len());
    let rows = a.iter().zip(b).enumerate();
    rows.fold((0, 0), |(differ, hidden), (at, (x, y))| {
        (differ + ((x ^ y) & used(at)).count_ones(), hidden + (x & used(at)).count_ones())
    })
}

/// Samples in which wedges differ from tiles, and samples that are hidden.
fn against_tiles(scene: &Scene, light: &Light, camera: Camera, settings: &DepthComplexity) -> (Visibility, u32, u32) {
    let (lights, receivers) = (std::slice::from_ref(light), Receivers::Camera(camera));
    let plain = DepthComplexity { pattern: settings.pattern, ..tiled(settings.samples) };
    let tiles = see(scene, lights, &receivers, &Technique::DepthComplexity(plain));
    let wedges = see(scene, lights, &receivers, &Technique::DepthComplexity(settings.clone()));
    assert_eq!(tiles.valid, wedges.valid);
    let (differ, hidden) = differing(&tiles, &wedges, settings.samples);
    (wedges, differ, hidden)
}

fn floor(z: f64) -> Vec<Triangle> {
    plate([-3.0, 3.0], [-3.0, 3.0], z)
}

#[test]
fn shipped_scenes_have_the_bits_of_tiles() {
    let _driver = on_driver();
    for name in ["fork", "cards", "toruses", "hall"] {
        let (scene, light, camera) = shipped(name, [160, 120]);
        for counters in [Counters::Words, Counters::Float] {
            let (wedges, differ, hidden) = against_tiles(&scene, &light, camera, &blended(64, counters));
            println!("{name} {counters:?}: {differ} samples differ, {} wedges", wedges.info.silhouette_edges);
            assert!(hidden > 100_000 && wedges.info.silhouette_edges > 40, "{name}: {hidden}");
            assert_eq!(differ, 0, "{name} {counters:?}");
        }
    }
}

#[test]
fn every_light_base_and_count_of_samples_has_the_bits_of_tiles() {
    let ground = scene(&[torus(0.5, 0.2, 24, 12), sphere([0.1, 0.0, 0.6], 0.25, 2), floor(-0.7)].concat());
    let camera = Camera::look_at([1.8, -2.4, 1.6], [0.0, 0.0, -0.4], None, 50.0, [64, 48]).unwrap();
    for light in lights() {
        for (samples, base) in [(1, 8), (16, 16), (40, 64), (64, 8), (128, 256), (256, 8)] {
            for counters in [Counters::Words, Counters::Float] {
                let settings = DepthComplexity { base, ..blended(samples, counters) };
                let (wedges, differ, hidden) = against_tiles(&ground, &light, camera, &settings);
                assert!(hidden > 100 * samples && wedges.info.silhouette_edges > 50, "{:?}: {hidden}", light.shape());
                assert_eq!(differ, 0, "{:?} {settings:?}", light.shape());
            }
        }
    }
}

#[test]
fn cameras_stand_in_wedges_and_before_casters() {
    let _driver = on_driver();
    // Between casters and floor, in umbra and penumbra, looking anywhere: wedges are entered, cross the near plane, and begin behind the
    // eye; walls stand behind receivers, and casters where the camera does not look.
    let walls = [floor(-0.7), plate([-3.0, 3.0], [-3.0, 3.0], 4.0)].concat();
    let room = scene(&[torus(0.5, 0.2, 24, 12), sphere([0.1, 0.0, 0.6], 0.25, 2), walls].concat());
    let mut random = Random(21);
    let mut seen = 0;
    for (number, light) in (0..5).flat_map(|_| lights()).enumerate() {
        let eye = random.point([-0.9, 0.9], [-0.9, 0.9], [-0.65, 1.2]);
        let target = random.point([-1.5, 1.5], [-1.5, 1.5], [-0.7, 1.0]);
        let camera = Camera::look_at(eye, target, None, random.within([20.0, 120.0]), [56, 40]).unwrap();
        let counters = if number % 2 == 0 { Counters::Words } else { Counters::Float };
        let (_, differ, hidden) = against_tiles(&room, &light, camera, &blended(64, counters));
        seen += u32::from(hidden > 2000);
        assert_eq!(differ, 0, "camera {number} at {eye:?} to {target:?}, {:?}", light.shape());
    }
    assert!(seen > 15, "{seen} cameras see shadow");
}

#[test]
fn lights_within_the_scene_have_wedges_over_the_whole_image() {
    let _driver = on_driver();
    let room = scene(&[torus(0.6, 0.3, 24, 12), sphere([0.0, 0.0, 0.1], 0.3, 2), floor(-0.8)].concat());
    let camera = Camera::look_at([1.2, -1.9, 0.4], [0.0, 0.0, -0.5], None, 60.0, [64, 48]).unwrap();
    for shape in [rectangle(1.0, 1.0), LightShape::Disc { radius: 0.4 }] {
        let light = lamp(shape, [0.05, 0.03, 0.12]);
        let (wedges, differ, hidden) = against_tiles(&room, &light, camera, &blended(64, Counters::Words));
        assert!(wedges.info.cut_triangles > 20 && hidden > 10_000, "{hidden}");
        assert_eq!(differ, 0, "{:?}", light.shape());
    }
    // Around a ball of light.
    let light = lamp(LightShape::Sphere { radius: 0.3 }, [1.1, 0.8, 0.2]);
    let (_, differ, hidden) = against_tiles(&room, &light, camera, &blended(64, Counters::Float));
    assert!(hidden > 10_000, "{hidden}");
    assert_eq!(differ, 0);
}

#[test]
fn any_number_of_layers_is_counted() {
    // Plates over each other, each with four borders over the same receivers: ever more layers, until digits are as wide as they get.
    let camera = Camera::look_at([0.0, -2.6, 1.2], [0.0, 0.3, 0.0], None, 50.0, [48, 36]).unwrap();
    let light = lamp(rectangle(0.6, 0.5), [0.1, 0.05, 3.0]);
    let mut widths = std::collections::BTreeSet::new();
    for layers in [1, 2, 3, 6, 7, 8, 15, 30, 31, 63, 64, 120, 127, 128, 239, 255, 256, 300] {
        let mut stack = floor(0.0);
        for k in 0..layers {
            let shift = 0.0007 * f64::from(k);
            stack.extend(plate([-0.5 + shift, 0.5 + shift], [-0.4, 0.4 + shift], 0.8 + 0.001 * f64::from(k)));
        }
        let stack = scene(&stack);
        for (counters, batches) in
            [(Counters::Words, 1), (Counters::Words, 2), (Counters::Float, 1), (Counters::Float, 2)]
        {
            let settings = DepthComplexity { batches, ..blended(64, counters) };
            let (wedges, differ, hidden) = against_tiles(&stack, &light, camera, &settings);
            assert!(hidden > 1000, "{hidden}");
            assert_eq!(differ, 0, "{layers} layers, {settings:?}");
            let line = wedges.info.plan.lines().find(|line| line.contains("[counters]")).unwrap().to_owned();
            widths.insert(format!("{counters:?}{}", line.split("[counters]").nth(1).unwrap()));
        }
    }
    println!("{widths:#?}");
    assert!(widths.len() >= 8, "narrow and wide digits were used: {widths:?}");
}

#[test]
fn blocks_textures_and_passes_change_no_bit() {
    let _driver = on_driver();
    let (scene, light, camera) = shipped("toruses", [96, 72]);
    let receivers = Receivers::Camera(camera);
    for counters in [Counters::Words, Counters::Float] {
        let technique = Technique::DepthComplexity(DepthComplexity { passes: 2, ..blended(40, counters) });
        let lights = [light.clone(), lights()[4].clone()];
        let whole = see(&scene, &lights, &receivers, &technique);
        let options = Options {
            memory_limit_bytes: 400_000,
            standard_error: true,
            receivers: true,
            sample_masks: true,
            ..Options::default()
        };
        let parts = visibility(context(), &scene, &lights, &receivers, &technique, &options, &mut |_, _| true).unwrap();
        assert!(whole.info.blocks == 1 && parts.info.blocks > 3, "{} blocks", parts.info.blocks);
        assert_eq!(bits(&whole), bits(&parts));
        let tiles = Technique::DepthComplexity(DepthComplexity { passes: 2, ..tiled(40) });
        let tiles = see(&scene, &lights, &receivers, &tiles);
        let numbers = |seen: &Visibility| -> Vec<u32> {
            seen.values.iter().chain(seen.standard_error.iter().flatten()).map(|v| v.to_bits()).collect()
        };
        assert_eq!(numbers(&whole), numbers(&tiles));
        let texture = LightTexture::new(2, 1, vec![[1.0, 0.0, 0.2], [0.0, 1.0, 0.2]]).unwrap();
        let textured = [light.clone().with_texture(texture).unwrap()];
        let wedges = see(&scene, &textured, &receivers, &Technique::DepthComplexity(blended(64, counters)));
        let tiles = see(&scene, &textured, &receivers, &Technique::DepthComplexity(tiled(64)));
        assert_eq!((wedges.channels, numbers(&wedges)), (3, numbers(&tiles)));
    }
}

#[test]
fn areas_are_left_to_samples_and_that_is_told() {
    let (scene, light, camera) = shipped("cards", [40, 30]);
    let with_area = DepthComplexity { exact_area: true, ..blended(64, Counters::Words) };
    let (wedges, differ, _) = against_tiles(&scene, &light, camera, &with_area);
    assert_eq!((differ, wedges.info.area_receivers), (0, 0));
    let told = |seen: &Visibility| seen.info.notes.iter().any(|note| note.contains("exact_area"));
    assert!(told(&wedges));
    let (plain, ..) = against_tiles(&scene, &light, camera, &blended(64, Counters::Words));
    assert!(!told(&plain));
    assert_eq!(bits(&plain), bits(&wedges));
}

#[test]
fn points_are_refused_with_the_way_out() {
    let light = lamp(rectangle(1.0, 1.0), [0.0, 0.0, 3.0]);
    let technique = Technique::DepthComplexity(blended(16, Counters::Words));
    let receivers = points(vec![[0.0, 0.0, -1.0]]);
    let options = Options::default();
    let refused = visibility(context(), &bodies(), &[light], &receivers, &technique, &options, &mut |_, _| true);
    let words = refused.unwrap_err().to_string();
    assert!(words.contains("evaluation") && words.contains("knows no points") && words.contains("'tiled'"), "{words}");
}

#[test]
fn gl_counts_in_words_and_refuses_what_it_cannot_blend() {
    let Some(gl) = adapters().into_iter().find(|a| a.backend == "gl") else {
        assert!(std::env::var("SOFTSHADOW_EXPECT_ADAPTER").is_err(), "GL is missing");
        println!("skipped 1 test: gl_counts_in_words_and_refuses_what_it_cannot_blend needs a GL adapter");
        return;
    };
    let context = Context::new(&DeviceChoice::Index(gl.index)).unwrap();
    for name in ["cards", "toruses", "hall"] {
        let (scene, light, camera) = shipped(name, [80, 60]);
        let options = Options { sample_masks: true, ..Options::default() };
        let run = |settings: DepthComplexity| {
            let (lights, technique) = (std::slice::from_ref(&light), Technique::DepthComplexity(settings));
            visibility(&context, &scene, lights, &Receivers::Camera(camera), &technique, &options, &mut |_, _| true)
        };
        let tiles = run(tiled(64)).unwrap();
        let wedges = run(blended(64, Counters::Words)).unwrap();
        let (differ, hidden) = differing(&tiles, &wedges, 64);
        assert!(hidden > 20_000, "{name}: {hidden}");
        assert_eq!(differ, 0, "{name}");
        let float = run(blended(64, Counters::Float));
        if gl.features.contains(&"float32-blendable") {
            assert_eq!(differing(&tiles, &float.unwrap(), 64).0, 0, "{name}");
        } else {
            let words = float.unwrap_err().to_string();
            assert!(words.contains("float32-blendable") && words.contains("'words'"), "{words}");
        }
    }
}

#[test]
fn a_bit_that_differs_is_seen() {
    let (scene, light, camera) = shipped("cards", [40, 30]);
    let technique = Technique::DepthComplexity(blended(40, Counters::Words));
    let seen = see(&scene, &[light], &Receivers::Camera(camera), &technique);
    let mut spoilt = seen.clone();
    let words = &mut spoilt.masks.as_mut().unwrap().bits;
    words[2 * 700] ^= 1 << 9;
    // The second word of 40 samples has eight of them.
    words[2 * 700 + 1] ^= 1 << 7 | 1 << 8;
    assert_eq!((differing(&seen, &seen, 40).0, differing(&seen, &spoilt, 40).0), (0, 2));
}

#[test]
fn shadow_volumes_count_nearly_what_rays_count() {
    // Rasterised depth says what lies behind a receiver, and signs say what an edge changes: next to edges they contradict. How often is
    // measured here; that rays do not is measured above.
    let against_rays = |scene: &Scene, light: &Light, camera: Camera| {
        let of = |initial_counts| {
            let settings = DepthComplexity { initial_counts, ..blended(64, Counters::Words) };
            let lights = std::slice::from_ref(light);
            see(scene, lights, &Receivers::Camera(camera), &Technique::DepthComplexity(settings))
        };
        let (rays, volumes) = (of(InitialCounts::Rays), of(InitialCounts::ZFail));
        assert!(volumes.info.plan.contains("count caps") && !volumes.info.plan.contains("find faces"));
        let words = |seen: &Visibility| seen.masks.as_ref().unwrap().bits.clone();
        let pairs = words(&rays).into_iter().zip(words(&volumes)).collect::<Vec<_>>();
        let differ = pairs.chunks(2).filter(|pair| pair.iter().any(|(a, b)| a != b)).count();
        let hidden = pairs.chunks(2).filter(|pair| pair.iter().any(|(a, _)| *a != 0)).count();
        (differ, rays.info.valid_receivers.unwrap_or_default(), hidden)
    };
    let mut total = (0, 0);
    let mut add = |name: &str, (differ, valid, hidden): (usize, usize, usize)| {
        println!("{name}: z-fail differs for {differ} of {valid} receivers, of which {hidden} lose some light");
        assert!(hidden * 12 > valid, "{name} has shadows");
        total = (total.0 + differ, total.1 + valid);
    };
    for name in ["fork", "cards", "toruses", "hall"] {
        let (scene, light, camera) = shipped(name, [240, 180]);
        add(name, against_rays(&scene, &light, camera));
    }
    let ground = scene(&[torus(0.5, 0.2, 24, 12), sphere([0.1, 0.0, 0.6], 0.25, 2), floor(-0.7)].concat());
    let camera = Camera::look_at([0.9, -1.6, 1.0], [0.0, 0.0, -0.4], None, 50.0, [96, 72]).unwrap();
    for light in lights().iter().filter(|light| !matches!(light.shape(), LightShape::Sphere { .. })) {
        add(&format!("{:?}", light.shape()), against_rays(&ground, light, camera));
    }
    println!("{} of {} receivers", total.0, total.1);
    assert!(total.0 * 2000 < total.1, "{} of {}", total.0, total.1);
}

#[test]
fn receivers_beside_their_pixels_are_told() {
    let _driver = on_driver();
    // A camera nearly in the plane of a plate: it covers less than a row of pixels, and rounding of its corners decides which. A receiver
    // that wedges might miss is refused; what is answered has the bits of tiles.
    let light = lamp(rectangle(1.0, 0.6), [0.3, 0.2, 3.0]);
    let thin = scene(&[plate([-1.0, 1.0], [-1.0, 1.0], 0.0), sphere([0.1, 0.0, 0.6], 0.25, 1)].concat());
    let (mut refused, mut answered) = (0, 0);
    for k in 0..60 {
        let height = 0.0004 * 1.13f64.powi(k);
        let camera = Camera::look_at([0.3, -4.0, height], [0.1, 0.0, 0.0], None, 30.0, [65, 33]).unwrap();
        let run = |settings: DepthComplexity| {
            let (lights, technique) = (std::slice::from_ref(&light), Technique::DepthComplexity(settings));
            let options = Options { sample_masks: true, ..Options::default() };
            visibility(context(), &thin, lights, &Receivers::Camera(camera), &technique, &options, &mut |_, _| true)
        };
        match run(blended(64, Counters::Words)) {
            Ok(wedges) => {
                answered += 1;
                assert_eq!(differing(&run(tiled(64)).unwrap(), &wedges, 64).0, 0, "height {height}");
            }
            Err(error) => {
                refused += 1;
                let words = error.to_string();
                assert!(words.contains("middle of their pixels") && words.contains("'tiled'"), "{words}");
            }
        }
    }
    println!("{refused} refused, {answered} answered");
    assert!(refused > 0 && answered > 30, "{refused} refused, {answered} answered");
}
