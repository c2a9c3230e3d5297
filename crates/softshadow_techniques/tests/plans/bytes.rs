//! Bytes by resource, counted a second time from what the method needs: nothing here reads a plan to know it.

use std::collections::BTreeMap;

use softshadow_plan::{Over, Work, check};
use softshadow_scene::{LightFrame, LightShape, LocalScene, Material, Mesh, SampleSpread, Scene};
use softshadow_techniques::depth_complexity::OccluderUnit;
use softshadow_techniques::occlusion_layers::{Filter, Near};
use softshadow_techniques::parts::occluder_buffers::boundary_of;
use softshadow_techniques::{
    DepthComplexity, HardShadowMap, OccluderContents, OcclusionLayers, PenumbraMap, ReceiverSource, Request,
    SceneContents, Shading, Technique,
};

use crate::requests::{Fixture, POINTS, stage, techniques};

/// Faces, edges, and faces at edges that hide the light: of every sheet in front of it two triangles, whose five sides share one.
fn hidden_by(request: &Request<'_>) -> [u64; 3] {
    let height = request.light.local(&request.scene.local.frame).center.z as f32;
    let has_front = matches!(request.light.shape(), LightShape::Rectangle { .. });
    let is_in_front = |triangle: &[[f32; 3]; 3]| !has_front || triangle.iter().all(|corner| corner[2] < height);
    let faces = request.scene.local.triangles().filter(is_in_front).count() as u64 - touching(request);
    [faces, faces / 2 * 5, faces * 3]
}

/// Triangles that touch a ball of light: sheets are level, and as near to its centre as it is large.
fn touching(request: &Request<'_>) -> u64 {
    let place = request.light.local(&request.scene.local.frame);
    let LightShape::Sphere { radius } = request.light.shape() else { return 0 };
    let touches =
        |t: &[[f32; 3]; 3]| t.iter().all(|v| (f64::from(v[2]) - place.center.z).abs() < radius * place.length_scale);
    request.scene.local.triangles().filter(touches).count() as u64
}

/// Whether anything semi-opaque hides the light.
fn is_attenuated(request: &Request<'_>) -> bool {
    let local = &request.scene.local;
    let glass = |corner: &[f32; 3]| corner[2] > 0.0;
    let has_glass = local.triangles().enumerate().any(|(n, t)| local.opacity(n) < 1.0 && t.iter().all(glass));
    // The rectangle within the scene looks down from between the sheets, and glass is the upper one.
    let looks_up_to_it = hidden_by(request)[0] == local.triangle_count() as u64;
    has_glass && looks_up_to_it
}

/// Who shares samples, and the side of the square that interleaves.
fn spread(technique: &Technique) -> (SampleSpread, u64) {
    match technique {
        Technique::RayTraced(settings) => (settings.spread, u64::from(settings.tile)),
        Technique::DepthComplexity(settings) => (settings.spread, u64::from(settings.tile)),
        _ => (SampleSpread::Correlated, 1),
    }
}

/// Bytes of a receiver's values before they are averaged.
fn noisy(technique: &Technique) -> u64 {
    if spread(technique).0 == SampleSpread::Interleaved { 16 } else { 0 }
}

/// Views of a light's maps: one, or the faces of a cube for a light within the scene.
fn views(request: &Request<'_>) -> u64 {
    let inside = !matches!(request.light.shape(), LightShape::Sun { .. })
        && request.light.local(&request.scene.local.frame).center.length() < 1.0;
    match (request.scene.local.sub_scenes.is_empty(), inside) {
        (true, _) => 0,
        (false, true) => 6,
        (false, false) => 1,
    }
}

/// Layers of a light's depth map: never one nor six, which are no arrays on GL.
fn map_layers(views: u64) -> u64 {
    if views == 6 { 7 } else { 2 }
}

