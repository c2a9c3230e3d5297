//! The program of a whole call: every block, light and pass once, in that order, with receivers first and results last.

use softshadow_plan::{Host, Program, Step, check};
use softshadow_scene::{MAX_SAMPLES, Points, SceneError};
use softshadow_techniques::{
    DepthComplexity, OcclusionCamera, RayTraced, ReceiverSource, Shading, StageTask, Technique, TechniqueError,
    VisibilityProgram, Wants, blocks,
};

use crate::requests::Fixture;

fn program<'a>(fixture: &'a Fixture, technique: &'a Technique) -> VisibilityProgram<'a> {
    VisibilityProgram {
        technique,
        scene: &fixture.scenes[1],
        lights: &fixture.lights[..2],
        occluders: if technique.wants_occluders() { &fixture.occluders[1][..2] } else { &[] },
        receivers: fixture.camera(),
        // Four rows of eight pixels, two at a time.
        blocks: blocks(32, 8, 0, 16),
        channels: 1,
        wants: Wants { picture: Some(Shading::Integrated), ..Wants::default() },
        host: Host::default(),
    }
}

/// The techniques that take passes.
fn passes(passes: u32) -> [Technique; 2] {
    [
        Technique::RayTraced(RayTraced { passes, samples: 4, ..RayTraced::default() }),
        Technique::DepthComplexity(DepthComplexity { passes, samples: 4, ..DepthComplexity::default() }),
    ]
}

#[test]
fn every_block_light_and_pass_has_its_stage() {
    let fixture = Fixture::new();
    for technique in passes(3) {
        let program = program(&fixture, &technique);
        program.check().unwrap();
        assert_eq!(program.stages(), 2 * 2 * 3);
        let tasks: Vec<StageTask> = (0..).map_while(|index| program.task(index)).collect();
        let mut expected = Vec::new();
        for block in 0..2 {
            for light in 0..2 {
                expected.extend((0..3).map(|pass| StageTask { block, light, pass, stage: 0 }));
            }
        }
        assert_eq!(tasks, expected);
    }
}

#[test]
fn stages_open_and_close_their_blocks() {
    let fixture = Fixture::new();
    for technique in passes(2) {
        let program = program(&fixture, &technique);
        let mut rows = Vec::new();
        let mut index = 0;
        while let Step::Run(stage) = program.step(index, &[]) {
            check(&stage.plan, &program.host).unwrap();
            let has = |label: &str| stage.plan.passes.iter().any(|p| p.label == label);
            let leaves =
                |label: &str| stage.plan.outputs.iter().any(|id| stage.plan.resources[id.index()].label == label);
            rows.push([has("draw triangle ids 0"), has("place receivers 0"), leaves("visibility"), leaves("color")]);
            index += 1;
        }
        // Pixels are drawn once, receivers placed once a block; values leave with a light's last pass, the picture with a block's.
        let block =
            |draws| [[draws, true, false, false], [false, false, true, false], [false; 4], [false, false, true, true]];
        assert_eq!(rows, [block(true), block(false)].concat(), "{}", technique.name());
    }
}

#[test]
fn every_stage_has_what_hides_its_light() {
    let fixture = Fixture::new();
    let technique = Technique::DepthComplexity(DepthComplexity::default());
    let program = program(&fixture, &technique);
    // Both sheets lie below the first light, and one below the second, which is between them.
    let mut edges = Vec::new();
    for index in 0..program.stages() {
        let Step::Run(stage) = program.step(index, &[]) else { panic!("stage {index} runs") };
        let uploaded: Vec<_> = stage.plan.content_keys().collect();
        let own = &fixture.occluders[1][program.task(index).unwrap().light];
        // Corners of faces serve triangles, and here edges are folded.
        let mut asked = own.contents().filter(|content| content.key != own.face_corners.key);
        assert!(asked.all(|content| uploaded.contains(&content.key)));
        edges.extend(stage.plan.memory().into_iter().filter(|(label, _)| *label == "edges").map(|(_, n)| n / 32));
    }
    assert_eq!(edges, [10, 5, 10, 5]);
}

#[test]
fn the_occlusion_camera_needs_float32_targets() {
    let fixture = Fixture::new();
    let technique = Technique::OcclusionCamera(OcclusionCamera::default());
    let mut program = program(&fixture, &technique);
    assert_eq!(program.check(), Ok(()));
    program.host.features.float32_drawable = false;
    let words = program.check().unwrap_err().to_string();
    assert!(words.starts_with("occlusion_camera device: draws into rgba32float targets"), "{words}");
    assert!(words.ends_with("or trace rays"), "{words}");
}

