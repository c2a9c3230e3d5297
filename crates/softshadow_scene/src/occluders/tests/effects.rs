//! What a boundary does, found by the hierarchy, against every triangle asked one by one.

use super::*;
use crate::local::LocalScene;
use crate::mesh::{Material, Mesh};
use crate::scene::Scene;

fn scene(triangles: &[Triangle]) -> LocalScene {
    let vertices = triangles.as_flattened().iter().map(|c| c.map(f64::from)).collect();
    let indices = (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let mesh = Mesh::new("soup", vertices, indices, Material::default()).unwrap();
    LocalScene::new(&Scene::new(vec![mesh]).unwrap(), None, 1 << 20)
}

/// Small triangles spread over the cube.
fn crumbs(random: &mut Random, count: usize) -> Vec<Triangle> {
    let crumb = |random: &mut Random| {
        let center = random.position();
        [0; 3].map(|_: i32| {
            let way = random.position();
            [0, 1, 2].map(|k| center[k] + 0.02 * way[k])
        })
    };
    (0..count).map(|_| crumb(random)).collect()
}

/// The effect as the occluders themselves show it.
fn shown(local: &LocalScene, boundary: LightBoundary) -> BoundaryEffect {
    let triangles: Vec<Triangle> = local.triangles().collect();
    let occluders = Occluders::new(&triangles, |_| 1.0, &boundary).unwrap();
    if occluders.cut > 0 || !occluders.touching.is_empty() {
        return BoundaryEffect { boundary, behind: Vec::new() };
    }
    let has_face = |t: &u32| occluders.faces.iter().any(|face| face.triangle == *t);
    let behind: Vec<u32> = (0..triangles.len() as u32).filter(|t| !has_face(t)).collect();
    assert_eq!(behind.len(), occluders.behind);
    BoundaryEffect { boundary: LightBoundary::None, behind }
}

#[test]
fn the_hierarchy_finds_the_effect_of_every_triangle() {
    let mut random = Random(11);
    let mut met = [0; 3];
    for round in 0..400 {
        let local = scene(&crumbs(&mut random, 3 + round % 40));
        let point = random.position().map(f64::from);
        let boundary = match round % 2 {
            0 => LightBoundary::Plane { point, normal: random.unit() },
            _ => LightBoundary::Ball { center: point, radius: 0.3 * f64::from(random.next()).abs() },
        };
        let effect = boundary.effect(&local);
        assert_eq!(effect, shown(&local, boundary), "{boundary:?}");
        met[if effect.is_none() { 0 } else { 1 + usize::from(effect.behind.is_empty()) }] += 1;
    }
    assert!(met.iter().all(|&count| count > 30), "{met:?}");
    assert!(LightBoundary::None.effect(&scene(&unit_box())).is_none());
}

#[test]
fn planes_that_touch_corners_leave_triangles_whole() {
    let local = scene(&closed_box([-1.0; 3], [1.0; 3]));
    let plane = |height: f64| LightBoundary::Plane { point: [0.0, 0.0, height], normal: [0.0, 0.0, 1.0] };
    assert_eq!(plane(-1.0).effect(&local), shown(&local, plane(-1.0)));
    assert_eq!(plane(-1.0).effect(&local).behind.len(), 2, "the bottom lies in it and lights nothing");
    assert!(plane(-1.0 - 1e-9).effect(&local).is_none());
    assert_eq!(plane(0.0).effect(&local).boundary, plane(0.0));
}

#[test]
fn equal_effects_make_equal_occluders() {
    // Two boxes and a lid over them: wherever the plane lies between, the lid is behind.
    let mut triangles = closed_box([-1.0, -1.0, -1.0], [-0.5, 1.0, 0.0]);
    triangles.extend(closed_box([0.5, -1.0, -1.0], [1.0, 1.0, 0.25]));
    triangles.extend(closed_box([-1.0, -1.0, 0.75], [1.0, 1.0, 1.0]));
    let local = scene(&triangles);
    let triangles: Vec<Triangle> = local.triangles().collect();
    let below = |height: f64, tilt: f64| LightBoundary::Plane {
        point: [0.0, 0.0, height],
        normal: [tilt.sin(), 0.0, -tilt.cos()],
    };
    let made = |boundary: &LightBoundary| Occluders::new(&triangles, |_| 1.0, boundary).unwrap();
    let (low, high) = (below(0.4, 0.0), below(0.6, 0.05));
    assert_eq!(low.effect(&local), high.effect(&local));
    assert_eq!(low.effect(&local).behind.len(), 12);
    assert_eq!(made(&low), made(&high));
    assert_ne!(low.effect(&local), below(0.1, 0.0).effect(&local), "it cuts a box");
    let ball = LightBoundary::Ball { center: [0.0, 0.0, 0.3], radius: 0.3 };
    assert!(ball.effect(&local).is_none());
    assert_eq!(made(&ball), made(&LightBoundary::None));
}
