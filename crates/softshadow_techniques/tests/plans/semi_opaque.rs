//! Opaque scenes carry no attenuation, and semi-opaque ones no more of it than they need.

use std::collections::BTreeSet;

use softshadow_plan::{Plan, Work};
use softshadow_scene::SampleSpread;
use softshadow_techniques::depth_complexity::Evaluation;
use softshadow_techniques::{Attenuation, DepthComplexity, RayTraced, Request, Shading, Technique};

use crate::requests::{Fixture, stage, techniques};

/// The scene whose upper sheet is semi-opaque, and the same all opaque.
const GLASS: usize = 3;
const SHEETS: usize = 2;

/// What speaks of transmittance or attenuation: resources, passes and entry points.
fn attenuating(plan: &Plan) -> BTreeSet<String> {
    let entries = plan.passes.iter().filter_map(|pass| match &pass.work {
        Work::Compute { kernel, .. } => Some(kernel.entry.to_owned()),
        _ => None,
    });
    let names = plan.resources.iter().map(|r| r.label.clone()).chain(plan.passes.iter().map(|p| p.label.clone()));
    let words = ["attenuat", "transmittance", "open samples", "mask samples", "spread"];
    entries.chain(names).filter(|name| words.iter().any(|word| name.contains(word))).collect()
}

#[test]
fn opaque_scenes_carry_no_attenuation() {
    let fixture = Fixture::new();
    for technique in techniques() {
        for request in fixture.requests(&technique) {
            let is_glass = std::ptr::eq(request.scene, &fixture.scenes[GLASS]);
            // Within the scene a light looks down from below the glass: nothing before it is semi-opaque.
            let is_before_glass = std::ptr::eq(request.light, &fixture.lights[1]);
            let carries = match technique {
                Technique::RayTraced(_) => is_glass,
                Technique::DepthComplexity(_) => is_glass && !is_before_glass,
                _ => false,
            };
            let plan = technique.plan(&request);
            assert_eq!(!attenuating(&plan).is_empty(), carries, "{plan}");
        }
    }
}

#[test]
fn areas_do_not_answer_under_glass() {
    let fixture = Fixture::new();
    let technique = Technique::DepthComplexity(DepthComplexity::default());
    let resolves = |scene| {
        let plan = technique.plan(&fixture.request(scene, fixture.points()));
        let pass = plan.passes.iter().find(|p| p.label == "resolve").unwrap();
        let Work::Compute { kernel, .. } = pass.work else { panic!("'resolve' computes") };
        (kernel.entry, plan.find("light outline").is_some())
    };
    assert_eq!(resolves(SHEETS), ("resolve_areas", true));
    assert_eq!(resolves(GLASS), ("resolve_attenuated", false));
}

#[test]
fn every_spread_goes_through_glass() {
    let fixture = Fixture::new();
    let shared = ["open_masks", "fold_attenuated", "resolve_attenuated", "resolve_attenuated_textured"];
    let own = ["open_masks_of_sets", "fold_attenuated_own_samples", "keep_attenuated", "keep_attenuated_textured"];
    let known = [shared, own].concat();
    for (spread, light, expected) in [
        (SampleSpread::Correlated, 0, vec![shared[0], shared[1], shared[2]]),
        (SampleSpread::Correlated, 2, vec![own[0], own[1], shared[2]]),
        (SampleSpread::Correlated, 4, vec![shared[0], shared[1], shared[3]]),
        (SampleSpread::Decorrelated, 0, vec![own[0], own[1], shared[2]]),
        (SampleSpread::Decorrelated, 4, vec![own[0], own[1], shared[3]]),
        (SampleSpread::Interleaved, 0, vec![own[0], own[1], own[2]]),
        (SampleSpread::Interleaved, 4, vec![own[0], own[1], own[3]]),
    ] {
        let technique = Technique::DepthComplexity(DepthComplexity { spread, ..DepthComplexity::default() });
        let channels = if light == 4 { 3 } else { 1 };
        let plan = technique.plan(&Request { channels, ..fixture.request_for(GLASS, fixture.camera(), light) });
        let entries = plan.passes.iter().filter_map(|pass| match &pass.work {
            Work::Compute { kernel, .. } => Some(kernel.entry),
            _ => None,
        });
        let found: BTreeSet<&str> = entries.filter(|entry| known.contains(entry)).collect();
        assert_eq!(found, expected.into_iter().collect(), "{spread:?} {light}");
    }
}

