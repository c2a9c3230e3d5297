//! Every technique over a grid of calls: the device accepts every plan, and outputs have exact sizes.

use std::collections::BTreeMap;
use std::sync::Arc;

use softshadow_engine::WgpuEngine;
use softshadow_plan::{Content, ContentKey, Engine as _, RunReport, StageReport, Timing};
use softshadow_scene::{
    Camera, Light, LightShape, LightTexture, LocalScene, Material, Mesh, Points, SampleSpread, Scene, look_at,
};
use softshadow_techniques::depth_complexity::{Counters, Evaluation, OccluderUnit};
use softshadow_techniques::parts::occluder_buffers::boundary_of;
use softshadow_techniques::{
    DepthComplexity, HardShadowMap, OccluderContents, OcclusionCamera, PenumbraMap, RayTraced, ReceiverSource,
    SceneContents, Shading, Technique, VisibilityProgram, Wants, blocks,
};

use crate::programs::engine;

const SIZE: [u32; 2] = [24, 16];

/// Two sheets of two triangles in one sub-scene, or in as many as `binding` bytes make necessary; the upper one may be semi-opaque.
fn sheets(binding: u64, opacity: f32) -> SceneContents {
    let rows = |z: f64| vec![[-1.0, -1.0, z], [1.0, -1.0, z], [1.0, 1.0, z], [-1.0, 1.0, z]];
    let material = |opacity| Material { opacity, ..Material::default() };
    let sheet = |z, opacity| Mesh::new("sheet", rows(z), vec![[0, 1, 2], [0, 2, 3]], material(opacity)).unwrap();
    let scene = Scene::new(vec![sheet(0.0, 1.0), sheet(0.5, opacity)]).unwrap();
    SceneContents::new(LocalScene::new(&scene, None, binding))
}

fn lights() -> Vec<Light> {
    let light = |shape, z| Light::new(shape, look_at([0.0, 0.0, z], [0.0, 0.0, -9.0], Some([0.0, 1.0, 0.0])).unwrap());
    let rectangle = LightShape::Rectangle { width: 1.0, height: 0.5 };
    let texture = LightTexture::new(1, 1, vec![[1.0, 0.5, 0.0]]).unwrap();
    vec![
        light(rectangle.clone(), 5.0).unwrap(),
        light(LightShape::Sphere { radius: 0.2 }, 0.25).unwrap(),
        // The upper sheet touches this one.
        light(LightShape::Sphere { radius: 0.3 }, 0.5).unwrap(),
        light(LightShape::Sun { angular_diameter: 0.01 }, 5.0).unwrap(),
        light(rectangle, 5.0).unwrap().with_texture(texture).unwrap(),
    ]
}

fn techniques() -> Vec<Technique> {
    let traced =
        |samples, probes, passes| Technique::RayTraced(RayTraced { samples, probes, passes, ..RayTraced::default() });
    let mut all = vec![traced(64, 0, 1), traced(33, 8, 3), traced(1, 0, 1)];
    all.extend([16, 300].map(|resolution| Technique::HardShadowMap(HardShadowMap { resolution })));
    all.push(Technique::PenumbraMap(PenumbraMap { resolution: 300, ..PenumbraMap::default() }));
    all.push(Technique::OcclusionCamera(OcclusionCamera { resolution: 48, ..OcclusionCamera::default() }));
    let folded =
        |samples, passes| Technique::DepthComplexity(DepthComplexity { samples, passes, ..DepthComplexity::default() });
    all.extend([folded(64, 1), folded(33, 2), folded(256, 1)]);
    for spread in [SampleSpread::Decorrelated, SampleSpread::Interleaved] {
        all.push(Technique::RayTraced(RayTraced { spread, samples: 33, probes: 8, passes: 2, ..RayTraced::default() }));
        all.push(Technique::DepthComplexity(DepthComplexity {
            spread,
            tile: 3,
            passes: 2,
            ..DepthComplexity::default()
        }));
    }
    let drawn = |samples, counters, batches| {
        let (evaluation, passes) = (Evaluation::Blended, batches);
        let settings = DepthComplexity { samples, counters, batches, passes, evaluation, ..DepthComplexity::default() };
        Technique::DepthComplexity(settings)
    };
    all.extend([drawn(64, Counters::Words, 1), drawn(40, Counters::Float, 2), drawn(256, Counters::Float, 1)]);
    let covered = |samples, passes| {
        let unit = OccluderUnit::Triangles;
        Technique::DepthComplexity(DepthComplexity { samples, passes, unit, ..DepthComplexity::default() })
    };
    all.extend([covered(33, 2), covered(256, 1)]);
    all
}

