//! Every light's frame: a rotation, never a mirror, with the samples where float64 has them.

use glam::{DVec3, Vec3};
use softshadow_measure::Target;
use softshadow_native::depth_complexity::view::Sight;
use softshadow_native::depth_complexity::{LightView, Receiver, face};
use softshadow_scene::LightShape;

use crate::scene::{Random, Setup, Soup};
use crate::shapes::{aimed, ball, leaves, shapes, soup, square, torus};

fn view_of(setup: &Setup, position: [f32; 3]) -> LightView {
    match LightView::towards(&setup.frame, position) {
        Sight::View(view) => view,
        other => panic!("{other:?}"),
    }
}

/// How often a face's side, taken from its plane, contradicts the turn of its image.
fn contradictions(setup: &Setup, random: &mut Random, spoil: impl Fn(LightView) -> LightView) -> usize {
    let mut count = 0;
    for _ in 0..200 {
        let view = spoil(view_of(setup, random.point([-2.0, -2.0, -2.0], [2.0, 2.0, 1.0])));
        for face in &setup.occluders.faces {
            let corners = setup.triangles[face.triangle as usize];
            let mut sorted = corners;
            sorted.sort_by(|a, b| a.partial_cmp(b).unwrap());
            let [a, b, c] = sorted.map(|v| view.project(Vec3::from(v) - view.position).as_dvec3());
            let turn = a.cross(b).dot(c);
            let clear = turn.abs() > 1e-4 * a.length() * b.length() * c.length();
            count += usize::from(clear && (turn > 0.0) != (face::side(&view, face) > 0));
        }
    }
    count
}

#[test]
fn no_light_is_seen_in_a_mirror() {
    let mut random = Random(3);
    let mesh = leaves(&mut random, 100, 0.5, [-1.0, -1.0, -0.5], [1.0, 1.0, 1.5]);
    for (name, shape) in shapes(1.0, 3.0) {
        let setup = Setup::new(mesh.clone(), aimed(shape, [1.0, 0.7, 3.0], [0.1, 0.2, 0.0]), 64);
        assert_eq!(contradictions(&setup, &mut random, |view| view), 0, "{name}");
        let mirrored = |view: LightView| LightView { rows: [-view.rows[0], view.rows[1], view.rows[2]], ..view };
        assert!(contradictions(&setup, &mut random, mirrored) > 1000, "{name}: a mirror is noticed");
    }
}

#[test]
fn every_light_casts_the_shadow_of_its_rays() {
    let mut random = Random(2);
    let meshes = [("ball", soup(&ball([0.0; 3], 0.4, 2))), ("torus", soup(&torus([0.0; 3], 0.4, 0.15, 24, 12)))];
    for (name, mesh) in &meshes {
        for (shape_name, shape) in shapes(1.0, 3.0) {
            let setup = Setup::new(mesh.clone(), aimed(shape, [0.3, 0.4, 3.0], [0.0; 3]), 64);
            let mut partly = 0;
            for _ in 0..2000 {
                let position = random.point([-1.0, -1.0, -0.9], [1.0, 1.0, -0.7]);
                let receiver = Receiver { position, ..Receiver::default() };
                let rays = setup.hidden_by_rays(&receiver);
                assert_eq!(setup.see(&receiver).hidden[0], rays, "{name} {shape_name} {position:?}");
                partly += usize::from(rays != 0 && rays != !0);
            }
            assert!(partly > 100, "{name} {shape_name}: {partly} receivers in the penumbra");
        }
    }
}

#[test]
fn samples_lie_where_rays_go() {
    let mut random = Random(4);
    for (name, shape) in shapes(1.0, 3.0) {
        let setup = Setup::new(Soup::new(), aimed(shape, [1.0, 0.7, 3.0], [0.1, 0.2, 0.0]), 256);
        let (mut worst, mut mirrored): (f64, f64) = (0.0, 0.0);
        for _ in 0..50 {
            let receiver = Receiver { position: random.point([-2.0; 3], [2.0, 2.0, 1.0]), ..Receiver::default() };
            let view = view_of(&setup, receiver.position);
            let p = DVec3::from(receiver.position.map(f64::from));
            let placed = view.place_samples(&setup.frame, &setup.samples);
            for (sample, target) in placed.iter().zip(setup.targets(&receiver)) {
                let way = match target {
                    Target::Point(s) => DVec3::from(s) - p,
                    Target::Direction(d) => DVec3::from(d),
                };
                let image = view.project(way.as_vec3());
                let at = (image.truncate() / image.z).as_dvec2();
                worst = worst.max((at - glam::DVec2::new(sample[0].into(), sample[1].into())).length());
                mirrored = mirrored.max((at - glam::DVec2::new(sample[0].into(), -f64::from(sample[1]))).length());
                // And the way to a sample is the way of the ray.
                let back = view.way_to(*sample).as_dvec3().normalize();
                assert!(back.distance(way.normalize()) < 1e-6, "{name}");
            }
        }
        assert!(worst < 4e-6, "{name}: {worst}");
        assert!(mirrored > 0.5, "{name}: a mirror is noticed");
    }
}

#[test]
fn lights_without_size_cast_the_shadow_of_a_point() {
    let mut random = Random(5);
    let mesh = leaves(&mut random, 60, 0.5, [-0.5, -0.5, 0.0], [0.5, 0.5, 1.5]);
    let point_like = [
        LightShape::Rectangle { width: 0.0, height: 0.0 },
        LightShape::Disc { radius: 0.0 },
        LightShape::Sphere { radius: 0.0 },
        LightShape::Sun { angular_diameter: 0.0 },
        LightShape::Rectangle { width: 0.0, height: 1.0 },
    ];
    for shape in point_like {
        let setup = Setup::new(mesh.clone(), aimed(shape.clone(), [0.3, 0.2, 3.0], [0.0; 3]), 64);
        let mut hidden = 0;
        for _ in 0..3000 {
            let position = random.point([-1.0, -1.0, -0.9], [1.0, 1.0, -0.2]);
            let receiver = Receiver { position, ..Receiver::default() };
            let edges = setup.see(&receiver);
            assert_eq!(edges.hidden[0], setup.hidden_by_rays(&receiver), "{shape:?} {position:?}");
            hidden += edges.hidden[0].count_ones();
        }
        assert!(hidden > 10_000, "{shape:?}: {hidden} hidden");
    }
}

#[test]
fn behind_a_light_is_dark_and_inside_a_ball_is_bright() {
    let square = Setup::new(Soup::new(), aimed(square(1.0), [0.0, 0.0, 3.0], [0.0; 3]), 64);
    for z in [3.0, 3.5] {
        let seen = square.see(&Receiver { position: [0.1, 0.2, z], ..Receiver::default() });
        assert_eq!((seen.hidden, seen.visibility()), ([!0], 0.0));
    }
    let ball = Setup::new(Soup::new(), aimed(LightShape::Sphere { radius: 0.5 }, [0.0, 0.0, 3.0], [0.0; 3]), 64);
    let seen = ball.see(&Receiver { position: [0.1, 0.2, 3.1], ..Receiver::default() });
    assert_eq!((seen.hidden, seen.visibility()), ([0], 1.0));
}
