//! The readers of files.

use std::fs;
use std::path::Path;
use std::sync::OnceLock;
use std::time::Duration;

use softshadow::scene_file::{SceneFile, parse_all};
use softshadow::{Error, Scene};

use crate::harness::Target;

const FILE: Target = Target {
    name: "",
    words: &[],
    longest: 16 << 10,
    // Instances multiply what a file holds, and texts of one digit a number become eight bytes.
    memory: 64 << 20,
    patience: Duration::from_secs(10),
    run: |_| String::new(),
};

pub(crate) const GLTF: Target = Target {
    name: "gltf",
    words: &[
        "\"nodes\":[",
        "\"mesh\":",
        "\"meshes\":[{",
        "\"primitives\":[{",
        "\"indices\":",
        "\"mode\":",
        "\"material\":",
        "\"accessors\":[",
        "\"bufferViews\":[",
        "\"buffers\":[",
        "\"byteLength\":",
        "\"byteOffset\":",
        "\"byteStride\":",
        "\"count\":",
        "\"componentType\":",
        "5121",
        "5123",
        "5125",
        "5126",
        "\"SCALAR\"",
        "\"VEC3\"",
        "\"POSITION\"",
        "\"children\":[",
        "\"matrix\":[",
        "\"rotation\":[",
        "\"scale\":[",
        "\"translation\":[",
        "\"scene\":",
        "\"scenes\":[",
        "\"uri\":",
        "\"data:;base64,",
        "\"data.bin\"",
        "\"../data.bin\"",
        "%2e%2e/",
        "\"sparse\":{",
        "\"alphaMode\":\"BLEND\"",
        "\"extensionsRequired\":[",
        "null",
        "true",
        "{}",
        "[]",
        ",",
        "glTF",
        "JSON",
        "BIN\0",
        "\"extras\":",
        "\"targets\":[{}]",
        "\u{feff}",
    ],
    run: |bytes| outcome(bytes, if bytes.starts_with(b"glTF") { "scene.glb" } else { "scene.gltf" }),
    ..FILE
};

pub(crate) const OBJ: Target = Target {
    name: "obj",
    words: &[
        "v 0 0 0\n",
        "f 1 2 3\n",
        "f -1 -2 -3\n",
        "f 1/1/1 2/2/2 3/3/3 4/4/4\n",
        "f 1//1 2//2 3//3\n",
        "o name\n",
        "g a b\n",
        "\\\n",
        "#",
        "usemtl x\n",
        "vt 0 0\n",
        "vn 0 0 1\n",
        "l 1 2\n",
        "nan",
        "inf",
        "-",
        "/",
        "//",
        "\r\n",
        "\u{e9}",
    ],
    run: |bytes| outcome(bytes, "scene.obj"),
    ..FILE
};

pub(crate) const PLY: Target = Target {
    name: "ply",
    words: &[
        "ply\n",
        "format ascii 1.0\n",
        "format binary_little_endian 1.0\n",
        "format binary_big_endian 1.0\n",
        "element vertex 3\n",
        "element face 1\n",
        "element edge 4294967295\n",
        "property float x\n",
        "property double y\n",
        "property uchar red\n",
        "property list uchar int vertex_indices\n",
        "property list int double vertex_index\n",
        "end_header\n",
        "comment a\n",
        "char",
        "short",
        "int8",
        "uint16",
        "float64",
        "nan",
        "inf",
        "\r\n",
        "\0",
    ],
    run: |bytes| outcome(bytes, "scene.ply"),
    ..FILE
};

pub(crate) const STL: Target = Target {
    name: "stl",
    words: &[
        "solid a\n",
        "facet normal 0 0 1\n",
        "outer loop\n",
        "vertex 1 0 0\n",
        "endloop\n",
        "endfacet\n",
        "endsolid a\n",
        "SOLID",
        "nan",
        "inf",
        "\r\n",
        "\0\0\0\0",
        "\u{e9}",
    ],
    run: |bytes| outcome(bytes, "scene.stl"),
    ..FILE
};

pub(crate) const SCENE_JSON: Target =
    Target { name: "scene_json", words: SCENE_WORDS, run: |bytes| outcome(bytes, "scene.json"), ..FILE };

