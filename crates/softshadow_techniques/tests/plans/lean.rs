//! What nobody asked for costs no pass and no byte; and equal requests make equal plans.

use std::collections::BTreeSet;

use softshadow_plan::{Origin, Over, Plan, VertexSource, Work};
use softshadow_scene::{Camera, Light, LightShape};
use softshadow_techniques::occlusion_layers::Near;
use softshadow_techniques::{
    DepthComplexity, HardShadowMap, OcclusionCamera, OcclusionLayers, PenumbraMap, RayTraced, ReceiverSource, Request,
    Shading, Technique, Wants,
};

use crate::requests::{Fixture, SIZE, stage, techniques};

fn traced(probes: u32) -> Technique {
    Technique::RayTraced(RayTraced { probes, ..RayTraced::default() })
}

fn silhouettes(exact_area: bool) -> Technique {
    Technique::DepthComplexity(DepthComplexity { exact_area, ..DepthComplexity::default() })
}

/// The passes that find the receivers with a triangle between them and the light: by boxes, then by triangles.
const FOUND: &[&str] = &["no gathered 0", "gather 0", "size narrow 0", "no candidates 0", "narrow 0"];
/// Those that trace, tell what was traced, and turn bits into values.
const TRACED: &[&str] = &["size trace 0", "trace 0", "report 0", "resolve"];

/// From edges to masks: which can be silhouettes at all, which lie before a tile, and what they add up to.
const FOLDED: &[&str] = &[
    "no counts",
    "bound tiles",
    "find faces",
    "list faces",
    "count reference depth",
    "find silhouettes",
    "bound clusters",
    "cull edges",
    "size fold",
    "narrow edges",
    "fold edges 0",
    "report counts",
];

fn labels(plan: &Plan) -> Vec<&str> {
    plan.passes.iter().map(|p| p.label.as_str()).collect()
}

fn outputs(plan: &Plan) -> Vec<&str> {
    plan.outputs.iter().map(|id| plan.resources[id.index()].label.as_str()).collect()
}

fn rasters(plan: &Plan) -> usize {
    plan.passes.iter().filter(|p| matches!(p.work, Work::Raster(_))).count()
}

#[test]
fn the_plainest_ray_traced_request_probes_and_shades_nothing() {
    let fixture = Fixture::new();
    let request = fixture.request(1, fixture.points());
    let plan = traced(0).plan(&request);
    assert_eq!(labels(&plan), [&["place points", "open masks"], FOUND, TRACED].concat());
    assert_eq!(outputs(&plan), ["trace counts 0", "visibility", "receivers"]);
    assert_eq!(plan.find("sample radiance"), None);
    // Each of these asks for one thing more, and gets it.
    let textured = traced(0).plan(&Request { channels: 3, ..request });
    assert!(textured.find("sample radiance").is_some());
    let mut wants = request.wants;
    wants.picture = Some(Shading::Integrated);
    assert_eq!(labels(&traced(0).plan(&Request { wants, ..request })).last(), Some(&"shade"));
    assert!(labels(&traced(4).plan(&request)).contains(&"choose"));
    let two = traced(0).plan(&fixture.request(2, fixture.points()));
    for word in ["gather ", "narrow ", "trace ", "report "] {
        let count = |plan: &Plan| labels(plan).iter().filter(|l| l.starts_with(word)).count();
        assert_eq!((count(&plan), count(&two)), (1, 2), "{word}: one a sub-scene");
    }
    assert_eq!(outputs(&two), ["trace counts 0", "trace counts 1", "visibility", "receivers"]);
}

#[test]
fn the_plainest_hard_shadow_has_three_passes() {
    let fixture = Fixture::new();
    let request = fixture.request(1, fixture.points());
    let technique = Technique::HardShadowMap(HardShadowMap::default());
    let plan = technique.plan(&request);
    assert_eq!(labels(&plan), ["place points", "draw depth 0 0", "look up"]);
    for label in ["sampling", "light samples", "sample radiance", "materials", "color"] {
        assert_eq!(plan.find(label), None, "{label}");
    }
    let Work::Raster(raster) = &plan.passes[1].work else { panic!("'draw depth 0 0' draws") };
    assert_eq!(raster.kernel.fragment, Some("write_depth"), "depth is written from the distance");
    assert!(raster.colors.is_empty() && raster.depth.is_some());
    let within = technique.plan(&Request { light: &fixture.lights[1], ..request });
    assert_eq!(rasters(&within), 6, "a light within the scene looks six ways");
}

