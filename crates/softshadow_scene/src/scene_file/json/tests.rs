use std::fs;
use std::path::PathBuf;

use serde_json::{Value, json};

use super::*;
use crate::light::LightShape;

const SCHEMA: &str = include_str!("../scene.schema.json");
const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n";

/// A folder with `part.obj` and `two.obj`, for the scene `inner/scene.json`.
fn folder() -> PathBuf {
    // One for each test thread: tests run side by side.
    let name = format!("softshadow-json-{}-{:?}", std::process::id(), std::thread::current().id());
    let folder = std::env::temp_dir().join(name);
    fs::create_dir_all(folder.join("inner")).unwrap();
    fs::write(folder.join("part.obj"), TRIANGLE).unwrap();
    fs::write(folder.join("inner/two.obj"), "v 0 0 0\nv 1 0 0\nv 0 2 0\ng a\nf 1 2 3\ng b\nf 3 2 1\n").unwrap();
    folder
}

fn read(text: &str) -> Result<SceneFile, SceneError> {
    let folder = folder();
    let read = parse(&folder.join("inner/scene.json"), text.as_bytes());
    fs::remove_dir_all(folder).unwrap();
    read
}

/// The least scene with some fields added or replaced.
fn with(fields: &Value) -> Value {
    let mut scene = json!({"softshadow": 1, "meshes": [{"path": "../part.obj"}]});
    scene.as_object_mut().unwrap().extend(fields.as_object().unwrap().clone());
    scene
}

fn refusal(scene: &Value) -> String {
    match read(&scene.to_string()) {
        Err(SceneError::FileInvalid { reason, .. }) => reason,
        other => panic!("expected FileInvalid, got {other:?}"),
    }
}

fn mesh(fields: Value) -> Result<SceneFile, SceneError> {
    let mut mesh = json!({"path": "../part.obj"});
    mesh.as_object_mut().unwrap().extend(fields.as_object().unwrap().clone());
    read(&with(&json!({"meshes": [mesh]})).to_string())
}

fn light(fields: Value) -> crate::Light {
    read(&with(&json!({"lights": [fields]})).to_string()).unwrap().lights[0].light.clone()
}

#[test]
fn meshes_stand_where_matrix_or_parts_put_them() {
    let vertices = |fields| mesh(fields).unwrap().scene.meshes()[0].vertices.clone();
    let rows = json!([[0, -1, 0, 5], [2, 0, 0, 6], [0, 0, 1, 7], [0, 0, 0, 1]]);
    assert_eq!(vertices(json!({"world_from_mesh": rows})), [[5.0, 6.0, 7.0], [5.0, 8.0, 7.0], [3.0, 6.0, 7.0]]);
    let parts = vertices(json!({"scale": [2, 1, 1], "rotate_xyz_deg": [0, 0, 90], "translate": [5, 6, 7]}));
    for (got, expected) in parts.iter().zip([[5.0, 6.0, 7.0], [5.0, 8.0, 7.0], [3.0, 6.0, 7.0]]) {
        assert!(got.iter().zip(expected).all(|(a, b): (&f64, f64)| (a - b).abs() < 1e-14), "{parts:?}");
    }
    // About X first: Y goes to Z; then about Z, which leaves it.
    let parts = vertices(json!({"rotate_xyz_deg": [90, 0, 90]}));
    assert!((parts[2][2] - 2.0).abs() < 1e-14 && (parts[1][1] - 1.0).abs() < 1e-14, "{parts:?}");
    assert_eq!(vertices(json!({})), [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]]);
}

#[test]
fn units_meet_in_the_scene() {
    let second = |scene: Value| read(&scene.to_string()).unwrap().scene.meshes()[0].vertices[1];
    let centimetres = json!([{"path": "../part.obj", "meters_per_unit": 0.01, "translate": [3, 0, 0]}]);
    assert_eq!(second(with(&json!({"meshes": centimetres}))), [3.01, 0.0, 0.0], "a part in cm in a scene in metres");
    assert_eq!(second(with(&json!({"meters_per_unit": 0.001}))), [1.0, 0.0, 0.0], "an OBJ is in the scene's unit");
    let file = read(&with(&json!({"meters_per_unit": 0.001})).to_string()).unwrap();
    assert_eq!(file.meters_per_unit, Some(0.001));
}