#[test]
fn a_program_that_cannot_run_says_so_before_it_starts() {
    let fixture = Fixture::new();
    let samples = format!("ray_traced samples: must lie between 1 and {MAX_SAMPLES}, got ");
    for (settings, words) in [
        (RayTraced { samples: 0, ..RayTraced::default() }, format!("{samples}0")),
        (RayTraced { samples: MAX_SAMPLES + 1, ..RayTraced::default() }, format!("{samples}{}", MAX_SAMPLES + 1)),
        (RayTraced { passes: 0, ..RayTraced::default() }, "ray_traced passes: must be at least 1".into()),
        (
            RayTraced { probes: 64, ..RayTraced::default() },
            "ray_traced probes: must be fewer than the 64 samples, or 0 for none".into(),
        ),
    ] {
        let technique = Technique::RayTraced(settings);
        assert_eq!(program(&fixture, &technique).check().unwrap_err().to_string(), words);
    }
    let most = Technique::RayTraced(RayTraced { samples: MAX_SAMPLES, ..RayTraced::default() });
    assert_eq!(program(&fixture, &most).check(), Ok(()));
    let samples = "depth_complexity samples: must lie between 1 and 256, got ";
    for (settings, words) in [
        (DepthComplexity { samples: 0, ..DepthComplexity::default() }, format!("{samples}0; more come as passes")),
        (DepthComplexity { samples: 257, ..DepthComplexity::default() }, format!("{samples}257; more come as passes")),
        (
            DepthComplexity { passes: 0, ..DepthComplexity::default() },
            "depth_complexity passes: must be at least 1".into(),
        ),
    ] {
        let technique = Technique::DepthComplexity(settings);
        assert_eq!(program(&fixture, &technique).check().unwrap_err().to_string(), words);
    }
    let most = Technique::DepthComplexity(DepthComplexity { samples: 256, ..DepthComplexity::default() });
    assert_eq!(program(&fixture, &most).check(), Ok(()));
    for resolution in [15, 16_385] {
        let technique = Technique::HardShadowMap(softshadow_techniques::HardShadowMap { resolution });
        let words = program(&fixture, &technique).check().unwrap_err().to_string();
        assert_eq!(words, format!("hard_shadow_map resolution: must lie between 16 and 16384, got {resolution}"));
    }
    let bent = softshadow_techniques::OcclusionCamera::default;
    for (settings, words) in [
        (OcclusionCamera { resolution: 4097, ..bent() }, "resolution: must lie between 16 and 4096, got 4097"),
        (OcclusionCamera { resolution: 18, ..bent() }, "resolution: must be a multiple of 4, got 18"),
        (OcclusionCamera { steps: 4, ..bent() }, "steps: must lie between 1 and 3, got 4"),
        (OcclusionCamera { steps: 0, ..bent() }, "steps: must lie between 1 and 3, got 0"),
        (OcclusionCamera { bias: f32::NAN, ..bent() }, "bias: must lie between 0 and 1, got NaN"),
    ] {
        let technique = Technique::OcclusionCamera(settings);
        assert_eq!(program(&fixture, &technique).check().unwrap_err().to_string(), format!("occlusion_camera {words}"));
    }
}

#[test]
fn points_beyond_float32_are_named_before_anything_runs() {
    let fixture = Fixture::new();
    for technique in Technique::defaults() {
        for (far, fits) in [(1e30, true), (1e300, false)] {
            let mut positions = vec![[0.0, 0.0, 0.1]; 9];
            positions[7] = [0.0, far, 0.0];
            let points = Points::new(positions, None).unwrap();
            let program = VisibilityProgram {
                receivers: ReceiverSource::Points(&points),
                // The far point is in the last block: every block's points are looked at.
                blocks: blocks(9, 1, 0, 2),
                ..program(&fixture, &technique)
            };
            let what = "points, relative to the scene in float32,".to_owned();
            let expected = Err(TechniqueError::Scene(SceneError::NotFinite { what, index: 7 }));
            assert_eq!(program.check(), if fits { Ok(()) } else { expected }, "{}", technique.name());
        }
    }
}