#[test]
fn a_penumbra_map_has_the_passes_that_its_light_needs() {
    let fixture = Fixture::new();
    let request = fixture.request(1, fixture.points());
    let technique = Technique::PenumbraMap(PenumbraMap::default());
    let plan = technique.plan(&request);
    let map = ["no silhouettes", "list silhouettes", "draw penumbra 0", "no strays"];
    assert_eq!(labels(&plan), [&["place points", "draw depth 0 0"], &map[..], &["look up"]].concat());
    assert_eq!(outputs(&plan), ["receivers astray", "visibility", "receivers"]);
    for label in ["sampling", "light samples", "materials", "color", "hierarchy 0", "faces", "face hierarchy"] {
        assert_eq!(plan.find(label), None, "{label}");
    }
    let within = technique.plan(&Request { light: &fixture.lights[1], ..request });
    assert_eq!(rasters(&within), 12, "a light within the scene looks six ways, with a pair of maps each");
    // Without size no penumbra, without casters no map.
    let shape = LightShape::Rectangle { width: 0.0, height: 0.0 };
    let point = Light::new(shape, request.light.world_from_light()).unwrap();
    let hard = technique.plan(&Request { light: &point, ..request });
    assert_eq!(labels(&hard), ["place points", "draw depth 0 0", "look up"]);
    assert_eq!(hard.find("penumbra map"), None);
    let empty = technique.plan(&fixture.request(0, fixture.points()));
    assert_eq!(labels(&empty), ["place points", "see all"]);
    assert_eq!(empty.find("depth map"), None);
}

#[test]
fn the_occlusion_camera_draws_maps_where_there_are_casters_alone() {
    let fixture = Fixture::new();
    let technique = Technique::OcclusionCamera(OcclusionCamera::default());
    let request = fixture.request(1, fixture.points());
    let plan = technique.plan(&request);
    let expected = [
        "place points",
        "draw depth 0 0",
        "no silhouettes",
        "list silhouettes",
        "draw distortion 0 outside",
        "draw distortion 0 inside",
        "no receivers",
        "look up",
    ];
    assert_eq!(labels(&plan), expected);
    assert_eq!(outputs(&plan), ["camera counts", "visibility", "receivers"]);
    let within = technique.plan(&Request { light: &fixture.lights[1], ..request });
    assert_eq!(rasters(&within), 6 * 3, "a light within the scene looks six ways");
    let nothing = technique.plan(&fixture.request(0, fixture.points()));
    assert_eq!(labels(&nothing), ["place points", "look up"]);
    for label in ["depth map", "distortion map", "camera counts", "light silhouettes"] {
        assert!(plan.find(label).is_some() && nothing.find(label).is_none(), "{label}");
    }
    // Two targets of four floats are all that core WebGPU promises of a pixel.
    for pass in &plan.passes {
        if let Work::Raster(raster) = &pass.work {
            let bytes =
                raster.colors.iter().map(|c| plan.resources[c.texture.index()].shape.texel_bytes()).sum::<u64>();
            assert!(bytes <= 32, "{}: {bytes}", pass.label);
        }
    }
}

