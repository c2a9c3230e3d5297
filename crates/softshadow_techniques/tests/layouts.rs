//! Every struct that is uploaded lies in memory as its WGSL twin does: the same members, by name, at the same offsets.
//!
//! Most fields are private to the file that fills them, so offsets are read from the source text instead of by `offset_of!`:
//! `#[repr(C)]` puts members of four-byte scalars one after the other. For structs with public fields both ways are compared,
//! and for all of them the compiler's size.

use std::collections::BTreeSet;
use std::mem::{offset_of, size_of};
use std::path::Path;

use softshadow_scene::occluders::{NO_SIDE, OPAQUE};
use softshadow_scene::{BvhNode, Corner, LocalPoint};
use softshadow_shaders::{EMBEDDED, module};
use softshadow_techniques::depth_complexity::blended::{Largest, Packing, TARGETS, WedgeView};
use softshadow_techniques::depth_complexity::{
    AttenuationScale, ClusterRange, CoverSettings, FoldSettings, FrameRecord, SampleBins, TouchingRange,
};
use softshadow_techniques::occlusion_camera::{self, CameraCounts, CameraLight};
use softshadow_techniques::occlusion_layers::{
    CASTER_BOUNDS_BYTES, CasterRange, LAYER_PLACES_BYTES, LayerFrame, LevelRange, LightParts,
};
use softshadow_techniques::parts::interleaving::InterleavingRecord;
use softshadow_techniques::parts::light_buffers::{LightRecord, Sampling};
use softshadow_techniques::parts::light_silhouettes::{EdgeCorners, LIGHT_SILHOUETTE_BYTES};
use softshadow_techniques::parts::occluder_buffers::{EdgeRecord, FaceRecord, IncidentFace, UNEQUAL_FACES};
use softshadow_techniques::parts::receivers::{CameraClip, CameraRays, PointRange, RECEIVER_BYTES, Receiver, SubScene};
use softshadow_techniques::parts::shading::{MaterialRecord, ShadingRecord};
use softshadow_techniques::parts::shadow_views::{ShadowView, ShadowViews};
use softshadow_techniques::penumbra_map::{MapLayer, PenumbraLight, Ramp};
use softshadow_techniques::ray_traced::{ProbeImage, TraceRange};

/// Members and bytes of a struct.
#[derive(Debug, Clone, PartialEq)]
struct Layout {
    members: Vec<(String, u32)>,
    bytes: u32,
}

