//! Layers over the reference point, and folds of edges.

use softshadow_native::{NativeEngine, NativeSettings, Vectors};
use softshadow_scene::{Light, LightShape, Material, Mesh, Points, SampleSpread, Scene, look_at};
use softshadow_techniques::depth_complexity::Coverage;
use softshadow_techniques::{Attenuation, DepthComplexity, Technique};

use crate::harness::{Call, Same, Source, Spoilt, shipped};

fn edges(settings: DepthComplexity) -> Technique {
    Technique::DepthComplexity(settings)
}

fn samples(samples: u32) -> DepthComplexity {
    DepthComplexity { samples, ..DepthComplexity::default() }
}

/// The passes whose twins are judged here.
fn chosen(pass: &str) -> bool {
    pass == "count reference depth" || pass.starts_with("fold edges")
}

/// How far areas may be apart. Now and then, for one receiver of a thousand, an edge's area differs by one unit of its fixed point, 2.4e-7
/// of the light's frame; which operation the driver rounds otherwise is not known.
const AREA_UNIT: f32 = 1e-6;

/// Lists are read alone here, and the device fills them in another order, with another number of chunks, each time.
fn bits(label: &str) -> Same {
    match label {
        "edge lists" | "first faces" => Same::Apart("read alone, and in another order each time"),
        "running counts" => Same::Sorted(|words| vec![[&words[..1], &words[2..]].concat()]),
        "visible areas" => Same::Within(AREA_UNIT),
        _ => Same::Bits,
    }
}

/// The driver's arc tangent is a polynomial, right to some 1e-5 of a radian.
fn of_discs(label: &str) -> Same {
    if label == "visible areas" { Same::Within(1e-4) } else { bits(label) }
}

fn call(name: &str, size: [u32; 2], settings: DepthComplexity) -> Call {
    let (scene, light, camera) = shipped(name, size);
    Call::new(edges(settings), &scene, vec![light], camera)
}

/// A scene under a light of another shape, from above.
fn under(name: &str, shape: LightShape, settings: DepthComplexity) -> Call {
    let mut call = call(name, [48, 40], settings);
    let pose = look_at([0.7, 3.0, 0.4], [0.0, 0.0, 0.0], None).unwrap();
    call.lights = vec![Light::new(shape, pose).unwrap()];
    call
}

#[test]
fn shipped_scenes_fold_alike() {
    for name in ["fork", "hall", "toruses", "cards"] {
        call(name, [61, 47], samples(64)).compare_alone(chosen, of_discs);
    }
}

#[test]
fn any_number_of_samples_folds_alike() {
    for count in [1, 31, 33, 64, 65, 256] {
        call("fork", [48, 48], samples(count)).compare_alone(chosen, bits);
        let settings = DepthComplexity { exact_area: false, ..samples(count) };
        call("toruses", [40, 40], settings).compare_alone(chosen, bits);
    }
}

/// A polygon that is no rectangle, and one that is not convex.
fn polygons() -> [LightShape; 2] {
    let convex = vec![[-0.5, -0.4], [0.5, -0.5], [0.7, 0.1], [0.1, 0.6], [-0.6, 0.2]];
    let concave = vec![[-0.6, -0.6], [0.6, -0.6], [0.6, 0.6], [0.1, -0.2], [-0.6, 0.5]];
    [convex, concave].map(|outline| LightShape::Polygon { outline })
}

#[test]
fn any_light_folds_alike() {
    let [convex, concave] = polygons();
    let shapes = [
        LightShape::Rectangle { width: 0.8, height: 0.5 },
        LightShape::Disc { radius: 0.5 },
        convex,
        concave,
        LightShape::Sphere { radius: 0.4 },
        LightShape::Sphere { radius: 1.6 },
        LightShape::Sun { angular_diameter: 0.0093 },
        LightShape::Sun { angular_diameter: 0.4 },
    ];
    for shape in shapes {
        for name in ["fork", "toruses"] {
            under(name, shape.clone(), samples(64)).compare_alone(chosen, of_discs);
        }
        under("fork", shape, DepthComplexity { exact_area: false, ..samples(40) }).compare_alone(chosen, of_discs);
    }
}

#[test]
fn own_samples_fold_alike() {
    for spread in [SampleSpread::Decorrelated, SampleSpread::Interleaved] {
        for (count, exact_area) in [(64, true), (33, true), (9, false), (128, false)] {
            let settings = DepthComplexity { spread, exact_area, tile: 4, ..samples(count) };
            call("toruses", [40, 44], settings.clone()).compare_alone(chosen, bits);
            under("fork", LightShape::Sphere { radius: 0.5 }, settings).compare_alone(chosen, bits);
        }
    }
}

#[test]
fn published_tables_fold_alike() {
    let settings = DepthComplexity { coverage: Coverage::Table, ..samples(64) };
    for name in ["fork", "hall", "cards"] {
        call(name, [56, 40], settings.clone()).compare_alone(chosen, of_discs);
    }
}

/// Points where a scene's vertices are, between them, and in the planes of its faces; with a normal or without.
fn on_the_surface(scene: &Scene, with_normals: bool) -> Points {
    let mut at = Vec::new();
    for mesh in scene.meshes() {
        for triangle in mesh.triangles.iter().take(400) {
            let [a, b, c] = triangle.map(|v| mesh.vertices[v as usize]);
            let mix = |x: f64, y: f64, z: f64| std::array::from_fn(|k| x * a[k] + y * b[k] + z * c[k]);
            at.extend([a, mix(0.5, 0.5, 0.0), mix(0.25, 0.25, 0.5), mix(2.0, -1.0, 0.0), mix(1.0, 1.0, -1.0)]);
        }
    }
    let normals = with_normals.then(|| (0..at.len()).map(|k| [[0.0, 1.0, 0.0], [0.6, 0.0, 0.8]][k % 2]).collect());
    Points::new(at, normals).unwrap()
}

