//! A thin sheet just over its receivers lets nothing through, as near as float32 can tell the two apart.
//!
//! A receiver with a normal is lifted off its surface by 14 u (|p| + extent), u = 2^-24, in local coordinates; and sheet and
//! receiver are each rounded to float32. A sheet that is higher than all of that hides the light. Lower, it may not.

use softshadow::Scene;
use softshadow_scene::LocalScene;

use crate::common::{Random, lamp, points, ray_traced, rectangle, see, surface_points};
use crate::shapes::{Point, Triangle, add, map, plate, scene};

const U: f64 = 1.0 / 16_777_216.0;
const HEIGHTS: [f64; 5] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6];
const DISTANCES: [f64; 4] = [0.0, 10.0, 100.0, 1000.0];

/// World heights below which a sheet over `position` may be lost, for a receiver with a normal and for one without.
fn bounds(scene: &Scene, position: Point) -> [f64; 2] {
    let local = LocalScene::new(scene, None, 128 << 20);
    let p = local.frame.local_from_world(position).abs().max_element();
    let lift = 14.0 * U * (p + f64::from(local.extent));
    // Half a last place each for the sheet and the receiver, and once more for the receiver that was lifted.
    let rounding = U * p.max(f64::from(local.extent));
    [lift + 3.0 * rounding, 2.0 * rounding].map(|local_height| local_height * local.frame.world_from_local_scale())
}

/// Floor and sheet around a place, a quarter of a unit to each side.
fn sheet_over_floor(at: Point, height: f64) -> Vec<Triangle> {
    let mut triangles = plate([-0.25, 0.25], [-0.25, 0.25], 0.0);
    triangles.extend(plate([-0.25, 0.25], [-0.25, 0.25], height));
    map(&triangles, |p| add(p, at))
}

struct Row {
    distance: f64,
    height: f64,
    /// For points with a normal, and for points without.
    bounds: [f64; 2],
    /// Their largest visibilities.
    leaks: [f64; 2],
}

fn row(at: Point, distance: f64, height: f64, triangles: &[Triangle]) -> Row {
    let scene = scene(triangles);
    let receivers: Vec<Point> =
        Random(5).points(256, [-0.2, 0.2], [-0.2, 0.2], [0.0, 0.0]).into_iter().map(|p| add(p, at)).collect();
    let light = lamp(rectangle(0.3, 0.3), add(at, [0.05, 0.0, 2.0]));
    let largest = |receivers| {
        let seen = see(&scene, std::slice::from_ref(&light), &receivers, &ray_traced(32));
        seen.values.iter().fold(0.0, |m: f64, v| m.max(f64::from(*v)))
    };
    let leaks = [largest(surface_points(receivers.clone(), [0.0, 0.0, 1.0])), largest(points(receivers))];
    Row { distance, height, bounds: bounds(&scene, add(at, [0.2, 0.2, 0.0])), leaks }
}

fn print(name: &str, rows: &[Row]) {
    println!("{name}: distance, height, bound and largest V with a normal, the same without");
    for r in rows {
        let [a, b] = [0, 1].map(|k| format!("{:9.2e} {:6.3}", r.bounds[k], r.leaks[k]));
        println!("  {:6} {:8.0e} {a} {b}", r.distance, r.height);
    }
}

/// Leaks past sheets that are above the bound.
fn faults(rows: &[Row]) -> usize {
    let of = |r: &Row| (0..2).filter(|&k| r.height > r.bounds[k] && r.leaks[k] > 0.0).count();
    rows.iter().map(of).sum()
}

#[test]
fn alone_in_its_scene_a_sheet_never_leaks() {
    // The scene is recentred, so its distance from the world's origin costs nothing.
    let cases = DISTANCES.into_iter().flat_map(|d| HEIGHTS.map(|h| (d, h)));
    let rows: Vec<Row> = cases
        .map(|(distance, height)| {
            let at = [distance, distance * 0.7, -distance * 0.3];
            row(at, distance, height, &sheet_over_floor(at, height))
        })
        .collect();
    print("alone", &rows);
    assert!(rows.iter().all(|r| r.height > r.bounds[0]), "every height is above the bound");
    assert!(rows.iter().all(|r| r.leaks == [0.0, 0.0]), "a sheet leaks");
}

#[test]
fn far_from_the_middle_of_a_scene_a_sheet_leaks_only_below_the_bound() {
    let cases = DISTANCES.into_iter().flat_map(|d| HEIGHTS.map(|h| (d, h)));
    let rows: Vec<Row> = cases
        .map(|(distance, height)| {
            let at = [distance, distance * 0.7, -distance * 0.3];
            let mut triangles = sheet_over_floor(at, height);
            triangles.push(map(&plate([-0.1, 0.1], [-0.1, 0.1], 0.0), |p| p.map(|x| x - distance))[0]);
            row(at, distance, height, &triangles)
        })
        .collect();
    print("with a far triangle", &rows);
    assert_eq!(faults(&rows), 0, "a sheet above the bound leaks");
    let above = rows.iter().filter(|r| r.height > r.bounds[0]).count();
    assert!(above >= 10, "{above} rows are above the bound");

    // The table can show a leak: far below the bound a receiver is lifted through the sheet.
    assert!(rows.iter().any(|r| r.height < 0.1 * r.bounds[0] && r.leaks[0] > 0.9));
}

#[test]
fn without_the_sheet_the_same_receivers_are_lit() {
    let at = [10.0, 7.0, -3.0];
    let open = row(at, 10.0, 1e-2, &sheet_over_floor(at, 1e-2)[..2]);
    assert_eq!(open.leaks, [1.0, 1.0]);
    assert_eq!(faults(&[open]), 2, "light above the bound is a fault");
}
