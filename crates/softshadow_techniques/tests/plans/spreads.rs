//! Who shares samples: what each spread adds to a plan, which set a receiver takes whatever its block, and what is refused.

use std::collections::BTreeSet;

use softshadow_plan::{Host, Plan, Work};
use softshadow_scene::{Camera, LightTexture, MAX_SAMPLES, SamplePattern, SampleSpread};
use softshadow_techniques::{Block, DepthComplexity, RayTraced, ReceiverSource, Request, Shading, Technique, blocks};

use crate::requests::{Fixture, stage};

use SampleSpread::{Correlated, Decorrelated, Interleaved};

fn traced(spread: SampleSpread) -> Technique {
    Technique::RayTraced(RayTraced { spread, ..RayTraced::default() })
}

fn folded(spread: SampleSpread) -> Technique {
    Technique::DepthComplexity(DepthComplexity { spread, ..DepthComplexity::default() })
}

fn both(spread: SampleSpread) -> [Technique; 2] {
    [traced(spread), folded(spread)]
}

fn labels(plan: &Plan) -> Vec<&str> {
    plan.passes.iter().map(|p| p.label.as_str()).collect()
}

fn entries(plan: &Plan) -> BTreeSet<&str> {
    let compute = |work: &Work| if let Work::Compute { kernel, .. } = work { Some(kernel.entry) } else { None };
    plan.passes.iter().filter_map(|p| compute(&p.work)).collect()
}

fn words(value: &[u8]) -> Vec<u32> {
    value.chunks_exact(4).map(|w| u32::from_le_bytes(w.try_into().unwrap())).collect()
}

#[test]
fn interleaving_is_one_more_pass_and_nothing_else_is() {
    let fixture = Fixture::new();
    for (index, technique) in both(Interleaved).iter().enumerate() {
        for (picture, closes_block) in [
            (None, true),
            (Some(Shading::Modulated), true),
            (Some(Shading::Integrated), false),
            (Some(Shading::Integrated), true),
        ] {
            let mut request = fixture.request(1, fixture.camera());
            (request.wants.picture, request.closes_block) = (picture, closes_block);
            let plans = [Correlated, Decorrelated, Interleaved].map(|spread| both(spread)[index].plan(&request));
            assert_eq!(labels(&plans[0]), labels(&plans[1]));
            let averages = |label: &&str| *label == "interleave" || *label == "interleave colors";
            let (more, rest): (Vec<&str>, Vec<&str>) = labels(&plans[2]).into_iter().partition(averages);
            assert_eq!(rest, labels(&plans[0]), "{}", technique.name());
            // Light is averaged where the picture leaves; a visibility before it modulates.
            let averages_light = picture == Some(Shading::Integrated) && closes_block;
            let expected: &[&str] = if averages_light { &["interleave", "interleave colors"] } else { &["interleave"] };
            assert_eq!(more, expected);
            let all = labels(&plans[2]);
            let at = |label: &str| all.iter().position(|l| *l == label);
            assert_eq!(at("interleave"), at("resolve").map(|n| n + 1));
            assert!(at("shade") > at("interleave") || picture.is_none());
        }
    }
}

#[test]
fn one_set_keeps_its_kernels_and_a_uniform_of_its_own() {
    let fixture = Fixture::new();
    let request = fixture.request(1, fixture.camera());
    let own = ["open_masks_of_sets", "fold_own_samples_areas", "keep_areas", "interleave"];
    let plans = [Correlated, Decorrelated, Interleaved].map(|spread| folded(spread).plan(&request));
    let used = |plan: &Plan| own.map(|entry| entries(plan).contains(entry));
    assert_eq!(plans.each_ref().map(used), [[false; 4], [true, true, false, false], [true; 4]]);
    for (plan, shares) in plans.iter().zip([true, false, false]) {
        assert_eq!(["open_masks", "fold_areas"].map(|entry| entries(plan).contains(entry)), [shares; 2]);
        assert_eq!((plan.find("frame samples").is_some(), plan.find("sample sets").is_some()), (shares, !shares));
    }
    assert_eq!(entries(&traced(Correlated).plan(&request)), entries(&traced(Decorrelated).plan(&request)));
}

