//! What nobody asked for costs no pass and no byte; and equal requests make equal plans.

use softshadow_plan::{Over, Plan, Work};
use softshadow_scene::Camera;
use softshadow_techniques::{HardShadowMap, RayTraced, Request, Shading, Technique};

use crate::requests::{Fixture, SIZE, stage, techniques};

fn traced(probes: u32) -> Technique {
    Technique::RayTraced(RayTraced { probes, ..RayTraced::default() })
}

/// The passes that find the receivers with a triangle between them and the light: by boxes, then by triangles.
const FOUND: &[&str] = &["no gathered 0", "gather 0", "size narrow 0", "no candidates 0", "narrow 0"];
/// Those that trace, tell what was traced, and turn bits into values.
const TRACED: &[&str] = &["size trace 0", "trace 0", "report 0", "resolve"];

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
}

#[test]
fn an_empty_scene_traces_and_draws_nothing() {
    let fixture = Fixture::new();
    for technique in techniques() {
        for (scene, empty) in [(0, true), (1, false)] {
            for receivers in [fixture.camera(), fixture.points()] {
                let plan = technique.plan(&fixture.request(scene, receivers));
                let looks = |label: &&str| {
                    ["trace", "probe", "gather", "narrow", "size", "no ", "report", "choose", "draw"]
                        .iter()
                        .any(|word| label.starts_with(word))
                };
                assert_eq!(!labels(&plan).iter().any(looks), empty, "{plan}");
            }
        }
    }
}

#[test]
fn equal_requests_make_equal_plans() {
    let (one, other) = (Fixture::new(), Fixture::new());
    for technique in techniques() {
        for (a, b) in one.requests().iter().zip(&other.requests()) {
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
    let changed = [
        Request { light: &bright, ..request },
        Request { receivers: softshadow_techniques::ReceiverSource::Camera(&elsewhere), ..request },
    ];
    let seeded = Technique::RayTraced(RayTraced { seed: 99, ..RayTraced::default() });
    assert_eq!(seeded.plan(&request), traced(0).plan(&request));
    assert_ne!(stage(&seeded, &request).1, stage(&traced(0), &request).1);
    for request_changed in &changed {
        assert_eq!(traced(0).plan(request_changed), traced(0).plan(&request));
        assert_ne!(stage(&traced(0), request_changed).1, stage(&traced(0), &request).1);
    }
    let wider = Request { channels: 3, ..request };
    assert_ne!(traced(0).plan(&wider), traced(0).plan(&request), "what changes buffers changes the plan");
}

#[test]
fn passes_of_one_light_differ_in_their_values_alone() {
    let fixture = Fixture::new();
    let technique = Technique::RayTraced(RayTraced { passes: 3, ..RayTraced::default() });
    let request = fixture.request(1, fixture.points());
    let values = |pass| technique.values(&request, &fixture.lights[0], pass).unwrap();
    let changed = |a: u32, b: u32| -> Vec<String> {
        values(a).into_iter().filter(|(label, value)| values(b)[label] != *value).map(|(label, _)| label).collect()
    };
    assert_eq!(changed(0, 1), ["light", "light samples", "sampling"], "the box around the samples moves with them");
    assert!(changed(1, 1).is_empty());
}