/// A Rust struct: its name, its bytes by the compiler, the WGSL file and the struct there.
type Pair = (&'static str, usize, &'static str, &'static str);

const PAIRS: &[Pair] = &[
    ("Receiver", size_of::<Receiver>(), "shared/receiver.wgsl", "Receiver"),
    ("CameraClip", size_of::<CameraClip>(), "receivers/draw_triangle_ids.wgsl", "CameraClip"),
    ("CameraRays", size_of::<CameraRays>(), "receivers/place_on_triangles.wgsl", "CameraRays"),
    ("SubScene", size_of::<SubScene>(), "receivers/place_on_triangles.wgsl", "SubScene"),
    ("PointRange", size_of::<PointRange>(), "receivers/place_points.wgsl", "PointRange"),
    ("LocalPoint", size_of::<LocalPoint>(), "receivers/place_points.wgsl", "LocalPoint"),
    ("LightRecord", size_of::<LightRecord>(), "shared/light.wgsl", "Light"),
    ("Sampling", size_of::<Sampling>(), "shared/samples.wgsl", "Sampling"),
    ("InterleavingRecord", size_of::<InterleavingRecord>(), "shared/continuity.wgsl", "Interleaving"),
    ("MaterialRecord", size_of::<MaterialRecord>(), "shading/shade.wgsl", "Material"),
    ("ShadingRecord", size_of::<ShadingRecord>(), "shading/shade.wgsl", "Shading"),
    ("TraceRange", size_of::<TraceRange>(), "ray_traced/hierarchy.wgsl", "TraceRange"),
    ("BvhNode", size_of::<BvhNode>(), "ray_traced/hierarchy.wgsl", "BvhNode"),
    ("Corner", size_of::<Corner>(), "shared/triangle.wgsl", "Corner"),
    ("ProbeImage", size_of::<ProbeImage>(), "ray_traced/choose.wgsl", "ProbeImage"),
    ("LayerFrame", size_of::<LayerFrame>(), "occlusion_layers/layers.wgsl", "LayerFrame"),
    ("CasterRange", size_of::<CasterRange>(), "occlusion_layers/casters.wgsl", "CasterRange"),
    ("LevelRange", size_of::<LevelRange>(), "occlusion_layers/build_levels.wgsl", "LevelRange"),
    ("LightParts", size_of::<LightParts>(), "occlusion_layers/kernel.wgsl", "LightParts"),
    ("ShadowView", size_of::<ShadowView>(), "shared/shadow_view.wgsl", "ShadowView"),
    ("PenumbraLight", size_of::<PenumbraLight>(), "penumbra_map/light.wgsl", "PenumbraLight"),
    ("MapLayer", size_of::<MapLayer>(), "penumbra_map/light.wgsl", "MapLayer"),
    ("FaceRecord", size_of::<FaceRecord>(), "shared/occluders.wgsl", "Face"),
    ("EdgeRecord", size_of::<EdgeRecord>(), "shared/occluders.wgsl", "OccluderEdge"),
    ("IncidentFace", size_of::<IncidentFace>(), "shared/occluders.wgsl", "IncidentFace"),
    ("BvhNode", size_of::<BvhNode>(), "depth_complexity/tree.wgsl", "TreeNode"),
    ("FrameRecord", size_of::<FrameRecord>(), "depth_complexity/frame.wgsl", "LightFrame"),
    ("ClusterRange", size_of::<ClusterRange>(), "depth_complexity/clusters.wgsl", "ClusterRange"),
    ("CameraLight", size_of::<CameraLight>(), "occlusion_camera/camera.wgsl", "CameraLight"),
    ("MapLayer", size_of::<occlusion_camera::MapLayer>(), "occlusion_camera/draw_distortion.wgsl", "MapLayer"),
    ("CameraCounts", size_of::<CameraCounts>(), "occlusion_camera/look_up.wgsl", "CameraCounts"),
    ("EdgeCorners", size_of::<EdgeCorners>(), "light_silhouettes/list.wgsl", "EdgeCorners"),
    ("AttenuationScale", size_of::<AttenuationScale>(), "depth_complexity/spread_reference.wgsl", "AttenuationScale"),
    ("CoverSettings", size_of::<CoverSettings>(), "depth_complexity/cover_faces.wgsl", "CoverSettings"),
    ("SampleBins", size_of::<SampleBins>(), "depth_complexity/sample_bins.wgsl", "SampleBins"),
    ("TouchingRange", size_of::<TouchingRange>(), "depth_complexity/touching.wgsl", "TouchingRange"),
    ("FoldSettings", size_of::<FoldSettings>(), "depth_complexity/fold.wgsl", "FoldSettings"),
    ("WedgeView", size_of::<WedgeView>(), "depth_complexity/blended/hull.wgsl", "WedgeView"),
    ("Packing", size_of::<Packing>(), "depth_complexity/blended/packing.wgsl", "Packing"),
    ("Largest", size_of::<Largest>(), "depth_complexity/blended/find_largest.wgsl", "Largest"),
];

/// The one struct that holds others.
const VIEWS: Pair = ("ShadowViews", size_of::<ShadowViews>(), "shared/shadow_view.wgsl", "ShadowViews");

/// Texts of every source file of the crates that upload structs.
fn sources() -> Vec<String> {
    fn collect(folder: &Path, texts: &mut Vec<String>) {
        for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                collect(&path, texts);
            } else {
                texts.push(std::fs::read_to_string(path).unwrap());
            }
        }
    }
    let mut texts = Vec::new();
    for folder in ["src", "../softshadow_scene/src"] {
        collect(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder), &mut texts);
    }
    texts
}

