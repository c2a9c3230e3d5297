//! Scenes that move and lights that do: the result is that of a scene made anew, and only what has to be is made.

use std::time::Instant;

use softshadow::{
    Context, DeviceChoice, Light, LightShape, Options, Preparation, Receivers, Scene, Technique, Visibility, look_at,
    procedural, visibility,
};

use crate::agreement::Truth;
use crate::common::{bits, depth_complexity, lamp, points, ray_traced, rays, rectangle, see, shipped, surface_points};
use crate::shapes::{Point, cuboid, plate, scene};

/// A device of its own, so that no other test fills its caches.
fn own_context() -> Context {
    Context::new(&DeviceChoice::Auto).unwrap()
}

fn look(context: &Context, scene: &Scene, lights: &[Light], receivers: &Receivers, by: &Technique) -> Visibility {
    let options = Options { standard_error: true, receivers: true, sample_masks: true, ..Options::default() };
    visibility(context, scene, lights, receivers, by, &options, &mut |_, _| true).unwrap()
}

/// Scene builds, scene refits, occluder builds, occluder refits.
fn made(seen: &Visibility) -> [usize; 4] {
    let Preparation { scene_builds, scene_refits, occluder_builds, occluder_refits, .. } = seen.info.preparation;
    [scene_builds, scene_refits, occluder_builds, occluder_refits]
}

fn anew(scene: &Scene) -> Scene {
    Scene::new(scene.meshes().to_vec()).unwrap()
}

/// Samples that differ between two calls with the same receivers.
fn differing(a: &Visibility, b: &Visibility) -> u32 {
    let words = |v: &Visibility| v.masks.as_ref().unwrap().bits.clone();
    words(a).iter().zip(words(b)).map(|(a, b)| (a ^ b).count_ones()).sum()
}

#[test]
fn every_frame_has_the_rays_of_a_scene_made_anew() {
    let (still, light, camera) = shipped("toruses", [64, 48]);
    let receivers = Receivers::Camera(camera);
    let context = own_context();
    let (settings, mut last) = (rays(64), None);
    let technique = Technique::RayTraced(settings.clone());
    look(&context, &still, std::slice::from_ref(&light), &receivers, &technique);
    for frame in 1..5 {
        let now = procedural::waving(&still, f64::from(frame) / 5.0).unwrap();
        let seen = look(&context, &now, std::slice::from_ref(&light), &receivers, &technique);
        assert_eq!(made(&seen), [0, 1, 0, 0], "{:?}", seen.info.preparation);
        let fresh = see(&anew(&now), std::slice::from_ref(&light), &receivers, &technique);
        assert_eq!(bits(&seen), bits(&fresh), "frame {frame}");
        assert_eq!(seen.placed.as_ref().unwrap().triangles, fresh.placed.as_ref().unwrap().triangles);
        let found = Truth::of(&now).compare(&now, &light, &settings, &seen);
        println!("moving, frame {frame} by rays: {found:?}");
        assert!(found.differing == 0 && found.hidden > 10_000, "{found:?}");
        let stale = Truth::of(last.as_ref().unwrap_or(&still)).compare(&now, &light, &settings, &seen);
        assert!(stale.differing > 1000, "another frame's truth is refused: {stale:?}");
        last = Some(now);
    }
}

#[test]
fn every_frame_has_the_edges_of_a_scene_made_anew() {
    let (still, light, camera) = shipped("toruses", [64, 48]);
    let lights = [light, Light::sun(70.0, 40.0, 3.0, softshadow::UpAxis::Y).unwrap()];
    let receivers = Receivers::Camera(camera);
    let context = own_context();
    let technique = depth_complexity(64);
    let first = look(&context, &still, &lights, &receivers, &technique);
    assert_eq!(made(&first), [1, 0, 1, 0], "one set of occluders serves both lights");
    for frame in 1..5 {
        let now = procedural::waving(&still, f64::from(frame) / 5.0).unwrap();
        let seen = look(&context, &now, &lights, &receivers, &technique);
        assert_eq!(made(&seen), [0, 1, 0, 1], "{:?}", seen.info.preparation);
        assert!(seen.info.preparation.rebuild_reasons.is_empty());
        let fresh = see(&anew(&now), &lights, &receivers, &technique);
        assert_eq!(differing(&seen, &fresh), 0, "frame {frame}");
        let traced = see(&now, &lights, &receivers, &ray_traced(64));
        let off = f64::from(differing(&seen, &traced)) / (seen.masks.as_ref().unwrap().bits.len() as f64 * 32.0);
        println!("moving, frame {frame} by edges: {:.5} % of the samples are not those of rays", 100.0 * off);
        assert!(off < 2e-4, "{off}");
    }
    assert_eq!(made(&look(&context, &still, &lights, &receivers, &technique)), [0, 1, 0, 1], "back again");
}

