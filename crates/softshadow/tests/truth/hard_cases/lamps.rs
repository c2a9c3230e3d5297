//! Where the light is: DC5.

use softshadow::LightShape;

use super::judge::{Case, expect_rays};
use super::{MANY, aimed, all_around, below, leaf};
use crate::common::{Random, lamp, points, rectangle};
use crate::shapes::{scene, sphere, torus};

fn bracket() -> LightShape {
    let outline = [[-0.5, -0.5], [0.6, -0.5], [0.6, -0.15], [-0.1, -0.15], [-0.1, 0.45], [-0.5, 0.45]];
    LightShape::Polygon { outline: outline.to_vec() }
}

#[test]
fn dc05_geometry_through_the_light() {
    let bodies = [sphere([0.2, 0.1, 1.0], 0.3, 2), torus(0.5, 0.2, 20, 12)].concat();
    let lifted: Vec<_> = bodies.iter().map(|t| t.map(|[x, y, z]| [x, y, if z < 0.5 { z + 0.95 } else { z }])).collect();
    let room = scene(&lifted);
    let mut random = Random(50);
    for shape in [rectangle(1.0, 0.8), LightShape::Disc { radius: 0.5 }, bracket()] {
        let light = aimed(shape, [0.05, 0.02, 1.0], [0.0, 0.0, -1.0]);
        let places = [below(&mut random, MANY), all_around(&mut random, MANY / 2)];
        let cases = places.map(|receivers| Case::run(&room, &light, &receivers));
        assert!(cases[0].seen.info.cut_triangles > 20 && cases[0].seen.info.triangles_behind > 20);
        expect_rays("DC5 through the light", cases);
    }
}

#[test]
fn dc05_receivers_just_in_front_of_the_light() {
    // One end of an edge is near and the other far: only the nearer has an image that is sharp enough for the line.
    let mut random = Random(54);
    let leaves: Vec<_> = (0..200).map(|_| leaf(&mut random, 0.5, [-0.6, 0.6], [0.2, 0.99])).collect();
    let (room, light) = (scene(&leaves), lamp(rectangle(1.0, 1.0), [0.1, 0.2, 1.0]));
    for exponent in 1..=6 {
        let z = 1.0 - 10f64.powi(-exponent);
        let case = Case::run(&room, &light, &points(random.points(MANY, [-0.5, 0.7], [-0.5, 0.7], [z, z])));
        let found = case.found();
        println!("hard case DC5 1e-{exponent} in front of the light {found:?}");
        // Nearest to the light the bound would excuse anything; nothing has to be excused.
        assert!(found.samples >= 100_000 && found.grazing + found.wrong == 0, "{found:?}");
        if exponent <= 3 {
            case.goes_red_when_spoilt("DC5 in front of the light");
        }
    }
}

#[test]
fn dc05_a_light_inside_a_body() {
    let mut random = Random(51);
    let shade = scene(&sphere([0.0, 0.0, 1.0], 0.8, 2));
    let light = lamp(rectangle(0.5, 0.5), [0.0, 0.0, 1.0]);
    let cases = [below(&mut random, MANY), all_around(&mut random, MANY)];
    expect_rays("DC5 a light inside a ball", cases.map(|receivers| Case::run(&shade, &light, &receivers)));
}

#[test]
fn dc05_occluders_behind_the_light_hide_nothing() {
    let mut random = Random(52);
    for (shape, top) in
        [(rectangle(0.5, 0.5), 1.5), (LightShape::Disc { radius: 0.3 }, 1.5), (LightShape::Sphere { radius: 0.2 }, 1.6)]
    {
        let behind = scene(&sphere([0.0, 0.0, top], 0.3, 2));
        let case = Case::run(&behind, &lamp(shape, [0.0, 0.0, 1.0]), &below(&mut random, MANY));
        assert!(case.seen.values.iter().all(|v| *v == 1.0), "{:?}", case.light().shape());
        let found = case.found();
        assert_eq!((found.samples, found.hidden, found.wrong), (MANY * 64, 0, 0));
        case.goes_red_when_spoilt("DC5 behind");
    }
}

#[test]
fn dc05_both_sides_of_a_ball_of_light() {
    // Before it for some receivers, behind it for others.
    let mut random = Random(53);
    let near = scene(&sphere([0.0, 0.0, 0.6], 0.3, 2));
    let light = lamp(LightShape::Sphere { radius: 0.2 }, [0.0; 3]);
    let cases = [0, 1].map(|_| Case::run(&near, &light, &all_around(&mut random, MANY)));
    expect_rays("DC5 either side of a ball of light", cases);
}