/// Name and body of every `#[repr(C)]` struct in a text.
fn uploaded(text: &str) -> Vec<(&str, &str)> {
    let structs = text.split("#[repr(C)]").skip(1).map(|rest| {
        let rest = rest.split_once("pub struct ").unwrap().1;
        let (name, rest) = rest.split_once(" {").unwrap();
        (name, rest.split_once("\n}").unwrap().0)
    });
    structs.collect()
}

/// Offsets by the rules of C for scalars of four bytes and arrays of them.
fn layout(body: &str) -> Layout {
    let (mut members, mut bytes) = (Vec::new(), 0);
    for row in body.lines().map(str::trim).filter(|row| !row.is_empty() && !row.starts_with("//")) {
        let (name, kind) = row.trim_start_matches("pub ").trim_end_matches(',').split_once(": ").unwrap();
        members.push((name.to_owned(), bytes));
        bytes += match kind {
            "f32" | "u32" => 4,
            "[f32; 2]" => 8,
            "[f32; 3]" => 12,
            "[u32; 4]" | "[f32; 4]" => 16,
            "[[f32; 4]; 4]" => 4 * 16,
            "[[u32; 4]; 64]" | "[[f32; 4]; 64]" | "[[f32; 4]; MOST_CORNERS]" => 64 * 16,
            "[[f32; 2]; MOST_CORNERS]" => 64 * 8,
            "[ShadowView; 6]" => 6 * size_of::<ShadowView>() as u32,
            other => panic!("teach this test the size of '{other}'"),
        };
    }
    Layout { members, bytes }
}

/// The first difference between a Rust struct and its twin.
fn compare(name: &str, rust: &Layout, wgsl: &Layout) -> Result<(), String> {
    for (ours, theirs) in rust.members.iter().zip(&wgsl.members) {
        if ours != theirs {
            return Err(format!("{name}: {ours:?} is {theirs:?} in WGSL"));
        }
    }
    if (rust.members.len(), rust.bytes) != (wgsl.members.len(), wgsl.bytes) {
        return Err(format!("{name}: {rust:?} is {wgsl:?} in WGSL"));
    }
    Ok(())
}

fn twin(file: &str, name: &str) -> Layout {
    let layout = &module(file).unwrap().structs[name];
    Layout { members: layout.members.clone(), bytes: layout.bytes }
}

#[test]
fn every_uploaded_struct_lies_as_its_twin() {
    assert_eq!(RECEIVER_BYTES, size_of::<Receiver>() as u64);
    let texts = sources();
    let found: Vec<(&str, &str)> = texts.iter().flat_map(|text| uploaded(text)).collect();
    let mut tested = BTreeSet::new();
    for (name, size, file, wgsl) in PAIRS.iter().copied().chain([VIEWS]) {
        let (_, body) = found.iter().find(|(known, _)| *known == name).unwrap_or_else(|| panic!("no struct {name}"));
        let rust = layout(body);
        assert_eq!(rust.bytes as usize, size, "{name}: the compiler's size");
        compare(name, &rust, &twin(file, wgsl)).unwrap();
        tested.insert(name);
    }
    assert_eq!(tested, found.iter().map(|(name, _)| *name).collect(), "a new struct needs a row in this test");
}