#[test]
fn layers_are_made_once_a_call_and_looked_up_by_every_block() {
    let fixture = Fixture::new();
    let fade = OcclusionLayers { near: Near::Fade, ..OcclusionLayers::default() };
    let technique = Technique::OcclusionLayers(fade);
    let request = fixture.request(1, fixture.points());
    let plan = technique.plan(&request);
    let made = [
        "no casters",
        "bound casters 0",
        "place planes",
        "empty slices",
        "no tall triangles 0",
        "slice triangles 0",
        "size rows 0",
        "slice rows 0",
        "count words",
        "sum columns",
    ];
    assert_eq!(labels(&plan), [&["place points"], &made[..], &["look up"]].concat());
    assert_eq!(outputs(&plan), ["caster bounds", "visibility", "receivers"]);
    assert_eq!((rasters(&plan), plan.find("hierarchy 0")), (0, None));
    for label in ["sampling", "light samples", "sample radiance", "materials", "color", "near blocked"] {
        assert_eq!(plan.find(label), None, "{label}");
    }
    // The same light for the next block: what is there is looked up.
    let next = Request { opens_run: false, ..request };
    assert_eq!(labels(&technique.plan(&next)), ["place points", "look up"]);
    // Another light has been there in between.
    let several = Request { only_light: false, ..next };
    assert_eq!(labels(&technique.plan(&several)), labels(&plan));
    // Without casters there is nothing to slice and nothing near.
    let near = Technique::OcclusionLayers(OcclusionLayers::default());
    assert_eq!(labels(&near.plan(&fixture.request(0, fixture.points()))), ["place points", "look up"]);
    let with_rays = near.plan(&request);
    let added: Vec<&str> = labels(&with_rays).into_iter().filter(|l| !labels(&plan).contains(l)).collect();
    assert_eq!(added, ["nothing near", "no near rays", "trace near 0"]);
}

#[test]
fn layers_that_a_device_cannot_hold_are_refused_with_how_many_it_can() {
    let fixture = Fixture::new();
    let host = softshadow_plan::Host::default();
    for (slices, resolution, words) in
        [(31, 1024, None), (32, 1024, Some("at most 31 slices")), (8, 2048, Some("at most 7"))]
    {
        let technique =
            Technique::OcclusionLayers(OcclusionLayers { slices, resolution, ..OcclusionLayers::default() });
        assert_eq!(technique.check(), Ok(()));
        let refused = technique.check_call(fixture.points(), &fixture.lights, &host).err().map(|e| e.to_string());
        match words {
            None => assert_eq!(refused, None),
            Some(words) => assert!(refused.as_ref().is_some_and(|text| text.contains(words)), "{refused:?}"),
        }
    }
    // A sphere among the receivers is refused, and told so for whichever light of a call it is.
    let technique = Technique::OcclusionLayers(OcclusionLayers::default());
    let lamp = fixture.request_for(1, fixture.camera(), 5);
    let error = technique.values(&lamp, lamp.light, 0).unwrap_err().to_string();
    assert!(error.contains("occlusion_layers light") && error.contains("trace rays"), "{error}");
}

#[test]
fn the_plainest_depth_complexity_request_folds_and_shades_nothing() {
    let fixture = Fixture::new();
    let request = fixture.request(1, fixture.points());
    let plan = silhouettes(true).plan(&request);
    let (first, last) = (["place points", "open masks"], ["resolve"]);
    let without_clear = |plan: &Plan| -> Vec<String> {
        let clears = ["all samples decided", "no areas"];
        labels(plan).into_iter().filter(|l| !clears.contains(l)).map(str::to_owned).collect()
    };
    assert_eq!(without_clear(&plan), [&first, FOLDED, &last].concat());
    assert_eq!(outputs(&plan), ["list counts", "visibility", "receivers"]);
    for label in ["sample radiance", "shading", "materials", "triangle materials", "color", "corners 0", "hierarchy 0"]
    {
        assert_eq!(plan.find(label), None, "{label}");
    }
    assert_eq!(rasters(&plan), 0);
    assert_eq!(plan.find("light outline").is_some(), plan.find("visible areas").is_some());
    // Silhouettes are the whole scene's: sub-scenes are no concern of theirs.
    let two = silhouettes(true).plan(&fixture.request(2, fixture.points()));
    assert_eq!((labels(&two), two.memory()), (labels(&plan), plan.memory()));
    // Each of these asks for one thing more, and gets it.
    let textured = silhouettes(true).plan(&Request { channels: 3, ..request });
    assert!(textured.find("sample radiance").is_some());
    for shading in [Shading::Integrated, Shading::Modulated] {
        let mut wants = request.wants;
        wants.picture = Some(shading);
        assert_eq!(labels(&silhouettes(true).plan(&Request { wants, ..request })).last(), Some(&"shade"));
    }
}

