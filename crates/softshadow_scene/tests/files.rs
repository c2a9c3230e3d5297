//! Reading files, and refusing broken ones: each refusal is a typed error, and nothing panics.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use softshadow_scene::scene_file::{load, parse};
use softshadow_scene::{Scene, SceneError};

const TRIANGLE: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]];

/// One mesh `m` with float32 positions and 16-bit indices; `old` in its JSON is replaced by `new`.
fn glb_with(positions: &[[f32; 3]], indices: &[u16], edits: &[(&str, &str)]) -> Vec<u8> {
    let mut binary: Vec<u8> = positions.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    let position_bytes = binary.len();
    binary.extend(indices.iter().flat_map(|i| i.to_le_bytes()));
    let mut json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
"meshes":[{{"name":"m","primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":{},"type":"VEC3"}},
{{"bufferView":1,"componentType":5123,"count":{},"type":"SCALAR"}}],
"bufferViews":[{{"buffer":0,"byteLength":{position_bytes}}},
{{"buffer":0,"byteOffset":{position_bytes},"byteLength":{}}}],
"buffers":[{{"byteLength":{}}}]}}"#,
        positions.len(),
        indices.len(),
        indices.len() * 2,
        binary.len()
    );
    for (old, new) in edits {
        assert!(json.contains(old), "{old} is not in {json}");
        json = json.replacen(old, new, 1);
    }
    glb(json.as_bytes(), &binary)
}

fn glb(json: &[u8], binary: &[u8]) -> Vec<u8> {
    let mut chunks = Vec::new();
    for (kind, data, padding) in [(b"JSON", json, b' '), (b"BIN\0", binary, 0)] {
        let length = data.len().next_multiple_of(4);
        chunks.extend((length as u32).to_le_bytes());
        chunks.extend(kind);
        chunks.extend(data);
        chunks.resize(chunks.len() + length - data.len(), padding);
    }
    let length = chunks.len() as u32 + 12;
    [&b"glTF"[..], &2_u32.to_le_bytes(), &length.to_le_bytes(), &chunks].concat()
}

fn read(extension: &str, bytes: &[u8]) -> Result<Scene, SceneError> {
    parse(Path::new(&format!("scene.{extension}")), bytes)
}

fn read_obj(text: &str) -> Result<Scene, SceneError> {
    read("obj", text.as_bytes())
}

/// The words of a [`SceneError::FileInvalid`]; any other outcome fails the test.
fn refusal(outcome: Result<Scene, SceneError>) -> String {
    match outcome {
        Err(SceneError::FileInvalid { reason, .. }) => reason,
        other => panic!("expected FileInvalid, got {other:?}"),
    }
}

/// An empty folder for one test, below the build's own.
fn empty_folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn glb_gives_vertices_triangles_and_names() {
    let scene = read("glb", &glb_with(&TRIANGLE, &[2, 0, 1], &[])).unwrap();
    let [mesh] = scene.meshes() else { panic!("one mesh expected") };
    assert_eq!(mesh.name, "m");
    assert_eq!(mesh.vertices, TRIANGLE.map(|v| v.map(f64::from)));
    assert_eq!(mesh.triangles, [[2, 0, 1]]);
    assert!(scene.notes().is_empty());
}

