//! What nobody asked for costs no pass and no byte; and equal requests make equal plans.

use softshadow_plan::{Plan, Work};
use softshadow_scene::Camera;
use softshadow_techniques::{HardShadowMap, RayTraced, Request, Shading, Technique};

use crate::requests::{Fixture, SIZE, stage, techniques};

fn traced(probes: u32) -> Technique {
    Technique::RayTraced(RayTraced { probes, ..RayTraced::default() })
}

/// The passes that find the receivers with anything between them and the light.
const GATHERED: &[&str] = &["empty list 0", "gather 0", "no ray unfinished"];

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
    assert_eq!(
        labels(&plan),
        [&["place points", "open masks"], GATHERED, &["size trace 0", "trace 0", "resolve"]].concat()
    );
    assert_eq!(outputs(&plan), ["unfinished rays", "visibility", "receivers"]);
    assert_eq!(plan.find("sample radiance"), None);
    // Each of these asks for one thing more, and gets it.
    let textured = traced(0).plan(&Request { channels: 3, ..request });
    assert!(textured.find("sample radiance").is_some());
    let mut wants = request.wants;
    wants.picture = Some(Shading::Integrated);
    assert_eq!(labels(&traced(0).plan(&Request { wants, ..request })).last(), Some(&"shade"));
    assert!(labels(&traced(4).plan(&request)).contains(&"choose"));
    let two = traced(0).plan(&fixture.request(2, fixture.points()));
    let traces = |plan: &Plan| labels(plan).iter().filter(|l| l.starts_with("trace")).count();
    assert_eq!((traces(&plan), traces(&two)), (1, 2), "one a sub-scene");
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
    let within = technique.plan(&Request { light: &fixture.lights[1], ..request });
    assert_eq!(rasters(&within), 6, "a light within the scene looks six ways");
}

#[test]
fn probing_is_chosen_between_two_rounds() {
    let fixture = Fixture::new();
    let plan = traced(4).plan(&fixture.request(1, fixture.points()));
    let rounds: &[&str] = &["size probe 0", "probe 0", "choose", "size trace 0", "trace 0", "resolve"];
    assert_eq!(labels(&plan), [&["place points", "open masks"], GATHERED, rounds].concat());
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
    assert_eq!(outputs(&plan), ["unfinished rays", "color", "visibility", "standard error", "blocked samples"]);
    let middle = Request { closes_light: false, closes_block: false, ..last };
    assert_eq!(outputs(&traced(0).plan(&middle)), ["unfinished rays"]);
    let other_light = Request { closes_block: false, ..last };
    assert_eq!(
        outputs(&traced(0).plan(&other_light)),
        ["unfinished rays", "visibility", "standard error", "blocked samples"]
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
                    ["trace", "probe", "gather", "size", "choose", "draw"].iter().any(|word| label.starts_with(word))
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
