//! `visibility_within`: bounds hold on scenes that nobody has tuned for, what is out of reach is said, and what is spoilt is seen.

use softshadow::measure::{ErrorNorm, ErrorReport, ReferenceImage, compare};
use softshadow::{
    Camera, Choice, Error, ErrorKind, Goal, Light, LightShape, Limit, Material, Mesh, Options, RayTraced, Receivers,
    SamplePattern, Scene, Technique, Visibility, look_at, visibility_within,
};

use crate::common::{Random, context, lamp, points, rectangle, see, shipped, surface_points};

/// A scene of a kind that its seed chooses: boxes, or leaves, over a ground; any light; any view from above.
fn held_back(seed: u64, size: [u32; 2]) -> (Scene, Light, Camera) {
    let mut random = Random(seed);
    let ground = vec![[-4.0, 0.0, -4.0], [4.0, 0.0, -4.0], [4.0, 0.0, 4.0], [-4.0, 0.0, 4.0]];
    let (mut corners, mut faces) = (ground, vec![[0, 1, 2], [0, 2, 3]]);
    let leaves = random.next() % 2 == 0;
    for _ in 0..if leaves { 300 } else { 12 } {
        let middle = random.point([-1.5, 1.5], [0.1, 1.5], [-1.5, 1.5]);
        let first = corners.len() as u32;
        if leaves {
            let corner = |random: &mut Random| random.point([-0.15, 0.15], [-0.1, 0.1], [-0.15, 0.15]);
            corners.extend((0..3).map(|_| corner(&mut random)).map(|d| [0, 1, 2].map(|k| middle[k] + d[k])));
            faces.push([first, first + 1, first + 2]);
        } else {
            let half = random.point([0.1, 0.4], [0.1, 0.4], [0.1, 0.4]);
            let sign = |bit: usize, k: usize| if bit >> k & 1 == 0 { -1.0 } else { 1.0 };
            corners.extend((0..8).map(|bit| [0, 1, 2].map(|k| middle[k] + sign(bit, k) * half[k])));
            let quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
            for [a, b, c, d] in quads.map(|quad: [u32; 4]| quad.map(|v| v + first)) {
                faces.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    let mesh = Mesh::new("held back", corners, faces, Material::default()).unwrap();
    let place = random.point([-1.5, 1.5], [3.0, 4.5], [-1.5, 1.5]);
    let span = random.within([0.3, 1.2]);
    let shape = match random.next() % 3 {
        0 => LightShape::Disc { radius: span / 2.0 },
        1 => LightShape::Sphere { radius: span / 2.0 },
        _ => LightShape::Rectangle { width: span, height: span / 2.0 },
    };
    let light = Light::new(shape, look_at(place, [0.0; 3], Some([1.0, 0.0, 0.0])).unwrap()).unwrap();
    let eye = random.point([2.0, 3.5], [1.5, 4.0], [2.0, 3.5]);
    (Scene::new(vec![mesh]).unwrap(), light, Camera::look_at(eye, [0.0, 0.3, 0.0], None, 45.0, size).unwrap())
}

fn within(scene: &Scene, light: &Light, receivers: &Receivers, goal: &Goal) -> Result<Visibility, Error> {
    let lights = std::slice::from_ref(light);
    visibility_within(context(), scene, lights, receivers, goal, &Options::default(), &mut |_, _| true)
}

/// Against many rays with samples of their own.
fn report(scene: &Scene, light: &Light, receivers: &Receivers, seen: &Visibility) -> ErrorReport {
    let settings =
        RayTraced { samples: 256, passes: 8, pattern: SamplePattern::LowDiscrepancy, seed: 77, ..RayTraced::default() };
    let truth = see(scene, std::slice::from_ref(light), receivers, &Technique::RayTraced(settings));
    let image = ReferenceImage { visibility: &truth.values, standard_error: None, width: None };
    compare(&seen.values, &image).unwrap()
}

fn choice(seen: &Visibility) -> &Choice {
    seen.info.choice.as_deref().unwrap()
}

#[test]
fn bounds_hold_on_scenes_that_nobody_has_tuned_for() {
    for seed in 9_000..9_006 {
        let (scene, light, camera) = held_back(seed, [96, 72]);
        let receivers = Receivers::Camera(camera);
        for (norm, bound) in [(ErrorNorm::Rmse, 0.05), (ErrorNorm::Rmse, 0.012), (ErrorNorm::P99, 0.08)] {
            let seen = within(&scene, &light, &receivers, &Goal::max_error(bound, norm)).unwrap();
            let (told, error) = (choice(&seen), norm.of(&report(&scene, &light, &receivers, &seen)));
            let found = told.error.unwrap();
            println!(
                "{seed} {norm} {bound}: {error:.4}, estimate {:.4}, upper {:.4}, {} {:?}, pilot {}, check {:.1} of {:.1} ms",
                found.estimate,
                found.upper.unwrap(),
                seen.info.technique.name(),
                seen.info.technique.samples(),
                told.pilot,
                told.check_ms,
                seen.info.wall_ms,
            );
            assert!(told.met && told.kind == ErrorKind::Statistical && seen.info.error_kind == "statistical");
            assert!(error <= bound, "{seed} {norm}: {error} for {bound}");
            assert!(found.upper.unwrap() <= bound && found.estimate <= found.upper.unwrap());
            assert!((found.estimate / error - 1.0).abs() < 0.35, "{seed} {norm}: {} for {error}", found.estimate);
        }
    }
}
