//! Triangles instead of edges, and triangles that touch a ball of light: what plans hold of them, and what parameters say.

use std::sync::Arc;

use softshadow_plan::{Host, Over, Plan, Work, check};
use softshadow_scene::{
    Light, LightFrame, LightSamples, LightSampling, LightShape, LocalScene, Material, Mesh, SamplePattern, Scene,
    look_at,
};
use softshadow_techniques::depth_complexity::OccluderUnit;
use softshadow_techniques::parts::occluder_buffers::boundary_of;
use softshadow_techniques::{DepthComplexity, OccluderContents, Request, SceneContents, Technique};

use crate::requests::{Fixture, stage};

fn folded(samples: u32, unit: OccluderUnit) -> Technique {
    Technique::DepthComplexity(DepthComplexity { samples, unit, ..DepthComplexity::default() })
}

fn labels<'a>(plan: &'a Plan, start: &str) -> Vec<&'a str> {
    plan.passes.iter().map(|p| p.label.as_str()).filter(|l| l.starts_with(start)).collect()
}

fn kernels(plan: &Plan) -> Vec<&'static str> {
    let of = |work: &Work| if let Work::Compute { kernel, .. } = work { Some(kernel.entry) } else { None };
    plan.passes.iter().filter_map(|p| of(&p.work)).collect()
}

fn words(value: &[u8]) -> Vec<u32> {
    value.chunks_exact(4).map(|w| u32::from_le_bytes(w.try_into().unwrap())).collect()
}

fn unit_used(unit: OccluderUnit, occluders: &OccluderContents) -> &'static str {
    DepthComplexity { unit, ..DepthComplexity::default() }.unit_used(occluders)
}

#[test]
fn triangles_need_no_edges_lists_tiles_or_areas() {
    let fixture = Fixture::new();
    for (light, kernel) in [(0, "cover_faces"), (1, "cover_faces"), (2, "cover_moving"), (3, "cover_faces")] {
        let request = fixture.request_for(1, fixture.points(), light);
        let plan = folded(64, OccluderUnit::Triangles).plan(&request);
        // A sphere's samples move with the receiver.
        let opens = if light == 2 { "open_masks_of_sets" } else { "open_masks" };
        assert_eq!(kernels(&plan), ["place", opens, kernel, "resolve"], "light {light}");
        for label in
            ["edges", "faces at edges", "clusters", "edge lists", "tile parts", "visible areas", "light outline"]
        {
            assert_eq!(plan.find(label), None, "{label}");
        }
        assert!(plan.find("corners of faces").is_some());
        check(&plan, &Host::default()).unwrap();
        let edges = folded(64, OccluderUnit::Edges).plan(&request);
        assert!(labels(&edges, "cover").is_empty() && edges.find("corners of faces").is_none());
        assert!(plan.memory() < edges.memory());
        // Four faces are too few to be a soup.
        assert_eq!(folded(64, OccluderUnit::Auto).plan(&request), edges);
        let values = stage(&folded(64, OccluderUnit::Edges), &request).1;
        assert!(values.keys().all(|label| !label.starts_with("cover ") && !label.starts_with("sample bins")));
    }
}

#[test]
fn without_triangles_nothing_is_covered() {
    let fixture = Fixture::new();
    let plan = folded(64, OccluderUnit::Triangles).plan(&fixture.request(0, fixture.points()));
    assert_eq!(kernels(&plan), ["place", "open_masks", "resolve"]);
}

/// `count` triangles side by side that share nothing.
fn soup(count: usize) -> SceneContents {
    let corners = |n: usize| [0.0, 0.2, 0.4].map(|x| [n as f64 + x, x * x, 0.0]);
    let triangles = (0..count as u32).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
    let mesh = Mesh::new("soup", (0..count).flat_map(corners).collect(), triangles, Material::default()).unwrap();
    SceneContents::new(LocalScene::new(&Scene::new(vec![mesh]).unwrap(), None, 1 << 30))
}

#[test]
fn a_soup_is_told_by_its_borders_and_takes_rounds() {
    let fixture = Fixture::new();
    for (count, unit, rounds) in [(1, "edges", 1), (30, "edges", 2), (640, "edges", 16), (641, "triangles", 16)] {
        let scene = soup(count);
        let boundary = boundary_of(&scene.local, &fixture.lights[0]);
        let occluders = OccluderContents::new(&scene.local, boundary).unwrap();
        assert_eq!((occluders.border_count, occluders.face_count), (3 * count as u32, count as u32));
        assert_eq!(unit_used(OccluderUnit::Auto, &occluders), unit, "{count}");
        assert_eq!(unit_used(OccluderUnit::Edges, &occluders), "edges");
        let request = Request { scene: &scene, occluders: Some(&occluders), ..fixture.request(1, fixture.points()) };
        let (plan, values) = stage(&folded(130, OccluderUnit::Triangles), &request);
        assert_eq!(labels(&plan, "cover triangles").len(), 3 * rounds, "{count}: rounds for each 64 samples");
        for group in 0..3 {
            for round in 0..rounds as u32 {
                let settings = words(&values[&format!("cover settings {group}.{round}")]);
                assert_eq!(settings, [5, group, round, rounds as u32]);
            }
        }
    }
    let empty = &fixture.occluders[0][0];
    assert_eq!(unit_used(OccluderUnit::Triangles, empty), "none");
}