#[test]
fn layers_lie_as_plans_say() {
    assert_eq!(u64::from(twin("occlusion_layers/casters.wgsl", "CasterBounds").bytes), CASTER_BOUNDS_BYTES);
    assert_eq!(u64::from(twin("occlusion_layers/layers.wgsl", "LayerPlaces").bytes), LAYER_PLACES_BYTES);
    // What the front door reads of the bounds: the words after three lows, three highs and the count.
    let bounds = twin("occlusion_layers/casters.wgsl", "CasterBounds");
    let offset = |name: &str| bounds.members.iter().find(|(member, _)| member == name).map(|(_, at)| *at);
    assert_eq!((offset("edge_on"), offset("area")), (Some(7 * 4), Some(8 * 4)));
    let words = [1, 2, 3, 4, 5, 6, 7, 30, 120, 9];
    assert_eq!(softshadow_techniques::occlusion_layers::edge_on_share(&words), 0.25);
    assert_eq!(softshadow_techniques::occlusion_layers::edge_on_share(&[0; 12]), 0.0);
    let text = shader("occlusion_layers/look_up.wgsl");
    assert_eq!(constant(text, "RAYS"), Some(8), "runs of rays are counted by the plan");
}

#[test]
fn lists_of_candidates_are_as_long_as_plans_say() {
    // Only kernels read and write them; plans know the bytes, and the front door the first words.
    let list = twin("ray_traced/hierarchy.wgsl", "CandidateList");
    let named = |name: &str| list.members.iter().find(|(n, _)| n == name).map(|(_, offset)| *offset);
    assert_eq!((named("count"), named("unfinished"), named("items")), (Some(0), Some(4), Some(16)));
    assert_eq!(list.members.last().map(|(name, _)| name.as_str()), Some("items"));
    let candidate = twin("ray_traced/hierarchy.wgsl", "Candidate");
    assert_eq!(candidate.bytes, 12);
    let words = ["receiver", "first_node", "last_node"].iter().zip([0, 4, 8]).map(|(n, at)| ((*n).to_owned(), at));
    assert_eq!(candidate.members, words.collect::<Vec<_>>());
    for file in ["count_groups", "gather", "narrow", "trace"] {
        let file = format!("ray_traced/{file}.wgsl");
        assert_eq!(
            (twin(&file, "CandidateList"), twin(&file, "Candidate")),
            (list.clone(), candidate.clone()),
            "{file}"
        );
    }
}

/// The value of a constant in a source text, Rust or WGSL.
fn constant(text: &str, name: &str) -> Option<u64> {
    let value = text.split_once(&format!("const {name}: "))?.1.split_once(" = ")?.1.split_once(';')?.0;
    let digits = value.trim_end_matches('u').replace('_', "");
    match digits.strip_prefix("0x") {
        Some(hex) => u64::from_str_radix(hex, 16).ok(),
        None => digits.parse().ok(),
    }
}

fn shader(file: &str) -> &'static str {
    EMBEDDED.iter().find(|(name, _)| *name == file).unwrap_or_else(|| panic!("no file '{file}'")).1
}

/// Constants of `depth_complexity`, each with what the kernels make of it.
fn counted_by_kernels() -> [(&'static str, u64); 19] {
    let bytes = |file: &str, name| u64::from(twin(&format!("depth_complexity/{file}.wgsl"), name).bytes);
    let value = |file: &str, name| constant(shader(&format!("depth_complexity/{file}.wgsl")), name).unwrap();
    [
        ("TILE", value("tiles", "TILE")),
        ("CLUSTER", value("clusters", "CLUSTER")),
        ("CHUNK_BYTES", 4 * value("tiles", "CHUNK")),
        ("COUNT_BYTES", bytes("tiles", "ListCounts")),
        ("PART_BYTES", bytes("tiles", "TilePart")),
        ("SLOT_BYTES", bytes("tiles", "Slot")),
        ("CLUSTER_BYTES", bytes("clusters", "Cluster")),
        ("MOST_SAMPLES", bytes("frame", "FrameSamples") / 16),
        ("SET_SAMPLES", bytes("sample_sets", "SampleSets") / 8),
        ("MOST_CORNERS", bytes("fold", "Outline") / 16),
        ("GROUP", bytes("fold", "GroupSamples") / 16),
        ("DIRECTIONS", value("coverage_table", "DIRECTIONS")),
        ("LINE_DIRECTIONS", value("coverage_table", "LINE_DIRECTIONS")),
        ("LINE_DISTANCES", value("coverage_table", "LINE_DISTANCES")),
        ("HEAD_BYTES", 4 * value("tiles", "HEAD")),
        ("BUNDLES", value("tiles", "BUNDLES")),
        ("STRIDES", value("walk", "STRIDES")),
        ("BINS", value("sample_bins", "BINS")),
        ("ROUND_STEPS", value("cover_faces", "ROUND_STEPS")),
    ]
}

/// Names of the constants of a Rust text that the kernels contradict.
fn contradicted(text: &str) -> Vec<&'static str> {
    let wrong = counted_by_kernels().into_iter().filter(|(name, value)| constant(text, name) != Some(*value));
    wrong.map(|(name, _)| name).collect()
}

