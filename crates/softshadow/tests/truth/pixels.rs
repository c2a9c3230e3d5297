//! A pixel's receiver lies where the ray through its centre first meets the scene.

use softshadow::{Context, DeviceChoice, Options, Receivers, adapters, visibility};
use softshadow_scene::LocalScene;

use crate::common::{context, ray_traced, shipped};
use crate::shapes::{Point, Triangle, cross, dot, sub};

/// Rasterisers snap corners to a 256th of a pixel at the coarsest. An edge within twice that of the pixel's centre may be
/// decided either way, so a pixel passes with what any of the rays around its centre meets first.
const SNAP: f64 = 1.0 / 128.0;

/// Where a surface folds back behind its silhouette, snapping may leave the hindmost of two triangles: they lie this near to
/// each other within the snap, relative to their distance.
const FOLD: f64 = 1e-4;

const SIZE: [u32; 2] = [80, 60];

/// Distance at which a ray meets a triangle, in units of `direction`; infinite where it does not.
fn distance(t: &Triangle, eye: Point, direction: Point) -> f64 {
    let [a, b, c] = t.map(|p| sub(p, eye));
    let volumes = [dot(direction, cross(a, b)), dot(direction, cross(b, c)), dot(direction, cross(c, a))];
    let inside = volumes.iter().all(|v| *v >= 0.0) || volumes.iter().all(|v| *v <= 0.0);
    let normal = cross(sub(b, a), sub(c, a));
    let at = dot(normal, a) / dot(normal, direction);
    if inside && at > 0.0 { at } else { f64::INFINITY }
}

/// Pixels whose triangle is not the first along any ray within the snap of the pixel's centre, which is taken to lie `shift`
/// pixels from where it does.
fn misplaced(context: &Context, name: &str, shift: f64) -> (usize, usize) {
    let (scene, light, camera) = shipped(name, SIZE);
    let options = Options { receivers: true, ..Options::default() };
    let receivers = Receivers::Camera(camera);
    let seen = visibility(context, &scene, &[light], &receivers, &ray_traced(1), &options, &mut |_, _| true).unwrap();
    let local = LocalScene::new(&scene, None, 128 << 20);
    let triangles: Vec<Triangle> = local.triangles().map(|t| t.map(|p| p.map(f64::from))).collect();
    let view = camera.local(&local.frame);
    let eye = view.eye.to_array();
    let ids = seen.placed.unwrap().triangles;
    let wrong = |pixel: &usize| {
        let width = SIZE[0] as usize;
        let center = [pixel % width, pixel / width].map(|x| x as f64 + 0.5 + shift);
        let own = local.caller_ids.iter().position(|id| i64::from(*id) == ids[*pixel]);
        // The centre first: the others are asked only at edges.
        let offsets = (0..25).map(|i| [(i + 12) % 25 % 5, (i + 12) % 25 / 5].map(|k| f64::from(k - 2) * 0.5 * SNAP));
        !offsets.into_iter().any(|o| {
            let [x, y] = [center[0] + o[0], center[1] + o[1]];
            let direction = (view.corner + view.step_x * x + view.step_y * y).to_array();
            let first = triangles.iter().map(|t| distance(t, eye, direction)).fold(f64::INFINITY, f64::min);
            match own {
                Some(own) => distance(&triangles[own], eye, direction) <= first * (1.0 + FOLD) && first.is_finite(),
                None => first.is_infinite(),
            }
        })
    };
    ((0..ids.len()).filter(wrong).count(), ids.len())
}

#[test]
fn pixels_see_the_first_triangle_along_their_ray_on_every_adapter() {
    let mut faults = Vec::new();
    for adapter in adapters() {
        let context = Context::new(&DeviceChoice::Index(adapter.index)).unwrap();
        for name in ["hall", "toruses"] {
            let (wrong, all) = misplaced(&context, name, 0.0);
            println!("pixels of {name} on {}: {wrong} of {all} see another triangle", adapter.backend);
            faults.extend((wrong > 0).then(|| format!("{name} on {}: {wrong} of {all}", adapter.backend)));
        }
    }
    assert!(faults.is_empty(), "pixels see another triangle than the first: {faults:?}");
}

#[test]
fn pixels_an_eighth_aside_would_be_seen() {
    let (wrong, all) = misplaced(context(), "hall", 0.125);
    println!("pixels of hall, as if their centres lay an eighth of a pixel aside: {wrong} of {all}");
    assert!(wrong * 50 > all);
}