/// A floor of 2 × 2, a box on it, and a lid above.
fn box_under_a_lid() -> Scene {
    let mut triangles = plate([-1.0, 1.0], [-1.0, 1.0], 0.0);
    triangles.extend(cuboid([-0.3, -0.3, 0.2], [0.3, 0.3, 0.5]));
    triangles.extend(plate([-1.0, 1.0], [-1.0, 1.0], 3.0));
    scene(&triangles)
}

fn floor() -> Receivers {
    let positions: Vec<Point> =
        (0..400).map(|i| [f64::from(i % 20) / 10.0 - 0.95, f64::from(i / 20) / 10.0 - 0.95, 0.0]).collect();
    surface_points(positions, [0.0, 0.0, 1.0])
}

#[test]
fn lights_move_freely_before_the_same_triangles() {
    let (scene, receivers, technique) = (box_under_a_lid(), floor(), depth_complexity(64));
    let context = own_context();
    let at = |shape: LightShape, place: Point, target: Point| {
        let light = Light::new(shape, look_at(place, target, Some([0.0, 1.0, 0.0])).unwrap()).unwrap();
        let seen = look(&context, &scene, std::slice::from_ref(&light), &receivers, &technique);
        let fresh = see(&anew(&scene), &[light], &receivers, &technique);
        assert_eq!(differing(&seen, &fresh), 0, "{place:?}");
        (made(&seen), seen.info.preparation.rebuild_reasons)
    };
    let nothing = ([0; 4], vec![]);
    let plane = vec!["occluders: a light's plane cuts triangles, or leaves out others than before".to_owned()];
    let (flat, disc, ball) =
        (rectangle(0.4, 0.4), LightShape::Disc { radius: 0.2 }, LightShape::Sphere { radius: 0.2 });
    // Under the lid, which is behind the light wherever it is.
    assert_eq!(at(flat.clone(), [0.0, 0.0, 1.0], [0.0; 3]), ([1, 0, 1, 0], vec![]));
    for height in [0.8, 1.3, 2.0] {
        assert_eq!(at(flat.clone(), [0.3, 0.1, height], [0.3, 0.1, 0.0]), nothing);
    }
    assert_eq!(at(disc.clone(), [-0.2, 0.0, 1.5], [-0.25, 0.0, 0.0]), nothing);
    // Above the lid, everything is in front; a sun and a ball that touches nothing see the same.
    assert_eq!(at(flat.clone(), [0.0, 0.0, 4.0], [0.0; 3]), ([0, 0, 1, 0], plane.clone()));
    for place in [[0.5, 0.0, 5.0], [-0.5, 0.3, 4.5]] {
        assert_eq!(at(flat.clone(), place, [0.0; 3]), nothing);
        assert_eq!(at(ball.clone(), place, [0.0; 3]), nothing);
    }
    for place in [[0.0, 0.0, 1.0], [0.6, 0.2, 2.0]] {
        assert_eq!(at(ball.clone(), place, [0.0; 3]), nothing, "between the triangles");
    }
    assert_eq!(at(LightShape::Sun { angular_diameter: 0.1 }, [0.1, 0.0, 1.0], [0.0; 3]), nothing);
    // A plane that cuts the box: every place is another scene.
    for x in [0.0, 0.1] {
        assert_eq!(at(flat.clone(), [x, 0.0, 0.7], [x + 1.0, 0.0, 0.3]), ([0, 0, 1, 0], plane.clone()));
    }
    assert_eq!(at(flat, [0.0, 0.0, 1.2], [0.0; 3]), nothing, "what was made first is still there");
}

