//! Silhouette edges on the device against shadow rays on the device: the same samples, the same bits; and areas against closed forms.

use softshadow::{
    Coverage, DepthComplexity, Light, LightShape, LightTexture, OccluderUnit, Options, Receivers, Scene, Silhouettes,
    Technique, Visibility, look_at, measure, visibility,
};

use crate::common::{Random, context, lamp, on_driver, points, ray_traced, rectangle, see, shipped, surface_points};
use crate::shapes::{Point, Triangle, plate, quad, scene, sphere, torus};

fn folded(samples: u32) -> DepthComplexity {
    DepthComplexity { samples, exact_area: false, unit: OccluderUnit::Edges, ..DepthComplexity::default() }
}

/// Samples in which edges and rays differ, and samples that are hidden.
fn against_rays(scene: &Scene, lights: &[Light], receivers: &Receivers, samples: u32) -> (Visibility, u32, u32) {
    let rays = see(scene, lights, receivers, &ray_traced(samples));
    let edges = see(scene, lights, receivers, &Technique::DepthComplexity(folded(samples)));
    let (a, b) = (&rays.masks.as_ref().unwrap().bits, &edges.masks.as_ref().unwrap().bits);
    // Bits past the last sample mean nothing.
    let used = |at: usize| {
        let left = samples - 32 * (at as u32 % samples.div_ceil(32));
        if left >= 32 { !0 } else { !(!0u32 << left) }
    };
    let differ = a.iter().zip(b).enumerate().map(|(at, (x, y))| ((x ^ y) & used(at)).count_ones()).sum();
    let hidden = a.iter().enumerate().map(|(at, x)| (x & used(at)).count_ones()).sum();
    (edges, differ, hidden)
}

#[test]
fn shipped_scenes_have_the_bits_of_rays() {
    for name in ["fork", "cards", "toruses", "hall"] {
        let (scene, light, camera) = shipped(name, [160, 120]);
        let (edges, differ, hidden) = against_rays(&scene, &[light], &Receivers::Camera(camera), 64);
        println!(
            "{name}: {differ} of {} samples differ, {} edges in lists",
            160 * 120 * 64,
            edges.info.silhouette_edges
        );
        assert!(hidden > 100_000 && edges.info.silhouette_edges > 500, "{name}: {hidden}");
        assert!(differ <= 12, "{name}: {differ} samples differ, more than one in 10^5");
    }
}

/// A ring and a ball over each other, and every kind of light over them.
pub(crate) fn bodies() -> Scene {
    scene(&[torus(0.5, 0.2, 24, 12), sphere([0.1, 0.0, 0.6], 0.25, 2)].concat())
}

