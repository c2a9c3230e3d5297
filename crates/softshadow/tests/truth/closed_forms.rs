//! Ray traced against closed forms and the exact union, within its own standard errors.

use std::f64::consts::{FRAC_PI_3, PI};

use softshadow::measure::{
    AxisRectangle, Receiver, RectangleLight, Sphere, disc_over_disc, half_plane_over_rectangle,
    rectangle_over_rectangle, rectangle_visibility, sphere_over_rectangle, sphere_over_sphere_light,
};
use softshadow::{LightShape, SamplePattern};

use crate::common::{lamp, rectangle};
use crate::coverage::Case;
use crate::shapes::{Point, Triangle, cuboid, disc, inner_radius, map, plate, scene, sphere, turned};

/// Height of every light over the receivers.
const HEIGHT: f64 = 2.0;
const UP: Point = [0.0, 0.0, 1.0];

/// Receivers over a square, with a normal that keeps the whole light above the horizon.
fn case<'a>(name: &'a str, triangles: &[Triangle], shape: LightShape) -> Case<'a> {
    Case {
        name,
        scene: scene(triangles),
        light: lamp(shape, [0.0, 0.0, HEIGHT]),
        x: [-1.0, 1.0],
        y: [-1.0, 1.0],
        normal: Some(UP),
        pattern: SamplePattern::Stratified,
    }
}

/// Everything on the far side of a line at `height`, as large as any ray from the receivers can reach.
fn half_plane(angle: f64, height: f64) -> Vec<Triangle> {
    map(&plate([-8.0, 0.0], [-8.0, 8.0], height), |p| turned(p, 0.0, angle))
}

#[test]
fn a_half_plane_hides_its_share_of_a_rectangle() {
    for (angle, height) in [(0.0, 1.0), (0.3, 1.0), (FRAC_PI_3, 0.5), (1.9, 1.5), (-2.5, 1.0)] {
        let name = format!("half-plane at {angle:.2}, height {height}");
        // Seen from p on the light's plane, the edge passes where n·q = n·p (1 - k), k = light's height by the edge's.
        let k = HEIGHT / height;
        case(&name, &half_plane(angle, height), rectangle(1.2, 0.7)).require(|p| {
            let across = p[0] * angle.cos() + p[1] * angle.sin();
            [half_plane_over_rectangle(across * (1.0 - k), angle, [0.6, 0.35]).unwrap(); 2]
        });
    }
}

#[test]
fn without_a_normal_and_with_either_pattern_the_share_is_the_same() {
    for pattern in [SamplePattern::Stratified, SamplePattern::LowDiscrepancy] {
        let free =
            Case { normal: None, pattern, ..case("half-plane, no normal", &half_plane(0.7, 1.0), rectangle(1.2, 0.7)) };
        free.require(|p| {
            let across = p[0] * 0.7_f64.cos() + p[1] * 0.7_f64.sin();
            [half_plane_over_rectangle(-across, 0.7, [0.6, 0.35]).unwrap(); 2]
        });
    }
}

#[test]
fn a_rectangle_hides_its_share_of_a_rectangle() {
    let occluder = AxisRectangle { x: [-0.4, 0.5], y: [-0.2, 0.3], z: 0.8 };
    let light = AxisRectangle { x: [-0.5, 0.5], y: [-0.3, 0.3], z: HEIGHT };
    let plate = plate(occluder.x, occluder.y, occluder.z);
    case("rectangle over rectangle", &plate, rectangle(1.0, 0.6))
        .require(|p| [rectangle_over_rectangle(p, &occluder, &light).unwrap(); 2]);
}

#[test]
fn a_disc_hides_its_share_of_a_disc() {
    let (sides, radius, height) = (512, 0.3, 1.0);
    let k = HEIGHT / height;
    let occluder = disc([0.0, 0.0, height], radius, sides);
    case("disc over disc", &occluder, LightShape::Disc { radius: 0.5 }).require(|p| {
        let distance = p[0].hypot(p[1]) * (k - 1.0);
        // The polygon lies between its inscribed and its circumscribed circle.
        let inner = radius * (PI / f64::from(sides)).cos();
        [radius, inner].map(|r| disc_over_disc(distance, r * k, 0.5).unwrap())
    });
}

