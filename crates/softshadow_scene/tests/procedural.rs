//! The scenes that come with the library, and texts that must be refused.

use softshadow_scene::edges::edges;
use softshadow_scene::procedural::{self, LightShape, MAX_PROCEDURAL_TRIANGLES};
use softshadow_scene::{Scene, SceneError};

/// What each scene is, found once by building it: name, triangles, hash. A change here changes every benchmark that
/// uses the scene, so it needs a reason.
const EXPECTED: [(&str, usize, u64); 5] = [
    ("canopy", 40_066, 0xab2e_3d46_d327_0450),
    ("cards", 64, 0xf302_7a70_930a_02ee),
    ("fork", 446, 0x1973_6408_383f_274b),
    ("hall", 4928, 0xb5a8_8bc3_5911_f7a2),
    ("toruses", 32_642, 0x6547_e25c_be26_159f),
];

/// FNV-1a of coordinates in steps of a micrometre and of the indices. Sines may differ in their last bit between
/// platforms, micrometres do not.
fn hash(scene: &Scene) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut add = |value: i64| {
        for byte in value.to_le_bytes() {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    };
    for mesh in scene.meshes() {
        mesh.vertices.iter().flatten().for_each(|x| add((x * 1e6).round() as i64));
        mesh.triangles.iter().flatten().for_each(|&v| add(i64::from(v)));
    }
    hash
}

fn one_part(shape: &str) -> String {
    format!(
        r#"{{"name": "test", "description": "", "parts": [
            {{"name": "part", "base_color": [1, 1, 1], "of": [{{"shape": {shape}}}]}}],
            "light": {{"shape": {{"sphere": {{"radius": 1}}}}, "position": [0, 5, 0], "target": [0, 0, 0],
                       "up": [1, 0, 0], "radiance": [1, 1, 1]}},
            "camera": {{"eye": [0, 1, 5], "target": [0, 0, 0], "fov_y_deg": 40, "size": [4, 4]}}}}"#
    )
}

fn refusal(text: &str) -> String {
    match procedural::parse(text) {
        Err(SceneError::Invalid { what, reason }) => format!("{what}: {reason}"),
        other => panic!("expected a refusal of {text}, got {other:?}"),
    }
}

/// Six times the signed volume, positive if the surface is wound outwards.
fn volume(scene: &Scene) -> f64 {
    let mesh = &scene.meshes()[0];
    let triangle = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| mesh.vertices[v as usize]);
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    mesh.triangles.iter().map(triangle).sum::<f64>() / 6.0
}

#[test]
fn shipped_scenes_are_what_they_were() {
    let measured = procedural::names().map(|name| {
        let description = procedural::shipped(name).unwrap();
        assert_eq!(description.name(), name);
        assert!(!description.description().is_empty());
        let scene = description.build().unwrap();
        assert_eq!(hash(&scene), hash(&description.build().unwrap()), "{name} must not change between builds");
        (name, scene.triangle_count(), hash(&scene))
    });
    assert_eq!(measured, EXPECTED);
}

