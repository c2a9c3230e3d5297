//! Every outline has its own ramp, whichever way the edge runs; cones and sheets are one penumbra.

use softshadow::{Light, LightShape, Ramp, look_at};

use super::{LAMP, across, farthest_from, half_plane, half_width, on_floor, over};
use crate::common::Random;
use crate::shapes::{Point, Triangle, length, map, plate, turned};

fn of_a_disc(k: f64) -> f64 {
    let t = 2.0 * k - 1.0;
    0.5 + (t * (1.0 - t * t).max(0.0).sqrt() + t.asin()) / std::f64::consts::PI
}

/// Nothing in the hard shadow, and a ramp before it.
fn outer(ramp: impl Fn(f64) -> f64) -> impl Fn(f64) -> f64 {
    move |t| ramp(t.clamp(0.0, 1.0))
}

#[test]
fn a_disc_has_the_ramp_of_a_disc() {
    let (height, radius) = (2.0, 0.4);
    let (t, places) = across(half_width(height, radius));
    let seen = on_floor(&half_plane(height), &over(LightShape::Disc { radius }), &places, 2048, Ramp::Light);
    let error = farthest_from(&t, &seen, outer(of_a_disc));
    let as_linear = farthest_from(&t, &seen, outer(|k| k));
    println!("disc: {error:.4} from the ramp of a disc, {as_linear:.4} from a linear one");
    assert!(error < 0.01 && as_linear > 0.05);
}

#[test]
fn a_sun_has_the_width_of_its_angle() {
    let (height, angle) = (2.0, 0.2_f64);
    let (t, places) = across(height * (angle * 0.5).tan());
    for (width, is_right) in [(angle, true), (angle * 1.2, false)] {
        let sun = crate::common::lamp(LightShape::Sun { angular_diameter: width }, [0.0; 3]);
        for (ramp, shape) in [(Ramp::Light, &of_a_disc as &dyn Fn(f64) -> f64), (Ramp::Linear, &|k| k)] {
            let seen = on_floor(&half_plane(height), &sun, &places, 2048, ramp);
            let error = farthest_from(&t, &seen, outer(shape));
            println!("sun of {width}, {ramp:?}: {error:.4}");
            assert_eq!(error < 0.01, is_right, "{width} {ramp:?}: {error}");
        }
    }
}

#[test]
fn a_sphere_is_the_disc_that_each_surface_sees() {
    let (height, radius) = (2.0, 0.6);
    let (_, places) = across(half_width(height, radius));
    // The angle between the way to the centre and the plane through the edge, against that which the ball spans.
    let share = |p: Point| {
        let way = [-p[0], -p[1], LAMP];
        let normal = [height, 0.0, p[0]].map(|x| x / (height * height + p[0] * p[0]).sqrt());
        let sine = (normal[0] * way[0] + normal[2] * way[2]) / length(way);
        let spanned = radius / length(way);
        (sine / (1.0 - sine * sine).sqrt()) / (spanned / (1.0 - spanned * spanned).sqrt())
    };
    let seen = on_floor(&half_plane(height), &over(LightShape::Sphere { radius }), &places, 2048, Ramp::Light);
    let k: Vec<f64> = places.iter().map(|p| share(*p)).collect();
    let error = farthest_from(&k, &seen, outer(of_a_disc));
    let flat: Vec<f64> = places.iter().map(|p| p[0] / half_width(height, radius * 1.1)).collect();
    let spoilt = farthest_from(&flat, &seen, outer(of_a_disc));
    println!("sphere: {error:.4}; against a disc a tenth larger {spoilt:.4}");
    assert!(error < 0.012 && spoilt > 0.03);
}

/// The share of a convex outline on the side of a line that moves across it, by clipping.
fn clipped_share(outline: &[[f64; 2]], normal: [f64; 2], k: f64) -> f64 {
    let at = |c: &[f64; 2]| c[0] * normal[0] + c[1] * normal[1];
    let area = |c: &[[f64; 2]]| {
        let next = c.iter().cycle().skip(1);
        c.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>().abs()
    };
    let low = outline.iter().map(at).fold(f64::INFINITY, f64::min);
    let high = outline.iter().map(at).fold(f64::NEG_INFINITY, f64::max);
    let line = low + k * (high - low);
    let mut kept = Vec::new();
    for (a, b) in outline.iter().zip(outline.iter().cycle().skip(1)) {
        if at(a) <= line {
            kept.push(*a);
        }
        if (at(a) < line) != (at(b) < line) && (at(a) - at(b)).abs() > 1e-12 {
            let t = (line - at(a)) / (at(b) - at(a));
            kept.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
        }
    }
    area(&kept) / area(outline)
}

/// The half plane turned about the z axis, and places across its border at t times the width.
fn turned_half_plane(height: f64, angle: f64, width: f64) -> (Vec<Triangle>, Vec<f64>, Vec<Point>) {
    let (t, places) = across(width);
    let about = |p: Point| turned(p, 0.0, angle);
    (map(&half_plane(height), about), t, places.into_iter().map(about).collect())
}