#[test]
fn receivers_on_edges_and_in_planes_fold_alike() {
    for name in ["fork", "cards", "toruses"] {
        for (with_normals, shape) in
            [(true, LightShape::Rectangle { width: 1.0, height: 1.0 }), (false, LightShape::Sphere { radius: 0.5 })]
        {
            let (scene, ..) = shipped(name, [8, 8]);
            let mut call = under(name, shape, samples(64));
            call.receivers = Source::Points(on_the_surface(&scene, with_normals));
            call.compare_alone(chosen, bits);
        }
    }
}

/// Cubes on a lattice under a light whose corners, and whose samples' directions, meet theirs.
fn lattice() -> (Scene, Points) {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    let sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
    for place in 0..9u32 {
        let (first, x, z) =
            (vertices.len() as u32, f64::from(place % 3) * 0.5 - 0.75, f64::from(place / 3) * 0.5 - 0.75);
        let corner =
            |k: u32| [x + f64::from(k >> 2) * 0.25, 0.5 + f64::from(k >> 1 & 1) * 0.25, z + f64::from(k & 1) * 0.25];
        vertices.extend((0..8).map(corner));
        for [a, b, c, d] in sides {
            triangles.extend([[a, b, c], [a, c, d]].map(|t: [u32; 3]| t.map(|v| v + first)));
        }
    }
    let at =
        |k: u32| [f64::from(k % 25) * 0.125 - 1.5, f64::from(k / 625) * 0.25, f64::from(k / 25 % 25) * 0.125 - 1.5];
    let mesh = Mesh::new("cubes", vertices, triangles, Material::default()).unwrap();
    (Scene::new(vec![mesh]).unwrap(), Points::new((0..1875).map(at).collect(), None).unwrap())
}

#[test]
fn ties_fold_alike() {
    for shape in [LightShape::Rectangle { width: 1.0, height: 1.0 }, LightShape::Sun { angular_diameter: 0.5 }] {
        let (scene, points) = lattice();
        let pose = look_at([0.0, 2.0, 0.0], [0.0, 0.0, 0.0], Some([0.0, 0.0, 1.0])).unwrap();
        let lights = vec![Light::new(shape, pose).unwrap()];
        let call = Call::new(edges(samples(64)), &scene, lights, Source::Points(points));
        call.compare_alone(chosen, bits);
    }
}

/// A shipped scene whose every other triangle lets something through.
fn semi_opaque(name: &str, size: [u32; 2], settings: DepthComplexity, lights: Option<Vec<Light>>) -> Call {
    let (scene, light, camera) = shipped(name, size);
    let mesh = |mesh: &Mesh| {
        let opacities = (0..mesh.triangles.len()).map(|k| [1.0, 0.5, 0.9, 0.03][k % 4]).collect();
        mesh.clone().with_opacities(opacities).unwrap()
    };
    let scene = Scene::new(scene.meshes().iter().map(mesh).collect()).unwrap();
    Call::new(edges(settings), &scene, lights.unwrap_or_else(|| vec![light]), camera)
}

/// The driver's powers of two are a polynomial's.
fn of_powers(label: &str) -> Same {
    if label == "sample transmittance" { Same::Within(2e-6) } else { bits(label) }
}

/// Not the toruses: where every edge lies between two opacities, the driver's steps end for some of their receivers.
#[test]
fn semi_opaque_layers_fold_alike() {
    let sphere = || {
        let pose = look_at([0.7, 3.0, 0.4], [0.0, 0.0, 0.0], None).unwrap();
        vec![Light::new(LightShape::Sphere { radius: 0.4 }, pose).unwrap()]
    };
    for attenuation in [Attenuation::Logarithmic, Attenuation::Sum] {
        for name in ["fork", "hall"] {
            let settings = DepthComplexity { attenuation, ..samples(70) };
            semi_opaque(name, [40, 36], settings, None).compare_alone(chosen, of_powers);
        }
        let settings = DepthComplexity { attenuation, spread: SampleSpread::Decorrelated, ..samples(33) };
        semi_opaque("fork", [40, 36], settings.clone(), None).compare_alone(chosen, of_powers);
        semi_opaque("hall", [40, 36], settings, Some(sphere())).compare_alone(chosen, of_powers);
    }
}

#[test]
fn neither_threads_nor_vectors_change_a_bit() {
    let one = NativeEngine::new(NativeSettings { threads: Some(1), vectors: Vectors::Baseline });
    let three = NativeEngine::new(NativeSettings { threads: Some(3), vectors: Vectors::Widest });
    for native in [one, three] {
        let found = call("fork", [80, 64], samples(64)).difference_alone(&native, chosen, &bits);
        assert_eq!(found, None);
        let sphere = under("toruses", LightShape::Sphere { radius: 0.5 }, samples(64));
        assert_eq!(sphere.difference_alone(&native, chosen, &bits), None);
    }
}

#[test]
fn a_spoilt_fold_is_noticed() {
    let native = NativeEngine::new(NativeSettings::default());
    let same = |label: &str| if label == "visible areas" { Same::Bits } else { bits(label) };
    for label in ["blocked samples", "visible areas", "slots"] {
        let call = call("fork", [32, 32], samples(64));
        let spoilt = Spoilt { engine: &native, label };
        let words = call.difference_alone(&spoilt, chosen, &same).expect("a difference");
        assert!(words.contains(&format!("alone: '{label}', word 0")), "{words}");
    }
}