#[test]
fn sets_follow_the_receiver_and_not_the_block() {
    let fixture = Fixture::new();
    let sampling = |technique: &Technique, receivers, block| {
        let request = Request { block, ..fixture.request(1, receivers) };
        words(&stage(technique, &request).1["sampling"])[5..].to_vec()
    };
    let block = |first, count| Block { first, count, skip: 0, keep: count };
    for (first, count) in [(0, 32), (16, 8)] {
        let block = block(first, count);
        for index in 0..2 {
            assert_eq!(sampling(&both(Correlated)[index], fixture.camera(), block), [1, 0, 0]);
            assert_eq!(sampling(&both(Decorrelated)[index], fixture.camera(), block), [128, 0, first as u32]);
            assert_eq!(sampling(&both(Interleaved)[index], fixture.camera(), block), [4, 8, first as u32]);
        }
    }
    assert_eq!(sampling(&traced(Decorrelated), fixture.points(), block(3, 2)), [128, 0, 3]);
    // Pixels are averaged within the block and the rows around what is kept of it.
    for block in blocks(32, 8, 2, 40) {
        let request = Request { block, ..fixture.request(1, fixture.camera()) };
        let interleaving = words(&stage(&traced(Interleaved), &request).1["interleaving"]);
        assert_eq!(interleaving[3..7], [4, 8, (block.count / 8) as u32, 1]);
    }
}

#[test]
fn rows_around_a_block_are_those_that_are_averaged() {
    let rows = |spread, tile, probes| {
        let traced = Technique::RayTraced(RayTraced { spread, tile, probes, ..RayTraced::default() });
        let folded = Technique::DepthComplexity(DepthComplexity { spread, tile, ..DepthComplexity::default() });
        (traced.halo_rows(), folded.halo_rows())
    };
    for (tile, reach) in [(2, 1), (3, 1), (4, 2), (5, 2), (8, 4)] {
        assert_eq!(rows(Interleaved, tile, 0), (reach, reach));
        assert_eq!(rows(Interleaved, tile, 8), (reach + 1, reach));
        assert_eq!((rows(Correlated, tile, 0), rows(Decorrelated, tile, 0)), ((0, 0), (0, 0)));
    }
}

#[test]
fn both_techniques_take_the_same_samples() {
    let fixture = Fixture::new();
    for spread in [Correlated, Decorrelated, Interleaved] {
        for receivers in [fixture.camera(), fixture.points()] {
            let request = fixture.request(1, receivers);
            let [rays, edges] = both(spread).map(|technique| stage(&technique, &request).1);
            for label in ["light", "light samples", "sample radiance", "sampling"] {
                assert_eq!(rays[label], edges[label], "{spread:?} {label}");
            }
        }
    }
    // Two sets are no copies of each other, nor are those of another pass.
    let request = fixture.request(1, fixture.camera());
    for spread in [Decorrelated, Interleaved] {
        let technique = folded(spread);
        let sets = |pass| technique.values(&request, request.light, pass).unwrap()["sample sets"].clone();
        let (first, next) = (sets(0), sets(1));
        let count = if spread == Interleaved { 16 } else { 128 };
        let distinct: BTreeSet<&[u8]> = first.chunks_exact(64 * 8).chain(next.chunks_exact(64 * 8)).collect();
        assert_eq!(
            distinct.len(),
            2 * count + usize::from(count < 128),
            "and zeros where sets do not fill the uniform"
        );
    }
}

