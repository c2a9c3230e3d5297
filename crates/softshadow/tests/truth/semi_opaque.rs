//! Semi-opaque occluders: products of what passes each triangle, in closed form, and what results make of them.

use softshadow::{
    Attenuation, Camera, DepthComplexity, Error, Evaluation, Light, LightShape, LightTexture, Material, Mesh, Options,
    PictureOptions, SampleSpread, Scene, Shading, Technique, look_at, render, visibility,
};

use crate::common::{
    Random, bits, context, hard_shadow_map, lamp, on_driver, points, ray_traced, rays, rectangle, see,
};
use crate::shapes::{Point, Triangle, cuboid, plate, scene, sphere, torus};

/// What a unit of attenuation, rounded, can cost of what passes one layer; and what float32 does besides.
pub(crate) const BY_LAYER: f64 = 8.5e-5;
pub(crate) const FLOAT32: f64 = 1e-6;

/// The same triangles with an opacity each.
pub(crate) fn with(triangles: &[Triangle], opacity: impl Fn(usize) -> f32) -> Scene {
    let mesh = scene(triangles).meshes()[0].clone();
    let opacities = (0..triangles.len()).map(opacity).collect();
    Scene::new(vec![mesh.with_opacities(opacities).unwrap()]).unwrap()
}

pub(crate) fn edges(samples: u32) -> Technique {
    Technique::DepthComplexity(DepthComplexity { samples, ..DepthComplexity::default() })
}

fn summed(samples: u32) -> Technique {
    let attenuation = Attenuation::Sum;
    Technique::DepthComplexity(DepthComplexity { samples, attenuation, ..DepthComplexity::default() })
}

/// One sample a receiver, so that every sample's own share is told.
pub(crate) fn sampled(technique: &str, seed: u32) -> Technique {
    match technique {
        "ray_traced" => Technique::RayTraced(softshadow::RayTraced { seed, ..rays(1) }),
        _ => Technique::DepthComplexity(DepthComplexity { samples: 1, seed, ..DepthComplexity::default() }),
    }
}

/// Every kind of light, looking down on the origin.
pub(crate) fn lights() -> Vec<Light> {
    let pose = look_at([0.5, 0.4, 3.0], [0.0; 3], None).unwrap();
    let bracket = [[-0.5, -0.5], [0.6, -0.5], [0.6, -0.15], [-0.1, -0.15], [-0.1, 0.45], [-0.5, 0.45]];
    [
        rectangle(1.0, 0.6),
        LightShape::Disc { radius: 0.5 },
        LightShape::Polygon { outline: bracket.to_vec() },
        LightShape::Sphere { radius: 0.5 },
        LightShape::Sun { angular_diameter: 0.3 },
    ]
    .map(|shape| Light::new(shape, pose).unwrap())
    .to_vec()
}

/// Opaque and semi-opaque triangles in turn.
pub(crate) fn mixed(triangle: usize) -> f32 {
    [0.5, 1.0, 0.25, 0.9, 0.0, 0.5, 0.75][triangle % 7]
}

/// Leaves at random, apart from each other.
fn leaves(random: &mut Random, count: usize, size: f64) -> Vec<Triangle> {
    let leaf = |random: &mut Random| {
        let at = random.point([-0.5, 0.5], [-0.5, 0.5], [-0.4, 0.8]);
        let mut corner = || {
            let off = random.point([-size, size], [-size, size], [-size, size]);
            [0, 1, 2].map(|k| at[k] + off[k])
        };
        [corner(), corner(), corner()]
    };
    (0..count).map(|_| leaf(random)).collect()
}