pub(crate) fn lights() -> Vec<Light> {
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
fn every_light_and_count_of_samples_has_the_bits_of_rays() {
    let scene = bodies();
    let floor = Random(6).points(3000, [-1.5, 1.5], [-1.5, 1.5], [-1.0, -0.4]);
    let (free, surface) = (points(floor.clone()), surface_points(floor, [0.0, 0.3, 0.9]));
    for light in lights() {
        for samples in [1, 16, 40, 64, 128, 256] {
            for receivers in [&free, &surface] {
                let (_, differ, hidden) = against_rays(&scene, std::slice::from_ref(&light), receivers, samples);
                assert!(hidden > 200 * samples, "{:?}: {hidden}", light.shape());
                assert!(differ <= samples / 64 + 1, "{:?}, {samples} samples: {differ} differ", light.shape());
            }
        }
    }
}

#[test]
fn tables_as_published_move_samples_near_edges() {
    let (scene, floor) = (bodies(), points(Random(62).points(4000, [-1.5, 1.5], [-1.5, 1.5], [-1.0, -0.4])));
    for light in &lights()[..3] {
        let masks = |coverage| {
            let technique = Technique::DepthComplexity(DepthComplexity { coverage, ..folded(64) });
            see(&scene, std::slice::from_ref(light), &floor, &technique).masks.unwrap().bits
        };
        let pairs = masks(Coverage::Exact).into_iter().zip(masks(Coverage::Table));
        let moved: u32 = pairs.map(|(a, b)| (a ^ b).count_ones()).sum();
        println!("{:?}: {moved} of {} samples move", light.shape(), 4000 * 64);
        // A cell spans a thirtieth of the light's width; a third of these receivers see an edge.
        assert!((20..4000 * 64 / 100).contains(&moved), "{:?}: {moved} samples move", light.shape());
    }
}

#[test]
fn silhouettes_of_one_point_are_fewer_and_wrong() {
    let scene = bodies();
    // A light as large as the bodies, near them: what is a silhouette depends on where on the light one stands.
    let light = [lamp(rectangle(1.6, 1.6), [0.3, 0.2, 1.6])];
    let floor = points(Random(61).points(4000, [-1.2, 1.2], [-1.2, 1.2], [-0.8, -0.4]));
    let rays = see(&scene, &light, &floor, &ray_traced(64));
    let rmse = |silhouettes| {
        let seen =
            see(&scene, &light, &floor, &Technique::DepthComplexity(DepthComplexity { silhouettes, ..folded(64) }));
        let squares = seen.values.iter().zip(&rays.values).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>();
        ((squares / seen.values.len() as f64).sqrt(), seen.info.silhouette_edges)
    };
    let [(accurate, all), (standard, few)] = [Silhouettes::Accurate, Silhouettes::Standard].map(rmse);
    println!("accurate: RMSE {accurate:.6} with {all} edges in lists; standard: {standard:.4} with {few}");
    assert!(accurate < 1e-4 && standard > 0.01 && few * 2 < all, "{accurate} {all} {standard} {few}");
}

/// The loop of edges around a body, as the light's reference point sees it, closes: however fine the mesh is, its shadow is that of a flat
/// body as wide as the loop.
#[test]
fn silhouettes_of_one_point_close_on_fine_meshes() {
    let light = [lamp(rectangle(1.6, 1.6), [0.0, 0.0, 1.7])];
    let floor = points((0..301).map(|k| [f64::from(k) * 0.008, f64::from(k) * 0.0008, -0.6]).collect());
    let standard = |subdivisions| {
        let silhouettes = Silhouettes::Standard;
        let technique = DepthComplexity { silhouettes, exact_area: false, ..folded(256) };
        see(&scene(&sphere([0.0; 3], 0.4, subdivisions)), &light, &floor, &Technique::DepthComplexity(technique)).values
    };
    let rays = see(&scene(&sphere([0.0; 3], 0.4, 4)), &light, &floor, &ray_traced(256)).values;
    let rmse = |a: &[f32], b: &[f32]| {
        let squares: f64 = a.iter().zip(b).map(|(a, b)| f64::from(a - b).powi(2)).sum();
        (squares / a.len() as f64).sqrt()
    };
    let [coarse, fine] = [3, 4].map(standard);
    let apart = [rmse(&coarse, &fine), rmse(&coarse, &rays), rmse(&fine, &rays)];
    println!(
        "standard silhouettes of a ball: coarse to fine {:.4}, to rays {:.4} and {:.4}",
        apart[0], apart[1], apart[2]
    );
    assert!(apart[0] < 0.01 && apart[2] < 0.08 && apart[2] > 0.005, "{apart:?}");
}

#[test]
fn lights_within_the_scene_cut_it() {
    let scene = scene(&[torus(0.6, 0.3, 24, 12), sphere([0.0, 0.0, 0.1], 0.3, 2)].concat());
    let light = lamp(rectangle(1.0, 1.0), [0.05, 0.03, 0.12]);
    let under = points(Random(7).points(4000, [-1.0, 1.0], [-1.0, 1.0], [-0.8, -0.1]));
    let (edges, differ, hidden) = against_rays(&scene, &[light], &under, 64);
    assert!(edges.info.cut_triangles > 50 && edges.info.triangles_behind > 50 && hidden > 100_000);
    assert_eq!(differ, 0);
}

#[test]
fn receivers_around_a_ball_of_light() {
    // One flat tile of points on both sides of the ball: the box of its shaft reaches beyond its receivers.
    let quads: Vec<Triangle> = (0..8)
        .flat_map(|i| {
            let (s, c) = (std::f64::consts::TAU * f64::from(i) / 8.0).sin_cos();
            let (x, y) = (2.0 * c, 2.0 * s);
            quad([x - 0.2, y - 0.2, 0.47], [x + 0.2, y - 0.2, 0.47], [x + 0.2, y + 0.2, 0.77], [x - 0.2, y + 0.2, 0.77])
        })
        .collect();
    let light = lamp(LightShape::Sphere { radius: 1.0 }, [0.0; 3]);
    let grid = (0..64).map(|i| [f64::from(i % 8) * 2.0 - 7.0, f64::from(i / 8) * 2.0 - 7.0, 0.3]).collect();
    let (edges, differ, hidden) = against_rays(&scene(&quads), &[light], &points(grid), 64);
    assert!(hidden > 100 && edges.info.silhouette_edges > 0, "{hidden}");
    assert!(differ <= 1, "{differ} samples differ");
}

#[test]
fn folds_that_a_driver_cuts_short_are_told() {
    let _driver = on_driver();
    // Points side by side, each with triangles of its own right before it: one list for all. It either fits, with the bits of rays, or
    // it is refused; never anything between.
    let mut random = Random(10);
    let mut refused = 0;
    // Far away, so that there is room for long lists.
    let far = random.points(4032, [30.0, 50.0], [30.0, 50.0], [0.0, 0.0]);
    for each in [50, 130, 260, 500, 800, 1200, 2000] {
        let mut soup = Vec::new();
        let receivers: Vec<Point> = (0..64).map(|i| [f64::from(i % 8) * 0.1, f64::from(i / 8) * 0.1, 0.0]).collect();
        for p in &receivers {
            for _ in 0..each {
                let at = random.point([-0.04, 0.04], [-0.04, 0.04], [0.05, 0.3]);
                let corner = |random: &mut Random| {
                    let off = random.point([-0.01, 0.01], [-0.01, 0.01], [-0.01, 0.01]);
                    [0, 1, 2].map(|k| p[k] + at[k] + off[k])
                };
                soup.push([corner(&mut random), corner(&mut random), corner(&mut random)]);
            }
        }
        let (scene, light) = (scene(&soup), lamp(rectangle(0.4, 0.4), [0.35, 0.35, 2.0]));
        let technique = Technique::DepthComplexity(folded(64));
        let options = Options { sample_masks: true, ..Options::default() };
        let lights = std::slice::from_ref(&light);
        let receivers = points([receivers, far.clone()].concat());
        match visibility(context(), &scene, lights, &receivers, &technique, &options, &mut |_, _| true) {
            Ok(seen) => {
                let rays = see(&scene, lights, &receivers, &ray_traced(64));
                let pairs = seen.masks.as_ref().unwrap().bits.iter().zip(&rays.masks.as_ref().unwrap().bits);
                let differ: u32 = pairs.map(|(a, b)| (a ^ b).count_ones()).sum();
                assert!(differ <= 1, "{each} triangles a point: {differ} samples differ");
            }
            Err(error) => {
                assert!(error.to_string().contains("use ray_traced"), "{error}");
                refused += 1;
            }
        }
    }
    println!("{refused} of 7 scenes refused");
    assert!((1..7).contains(&refused), "{refused} of 7 scenes are refused");
}

#[test]
fn areas_answer_without_noise() {
    // One plate: its shadow on the light is a rectangle, and no sample sees two layers.
    let occluder = plate([-0.3, 0.4], [-0.2, 0.25], 0.7);
    let (shade, light) = (scene(&occluder), lamp(rectangle(1.0, 0.8), [0.15, -0.1, 2.0]));
    let floor = Random(8).points(4000, [-1.0, 1.0], [-1.0, 1.0], [0.0, 0.0]);
    let seen = see(&shade, &[light], &points(floor.clone()), &Technique::DepthComplexity(DepthComplexity::default()));
    let exact =
        measure::RectangleLight::new([0.15, -0.1, 2.0], [0.5, 0.0, 0.0], [0.0, 0.4, 0.0], [0.0, 0.0, -1.0]).unwrap();
    let mut partly = 0;
    for (p, value) in floor.iter().zip(&seen.values) {
        let truth = measure::rectangle_visibility(&exact, &occluder, &measure::Receiver::at(*p)).unwrap();
        assert!((f64::from(*value) - truth).abs() < 1e-5, "{p:?}: {value} {truth}");
        partly += usize::from(truth > 0.0 && truth < 1.0);
    }
    assert!(partly > 500 && seen.info.area_receivers > partly as u64 / 2, "{partly} {:?}", seen.info.area_receivers);
    // However many samples, a receiver is answered once.
    let light = lamp(rectangle(1.0, 0.8), [0.15, -0.1, 2.0]);
    let fine = Technique::DepthComplexity(DepthComplexity { samples: 256, ..DepthComplexity::default() });
    let fine = see(&shade, &[light], &points(floor.clone()), &fine);
    assert!(fine.info.area_receivers.abs_diff(seen.info.area_receivers) < 400, "{}", fine.info.area_receivers);
    // Samples alone are far off.
    let light = lamp(rectangle(1.0, 0.8), [0.15, -0.1, 2.0]);
    let sampled = see(&shade, &[light], &points(floor), &Technique::DepthComplexity(folded(64)));
    let worst = sampled.values.iter().zip(&seen.values).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(worst > 0.03 && sampled.info.area_receivers == 0, "{worst}");
}

#[test]
fn textured_lights_and_progressive_passes_average_samples() {
    let (scene, texture) = (bodies(), LightTexture::new(2, 1, vec![[1.0, 0.0, 0.2], [0.0, 1.0, 0.2]]).unwrap());
    let light = lights()[0].clone().with_texture(texture).unwrap();
    let floor = points(Random(9).points(2000, [-1.5, 1.5], [-1.5, 1.5], [-1.0, -0.4]));
    let both = [lights()[1].clone(), light];
    let rays = see(&scene, &both, &floor, &ray_traced(64));
    let edges = see(&scene, &both, &floor, &Technique::DepthComplexity(DepthComplexity::default()));
    assert_eq!((edges.channels, edges.info.area_receivers), (3, 0));
    assert_eq!(rays.values, edges.values);
    let passes = |technique| see(&scene, &lights()[..1], &floor, &technique);
    let four = passes(Technique::DepthComplexity(DepthComplexity { passes: 4, ..folded(64) }));
    let rays = passes(Technique::RayTraced(softshadow::RayTraced { passes: 4, ..Default::default() }));
    assert_eq!((four.values, four.standard_error), (rays.values, rays.standard_error));
}

#[test]
fn an_empty_scene_is_lit() {
    let empty = Scene::new(Vec::new()).unwrap();
    let up = surface_points(vec![[0.0, 0.0, 0.0], [0.3, 0.1, 0.0]], [0.0, 0.0, 1.0]);
    let seen = see(&empty, &lights(), &up, &Technique::DepthComplexity(DepthComplexity::default()));
    assert!(seen.values.iter().all(|v| *v == 1.0), "{:?}", seen.values);
}