#[test]
fn strips_hold_the_samples_before_them() {
    let fixture = Fixture::new();
    for samples in [1, 40, 64] {
        let request = fixture.request(1, fixture.points());
        let (_, values) = stage(&folded(samples, OccluderUnit::Triangles), &request);
        let bins = words(&values["sample bins 0"]);
        let float = |at: usize| f32::from_bits(bins[at]);
        let local = &fixture.scenes[1].local.frame;
        let light = &fixture.lights[0];
        let set =
            LightSamples::new(light, local, &LightSampling::correlated(SamplePattern::Stratified, samples, 0)).unwrap();
        let placed = LightFrame::new(light, local).samples(light, &set);
        for axis in 0..2 {
            let before =
                |strip: usize, sample: usize| bins[4 + 4 * strip + 2 * axis + sample / 32] >> (sample % 32) & 1;
            for (sample, place) in placed.iter().enumerate() {
                assert_eq!((before(0, sample), before(63, sample)), (0, 1));
                let strip = ((place[axis] - float(axis)) * float(2 + axis)).floor();
                assert!((0.0..63.0).contains(&strip), "{strip}");
                assert_eq!((before(strip as usize, sample), before(strip as usize + 1, sample)), (0, 1));
            }
            let all: u32 = (0..2).map(|word| bins[4 + 4 * 63 + 2 * axis + word].count_ones()).sum();
            assert_eq!(all, samples, "no bit without a sample");
        }
    }
}

#[test]
fn corners_of_faces_stand_in_the_order_of_their_sides() {
    let scene = soup(3);
    let occluders = OccluderContents::new(&scene.local, softshadow_scene::occluders::LightBoundary::None).unwrap();
    let floats: &[f32] = bytemuck::cast_slice(&occluders.face_corners.bytes);
    let faces: &[u32] = bytemuck::cast_slice(&occluders.faces.bytes);
    let edges: &[u32] = bytemuck::cast_slice(&occluders.edges.bytes);
    for (corners, face) in floats.chunks_exact(12).zip(faces.chunks_exact(12)) {
        assert_eq!(corners[..3], corners[9..], "a triangle comes back to its first corner");
        for side in 0..3 {
            let (edge, backward) = (8 * (face[8 + side] >> 1) as usize, face[8 + side] & 1 == 1);
            let [low, high] = [0, 4].map(|at| [0, 1, 2].map(|k| f32::from_bits(edges[edge + at + k])));
            let [from, to] = if backward { [high, low] } else { [low, high] };
            assert_eq!((&corners[3 * side..3 * side + 3], &corners[3 * side + 3..3 * side + 6]), (&from[..], &to[..]));
        }
    }
}

#[test]
fn only_triangles_that_touch_a_ball_of_light_are_tried() {
    let fixture = Fixture::new();
    for unit in [OccluderUnit::Edges, OccluderUnit::Triangles] {
        for light in 0..6 {
            let (plan, values) = stage(&folded(64, unit), &fixture.request_for(1, fixture.points(), light));
            let tried = labels(&plan, "try touching triangles").len();
            assert_eq!(
                (tried, plan.find("touching triangles").is_some()),
                if light == 5 { (1, true) } else { (0, false) }
            );
            assert_eq!(values.contains_key("touching range 0"), light == 5);
        }
    }
    let occluders = &fixture.occluders[1][5];
    assert_eq!(occluders.touching.as_ref().map(|t| t.count), Some(2));
    assert_eq!(occluders.edge_count, 5, "the other sheet");
}

#[test]
fn many_touching_triangles_take_several_passes() {
    // All within the ball.
    let scene = soup(4000);
    let light = Light::new(
        LightShape::Sphere { radius: 9000.0 },
        look_at([0.0, 0.0, 5.0], [0.0, 0.0, -9.0], Some([0.0, 1.0, 0.0])).unwrap(),
    )
    .unwrap();
    let occluders = Arc::new(OccluderContents::new(&scene.local, boundary_of(&scene.local, &light)).unwrap());
    assert_eq!(occluders.edge_count, 0);
    let fixture = Fixture::new();
    let base = fixture.request(1, fixture.points());
    let request = Request { scene: &scene, light: &light, occluders: Some(&occluders), ..base };
    let (plan, values) = stage(&folded(70, OccluderUnit::Auto), &request);
    let passes = labels(&plan, "try touching triangles");
    assert_eq!(passes.len(), 3);
    let mut next = 0;
    for pass in 0..3 {
        let range = words(&values[&format!("touching range {pass}")]);
        assert_eq!(range[0], next);
        // 32 samples against them, and a driver ends loops after 65,535 steps.
        assert!(range[1] > range[0] && 32 * (range[1] - range[0] + 2) < 65_535);
        next = range[1];
    }
    assert_eq!(next, 4000);
    let of = |label: &str| &plan.passes.iter().find(|p| p.label == label).unwrap().work;
    let Work::Compute { over: Over::Items { count, .. }, .. } = of(passes[0]) else { panic!("over items") };
    assert_eq!(*count, 5 * 3, "one invocation a word");
}