#[test]
fn without_triangles_no_edge_is_looked_for() {
    let fixture = Fixture::new();
    for (scene, light, folds) in [(0, 0, false), (1, 0, true), (1, 1, true), (2, 3, true)] {
        for receivers in [fixture.camera(), fixture.points()] {
            for exact_area in [true, false] {
                let plan = silhouettes(exact_area).plan(&fixture.request_for(scene, receivers, light));
                let found: Vec<&str> = labels(&plan).into_iter().filter(|label| FOLDED.contains(label)).collect();
                assert_eq!(found, if folds { FOLDED } else { &[] }, "{plan}");
                for label in ["faces", "edges", "faces at edges", "clusters", "groups of clusters", "edge lists"] {
                    assert_eq!(plan.find(label).is_some(), folds, "{label}");
                }
                // The fourth light is one whose area is no visibility.
                for label in ["visible areas", "light outline"] {
                    assert_eq!(plan.find(label).is_some(), folds && exact_area && light != 3, "{label}");
                }
                // Masks open with the horizon in any scene, and results leave.
                assert!(labels(&plan).contains(&"open masks"));
                assert_eq!(outputs(&plan).contains(&"list counts"), folds);
                assert!(outputs(&plan).contains(&"visibility"));
            }
        }
    }
}

#[test]
fn areas_answer_where_they_are_asked_and_light_is_even() {
    let fixture = Fixture::new();
    for (scene, exact_area, channels, kernel) in [
        (1, true, 1, "resolve_areas"),
        (1, false, 1, "resolve"),
        (1, true, 3, "resolve_textured"),
        (1, false, 3, "resolve_textured"),
        (0, true, 1, "resolve"),
        (0, true, 3, "resolve_textured"),
    ] {
        let request = Request { channels, ..fixture.request(scene, fixture.points()) };
        let plan = silhouettes(exact_area).plan(&request);
        let pass = plan.passes.iter().find(|p| p.label == "resolve").unwrap();
        let Work::Compute { kernel: chosen, .. } = &pass.work else { panic!("'resolve' computes") };
        assert_eq!(chosen.entry, kernel);
        let binds = |name: &str| pass.bindings.iter().any(|(bound, _)| *bound == name);
        let by_area = kernel == "resolve_areas";
        assert_eq!((binds("areas"), binds("decided")), (by_area, !by_area), "{kernel}");
        assert_eq!(binds("sample_radiance"), channels == 3);
        if by_area {
            assert_eq!(bound(&plan, "resolve", "areas"), "visible areas");
        }
    }
}

#[test]
fn what_edges_pass_on_is_written_before_it_is_read() {
    let fixture = Fixture::new();
    let plan = silhouettes(true).plan(&fixture.request(1, fixture.camera()));
    for (passes, name, label) in [
        (&["bound clusters", "cull edges"][..], "clusters", "clusters"),
        (&["bound clusters", "cull edges"], "groups_of_clusters", "groups of clusters"),
        (&["bound tiles", "find faces", "list faces", "cull edges"], "parts", "tile parts"),
        (&["list faces", "count reference depth"], "first_faces", "first faces"),
        (&["list faces", "count reference depth", "cull edges", "narrow edges", "fold edges 0"], "lists", "edge lists"),
        (
            &["list faces", "count reference depth", "cull edges", "size fold", "narrow edges", "fold edges 0"],
            "counts",
            "running counts",
        ),
        (
            &["open masks", "bound tiles", "list faces", "count reference depth", "narrow edges", "fold edges 0"],
            "slots",
            "slots",
        ),
        (&["open masks", "count reference depth", "fold edges 0", "resolve"], "blocked", "blocked samples"),
        (&["fold edges 0", "resolve"], "areas", "visible areas"),
    ] {
        let places = passes.iter().map(|pass| labels(&plan).iter().position(|l| l == pass).unwrap());
        assert!(places.is_sorted(), "{passes:?}");
        passes.iter().for_each(|pass| assert_eq!(bound(&plan, pass, name), label, "{pass}"));
    }
    let work = |label: &str| &plan.passes.iter().find(|p| p.label == label).unwrap().work;
    for (pass, size, name) in
        [("fold edges 0", "fold dispatch", "dispatch_size"), ("narrow edges", "narrow dispatch", "narrow_size")]
    {
        let Work::Compute { over: Over::Indirect(groups), .. } = work(pass) else {
            panic!("'{pass}' runs over what was counted")
        };
        assert_eq!(plan.resources[groups.index()].label, size);
        assert_eq!(bound(&plan, "size fold", name), size);
    }
    let Work::Clear { target } = work("no areas") else { panic!("'no areas' clears") };
    assert_eq!(plan.resources[target.index()].label, "visible areas");
    let Work::Clear { target } = work("no counts") else { panic!("'no counts' clears") };
    assert_eq!(plan.resources[target.index()].label, "running counts");
    let Work::Copy { source, target, bytes } = work("report counts") else { panic!("it copies") };
    let ends = [source, target].map(|id| plan.resources[id.index()].label.as_str());
    assert_eq!((ends, *bytes), (["running counts", "list counts"], 32));
}

