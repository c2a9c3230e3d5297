//! Bad input ends in a typed error that names what is wrong, and the context works on.

use softshadow::{
    Camera, Error, HardShadowMap, Light, LightShape, Material, Mesh, Options, Points, RayTraced, Receivers, Scene,
    SceneError, Technique, Visibility, compare, look_at, visibility,
};

use crate::common::{context, hard_shadow_map, lamp, points, pose_at, ray_traced, rays, rectangle, surface_points};
use crate::shapes::{plate, scene};

fn ask(scene: &Scene, lights: &[Light], receivers: &Receivers, technique: &Technique) -> Result<Visibility, Error> {
    visibility(context(), scene, lights, receivers, technique, &Options::default(), &mut |_, _| true)
}

fn shade() -> Scene {
    scene(&plate([-0.5, 0.0], [-0.5, 0.5], 1.0))
}

fn light() -> Light {
    lamp(rectangle(0.1, 0.1), [0.0, 0.0, 2.0])
}

/// One point under the plate and one beside it: what the shared context must answer after every error.
fn works() {
    for technique in [ray_traced(8), hard_shadow_map(64)] {
        let seen = ask(&shade(), &[light()], &points(vec![[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]]), &technique);
        assert_eq!(seen.unwrap().values, [0.0, 1.0], "{}", technique.name());
    }
}

fn refused(outcome: Result<Visibility, Error>) -> Error {
    let error = outcome.err().unwrap();
    works();
    error
}

#[test]
fn vertices_that_are_no_numbers_are_named() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let vertices = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, bad, 0.0], [0.0, 0.0, bad]];
        let error = Mesh::new("roof", vertices, vec![[0, 1, 2]], Material::default()).unwrap_err();
        assert!(matches!(&error, SceneError::NotFinite { what, index: 2 } if what.contains("roof")), "{error}");
    }
    // Finite in float64, and beside a small mesh nothing in float32.
    let huge = [[0.0; 3], [1e300, 0.0, 0.0], [0.0, 1e300, 0.0]];
    assert!(
        ask(&scene(&[huge]), &[light()], &points(vec![[0.0; 3]]), &ray_traced(4))
            .is_ok_and(|v| v.values[0].is_finite())
    );
    let overflow = [[-1.7e308; 3], [1.7e308, 0.0, 0.0], [0.0, 1.7e308, 0.0]];
    let outcome = ask(&scene(&[overflow]), &[light()], &points(vec![[0.0; 3]]), &ray_traced(4));
    match outcome {
        Ok(seen) => assert!(seen.values[0] == 0.0 || seen.values[0] == 1.0),
        Err(error) => assert!(matches!(error, Error::Scene(SceneError::NotFinite { .. })), "{error:?}"),
    }
    works();
}

#[test]
fn indices_out_of_range_are_named() {
    let error = Mesh::new("roof", vec![[0.0; 3]; 3], vec![[0, 1, 2], [0, 3, 2]], Material::default()).unwrap_err();
    let expected = SceneError::IndexOutOfRange { mesh: "roof".into(), triangle: 1, vertex: 3, vertices: 3 };
    assert_eq!(error, expected);
}

#[test]
fn an_empty_scene_shades_nothing() {
    let empty_mesh = Mesh::new("nothing", Vec::new(), Vec::new(), Material::default()).unwrap();
    let unused = Mesh::new("unused", vec![[0.0; 3], [1.0; 3]], Vec::new(), Material::default()).unwrap();
    let camera = Camera::look_at([0.0, 0.0, 3.0], [0.0; 3], None, 40.0, [8, 6]).unwrap();
    for meshes in [Vec::new(), vec![empty_mesh], vec![unused]] {
        let empty = Scene::new(meshes).unwrap();
        for technique in [ray_traced(8), hard_shadow_map(64)] {
            // In front of the light, behind it, and turned away from it.
            let free = ask(&empty, &[light()], &points(vec![[0.0; 3], [0.0, 0.0, 3.0]]), &technique).unwrap();
            assert_eq!(free.values, [1.0, 0.0], "{}", technique.name());
            let turned = surface_points(vec![[0.0; 3]], [0.0, 0.0, -1.0]);
            assert_eq!(ask(&empty, &[light()], &turned, &technique).unwrap().values, [0.0]);
            let image = ask(&empty, &[light()], &Receivers::Camera(camera), &technique).unwrap();
            assert!(image.values.len() == 48 && image.values.iter().all(|v| v.is_nan()));
            assert!(image.valid.iter().all(|v| !v) && image.info.valid_receivers == Some(0));
        }
    }
    // Nor are zero receivers an error.
    let none = ask(&shade(), &[light()], &points(Vec::new()), &ray_traced(8)).unwrap();
    assert!(none.values.is_empty() && none.receivers == 0);
    works();
}