#[test]
fn wedges_refuse_glass() {
    let fixture = Fixture::new();
    let check = |evaluation, scene: usize| {
        let technique = Technique::DepthComplexity(DepthComplexity { evaluation, ..DepthComplexity::default() });
        technique.check_scene(&fixture.scenes[scene]).map_err(|error| error.to_string())
    };
    let words = "depth_complexity evaluation: 'blended' counts opaque triangles alone, and the scene has semi-opaque ones; use 'tiled'";
    assert_eq!(check(Evaluation::Blended, GLASS), Err(words.to_owned()));
    assert_eq!(check(Evaluation::Blended, SHEETS), Ok(()));
    assert_eq!(check(Evaluation::Tiled, GLASS), Ok(()));
    // Nor is there anything that the rule could change.
    let settings = DepthComplexity {
        evaluation: Evaluation::Blended,
        attenuation: Attenuation::Sum,
        ..DepthComplexity::default()
    };
    let words = Technique::DepthComplexity(settings).check().unwrap_err().to_string();
    assert!(words.contains("attenuation") && words.contains("'tiled'"), "{words}");
}

#[test]
fn a_block_is_sized_by_what_passes_too() {
    let fixture = Fixture::new();
    for technique in techniques() {
        let request = fixture.request(GLASS, if technique.interleaves() { fixture.camera() } else { fixture.points() });
        let total = |scene: usize, occluders| {
            let mut request = Request { scene: &fixture.scenes[scene], occluders, ..request };
            request.block.count = 64 * 64;
            (request.opens_block, request.opens_run) = (false, false);
            let plan = technique.plan(&request);
            let passing = plan.memory().into_iter().find(|(label, _)| *label == "sample transmittance");
            passing.map_or(0, |(_, bytes)| bytes)
        };
        let each = |is_semi_opaque| technique.bytes_per_receiver(1, 2, is_semi_opaque);
        let occluders = fixture.request(GLASS, fixture.points()).occluders;
        assert_eq!(total(GLASS, occluders), 64 * 64 * (each(true) - each(false)), "{technique:?}");
    }
}

#[test]
fn masks_are_made_of_shares_where_they_are_wanted() {
    let fixture = Fixture::new();
    let sampled = [Technique::RayTraced(RayTraced::default()), Technique::DepthComplexity(DepthComplexity::default())];
    for technique in sampled {
        let mut request = fixture.request(GLASS, fixture.points());
        request.wants.picture = Some(Shading::Integrated);
        let masks = |request: &Request<'_>| technique.plan(request).passes.iter().any(|p| p.label == "mask samples");
        assert!(!masks(&request));
        request.wants.sample_masks = true;
        assert!(masks(&request));
        assert!(!masks(&Request { closes_light: false, ..request }));
    }
}

#[test]
fn the_rule_is_in_the_values_and_in_what_triangles_take_away() {
    let fixture = Fixture::new();
    let request = fixture.request(GLASS, fixture.points());
    let of = |attenuation| {
        let technique = Technique::DepthComplexity(DepthComplexity { attenuation, ..DepthComplexity::default() });
        let (plan, values) = stage(&technique, &request);
        let scale: Vec<f32> = bytemuck::pod_collect_to_vec(&values["attenuation scale"]);
        (plan, scale)
    };
    let ((logarithmic, halvings), (sum, shares)) = (of(Attenuation::Logarithmic), of(Attenuation::Sum));
    assert_eq!((halvings, shares), (vec![1.0 / 4096.0, 0.0], vec![0.0, 1.0 / 65_536.0]));
    assert_ne!(logarithmic, sum);
    let opacity = fixture.scenes[GLASS].opacity.as_ref().unwrap();
    let words = |content: &softshadow_plan::Content| -> Vec<u32> { bytemuck::pod_collect_to_vec(&content.bytes) };
    let is_glass: Vec<bool> = (0..4).map(|n| fixture.scenes[GLASS].local.opacity(n) < 1.0).collect();
    assert_eq!(is_glass.iter().filter(|glass| **glass).count(), 2);
    for (triangle, glass) in is_glass.into_iter().enumerate() {
        // A quarter of the light: 0.415 halvings.
        let expected = if glass { [1700, 16_384, 0.75f32.to_bits()] } else { [u32::MAX, u32::MAX, 0] };
        let given = [&opacity.halvings, &opacity.shares, &opacity.transmittances].map(|c| words(c)[triangle]);
        assert_eq!(given, expected);
    }
}
