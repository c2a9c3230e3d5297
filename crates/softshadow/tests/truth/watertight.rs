//! Nothing shines through a closed mesh, not even along its edges and through its corners.

use softshadow::{Light, LightShape, Visibility};

use crate::common::{Random, lamp, points, ray_traced, rectangle, see};
use crate::shapes::{Point, Triangle, add, map, scene, sphere, sub, torus, turned};

/// Where the solids stand: no coordinate of theirs is a round number, and world coordinates are large.
const CENTER: Point = [1483.76, -223.423, 71.9];

fn placed(triangles: &[Triangle]) -> Vec<Triangle> {
    map(triangles, |p| add(turned(p, 0.7, 1.1), CENTER))
}

fn lights() -> Vec<Light> {
    let [x, y, z] = CENTER;
    vec![
        lamp(rectangle(1.5, 1.0), [x + 0.3, y - 0.2, z + 3.0]),
        lamp(LightShape::Sphere { radius: 0.8 }, [x - 2.5, y + 0.5, z + 1.0]),
    ]
}

/// Samples that are visible, of how many.
fn leaks(seen: &Visibility, samples: usize) -> (usize, usize) {
    let masks = seen.masks.as_ref().unwrap();
    let blocked: usize =
        masks.bits.iter().map(|word| (word & (u32::MAX >> (32 - samples.min(32)))).count_ones() as usize).sum();
    let asked = seen.lights * seen.receivers * samples;
    (asked - blocked, asked)
}

/// Receivers inside a solid whose inside is where `inside` says.
fn receivers_in(count: usize, inside: impl Fn(Point) -> bool) -> Vec<Point> {
    let mut random = Random(23);
    let mut found = Vec::with_capacity(count);
    while found.len() < count {
        let p = random.point([-1.5, 1.5], [-1.5, 1.5], [-1.5, 1.5]);
        if inside(p) {
            found.push(add(turned(p, 0.7, 1.1), CENTER));
        }
    }
    found
}

#[test]
fn no_ray_of_a_million_leaves_a_closed_mesh() {
    let ball = sphere([0.0; 3], 1.0, 5);
    let ring = torus(1.0, 0.4, 200, 80);
    let in_ball = receivers_in(6000, |p| p.iter().map(|x| x * x).sum::<f64>() < 0.99);
    let in_ring = receivers_in(6000, |p| (p[0].hypot(p[1]) - 1.0).hypot(p[2]) < 0.39);
    let mut asked = 0;
    for (name, solid, receivers) in [("ball", &ball, &in_ball), ("ring", &ring, &in_ring)] {
        let closed = placed(solid);
        let seen = see(&scene(&closed), &lights(), &points(receivers.clone()), &ray_traced(64));
        let (visible, of) = leaks(&seen, 64);
        println!("watertight, {name}: {visible} of {of} samples visible past {} triangles", closed.len());
        assert_eq!(visible, 0, "{name}");
        asked += of;

        // A hole of one triangle on the side of the first light is seen.
        let highest = |t: &Triangle| t.iter().map(|p| p[2]).fold(f64::INFINITY, f64::min);
        let mut open = closed;
        open.sort_by(|a, b| highest(a).total_cmp(&highest(b)));
        open.pop();
        let (visible, of) = leaks(&see(&scene(&open), &lights(), &points(receivers.clone()), &ray_traced(64)), 64);
        println!("watertight, {name} with one triangle missing: {visible} of {of}");
        assert!(visible > 0, "{name}");
    }
    assert!(asked >= 1_000_000);
}

#[test]
fn rays_at_corners_and_along_edges_do_not_slip_through() {
    // A light without size: the one ray of each receiver goes through a corner or the middle of an edge, to rounding.
    let ball = placed(&sphere([0.0; 3], 1.0, 6));
    let at = add(CENTER, [0.4, 0.3, 3.0]);
    let light = lamp(rectangle(0.0, 0.0), at);
    let mut receivers = Vec::new();
    // Far from the silhouette, which lies about 0.5 over the centre: a ray along a silhouette edge may pass.
    for t in ball.iter().filter(|t| t[0][2] > CENTER[2] + 0.75) {
        for k in 0..3 {
            let edge = [0.5, 1.0, 0.25].map(|w| [0, 1, 2].map(|a| t[k][a] * w + t[(k + 1) % 3][a] * (1.0 - w)));
            for target in edge {
                let onward = sub(target, at).map(|x| x * 0.03);
                receivers.push(add(target, onward));
            }
        }
    }
    let (visible, of) = leaks(&see(&scene(&ball), &[light], &points(receivers), &ray_traced(1)), 1);
    println!("watertight, aimed at corners and edges: {visible} of {of} visible");
    assert!(of > 20_000);
    assert_eq!(visible, 0);
}

#[test]
fn thin_bundles_along_an_axis_do_not_slip_through_a_shared_edge() {
    // Every receiver stands under the diagonal of a quad at generic coordinates; all its rays are nearly one, and nearly vertical.
    let corners: [Point; 4] = [[0.137, 0.291, 1.03], [1.419, 0.173, 1.21], [1.533, 1.371, 0.97], [0.211, 1.457, 1.12]];
    let quad = [[corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]];
    let receivers: Vec<Point> = (400..19_600)
        .map(|i| [0, 1].map(|k| corners[0][k] + (corners[2][k] - corners[0][k]) * f64::from(i) / 20_000.0))
        .map(|[x, y]| [x, y, 0.0])
        .collect();
    let sun = |elevation: f64, diameter: f64| Light::sun(33.0, elevation, diameter, softshadow::UpAxis::Z).unwrap();
    let mut lights = vec![sun(90.0, 0.0), sun(90.0, 1e-6), sun(89.999, 0.0), sun(89.9999, 1e-4)];
    lights.push(lamp(rectangle(0.0, 0.0), [0.8, 0.8, 1e4]));
    lights.push(lamp(rectangle(1e-4, 1e-4), [0.8, 0.8, 400.0]));
    for (index, light) in lights.iter().enumerate() {
        let closed = see(&scene(&quad), std::slice::from_ref(light), &points(receivers.clone()), &ray_traced(4));
        let (visible, of) = leaks(&closed, 4);
        println!("watertight, thin bundle {index}: {visible} of {of} visible");
        assert_eq!(visible, 0, "light {index}");
        // Either half alone leaves a border: what its neighbour closes is open then.
        let alone = quad.chunks(1).map(|half| {
            leaks(&see(&scene(half), std::slice::from_ref(light), &points(receivers.clone()), &ray_traced(4)), 4).0
        });
        assert!(alone.sum::<usize>() > 0, "light {index}");
    }
}
