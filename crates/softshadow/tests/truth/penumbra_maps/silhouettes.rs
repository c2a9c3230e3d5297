//! The list of silhouettes as the light's centre sees them: which edges, and on which side there are more layers.

use std::collections::{BTreeMap, BTreeSet};

use softshadow::{Light, LightShape, Points, Ramp};
use softshadow_engine::{AdapterChoice, WgpuEngine};
use softshadow_plan::{Content, ContentKey, Engine, Program, Stage, StageReport, Step, Timing};
use softshadow_scene::LocalScene;
use softshadow_techniques::parts::occluder_buffers::boundary_of;
use softshadow_techniques::{OccluderContents, ReceiverSource, SceneContents, VisibilityProgram, Wants, blocks};

use super::over;
use crate::common::penumbra_map;
use crate::shapes::{Point, Triangle, cross, cuboid, dot, plate, scene, sphere, sub, torus};

/// A program whose stages give out the list, too.
struct Listed<'a>(VisibilityProgram<'a>);

impl Program for Listed<'_> {
    fn step(&self, index: usize, decision: &[u32]) -> Step {
        let Step::Run(stage) = self.0.step(index, decision) else { return Step::Done };
        let Stage { mut plan, values } = *stage;
        let more: Vec<_> = ["light silhouettes", "silhouette corners"].iter().filter_map(|l| plan.find(l)).collect();
        plan.outputs.extend(more);
        Step::run(plan, values)
    }
}

/// An edge by the positions of its ends, and its weight.
type Weights = BTreeMap<[[u32; 3]; 2], i32>;

/// The scene in local float32, and what the device lists of it.
fn listed(triangles: &[Triangle], light: &Light) -> (Vec<[[f32; 3]; 3]>, Point, Weights) {
    let engine = WgpuEngine::new(AdapterChoice::Software).unwrap();
    let local = LocalScene::new(&scene(triangles), None, engine.host().limits.storage_binding_bytes);
    let center = light.local(&local.frame).center.to_array();
    let contents = SceneContents::new(local);
    let occluders = [OccluderContents::new(&contents.local, boundary_of(&contents.local, light)).unwrap().into()];
    let points = Points::new(vec![[0.0; 3]], None).unwrap();
    let technique = penumbra_map(64, Ramp::Linear);
    let program = Listed(VisibilityProgram {
        technique: &technique,
        scene: &contents,
        lights: std::slice::from_ref(light),
        occluders: &occluders,
        receivers: ReceiverSource::Points(&points),
        blocks: blocks(1, 1, 0, 1),
        channels: 1,
        wants: Wants::default(),
        host: engine.host(),
    });
    let uploads: BTreeMap<ContentKey, Content> =
        contents.contents().chain(occluders[0].contents()).map(|c| (c.key, c.clone())).collect();
    let mut words: BTreeMap<String, Vec<u32>> = BTreeMap::new();
    let mut keep = |stage: Option<StageReport>| {
        for (label, bytes) in stage.into_iter().flat_map(|s| s.outputs) {
            words.insert(label, bytemuck::pod_collect_to_vec(&bytes));
        }
        true
    };
    engine.run(&program, &uploads, Timing::Device, &mut keep).unwrap();
    let [vertices, instances, ..] = words["silhouette corners"][..] else { unreachable!("four words") };
    assert_eq!((vertices % 12, instances), (0, 1));
    let rows = words["light silhouettes"].chunks_exact(8).take(vertices as usize / 12);
    let found: Weights = rows.clone().map(|r| ([[r[0], r[1], r[2]], [r[4], r[5], r[6]]], r[3] as i32)).collect();
    assert_eq!(found.len(), rows.len(), "no edge twice");
    let corners = contents.local.triangles().collect();
    (corners, center, found)
}

/// The same in float64, from the definition: each face counts for the side of its edge on which the centre sees it.
fn expected(triangles: &[[[f32; 3]; 3]], center: Point) -> Weights {
    let mut weights = Weights::new();
    for t in triangles {
        let wide = t.map(|v| v.map(f64::from));
        let height = dot(cross(sub(wide[1], wide[0]), sub(wide[2], wide[0])), sub(center, wide[0]));
        // Seen counter-clockwise, a face lies to the left of each of its sides as they wind.
        let side = if height > 0.0 { 1 } else { -1 };
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            let bits = |v: [f32; 3]| v.map(f32::to_bits);
            *weights.entry([bits(a), bits(b)]).or_default() += side;
            *weights.entry([bits(b), bits(a)]).or_default() -= side;
        }
    }
    weights.retain(|_, w| *w != 0);
    weights
}

/// Edges of the list that the definition has not, or with another weight; and those that it lacks. Either end may come first.
fn different(found: &Weights, expected: &Weights) -> usize {
    let turned = |[a, b]: [[u32; 3]; 2]| [b, a];
    let wrong = found.iter().filter(|(edge, weight)| expected.get(*edge) != Some(weight)).count();
    let either = |edge: [[u32; 3]; 2]| edge.min(turned(edge));
    let edges = |weights: &Weights| weights.keys().map(|edge| either(*edge)).collect::<BTreeSet<_>>();
    wrong + edges(expected).symmetric_difference(&edges(found)).count()
}

#[test]
fn the_list_is_that_of_the_definition() {
    let light = over(LightShape::Disc { radius: 0.3 });
    let open = plate([-0.7, 0.4], [-0.3, 0.9], 0.5);
    // Three sheets at one edge, and a triangle that winds the other way.
    let fan: Vec<Triangle> =
        [[1.0, 0.2, 0.4], [-0.8, 0.5, 0.1], [0.3, -0.9, 0.3]].map(|p| [[0.0, 0.0, 0.0], [0.1, 0.2, 1.0], p]).to_vec();
    for (name, triangles) in [
        ("plate", open),
        ("box", cuboid([-0.5, -0.4, 0.1], [0.6, 0.3, 0.9])),
        ("ball", sphere([0.2, 0.1, 0.7], 0.5, 3)),
        ("ring", torus(0.8, 0.3, 24, 12)),
        ("fan", fan),
    ] {
        let (local, center, found) = listed(&triangles, &light);
        let truth = expected(&local, center);
        println!("{name}: {} of {} sides are silhouettes", found.len(), 3 * triangles.len());
        assert!(!found.is_empty());
        assert_eq!(different(&found, &truth), 0, "{name}: {found:?} {truth:?}");
        // A weight with the other sign, an edge too few, and a light somewhere else are seen.
        let mut spoilt = found.clone();
        spoilt.values_mut().take(1).for_each(|w| *w = -*w);
        assert_eq!(different(&spoilt, &truth), 1, "{name}");
        spoilt.pop_first();
        assert_eq!(different(&spoilt, &truth), 1, "{name}");
        let elsewhere = [center[0] + 3.0, center[1] - 2.0, -center[2]];
        assert!(different(&found, &expected(&local, elsewhere)) > 0, "{name}");
    }
}