pub(crate) const SCENE_WORDS: &[&str] = &[
    "\"softshadow\":1",
    "\"meshes\":[",
    "\"path\":",
    "\"card.obj\"",
    "\"card.stl\"",
    "\"card.ply\"",
    "\"card.gltf\"",
    "\"scene.json\"",
    "\"nowhere.obj\"",
    "\"name\":",
    "\"meters_per_unit\":",
    "\"world_from_mesh\":[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]",
    "\"translate\":[0,0,1]",
    "\"rotate_xyz_deg\":[0,90,0]",
    "\"scale\":[1,-1,1]",
    "\"material\":{",
    "\"base_color\":[0,1,0]",
    "\"roughness\":",
    "\"specular\":",
    "\"opacity\":0.5",
    "\"lights\":[",
    "\"type\":\"RectLight\"",
    "\"type\":\"DiskLight\"",
    "\"type\":\"SphereLight\"",
    "\"type\":\"DistantLight\"",
    "\"width\":",
    "\"height\":",
    "\"radius\":",
    "\"angle\":",
    "\"color\":[1,1,1]",
    "\"intensity\":",
    "\"exposure\":",
    "\"target\":[0,0,0]",
    "\"up\":[0,0,1]",
    "\"camera\":{",
    "\"eye\":",
    "\"fov_y_deg\":",
    "\"size\":[2,2]",
    "null",
    "true",
    "{}",
    "[]",
    ",",
    "{",
    "}",
    "\u{feff}",
];

/// Meshes and buffers to which inputs refer, in a folder of this process.
pub(crate) fn folder() -> &'static Path {
    static FOLDER: OnceLock<std::path::PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fuzz inputs");
        fs::create_dir_all(&folder).unwrap();
        let corner = |x: f32, z: f32| [x, 0.5, z].map(f32::to_le_bytes).concat();
        let triangle = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(0.0, 1.0)].concat();
        let stl = [&[0; 80][..], &1_u32.to_le_bytes(), &[0; 12], &triangle, &[0; 2]].concat();
        let gltf = r#"{"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
            "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],"bufferViews":[{"buffer":0,"byteLength":36}],
            "buffers":[{"byteLength":36,"uri":"data.bin"}]}"#;
        let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
            property list uchar int vertex_indices\nend_header\n-1 .5 -1\n1 .5 -1\n0 .5 1\n3 0 1 2\n";
        for (name, bytes) in [
            ("card.obj", &b"v -1 .5 -1\nv 1 .5 -1\nv 1 .5 1\nv -1 .5 1\nf 1 2 3 4\n"[..]),
            ("card.stl", &stl),
            ("card.ply", ply.as_bytes()),
            ("card.gltf", gltf.as_bytes()),
            ("data.bin", &triangle),
        ] {
            fs::write(folder.join(name), bytes).unwrap();
        }
        folder
    })
}

fn outcome(bytes: &[u8], name: &str) -> String {
    match parse_all(&folder().join(name), bytes) {
        Err(error) => words(&error.into()),
        Ok(file) => {
            check(&file.scene);
            description(&file)
        }
    }
}

/// The words of an error; the names of fields and extensions that nobody knows are as many as there are inputs.
pub(crate) fn words(error: &Error) -> String {
    let words = error.to_string();
    let known = ["unknown field", "requires the extension"].into_iter().find(|known| words.contains(known));
    known.map_or(words, str::to_owned)
}

/// What the rest of the library relies on.
fn check(scene: &Scene) {
    for mesh in scene.meshes() {
        assert!(mesh.vertices.iter().flatten().all(|x| x.is_finite()), "a vertex is not finite");
        assert!(mesh.triangles.iter().flatten().all(|&v| (v as usize) < mesh.vertices.len()), "a corner is not there");
        assert!((0.0..=1.0).contains(&mesh.material.opacity), "an opacity is none");
    }
}

/// In letters where numbers would not tell files apart.
fn description(file: &SceneFile) -> String {
    let size = |count: usize| "I".repeat(usize::BITS.saturating_sub(count.leading_zeros()) as usize);
    let SceneFile { scene, lights, camera, meters_per_unit } = file;
    format!(
        "{} meshes, {} triangles, {} lights, {} {}, {} notes",
        size(scene.meshes().len()),
        size(scene.triangle_count()),
        size(lights.len()),
        if camera.is_some() { "camera" } else { "" },
        if meters_per_unit.is_some_and(|unit| unit != 1.0) { "unit" } else { "" },
        size(scene.notes().len())
    )
}
