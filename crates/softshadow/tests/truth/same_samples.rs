//! Ray traced against the float64 tracer on the same triangles, receivers and samples: no sample may differ but grazing ones.

use softshadow::{Light, LightShape, RayTraced, Receivers, SamplePattern, Scene, Technique, UpAxis, look_at};

use crate::agreement::{Agreement, Truth};
use crate::common::{Random, rays, see, shipped, surface_points};
use crate::shapes::{Triangle, plate, scene};

fn compare(scene: &Scene, light: &Light, receivers: &Receivers, settings: &RayTraced) -> Agreement {
    let seen = see(scene, std::slice::from_ref(light), receivers, &Technique::RayTraced(settings.clone()));
    Truth::of(scene).compare(scene, light, settings, &seen)
}

/// No fault, few grazing samples, and enough of both light and shadow to mean something.
fn require(name: &str, found: Agreement) {
    let grazing = found.grazing as f64 / found.samples as f64;
    println!("same samples, {name:<26} {found:?}, grazing {:.4} %", 100.0 * grazing);
    assert_eq!(found.differing, 0, "{name}: {found:?}");
    assert!(grazing < 0.01, "{name}: {found:?}");
    assert!(found.hidden * 50 > found.samples && found.hidden < found.samples, "{name}: {found:?}");
}

#[test]
fn no_sample_of_a_million_differs_in_the_shipped_scenes() {
    let mut total = Agreement::default();
    for (name, pattern) in [
        ("hall", SamplePattern::Stratified),
        ("toruses", SamplePattern::LowDiscrepancy),
        ("cards", SamplePattern::Stratified),
        ("fork", SamplePattern::LowDiscrepancy),
    ] {
        let (scene, light, camera) = shipped(name, [96, 72]);
        let found = compare(&scene, &light, &Receivers::Camera(camera), &RayTraced { pattern, seed: 5, ..rays(64) });
        require(name, found);
        total += found;
    }
    println!("same samples, in all: {total:?}");
    assert!(total.samples >= 1_000_000, "{total:?}");
}

#[test]
fn no_sample_differs_for_any_shape_of_light() {
    let (scene, _, camera) = shipped("hall", [64, 40]);
    let pose = look_at([8.0, 8.0, 3.5], [0.0, 0.5, -1.0], None).unwrap();
    let star = vec![[0.0, -0.8], [0.2, -0.2], [0.8, 0.0], [0.2, 0.2], [0.0, 0.8], [-0.6, 0.3], [-0.1, -0.1]];
    for shape in [
        LightShape::Disc { radius: 0.6 },
        LightShape::Polygon { outline: star },
        LightShape::Sun { angular_diameter: 0.02 },
        LightShape::Sphere { radius: 0.7 },
    ] {
        let name = format!("{shape:?}").chars().take_while(|c| c.is_alphanumeric()).collect::<String>();
        let light = Light::new(shape, pose).unwrap();
        require(&name, compare(&scene, &light, &Receivers::Camera(camera), &rays(64)));
    }
    let low_sun = Light::sun(70.0, 8.0, 3.0, UpAxis::Y).unwrap();
    require("low sun", compare(&scene, &low_sun, &Receivers::Camera(camera), &rays(48)));
}

#[test]
fn no_sample_differs_in_contact() {
    // On the hall's floor at the feet of a column's base: from 0.3 m down to a tenth of a millimetre away.
    let (scene, light, _) = shipped("hall", [8, 8]);
    let mut random = Random(17);
    let at = |random: &mut Random| {
        let away = 10_f64.powf(random.within([-4.0, -0.5]));
        [-2.5 - 0.4 - away, 0.0, 2.6 * (random.next() % 5) as f64 - 5.2 + random.within([-0.4, 0.4])]
    };
    let positions = (0..3000).map(|_| at(&mut random)).collect();
    let receivers = surface_points(positions, [0.0, 1.0, 0.0]);
    require("contact", compare(&scene, &light, &receivers, &rays(64)));
}

#[test]
fn the_comparison_sees_a_moved_triangle_and_a_flipped_bit() {
    let mut triangles = plate([-1.0, 1.0], [-1.0, 1.0], 0.0);
    triangles.push([[-0.3, -0.2, 0.5], [0.4, -0.1, 0.6], [0.0, 0.35, 0.55]]);
    let scene = scene(&triangles);
    let light = crate::common::lamp(crate::common::rectangle(0.5, 0.5), [0.1, 0.2, 1.8]);
    let floor = Random(2).points(2000, [-0.7, 0.7], [-0.7, 0.7], [0.0, 0.0]);
    let receivers = surface_points(floor, [0.0, 0.0, 1.0]);
    let settings = rays(64);
    let mut seen = see(&scene, std::slice::from_ref(&light), &receivers, &Technique::RayTraced(settings.clone()));
    let honest = Truth::of(&scene).compare(&scene, &light, &settings, &seen);
    assert_eq!(honest.differing, 0, "{honest:?}");

    let raise = |t: &mut Triangle| t.iter_mut().for_each(|p| p[0] += 1e-3);
    let is_occluder = |t: &Triangle| t.iter().all(|p| p[2] > 0.0);
    let moved = Truth::with(&scene, |local| local.iter_mut().filter(|t| is_occluder(t)).for_each(raise));
    let found = moved.compare(&scene, &light, &settings, &seen);
    println!("same samples, triangle moved by 1e-3: {found:?}");
    assert!(found.differing > 10, "{found:?}");

    // The first receiver's word, every bit: grazing samples are few, so most of the 32 count.
    seen.masks.as_mut().unwrap().bits[0] ^= u32::MAX;
    let flipped = Truth::of(&scene).compare(&scene, &light, &settings, &seen);
    assert!((30..=32).contains(&flipped.differing), "{flipped:?}");
}