#[test]
fn lights_that_the_whole_scene_is_before_share_its_occluders() {
    let fixture = Fixture::new();
    let plan = |light| silhouettes(true).plan(&fixture.request_for(1, fixture.points(), light));
    // A rectangle, a sphere and a sun above the scene: what differs is how samples and areas are taken.
    let uploads = |light| {
        let plan = plan(light);
        plan.resources.into_iter().filter(|r| matches!(r.origin, Origin::Uploaded(_))).collect::<Vec<_>>()
    };
    assert_eq!((uploads(0), uploads(0)), (uploads(2), uploads(3)));
    // The rectangle within it has its own.
    assert_ne!(uploads(0), uploads(1));
    let faces = |light: usize| fixture.occluders[1][light].faces.key;
    assert_eq!([2, 3, 4].map(faces), [faces(0); 3]);
    assert_ne!(faces(0), faces(1));
}

#[test]
fn occluders_are_for_those_who_ask() {
    let fixture = Fixture::new();
    for technique in techniques() {
        for receivers in [fixture.camera(), fixture.points()] {
            let with = fixture.request(1, receivers);
            let without = Request { occluders: None, ..with };
            let asks = ["depth_complexity", "penumbra_map", "occlusion_camera"].contains(&technique.name());
            assert_eq!(technique.wants_occluders(), asks);
            assert_eq!(stage(&technique, &with) != stage(&technique, &without), asks, "{}", technique.name());
        }
    }
}

#[test]
fn probing_is_chosen_between_two_rounds() {
    let fixture = Fixture::new();
    let plan = traced(4).plan(&fixture.request(1, fixture.points()));
    let rounds: &[&str] = &["size probe 0", "probe 0", "choose"];
    assert_eq!(labels(&plan), [&["place points", "open masks"], FOUND, rounds, TRACED].concat());
    let two = traced(4).plan(&fixture.request(2, fixture.points()));
    let order: Vec<&str> = labels(&two).into_iter().filter(|l| l.contains("probe") || l.contains("trace")).collect();
    assert_eq!(&order[..4], ["size probe 0", "probe 0", "size probe 1", "probe 1"], "every sub-scene is probed first");
    assert_eq!(order[4..], ["size trace 0", "trace 0", "size trace 1", "trace 1"]);
}

/// The label of the resource that a pass binds by this name.
fn bound<'a>(plan: &'a Plan, pass: &str, name: &str) -> &'a str {
    let pass = plan.passes.iter().find(|p| p.label == pass).unwrap();
    let (_, id) = pass.bindings.iter().find(|(n, _)| *n == name).unwrap();
    &plan.resources[id.index()].label
}