/// Bytes by label that a plan must have, and no other.
fn counted(technique: &Technique, request: &Request<'_>) -> BTreeMap<String, u64> {
    let mut bytes = BTreeMap::new();
    let mut add = |label: String, n: u64| assert_eq!(bytes.insert(label, n), None);
    let count = request.block.count as u64;
    let sub_scenes = &request.scene.local.sub_scenes;
    let camera = matches!(request.receivers, ReceiverSource::Camera(_));
    let sampled = match technique {
        Technique::RayTraced(settings) => Some(u64::from(settings.samples)),
        Technique::DepthComplexity(settings) => Some(u64::from(settings.samples)),
        _ => None,
    };
    let samples = sampled.unwrap_or(64);
    // Samples of all sets: a square of pixels has one each; as many as 8,192 samples are, or 256.
    let (spread, tile) = spread(technique);
    let sets = match spread {
        SampleSpread::Correlated => 1,
        SampleSpread::Decorrelated => (8192 / samples).min(256),
        SampleSpread::Interleaved => tile * tile,
    };
    let interleaves = spread == SampleSpread::Interleaved;
    // Samples know their final visibility after the last pass, and only then is a light modulated by it.
    let too_early = sampled.is_some() && request.wants.picture == Some(Shading::Modulated) && !request.closes_light;
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
    // The occlusion camera draws nothing where nothing has a silhouette.
    let is_bare = matches!(technique, Technique::OcclusionCamera(_)) && hidden_by(request)[1] == 0;
    for (n, sub_scene) in sub_scenes.iter().enumerate() {
        // Silhouettes need no corners, and layers none once they are made: then they are there for the camera alone.
        let has_all = match technique {
            Technique::OcclusionLayers(settings) => request.opens_run || settings.near == Near::Rays,
            _ => !technique.wants_occluders() || technique.draws() && !is_bare,
        };
        if has_all || request.opens_block && camera {
            add(format!("corners {n}"), sub_scene.corners.len() as u64 / 3 * 48);
        }
        let traces_near = matches!(technique, Technique::OcclusionLayers(settings) if settings.near == Near::Rays);
        if traces_near || matches!(technique, Technique::RayTraced(_)) {
            add(format!("hierarchy {n}"), sub_scene.nodes.len() as u64 * 32);
        }
    }
    add("light".into(), 80);
    add("visibility".into(), count * 4 * u64::from(request.channels));
    match technique {
        Technique::RayTraced(settings) => {
            if request.scene.opacity.is_some() {
                add("triangle transmittance".into(), request.scene.local.triangle_count() as u64 * 4);
                add("sample transmittance".into(), count * samples * 4);
            }
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
        Technique::HardShadowMap(HardShadowMap { resolution })
        | Technique::PenumbraMap(PenumbraMap { resolution, .. }) => {
            let views = views(request);
            let map = u64::from(*resolution).pow(2) * 4 * map_layers(views);
            if views > 0 || matches!(technique, Technique::HardShadowMap(_)) {
                add("depth map".into(), map);
            }
            (0..views).for_each(|n| add(format!("shadow view {n}"), 64));
            add("shadow views".into(), 6 * 64 + 16);
            let [_, edges, sides] = hidden_by(request);
            if matches!(technique, Technique::PenumbraMap(_)) && edges > 0 {
                add("penumbra map".into(), map);
                (0..views).for_each(|n| add(format!("map layer {n}"), 16));
                // Axes, sizes, and 64 corners with a line each.
                add("penumbra light".into(), 4 * 16 + 64 * 16);
                add("edges".into(), edges * 32);
                add("faces at edges".into(), sides * 32);
                add("edge corners".into(), 16);
                add("light silhouettes".into(), edges * 32);
                add("silhouette corners".into(), 16);
                add("receivers astray".into(), 4);
            }
        }
        Technique::OcclusionCamera(settings) => {
            let [_, edges, sides] = hidden_by(request);
            // Three ways or half sizes, and 64 corners of a polygon.
            add("camera light".into(), 80 + 64 * 8);
            add("shadow views".into(), 6 * 64 + 16);
            if edges > 0 {
                let (texels, views) = (u64::from(settings.resolution).pow(2), views(request));
                add("depth map".into(), texels * 4 * map_layers(views));
                // Eight floats a texel, on either side of the hard shadow's border.
                add("distortion map".into(), texels / 16 * 2 * 32 * views);
                add("distance to silhouettes".into(), texels / 16 * 4);
                for n in 0..views {
                    add(format!("shadow view {n}"), 64);
                    add(format!("map layer {n}"), 16);
                }
                add("edges".into(), edges * 32);
                add("faces at edges".into(), sides * 32);
                add("edge corners".into(), 16);
                add("light silhouettes".into(), edges * 32);
                add("silhouette corners".into(), 16);
                add("camera counts".into(), 16);
            }
        }
        Technique::DepthComplexity(settings) => {
            let ([faces, edges, sides], tiles) = (hidden_by(request), count.div_ceil(64));
            add("light frame".into(), 128);
            let moves = matches!(request.light.shape(), LightShape::Sphere { .. });
            let shared = spread == SampleSpread::Correlated && !moves;
            if shared {
                add("frame samples".into(), 256 * 16);
            } else {
                // The largest uniform that core WebGPU has.
                add("sample sets".into(), 65_536);
            }
            add("receiver order".into(), count * 4);
            add("slots".into(), tiles * 64 * 16);
            add("blocked samples".into(), count * samples.div_ceil(32) * 4);
            add("decided samples".into(), count * 4);
            add("standard error".into(), count * 4 * u64::from(request.channels));
            if touching(request) > 0 {
                add("touching triangles".into(), touching(request) * 3 * 16);
                add("touching range 0".into(), 16);
            }
            if edges > 0 {
                // A face: its plane, its triangle, how flat it is, and four sides. An edge: two ends and its faces.
                add("faces".into(), faces * 48);
                add("edges".into(), edges * 32);
                // So few faces have a leaf each.
                add("face hierarchy".into(), (2 * faces - 1) * 32);
                add("running counts".into(), 32);
                add("list counts".into(), 32);
                add("faces at edges".into(), sides * 32);
                add("cluster range".into(), 16);
                add("clusters".into(), edges.div_ceil(32) * 32);
                add("groups of clusters".into(), edges.div_ceil(32 * 32) * 32);
                // Two parts a tile, each five planes and a box, and eight bundles; ten words each for where its lists begin, and 128 chunks
                // of 32 words.
                add("tile parts".into(), tiles * 2 * (5 * 16 + 32));
                add("first faces".into(), tiles * 2 * 8 * 4);
                add("edge lists".into(), tiles * (2 * 40 + 128 * 128) + 65_536 * 128);
                add("narrow dispatch".into(), 12);
                add("fold dispatch".into(), 12);
                for group in 0..samples.div_ceil(64) {
                    add(format!("fold settings {group}"), 16);
                    if shared {
                        add(format!("group samples {group}"), 64 * 16);
                        // The largest uniform that core WebGPU has.
                        add(format!("coverage table {group}"), 65_536);
                    }
                }
                let outline = LightFrame::new(request.light, &request.scene.local.frame).outline;
                if is_attenuated(request) {
                    add("attenuation scale".into(), 8);
                    add("triangle attenuation".into(), request.scene.local.triangle_count() as u64 * 4);
                    add("sample transmittance".into(), count * samples * 4);
                } else if settings.exact_area && request.channels == 1 && outline.is_some() {
                    add("visible areas".into(), count * 4);
                    add("light outline".into(), 64 * 16);
                }
            }
        }
        Technique::OcclusionLayers(settings) => {
            let (slices, resolution) = (u64::from(settings.slices), u64::from(settings.resolution));
            add("layer frame".into(), 80);
            // Boxes and weights of at most 64 parts, the whole light, and four words.
            add("light parts".into(), 2 * 64 * 16 + 16 + 16);
            add("layer places".into(), 32 + 128 * 4);
            let has_casters = !sub_scenes.is_empty();
            // A sum before every texel and behind the last; or squares of 2^n texels, four slices a word: one at every 2^n-th texel, or
            // every one that holds any.
            let levels = u64::from(settings.resolution.ilog2());
            let squares =
                |side: &dyn Fn(u64) -> u64| (0..=levels).map(|n| side(n).pow(2)).sum::<u64>() * 4 * slices.div_ceil(4);
            let table = match settings.filter {
                Filter::SummedArea => slices * (resolution + 1) * (resolution + 1) * 4,
                Filter::Nbuffer => squares(&|n| resolution - 1 + 2u64.pow(n as u32)),
                Filter::Mipmap => squares(&|n| resolution / 2u64.pow(n as u32)),
            };
            add("layer tables".into(), if has_casters { table } else { 4 });
            if has_casters && request.opens_run {
                add("caster range".into(), 128);
                add("caster bounds".into(), 48);
                // A bit a texel; a count a word.
                add("slice bits".into(), slices * resolution * resolution / 8);
                if settings.filter == Filter::SummedArea {
                    add("words before".into(), slices * resolution * resolution / 8);
                } else {
                    (1..=levels).for_each(|n| add(format!("level range {n}"), 16));
                }
                for (n, sub_scene) in sub_scenes.iter().enumerate() {
                    add(format!("tall triangles {n}"), 16 + sub_scene.corners.len() as u64 / 3 * 4);
                    add(format!("row dispatch {n}"), 12);
                }
            }
            if has_casters && settings.near == Near::Rays {
                add("near blocked".into(), count * 8);
                add("near counts".into(), 8);
            }
        }
        _ => panic!("count the bytes of '{}' here", technique.name()),
    }
    if sampled.is_some() || picture {
        add("sampling".into(), 32);
        add("light samples".into(), sets * samples * 16);
    }
    if picture || sampled.is_some() && request.channels == 3 {
        add("sample radiance".into(), sets * samples * 16);
    }
    if picture {
        add("shading".into(), 32);
        add("triangle materials".into(), request.scene.local.triangle_count() as u64 * 4);
        add("materials".into(), request.scene.local.materials.len().max(1) as u64 * 32);
        let is_averaged = interleaves && request.wants.picture == Some(Shading::Integrated);
        if is_averaged {
            add("noisy color".into(), count * 16);
        }
        if request.closes_block || !is_averaged {
            add("color".into(), count * 16);
        }
    }
    if interleaves {
        add("values of a pass".into(), count * 16);
        add("interleaving".into(), 32);
    }
    bytes
}

#[test]
fn bytes_are_exact_over_the_whole_grid() {
    let fixture = Fixture::new();
    for technique in techniques() {
        for request in fixture.requests(&technique) {
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
    for technique in techniques().iter().filter(|t| !t.wants_occluders()) {
        for (scene, channels) in [(0, 1), (0, 3), (1, 1), (1, 3), (2, 1), (2, 3)] {
            let request = Request { channels, ..fixture.request(scene, fixture.points()) };
            let total = |count: usize| {
                let mut request = request;
                request.block.count = count;
                technique.plan(&request).memory().iter().map(|(_, bytes)| bytes).sum::<u64>()
            };
            // Bits of samples and how many are decided; both lists of each sub-scene; values and their errors.
            let expected = match technique {
                Technique::RayTraced(settings) => {
                    let words = u64::from(settings.samples.div_ceil(32));
                    4 * words + 4 + 24 * scene as u64 + 8 * u64::from(channels) + noisy(technique)
                }
                Technique::OcclusionLayers(OcclusionLayers { near: Near::Rays, .. }) => 4 * u64::from(channels) + 8,
                _ => 4 * u64::from(channels),
            };
            // Without casters there is nothing near, either.
            let spared = if scene == 0 && !matches!(technique, Technique::RayTraced(_)) {
                expected - 4 * u64::from(channels)
            } else {
                0
            };
            let sub_scenes = request.scene.local.sub_scenes.len() as u64;
            assert_eq!(sub_scenes, scene as u64);
            assert_eq!(technique.bytes_per_receiver(u64::from(channels), sub_scenes, false), expected, "{technique:?}");
            // The receiver and its point take 32 bytes each.
            assert_eq!(total(5) - total(1), 4 * (64 + expected - spared), "{technique:?} in {sub_scenes} sub-scenes");
            let one_more = technique.bytes_per_receiver(u64::from(channels), sub_scenes + 1, false);
            assert_eq!(one_more - expected, if matches!(technique, Technique::RayTraced(_)) { 24 } else { 0 });
        }
    }
}

#[test]
fn a_block_in_tiles_is_sized_by_no_less_than_a_receiver_takes() {
    let fixture = Fixture::new();
    for technique in techniques() {
        let Technique::DepthComplexity(settings) = &technique else { continue };
        let words = u64::from(settings.samples.div_ceil(32));
        for (scene, channels) in [(0, 1), (0, 3), (1, 1), (1, 3), (2, 1), (2, 3)] {
            let request = Request { channels, ..fixture.request(scene, fixture.points()) };
            let total = |count: u64| {
                let mut request = request;
                request.block.count = count as usize;
                technique.plan(&request).memory().iter().map(|(_, bytes)| bytes).sum::<u64>()
            };
            // Its place in the order, its slot, its bits, how many are decided, and values with their errors; the receiver and its point.
            let alone = 4 + 16 + 4 * words + 4 + 8 * u64::from(channels) + 64 + noisy(&technique);
            // Where there are edges an area, and what 64 receivers share.
            let area = if channels == 1 && settings.exact_area { 4 } else { 0 };
            let [with_area, tile] =
                if scene == 0 { [alone, 0] } else { [alone + area, 2 * (112 + 8 * 4 + 40) + 128 * 128] };
            assert_eq!(total(65 * 64) - total(64), 64 * (64 * with_area + tile), "{technique:?} in scene {scene}");
            // A tile that is not full has its slots and lists all the same.
            assert_eq!(total(65) - total(64), 63 * 16 + with_area + tile);
            assert_eq!(total(64) - total(2), 62 * (with_area - 16));

            let sub_scenes = request.scene.local.sub_scenes.len() as u64;
            let estimate = technique.bytes_per_receiver(u64::from(channels), sub_scenes, false);
            assert_eq!(estimate, alone - 64 + area + 262, "262 is a 64th of what a tile takes, rounded up");
            assert_eq!(estimate, technique.bytes_per_receiver(u64::from(channels), sub_scenes + 1, false));
            for count in [64 * 64, 100_000, 1_000_003] {
                let (fixed, taken) = (total(64) - 64 * with_area - tile, total(count));
                assert!(taken - fixed <= count * (64 + estimate) + 64 * 16 + tile, "{count} receivers, {technique:?}");
                // And not so much more that blocks would be small for nothing.
                assert!(scene == 0 || taken >= count * (64 + estimate - 1), "{count} receivers, {technique:?}");
            }
        }
    }
}

#[test]
fn clusters_of_edges_are_as_many_as_edges_need() {
    // Triangles apart from each other: three edges each, so that clusters and groups of them are counted beyond the first.
    for (triangles, clusters, groups) in [(10, 1, 1), (11, 2, 1), (341, 32, 1), (342, 33, 2), (683, 65, 3)] {
        let positions: Vec<[f64; 3]> = (0..triangles)
            .flat_map(|n| [[0.0, 0.0], [0.5, 0.0], [0.0, 0.5]].map(|[x, y]| [f64::from(n) + x, y, 0.0]))
            .collect();
        let faces = (0..triangles).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
        let mesh = Mesh::new("leaves", positions, faces, Material::default()).unwrap();
        let scene = SceneContents::new(LocalScene::new(&Scene::new(vec![mesh]).unwrap(), None, 1 << 20));
        let fixture = Fixture::new();
        let occluders = OccluderContents::new(&scene.local, boundary_of(&scene.local, &fixture.lights[3])).unwrap();
        let request = Request {
            scene: &scene,
            light: &fixture.lights[3],
            occluders: Some(&occluders),
            ..fixture.request(1, fixture.points())
        };
        let (plan, values) = stage(
            &Technique::DepthComplexity(DepthComplexity { unit: OccluderUnit::Edges, ..DepthComplexity::default() }),
            &request,
        );
        let bytes: BTreeMap<&str, u64> = plan.memory().into_iter().collect();
        let edges = 3 * u64::from(triangles);
        let labels = ["faces", "edges", "faces at edges", "clusters", "groups of clusters"];
        let expected = [u64::from(triangles) * 48, edges * 32, edges * 32, clusters * 32, groups * 32];
        assert_eq!(labels.map(|label| bytes[label]), expected, "{triangles} triangles");
        let range: Vec<u32> =
            values["cluster range"].chunks_exact(4).map(|w| u32::from_le_bytes(w.try_into().unwrap())).collect();
        assert_eq!(range, [edges as u32, clusters as u32, 1, POINTS as u32]);
        let labels =
            ["find silhouettes", "bound clusters", "bound tiles", "cull edges", "list faces", "count reference depth"];
        let invocations = labels.map(|label| match plan.passes.iter().find(|p| p.label == label).unwrap().work {
            Work::Compute { over: Over::Items { count, .. }, .. } => u64::from(count),
            _ => panic!("'{label}' runs over items"),
        });
        // The last two take 32 groups of 64 in strides.
        assert_eq!(invocations, [clusters, groups, 1, 2, 2048, 2048]);
        check(&plan, &request.host).unwrap();
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

#[test]
fn what_passes_to_samples_is_sized_where_triangles_are_semi_opaque() {
    let fixture = Fixture::new();
    for technique in techniques() {
        let of = |is_semi_opaque| technique.bytes_per_receiver(1, 2, is_semi_opaque);
        let total = |scene: usize, count: usize| {
            let mut request = fixture.request(scene, fixture.points());
            request.block.count = count;
            technique.plan(&request).memory().iter().map(|(_, bytes)| bytes).sum::<u64>()
        };
        // Full tiles: a tile that is not has its slots and lists all the same.
        let grown = |scene| (total(scene, 65 * 64) - total(scene, 64)) / (64 * 64);
        // No area is needed under glass; but another light of the call may have none before it.
        let area = match &technique {
            Technique::DepthComplexity(settings) if settings.exact_area => 4,
            _ => 0,
        };
        assert_eq!(of(true) - of(false) + grown(2), grown(3) + area, "{technique:?}");
        let is_sampled = matches!(technique, Technique::RayTraced(_) | Technique::DepthComplexity(_));
        let samples = if is_sampled { u64::from(technique.samples()) } else { 0 };
        assert_eq!(of(true) - of(false), 4 * samples);
    }
}
