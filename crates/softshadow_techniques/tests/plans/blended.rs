//! Plans of the blended evaluation: two stages, of which the second follows from what the first reads back.

use std::collections::BTreeMap;

use softshadow_plan::{Host, Origin, Plan, Program, Step, Values, Work, check};
use softshadow_scene::Camera;
use softshadow_techniques::depth_complexity::{Counters, Evaluation, InitialCounts};
use softshadow_techniques::{
    Block, DepthComplexity, ReceiverSource, Request, Technique, VisibilityProgram, Wants, blocks,
};

use crate::requests::{Fixture, SIZE};

const COUNTERS: [Counters; 2] = [Counters::Words, Counters::Float];

fn settings(samples: u32, counters: Counters) -> DepthComplexity {
    DepthComplexity { samples, counters, evaluation: Evaluation::Blended, ..DepthComplexity::default() }
}

/// A host that blends, with room for all of the paper's targets or for as many as every host has.
fn host(color_bytes: u32) -> Host {
    let mut host = Host::default();
    host.features.float32_blendable = true;
    host.limits.color_bytes = color_bytes;
    host
}

/// The plans and values of both stages, when the first reads `decision` back.
fn stages(settings: &DepthComplexity, request: &Request<'_>, decision: [u32; 4]) -> [(Plan, Values); 2] {
    let technique = Technique::DepthComplexity(settings.clone());
    let last = request.closes_light;
    let first = Request { stage: 0, closes_light: false, closes_block: false, ..*request };
    let opens = Request { stage: 1, decision, opens_block: false, opens_run: false, closes_light: last, ..*request };
    [first, opens].map(|request| (technique.plan(&request), technique.values(&request, request.light, 0).unwrap()))
}

fn labels(plan: &Plan) -> Vec<&str> {
    plan.passes.iter().map(|p| p.label.as_str()).collect()
}

fn outputs(plan: &Plan) -> Vec<&str> {
    plan.outputs.iter().map(|id| plan.resources[id.index()].label.as_str()).collect()
}