#[test]
fn every_list_is_emptied_filled_sized_and_walked_in_its_sub_scene() {
    let fixture = Fixture::new();
    for probes in [0, 4] {
        let plan = traced(probes).plan(&fixture.request(2, fixture.camera()));
        let at = |label: &str| labels(&plan).iter().position(|l| *l == label).unwrap_or_else(|| panic!("no '{label}'"));
        for index in 0..2 {
            let of = |label: &str| format!("{label} {index}");
            let is = |pass: &str, name: &str, label: &str| assert_eq!(bound(&plan, &of(pass), name), of(label));
            for pass in ["gather", "narrow", "trace"] {
                is(pass, "nodes", "hierarchy");
            }
            is("narrow", "corners", "corners");
            is("trace", "corners", "corners");
            is("gather", "candidates", "gathered");
            is("size narrow", "candidates", "gathered");
            is("narrow", "candidates", "gathered");
            is("narrow", "narrowed", "candidates");
            for (stage, list) in [("gather", "gathered"), ("narrow", "gathered"), ("trace", "candidates")] {
                is(stage, "candidates", list);
            }
            for stage in if probes > 0 { &["narrow", "probe", "trace"][..] } else { &["narrow", "trace"] } {
                let size = format!("size {stage}");
                is(&size, "dispatch_size", &format!("{stage} dispatch"));
                is(&size, "trace_range", &format!("{stage} range"));
                is(&size, "candidates", if *stage == "narrow" { "gathered" } else { "candidates" });
                let Work::Compute { over: Over::Indirect(groups), .. } = plan.passes[at(&of(stage))].work else {
                    panic!("'{stage}' runs over what was counted");
                };
                assert_eq!(plan.resources[groups.index()].label, of(&format!("{stage} dispatch")));
                assert!(at(&of(&size)) < at(&of(stage)));
            }
            // A list that is emptied after it was filled, or counted before, would lose receivers.
            let order =
                ["no gathered", "gather", "size narrow", "no candidates", "narrow", "size trace", "trace", "report"];
            let places = order.map(|label| at(&of(label)));
            assert!(places.is_sorted(), "{places:?}");
            for (label, target) in [("no gathered", "gathered"), ("no candidates", "candidates")] {
                let Work::Clear { target: id } = plan.passes[at(&of(label))].work else { panic!("'{label}' clears") };
                assert_eq!(plan.resources[id.index()].label, of(target));
            }
            // What is told of a list is its header: how many, and how many rays were cut short.
            let Work::Copy { source, target, bytes } = plan.passes[at(&of("report"))].work else { panic!("it copies") };
            let ends = [source, target].map(|id| plan.resources[id.index()].label.clone());
            assert_eq!((ends, bytes), ([of("candidates"), of("trace counts")], 16));
        }
    }
}

/// The words of one `Sampling`: samples, words, probes, pass, passes.
fn sampling(technique: &Technique, request: &Request<'_>) -> Vec<u32> {
    let value = &stage(technique, request).1["sampling"];
    value.chunks_exact(4).take(5).map(|w| u32::from_le_bytes(w.try_into().unwrap())).collect()
}

#[test]
fn where_nothing_is_traced_no_probe_is_asked() {
    // Probes that no round follows would be all that is known of the masks: in an empty scene every sample counts.
    let fixture = Fixture::new();
    for (probes, in_scene) in [(0, 64), (8, 8), (63, 63)] {
        for receivers in [fixture.camera(), fixture.points()] {
            let words = |scene| sampling(&traced(probes), &fixture.request(scene, receivers));
            assert_eq!(words(0), [64, 2, 64, 0, 1]);
            assert_eq!(words(1), [64, 2, in_scene, 0, 1]);
            assert_eq!(words(2), [64, 2, in_scene, 0, 1]);
        }
    }
}

#[test]
fn rounds_share_the_samples() {
    let fixture = Fixture::new();
    let request = fixture.request(2, fixture.camera());
    let nodes = |index: usize| request.scene.local.sub_scenes[index].nodes.len() as u32;
    for (probes, rounds) in [(0, &[("trace", 0, 64)][..]), (8, &[("probe", 0, 8), ("trace", 8, 64)])] {
        let (_, values) = stage(&traced(probes), &request);
        for index in 0..2 {
            // One invocation a candidate gathers and narrows; rays walk the samples of their round.
            for (name, first, end) in [("gather", 0, 1), ("narrow", 0, 1)].iter().chain(rounds) {
                let value = &values[&format!("{name} range {index}")];
                let words: Vec<u32> =
                    value.chunks_exact(4).map(|w| u32::from_le_bytes(w.try_into().unwrap())).collect();
                assert_eq!(words, [*first, *end, nodes(index), 0], "{name} {index}");
            }
        }
    }
}

#[test]
fn points_are_not_drawn_and_pixels_once_a_run() {
    let fixture = Fixture::new();
    assert_eq!(rasters(&traced(0).plan(&fixture.request(2, fixture.points()))), 0);
    let first = fixture.request(2, fixture.camera());
    assert_eq!(rasters(&traced(0).plan(&first)), 2, "once a sub-scene");
    let next_block = Request { opens_run: false, ..first };
    assert_eq!(rasters(&traced(0).plan(&next_block)), 0);
}