fn source(path: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap()
}

#[test]
fn what_depth_complexity_counts_is_what_its_kernels_count() {
    let text = ["coverage_table", "covered", "mod", "tiled", "values"]
        .map(|name| source(&format!("src/depth_complexity/{name}.rs")))
        .concat();
    assert_eq!(contradicted(&text), Vec::<&str>::new());
    // Any of them one off, or gone, is named.
    for (name, value) in counted_by_kernels() {
        let written = text.lines().find(|line| line.contains(&format!("const {name}: "))).unwrap();
        let (head, _) = written.split_once(" = ").unwrap();
        let spoilt = text.replace(written, &format!("{head} = {};", value + 1));
        assert_eq!(contradicted(&spoilt), [name]);
        assert_eq!(contradicted(&text.replace(written, "")), [name]);
    }
}

#[test]
fn lists_of_edges_lie_as_plans_say() {
    // A head for each of a tile's two parts; a chunk is the next one, a count, and entries.
    let tiles = shader("depth_complexity/tiles.wgsl");
    assert!(tiles.contains("return 2u * HEAD * tile_count;"));
    assert!(
        source("src/depth_complexity/tiled.rs")
            .contains("u64::from(tile_count) * (2 * HEAD_BYTES + CHUNKS_PER_TILE * CHUNK_BYTES)")
    );
    let of = |name| constant(tiles, name).unwrap();
    // A table holds all its cells, and both sides agree how far they reach.
    let table = twin("depth_complexity/coverage_table.wgsl", "CoverageTable");
    let cells = |name| constant(shader("depth_complexity/coverage_table.wgsl"), name).unwrap() as u32;
    assert_eq!(table.members[1], ("lines".to_owned(), 16 * cells("DIRECTIONS")));
    assert_eq!(table.bytes, 16 * (cells("DIRECTIONS") + cells("LINE_DIRECTIONS") * cells("LINE_DISTANCES")));
    assert!(shader("depth_complexity/coverage_table.wgsl").contains("const FARTHEST: f32 = 1.1;"));
    assert!(source("src/depth_complexity/coverage_table.rs").contains("const FARTHEST: f64 = 1.1;"));
    assert_eq!(of("CHUNK"), of("CHUNK_EDGES") + 2);
    assert_eq!(of("HEAD"), of("BUNDLES") + 2);
    assert_eq!(of("TILE"), of("BUNDLES") * of("BUNDLE"));
    // One bit an entry of a chunk.
    assert!(of("CHUNK_EDGES") <= 32);
    // A cluster, and a group of them, has a bit for each.
    assert_eq!(constant(shader("depth_complexity/clusters.wgsl"), "CLUSTER"), Some(32));
    // The front door reads these words by number.
    let counts = ["parts", "chunks", "edges", "unfinished", "by_area", "overflowed", "reserved0", "reserved1"];
    let words = counts.iter().zip(0..).map(|(name, word)| ((*name).to_owned(), 4 * word));
    assert_eq!(twin("depth_complexity/tiles.wgsl", "ListCounts").members, words.collect::<Vec<_>>());
}

