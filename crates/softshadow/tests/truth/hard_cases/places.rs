//! Where receivers are: DC4, DC6, DC7 and DC8.

use softshadow::{Camera, Counters, DepthComplexity, Evaluation, Receivers};

use super::judge::{Case, expect_rays, settings};
use super::{MANY, aimed, all_around, slanting};
use crate::common::{Random, bits, lamp, on_driver, points, rectangle};
use crate::shapes::{Triangle, cuboid, plate, scene, sphere, torus};

#[test]
fn dc04_half_buried_bodies() {
    let mut random = Random(40);
    let level = lamp(rectangle(1.0, 1.0), [0.1, 0.05, 3.0]);
    for (name, body) in [("DC4 ball", sphere([0.0; 3], 0.5, 3)), ("DC4 ring", torus(0.5, 0.2, 24, 16))] {
        // Edges cross the plane through every receiver; many receivers are inside.
        let around = all_around(&mut random, MANY);
        // Receivers at the height of a ring of vertices, where ends lie in the plane itself.
        let heights: Vec<f64> = body.as_flattened().iter().map(|v| v[2]).collect();
        let mut place = || {
            let [x, y, _] = random.point([-1.0, 1.0], [-1.0, 1.0], [0.0, 1.0]);
            [x, y, heights[(random.next() % heights.len() as u64) as usize]]
        };
        let at_rings = points((0..MANY).map(|_| place()).collect());
        let body = scene(&body);
        let calls = [Case::run(&body, &slanting(), &around), Case::run(&body, &level, &at_rings)];
        let found = expect_rays(name, calls);
        assert!(found.samples >= 200_000);
    }
}

/// A camera's image by tiles and by wedges, which have to be one.
fn by_both(triangles: &[Triangle], light: &softshadow::Light, camera: Camera) -> Case {
    let (scene, receivers) = (scene(triangles), Receivers::Camera(camera));
    let found = Case::run(&scene, light, &receivers);
    // Wedges are drawn, and their receivers with them.
    let _driver = on_driver();
    let tiled = Case::run(&scene, light, &receivers);
    for counters in [Counters::Words, Counters::Float] {
        let blended = DepthComplexity { evaluation: Evaluation::Blended, counters, ..settings() };
        let wedges = Case::with(&scene, light, &receivers, blended);
        assert!(wedges.seen.info.silhouette_edges > 0);
        assert!(bits(&tiled.seen) == bits(&wedges.seen), "{counters:?}");
    }
    found
}

#[test]
fn dc04_floors_through_bodies_under_a_camera() {
    // Receivers on floor, ball and ring know their own triangle and have a horizon.
    let floor = plate([-2.0, 2.0], [-2.0, 2.0], 0.0);
    let bodies = [floor, sphere([0.4, 0.0, 0.0], 0.5, 3), torus(0.9, 0.2, 24, 12)].concat();
    let camera = Camera::look_at([1.6, -2.6, 1.9], [0.1, 0.0, 0.0], None, 45.0, [80, 60]).unwrap();
    let lights = [slanting(), aimed(rectangle(1.2, 0.9), [2.5, 0.6, 0.7], [0.0; 3])];
    expect_rays("DC4 floors under a camera", lights.map(|light| by_both(&bodies, &light, camera)));
}

#[test]
fn dc06_inside_a_closed_body_nothing_is_seen() {
    let inside = points(Random(60).points(MANY, [-0.5, 0.5], [-0.5, 0.5], [-0.5, 0.5]));
    let case = Case::run(&scene(&sphere([0.0; 3], 0.9, 3)), &slanting(), &inside);
    assert!(case.seen.values.iter().all(|v| *v == 0.0));
    let found = expect_rays("DC6 inside a ball", [case]);
    assert_eq!(found.hidden, found.samples);
}

#[test]
fn dc07_the_terminator_of_a_ball() {
    // The ball fills the image, and the light stands to the side: the terminator runs across it.
    for levels in [2, 4] {
        let ball = sphere([0.0; 3], 0.8, levels);
        let camera = Camera::look_at([0.3, -3.0, 0.4], [0.0; 3], None, 30.0, [72, 72]).unwrap();
        let light = aimed(rectangle(1.5, 1.0), [2.4, -1.0, 0.9], [0.0; 3]);
        let case = by_both(&ball, &light, camera);
        let partly =
            case.seen.values.iter().zip(&case.seen.valid).filter(|(v, valid)| **valid && **v > 0.0 && **v < 1.0);
        assert!(partly.count() > 200, "the terminator is in the image");
        expect_rays(&format!("DC7 ball of {} faces", ball.len()), [case]);
    }
}

#[test]
fn dc07_the_own_corners_of_a_body() {
    // A box that stands on another, and its coplanar pairs of triangles: neighbours of the receiver's own triangle pass just below it.
    let boxes = [cuboid([-0.5; 3], [0.5, 0.5, 0.0]), cuboid([-0.2, -0.3, 0.0], [0.3, 0.2, 0.4])].concat();
    let camera = Camera::look_at([1.3, -1.9, 1.6], [0.0, 0.0, -0.1], None, 35.0, [72, 60]).unwrap();
    let lights = [slanting(), aimed(rectangle(1.0, 1.0), [-2.0, -1.5, 0.6], [0.0; 3])];
    expect_rays("DC7 boxes", lights.map(|light| by_both(&boxes, &light, camera)));
}

#[test]
fn dc08_contact_gaps() {
    let mut random = Random(80);
    let (height, reach) = (0.3, 0.31);
    let plate = scene(&plate([0.05 - reach, 0.05 + reach], [0.02 - reach, 0.02 + reach], height));
    let light = lamp(rectangle(1.0, 1.0), [0.1, 0.05, 3.0]);
    for exponent in 1..=6 {
        let gap = 10f64.powi(-exponent);
        // Under the plate and a little beside it, as far as the shadow's border reaches; and within a few gaps of the border.
        let under = random.points(MANY / 2, [-0.5, 0.6], [-0.5, 0.6], [height - gap; 2]);
        let mut beside = || [0.05 + reach + random.within([-1.0, 1.0]) * gap, random.within([-0.2, 0.2]), height - gap];
        let at_border = (0..MANY / 2).map(|_| beside()).collect();
        let calls = [under, at_border].map(|receivers| Case::run(&plate, &light, &points(receivers)));
        expect_rays(&format!("DC8 gap {gap:e}"), calls);
    }
}
