//! Soups of triangles: `depth_complexity` triangle by triangle against edges and rays to the same samples.

use softshadow::{
    Camera, DepthComplexity, Error, Light, LightShape, OccluderUnit, Options, Receivers, Scene, Technique, Visibility,
    look_at, visibility,
};

use crate::agreement::Truth;
use crate::common::{Random, context, lamp, points, ray_traced, rays, rectangle, see, shipped, surface_points};
use crate::shapes::{Point, Triangle, scene, sphere, torus};

fn unit(samples: u32, unit: OccluderUnit) -> Technique {
    Technique::DepthComplexity(DepthComplexity { samples, exact_area: false, unit, ..DepthComplexity::default() })
}

/// In how many samples two results differ, and how many the first hides. Bits past the last sample mean nothing.
fn differences(a: &Visibility, b: &Visibility, samples: u32) -> (u32, u32) {
    let used = |at: usize| {
        let left = samples - 32 * (at as u32 % samples.div_ceil(32));
        if left >= 32 { !0 } else { !(!0u32 << left) }
    };
    let (a, b) = (&a.masks.as_ref().unwrap().bits, &b.masks.as_ref().unwrap().bits);
    let differ = a.iter().zip(b).enumerate().map(|(at, (x, y))| ((x ^ y) & used(at)).count_ones()).sum();
    (differ, a.iter().enumerate().map(|(at, x)| (x & used(at)).count_ones()).sum())
}

#[test]
fn triangles_and_edges_have_the_same_bits_on_shipped_scenes() {
    for name in ["fork", "cards", "toruses", "hall"] {
        let (scene, light, camera) = shipped(name, [160, 120]);
        let run = |technique| see(&scene, std::slice::from_ref(&light), &Receivers::Camera(camera), &technique);
        let (edges, triangles) = (run(unit(64, OccluderUnit::Edges)), run(unit(64, OccluderUnit::Triangles)));
        let (differ, hidden) = differences(&edges, &triangles, 64);
        let from_rays = differences(&run(ray_traced(64)), &triangles, 64).0;
        println!("{name}: {differ} samples differ from edges, {from_rays} from rays, {hidden} hidden");
        assert!(hidden > 100_000, "{name}: {hidden}");
        assert_eq!((edges.info.occluder_units, triangles.info.occluder_units), (vec!["edges"], vec!["triangles"]));
        assert!(triangles.info.silhouette_edges == 0 && edges.info.silhouette_edges > 0);
        assert_eq!(differ, 0, "{name}");
        assert!(from_rays <= 12, "{name}: {from_rays}");
    }
}

/// A ring and a ball over each other, and every kind of light over them.
fn bodies() -> Scene {
    scene(&[torus(0.5, 0.2, 24, 12), sphere([0.1, 0.0, 0.6], 0.25, 2)].concat())
}

fn lights() -> Vec<Light> {
    let pose = look_at([0.5, 0.4, 3.0], [0.0; 3], None).unwrap();
    let bracket = [[-0.5, -0.5], [0.6, -0.5], [0.6, -0.15], [-0.1, -0.15], [-0.1, 0.45], [-0.5, 0.45]];
    [
        rectangle(1.0, 0.6),
        LightShape::Disc { radius: 0.5 },
        LightShape::Polygon { outline: bracket.to_vec() },
        LightShape::Sphere { radius: 0.5 },
        LightShape::Sun { angular_diameter: 0.3 },
        rectangle(0.0, 0.0),
    ]
    .map(|shape| Light::new(shape, pose).unwrap())
    .to_vec()
}

#[test]
fn every_light_and_count_of_samples_has_the_bits_of_edges() {
    let scene = bodies();
    let floor = Random(6).points(3000, [-1.5, 1.5], [-1.5, 1.5], [-1.0, -0.4]);
    let (free, surface) = (points(floor.clone()), surface_points(floor, [0.0, 0.3, 0.9]));
    for light in lights() {
        for samples in [1, 16, 40, 64, 128, 256] {
            for receivers in [&free, &surface] {
                let run = |kind| see(&scene, std::slice::from_ref(&light), receivers, &unit(samples, kind));
                let (edges, triangles) = (run(OccluderUnit::Edges), run(OccluderUnit::Triangles));
                let (differ, hidden) = differences(&edges, &triangles, samples);
                assert!(hidden > 200 * samples, "{:?}: {hidden}", light.shape());
                assert_eq!(differ, 0, "{:?}, {samples} samples", light.shape());
            }
        }
    }
}