#[test]
fn node_transforms_are_applied_in_order_and_in_float64() {
    // A turn about z by 90 degrees, twice the size along x, moved to map coordinates.
    let node = r#"{"children":[1],"translation":[500000.123456789,10,20]},
        {"mesh":0,"rotation":[0,0,0.70710678,0.70710678],"scale":[2,1,1]}"#;
    let scene = read("glb", &glb_with(&TRIANGLE, &[0, 1, 2], &[(r#"{"mesh":0}"#, node)])).unwrap();
    let expected = [[0.0, 0.0, 0.0], [0.0, 2.0, 0.0], [-2.0, 0.0, 0.0]];
    for (vertex, local) in scene.meshes()[0].vertices.iter().zip(expected) {
        for (k, offset) in [500_000.123_456_789, 10.0, 20.0].into_iter().enumerate() {
            assert!((vertex[k] - local[k] - offset).abs() < 1e-9, "{vertex:?}");
        }
    }
}

#[test]
fn a_matrix_is_read_by_columns() {
    let node = r#"{"mesh":0,"matrix":[0,1,0,0, -1,0,0,0, 0,0,1,0, 5,6,7,1]}"#;
    let scene = read("glb", &glb_with(&TRIANGLE, &[0, 1, 2], &[(r#"{"mesh":0}"#, node)])).unwrap();
    assert_eq!(scene.meshes()[0].vertices, [[5.0, 6.0, 7.0], [5.0, 7.0, 7.0], [3.0, 6.0, 7.0]]);

    let node = r#"{"mesh":0,"matrix":[1,0,0,1, 0,1,0,0, 0,0,1,0, 0,0,0,1]}"#;
    assert!(refusal(read("glb", &glb_with(&TRIANGLE, &[0, 1, 2], &[(r#"{"mesh":0}"#, node)]))).contains("affine"));
}

#[test]
fn a_mesh_stands_wherever_a_node_of_the_default_scene_puts_it() {
    let nodes = r#"{"mesh":0},{"mesh":0,"translation":[9,0,0]},{"mesh":0,"translation":[100,0,0]}"#;
    let count = |scene_edit: (&str, &str)| {
        let bytes = glb_with(&TRIANGLE, &[0, 1, 2], &[(r#"{"mesh":0}"#, nodes), scene_edit]);
        read("glb", &bytes).unwrap().meshes().len()
    };
    assert_eq!(count((r#""nodes":[0]"#, r#""nodes":[1,0]"#)), 2);
    assert_eq!(count((r#""scene":0,"scenes":[{"nodes":[0]}]"#, r#""scenes":[{"nodes":[0]},{"nodes":[0,2]}]"#)), 2);
    assert_eq!(count((r#""scene":0,"scenes":[{"nodes":[0]}],"#, "")), 3);
}

#[test]
fn strips_fans_and_meshes_without_indices_become_triangles() {
    let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    let triangles = |mode: &str| {
        let edit = (r#""indices":1"#, &*format!(r#""indices":1,"mode":{mode}"#));
        read("glb", &glb_with(&square, &[0, 1, 2, 3], &[edit])).map(|scene| scene.meshes()[0].triangles.clone())
    };
    assert_eq!(triangles("5").unwrap(), [[0, 1, 2], [1, 3, 2]]);
    assert_eq!(triangles("6").unwrap(), [[1, 2, 0], [2, 3, 0]]);
    assert!(triangles("4").unwrap_err().to_string().contains("4 corners"));
    assert!(triangles("7").unwrap_err().to_string().contains("mode"));

    let scene = read("glb", &glb_with(&TRIANGLE, &[], &[(r#","indices":1"#, "")])).unwrap();
    assert_eq!(scene.meshes()[0].triangles, [[0, 1, 2]]);
}

#[test]
fn strided_and_offset_accessors_read_the_right_bytes() {
    // Position, then 4 bytes of something else; the first element is skipped by the accessor's offset.
    let rows: Vec<f32> = [[7.0; 3]].iter().chain(&TRIANGLE).flat_map(|v| [v[0], v[1], v[2], 99.0]).collect();
    let mut binary: Vec<u8> = rows.iter().flat_map(|x| x.to_le_bytes()).collect();
    binary.extend([0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
    let json = |count: u32| {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"nodes":[{{"mesh":0}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
"accessors":[{{"bufferView":0,"byteOffset":16,"componentType":5126,"count":{count},"type":"VEC3"}},
{{"bufferView":1,"componentType":5125,"count":3,"type":"SCALAR"}}],
"bufferViews":[{{"buffer":0,"byteLength":64,"byteStride":16}},{{"buffer":0,"byteOffset":64,"byteLength":12}}],
"buffers":[{{"byteLength":76}}]}}"#
        )
    };
    let scene = read("glb", &glb(json(3).as_bytes(), &binary)).unwrap();
    assert_eq!(scene.meshes()[0].vertices, TRIANGLE.map(|v| v.map(f64::from)));
    assert_eq!(scene.meshes()[0].triangles, [[0, 1, 2]]);
    assert!(refusal(read("glb", &glb(json(4).as_bytes(), &binary))).contains("past the end"));
}

#[test]
fn materials_keep_colour_and_roughness_and_note_the_rest() {
    let material = r#""materials":[{"pbrMetallicRoughness":{"baseColorFactor":[0.1,0.2,0.3,0.4],"metallicFactor":0.5,
        "roughnessFactor":0.25,"baseColorTexture":{"index":0}},"normalTexture":{"index":0},"alphaMode":"MASK"}],
        "cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":1}}],
        "images":[{"uri":"absent.png"}],"textures":[{"source":0}],"accessors":["#;
    let bytes = glb_with(
        &TRIANGLE,
        &[0, 1, 2],
        &[(r#""accessors":["#, material), (r#""indices":1"#, r#""indices":1,"material":0"#)],
    );
    let scene = read("glb", &bytes).unwrap();
    let material = scene.meshes()[0].material;
    assert_eq!((material.base_color, material.roughness, material.specular), ([0.1, 0.2, 0.3], 0.25, 0.04));
    assert_eq!(material.opacity, 1.0, "a mask's alpha is no opacity");
    let notes = scene.notes().join("\n");
    for word in ["textures", "normal maps", "metallic", "alpha masks", "1 cameras"] {
        assert!(notes.contains(word), "{word} is not in {notes}");
    }
}

#[test]
fn alpha_is_opacity_where_it_blends_and_nowhere_else() {
    let of = |mode: &str, alpha: &str| {
        let factor = format!(r#"{{"baseColorFactor":[0.1,0.2,0.3,{alpha}],"metallicFactor":0}}"#);
        let material = format!(r#""materials":[{{"pbrMetallicRoughness":{factor}{mode}}}],"accessors":["#);
        let with_material = (r#""indices":1"#, r#""indices":1,"material":0"#);
        let bytes = glb_with(&TRIANGLE, &[0, 1, 2], &[(r#""accessors":["#, &material), with_material]);
        let scene = read("glb", &bytes).unwrap();
        (scene.meshes()[0].material.opacity, scene.notes().to_vec())
    };
    let blended = r#","alphaMode":"BLEND""#;
    for (alpha, opacity) in [("0.4", 0.4), ("0", 0.0), ("1", 1.0), ("1.5", 1.0), ("-3", 0.0)] {
        assert_eq!(of(blended, alpha), (opacity, Vec::new()));
    }
    assert_eq!(of("", "0.4"), (1.0, Vec::new()), "alpha means nothing unless it blends");
    let masked = of(r#","alphaMode":"MASK""#, "0.4");
    assert_eq!(masked, (1.0, vec!["alpha masks left out; their surfaces are opaque".to_owned()]));
}

#[test]
fn broken_references_and_sizes_are_refused() {
    for (old, new, word) in [
        (r#""mesh":0"#, r#""mesh":7"#, "mesh 7"),
        (r#""nodes":[0]"#, r#""nodes":[3]"#, "node 3"),
        (r#""nodes":[0]"#, r#""nodes":[0,0]"#, "twice"),
        (r#""scene":0"#, r#""scene":1"#, "scene 1"),
        (r#"{"mesh":0}"#, r#"{"mesh":0,"children":[0]}"#, "twice"),
        (r#"{"mesh":0}"#, r#"{"mesh":0,"rotation":[0,0,0,0]}"#, "rotation"),
        (r#""POSITION":0"#, r#""NORMAL":0"#, "POSITION"),
        (r#""POSITION":0"#, r#""POSITION":9"#, "accessor 9"),
        (r#""POSITION":0"#, r#""POSITION":1"#, "float VEC3"),
        (r#""indices":1"#, r#""indices":0"#, "unsigned SCALAR"),
        (r#""indices":1"#, r#""indices":1,"material":4"#, "material 4"),
        (r#"{"bufferView":0,"#, "{", "no buffer view"),
        (r#"{"bufferView":0,"#, r#"{"bufferView":5,"#, "view 5"),
        (
            r#""bufferView":0,"#,
            r#""bufferView":0,"sparse":{"count":1,"indices":{"bufferView":1,
            "componentType":5123},"values":{"bufferView":0}},"#,
            "sparse",
        ),
        (r#""count":3,"type":"VEC3""#, r#""count":4,"type":"VEC3""#, "past the end"),
        // Times the size of an element, these wrap around 2^64.
        (r#""count":3,"type":"VEC3""#, r#""count":4611686018427387904,"type":"VEC3""#, "past the end"),
        (r#""count":3,"type":"VEC3""#, r#""count":4611686018427387905,"type":"VEC3""#, "past the end"),
        (r#""count":3,"type":"VEC3""#, r#""count":18446744073709551615,"type":"VEC3""#, "past the end"),
        (r#""bufferView":0,"#, r#""bufferView":0,"byteOffset":18446744073709551615,"#, "past the end"),
        (
            r#"{"buffer":0,"byteLength":36}"#,
            r#"{"buffer":0,"byteLength":36,"byteOffset":18446744073709551615}"#,
            "past",
        ),
        (r#"{"buffer":0,"byteLength":36}"#, r#"{"buffer":0,"byteLength":36,"byteStride":4}"#, "overlap"),
        (r#"{"buffer":0,"byteLength":36}"#, r#"{"buffer":0,"byteLength":36,"byteStride":0}"#, "overlap"),
        (r#"{"buffer":0,"byteLength":36}"#, r#"{"buffer":2,"byteLength":36}"#, "buffer 2"),
        (r#"{"byteLength":42}"#, r#"{"byteLength":4200}"#, "truncated"),
        (r#"{"byteLength":42}"#, r#"{"byteLength":4,"uri":"data:;base64,!!!!"}"#, "base64"),
        (r#""version":"2.0""#, r#""version":"1.0""#, "version 1.0"),
        (r#""scene":0"#, r#""extensionsRequired":["KHR_draco_mesh_compression"],"scene":0"#, "KHR_draco"),
        (r#""indices":1"#, r#""indices":1,"mode":1"#, "no triangles"),
    ] {
        let reason = refusal(read("glb", &glb_with(&TRIANGLE, &[0, 1, 2], &[(old, new)])));
        assert!(reason.contains(word), "{new}: {reason}");
    }
}

#[test]
fn a_small_file_cannot_ask_for_endless_meshes() {
    let too_large = |bytes: &[u8]| match read("glb", bytes) {
        Err(SceneError::TooLarge { what, needed, limit }) => (what, needed > limit),
        other => panic!("expected TooLarge, got {}", other.is_ok()),
    };
    let buffer = (r#"{"byteLength":42}"#, r#"{"byteLength":18446744073709551615}"#);
    assert!(too_large(&glb_with(&TRIANGLE, &[0, 1, 2], &[buffer])).1);

    // 1,500 nodes with 1,500 primitives each, of lines, which make no triangles that could be counted.
    let list = |item: &str| vec![item; 1_500].join(",");
    let primitive = r#"{"attributes":{"POSITION":0},"indices":1}"#;
    let roots = (0..1_500).map(|i| i.to_string()).collect::<Vec<_>>().join(",");
    let edits = [
        (primitive, &*list(r#"{"attributes":{"POSITION":0},"indices":1,"mode":1}"#)),
        (r#""nodes":[0]"#, &*format!(r#""nodes":[{roots}]"#)),
        (r#"{"mesh":0}"#, &*list(r#"{"mesh":0}"#)),
    ];
    let (what, is_above) = too_large(&glb_with(&TRIANGLE, &[0, 1, 2], &edits));
    assert!(is_above && what.contains("primitives"), "{what}");
}

#[test]
fn a_deep_tree_does_not_exhaust_the_stack() {
    let depth = 100_000;
    let mut nodes = String::new();
    for child in 1..depth {
        write!(nodes, r#"{{"children":[{child}]}},"#).unwrap();
    }
    let edit = (r#"{"mesh":0}"#, &*(nodes + r#"{"mesh":0}"#));
    assert_eq!(read("glb", &glb_with(&TRIANGLE, &[0, 1, 2], &[edit])).unwrap().triangle_count(), 1);
}

#[test]
fn bad_vertices_and_indices_are_named() {
    let mut positions = TRIANGLE;
    positions[2][1] = f32::NAN;
    let error = read("glb", &glb_with(&positions, &[0, 1, 2], &[])).unwrap_err();
    assert_eq!(error, SceneError::NotFinite { what: "mesh 'm' vertices".into(), index: 2 });

    let error = read("glb", &glb_with(&TRIANGLE, &[0, 1, 2, 0, 1, 3], &[])).unwrap_err();
    assert_eq!(error, SceneError::IndexOutOfRange { mesh: "m".into(), triangle: 1, vertex: 3, vertices: 3 });

    let node = (r#"{"mesh":0}"#, r#"{"mesh":0,"scale":[1e308,1,1],"translation":[1.7e308,0,0]}"#);
    let error = read("glb", &glb_with(&TRIANGLE, &[0, 1, 2], &[node])).unwrap_err();
    assert!(matches!(error, SceneError::NotFinite { index: 1, .. }), "{error}");
}

#[test]
fn every_truncation_of_a_glb_is_refused() {
    let bytes = glb_with(&TRIANGLE, &[0, 1, 2], &[]);
    assert!(read("glb", &bytes).is_ok());
    for length in 0..bytes.len() {
        refusal(read("glb", &bytes[..length]));
    }
}

#[test]
fn every_truncation_of_a_glb_with_a_matching_header_is_an_error() {
    let bytes = glb_with(&TRIANGLE, &[0, 1, 2], &[]);
    for length in 12..bytes.len() {
        let mut cut = bytes[..length].to_vec();
        cut[8..12].copy_from_slice(&(length as u32).to_le_bytes());
        assert!(read("glb", &cut).is_err(), "{length}");
    }
}

#[test]
fn gltf_reads_the_bin_beside_it_and_nothing_else() {
    let folder = empty_folder("gltf_beside");
    let binary: Vec<u8> = TRIANGLE.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    fs::write(folder.join("a mesh.bin"), &binary).unwrap();
    fs::create_dir_all(folder.join("inner")).unwrap();
    let path = folder.join("inner/../scene.gltf");
    let load_with = |uri: &str, length: usize| {
        let json = format!(
            r#"{{"asset":{{"version":"2.0"}},"nodes":[{{"mesh":0}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}}],
"bufferViews":[{{"buffer":0,"byteLength":36}}],"buffers":[{{"byteLength":{length},"uri":"{uri}"}}]}}"#
        );
        fs::write(&path, json).unwrap();
        load(&path)
    };
    assert_eq!(load_with("a%20mesh.bin", 36).unwrap().meshes()[0].vertices, TRIANGLE.map(|v| v.map(f64::from)));
    assert!(refusal(load_with("a%20mesh.bin", 37)).contains("truncated"));
    assert!(
        matches!(load_with("absent.bin", 36), Err(SceneError::FileUnreadable { path, .. }) if path.ends_with("absent.bin"))
    );
    assert!(matches!(load_with("inner.bin/x.bin", 36), Err(SceneError::FileUnreadable { .. })));
    for uri in ["../gltf_beside/a mesh.bin", "/a mesh.bin", "file:a mesh.bin", "inner/../a mesh.bin"] {
        assert!(refusal(load_with(uri, 36)).contains("URI"), "{uri}");
    }
    let inline = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAAEAAAAAA";
    let scene = load_with(&format!("data:application/octet-stream;base64,{inline}"), 36).unwrap();
    assert_eq!(scene.meshes()[0].vertices, TRIANGLE.map(|v| v.map(f64::from)));
}

#[test]
fn extensions_in_any_case_are_known_and_others_refused() {
    let folder = empty_folder("extensions");
    let path = folder.join("A.GLB");
    fs::write(&path, glb_with(&TRIANGLE, &[0, 1, 2], &[])).unwrap();
    assert!(load(&path).is_ok());
    for (name, expected) in [("a.fbx", "fbx"), ("a", ""), ("a.GLB.Zip", "zip")] {
        let error = load(&folder.join(name)).unwrap_err();
        assert!(matches!(&error, SceneError::UnknownFormat { extension, .. } if extension == expected), "{error}");
    }
}

#[test]
fn missing_files_and_folders_are_unreadable() {
    let folder = empty_folder("missing");
    fs::create_dir(folder.join("folder.obj")).unwrap();
    for name in ["absent.glb", "absent.gltf", "absent.obj", "folder.obj"] {
        let error = load(&folder.join(name)).unwrap_err();
        assert!(matches!(&error, SceneError::FileUnreadable { path, .. } if path.ends_with(name)), "{error}");
    }
}

#[test]
fn obj_positions_are_float64() {
    let scene = read_obj("v 500000.123456789 4649776.22 1e-3\nv 1 0 0 1\nv 0 1 0 0.5 0.5 0.5\nf 1 2 3\n").unwrap();
    let mesh = &scene.meshes()[0];
    assert_eq!(mesh.vertices, [[500_000.123_456_789, 4_649_776.22, 1e-3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!((mesh.name.as_str(), &mesh.triangles[..]), ("scene", &[[0, 1, 2]][..]));
}

#[test]
fn obj_corners_count_from_the_front_or_back_and_polygons_are_fans() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n\
        f 1/1 2/1/1 3//1 4 # a square\nf -4 -2 \\\n  -1\nv 9 9 9\nf -1 1 2\nusemtl stone\ns off\n";
    let scene = read_obj(text).unwrap();
    assert_eq!(scene.meshes()[0].triangles, [[0, 1, 2], [0, 2, 3], [0, 2, 3], [4, 0, 1]]);
    let notes = scene.notes().join("\n");
    assert!(notes.contains("'usemtl'") && notes.contains("fans") && scene.notes().len() == 2, "{notes}");
}

#[test]
fn obj_groups_become_meshes_with_the_vertices_that_they_use() {
    let text = "o empty\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\ng front side\nf 1 2 3\no back\nf 4 3 2\n";
    let scene = read_obj(text).unwrap();
    let [front, back] = scene.meshes() else { panic!("two meshes expected") };
    assert_eq!((front.name.as_str(), back.name.as_str()), ("front side", "back"));
    assert_eq!((front.vertices.len(), &front.triangles[..]), (3, &[[0, 1, 2]][..]));
    assert_eq!(back.vertices, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    assert_eq!(back.triangles, [[2, 1, 0]]);
}

#[test]
fn broken_obj_lines_are_refused_with_their_number() {
    for (line, word) in [
        ("v 1 2", "3 coordinates"),
        ("v 1 2 x", "'x'"),
        ("v 1,0 2 3", "'1,0'"),
        ("f 1 2", "3 corners"),
        ("f", "3 corners"),
        ("f 1 2 0", "'0'"),
        ("f 1 2 -4", "'-4'"),
        ("f 1 2 -9223372036854775808", "before the first"),
        ("f 1 2 3/", "'3/'"),
        ("f 1 2 3/x", "'3/x'"),
        ("f 1 2 3/1/1/1", "'3/1/1/1'"),
        ("f 1 2 99999999999999999999", "corner"),
        ("f 1 2 3.0", "corner"),
        ("\u{89}PNG", "unknown statement"),
    ] {
        let reason = refusal(read_obj(&format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{line}\nf 1 2 3\n")));
        assert!(reason.contains("line 4") && reason.contains(word), "{line}: {reason}");
    }
    assert!(refusal(read_obj("")).contains("no faces"));
    assert!(refusal(read_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 \\")).contains("truncated"));
}

#[test]
fn obj_vertices_that_are_missing_or_not_finite_are_named() {
    for (faces, mesh, triangle) in [("f 1 2 3\nf 1 2 7\n", "scene", 1), ("o a\nf 1 2 3\no b\nf 1 2 7\n", "b", 0)] {
        let error = read_obj(&format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}")).unwrap_err();
        // The seventh vertex of the file has the index 6.
        assert_eq!(error, SceneError::IndexOutOfRange { mesh: mesh.into(), triangle, vertex: 6, vertices: 3 });
    }
    let error = read_obj("v 0 0 0\nf 1 1 5000000000\n").unwrap_err();
    assert!(matches!(error, SceneError::IndexOutOfRange { vertex: 4_999_999_999, .. }), "{error}");
    for number in ["nan", "inf", "-infinity", "1e999"] {
        let error = read_obj(&format!("v 0 0 0\nv 1 {number} 0\nv 0 1 0\nf 1 2 3\n")).unwrap_err();
        assert!(matches!(error, SceneError::NotFinite { index: 1, .. }), "{error}");
    }
    // A face may come before its vertices.
    assert!(read_obj("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").is_ok());
}

/// Bytes of good files, changed at random: whatever comes out, it is a value. Counts both outcomes, so that a loop
/// whose changes never matter would show.
#[test]
fn random_changes_never_panic() {
    let node = (r#"{"mesh":0}"#, r#"{"mesh":0,"rotation":[0,0,0.6,0.8],"translation":[1,2,3],"children":[]}"#);
    let obj = "o a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\nf 1/1 2//2 3/3/3\nf -1 -2 -3 1\ng b\nf 4 3 2\n";
    // Most of the header is comment, so that many changes leave a file that can be read.
    let comment = "made by hand ".repeat(40);
    let ply = format!(
        "ply\ncomment {comment}\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n\
        property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n4 0 1 2 3\n"
    );
    let stl = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n";
    // Blocks of a header that no reader looks at, for the same reason.
    let binary_stl = [&[b'x'; 80][..], &2_u32.to_le_bytes(), &[0x3e; 100]].concat();
    let (header, _) = ply.split_once("0 0 0\n").unwrap();
    let header = header.replace("ascii", "binary_big_endian");
    let corners: Vec<u8> = (0..12).flat_map(|i: u8| f32::from(i).to_be_bytes()).collect();
    let faces = [[3, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2], [3, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 3]].concat();
    let binary_ply = [header.as_bytes(), &corners, &faces].concat();
    let files = [
        ("glb", glb_with(&TRIANGLE, &[0, 1, 2], &[node])),
        ("obj", obj.as_bytes().to_vec()),
        ("ply", ply.into_bytes()),
        ("ply", binary_ply),
        ("stl", stl.as_bytes().to_vec()),
        ("stl", binary_stl),
    ];
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut random = |below: usize| {
        // Xorshift: Marsaglia 2003.
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state % below as u64) as usize
    };
    for (extension, good) in &files {
        let mut read_count = 0;
        for _ in 0..5_000 {
            let mut bytes = good.clone();
            for _ in 0..=random(4) {
                let place = random(bytes.len());
                match random(4) {
                    0 => bytes[place] = random(256) as u8,
                    1 => bytes[place] ^= 1 << random(8),
                    2 => bytes[place] = b"0123456789-{}[],:\"e. /\n"[random(23)],
                    _ => bytes.swap(place, random(good.len())),
                }
            }
            if let Ok(scene) = read(extension, &bytes) {
                read_count += 1;
                assert!(scene.bounds().is_some_and(|(low, high)| low.iter().chain(&high).all(|x| x.is_finite())));
            }
        }
        assert!((100..4_900).contains(&read_count), "{extension}: {read_count} of 5,000 were readable");
    }
}
