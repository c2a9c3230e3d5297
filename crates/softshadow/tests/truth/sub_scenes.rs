//! A scene whose hierarchy exceeds one storage binding is cut into sub-scenes, and nothing else changes.

use softshadow::{Material, Mesh, Scene};

use crate::common::{bits, hard_shadow_map, lamp, on_driver, ray_traced, rectangle, see, surface_points};
use crate::shapes::Point;

/// A square plate of `2·columns·rows` triangles at height z.
fn plate(opacity: f32, [low, high]: [[f64; 2]; 2], z: f64, [columns, rows]: [u32; 2]) -> Mesh {
    let along = |k: usize, i: u32, n: u32| low[k] + (high[k] - low[k]) * f64::from(i) / f64::from(n);
    let vertices = (0..=rows)
        .flat_map(|j| (0..=columns).map(move |i| (i, j)))
        .map(|(i, j)| [along(0, i, columns), along(1, j, rows), z])
        .collect();
    let at = |i: u32, j: u32| j * (columns + 1) + i;
    let triangles = (0..rows)
        .flat_map(|j| (0..columns).map(move |i| (i, j)))
        .flat_map(|(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]])
        .collect();
    Mesh::new("plate", vertices, triangles, Material { opacity, ..Material::default() }).unwrap()
}

/// A floor, cut as finely as is asked, and occluders near both of its ends: they fall into different sub-scenes.
fn hall(floor: [u32; 2], occluders: &[[[f64; 2]; 2]]) -> Scene {
    glass_hall(floor, occluders, 1.0)
}

fn glass_hall(floor: [u32; 2], occluders: &[[[f64; 2]; 2]], opacity: f32) -> Scene {
    let mut meshes = vec![plate(1.0, [[-1.0, -1.0], [1.0, 1.0]], 0.0, floor)];
    meshes.extend(occluders.iter().map(|bounds| plate(opacity, *bounds, 0.25, [1, 1])));
    Scene::new(meshes).unwrap()
}

const LEFT: [[f64; 2]; 2] = [[-0.9, -0.4], [-0.4, 0.3]];
const RIGHT: [[f64; 2]; 2] = [[0.35, -0.2], [0.8, 0.5]];

#[test]
fn a_scene_over_the_binding_limit_casts_the_same_shadow() {
    let _driver = on_driver();
    let positions: Vec<Point> =
        (0..2000).map(|i| [f64::from(i % 50) / 25.0 - 0.98, f64::from(i / 50) / 20.0 - 0.975, 0.0]).collect();
    let receivers = surface_points(positions, [0.0, 0.0, 1.0]);
    let lights = [lamp(rectangle(0.6, 0.6), [0.0, 0.0, 2.0])];
    // 128 MiB hold the nodes of 2,097,152 triangles.
    let fine = hall([1100, 1000], &[LEFT, RIGHT]);
    let coarse = hall([1, 1], &[LEFT, RIGHT]);
    for technique in [ray_traced(64), hard_shadow_map(512)] {
        let (cut, whole) = (see(&fine, &lights, &receivers, &technique), see(&coarse, &lights, &receivers, &technique));
        assert!(cut.info.plan.contains("corners 1"), "the fine scene needs a second binding: {}", cut.info.plan);
        assert!(!whole.info.plan.contains("corners 1"));
        assert_eq!(bits(&cut), bits(&whole), "{}", technique.name());
    }
    // Each occluder counts, whichever sub-scene it fell into.
    let whole = see(&coarse, &lights, &receivers, &ray_traced(64));
    for lone in [LEFT, RIGHT] {
        assert_ne!(bits(&see(&hall([1, 1], &[lone]), &lights, &receivers, &ray_traced(64))), bits(&whole));
    }
}

#[test]
fn what_passes_is_multiplied_over_sub_scenes() {
    let _driver = on_driver();
    let positions: Vec<Point> = (0..500).map(|i| [f64::from(i) / 250.0 - 0.999, 0.1, 0.0]).collect();
    let receivers = surface_points(positions, [0.0, 0.0, 1.0]);
    let lights = [lamp(rectangle(0.6, 0.6), [0.0, 0.0, 2.0])];
    // The wide plate lies with the left end of the floor, the other with its right end, and rays cross both.
    let plates = [[[-0.9, -0.4], [0.8, 0.5]], RIGHT];
    let see = |floor| see(&glass_hall(floor, &plates, 0.5), &lights, &receivers, &ray_traced(16));
    let (cut, whole) = (see([1100, 1000]), see([1, 1]));
    assert!(cut.info.plan.contains("corners 1") && !whole.info.plan.contains("corners 1"));
    assert_eq!(bits(&cut), bits(&whole));
    for passes in [0.5, 0.25] {
        assert!(whole.values.iter().filter(|v| **v == passes).count() > 20, "{passes}");
    }
}