/// Leaves of two triangles each, anyhow in a ball of radius 0.8 around the origin.
fn leaves(count: usize) -> Vec<Triangle> {
    let mut random = Random(21);
    let mut soup = Vec::new();
    while soup.len() < 2 * count {
        let [x, y, z] = random.point([-0.8, 0.8], [-0.8, 0.8], [-0.8, 0.8]);
        if x * x + y * y + z * z > 0.64 {
            continue;
        }
        let way = |random: &mut Random| random.point([-0.05, 0.05], [-0.05, 0.05], [-0.05, 0.05]);
        let (u, v) = (way(&mut random), way(&mut random));
        let corner = |a: f64, b: f64| [x + a * u[0] + b * v[0], y + a * u[1] + b * v[1], z + a * u[2] + b * v[2]];
        soup.push([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0)]);
        soup.push([corner(-1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
    }
    soup
}

#[test]
fn a_soup_of_leaves_has_the_samples_of_rays_and_of_float64() {
    let soup = scene(&leaves(1500));
    // Under the leaves, and among them.
    let under = Random(22).points(400, [-1.5, 1.5], [-1.5, 1.5], [-1.2, -0.9]);
    let among = Random(23).points(400, [-0.6, 0.6], [-0.6, 0.6], [-0.6, 0.6]);
    let receivers = surface_points([under, among].concat(), [0.1, 0.2, 0.9]);
    let (mut differ, mut all) = (0, 0);
    for light in &lights()[..5] {
        for samples in [40, 64, 256] {
            let lights = std::slice::from_ref(light);
            let seen = see(&soup, lights, &receivers, &unit(samples, OccluderUnit::Auto));
            assert_eq!(seen.info.occluder_units, ["triangles"]);
            let (from_rays, hidden) =
                differences(&see(&soup, lights, &receivers, &ray_traced(samples)), &seen, samples);
            assert!(hidden > 200 * samples && hidden < 700 * samples, "{hidden}");
            if samples == 64 {
                let found = Truth::of(&soup).compare(&soup, light, &rays(samples), &seen);
                assert_eq!(found.differing, 0, "{:?}: {found:?}", light.shape());
            }
            (differ, all) = (differ + from_rays, all + 800 * samples);
        }
    }
    println!("leaves: {differ} of {all} samples differ from rays");
    assert!(differ <= all / 100_000, "{differ} of {all}");
}

#[test]
fn the_comparison_sees_a_leaf_that_moved() {
    let soup = scene(&leaves(1500));
    let receivers = points(Random(22).points(400, [-1.5, 1.5], [-1.5, 1.5], [-1.2, -0.9]));
    let light = &lights()[0];
    let seen = see(&soup, std::slice::from_ref(light), &receivers, &unit(64, OccluderUnit::Triangles));
    let moved = Truth::with(&soup, |local| local[0].iter_mut().for_each(|p| p[0] += 0.01));
    let found = moved.compare(&soup, light, &rays(64), &seen);
    assert!(found.differing > 0, "{found:?}");
}

#[test]
fn foliage_is_folded_triangle_by_triangle() {
    let (canopy, _, _) = shipped("canopy", [8, 8]);
    let light = Light::new(rectangle(2.0, 2.0), look_at([0.0, 5.0, 0.0], [0.0; 3], None).unwrap()).unwrap();
    let camera = Camera::look_at([2.6, 2.4, 3.6], [0.0, 0.85, 0.0], None, 40.0, [64, 64]).unwrap();
    let (lights, receivers) = (std::slice::from_ref(&light), Receivers::Camera(camera));
    let seen = see(&canopy, lights, &receivers, &Technique::DepthComplexity(DepthComplexity::default()));
    assert_eq!((seen.info.occluder_units.as_slice(), seen.info.area_receivers), (&["triangles"][..], 0));
    assert!(seen.info.plan.contains("cover triangles") && !seen.info.plan.contains("silhouettes"));
    let (differ, hidden) = differences(&see(&canopy, lights, &receivers, &ray_traced(64)), &seen, 64);
    println!("canopy: {differ} of {} samples differ from rays", 64 * 64 * 64);
    assert!(hidden > 50_000 && differ <= 2, "{differ} of {hidden}");
    // Edges are refused, with the way out.
    let edges = unit(64, OccluderUnit::Edges);
    let options = Options::default();
    let refused = visibility(context(), &canopy, lights, &receivers, &edges, &options, &mut |_, _| true).unwrap_err();
    let says = |words: &str| matches!(&refused, Error::Gpu(text) if text.contains(words));
    assert!(says("unit triangles") && says("use ray_traced"), "{refused}");
}

#[test]
fn bodies_are_folded_edge_by_edge() {
    for (scene, expected) in [(bodies(), "edges"), (scene(&leaves(200)), "edges"), (scene(&leaves(500)), "triangles")] {
        let technique = Technique::DepthComplexity(DepthComplexity { samples: 1, ..DepthComplexity::default() });
        let seen = see(&scene, &lights()[..1], &points(vec![[0.0, 0.0, -5.0]]), &technique);
        assert_eq!(seen.info.occluder_units, [expected]);
    }
}

#[test]
fn triangles_that_touch_a_lamp_are_tried_sample_by_sample() {
    // The lamp sits in the ring and in the ball over it.
    let light = lamp(LightShape::Sphere { radius: 0.4 }, [0.2, 0.1, 0.3]);
    let lights = std::slice::from_ref(&light);
    let scene = scene(&[torus(0.5, 0.2, 10, 6), sphere([0.1, 0.0, 0.6], 0.25, 0)].concat());
    let grid = |place: fn(f64, f64) -> Point| -> Vec<Point> {
        (0..48 * 48).map(|i| place(f64::from(i % 48) * 0.05 - 1.2, f64::from(i / 48) * 0.05 - 1.2)).collect()
    };
    for (positions, normal) in
        [(grid(|x, y| [x, y, -0.9]), [0.1, 0.3, 0.9]), (grid(|y, z| [1.1, y, z]), [-0.9, 0.2, -0.1])]
    {
        let receivers = surface_points(positions, normal);
        for samples in [1, 40, 64, 256] {
            let traced = see(&scene, lights, &receivers, &ray_traced(samples));
            for kind in [OccluderUnit::Edges, OccluderUnit::Triangles] {
                let seen = see(&scene, lights, &receivers, &unit(samples, kind));
                assert!(seen.info.touching_triangles > 20 && seen.info.plan.contains("try touching triangles"));
                let (differ, hidden) = differences(&traced, &seen, samples);
                assert!(hidden > 200 * samples, "{hidden}");
                assert!(differ <= samples / 64, "{kind:?}, {samples} samples: {differ} of {hidden} differ");
                if samples != 64 {
                    continue;
                }
                let honest = Truth::of(&scene);
                let found = honest.compare(&scene, &light, &rays(samples), &seen);
                assert_eq!(found.differing, 0, "{kind:?}: {found:?}");
                // Without those that touch, samples differ.
                let frame = &honest.local.frame;
                let [center, border] = [0.2, 0.6].map(|x| frame.local_from_world([x, 0.1, 0.3]));
                let touches = |t: &Triangle| t.iter().any(|p| center.distance((*p).into()) < center.distance(border));
                let away = |t: &mut Triangle| t.iter_mut().for_each(|p| p[2] -= 1e3);
                let bare = Truth::with(&scene, |local| local.iter_mut().filter(|t| touches(t)).for_each(away));
                let found = bare.compare(&scene, &light, &rays(samples), &seen);
                assert!(found.differing > 100, "{kind:?}: {found:?}");
            }
        }
    }
}