#[test]
fn wedges_are_drawn_and_counted_as_plans_say() {
    let text = source("src/depth_complexity/blended/mod.rs");
    let bytes = |file: &str, name| u64::from(twin(&format!("depth_complexity/blended/{file}.wgsl"), name).bytes);
    assert_eq!(constant(&text, "DRAW_BYTES"), Some(bytes("append_wedges", "DrawArguments")));
    assert_eq!(constant(&text, "CHANGE_BYTES"), Some(bytes("draw_wedges", "Changes")));
    // A face of four corners is two triangles, and has two caps.
    assert_eq!(constant(&source("src/depth_complexity/blended/z_fail.rs"), "CAP_CORNERS"), Some(2 * 2 * 3));
    assert!(shader("depth_complexity/blended/z_fail.wgsl").contains("faces[index / 12u]"));
    // An indirect draw begins with its vertices, then instances.
    let draw = twin("depth_complexity/blended/append_wedges.wgsl", "DrawArguments").members;
    let names = ["vertices", "instances", "first_vertex", "first_instance"];
    let expected = names.iter().zip(0..).map(|(name, word)| ((*name).to_owned(), 4 * word));
    assert_eq!(draw, expected.collect::<Vec<_>>());
    // A fragment shader for each number of targets.
    let entries = &module("depth_complexity/blended/draw_wedges.wgsl").unwrap().entry_points;
    let found = entries.keys().filter_map(|name| name.strip_prefix("add_digits_")).map(|n| n.parse::<u32>().unwrap());
    assert_eq!(found.collect::<BTreeSet<_>>(), BTreeSet::from(TARGETS));
}

#[test]
fn light_silhouettes_are_as_long_as_plans_say() {
    assert_eq!(u64::from(twin("light_silhouettes/list.wgsl", "LightSilhouette").bytes), LIGHT_SILHOUETTE_BYTES);
    assert_eq!(twin("light_silhouettes/list.wgsl", "DrawArguments").bytes, 16);
}

#[test]
fn penumbrae_are_drawn_and_counted_as_plans_say() {
    let triangles = constant(shader("penumbra_map/hull.wgsl"), "HULL_TRIANGLES").unwrap();
    let text = source("src/penumbra_map/mod.rs");
    assert_eq!(constant(&text, "HULL_CORNERS"), Some(3 * triangles));
    assert_eq!(
        constant(&text, "COUNT_BYTES"),
        Some(u64::from(twin("penumbra_map/look_up.wgsl", "LookUpCounts").bytes))
    );
    // Ramps are numbers there and an enumeration here.
    let ramps =
        ["RAMP_LIGHT", "RAMP_LINEAR", "RAMP_PAPER"].map(|name| constant(shader("penumbra_map/light.wgsl"), name));
    assert_eq!(ramps, [Ramp::Light, Ramp::Linear, Ramp::Paper].map(|ramp| Some(ramp as u64)));
}

#[test]
fn faces_and_leaves_are_packed_alike() {
    let occluders = shader("shared/occluders.wgsl");
    assert_eq!(constant(occluders, "NO_SIDE"), Some(u64::from(NO_SIDE)));
    assert_eq!(constant(occluders, "UNEQUAL_FACES"), Some(u64::from(UNEQUAL_FACES)));
    assert_eq!(constant(shader("depth_complexity/attenuation.wgsl"), "OPAQUE"), Some(u64::from(OPAQUE)));
    let bits = constant(&source("../softshadow_scene/src/bvh.rs"), "LEAF_BITS");
    assert!(bits.is_some());
    assert_eq!(constant(shader("depth_complexity/tree.wgsl"), "LEAF_BITS"), bits);
}

