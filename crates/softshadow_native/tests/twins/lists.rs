//! What `depth_complexity` finds out before it folds: masks below the horizon, shafts, silhouettes and lists.
//!
//! Lists stand in chunks, which are handed out in any order, and so do their heads: what is compared is which entries each part and each
//! bundle has.

use softshadow_native::{NativeEngine, NativeSettings, Vectors};
use softshadow_scene::{Camera, Light, LightShape, Material, Mesh, Points, SampleSpread, Scene, look_at, procedural};
use softshadow_techniques::depth_complexity::{DepthComplexity, OccluderUnit, Silhouettes};
use softshadow_techniques::parts::occluder_buffers::boundary_of;
use softshadow_techniques::{OccluderContents, Technique};

use crate::harness::{Buffers, Call, Same, Source, Spoilt, shipped};

/// The last pass before the fold.
const NARROW: &str = "narrow edges";

/// Passes before that which write nothing that these passes read: depths, and what passes to samples.
const OTHERS: &[&str] = &["open samples", "count reference depth"];

/// Set in an edge's count of faces.
const UNEQUAL_FACES: u32 = 0x8000_0000;

const WORDS_OF_PARTS_OF_TILE: usize = 2 * 28;
const HEAD: usize = 10;
const BUNDLES: usize = 8;
const CHUNK: usize = 32;

/// The settings of a technique that lists edges.
fn edges(change: impl FnOnce(&mut DepthComplexity)) -> Technique {
    let mut settings = DepthComplexity { unit: OccluderUnit::Edges, ..DepthComplexity::default() };
    change(&mut settings);
    Technique::DepthComplexity(settings)
}

fn accurate() -> Technique {
    edges(|_| ())
}

/// Ends a call's stages before they fold.
fn before_fold(mut call: Call) -> Call {
    (call.until, call.without) = (Some(NARROW), OTHERS);
    call
}

fn same(label: &str) -> Same {
    match label {
        "edge lists" => Same::Said(lists_of_edges),
        "first faces" => Same::Said(lists_of_faces),
        _ => Same::Bits,
    }
}

fn compare(call: Call) {
    before_fold(call).compare(same);
}

/// Where the chunks begin.
fn chunks(buffers: &Buffers) -> &[u32] {
    let tiles = buffers["tile parts"].len() / WORDS_OF_PARTS_OF_TILE;
    &buffers["edge lists"][2 * HEAD * tiles..]
}

/// What a list holds, after what it belongs to.
fn list(chunks: &[u32], belongs_to: &[u32], first: u32) -> Vec<u32> {
    let (mut entries, mut chunk) = (Vec::new(), first as usize);
    // Before a pass has written them, heads hold whatever an earlier run left.
    while chunk != 0 && (chunk + 1) * CHUNK <= chunks.len() && entries.len() <= chunks.len() {
        let words = &chunks[chunk * CHUNK..][..CHUNK];
        entries.extend(words[2..].iter().take(words[1] as usize));
        chunk = words[0] as usize;
    }
    entries.sort_unstable();
    [belongs_to, &entries].concat()
}

fn lists_of_faces(buffers: &Buffers) -> Vec<Vec<u32>> {
    let chunks = chunks(buffers);
    let firsts = buffers["first faces"].iter().zip(0..);
    firsts.map(|(first, bundle)| list(chunks, &[bundle], *first)).collect()
}

fn lists_of_edges(buffers: &Buffers) -> Vec<Vec<u32>> {
    let chunks = chunks(buffers);
    let parts = buffers["running counts"][0] as usize;
    let heads = buffers["edge lists"].chunks(HEAD).take(parts);
    let is_narrowed = buffers.contains_key("narrow dispatch");
    let lists = heads.flat_map(|head| {
        let bundles = head[2..].iter().zip(0..).take(if is_narrowed { BUNDLES } else { 0 });
        let of_bundles = bundles.map(|(first, bundle)| list(chunks, &[head[0], bundle], *first));
        of_bundles.chain([list(chunks, &[head[0], u32::MAX], head[1])])
    });
    lists.collect()
}

/// A light of another shape where a shipped scene has its own.
fn shaped(name: &str, shape: LightShape) -> Light {
    let shipped = procedural::shipped(name).unwrap();
    let light = shipped.light();
    Light::new(shape, look_at(light.position, light.target, Some(light.up)).unwrap()).unwrap()
}

#[test]
fn shipped_scenes_have_the_same_lists() {
    for (name, size) in [("fork", [96, 64]), ("hall", [64, 48]), ("toruses", [72, 56]), ("cards", [64, 64])] {
        let (scene, light, camera) = shipped(name, size);
        compare(Call::new(accurate(), &scene, vec![light], camera));
    }
}

#[test]
fn lights_of_every_shape_have_the_same_lists() {
    let pentagon = (0..5).map(|k| f64::from(k) * 1.2566).map(|a| [0.5 * a.cos(), 0.6 * a.sin()]).collect();
    for shape in [
        LightShape::Rectangle { width: 1.0, height: 0.5 },
        LightShape::Disc { radius: 0.7 },
        LightShape::Polygon { outline: pentagon },
        LightShape::Sphere { radius: 0.4 },
        LightShape::Sun { angular_diameter: 0.05 },
    ] {
        let (scene, _, camera) = shipped("toruses", [64, 48]);
        compare(Call::new(accurate(), &scene, vec![shaped("toruses", shape)], camera));
    }
}