#[test]
fn another_light_or_pass_places_no_receivers_and_hands_none_out() {
    let fixture = Fixture::new();
    for technique in techniques() {
        for receivers in [fixture.camera(), fixture.points()] {
            let first = fixture.request(1, receivers);
            let second = Request { opens_block: false, opens_run: false, ..first };
            let places = |request| {
                let plan = technique.plan(request);
                let placed =
                    labels(&plan).iter().filter(|l| l.starts_with("place ") || l.starts_with("draw triangle")).count();
                (placed, outputs(&plan).contains(&"receivers"))
            };
            assert!(places(&first).0 > 0 && places(&first).1);
            assert_eq!(places(&second), (0, false), "{}", technique.name());
        }
    }
}

#[test]
fn results_leave_with_the_last_pass_alone() {
    let fixture = Fixture::new();
    let mut last = fixture.request(1, fixture.points());
    last.opens_block = false;
    last.wants.standard_error = true;
    last.wants.sample_masks = true;
    last.wants.picture = Some(Shading::Integrated);
    let plan = traced(0).plan(&last);
    assert_eq!(outputs(&plan), ["trace counts 0", "color", "visibility", "standard error", "blocked samples"]);
    let middle = Request { closes_light: false, closes_block: false, ..last };
    assert_eq!(outputs(&traced(0).plan(&middle)), ["trace counts 0"]);
    let other_light = Request { closes_block: false, ..last };
    assert_eq!(
        outputs(&traced(0).plan(&other_light)),
        ["trace counts 0", "visibility", "standard error", "blocked samples"]
    );
    for exact_area in [true, false] {
        let given = |request| outputs(&silhouettes(exact_area).plan(request)).join(", ");
        assert_eq!(given(&last), "list counts, color, visibility, standard error, blocked samples");
        assert_eq!(given(&middle), "list counts");
        assert_eq!(given(&other_light), "list counts, visibility, standard error, blocked samples");
        let mut nothing_more = last;
        nothing_more.wants = Wants::default();
        assert_eq!(given(&nothing_more), "list counts, visibility");
    }
}

#[test]
fn a_light_is_modulated_once_its_visibility_is_known() {
    let fixture = Fixture::new();
    let mut request = fixture.request(1, fixture.points());
    request.wants.picture = Some(Shading::Modulated);
    for technique in [traced(0), silhouettes(true)] {
        for closes_light in [true, false] {
            let plan = technique.plan(&Request { closes_light, ..request });
            assert_eq!(labels(&plan).contains(&"shade"), closes_light, "{}", technique.name());
        }
    }
}

#[test]
fn an_empty_scene_traces_and_draws_nothing() {
    let fixture = Fixture::new();
    for technique in techniques() {
        let words: &[&str] = match technique {
            Technique::DepthComplexity(_) => &["find", "bound", "cull", "size", "fold", "draw"],
            _ => &["trace", "probe", "gather", "narrow", "size", "no ", "report", "choose", "draw"],
        };
        for (scene, empty) in [(0, true), (1, false)] {
            for receivers in [fixture.camera(), fixture.points()] {
                let plan = technique.plan(&fixture.request(scene, receivers));
                let looks = |label: &&str| words.iter().any(|word| label.starts_with(word));
                assert_eq!(!labels(&plan).iter().any(looks), empty, "{plan}");
            }
        }
    }
}

/// Labels of the resources that no pass takes up and nobody gets. To clear one is no use of it.
fn idle(plan: &Plan) -> BTreeSet<&str> {
    let mut used: BTreeSet<usize> = plan.outputs.iter().map(|id| id.index()).collect();
    for pass in &plan.passes {
        used.extend(pass.bindings.iter().map(|(_, id)| id.index()));
        match &pass.work {
            Work::Clear { .. } => {}
            Work::Copy { source, target, .. } => used.extend([source.index(), target.index()]),
            Work::Compute { over: Over::Indirect(size), .. } => used.extend([size.index()]),
            Work::Compute { .. } => {}
            Work::Raster(raster) => {
                if let VertexSource::Corners { buffer, .. } = raster.vertices {
                    used.insert(buffer.index());
                }
                used.extend(raster.colors.iter().map(|target| target.texture.index()));
                used.extend(raster.depth.iter().map(|target| target.texture.index()));
            }
        }
    }
    let rows = plan.resources.iter().enumerate();
    rows.filter(|(index, _)| !used.contains(index)).map(|(_, resource)| resource.label.as_str()).collect()
}