#[test]
fn materials_and_names_replace_those_of_the_file() {
    let material = json!({"base_color": [0.1, 0.2, 0.3], "roughness": 0.5, "specular": 0.04});
    let scene = mesh(json!({"name": "roof", "material": material, "opacity": 0.25})).unwrap().scene;
    let expected = crate::Material { base_color: [0.1, 0.2, 0.3], roughness: 0.5, specular: 0.04, opacity: 0.25 };
    assert_eq!((scene.meshes()[0].name.as_str(), scene.meshes()[0].material), ("roof", expected));
    let entries = json!([{"path": "two.obj", "name": "pair"}, {"path": "two.obj"}, {"path": "../part.obj"}]);
    let file = read(&with(&json!({"meshes": entries})).to_string()).unwrap();
    let names: Vec<_> = file.scene.meshes().iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["pair/a", "pair/b", "a", "b", "part"]);
    assert_eq!(file.scene.meshes()[4].material, crate::Material::default());
}

#[test]
fn lights_have_usd_s_words_and_sizes() {
    let rect =
        light(json!({"type": "RectLight", "width": 2, "height": 3, "translate": [0, 4, 0], "target": [0, 0, 0]}));
    assert_eq!(*rect.shape(), LightShape::Rectangle { width: 2.0, height: 3.0 });
    assert_eq!(rect.world_from_light(), crate::look_at([0.0, 4.0, 0.0], [0.0; 3], None).unwrap());
    assert_eq!(*light(json!({"type": "DiskLight"})).shape(), LightShape::Disc { radius: 0.5 });
    assert_eq!(*light(json!({"type": "SphereLight", "radius": 0.1})).shape(), LightShape::Sphere { radius: 0.1 });
    let sun = light(json!({"type": "DistantLight", "rotate_xyz_deg": [-90, 0, 0]}));
    assert_eq!(*sun.shape(), LightShape::Sun { angular_diameter: 0.53_f64.to_radians() });
    assert!((sun.world_from_light()[1][2] - 1.0).abs() < 1e-15, "it shines down along −Y: its Z is up");
    let bright = light(json!({"type": "DiskLight", "color": [1, 0.5, 0.25], "intensity": 3, "exposure": 2}));
    assert_eq!(bright.radiance(), [12.0, 6.0, 3.0]);
    let rows = json!([[1, 0, 0, 1], [0, 1, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]);
    assert_eq!(
        light(json!({"type": "RectLight", "world_from_light": rows})).world_from_light()[2],
        [0.0, 0.0, 1.0, 3.0]
    );
}

#[test]
fn a_camera_is_checked_and_kept() {
    let view = json!({"eye": [1, 2, 3], "target": [0, 0, 0], "fov_y_deg": 40, "size": [64, 48]});
    let file = read(&with(&json!({"camera": view})).to_string()).unwrap();
    let expected = FileCamera { eye: [1.0, 2.0, 3.0], target: [0.0; 3], up: None, fov_y_deg: 40.0, size: [64, 48] };
    assert_eq!(file.camera, Some(expected));
    for (field, value, words) in [
        ("fov_y_deg", json!(180), "camera: camera fov_y_deg: must lie between"),
        ("size", json!([0, 4]), "camera: camera size"),
        ("size", json!([1.5, 4]), "camera.size[0]: invalid type"),
        ("eye", json!([0, 0, 0]), "same point"),
        ("up", json!([1, 2, 3]), "parallel"),
    ] {
        let mut view = view.clone();
        view[field] = value;
        let reason = refusal(&with(&json!({"camera": view})));
        assert!(reason.contains(words), "{reason}");
    }
}

#[test]
fn mistakes_are_named_with_their_place() {
    let mesh = |extra: Value| {
        let mut mesh = json!({"path": "../part.obj"});
        mesh.as_object_mut().unwrap().extend(extra.as_object().unwrap().clone());
        json!({"meshes": [mesh]})
    };
    let lit = |light: Value| json!({"lights": [{"type": "DiskLight"}, light]});
    let mirror = json!([[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]);
    for (fields, words) in [
        (json!({"softshadow": 2}), "softshadow: version 2 cannot be read; 1 can"),
        (json!({"softshadow": null}), "\"softshadow\": 1 is missing"),
        (json!({"softshadow": "1"}), "softshadow: invalid type"),
        (json!({"lihgts": []}), "unknown field `lihgts`"),
        (json!({"meters_per_unit": 0}), "meters_per_unit: must be positive"),
        (json!({"meshes": []}), "no meshes with triangles"),
        (json!({"meshes": null}), "meshes: invalid type"),
        (mesh(json!({"colour": 1})), "meshes[0].colour: unknown field `colour`"),
        (mesh(json!({"path": "a.fbx"})), "meshes[0]: path: "),
        (mesh(json!({"path": "scene.json"})), "cannot hold another scene.json"),
        (mesh(json!({"material": {"metal": 1}})), "meshes[0].material.metal: unknown field `metal`"),
        (mesh(json!({"material": {"roughness": 1.5}})), "meshes[0]: material.roughness: must lie between 0 and 1"),
        (mesh(json!({"material": {"base_color": [0, 0, -1]}})), "material.base_color: must lie"),
        (mesh(json!({"opacity": -0.5})), "meshes[0]: opacity: must lie"),
        (mesh(json!({"meters_per_unit": -1})), "meshes[0]: meters_per_unit"),
        (mesh(json!({"scale": 2})), "meshes[0].scale: invalid type"),
        (mesh(json!({"scale": [1, 1]})), "meshes[0].scale: invalid length 2"),
        (mesh(json!({"world_from_mesh": mirror, "scale": [1, 1, 1]})), "give either world_from_mesh"),
        (mesh(json!({"world_from_mesh": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [5, 6, 7, 1]]})), "last row"),
        (mesh(json!({"scale": [1e308, 1, 1], "translate": [1.7e308, 0, 0]})), "transformed vertices"),
        (lit(json!({"type": "DomeLight"})), "lights[1].type: unknown variant `DomeLight`"),
        (lit(json!({"width": 1})), "lights[1]: missing field `type`"),
        (
            lit(json!({"type": "RectLight", "radius": 1})),
            "lights[1]: a RectLight has no 'radius'; it has width and height",
        ),
        (lit(json!({"type": "RectLight", "widht": 1})), "lights[1].widht: unknown field `widht`"),
        (lit(json!({"type": "RectLight", "width": -1})), "lights[1]: light width: must be finite and not negative"),
        (lit(json!({"type": "DistantLight", "angle": 180})), "below 180 degrees"),
        (lit(json!({"type": "DiskLight", "intensity": -1})), "lights[1]: color · intensity · 2^exposure"),
        (lit(json!({"type": "DiskLight", "exposure": 1e9})), "must be finite"),
        (lit(json!({"type": "DiskLight", "world_from_light": mirror})), "is a mirror"),
        (
            lit(json!({"type": "DiskLight", "world_from_light": mirror, "translate": [0, 0, 0]})),
            "give either world_from",
        ),
        (lit(json!({"type": "DiskLight", "target": [1, 0, 0], "rotate_xyz_deg": [0, 0, 0]})), "either rotate_xyz_deg"),
        (lit(json!({"type": "DiskLight", "target": [0, 0, 0]})), "same point"),
        (lit(json!({"type": "DiskLight", "up": [0, 1, 0]})), "up needs a target"),
        (
            json!({"lights": [{"type": "DiskLight", "name": "a"}, {"type": "DiskLight", "name": "a"}]}),
            "a second light 'a'",
        ),
    ] {
        let reason = refusal(&with(&fields));
        assert!(reason.contains(words), "{fields}: {reason}");
    }
}

#[test]
fn hostile_texts_are_refused() {
    for (text, words) in [
        ("", "EOF"),
        ("[]", "invalid length"),
        ("{\"softshadow\": 1", "EOF"),
        ("{\"softshadow\": 1, \"meshes\": []} x", "trailing characters"),
        ("{\"softshadow\": 1, \"softshadow\": 1, \"meshes\": []}", "duplicate field"),
        (
            "{\"softshadow\": 1, \"meshes\": [{\"path\": \"../part.obj\", \"scale\": [1e999, 1, 1]}]}",
            "number out of range",
        ),
        ("{\"softshadow\": 1, \"meshes\": [{\"path\": \"../part.obj\", \"scale\": [NaN, 1, 1]}]}", "expected"),
    ] {
        let reason = read(text).unwrap_err().to_string();
        assert!(reason.contains(words), "{text}: {reason}");
    }
    for deep in ["[", "{\"a\":"] {
        let deep = deep.repeat(1_000_000);
        for text in [deep.clone(), format!("{{\"softshadow\": 1, \"meshes\": {deep}"), format!("{{\"x\": {deep}")] {
            assert!(read(&text).is_err());
        }
    }
    let long = " ".repeat(MAX_BYTES as usize + 1);
    assert!(matches!(read(&long).unwrap_err(), SceneError::TooLarge { limit: MAX_BYTES, .. }));
}

#[test]
fn files_of_meshes_must_be_there_and_regular() {
    let unreadable = |path: &str| match read(&with(&json!({"meshes": [{"path": path}]})).to_string()) {
        Err(SceneError::FileUnreadable { reason, .. }) => reason,
        other => panic!("expected FileUnreadable, got {other:?}"),
    };
    assert!(!unreadable("absent.obj").is_empty());
    assert!(!unreadable("nul\0.obj").is_empty());
    let folder = folder();
    fs::create_dir_all(folder.join("inner/folder.obj")).unwrap();
    let read_path = |path: &std::path::Path| {
        let text = json!({"softshadow": 1, "meshes": [{"path": path}]}).to_string();
        parse(&folder.join("inner/scene.json"), text.as_bytes())
    };
    assert!(read_path("folder.obj".as_ref()).unwrap_err().to_string().contains("not a regular file"));
    assert!(read_path(&folder.join("part.obj")).is_ok(), "a path of its own may lead out of the folder");
    fs::write(folder.join("inner/broken.obj"), "v 1 2\n").unwrap();
    let error = read_path("broken.obj".as_ref()).unwrap_err();
    assert!(matches!(&error, SceneError::FileInvalid { path, .. } if path.ends_with("broken.obj")), "{error}");
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn notes_of_mesh_files_are_kept_once() {
    let folder = folder();
    fs::write(folder.join("inner/quad.obj"), "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n").unwrap();
    let text = json!({"softshadow": 1, "meshes": [{"path": "quad.obj"}, {"path": "quad.obj", "translate": [0, 0, 1]}]});
    let file = parse(&folder.join("inner/scene.json"), text.to_string().as_bytes()).unwrap();
    fs::remove_dir_all(folder).unwrap();
    assert_eq!(file.scene.notes().len(), 1);
    assert!(file.scene.notes()[0].starts_with("quad.obj: polygons"), "{:?}", file.scene.notes());
}

/// For each object of the schema: a scene that has it, in its least form, and where it stands.
fn objects(schema: &Value) -> [(&Value, Value, &'static str); 5] {
    let least = with(&json!({
        "meshes": [{"path": "../part.obj", "material": {}}],
        "lights": [{"type": "RectLight"}],
        "camera": {"eye": [1, 2, 3], "target": [0, 0, 0], "fov_y_deg": 40, "size": [64, 48]}
    }));
    let of = |name: &str| &schema["$defs"][name];
    [
        (schema, with(&json!({})), ""),
        (of("mesh"), least.clone(), "/meshes/0"),
        (of("material"), least.clone(), "/meshes/0/material"),
        (of("light"), least.clone(), "/lights/0"),
        (of("camera"), least, "/camera"),
    ]
}

#[test]
fn the_schema_names_the_fields_that_the_parser_takes() {
    let schema: Value = serde_json::from_str(SCHEMA).unwrap();
    for (object, least, place) in objects(&schema) {
        assert_eq!(object["additionalProperties"], json!(false), "{place}");
        let mut unknown = least.clone();
        unknown.pointer_mut(place).unwrap()["unheard"] = json!(0);
        let reason = refusal(&unknown);
        let mut parsed: Vec<&str> = reason.split('`').skip(3).step_by(2).collect();
        let mut named: Vec<&str> = object["properties"].as_object().unwrap().keys().map(String::as_str).collect();
        parsed.sort_unstable();
        named.sort_unstable();
        assert_eq!(parsed, named, "{place}: {reason}");
    }
}

#[test]
fn the_schema_requires_what_the_parser_requires() {
    let schema: Value = serde_json::from_str(SCHEMA).unwrap();
    for (object, least, place) in objects(&schema) {
        assert!(read(&least.to_string()).is_ok());
        let required: Vec<&str> =
            object["required"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
        for field in object["properties"].as_object().unwrap().keys() {
            let mut without = least.clone();
            without.pointer_mut(place).unwrap().as_object_mut().unwrap().remove(field);
            let is_refused = read(&without.to_string()).is_err();
            assert_eq!(is_refused, required.contains(&field.as_str()), "{place}/{field}");
        }
    }
}

/// Values that fit what the schema says of a field, and some that do not.
fn samples(field: &Value, schema: &Value) -> (Vec<Value>, Vec<Value>) {
    if let Some(name) = field["$ref"].as_str() {
        return samples(schema.pointer(name.trim_start_matches('#')).unwrap(), schema);
    }
    if let Some(constant) = field.get("const") {
        return (vec![constant.clone()], vec![json!(2), json!("1")]);
    }
    if let Some(choices) = field["enum"].as_array() {
        return (choices.clone(), vec![json!("Other"), json!(1)]);
    }
    match field["type"].as_str().unwrap() {
        "string" => (vec![json!("../part.obj")], vec![json!(1), json!([])]),
        "integer" => (vec![json!(1)], [vec![json!("1"), json!(0.5)], outside(field)].concat()),
        "number" => (vec![json!(1), json!(0.5)], [vec![json!("1")], outside(field)].concat()),
        "array" if field.get("maxItems").is_some() => {
            let count = usize::try_from(field["maxItems"].as_u64().unwrap()).unwrap();
            let (items, wrong_items) = samples(&field["items"], schema);
            let good: Vec<_> = match count {
                4 => vec![json!([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])],
                _ => items.iter().map(|item| json!(vec![item; count])).collect(),
            };
            let spoilt = wrong_items.into_iter().map(|wrong| {
                let mut items = good[0].clone();
                items[0] = wrong;
                items
            });
            let lengths = [json!(vec![&items[0]; count - 1]), json!(vec![&items[0]; count + 1]), json!({})];
            let wrong = spoilt.chain(lengths).collect();
            (good, wrong)
        }
        "array" => (vec![json!([samples(&field["items"], schema).0[0]])], vec![json!(1), json!([1])]),
        "object" => {
            let required = field["required"].as_array().into_iter().flatten().filter_map(Value::as_str);
            let good = required.map(|name| (name.to_owned(), samples(&field["properties"][name], schema).0[0].clone()));
            (vec![Value::Object(good.collect())], vec![json!(1), json!({"unheard": 1})])
        }
        other => panic!("no samples of {other}"),
    }
}

/// Numbers beyond the bounds of a field.
fn outside(field: &Value) -> Vec<Value> {
    let below = field.get("minimum").map(|low| json!(low.as_f64().unwrap() - 1.0));
    let above = field.get("maximum").map(|high| json!(high.as_f64().unwrap() + 1.0));
    let at = [field.get("exclusiveMinimum"), field.get("exclusiveMaximum")].into_iter().flatten().cloned();
    below.into_iter().chain(above).chain(at).collect()
}

#[test]
fn the_schema_bounds_what_the_parser_bounds() {
    let schema: Value = serde_json::from_str(SCHEMA).unwrap();
    for (object, least, place) in objects(&schema) {
        for (name, field) in object["properties"].as_object().unwrap() {
            let (good, wrong) = samples(field, &schema);
            let read_with = |value: &Value| {
                let mut scene = least.clone();
                let owner = scene.pointer_mut(place).unwrap();
                owner[name.as_str()] = value.clone();
                // What depends on another field gets it.
                match name.as_str() {
                    "radius" => owner["type"] = json!("DiskLight"),
                    "angle" => owner["type"] = json!("DistantLight"),
                    "up" if place == "/lights/0" => owner["target"] = json!([1, 0, 0]),
                    "camera" | "target" => owner["eye"] = json!([5, 2, 3]),
                    _ => {}
                }
                if place == "/lights/0" || (place.is_empty() && name == "camera") {
                    owner.as_object_mut().unwrap().remove("eye");
                }
                if let Some(eye) = scene.pointer_mut("/camera/eye") {
                    *eye = if name == "eye" && place == "/camera" { value.clone() } else { json!([5, 2, 3]) };
                }
                read(&scene.to_string())
            };
            for value in good {
                assert!(read_with(&value).is_ok(), "{place}/{name}: {value} is refused: {:?}", read_with(&value));
            }
            for value in wrong {
                assert!(read_with(&value).is_err(), "{place}/{name}: {value} is taken");
            }
        }
    }
}