#[test]
fn structs_of_depth_complexity_are_the_same_in_every_kernel() {
    let kernels = [
        "silhouettes",
        "bound_clusters",
        "reference_depth",
        "spread_reference",
        "bound_tiles",
        "cull",
        "cover_faces",
        "size_fold",
        "fold",
    ]
    .map(|name| {
        let file = format!("depth_complexity/{name}.wgsl");
        module(&file).unwrap()
    });
    let homes = [
        ("depth_complexity/frame", &["LightFrame", "FrameSamples"][..]),
        ("shared/occluders", &["Face", "OccluderEdge", "IncidentFace"]),
        ("depth_complexity/clusters", &["Cluster", "ClusterRange"]),
        ("depth_complexity/tiles", &["TilePart", "Slot", "ListCounts"]),
        ("depth_complexity/tree", &["TreeNode"]),
        ("depth_complexity/spread_reference", &["AttenuationScale"]),
    ];
    for (file, names) in homes {
        for name in names {
            let home = twin(&format!("{file}.wgsl"), name);
            let uses = kernels.iter().filter_map(|kernel| kernel.structs.get(*name));
            let same = uses.map(|s| Layout { members: s.members.clone(), bytes: s.bytes } == home).collect::<Vec<_>>();
            assert!(!same.is_empty() && same.iter().all(|same| *same), "{name}: {same:?}");
        }
    }
}

#[test]
fn the_text_says_what_the_compiler_does() {
    macro_rules! offsets {
        ($name:ty, $($member:ident),+) => {
            Layout {
                members: vec![$((stringify!($member).to_owned(), offset_of!($name, $member) as u32)),+],
                bytes: size_of::<$name>() as u32,
            }
        };
    }
    let texts = sources();
    let read = |name: &str| {
        let found: Vec<Layout> =
            texts.iter().flat_map(|text| uploaded(text)).filter(|(n, _)| *n == name).map(|(_, b)| layout(b)).collect();
        found[0].clone()
    };
    assert_eq!(read("Receiver"), offsets!(Receiver, position, triangle, normal, kind));
    assert_eq!(read("LocalPoint"), offsets!(LocalPoint, position, has_normal, normal, unused));
    assert_eq!(read("Corner"), offsets!(Corner, position, triangle));
    assert_eq!(read("BvhNode"), offsets!(BvhNode, low, skip, high, leaf));
    assert_eq!(
        read("Sampling"),
        offsets!(Sampling, count, words, probes, pass_index, passes, sets, row, first_receiver)
    );
}

#[test]
fn a_shifted_renamed_missing_or_longer_member_is_seen() {
    let wgsl = twin("ray_traced/hierarchy.wgsl", "BvhNode");
    let spoilt = |spoil: &dyn Fn(&mut Layout)| {
        let mut rust = wgsl.clone();
        spoil(&mut rust);
        compare("BvhNode", &rust, &wgsl)
    };
    assert_eq!(spoilt(&|_| ()), Ok(()));
    assert_eq!(spoilt(&|l| l.members[2].1 += 4), Err(r#"BvhNode: ("high", 20) is ("high", 16) in WGSL"#.into()));
    assert!(spoilt(&|l| l.members[1].0 = "next".into()).is_err());
    assert!(spoilt(&|l| drop(l.members.pop())).is_err());
    assert!(spoilt(&|l| l.bytes += 4).is_err());
    // The padding that WGSL puts behind three floats and Rust does not.
    let body = "\n    /// Direction.\n    pub way: [f32; 3],\n    pub reach: [f32; 3],\n";
    assert_eq!(layout(body).members, [("way".to_owned(), 0), ("reach".to_owned(), 12)]);
    // Pairs and fours of scalars are no longer than they are.
    let body = "\n    low: [f32; 2],\n    sides: [u32; 4],\n    count: u32,\n";
    let members = [("low", 0), ("sides", 8), ("count", 24)].map(|(name, at)| (name.to_owned(), at));
    assert_eq!(layout(body), Layout { members: members.to_vec(), bytes: 28 });
}