/// Whether a technique serves such receivers of such a scene here.
fn serves(technique: &Technique, scene: &SceneContents, receivers: ReceiverSource<'_>, engine: &WgpuEngine) -> bool {
    technique.check_call(receivers, &lights()[..1], &engine.host()).is_ok() && technique.check_scene(scene).is_ok()
}

/// The lights without the one that triangles touch, where it is refused: over glass, for wedges, and by the occlusion camera.
fn served(technique: &Technique, scene: &SceneContents, lights: &[Light]) -> Vec<Light> {
    let refuses = match technique {
        Technique::DepthComplexity(settings) => settings.evaluation == Evaluation::Blended,
        Technique::OcclusionCamera(_) => true,
        _ => false,
    };
    let is_refused = |index: usize| index == 2 && (scene.opacity.is_some() || refuses);
    lights.iter().enumerate().filter(|(index, _)| !is_refused(*index)).map(|(_, light)| light.clone()).collect()
}

fn occluders(scene: &SceneContents, lights: &[Light]) -> Vec<Arc<OccluderContents>> {
    let of = |light| OccluderContents::new(&scene.local, boundary_of(&scene.local, light)).unwrap();
    lights.iter().map(|light| Arc::new(of(light))).collect()
}

/// Runs a program and returns the size of every output by stage.
fn sizes(engine: &WgpuEngine, program: &VisibilityProgram<'_>) -> (RunReport, Vec<BTreeMap<String, usize>>) {
    program.check().unwrap();
    let everything = program.scene.contents().chain(program.occluders.iter().flat_map(|o| o.contents()));
    let uploads: BTreeMap<ContentKey, Content> = everything.map(|c| (c.key, c.clone())).collect();
    let mut rows = Vec::new();
    let report = engine
        .run(program, &uploads, Timing::Device, &mut |stage: Option<StageReport>| {
            rows.extend(stage.map(|s| s.outputs.into_iter().map(|(label, bytes)| (label, bytes.len())).collect()));
            true
        })
        .unwrap_or_else(|error| panic!("{:?}: {error}", program.technique));
    assert_eq!(report.stages, program.stages());
    (report, rows)
}

#[test]
fn the_device_accepts_every_plan_and_outputs_have_exact_sizes() {
    let engine = engine();
    let scenes = [sheets(1 << 20, 1.0), sheets(128, 1.0), sheets(128, 0.5)];
    assert_eq!(scenes.each_ref().map(|s| s.local.sub_scenes.len()), [1, 2, 2]);
    let camera = Camera::look_at([3.0, 0.5, 4.0], [0.0; 3], None, 45.0, SIZE).unwrap();
    let points = Points::new((0..77).map(|n| [0.01 * f64::from(n), 0.0, 0.1]).collect(), None).unwrap();
    let lights = lights();
    let mut runs = 0;
    for technique in techniques() {
        for scene in &scenes {
            let lights = served(&technique, scene, &lights);
            let occluders = occluders(scene, &lights);
            for receivers in [ReceiverSource::Camera(&camera), ReceiverSource::Points(&points)] {
                if !serves(&technique, scene, receivers, &engine) {
                    continue;
                }
                for picture in [None, Some(Shading::Integrated), Some(Shading::Modulated)] {
                    for most in [usize::MAX, 100] {
                        let wants = Wants { standard_error: true, sample_masks: true, picture };
                        let blocks = blocks(receivers.count(), receivers.row(), technique.halo_rows() as usize, most);
                        let (channels, host) = (3, engine.host());
                        let program = VisibilityProgram {
                            technique: &technique,
                            scene,
                            lights: &lights,
                            occluders: &occluders,
                            receivers,
                            blocks,
                            channels,
                            wants,
                            host,
                        };
                        let (report, rows) = sizes(&engine, &program);
                        assert_eq!(report.submissions, program.stages(), "one submission a stage");
                        check_sizes(&program, &rows);
                        runs += 1;
                    }
                }
            }
        }
    }
    // Of nineteen, two average pixels, and three draw on images; these three and the two that fold triangles know no semi-opaque sheets.
    assert_eq!(runs, (19 * 3 - 5 + 14 * 3 - 2) * 3 * 2);
}