#[test]
fn triangles_without_area_are_left_out_and_counted() {
    let mut triangles = plate([-0.5, 0.0], [-0.5, 0.5], 1.0);
    let flat = [[[0.1, 0.2, 0.3]; 3], [[0.0; 3], [0.5, 0.25, 0.0], [1.0, 0.5, 0.0]]];
    triangles.extend(flat);
    let receivers = points(vec![[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]]);
    for technique in [ray_traced(8), hard_shadow_map(64)] {
        let seen = ask(&scene(&triangles), &[light()], &receivers, &technique).unwrap();
        assert_eq!(seen.values, [0.0, 1.0]);
        assert_eq!(seen.info.zero_area_triangles, 2);
        assert_eq!(ask(&shade(), &[light()], &receivers, &technique).unwrap().info.zero_area_triangles, 0);
    }
    // Nothing but flat triangles is an empty scene.
    assert_eq!(ask(&scene(&flat), &[light()], &receivers, &ray_traced(8)).unwrap().values, [1.0, 1.0]);
    works();
}

#[test]
fn lights_that_cannot_be_are_named() {
    let named = |shape| Light::new(shape, pose_at([0.0; 3])).unwrap_err().to_string();
    assert!(named(LightShape::Rectangle { width: f64::NAN, height: 1.0 }).contains("light width"));
    assert!(named(LightShape::Sphere { radius: -1.0 }).contains("light radius"));
    assert!(named(LightShape::Sun { angular_diameter: 4.0 }).contains("180 degrees"));
    let mut scaled = pose_at([0.0; 3]);
    scaled[0][0] = 2.0;
    assert!(Light::new(rectangle(1.0, 1.0), scaled).unwrap_err().to_string().contains("world_from_light"));
    let error = refused(ask(&shade(), &[], &points(vec![[0.0; 3]]), &ray_traced(8)));
    assert!(matches!(&error, Error::Settings(words) if words.contains("light")), "{error:?}");
    // A finite pose that is too far from the scene for float32.
    let far = lamp(rectangle(1.0, 1.0), [0.0, 0.0, 1e60]);
    for technique in [ray_traced(8), hard_shadow_map(64)] {
        let outcome = ask(&shade(), std::slice::from_ref(&far), &points(vec![[0.5, 0.0, 0.0]]), &technique);
        println!("light at 1e60, {}: {:?}", technique.name(), outcome.as_ref().map(|v| &v.values));
        assert!(outcome.map_or(true, |v| v.values == [1.0]), "{}: no number made of infinities", technique.name());
        works();
    }
}

#[test]
fn cameras_that_cannot_be_are_named() {
    let error = Camera::look_at([1.0; 3], [1.0; 3], None, 40.0, [8, 8]).unwrap_err().to_string();
    assert!(error.contains("camera") && error.contains("same point"), "{error}");
    assert!(look_at([f64::NAN; 3], [0.0; 3], None).is_err());
    assert!(Camera::look_at([1.0; 3], [0.0; 3], None, f64::NAN, [8, 8]).is_err());
    // A camera without a view of anything sees background only.
    let away = Camera::look_at([0.0, 0.0, 5.0], [0.0, 0.0, 9.0], None, 40.0, [8, 8]).unwrap();
    let seen = ask(&shade(), &[light()], &Receivers::Camera(away), &ray_traced(8)).unwrap();
    assert!(seen.values.iter().all(|v| v.is_nan()));
    works();
}

#[test]
fn an_image_beyond_the_limits_is_refused_before_anything_is_allocated() {
    let limit = context().adapter().texture_size;
    for size in [[limit + 1, 2], [2, limit + 1], [u32::MAX, u32::MAX]] {
        let camera = Receivers::Camera(Camera::look_at([0.0, 0.0, 3.0], [0.0; 3], None, 40.0, size).unwrap());
        let error = refused(ask(&shade(), &[light()], &camera, &ray_traced(8)));
        let needed = u64::from(size[0].max(size[1]));
        assert!(
            matches!(&error, Error::TooLarge { needed: n, limit: l, .. } if (*n, *l) == (needed, u64::from(limit))),
            "{size:?}: {error:?}"
        );
    }
    let longest = Receivers::Camera(Camera::look_at([0.0, 0.0, 3.0], [0.0; 3], None, 40.0, [limit, 1]).unwrap());
    assert!(ask(&shade(), &[light()], &longest, &ray_traced(1)).is_ok(), "the limit itself is possible");
}