#[test]
fn idle_resources_are_seen() {
    let fixture = Fixture::new();
    let mut plan = traced(0).plan(&fixture.request(1, fixture.camera()));
    assert_eq!(idle(&plan), BTreeSet::new());
    let spare = plan.buffer("spare", 4);
    plan.clear("no spare", "to no end", spare);
    assert_eq!(idle(&plan), BTreeSet::from(["spare"]));
    plan.passes.retain(|pass| pass.label != "resolve");
    assert!(idle(&plan).contains("standard error"));
}

#[test]
fn every_resource_is_for_something() {
    let fixture = Fixture::new();
    for technique in techniques() {
        // Without triangles a camera has nothing to draw.
        let requests = fixture.requests(&technique);
        for request in requests.iter().filter(|request| !request.scene.local.sub_scenes.is_empty()) {
            let plan = technique.plan(request);
            // Its samples stand in the light's frame: those in space are for pictures, and areas need no number of samples.
            let spared: &[&str] = match technique {
                Technique::DepthComplexity(_) => &["light", "light samples", "decided samples"],
                _ => &[],
            };
            let idle: Vec<&str> = idle(&plan).into_iter().filter(|label| !spared.contains(label)).collect();
            assert_eq!(idle, Vec::<&str>::new(), "{plan}");
        }
    }
}

#[test]
fn equal_requests_make_equal_plans() {
    let (one, other) = (Fixture::new(), Fixture::new());
    for technique in techniques() {
        for (a, b) in one.requests(&technique).iter().zip(&other.requests(&technique)) {
            assert_eq!(stage(&technique, a), stage(&technique, b));
        }
    }
}

#[test]
fn what_a_parameter_can_say_leaves_the_plan_alone() {
    let fixture = Fixture::new();
    let request = fixture.request(1, fixture.camera());
    let bright = fixture.lights[0].clone().with_radiance([9.0; 3]).unwrap();
    let elsewhere = Camera::look_at([9.0, 0.5, 4.0], [0.0; 3], None, 30.0, SIZE).unwrap();
    let changed =
        [Request { light: &bright, ..request }, Request { receivers: ReceiverSource::Camera(&elsewhere), ..request }];
    let sampled = |seed| {
        [
            Technique::RayTraced(RayTraced { seed, ..RayTraced::default() }),
            Technique::DepthComplexity(DepthComplexity { seed, ..DepthComplexity::default() }),
        ]
    };
    for (technique, seeded) in sampled(0).into_iter().zip(sampled(99)) {
        assert_eq!(seeded.plan(&request), technique.plan(&request));
        assert_ne!(stage(&seeded, &request).1, stage(&technique, &request).1);
        for request_changed in &changed {
            assert_eq!(technique.plan(request_changed), technique.plan(&request));
            assert_ne!(stage(&technique, request_changed).1, stage(&technique, &request).1);
        }
        let wider = Request { channels: 3, ..request };
        assert_ne!(technique.plan(&wider), technique.plan(&request), "what changes buffers changes the plan");
    }
    assert_ne!(silhouettes(true).plan(&request), silhouettes(false).plan(&request));
}

#[test]
fn passes_of_one_light_differ_in_their_values_alone() {
    let fixture = Fixture::new();
    let request = fixture.request(1, fixture.points());
    // The box around the samples moves with them.
    for (technique, different) in [
        (
            Technique::RayTraced(RayTraced { passes: 3, ..RayTraced::default() }),
            &["light", "light samples", "sampling"][..],
        ),
        (
            Technique::DepthComplexity(DepthComplexity { passes: 3, ..DepthComplexity::default() }),
            &["coverage table 0", "frame samples", "group samples 0", "light", "light samples", "sampling"],
        ),
    ] {
        let values = |pass| technique.values(&request, &fixture.lights[0], pass).unwrap();
        let changed = |a: u32, b: u32| -> Vec<String> {
            values(a).into_iter().filter(|(label, value)| values(b)[label] != *value).map(|(label, _)| label).collect()
        };
        assert_eq!(changed(0, 1), different);
        assert!(changed(1, 1).is_empty());
    }
}