#[test]
fn the_hash_sees_a_moved_part() {
    let hash_at = |height: f64| {
        let text = one_part(r#"{"box": {"size": [1, 1, 1]}}, "position": [0, HEIGHT, 0]"#);
        hash(&procedural::parse(&text.replace("HEIGHT", &height.to_string())).unwrap().build().unwrap())
    };
    assert_ne!(hash_at(0.0), hash_at(2e-6));
    assert_eq!(hash_at(0.0), hash_at(1e-12));
}

#[test]
fn a_part_is_opaque_unless_it_says_otherwise() {
    let text = one_part(r#"{"box": {"size": [1, 1, 1]}}"#);
    let opacity = |text: &str| procedural::parse(text).unwrap().build().unwrap().meshes()[0].material.opacity;
    assert_eq!(opacity(&text), 1.0);
    assert_eq!(opacity(&text.replace(r#""name": "part""#, r#""name": "part", "opacity": 0.25"#)), 0.25);
}

#[test]
fn shipped_scenes_have_sane_bounds_lights_and_cameras() {
    for name in procedural::names() {
        let description = procedural::shipped(name).unwrap();
        let (low, high) = description.build().unwrap().bounds().unwrap();
        for k in 0..3 {
            assert!(low[k] > -10.0 && high[k] < 10.0 && low[k] <= high[k], "{name}: {low:?} to {high:?}");
        }
        assert!(description.light().position[1] > high[1], "{name}: the light must be above everything");
        assert!(description.camera().eye[1] > 0.0 && description.camera().eye[1] < 10.0, "{name}");
        assert!(description.camera().size.iter().all(|&n| (256..=2048).contains(&n)), "{name}");
    }
    assert!(procedural::shipped("hall").unwrap().build().unwrap().triangle_count() < 5_000);
}

#[test]
fn nothing_is_below_its_floor() {
    for name in ["canopy", "cards", "fork", "toruses"] {
        let (low, _) = procedural::shipped(name).unwrap().build().unwrap().bounds().unwrap();
        assert_eq!(low[1], 0.0, "{name}");
    }
}

#[test]
fn cards_and_fork_touch_what_they_rest_on() {
    for (name, highest_gap) in [("cards", 0.0), ("fork", 2e-3)] {
        let scene = procedural::shipped(name).unwrap().build().unwrap();
        for mesh in scene.meshes().iter().skip(1) {
            let lowest = mesh.vertices.iter().map(|v| v[1]).fold(f64::INFINITY, f64::min);
            assert!((0.0..=highest_gap).contains(&lowest), "{name}, {}: {lowest}", mesh.name);
        }
    }
}

/// The numbers of the published comparison: 20,000 leaves of s by s/2 in a ball, and the light above them.
#[test]
fn canopy_is_the_canopy() {
    let description = procedural::shipped("canopy").unwrap();
    assert_eq!(description.light().shape, LightShape::Rectangle { width: 2.0, height: 2.0 });
    assert_eq!((description.light().position, description.light().target), ([0.0, 5.0, 0.0], [0.0; 3]));
    let camera = description.camera();
    assert_eq!((camera.eye, camera.target, camera.fov_y_deg), ([2.6, 2.4, 3.6], [0.0, 0.85, 0.0], 40.0));

    let scene = description.build().unwrap();
    let leaves = scene.meshes().iter().find(|mesh| mesh.name == "leaves").unwrap();
    assert_eq!(leaves.triangles.len(), 40_000);
    let distance = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
    let mut mean_cubed_distance = 0.0;
    for corners in leaves.vertices.as_chunks::<4>().0 {
        let [a, b, c, d] = *corners;
        let (long, short) = (distance(a, b), distance(b, c));
        assert!((0.04 - 1e-12..=0.1 + 1e-12).contains(&long) && (long - 2.0 * short).abs() < 1e-12);
        assert!((distance(a, c) - distance(b, d)).abs() < 1e-12, "a leaf must be a rectangle");
        let centre = [0, 1, 2].map(|k| (a[k] + c[k]) / 2.0);
        let from_middle = distance(centre, [0.0, 1.6, 0.0]);
        assert!(from_middle <= 0.8 + 1e-12);
        mean_cubed_distance += (from_middle / 0.8).powi(3) / 20_000.0;
    }
    // Uniform in a ball means that the cubed distance is uniform in 0..1; its standard error is 0.002.
    assert!((mean_cubed_distance - 0.5).abs() < 0.008, "{mean_cubed_distance}");
}

#[test]
fn solids_are_closed_and_wound_outwards() {
    for (shape, expected_volume, tolerance) in [
        (r#"{"box": {"size": [1, 2, 3]}}"#, 6.0, 1e-12),
        (r#"{"cylinder": {"radius": 1, "height": 2, "segments": 200}}"#, std::f64::consts::TAU, 0.01),
        (r#"{"cylinder": {"radius": 2, "top_radius": 1, "height": 3, "segments": 200}}"#, 21.991, 0.02),
        (r#"{"torus": {"major": 2, "minor": 0.5, "segments": [100, 100]}}"#, 9.8696, 0.05),
        (r#"{"sphere": {"radius": 1, "subdivisions": 4}}"#, 4.18879, 0.02),
    ] {
        let scene = procedural::parse(&one_part(shape)).unwrap().build().unwrap();
        let mesh = &scene.meshes()[0];
        let list = edges(&mesh.vertices, &mesh.triangles).unwrap();
        let is_closed = list.edges.iter().all(|e| matches!(list.incidences_of(e), [a, b] if a.forward != b.forward));
        assert!(is_closed, "{shape}");
        assert!((volume(&scene) - expected_volume).abs() < tolerance, "{shape}: {}", volume(&scene));
    }
}

#[test]
fn transforms_scale_then_turn_about_x_y_z_then_move() {
    let text = one_part(
        r#"{"quad": {"size": [2, 2]}}, "scale": [3, 1, 1], "rotation_deg": [90, 90, 0], "position": [10, 20, 30]"#,
    );
    let scene = procedural::parse(&text).unwrap().build().unwrap();
    // (1, 1, 0) → (3, 1, 0) → about x (3, 0, 1) → about y (1, 0, -3) → (11, 20, 27).
    let expected = [11.0, 20.0, 27.0];
    let corner = scene.meshes()[0].vertices[2];
    assert!((0..3).all(|k| (corner[k] - expected[k]).abs() < 1e-12), "{corner:?}");
}

#[test]
fn a_grid_is_centred_and_counts_its_copies() {
    let shape = r#"{"grid": {"count": [3, 1, 2], "step": [2, 9, 4], "of": [
        {"shape": {"box": {"size": [1, 1, 1]}}}, {"shape": {"plane": {"size": [1, 1]}}}]}}"#;
    let scene = procedural::parse(&one_part(shape)).unwrap().build().unwrap();
    assert_eq!(scene.triangle_count(), 6 * 14);
    assert_eq!(scene.bounds().unwrap(), ([-2.5, -0.5, -2.5], [2.5, 0.5, 2.5]));
}

#[test]
fn unknown_names_are_refused_with_the_known_ones() {
    let message = procedural::shipped("bunny").unwrap_err().to_string();
    assert!(procedural::names().iter().all(|name| message.contains(name)), "{message}");
}

#[test]
fn unknown_fields_shapes_and_values_are_refused() {
    let good = one_part(r#"{"box": {"size": [1, 1, 1]}}"#);
    assert!(procedural::parse(&good).is_ok());
    for (old, new, in_message) in [
        (r#""description""#, r#""descripton""#, "descripton"),
        (r#""base_color""#, r#""colour""#, "colour"),
        (r#""box""#, r#""cube""#, "cube"),
        (r#""size": [1, 1, 1]"#, r#""size": [1, 1, 1], "segments": 3"#, "segments"),
        (r#""size": [1, 1, 1]"#, r#""size": [1, 1, 0]"#, "positive"),
        (r#""size": [1, 1, 1]"#, r#""size": [1, 1, 1e999]"#, "number"),
        (r#""size": [1, 1, 1]"#, r#""size": [1, 1]"#, "length"),
        (r#""base_color": [1"#, r#""base_color": [1.5"#, "0..=1"),
        (r#""base_color": [1"#, r#""opacity": 1.5, "base_color": [1"#, "0..=1"),
        (r#"[{"shape": {"box": {"size": [1, 1, 1]}}}]"#, "[]", "at least one shape"),
        (r#""sphere": {"radius": 1}"#, r#""lamp": {"radius": 1}"#, "lamp"),
        (r#""sphere": {"radius": 1}"#, r#""sphere": {"radius": -1}"#, "positive"),
        (r#""up": [1, 0, 0]"#, r#""up": [0, 1, 0]"#, "up"),
        (r#""eye": [0, 1, 5]"#, r#""eye": [0, 0, 0]"#, "apart"),
        (r#""fov_y_deg": 40"#, r#""fov_y_deg": 180"#, "fov_y_deg"),
        (r#""radiance": [1"#, r#""radiance": [-1"#, "negative"),
        (r#""size": [4, 4]"#, r#""size": [4, 0]"#, "pixel"),
    ] {
        assert!(good.contains(old), "{old}");
        let message = refusal(&good.replacen(old, new, 1));
        assert!(message.contains(in_message), "{new}: {message}");
    }
    for cut in 0..good.len() {
        refusal(&good[..cut]);
    }
}

#[test]
fn shapes_without_a_meaning_are_refused() {
    for shape in [
        r#"{"cylinder": {"radius": 1, "height": 1, "segments": 2}}"#,
        r#"{"torus": {"major": 1, "minor": 1, "segments": [8, 8]}}"#,
        r#"{"torus": {"major": 1, "minor": 0.1, "segments": [8, 2]}}"#,
        r#"{"sphere": {"radius": 1, "subdivisions": 11}}"#,
        r#"{"leaves": {"count": 0, "seed": 0, "center": [0, 0, 0], "radius": 1, "size": [1, 2]}}"#,
        r#"{"leaves": {"count": 1, "seed": 0, "center": [0, 0, 0], "radius": 1, "size": [2, 1]}}"#,
        r#"{"grid": {"count": [1, 0, 1], "step": [1, 1, 1], "of": [{"shape": {"quad": {"size": [1, 1]}}}]}}"#,
        r#"{"grid": {"count": [9, 9, 9], "step": [1, 1, 1], "of": []}}"#,
    ] {
        refusal(&one_part(shape));
    }
}

#[test]
fn counts_above_the_limit_are_refused_before_anything_is_allocated() {
    let huge = u32::MAX;
    let quad = r#"{"quad": {"size": [1, 1]}}"#;
    let grid = |of: &str| {
        format!(r#"{{"grid": {{"count": [{huge}, {huge}, {huge}], "step": [1, 1, 1], "of": [{{"shape": {of}}}]}}}}"#)
    };
    for shape in [
        format!(r#"{{"leaves": {{"count": {huge}, "seed": 0, "center": [0, 0, 0], "radius": 1, "size": [1, 2]}}}}"#),
        format!(r#"{{"cylinder": {{"radius": 1, "height": 1, "segments": {huge}}}}}"#),
        format!(r#"{{"torus": {{"major": 2, "minor": 1, "segments": [{huge}, {huge}]}}}}"#),
        r#"{"sphere": {"radius": 1, "subdivisions": 10}}"#.to_string(),
        grid(quad),
        grid(&grid(quad)),
        // 2^64 copies, which wrap around to none.
        grid(quad).replace(&format!("[{huge}, {huge}, {huge}]"), "[2147483648, 2147483648, 4]"),
    ] {
        let error = procedural::parse(&one_part(&shape)).unwrap_err();
        assert!(
            matches!(error, SceneError::TooLarge { needed, limit, .. } if needed > limit && limit == MAX_PROCEDURAL_TRIANGLES),
            "{shape}: {error}"
        );
    }
}

#[test]
fn products_beyond_float64_are_an_error() {
    let text = one_part(r#"{"box": {"size": [1e300, 1, 1]}}, "scale": [1e300, 1, 1]"#);
    assert!(matches!(procedural::parse(&text).unwrap().build(), Err(SceneError::NotFinite { .. })));
}