#[test]
fn a_sphere_hides_its_share_of_a_rectangle() {
    let (center, radius) = ([0.0, 0.1, 1.0], 0.35);
    let occluder = sphere(center, radius, 6);
    let light = AxisRectangle { x: [-0.5, 0.5], y: [-0.3, 0.3], z: HEIGHT };
    let inner = inner_radius(&occluder, center);
    case("sphere over rectangle", &occluder, rectangle(1.0, 0.6)).require(|p| {
        [radius, inner].map(|radius| sphere_over_rectangle(p, &Sphere { center, radius }, &light).unwrap())
    });
}

#[test]
fn a_sphere_hides_its_share_of_a_sphere_light() {
    let (center, radius) = ([0.0, 0.1, 0.7], 0.25);
    let occluder = sphere(center, radius, 6);
    let light = Sphere { center: [0.0, 0.0, HEIGHT], radius: 0.4 };
    let inner = inner_radius(&occluder, center);
    case("sphere over sphere light", &occluder, LightShape::Sphere { radius: light.radius }).require(|p| {
        [radius, inner].map(|radius| sphere_over_sphere_light(p, &Sphere { center, radius }, &light).unwrap())
    });
}

#[test]
fn an_l_shaped_light_is_the_sum_of_its_rectangles_past_a_box_and_below_the_horizon() {
    let outline = vec![[-0.5, -0.5], [0.5, -0.5], [0.5, 0.0], [0.0, 0.0], [0.0, 0.5], [-0.5, 0.5]];
    let part = |center: [f64; 2], half: [f64; 2]| {
        let center = [center[0], center[1], HEIGHT];
        RectangleLight::new(center, [half[0], 0.0, 0.0], [0.0, half[1], 0.0], [0.0, 0.0, -1.0]).unwrap()
    };
    // Areas 0.5 and 0.25.
    let parts = [(part([0.0, -0.25], [0.5, 0.25]), 2.0 / 3.0), (part([-0.25, 0.25], [0.25, 0.25]), 1.0 / 3.0)];
    let mut triangles = cuboid([-0.2, -0.3, 0.7], [0.3, 0.1, 1.2]);
    triangles.extend(map(&plate([-0.3, 0.3], [-0.2, 0.2], 0.0), |p| {
        let p = turned(p, 0.8, 0.4);
        [p[0] + 0.1, p[1] + 0.2, p[2] + 1.4]
    }));
    // The second normal cuts the light with the receivers' horizon.
    for normal in [UP, [-0.9, 0.3, 0.2]] {
        let tilted = Case {
            normal: Some(normal),
            ..case("L-shaped light, exact union", &triangles, LightShape::Polygon { outline: outline.clone() })
        };
        tilted.require(|p| {
            let receiver = Receiver { normal: Some(normal), ..Receiver::at(p) };
            [parts.iter().map(|(l, share)| share * rectangle_visibility(l, &triangles, &receiver).unwrap()).sum(); 2]
        });
    }
}

#[test]
fn a_half_plane_hides_a_segment_of_the_sun() {
    let (angle, height, diameter) = (0.5, 1.0, 4.0_f64.to_radians());
    let sun = LightShape::Sun { angular_diameter: diameter };
    let near_edge =
        Case { x: [-0.08, 0.08], y: [-0.08, 0.08], ..case("half-plane over the sun", &half_plane(angle, height), sun) };
    near_edge.require(|p| {
        // On the tangent disc of radius 1 around the sun's direction the edge stands at t.
        let t = -(p[0] * angle.cos() + p[1] * angle.sin()) / (height * (diameter / 2.0).tan());
        let t = t.clamp(-1.0, 1.0);
        let visible = 0.5 - (t * (1.0 - t * t).sqrt() + t.asin()) / PI;
        // Equal shares of solid angle and equal shares of the tangent disc differ by at most the cosine cubed at its rim.
        let slack = if visible <= 0.0 || visible >= 1.0 { 0.0 } else { 1.0 - (diameter / 2.0).cos().powi(3) };
        [(visible - slack).max(0.0), (visible + slack).min(1.0)]
    });
}