#[test]
fn what_cannot_be_refitted_is_made_anew_and_said() {
    let (receivers, technique) = (floor(), depth_complexity(64));
    let light = lamp(rectangle(0.4, 0.4), [0.1, 0.2, 2.0]);
    let context = own_context();
    let still = box_under_a_lid();
    let frame = |place: &dyn Fn(usize, Point) -> Point| {
        let place = |(i, v): (usize, &Point)| place(i, *v);
        let vertices = still.meshes()[0].vertices.iter().enumerate().map(place).collect();
        still.with_vertices(vec![Some(vertices)]).unwrap()
    };
    let seen = |scene: &Scene| {
        let seen = look(&context, scene, std::slice::from_ref(&light), &receivers, &technique);
        let fresh = see(&anew(scene), std::slice::from_ref(&light), &receivers, &technique);
        assert_eq!(differing(&seen, &fresh), 0);
        assert!(seen.values.iter().all(|v| (0.0..=1.0).contains(v)));
        (made(&seen), seen.info.preparation.rebuild_reasons)
    };
    assert_eq!(seen(&still), ([1, 0, 1, 0], vec![]));
    let rise = |i: usize, [x, y, z]: Point| if (6..42).contains(&i) { [x, y, z + 0.1] } else { [x, y, z] };
    assert_eq!(seen(&frame(&rise)), ([0, 1, 0, 1], vec![]), "the box rises");
    let part = |i: usize, [x, y, z]: Point| if i == 8 { [x, y, z + 0.05] } else { [x, y, z] };
    let parted = vec!["occluders: vertices that lay in one place parted, or others met".to_owned()];
    assert_eq!(seen(&frame(&part)), ([0, 1, 1, 0], parted), "the soup's welded corners part");
    let fold = |i: usize, p: Point| if i == 8 { still.meshes()[0].vertices[6] } else { p };
    let areas = "scene: triangles lost or gained their area".to_owned();
    let order = "occluders: the order of the triangles is new".to_owned();
    assert_eq!(seen(&frame(&fold)), ([1, 0, 1, 0], vec![areas.clone(), order.clone()]), "a triangle is gone");
    assert_eq!(seen(&still), ([1, 0, 1, 0], vec![areas, order]), "and is back");
    let through = |i: usize, [x, y, z]: Point| if (6..42).contains(&i) { [x, y, 4.0 * z] } else { [x, y, z] };
    let cut = vec!["occluders: a light's plane cuts triangles, or leaves out others than before".to_owned()];
    // The lamp in the box sees its bottom only, and the floor is dark but for what it encloses.
    let pierced = frame(&|i, p| if i < 6 { p } else { through(i, [p[0], p[1], p[2] + 0.05]) });
    assert_eq!(seen(&pierced), ([0, 1, 1, 0], cut));
}

#[test]
fn an_empty_scene_may_be_moved() {
    let empty = Scene::new(Vec::new()).unwrap();
    let moved = empty.with_vertices(Vec::new()).unwrap();
    let light = lamp(rectangle(0.4, 0.4), [0.0, 0.0, 2.0]);
    for scene in [&empty, &moved] {
        let seen = see(scene, std::slice::from_ref(&light), &points(vec![[0.0; 3]]), &depth_complexity(64));
        assert_eq!(seen.values, [1.0]);
    }
}

/// The file of a public mesh, where there is one: it is measured, and never shipped.
fn bunny() -> Option<Scene> {
    let folder =
        std::env::var_os("SOFTSHADOW_MESHES").map_or_else(|| "../../../shared/meshes".into(), std::path::PathBuf::from);
    softshadow::scene_file::load(&folder.join("stanford-bunny.obj")).ok()
}

#[test]
fn a_refit_costs_less_than_a_build() {
    let scenes = [("toruses", Some(shipped("toruses", [8, 8]).0)), ("bunny", bunny())];
    for (name, still) in scenes {
        let Some(still) = still else {
            println!("moving: {name} is not here and was left out");
            continue;
        };
        let ([low, high], center) = {
            let (low, high) = still.bounds().unwrap();
            ([low, high], [0, 1, 2].map(|k| 0.5 * (low[k] + high[k])))
        };
        let size = high[1] - low[1];
        let pose = look_at([center[0] + 0.1 * size, high[1] + size, center[2]], center, None).unwrap();
        let light = Light::new(rectangle(0.5 * size, 0.5 * size), pose).unwrap();
        let receivers = points(vec![[center[0], low[1] - 0.1 * size, center[2]]]);
        let (moving, apart) = (own_context(), own_context());
        let technique = depth_complexity(64);
        let mut times = [Vec::new(), Vec::new(), Vec::new()];
        look(&moving, &still, std::slice::from_ref(&light), &receivers, &technique);
        for frame in 1..=10 {
            let started = Instant::now();
            let now = procedural::waving(&still, f64::from(frame) / 10.0).unwrap();
            times[2].push(started.elapsed().as_secs_f64() * 1e3);
            let seen = look(&moving, &now, std::slice::from_ref(&light), &receivers, &technique);
            assert_eq!(made(&seen), [0, 1, 0, 1], "{:?}", seen.info.preparation);
            times[0].push(seen.info.preparation.preparation_ms);
            let fresh = look(&apart, &anew(&now), std::slice::from_ref(&light), &receivers, &technique);
            assert_eq!(made(&fresh), [1, 0, 1, 0]);
            times[1].push(fresh.info.preparation.preparation_ms);
        }
        times.iter_mut().for_each(|t| t.sort_by(f64::total_cmp));
        let [refit, build, wave] = times.map(|t| t[t.len() / 2]);
        let triangles = still.triangle_count();
        println!(
            "moving, {name}, {triangles} triangles: refit {refit:.1} ms, build {build:.1} ms; a new frame {wave:.1} ms"
        );
        assert!(refit < build, "{name}: {refit} ms against {build} ms");
    }
}