/// Outputs of every stage against what is asked for: values with a light's last pass, receivers and pictures once a block.
fn check_sizes(program: &VisibilityProgram<'_>, rows: &[BTreeMap<String, usize>]) {
    for (index, row) in rows.iter().enumerate() {
        let task = program.task(index).unwrap();
        let count = program.blocks[task.block].count;
        let opens = task.stage == 0;
        let last_pass = task.pass + 1 == program.technique.passes() && task.stage + 1 == program.technique.stages();
        let mut expected = BTreeMap::new();
        if opens && task.light == 0 && task.pass == 0 {
            expected.insert("receivers".to_owned(), count * 32);
        }
        if matches!(program.technique, Technique::RayTraced(_)) {
            for index in 0..program.scene.local.sub_scenes.len() {
                expected.insert(format!("trace counts {index}"), 16);
            }
        }
        if matches!(program.technique, Technique::DepthComplexity(_)) && opens {
            expected.insert("list counts".to_owned(), 32);
            if program.technique.stages() == 2 {
                expected.insert("largest counts".to_owned(), 16);
            }
        }
        if last_pass {
            expected.insert("visibility".to_owned(), count * 4 * 3);
            if matches!(program.technique, Technique::OcclusionCamera(_)) {
                expected.insert("camera counts".to_owned(), 16);
            } else if !matches!(program.technique, Technique::HardShadowMap(_) | Technique::PenumbraMap(_)) {
                let words = program.technique.samples().div_ceil(32) as usize;
                expected.insert("standard error".to_owned(), count * 4 * 3);
                expected.insert("blocked samples".to_owned(), count * 4 * words);
            }
        }
        if matches!(program.technique, Technique::PenumbraMap(_)) && program.occluders[task.light].edge_count > 0 {
            expected.insert("receivers astray".to_owned(), 4);
        }
        if last_pass && task.light + 1 == program.lights.len() && program.wants.picture.is_some() {
            expected.insert("color".to_owned(), count * 16);
        }
        assert_eq!(*row, expected, "stage {index} of {:?}", program.technique);
    }
}

#[test]
fn one_light_in_one_block_is_one_submission() {
    let engine = engine();
    let (scene, lights) = (sheets(1 << 20, 1.0), lights());
    let camera = Camera::look_at([3.0, 0.5, 4.0], [0.0; 3], None, 45.0, [512, 512]).unwrap();
    let receivers = ReceiverSource::Camera(&camera);
    for technique in Technique::defaults() {
        let program = VisibilityProgram {
            technique: &technique,
            scene: &scene,
            lights: &lights[..1],
            occluders: &occluders(&scene, &lights[..1]),
            receivers,
            blocks: blocks(receivers.count(), receivers.row(), 0, usize::MAX),
            channels: 1,
            wants: Wants::default(),
            host: engine.host(),
        };
        assert_eq!(sizes(&engine, &program).0.submissions, 1, "{}", technique.name());
    }
}

#[test]
fn an_empty_scene_is_run_too() {
    let engine = engine();
    let scene = SceneContents::new(LocalScene::new(&Scene::new(Vec::new()).unwrap(), None, 1 << 20));
    let (points, lights) = (Points::new(vec![[0.0; 3]; 9], None).unwrap(), lights());
    for technique in techniques().iter().filter(|t| serves(t, &scene, ReceiverSource::Points(&points), &engine)) {
        let program = VisibilityProgram {
            technique,
            scene: &scene,
            lights: &lights,
            occluders: &occluders(&scene, &lights),
            receivers: ReceiverSource::Points(&points),
            blocks: blocks(9, 1, 0, 4),
            channels: 3,
            wants: Wants::default(),
            host: engine.host(),
        };
        let (_, rows) = sizes(&engine, &program);
        let values: usize = rows.iter().filter_map(|row| row.get("visibility")).sum();
        assert_eq!(values, 9 * lights.len() * 12, "{technique:?}");
    }
}