#[test]
fn standard_silhouettes_are_the_same() {
    let technique = || edges(|settings| settings.silhouettes = Silhouettes::Standard);
    for name in ["toruses", "fork"] {
        let (scene, light, camera) = shipped(name, [64, 48]);
        compare(Call::new(technique(), &scene, vec![light], camera));
    }
}

#[test]
fn points_and_blocks_have_the_same_lists() {
    let (scene, light, camera) = shipped("fork", [60, 44]);
    let mut call = Call::new(accurate(), &scene, vec![light.clone()], camera);
    call.block = 1000;
    compare(call);
    let at = |k: usize| [(k % 41) as f64 * 0.07 - 1.4, 0.02 * (k % 7) as f64, (k % 53) as f64 * 0.05 - 1.2];
    for normals in [None, Some(vec![[0.0, 1.0, 0.2]; 1111])] {
        let points = Points::new((0..1111).map(at).collect(), normals).unwrap();
        compare(Call::new(accurate(), &scene, vec![light.clone()], Source::Points(points)));
    }
}

#[test]
fn samples_of_their_own_are_masked_alike() {
    for spread in [SampleSpread::Decorrelated, SampleSpread::Interleaved] {
        for samples in [16, 40] {
            let technique = edges(|settings| (settings.spread, settings.samples) = (spread, samples));
            let (scene, light, camera) = shipped("toruses", [40, 32]);
            compare(Call::new(technique, &scene, vec![light], camera));
        }
    }
}

#[test]
fn edges_between_two_opacities_stay() {
    let quad = |corners: [[f64; 3]; 4], opacity| {
        let material = Material { opacity, ..Material::default() };
        Mesh::new("quad", corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]], material).unwrap()
    };
    // Half of a roof lets light through, and both halves lie on one side of the light.
    let opaque = quad([[-1.0, 0.5, -0.5], [-1.0, 0.6, 0.0], [1.0, 0.6, 0.0], [1.0, 0.5, -0.5]], 1.0);
    let half = quad([[-1.0, 0.6, 0.0], [-1.0, 0.5, 0.5], [1.0, 0.5, 0.5], [1.0, 0.6, 0.0]], 0.5);
    let ground = quad([[-3.0, -0.5, -3.0], [-3.0, -0.5, 3.0], [3.0, -0.5, 3.0], [3.0, -0.5, -3.0]], 1.0);
    let scene = Scene::new(vec![opaque, half, ground]).unwrap();
    let pose = look_at([0.5, 3.0, 0.2], [0.0, 0.0, 0.0], None).unwrap();
    let light = Light::new(LightShape::Disc { radius: 0.3 }, pose).unwrap();
    let camera = Camera::look_at([2.2, 1.4, 3.0], [0.0, 0.0, 0.0], None, 50.0, [64, 48]).unwrap();
    let call = Call::new(accurate(), &scene, vec![light.clone()], Source::Camera(camera));
    let local = &call.scene.local;
    let occluders = OccluderContents::new(local, boundary_of(local, &light)).unwrap();
    let words: Vec<u32> = bytemuck::pod_collect_to_vec(&occluders.edges.bytes);
    assert!(words.chunks(8).any(|edge| edge[7] & UNEQUAL_FACES != 0));
    compare(call);
}

#[test]
fn results_depend_on_no_setting() {
    let (scene, light, camera) = shipped("toruses", [48, 40]);
    let call = before_fold(Call::new(accurate(), &scene, vec![light], camera));
    let baseline = NativeSettings { threads: Some(1), vectors: Vectors::Baseline };
    assert_eq!(call.difference(&NativeEngine::new(baseline), None, &same), None);
}

#[test]
fn full_lists_are_reported() {
    fn full(buffers: &Buffers) -> Vec<Vec<u32>> {
        assert!(buffers["running counts"][3] > 0, "lists have room for all");
        Vec::new()
    }
    let (scene, light, camera) = shipped("toruses", [64, 48]);
    let mut call = before_fold(Call::new(accurate(), &scene, vec![light], camera));
    call.room = Some(("edge lists", 48 * 2 * 40 + 100 * 128));
    call.compare(|label| match label {
        "running counts" => Same::Said(full),
        _ => Same::Apart("whose list is cut depends on who came first"),
    });
}

#[test]
fn a_spoilt_list_is_noticed() {
    let (scene, light, camera) = shipped("fork", [48, 32]);
    let call = before_fold(Call::new(accurate(), &scene, vec![light], camera));
    let native = NativeEngine::new(NativeSettings::default());
    for label in ["edge lists", "tile parts", "clusters"] {
        let words = call.difference(&Spoilt { engine: &native, label }, None, &same).expect("a difference");
        assert!(words.contains(label), "{words}");
    }
}