/// A ring and a ball, wound and shared as bodies are; and leaves.
pub(crate) fn soups() -> [(&'static str, Vec<Triangle>); 2] {
    let bodies = [torus(0.5, 0.2, 24, 12), sphere([0.1, 0.0, 0.6], 0.25, 2)].concat();
    [("bodies", bodies), ("leaves", leaves(&mut Random(41), 120, 0.2))]
}

#[test]
fn what_passes_a_stack_is_the_product_of_what_passes_each_sheet() {
    let opacities = [0.5_f32, 0.1, 0.875, 0.3, 0.02, 0.6, 0.45, 0.2];
    let under = Random(50).points(200, [-0.3, 0.3], [-0.3, 0.3], [-1.0, -0.5]);
    for count in 1..=opacities.len() {
        let stack: Vec<Triangle> =
            (0..count).flat_map(|sheet| plate([-4.0, 4.0], [-4.0, 4.0], 0.1 * sheet as f64)).collect();
        let shade = with(&stack, |triangle| opacities[triangle / 2]);
        let expected: f64 = opacities[..count].iter().map(|o| 1.0 - f64::from(*o)).product();
        let layers = count as f64;
        for (technique, bound) in [(ray_traced(16), FLOAT32), (edges(16), FLOAT32 + BY_LAYER)] {
            let seen = see(&shade, &lights(), &points(under.clone()), &technique);
            let off = |v: &f32| (f64::from(*v) - expected).abs() / expected / layers;
            let worst = seen.values.iter().map(off).fold(0.0, f64::max);
            println!("{count} sheets, {}: off by {worst:.1e} of it a sheet", technique.name());
            assert!(worst <= bound, "{count} sheets, {}: {worst:e}", technique.name());
            assert!(seen.standard_error.unwrap().iter().all(|e| *e < 1e-6), "all samples agree");
            assert!(seen.masks.unwrap().visible(16).iter().all(|visible| *visible), "something passes");
        }
    }
}

#[test]
fn a_closed_box_is_crossed_twice() {
    let under = points(vec![[0.05, 0.02, 0.0], [-0.1, 0.03, -0.2]]);
    let hall = |opacity| with(&cuboid([-2.0, -2.0, 0.3], [2.0, 2.0, 0.6]), move |_| opacity);
    for technique in [ray_traced(64), edges(64)] {
        for light in
            [lamp(rectangle(0.5, 0.5), [0.0, 0.0, 3.0]), lamp(LightShape::Sphere { radius: 0.3 }, [0.0, 0.0, 3.0])]
        {
            let values = |opacity| see(&hall(opacity), std::slice::from_ref(&light), &under, &technique).values;
            assert_eq!(values(0.5), [0.25; 2], "{}", technique.name());
            assert_eq!(values(1.0), [0.0; 2]);
            assert_eq!(values(0.0), [1.0; 2]);
        }
    }
}

#[test]
fn a_sheet_that_hides_a_part_takes_its_share_of_that_part() {
    // Any single layer: what passes is 1 less its opacity times what an opaque one hides of the same samples.
    let sheet = [plate([-0.3, 0.4], [-0.2, 0.25], 0.7), plate([-0.9, -0.5], [-0.4, 0.6], 0.7)].concat();
    let floor = points(Random(51).points(2000, [-1.0, 1.0], [-1.0, 1.0], [0.0, 0.0]));
    for light in lights() {
        let light = std::slice::from_ref(&light);
        for samples in [16, 64, 200] {
            let opaque = see(&scene(&sheet), light, &floor, &ray_traced(samples));
            for technique in [ray_traced(samples), edges(samples), summed(samples)] {
                let seen = see(&with(&sheet, |_| 0.625), light, &floor, &technique);
                let off = |(v, o): (&f32, &f32)| (f64::from(*v) - (1.0 - 0.625 * (1.0 - f64::from(*o)))).abs();
                let wrong = seen.values.iter().zip(&opaque.values).filter(|pair| off(*pair) > 1e-4).count();
                assert!(wrong <= 1, "{:?}, {samples}, {}: {wrong}", light[0].shape(), technique.name());
            }
            assert!(opaque.values.iter().filter(|v| **v > 0.1 && **v < 0.9).count() > 100);
        }
    }
}

#[test]
fn an_edge_between_two_opacities_feeds_both() {
    // One plate in two halves: seen through either, or past both; and a step between two opacities that cull might take for flat.
    let halves = [plate([-0.6, 0.0], [-0.6, 0.6], 0.5), plate([0.0, 0.6], [-0.6, 0.6], 0.5)].concat();
    let light = lamp(rectangle(0.01, 0.01), [0.0, 0.0, 4.0]);
    let row: Vec<Point> = (0..64).map(|i| [f64::from(i) / 32.0 - 0.99, 0.02, 0.0]).collect();
    for [left, right] in [[1.0, 0.5], [0.5, 1.0], [0.25, 0.75], [0.5, 0.5], [0.0, 0.5]] {
        let shade = with(&halves, |triangle| if triangle < 2 { left } else { right });
        for technique in [ray_traced(64), edges(64)] {
            let seen = see(&shade, std::slice::from_ref(&light), &points(row.clone()), &technique);
            for (p, value) in row.iter().zip(&seen.values) {
                let x = p[0] * 3.5 / 4.0;
                let expected = if x.abs() > 0.6 { 1.0 } else { 1.0 - if x < 0.0 { left } else { right } };
                let is_near_a_border = [-0.6, 0.0, 0.6].iter().any(|b: &f64| (b - x).abs() < 2e-3);
                assert!(is_near_a_border || (value - expected).abs() < 1e-4, "{p:?}: {value} {expected}");
            }
        }
    }
}

#[test]
fn added_opacities_are_right_for_one_sheet_and_too_dark_for_two() {
    let light = [lamp(rectangle(0.5, 0.5), [0.0, 0.0, 3.0])];
    let under = points(vec![[0.05, 0.05, -0.5]]);
    let sheets = |opacities: &[f32]| {
        let stack: Vec<Triangle> =
            (0..opacities.len()).flat_map(|i| plate([-2.0, 2.0], [-2.0, 2.0], 0.2 * i as f64)).collect();
        with(&stack, |triangle| opacities[triangle / 2])
    };
    let value = |opacities: &[f32], technique: &Technique| see(&sheets(opacities), &light, &under, technique).values[0];
    for opacity in [0.1, 0.5, 0.9] {
        assert!((value(&[opacity], &summed(64)) - value(&[opacity], &edges(64))).abs() < 1e-4, "{opacity}");
    }
    assert_eq!([value(&[0.5, 0.5], &edges(64)), value(&[0.5, 0.5], &summed(64))], [0.25, 0.0]);
    assert_eq!(value(&[0.25, 0.25, 0.25], &summed(64)), 0.25);
    // More than everything is everything, and an opaque sheet hides all under either rule.
    assert_eq!(value(&[0.75, 0.75, 0.75], &summed(64)), 0.0);
    assert_eq!([value(&[0.5, 1.0], &summed(64)), value(&[0.5, 1.0], &edges(64))], [0.0; 2]);
}

#[test]
fn masks_mark_samples_to_which_nothing_passes() {
    let light = [lamp(rectangle(0.5, 0.5), [0.0, 0.0, 3.0])];
    let floor = points(Random(54).points(500, [-0.8, 0.8], [-0.8, 0.8], [0.0, 0.0]));
    let bodies = [sphere([0.0, 0.0, 0.8], 0.3, 2), plate([-2.0, 2.0], [-2.0, 2.0], 1.2)].concat();
    let glass = bodies.len() - 2;
    let opaque = scene(&bodies[..glass]);
    for technique in [ray_traced(64), edges(64)] {
        // Behind glass the bits are those of what is opaque, and values half of them.
        let (seen, bare) =
            (with(&bodies, |t| if t < glass { 1.0 } else { 0.5 }), see(&opaque, &light, &floor, &ray_traced(64)));
        let seen = see(&seen, &light, &floor, &technique);
        let differ: u32 = bits(&seen).1.iter().zip(&bits(&bare).1).map(|(a, b)| (a ^ b).count_ones()).sum();
        assert!(differ <= 2, "{}: {differ}", technique.name());
        let off = seen.values.iter().zip(&bare.values).map(|(s, b)| (s - b / 2.0).abs()).fold(0.0, f32::max);
        assert!(off < 2.0 / 64.0, "{off}");
        let all_glass = see(&with(&bodies, |_| 0.5), &light, &floor, &technique);
        assert!(all_glass.masks.unwrap().visible(64).iter().all(|visible| *visible));
    }
    let dark = see(&with(&bodies, |_| 0.5), &light, &floor, &summed(64));
    assert!(dark.masks.unwrap().visible(64).iter().any(|visible| !visible), "sums hide all");
}

#[test]
fn textures_passes_and_probes_go_through_glass() {
    let shade = with(&soups()[0].1, mixed);
    let floor = points(Random(55).points(1000, [-1.5, 1.5], [-1.5, 1.5], [-1.0, -0.4]));
    let texture = LightTexture::new(2, 1, vec![[1.0, 0.0, 0.2], [0.0, 1.0, 0.2]]).unwrap();
    let both = [lights()[1].clone(), lights()[0].clone().with_texture(texture).unwrap()];
    let (a, b) = (see(&shade, &both, &floor, &ray_traced(64)), see(&shade, &both, &floor, &edges(64)));
    assert_eq!((a.channels, b.channels), (3, 3));
    let close = |a: &[f32], b: &[f32], bound: f32| {
        let wrong = a.iter().zip(b).filter(|(a, b)| (*a - *b).abs() > bound).count();
        assert!(wrong <= 3, "{wrong} of {} differ", a.len());
    };
    close(&a.values, &b.values, 1e-3);
    close(a.standard_error.as_ref().unwrap(), b.standard_error.as_ref().unwrap(), 1e-3);
    let coloured = a.values[3000..].chunks_exact(3).filter(|v| (v[0] - v[1]).abs() > 0.05).count();
    assert!(coloured > 100, "{coloured} receivers see coloured light");
    // Several passes are the mean of several runs.
    let one = |seed| see(&shade, &both[..1], &floor, &sampled("depth_complexity", seed)).values;
    let technique = DepthComplexity { samples: 1, passes: 3, ..DepthComplexity::default() };
    let three = see(&shade, &both[..1], &floor, &Technique::DepthComplexity(technique));
    let runs: Vec<Vec<f32>> = (0..3).map(|pass| one(softshadow_scene::pass_seed(0, pass))).collect();
    let mean: Vec<f32> = (0..1000).map(|i| runs.iter().map(|run| run[i]).sum::<f32>() / 3.0).collect();
    close(&mean, &three.values, 1e-5);
    // Probes that all see the same speak for all.
    let probed = Technique::RayTraced(softshadow::RayTraced { probes: 16, ..rays(64) });
    let probed = see(&shade, &both[..1], &floor, &probed);
    let full = see(&shade, &both[..1], &floor, &ray_traced(64));
    let changed = probed.values.iter().zip(&full.values).filter(|(a, b)| (*a - *b).abs() > 1e-6).count();
    assert!(changed < 100, "{changed} of 1000 receivers were decided by probes wrongly");
}

#[test]
fn blocks_and_the_order_of_triangles_change_no_bit() {
    let (_, soup) = &soups()[1];
    let floor = points(Random(59).points(3000, [-1.2, 1.2], [-1.2, 1.2], [-1.0, -0.5]));
    let light = &lights()[..1];
    let turned: Vec<Triangle> = soup.iter().rev().map(|[a, b, c]| [*c, *a, *b]).collect();
    for technique in [ray_traced(64), edges(64)] {
        let run = |shade: &Scene, memory_limit_bytes| {
            let options = Options { memory_limit_bytes, sample_masks: true, ..Options::default() };
            visibility(context(), shade, light, &floor, &technique, &options, &mut |_, _| true).unwrap()
        };
        let (whole, cut) = (run(&with(soup, mixed), 1 << 30), run(&with(soup, mixed), 1 << 18));
        assert!(cut.info.blocks > 4 && whole.info.blocks == 1, "{}", cut.info.blocks);
        assert_eq!(bits(&whole), bits(&cut), "{}", technique.name());
        let reversed = run(&with(&turned, |triangle| mixed(soup.len() - 1 - triangle)), 1 << 30);
        assert_eq!(bits(&whole), bits(&reversed), "{}", technique.name());
    }
}

#[test]
fn pictures_are_lit_through_glass() {
    // A camera under a sheet that all light passes: every colour is that share of what it is without.
    let floor = plate([-1.0, 1.0], [-1.0, 1.0], 0.0);
    let all = [floor.clone(), plate([-8.0, 8.0], [-8.0, 8.0], 2.0)].concat();
    let camera = Camera::look_at([0.0, -1.5, 1.0], [0.0; 3], Some([0.0, 0.0, 1.0]), 45.0, [32, 24]).unwrap();
    let light = lamp(rectangle(1.0, 1.0), [0.0, 0.0, 3.0]);
    let probed = Technique::RayTraced(softshadow::RayTraced { probes: 16, ..rays(64) });
    let spread = [SampleSpread::Decorrelated, SampleSpread::Interleaved].into_iter().flat_map(|spread| {
        [
            Technique::RayTraced(softshadow::RayTraced { spread, ..rays(16) }),
            Technique::DepthComplexity(DepthComplexity { samples: 16, spread, ..DepthComplexity::default() }),
        ]
    });
    for technique in [ray_traced(64), probed, edges(64)].into_iter().chain(spread) {
        for shading in [Shading::Integrated, Shading::Modulated] {
            let options = PictureOptions { shading, ..PictureOptions::default() };
            let picture = |scene: &Scene| {
                let light = std::slice::from_ref(&light);
                render(context(), scene, light, &camera, &technique, &options, &mut |_, _| true).unwrap().linear
            };
            let (bare, through) = (picture(&scene(&floor)), picture(&with(&all, |t| if t < 2 { 1.0 } else { 0.75 })));
            let mut lit = 0;
            for (bare, through) in bare.iter().flatten().zip(through.iter().flatten()) {
                assert!((bare * 0.25 - through).abs() <= 1e-5 * bare, "{}: {bare} {through}", technique.name());
                lit += usize::from(*bare > 0.0);
            }
            assert!(lit > 1000, "{lit}");
        }
    }
}

#[test]
fn more_attenuation_than_sums_hold_is_told() {
    // 2^27 units at 24 halvings a sheet are 1,365 sheets; with a small plate, so that something is folded, and without.
    let stack = |sheets: usize, folds: bool| {
        let mut all: Vec<Triangle> =
            (0..sheets).flat_map(|i| plate([-9.0, 9.0], [-9.0, 9.0], 0.5 + 1e-4 * i as f64)).collect();
        all.extend(plate([-0.02, 0.02], [-0.03, 0.03], 0.4).into_iter().filter(|_| folds));
        with(&all, |_| 0.999_999_94)
    };
    let light = [lamp(rectangle(0.5, 0.5), [0.0, 0.0, 3.0])];
    let mut under = Random(56).points(64, [-0.1, 0.1], [-0.1, 0.1], [0.0, 0.0]);
    // Far away, so that there is room for long lists.
    under.extend(Random(57).points(2496, [30.0, 50.0], [30.0, 50.0], [0.0, 0.0]));
    let under = points(under);
    for folds in [true, false] {
        let run = |sheets| {
            let shade = stack(sheets, folds);
            visibility(context(), &shade, &light, &under, &edges(64), &Options::default(), &mut |_, _| true)
        };
        let fits = run(1200).unwrap();
        assert_eq!(fits.values[..64], [0.0; 64]);
        assert!(!folds || fits.info.silhouette_edges > 0);
        let error = run(1500).unwrap_err();
        let words = error.to_string();
        assert!(matches!(error, Error::Gpu(_)), "{words}");
        assert!(words.contains("semi-opaque layers") && words.contains("use ray_traced"), "{words}");
    }
}

#[test]
fn more_attenuation_at_edges_than_sums_hold_is_told() {
    // Triangles many times over, beside the way to the light's reference point: nothing of them is counted there, all of it at their edges.
    let blade = |x: f64| [[x, -0.5, 0.8], [x + 0.08, -0.5, 0.8], [x, 0.5, 0.8]];
    let copies = |triangles: &[Triangle], copies: usize, opacity: f32| {
        let all: Vec<Triangle> = triangles.iter().flat_map(|t| vec![*t; copies]).collect();
        with(&all, move |_| opacity)
    };
    let light = [lamp(rectangle(1.0, 1.0), [0.0, 0.0, 3.0])];
    let under = points(Random(58).points(64, [-0.02, 0.02], [-0.02, 0.02], [0.0, 0.0]));
    let run =
        |shade: &Scene| visibility(context(), shade, &light, &under, &edges(64), &Options::default(), &mut |_, _| true);
    let three = [blade(0.05), blade(0.08), blade(-0.12)];
    for (triangles, count, opacity, fits) in [
        (&three[..1], 1000, 0.5, true),
        (&three[..1], 1100, 0.5, false),
        (&three[..], 100, 0.999_999_94, true),
        (&three[..], 500, 0.999_999_94, false),
    ] {
        let shade = copies(triangles, count, opacity);
        match run(&shade) {
            Ok(seen) => {
                assert!(fits, "{count} copies are told");
                let bound = |(a, b): (&f32, &f32)| (a - b).abs() < 1e-4;
                assert!(seen.values.iter().zip(&see(&shade, &light, &under, &ray_traced(64)).values).all(bound));
                assert!(seen.values.iter().any(|v| *v < 0.95));
            }
            Err(error) => {
                let error = error.to_string();
                assert!(!fits && error.contains("semi-opaque layers"), "{count} copies: {error}");
            }
        }
    }
}

#[test]
fn invisible_triangles_are_not_there() {
    let (_, soup) = &soups()[1];
    let floor = points(Random(57).points(500, [-1.0, 1.0], [-1.0, 1.0], [-1.0, -0.6]));
    let kept: Vec<Triangle> = soup.iter().step_by(2).copied().collect();
    for technique in [ray_traced(64), edges(64), hard_shadow_map(256)] {
        let with_them = with(soup, |t| if t % 2 == 0 { 1.0 } else { 0.0 });
        let seen = see(&with_them, &lights()[..1], &floor, &technique);
        assert_eq!(seen.info.invisible_triangles, soup.len() / 2);
        // They may have moved the frame of the scene: what is left is the same to rounding.
        let bare = see(&scene(&kept), &lights()[..1], &floor, &technique);
        let differ = seen.values.iter().zip(&bare.values).filter(|(a, b)| (*a - *b).abs() > 1e-3).count();
        assert!(differ <= 5, "{}: {differ}", technique.name());
    }
}

#[test]
fn a_depth_map_says_that_it_takes_glass_for_opaque() {
    let _driver = on_driver();
    let light = [lamp(rectangle(0.5, 0.5), [0.0, 0.0, 3.0])];
    let under = points(vec![[0.0, 0.0, 0.0]]);
    let glass = Material { opacity: 0.5, ..Material::default() };
    let mesh = scene(&plate([-1.0, 1.0], [-1.0, 1.0], 1.0)).meshes()[0].clone();
    let glass = Scene::new(vec![Mesh { material: glass, ..mesh }]).unwrap();
    let mapped = see(&glass, &light, &under, &hard_shadow_map(64));
    assert_eq!(mapped.values, [0.0]);
    let note = "2 semi-opaque triangles taken for opaque: hard_shadow_map knows no others";
    assert_eq!(mapped.info.notes, [note]);
    for technique in [ray_traced(16), edges(16)] {
        let seen = see(&glass, &light, &under, &technique);
        assert_eq!((seen.values, seen.info.notes), (vec![0.5], Vec::<String>::new()));
    }
    let opaque = see(&scene(&plate([-1.0, 1.0], [-1.0, 1.0], 1.0)), &light, &under, &hard_shadow_map(64));
    assert!(opaque.info.notes.is_empty());
}

#[test]
fn wedges_refuse_glass_with_the_way_out() {
    let camera = Camera::look_at([0.0, -1.5, 1.0], [0.0; 3], Some([0.0, 0.0, 1.0]), 45.0, [8, 6]).unwrap();
    let light = lamp(rectangle(1.0, 1.0), [0.0, 0.0, 3.0]);
    let shade = [plate([-1.0, 1.0], [-1.0, 1.0], 0.0), plate([-1.0, 1.0], [-1.0, 1.0], 2.0)].concat();
    let evaluation = Evaluation::Blended;
    let technique = Technique::DepthComplexity(DepthComplexity { evaluation, ..DepthComplexity::default() });
    let run = |opacity| {
        let (receivers, options) = (softshadow::Receivers::Camera(camera), Options::default());
        let scene = with(&shade, |t| if t < 2 { 1.0 } else { opacity });
        visibility(context(), &scene, std::slice::from_ref(&light), &receivers, &technique, &options, &mut |_, _| true)
    };
    assert!(run(1.0).is_ok());
    let words = run(0.5).unwrap_err().to_string();
    assert!(words.contains("evaluation") && words.contains("semi-opaque") && words.contains("'tiled'"), "{words}");
}

#[test]
fn what_all_samples_pass_alike_has_no_error() {
    // Pixels under one large sheet, whose diagonal no sample is near to: a binomial estimate would be 0.05.
    let all = [plate([-1.0, 1.0], [-1.0, 1.0], 0.0), plate([-8.0, 20.0], [-8.0, 9.0], 2.0)].concat();
    let camera = Camera::look_at([0.0, -1.5, 1.0], [0.0; 3], Some([0.0, 0.0, 1.0]), 45.0, [32, 24]).unwrap();
    let light = [lamp(rectangle(1.0, 1.0), [0.0, 0.0, 3.0])];
    for spread in [SampleSpread::Correlated, SampleSpread::Decorrelated, SampleSpread::Interleaved] {
        let technique = DepthComplexity { samples: 64, spread, ..DepthComplexity::default() };
        for technique in
            [Technique::RayTraced(softshadow::RayTraced { spread, ..rays(64) }), Technique::DepthComplexity(technique)]
        {
            let shade = with(&all, |t| if t < 2 { 1.0 } else { 0.75 });
            let seen = see(&shade, &light, &softshadow::Receivers::Camera(camera), &technique);
            let valid = || (0..seen.receivers).filter(|i| seen.valid[*i]);
            assert!(valid().count() > 200);
            let errors = seen.standard_error.as_ref().unwrap();
            let most = valid().map(|i| errors[i]).fold(0.0, f32::max);
            assert!(valid().all(|i| (seen.values[i] - 0.25).abs() < 1e-5) && most < 1e-5, "{spread:?}: {most}");
        }
    }
}
