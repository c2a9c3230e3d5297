//! Long files of one thing repeated: time and memory may grow with the file, and no faster.

use std::time::Instant;

use crate::files::{GLTF, OBJ, PLY, SCENE_JSON, STL};
use crate::harness::Target;
use crate::memory::most_held;

/// What stands before, again and again (with `#` for a running number), and behind.
type Repeated = (Target, &'static str, &'static str, &'static str);

const PLY_HEAD: &str =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";

const REPEATED: [Repeated; 24] = [
    (OBJ, "", "g\n", ""),
    (OBJ, "v 0 0 0\n", "g #\nf 1 1 1\n", ""),
    (OBJ, "", "v 0 0 0\n", "f 1 2 3\n"),
    (OBJ, "v 0 0 0\n", "f 1 1 1\n", ""),
    (OBJ, "v 0 0 0\nf 1 1 1", " 1", "\n"),
    (OBJ, "", "\\\n", "v 0 0 0\n"),
    (OBJ, "", "# \\\n", "v 0 0 0\n"),
    (PLY, "ply\nformat ascii 1.0\n", "element e# 0\n", "end_header\n"),
    (PLY, PLY_HEAD, "property float p#\n", "end_header\n"),
    (PLY, "ply\nformat ascii 1.0\n", "comment\n", "end_header\n"),
    (PLY, "ply\nformat ascii 1.0\nelement a 1\nproperty list int char b\nend_header\n999999999 ", "1 ", "\n"),
    (STL, "", "solid\nendsolid\n", ""),
    (STL, "", "solid\nfacet\nouter\nvertex 0 0 0\nvertex 0 0 0\nvertex 0 0 0\nendloop\nendfacet\nendsolid\n", ""),
    (STL, "solid\n", "facet\nouter\nvertex 0 0 0\nvertex 0 0 0\nvertex 0 0 0\nendloop\nendfacet\n", "endsolid"),
    (GLTF, "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[", "{},", "{}]}"),
    (GLTF, "{\"asset\":{\"version\":\"2.0\"},\"extensionsUsed\":[", "\"#\",", "\"\"]}"),
    (
        GLTF,
        "{\"asset\":{\"version\":\"2.0\"},\"meshes\":[{\"primitives\":[",
        "{\"attributes\":{}},",
        "{\"attributes\":{}}]}],\"nodes\":[{\"mesh\":0}]}",
    ),
    (GLTF, "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[", "0,", "0]}],\"nodes\":[{}]}"),
    (GLTF, "{\"asset\":{\"version\":\"2.0\"},\"extras\":", "[", ""),
    (GLTF, "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":1,\"uri\":\"data:;base64,", "AAAA", "\"}]}"),
    (SCENE_JSON, "{\"softshadow\":1,\"meshes\":[", "{\"path\":\"card.obj\"},", "{\"path\":\"card.obj\"}]}"),
    (
        SCENE_JSON,
        "{\"softshadow\":1,\"meshes\":[{\"path\":\"card.obj\"}],\"lights\":[",
        "{\"type\":\"SphereLight\",\"name\":\"#\"},",
        "{\"type\":\"RectLight\"}]}",
    ),
    (
        SCENE_JSON,
        "{\"softshadow\":1,\"meshes\":[",
        "{\"path\":\"./card.obj\",\"name\":\"#\"},",
        "{\"path\":\"card.obj\"}]}",
    ),
    (SCENE_JSON, "{\"softshadow\":1,\"meshes\":", "[", ""),
];

/// Bytes of memory a byte of a file: an empty node of a glTF is 3 in the file, and 900 when it is read.
const SHARE: u64 = 300;
/// For tables that are there in any case.
const ALWAYS: u64 = 1 << 20;
const LONG: usize = 1 << 20;

#[test]
fn time_and_memory_grow_with_the_file_and_no_faster() {
    let mut red = Vec::new();
    for (target, head, unit, tail) in REPEATED {
        let mut text = head.to_owned();
        for index in 0_u32.. {
            if text.len() > LONG {
                break;
            }
            text.push_str(&unit.replace('#', &index.to_string()));
        }
        text.push_str(tail);
        let started = Instant::now();
        let (words, memory) = most_held(|| (target.run)(text.as_bytes()));
        let (seconds, share) = (started.elapsed().as_secs_f64(), memory / text.len() as u64);
        let row = format!("{} {unit:?}: {seconds:.2} s, {share} bytes a byte: {words:.80}", target.name);
        println!("{row}");
        // A quadratic time is minutes.
        if seconds > 5.0 || memory > SHARE * text.len() as u64 + ALWAYS {
            red.push(row);
        }
    }
    assert!(red.is_empty(), "{}", red.join("\n"));
}

#[test]
fn what_has_a_limit_says_so() {
    let repeated = |head: &str, unit: &str, count: usize, tail: &str| [head, &unit.repeat(count), tail].concat();
    for (target, text, words) in [
        (GLTF, repeated("{\"nodes\":[", "{},", 1 << 22, "{}]}"), "objects in the JSON of"),
        (
            OBJ,
            repeated("v 0 0 0\n", "o\nf 1 1 1\n", (1 << 20) + 1, ""),
            "meshes of the scene: 1048577 needed, at most 1048576",
        ),
        (PLY, (0..1025).map(|index| format!("element e{index} 0\n")).collect(), "more than 1024 elements"),
        (PLY, (0..1025).map(|index| format!("property int p{index}\n")).collect(), "more than 1024 properties"),
    ] {
        let head = if text.starts_with("element") {
            "ply\n"
        } else if text.starts_with("prop") {
            "ply\nelement a 1\n"
        } else {
            ""
        };
        let got = (target.run)([head, &text].concat().as_bytes());
        assert!(got.contains(words), "{got:.200}");
    }
}