#[test]
fn another_frame_of_a_texture_changes_the_radiance_of_samples_alone() {
    let fixture = Fixture::new();
    let frame = |brightness: f32| {
        let texels = vec![[brightness, 0.0, 1.0], [0.0, brightness, 1.0]];
        fixture.lights[4].clone().with_texture(LightTexture::new(2, 1, texels).unwrap()).unwrap()
    };
    let frames = [frame(1.0), frame(0.25)];
    for spread in [Correlated, Decorrelated, Interleaved] {
        for technique in both(spread) {
            let mut request = Request { channels: 3, ..fixture.request_for(1, fixture.camera(), 4) };
            request.wants.picture = Some(Shading::Integrated);
            let [one, other] = frames.each_ref().map(|light| stage(&technique, &Request { light, ..request }));
            // Equal plans name equal contents: nothing is uploaded again, no pipeline is made.
            assert_eq!(one.0, other.0);
            let changed: Vec<&String> = one.1.keys().filter(|label| one.1[*label] != other.1[*label]).collect();
            assert_eq!(changed, ["sample radiance"], "{}", technique.name());
        }
    }
}

#[test]
fn what_cannot_interleave_is_named_with_a_way_out() {
    let fixture = Fixture::new();
    let traced =
        |samples, tile| Technique::RayTraced(RayTraced { samples, tile, spread: Interleaved, ..RayTraced::default() });
    let folded = |samples, tile| {
        Technique::DepthComplexity(DepthComplexity { samples, tile, spread: Interleaved, ..DepthComplexity::default() })
    };
    for (technique, words) in [
        (traced(64, 1), "ray_traced tile: must lie between 2 and 8, got 1"),
        (folded(64, 9), "depth_complexity tile: must lie between 2 and 8, got 9"),
        (folded(256, 6), "depth_complexity tile: 6 x 6 sets of 256 samples are more than 8192; take a smaller tile"),
        (
            traced(MAX_SAMPLES, 2),
            "ray_traced tile: 2 x 2 sets of 32768 samples are more than 65536; take a smaller tile",
        ),
    ] {
        assert_eq!(technique.check().unwrap_err().to_string(), words);
    }
    for technique in [traced(16_384, 2), traced(1024, 8), folded(128, 8), folded(256, 5)] {
        assert_eq!(technique.check(), Ok(()));
        assert_eq!(technique.check_call(fixture.camera(), &fixture.lights, &Host::default()), Ok(()));
        let words = technique.check_call(fixture.points(), &fixture.lights, &Host::default()).unwrap_err().to_string();
        assert!(words.contains("spread: interleaved averages pixels side by side") && words.contains("'decorrelated'"));
    }
    for technique in both(Decorrelated) {
        assert_eq!(technique.check_call(fixture.points(), &fixture.lights, &Host::default()), Ok(()));
    }
}

#[test]
fn every_count_of_samples_has_every_spread() {
    let fixture = Fixture::new();
    let camera = Camera::look_at([3.0, 0.5, 4.0], [0.0; 3], None, 45.0, [8, 4]).unwrap();
    for samples in [16, 32, 64, 128, 256] {
        for pattern in [SamplePattern::Stratified, SamplePattern::LowDiscrepancy] {
            for spread in [Correlated, Decorrelated, Interleaved] {
                let request = fixture.request(1, ReceiverSource::Camera(&camera));
                let folded = DepthComplexity { samples, pattern, spread, ..DepthComplexity::default() };
                let technique = Technique::DepthComplexity(folded.clone());
                assert_eq!(technique.check(), Ok(()));
                let (_, values) = stage(&technique, &request);
                assert_eq!(values["light samples"].len() as u32, folded.sampling(0).sets() * samples * 16);
            }
        }
    }
}

#[test]
fn ray_traced_interleaved_everything() {
    let fixture = Fixture::new();
    let mut request = Request { channels: 3, ..fixture.request_for(1, fixture.camera(), 4) };
    request.wants.picture = Some(Shading::Integrated);
    request.wants.standard_error = true;
    insta::assert_snapshot!(traced(Interleaved).plan(&request));
}

#[test]
fn depth_complexity_interleaved() {
    let fixture = Fixture::new();
    let request = fixture.request(1, fixture.camera());
    insta::assert_snapshot!(folded(Interleaved).plan(&Request { opens_block: false, opens_run: false, ..request }));
}

#[test]
fn depth_complexity_decorrelated_points() {
    let fixture = Fixture::new();
    insta::assert_snapshot!(folded(Decorrelated).plan(&fixture.request(1, fixture.points())));
}