#[test]
fn every_stage_runs_and_every_parameter_has_its_value() {
    let fixture = Fixture::new();
    for (scene, light) in (0..3).flat_map(|scene| (0..5).map(move |light| (scene, light))) {
        for counters in COUNTERS {
            for (samples, base, batches) in [(1, 8, 1), (16, 64, 2), (33, 16, 1), (64, 64, 2), (256, 256, 1)] {
                let initial_counts = if batches == 2 { InitialCounts::ZFail } else { InitialCounts::Rays };
                let settings = DepthComplexity { base, batches, initial_counts, ..settings(samples, counters) };
                for host in [host(32), host(128)] {
                    for largest in [[0; 4], [70, 9, 2, 0], [9, 70, 2, 0], [70_000, 70_000, 3, 0], [u32::MAX; 4]] {
                        let request = Request { host, ..fixture.request_for(scene, fixture.camera(), light) };
                        for (plan, values) in stages(&settings, &request, largest) {
                            check(&plan, &host).unwrap_or_else(|error| panic!("{error}\n{plan}"));
                            for parameter in plan.resources.iter().filter(|r| r.origin == Origin::Parameter) {
                                let given = values.get(&parameter.label).map(|value| value.len() as u64);
                                assert_eq!(given, Some(parameter.bytes()), "{}\n{plan}", parameter.label);
                            }
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn a_light_without_casters_has_no_wedge() {
    let fixture = Fixture::new();
    for counters in COUNTERS {
        let [(first, _), (second, _)] = stages(&settings(64, counters), &fixture.request(0, fixture.camera()), [0; 4]);
        let wedges = |plan: &Plan| labels(plan).iter().filter(|l| !l.starts_with("draw triangle ids")).count();
        assert_eq!((wedges(&first), labels(&second)), (1, vec!["all samples decided", "resolve"]), "{first}");
        assert_eq!((outputs(&first), first.decision), (vec!["receivers"], None));
        let [(first, _), (second, _)] = stages(&settings(64, counters), &fixture.request(1, fixture.camera()), [0; 4]);
        assert!(labels(&first).contains(&"list wedges") && labels(&second).iter().any(|l| l.starts_with("count")));
        assert_eq!(outputs(&first), ["receivers", "list counts", "largest counts"]);
        assert_eq!(first.decision, first.find("largest counts"));
        assert_eq!(outputs(&second), ["visibility"]);
    }
}

#[test]
fn shadow_volumes_and_rays_count_alone() {
    let fixture = Fixture::new();
    let counting = |initial_counts| {
        let settings = DepthComplexity { initial_counts, ..settings(64, Counters::Words) };
        let [(first, _), (second, _)] = stages(&settings, &fixture.request(1, fixture.camera()), [0; 4]);
        let words = ["bound tiles", "find faces", "count reference depth", "count caps", "count sides", "take layers"];
        let found = words.map(|word| labels(&first).contains(&word));
        (found, first.find("face hierarchy").is_some(), second)
    };
    let [rays, volumes] = [InitialCounts::Rays, InitialCounts::ZFail].map(counting);
    assert_eq!((rays.0, rays.1), ([true, true, true, false, false, false], true));
    assert_eq!((volumes.0, volumes.1), ([false, false, false, true, true, true], false));
    assert_eq!(rays.2, volumes.2, "what follows is the same");
}

#[test]
fn what_was_found_chooses_words_targets_and_draws() {
    let fixture = Fixture::new();
    let counted = |settings: &DepthComplexity, host: Host, largest: [u32; 4]| {
        let request = Request { host, ..fixture.request(1, fixture.camera()) };
        let [_, (plan, _)] = stages(settings, &request, largest);
        let draws = plan.passes.iter().filter(|pass| matches!(pass.work, Work::Raster(_))).count();
        let bytes = plan.memory().into_iter().find(|(label, _)| *label == "counters").unwrap().1;
        (bytes / u64::from(SIZE[0] * SIZE[1]), draws)
    };
    let [words, float] = COUNTERS.map(|counters| settings(64, counters));
    let bound = |count| [count, 0, 1, 0];
    // Bytes of a receiver: 4, 6, 8, 16 and 32 bits a sample, in whole words.
    assert_eq!(
        [13, 55, 239, 256, 70_000].map(|n| counted(&words, host(32), bound(n))),
        [(32, 1), (52, 1), (64, 1), (128, 1), (256, 1)]
    );
    // Targets of 16 bytes: the paper's counters for base 8, 16, 64 and 256.
    assert_eq!([6, 13, 55, 239].map(|n| counted(&float, host(128), bound(n))), [(32, 1), (48, 1), (64, 1), (96, 1)]);
    // With the room that every host has wedges are drawn more often, into the same two targets.
    assert_eq!([6, 13, 55, 239].map(|n| counted(&float, host(32), bound(n))), [(32, 1), (32, 2), (32, 2), (32, 3)]);
    // Two batches draw each twice.
    let twice = DepthComplexity { batches: 2, ..float };
    assert_eq!(counted(&twice, host(32), bound(239)), (32, 6));
    assert_eq!(counted(&DepthComplexity { batches: 2, ..words }, host(32), bound(1)), (32, 2));
}

#[test]
fn a_block_is_sized_by_no_less_than_a_receiver_takes() {
    let fixture = Fixture::new();
    for (samples, counters) in
        [(1, Counters::Words), (64, Counters::Words), (64, Counters::Float), (256, Counters::Float)]
    {
        let settings = settings(samples, counters);
        let technique = Technique::DepthComplexity(settings.clone());
        for channels in [1, 3] {
            // What grows with the receivers, by label, over both stages: what one leaves stays for the next.
            let taken = |size: [u32; 2]| {
                let camera = Camera::look_at([3.0, 0.5, 4.0], [0.0; 3], None, 45.0, size).unwrap();
                let count = (size[0] * size[1]) as usize;
                let request = Request {
                    channels,
                    host: host(128),
                    receivers: ReceiverSource::Camera(&camera),
                    block: Block { first: 0, count, skip: 0, keep: count },
                    // The image's ids and depth are there once, whatever the blocks.
                    opens_block: false,
                    opens_run: false,
                    ..fixture.request(1, fixture.camera())
                };
                let widest = stages(&settings, &request, [1 << 23, 1 << 23, 0, 0]);
                let resources: BTreeMap<String, u64> = widest
                    .iter()
                    .flat_map(|(plan, _)| plan.memory().into_iter().map(|(label, bytes)| (label.to_owned(), bytes)))
                    .collect();
                resources.values().sum::<u64>()
            };
            let each = technique.bytes_per_receiver(u64::from(channels), 1, false) + 32;
            let (small, large) = (taken([64, 64]), taken([64, 256]));
            let growth = large - small;
            assert!(growth <= 3 * 64 * 64 * each, "{growth} {each} {settings:?}");
            // And not so much more that blocks would be small for nothing.
            assert!(growth + 3 * 64 * 64 * 5 >= 3 * 64 * 64 * each, "{growth} {each} {settings:?}");
        }
    }
}

#[test]
fn calls_that_cannot_be_drawn_are_refused_by_name() {
    let fixture = Fixture::new();
    let refused = |settings: DepthComplexity, receivers: ReceiverSource<'_>, host: &Host| {
        Technique::DepthComplexity(settings)
            .check_call(receivers, &fixture.lights, host)
            .map_err(|error| error.to_string())
    };
    let plain = Host::default();
    let words = settings(64, Counters::Words);
    assert_eq!(refused(words.clone(), fixture.camera(), &plain), Ok(()));
    let points = refused(words.clone(), fixture.points(), &plain).unwrap_err();
    assert_eq!(
        points,
        "depth_complexity evaluation: 'blended' draws over a camera's image and knows no points; use 'tiled'"
    );
    let mut blind = plain;
    blind.features.raster = false;
    assert_eq!(
        refused(words, fixture.camera(), &blind).unwrap_err(),
        "depth_complexity device: it draws triangles, which this one does not; use 'gpu' or 'software'"
    );
    let float = settings(64, Counters::Float);
    let words = refused(float.clone(), fixture.camera(), &plain).unwrap_err();
    assert!(words.contains("counters") && words.contains("float32-blendable") && words.contains("'words'"), "{words}");
    assert_eq!(refused(float, fixture.camera(), &host(32)), Ok(()));
    let z_fail = DepthComplexity { initial_counts: InitialCounts::ZFail, ..settings(64, Counters::Words) };
    let words = refused(z_fail.clone(), fixture.camera(), &plain).unwrap_err();
    assert!(words.contains("initial_counts") && words.contains("sphere") && words.contains("'rays'"), "{words}");
    let flat = Technique::DepthComplexity(z_fail).check_call(fixture.camera(), &fixture.lights[..2], &plain);
    assert_eq!(flat, Ok(()));
    // Tiles serve everybody.
    assert_eq!(refused(DepthComplexity::default(), fixture.points(), &blind), Ok(()));
}

#[test]
fn settings_out_of_range_are_named() {
    let refused = |settings: DepthComplexity| Technique::DepthComplexity(settings).check().unwrap_err().to_string();
    let blended = settings(64, Counters::Float);
    assert_eq!(
        refused(DepthComplexity { base: 32, ..blended.clone() }),
        "depth_complexity base: must be 8, 16, 64 or 256, got 32"
    );
    for batches in [0, 3] {
        let words = refused(DepthComplexity { batches, ..blended.clone() });
        assert_eq!(words, format!("depth_complexity batches: must be 1 or 2, got {batches}"));
    }
    let tiled = DepthComplexity::default();
    for (settings, name) in [
        (DepthComplexity { counters: Counters::Float, ..tiled.clone() }, "counters"),
        (DepthComplexity { initial_counts: InitialCounts::ZFail, ..tiled.clone() }, "initial_counts"),
        (DepthComplexity { base: 64, ..tiled.clone() }, "base"),
        (DepthComplexity { batches: 2, ..tiled.clone() }, "batches"),
    ] {
        assert_eq!(refused(settings), format!("depth_complexity {name}: counts for evaluation 'blended' alone"));
    }
}

#[test]
fn a_program_has_two_stages_a_pass_and_the_second_follows_from_the_first() {
    let fixture = Fixture::new();
    let technique = Technique::DepthComplexity(DepthComplexity { passes: 2, ..settings(64, Counters::Float) });
    let program = VisibilityProgram {
        technique: &technique,
        scene: &fixture.scenes[1],
        lights: &fixture.lights[..2],
        occluders: &fixture.occluders[1][..2],
        receivers: fixture.camera(),
        blocks: blocks(32, 8, 0, 16),
        channels: 1,
        wants: Wants::default(),
        host: host(128),
    };
    program.check().unwrap();
    assert_eq!(program.stages(), 2 * 2 * 2 * 2);
    let mut rows = Vec::new();
    for index in 0.. {
        let Step::Run(stage) = program.step(index, &[if index % 4 == 1 { 200 } else { 2 }, 0, 0, 0]) else { break };
        check(&stage.plan, &program.host).unwrap();
        let has = |label: &str| labels(&stage.plan).contains(&label);
        let task = program.task(index).unwrap();
        assert_eq!(task.stage == 0, stage.plan.decision.is_some());
        assert_eq!(task.stage as usize, index % 2);
        let targets = stage.plan.find("counters").map_or(0, |id| stage.plan.resources[id.index()].bytes() / (16 * 16));
        rows.push((
            has("draw triangle ids 0"),
            has("place receivers 0"),
            outputs(&stage.plan).contains(&"visibility"),
            targets,
        ));
    }
    let light = |draws, places| {
        [(draws, places, false, 0), (false, false, false, 6), (false, false, false, 0), (false, false, true, 2)]
    };
    let block = |draws| [light(draws, true), light(false, false)].concat();
    assert_eq!(rows, [block(true), block(false)].concat());
}

/// Rows like those of the paper's table of memory: 1024 × 1024 pixels, 64 samples, one light.
#[test]
fn memory_of_an_image_of_a_million_pixels() {
    let fixture = Fixture::new();
    let camera = Camera::look_at([3.0, 0.5, 4.0], [0.0; 3], None, 45.0, [1024, 1024]).unwrap();
    let receivers = ReceiverSource::Camera(&camera);
    let count = receivers.count();
    let block = Block { first: 0, count, skip: 0, keep: count };
    let mut text = String::new();
    for counters in COUNTERS {
        let request = Request { receivers, block, host: host(128), ..fixture.request(1, fixture.camera()) };
        let [(_, _), (plan, _)] =
            stages(&DepthComplexity { base: 64, ..settings(64, counters) }, &request, [20, 20, 2, 0]);
        text += &format!("{counters:?}, base 64\n");
        for (label, bytes) in plan.memory() {
            text += &format!("{bytes:>12}  {label}\n");
        }
    }
    insta::assert_snapshot!(text);
}

#[test]
fn both_stages_as_text() {
    let fixture = Fixture::new();
    for (name, counters, batches) in [("words", Counters::Words, 1), ("float", Counters::Float, 2)] {
        let request = Request { host: host(32), ..fixture.request(1, fixture.camera()) };
        let [(first, _), (second, _)] =
            stages(&DepthComplexity { batches, ..settings(64, counters) }, &request, [100, 90, 4, 0]);
        insta::assert_snapshot!(format!("blended_{name}"), format!("{first}\n{second}"));
    }
}