#[test]
fn squares_and_polygons_have_the_ramp_of_the_edge_s_direction() {
    let height = 2.0;
    // Along x and y, lopsided, and seen from above with x to the right.
    let triangle = vec![[0.7, -0.1], [-0.3, 0.5], [-0.4, -0.6]];
    let shapes = [
        (
            LightShape::Rectangle { width: 0.8, height: 0.5 },
            vec![[0.4, 0.25], [-0.4, 0.25], [-0.4, -0.25], [0.4, -0.25]],
        ),
        (LightShape::Polygon { outline: triangle.clone() }, triangle),
    ];
    for (shape, outline) in shapes {
        for degrees in [0.0_f64, 20.0, 45.0, 90.0, 137.0, 180.0, 270.0] {
            let angle = degrees.to_radians();
            // The plate ends where x turned by the angle is 0: the light is seen over it, so from +x its far side at -x goes first.
            let normal = [-angle.cos(), -angle.sin()];
            let reach = |n: [f64; 2]| outline.iter().map(|c| c[0] * n[0] + c[1] * n[1]).fold(0.0, f64::max);
            let (triangles, t, places) = turned_half_plane(height, angle, half_width(height, reach(normal)));
            let seen = on_floor(&triangles, &over(shape.clone()), &places, 2048, Ramp::Light);
            let error = farthest_from(&t, &seen, outer(|k| clipped_share(&outline, normal, k)));
            let linear = on_floor(&triangles, &over(shape.clone()), &places, 2048, Ramp::Linear);
            let linear_error = farthest_from(&t, &linear, outer(|k| k));
            println!("{} corners at {degrees}°: {error:.4}, linear {linear_error:.4}", outline.len());
            assert!(error < 0.015 && linear_error < 0.015, "{} corners at {degrees}", outline.len());
            // A light that was not reflected in the edge reaches as far as its other side.
            if outline.len() == 3 {
                let mirrored = [-normal[0], -normal[1]];
                let (_, wrong, _) = turned_half_plane(height, angle, 1.0);
                let wrong: Vec<f64> = wrong.iter().map(|t| t * reach(normal) / reach(mirrored)).collect();
                let spoilt = farthest_from(&wrong, &linear, outer(|k| k));
                if (reach(normal) / reach(mirrored) - 1.0).abs() > 0.2 {
                    assert!(spoilt > 0.05, "{degrees}: a forgotten reflection is seen, {spoilt}");
                }
            }
        }
    }
}

#[test]
fn around_a_corner_a_cone_joins_the_sheets() {
    let height = 2.0;
    let mut triangles = plate([-3.0, 3.0], [-3.0, 3.0], 0.0);
    triangles.extend(plate([-3.0, 0.0], [-3.0, 0.0], height));
    let places = Random(5).points(8000, [-0.7, 0.7], [-0.7, 0.7], [0.0, 0.0]);
    let (disc, square) = (LightShape::Disc { radius: 0.5 }, LightShape::Rectangle { width: 1.0, height: 1.0 });
    let width = half_width(height, 0.5);
    for (name, shape) in [("disc", disc), ("square", square)] {
        let seen = on_floor(&triangles, &over(shape), &places, 2048, Ramp::Linear);
        let share = |p: &Point| {
            let [x, y] = [p[0].max(0.0) / width, p[1].max(0.0) / width];
            if name == "disc" { x.hypot(y).min(1.0) } else { x.max(y).min(1.0) }
        };
        let clear = |p: &&Point| p[0].max(p[1]).abs() > 0.02;
        let error = |f: &dyn Fn(&Point) -> f64| {
            let pairs = places.iter().zip(&seen.values).filter(|(p, _)| clear(p));
            pairs.map(|(p, v)| (f64::from(*v) - f(p)).abs()).fold(0.0, f64::max)
        };
        let (found, sheets_alone) = (
            error(&share),
            error(&|p: &Point| {
                // Without its cone, the quarter beyond the corner is lit.
                if p[0] > 0.0 && p[1] > 0.0 { 1.0 } else { share(p) }
            }),
        );
        println!("corner, {name}: {found:.4} from the closed form, {sheets_alone:.3} from sheets alone");
        assert!(found < 0.01 && sheets_alone > 0.5, "{name}");
    }
}

#[test]
fn six_faces_see_what_one_view_sees() {
    // The border falls on the seam between two faces of the cube: 45 degrees from straight down.
    let height = 1.0;
    let lean = std::f64::consts::FRAC_PI_4;
    let far: Vec<Triangle> = [[7.0, 0.0, 0.0], [0.0, 7.0, 0.0], [0.0, 0.0, 12.0]]
        .iter()
        .map(|p| [*p, [p[0] + 0.1, p[1], p[2]], [p[0], p[1] + 0.1, p[2]]])
        .collect();
    let about = |p: Point| {
        let q = turned([p[0], p[1], p[2] - LAMP], lean, 0.3);
        [q[0], q[1], q[2] + LAMP]
    };
    let (t, places) = across(half_width(height, 0.4));
    let mut small = plate([-0.8, 0.8], [-0.3, 0.3], 0.0);
    small.extend(plate([-0.8, 0.0], [-0.3, 0.3], height));
    let mut alone = map(&small, about);
    let normal = turned([0.0, 0.0, 1.0], lean, 0.3);
    let receivers = crate::common::surface_points(places.iter().map(|p| about(*p)).collect(), normal);
    let light =
        Light::new(LightShape::Sphere { radius: 0.4 }, look_at([0.0, 0.0, LAMP], [0.0; 3], None).unwrap()).unwrap();
    let see = |triangles: &[Triangle]| {
        let technique = crate::common::penumbra_map(2048, Ramp::Linear);
        crate::common::see(&crate::shapes::scene(triangles), std::slice::from_ref(&light), &receivers, &technique)
    };
    let one = see(&alone);
    alone.extend(far);
    let six = see(&alone);
    assert!(
        six.info.plan.contains("draw penumbra 5") && !one.info.plan.contains("draw penumbra 1"),
        "{}",
        six.info.plan
    );
    let pairs = || one.values.iter().zip(&six.values).zip(&t).filter(|(_, t)| t.abs() > 0.02);
    let worst = pairs().map(|((a, b), _)| (a - b).abs()).fold(0.0, f32::max);
    println!("one view and six faces differ by at most {worst:.4}");
    assert!(worst < 0.02 && pairs().any(|((a, _), _)| *a > 0.4 && *a < 0.6));
}