#[test]
fn settings_out_of_range_are_named() {
    let traced = |settings| Technique::RayTraced(settings);
    for (technique, setting) in [
        (traced(rays(0)), "samples"),
        (traced(rays(65_537)), "samples"),
        (traced(RayTraced { passes: 0, ..rays(8) }), "passes"),
        (traced(RayTraced { probes: 8, ..rays(8) }), "probes"),
        (Technique::HardShadowMap(HardShadowMap { resolution: 15 }), "resolution"),
        (Technique::HardShadowMap(HardShadowMap { resolution: 16_385 }), "resolution"),
    ] {
        let error = refused(ask(&shade(), &[light()], &points(vec![[0.0; 3]]), &technique));
        let words = error.to_string();
        assert!(matches!(&error, Error::Settings(_)), "{error:?}");
        assert!(words.contains(setting) && words.contains(technique.name()), "{words}");
    }
    let receivers = points(vec![[0.0; 3]]);
    let none = compare(context(), &shade(), &light(), &receivers, &[], &ray_traced(8), 0, &mut |_, _| true);
    assert!(matches!(none, Err(Error::Settings(words)) if words.contains("repeats")));
    works();
}

#[test]
fn receivers_that_cannot_be_are_named() {
    let nan = Points::new(vec![[0.0; 3], [0.0, f64::NAN, 0.0]], None).unwrap_err();
    assert_eq!(nan, SceneError::NotFinite { what: "points".into(), index: 1 });
    let zero = Points::new(vec![[0.0; 3]; 2], Some(vec![[1.0, 0.0, 0.0], [0.0; 3]])).unwrap_err();
    assert!(zero.to_string().contains("normals: entry 1"), "{zero}");
    let fewer = Points::new(vec![[0.0; 3]; 2], Some(vec![[1.0, 0.0, 0.0]])).unwrap_err();
    assert!(fewer.to_string().contains("1 normals for 2 points"), "{fewer}");
    // In every block, not only in the first, and with the caller's index.
    let mut positions = vec![[0.5, 0.0, 0.0]; 5000];
    positions[4321][0] = 1e60;
    for technique in [ray_traced(8), hard_shadow_map(64)] {
        for memory_limit_bytes in [1 << 30, 100_000] {
            let options = Options { memory_limit_bytes, ..Options::default() };
            let receivers = points(positions.clone());
            let outcome =
                visibility(context(), &shade(), &[light()], &receivers, &technique, &options, &mut |_, _| true);
            let error = refused(outcome);
            assert!(
                matches!(&error, Error::Scene(SceneError::NotFinite { what, index: 4321 }) if what.contains("points")),
                "{}, {memory_limit_bytes}: {error:?}",
                technique.name()
            );
        }
    }
}

#[test]
fn lights_out_of_proportion_are_refused_before_float32_makes_them_infinite() {
    for (shape, height, words) in [
        (rectangle(1e154, 1.0), 2.0, "light: its size"),
        (LightShape::Disc { radius: 1e20 }, 2.0, "light: its size"),
        (LightShape::Sphere { radius: 1.0 }, 1e30, "use a sun"),
    ] {
        let lights = [light(), lamp(shape, [0.0, 0.0, height])];
        let outcome = ask(&shade(), &lights, &points(vec![[0.5, 0.0, 0.0]]), &ray_traced(8));
        let error = refused(outcome).to_string();
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn results_without_room_are_refused_before_anything_is_computed() {
    let camera = Camera::look_at([0.0, 0.0, 9.0], [0.0; 3], None, 40.0, [8192, 8192]).unwrap();
    let options = Options { sample_masks: true, ..Options::default() };
    let (shade, receivers) = (shade(), Receivers::Camera(camera));
    let outcome = visibility(context(), &shade, &[light()], &receivers, &ray_traced(32768), &options, &mut |_, _| {
        panic!("begun")
    });
    let error = refused(outcome);
    assert!(
        matches!(&error, Error::TooLarge { what, needed, .. } if what == "bytes of results" && *needed > 1 << 41),
        "{error}"
    );
}
