//! Bytes by resource, counted a second time from what the method needs: nothing here reads a plan to know it.

use std::collections::BTreeMap;

use softshadow_scene::LightShape;
use softshadow_techniques::{ReceiverSource, Request, Shading, Technique};

use crate::requests::{Fixture, techniques};

/// Bytes by label that a plan must have, and no other.
fn counted(technique: &Technique, request: &Request<'_>) -> BTreeMap<String, u64> {
    let mut bytes = BTreeMap::new();
    let mut add = |label: String, n: u64| assert_eq!(bytes.insert(label, n), None);
    let count = request.block.count as u64;
    let sub_scenes = &request.scene.local.sub_scenes;
    let camera = matches!(request.receivers, ReceiverSource::Camera(_));
    let (traced, samples) = match technique {
        Technique::RayTraced(settings) => (Some(settings), u64::from(settings.samples)),
        _ => (None, 64),
    };
    // Rays know their final visibility after the last pass, and only then is a light modulated by it.
    let too_early = traced.is_some() && request.wants.picture == Some(Shading::Modulated) && !request.closes_light;
    let picture = request.wants.picture.is_some() && !too_early;

    // Four words, and a receiver with the ends of its walk for each that may need rays; `layouts.rs` compares with the kernels.
    let list = 16 + 12 * count;

    add("receivers".into(), count * 32);
    if request.opens_block && camera {
        let [width, height] = match request.receivers {
            ReceiverSource::Camera(camera) => camera.size().map(u64::from),
            ReceiverSource::Points(_) => [0; 2],
        };
        add("triangle ids".into(), width * height * 4);
        add("camera rays".into(), 64);
        (0..sub_scenes.len()).for_each(|n| add(format!("sub-scene {n}"), 8));
        if request.opens_run {
            add("camera depth".into(), width * height * 4);
            add("camera clip".into(), 64);
        }
    }
    if request.opens_block && !camera {
        add("points".into(), count * 32);
        add("point range".into(), 4);
    }
    for (n, sub_scene) in sub_scenes.iter().enumerate() {
        let triangles = sub_scene.corners.len() as u64 / 3;
        add(format!("corners {n}"), triangles * 48);
        if traced.is_some() {
            add(format!("hierarchy {n}"), sub_scene.nodes.len() as u64 * 32);
        }
    }
    add("light".into(), 80);
    add("visibility".into(), count * 4 * u64::from(request.channels));
    match technique {
        Technique::RayTraced(settings) => {
            add("blocked samples".into(), count * samples.div_ceil(32) * 4);
            add("decided samples".into(), count * 4);
            add("standard error".into(), count * 4 * u64::from(request.channels));
            for n in 0..sub_scenes.len() {
                for found in ["gathered", "candidates"] {
                    add(format!("{found} {n}"), list);
                }
                add(format!("gather range {n}"), 16);
                for round in if settings.probes > 0 { &["narrow", "probe", "trace"][..] } else { &["narrow", "trace"] }
                {
                    add(format!("{round} range {n}"), 16);
                    add(format!("{round} dispatch {n}"), 12);
                }
                add(format!("trace counts {n}"), 16);
            }
            if settings.probes > 0 && !sub_scenes.is_empty() {
                add("probe image".into(), 8);
            }
        }
        Technique::HardShadowMap(settings) => {
            // One view, or the faces of a cube for a light within the scene; the texture is always an array.
            let inside = !matches!(request.light.shape(), LightShape::Sun { .. })
                && request.light.local(&request.scene.local.frame).center.length() < 1.0;
            let views = match (sub_scenes.is_empty(), inside) {
                (true, _) => 0,
                (false, true) => 6,
                (false, false) => 1,
            };
            add("depth map".into(), u64::from(settings.resolution).pow(2) * 4 * views.max(2));
            (0..views).for_each(|n| add(format!("shadow view {n}"), 64));
            add("shadow views".into(), 6 * 64 + 16);
        }
        _ => panic!("count the bytes of '{}' here", technique.name()),
    }
    if traced.is_some() || picture {
        add("sampling".into(), 32);
        add("light samples".into(), samples * 16);
    }
    if picture || traced.is_some() && request.channels == 3 {
        add("sample radiance".into(), samples * 16);
    }
    if picture {
        add("shading".into(), 32);
        add("triangle materials".into(), request.scene.local.triangle_count() as u64 * 4);
        add("materials".into(), request.scene.local.materials.len().max(1) as u64 * 32);
        add("color".into(), count * 16);
    }
    bytes
}

#[test]
fn bytes_are_exact_over_the_whole_grid() {
    let fixture = Fixture::new();
    for technique in techniques() {
        for request in fixture.requests() {
            let plan = technique.plan(&request);
            let given: BTreeMap<String, u64> = plan.memory().into_iter().map(|(l, b)| (l.to_owned(), b)).collect();
            assert_eq!(given, counted(&technique, &request), "{technique:?}\n{plan}");
        }
    }
}

#[test]
fn a_block_is_sized_by_what_a_receiver_takes() {
    // The front door divides its memory limit by this number: it must be what grows with the receivers.
    let fixture = Fixture::new();
    for technique in techniques() {
        for (scene, channels) in [(0, 1), (0, 3), (1, 1), (1, 3), (2, 1), (2, 3)] {
            let request = Request { channels, ..fixture.request(scene, fixture.points()) };
            let total = |count: usize| {
                let mut request = request;
                request.block.count = count;
                technique.plan(&request).memory().iter().map(|(_, bytes)| bytes).sum::<u64>()
            };
            // Bits of samples and how many are decided; both lists of each sub-scene; values and their errors.
            let expected = match &technique {
                Technique::RayTraced(settings) => {
                    let words = u64::from(settings.samples.div_ceil(32));
                    4 * words + 4 + 24 * scene as u64 + 8 * u64::from(channels)
                }
                _ => 4 * u64::from(channels),
            };
            let sub_scenes = request.scene.local.sub_scenes.len() as u64;
            assert_eq!(sub_scenes, scene as u64);
            assert_eq!(technique.bytes_per_receiver(u64::from(channels), sub_scenes), expected, "{technique:?}");
            // The receiver and its point take 32 bytes each.
            assert_eq!(total(5) - total(1), 4 * (64 + expected), "{technique:?} in {sub_scenes} sub-scenes");
            let one_more = technique.bytes_per_receiver(u64::from(channels), sub_scenes + 1);
            assert_eq!(one_more - expected, if matches!(technique, Technique::RayTraced(_)) { 24 } else { 0 });
        }
    }
}

#[test]
fn another_request_has_other_bytes() {
    let fixture = Fixture::new();
    for technique in techniques() {
        let request = fixture.request(1, fixture.points());
        let mut one_less = request;
        one_less.block.count -= 1;
        assert_ne!(counted(&technique, &request), counted(&technique, &one_less));
        let mut shaded = request;
        shaded.wants.picture = Some(Shading::Integrated);
        assert_ne!(counted(&technique, &request), counted(&technique, &shaded));
    }
}
