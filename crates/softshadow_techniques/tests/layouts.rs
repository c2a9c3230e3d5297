//! Every struct that is uploaded lies in memory as its WGSL twin does: the same members, by name, at the same offsets.
//!
//! Most fields are private to the file that fills them, so offsets are read from the source text instead of by `offset_of!`:
//! `#[repr(C)]` puts members of four-byte scalars one after the other. For structs with public fields both ways are compared,
//! and for all of them the compiler's size.

use std::collections::BTreeSet;
use std::mem::{offset_of, size_of};
use std::path::Path;

use softshadow_scene::{BvhNode, Corner, LocalPoint};
use softshadow_shaders::module;
use softshadow_techniques::hard_shadow_map::{ShadowView, ShadowViews};
use softshadow_techniques::parts::light_buffers::{LightRecord, Sampling};
use softshadow_techniques::parts::receivers::{CameraClip, CameraRays, PointRange, RECEIVER_BYTES, Receiver, SubScene};
use softshadow_techniques::parts::shading::{MaterialRecord, ShadingRecord};
use softshadow_techniques::ray_traced::{ProbeImage, TraceRange};

/// Members and bytes of a struct.
#[derive(Debug, Clone, PartialEq)]
struct Layout {
    members: Vec<(String, u32)>,
    bytes: u32,
}

/// A Rust struct: its name, its bytes by the compiler, the WGSL file and the struct there.
type Pair = (&'static str, usize, &'static str, &'static str);

const PAIRS: [Pair; 15] = [
    ("Receiver", size_of::<Receiver>(), "shared/receiver.wgsl", "Receiver"),
    ("CameraClip", size_of::<CameraClip>(), "receivers/draw_triangle_ids.wgsl", "CameraClip"),
    ("CameraRays", size_of::<CameraRays>(), "receivers/place_on_triangles.wgsl", "CameraRays"),
    ("SubScene", size_of::<SubScene>(), "receivers/place_on_triangles.wgsl", "SubScene"),
    ("PointRange", size_of::<PointRange>(), "receivers/place_points.wgsl", "PointRange"),
    ("LocalPoint", size_of::<LocalPoint>(), "receivers/place_points.wgsl", "LocalPoint"),
    ("LightRecord", size_of::<LightRecord>(), "shared/light.wgsl", "Light"),
    ("Sampling", size_of::<Sampling>(), "shared/samples.wgsl", "Sampling"),
    ("MaterialRecord", size_of::<MaterialRecord>(), "shading/shade.wgsl", "Material"),
    ("ShadingRecord", size_of::<ShadingRecord>(), "shading/shade.wgsl", "Shading"),
    ("TraceRange", size_of::<TraceRange>(), "ray_traced/hierarchy.wgsl", "TraceRange"),
    ("BvhNode", size_of::<BvhNode>(), "ray_traced/hierarchy.wgsl", "BvhNode"),
    ("Corner", size_of::<Corner>(), "shared/triangle.wgsl", "Corner"),
    ("ProbeImage", size_of::<ProbeImage>(), "ray_traced/choose.wgsl", "ProbeImage"),
    ("ShadowView", size_of::<ShadowView>(), "hard_shadow_map/view.wgsl", "ShadowView"),
];

/// The one struct that holds others.
const VIEWS: Pair = ("ShadowViews", size_of::<ShadowViews>(), "hard_shadow_map/look_up.wgsl", "ShadowViews");

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
            "[f32; 3]" => 12,
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
    for (name, size, file, wgsl) in PAIRS.into_iter().chain([VIEWS]) {
        let (_, body) = found.iter().find(|(known, _)| *known == name).unwrap_or_else(|| panic!("no struct {name}"));
        let rust = layout(body);
        assert_eq!(rust.bytes as usize, size, "{name}: the compiler's size");
        compare(name, &rust, &twin(file, wgsl)).unwrap();
        tested.insert(name);
    }
    assert_eq!(tested, found.iter().map(|(name, _)| *name).collect(), "a new struct needs a row in this test");
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
        offsets!(Sampling, count, words, probes, pass_index, passes, reserved0, reserved1, reserved2)
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
}
