//! Contact, silhouettes next to the light, vertices with many silhouettes, order, fine ramps, lights without size, and who is served.

use std::time::Instant;

use softshadow::{
    Error, Light, LightShape, Options, Points, Ramp, RayTraced, Receivers, Technique, look_at, visibility,
};

use super::{LAMP, half_plane, half_width, mean, on_floor, over};
use crate::common::{
    Random, bits, context, hard_shadow_map, penumbra_map, points, ray_traced, see, shipped, surface_points,
};
use crate::shapes::{Point, Triangle, cuboid, plate, quad, scene, torus};

fn square(side: f64) -> LightShape {
    LightShape::Rectangle { width: side, height: side }
}

fn all_are_shares(values: &[f32]) -> bool {
    values.iter().all(|v| (0.0..=1.0).contains(v))
}

#[test]
fn in_contact_nothing_is_nan_and_the_shadow_is_hard() {
    let mut random = Random(77);
    let places: Vec<Point> =
        (0..4000).map(|_| [10_f64.powf(random.within([-5.0, 0.0])), random.within([-0.5, 0.5]), 0.0]).collect();
    let mut order: Vec<usize> = (0..places.len()).collect();
    order.sort_by(|a, b| places[*a][0].total_cmp(&places[*b][0]));
    for gap in [0.5, 1e-2, 1e-4, 1e-6, 1e-7, 0.0] {
        // A wedge that rises from the border away from it.
        let mut triangles = plate([-3.0, 3.0], [-3.0, 3.0], 0.0);
        triangles.extend(quad([0.0, -2.0, gap], [0.0, 2.0, gap], [-2.0, 2.0, gap + 0.5], [-2.0, -2.0, gap + 0.5]));
        for shape in [square(1.0), LightShape::Disc { radius: 0.5 }, LightShape::Sphere { radius: 0.5 }] {
            for ramp in [Ramp::Light, Ramp::Linear, Ramp::Paper] {
                let seen = on_floor(&triangles, &over(shape.clone()), &places, 256, ramp);
                assert!(all_are_shares(&seen.values), "{gap} {shape:?} {ramp:?}");
            }
        }
        let light = over(square(1.0));
        let soft = on_floor(&triangles, &light, &places, 1024, Ramp::Linear);
        let values: Vec<f32> = order.iter().map(|i| soft.values[*i]).collect();
        let fall = values.windows(2).map(|pair| pair[0] - pair[1]).fold(0.0, f32::max);
        assert!(fall < 2e-3, "{gap}: light falls by {fall} away from the border");
        let receivers = surface_points(places.clone(), [0.0, 0.0, 1.0]);
        let hard = see(&scene(&triangles), std::slice::from_ref(&light), &receivers, &hard_shadow_map(1024));
        let apart = |a: f32, b: f32| (a - b).abs() > 1.0 / 255.0;
        // A texel is at most 2/1024 of the map's width of 8.
        let beyond = |p: &Point| p[0] > 8.0 * 2.0 / 1024.0;
        let pairs = places.iter().zip(soft.values.iter().zip(&hard.values));
        let differ = pairs.filter(|(p, (a, b))| beyond(p) && apart(**a, **b)).count();
        println!("gap {gap:e}: {differ} receivers beyond a texel differ from the hard shadow");
        assert!(gap < 0.1 || differ > 100, "a wide gap has a penumbra: {differ}");
        assert!(gap > 1e-6 || differ == 0, "{gap}: {differ}");
    }
}

#[test]
fn silhouettes_next_to_the_light_are_finite_and_bounded() {
    let places = Random(3).points(3000, [-2.0, 2.0], [-2.0, 2.0], [0.0, 0.0]);
    let time = |triangles: &[Triangle], shape: LightShape| {
        let start = Instant::now();
        let seen = on_floor(triangles, &over(shape), &places, 512, Ramp::Light);
        assert!(all_are_shares(&seen.values));
        (start.elapsed().as_secs_f64(), mean(seen.values.iter().map(|v| f64::from(*v))))
    };
    for shape in [square(0.5), LightShape::Disc { radius: 0.25 }, LightShape::Sphere { radius: 0.25 }] {
        for below in [1e-1, 1e-2, 1e-3, 1e-6, 0.0, -0.1] {
            // A fin beside the light, from the floor to just below its plane, and beyond.
            let mut triangles = plate([-2.5, 2.5], [-2.5, 2.5], 0.0);
            triangles.extend(quad(
                [0.6, -0.5, 0.5],
                [0.6, 0.5, 0.5],
                [0.6, 0.5, LAMP - below],
                [0.6, -0.5, LAMP - below],
            ));
            let (seconds, lit) = time(&triangles, shape.clone());
            println!("{shape:?}, {below} below: {seconds:.3} s, mean {lit:.4}");
            assert!(seconds < 20.0 && lit > 0.3 && lit < 1.0, "{shape:?} {below}: {seconds} {lit}");
        }
    }
}

#[test]
fn vertices_with_many_silhouettes_are_dark_all_around() {
    // Four leaves meet in a point: eight silhouettes.
    let mut triangles = plate([-3.0, 3.0], [-3.0, 3.0], 0.0);
    for k in 0..4 {
        let angle = f64::from(k) * std::f64::consts::FRAC_PI_2;
        let tip = |turn: f64| [0.8 * (angle + turn).cos(), 0.8 * (angle + turn).sin(), 2.0];
        triangles.push([[0.0, 0.0, 2.0], tip(-0.3), tip(0.3)]);
    }
    let light = over(LightShape::Disc { radius: 0.3 });
    let places = Random(9).points(3000, [-0.2, 0.2], [-0.2, 0.2], [0.0, 0.0]);
    let seen = on_floor(&triangles, &light, &places, 1024, Ramp::Linear);
    let width = half_width(2.0, 0.3);
    // Darker than the cone of the vertex alone, everywhere.
    let worst = places
        .iter()
        .zip(&seen.values)
        .map(|(p, v)| f64::from(*v) - p[0].hypot(p[1]) / width)
        .fold(f64::NEG_INFINITY, f64::max);
    println!("eight silhouettes at a vertex: at most {worst:.4} lighter than its cone");
    assert!(worst < 0.01);
    let without: Vec<Triangle> = triangles[..4].to_vec();
    let fewer = on_floor(&without, &light, &places, 1024, Ramp::Linear);
    assert!(fewer.values != seen.values);
}

#[test]
fn the_order_of_triangles_changes_no_bit() {
    let (scene_before, light, camera) = shipped("fork", [96, 96]);
    let triangles = crate::shapes::triangles_of(&scene_before);
    let mut shuffled = triangles.clone();
    let mut random = Random(4);
    for i in (1..shuffled.len()).rev() {
        shuffled.swap(i, (random.next() % (i as u64 + 1)) as usize);
    }
    let receivers = Receivers::Camera(camera);
    let of = |t: &[Triangle]| {
        bits(&see(&scene(t), std::slice::from_ref(&light), &receivers, &penumbra_map(512, Ramp::Light)))
    };
    let once = of(&triangles);
    assert_eq!(once, of(&shuffled));
    assert_eq!(once, of(&triangles), "nor does another run");
    shuffled.truncate(shuffled.len() - 20);
    assert_ne!(once, of(&shuffled), "twenty triangles fewer are seen");
}

#[test]
fn ramps_are_finer_than_sixteen_bits() {
    // A ramp as wide as the map, looked at over a small part of it.
    let height = 3.0;
    let width = half_width(height, 0.5);
    let places: Vec<Point> = (0..4096).map(|i| [width * (0.5 + f64::from(i) / 4096.0 * 0.02), 0.013, 0.0]).collect();
    let seen = on_floor(&half_plane(height), &over(square(1.0)), &places, 4096, Ramp::Linear);
    let off: Vec<f64> = places.iter().zip(&seen.values).map(|(p, v)| f64::from(*v) - p[0] / width).collect();
    let middle = mean(off.iter().copied());
    let spread = off.iter().map(|d| (d - middle).abs()).fold(0.0, f64::max);
    let quantised = seen
        .values
        .iter()
        .zip(&places)
        .map(|(v, p)| ((f64::from(*v) * 65_535.0).round() / 65_535.0 - p[0] / width - middle).abs())
        .fold(0.0, f64::max);
    println!("ramp: {middle:.2e} off, and {spread:.2e} around that; in 16 bits {quantised:.2e}");
    let levels: std::collections::BTreeSet<u32> = seen.values.iter().map(|v| v.to_bits()).collect();
    assert!(levels.len() > 4000, "{} levels", levels.len());
    assert!(spread < 4e-6 && quantised > 6e-6, "{spread} {quantised}");
}

#[test]
fn a_light_without_size_has_the_hard_shadow() {
    let (scene, light, camera) = shipped("hall", [96, 64]);
    let receivers = Receivers::Camera(camera);
    let of = |shape: LightShape, technique| {
        let light = Light::new(shape, look_at([8.0, 8.0, 3.5], [0.0, 0.5, -1.0], None).unwrap()).unwrap();
        see(&scene, std::slice::from_ref(&light), &receivers, &technique)
    };
    let (hard, point) = (of(square(0.0), hard_shadow_map(1024)), of(square(0.0), penumbra_map(1024, Ramp::Light)));
    assert_eq!(bits(&hard), bits(&point));
    assert!(!point.info.plan.contains("silhouettes"), "no penumbra, no pass: {}", point.info.plan);
    let differ = |side: f64| {
        let soft = of(square(side), penumbra_map(1024, Ramp::Light));
        let pairs = hard.values.iter().zip(&soft.values).filter(|(a, _)| !a.is_nan());
        assert!(pairs.clone().all(|(_, b)| (0.0..=1.0).contains(b)), "{side}");
        pairs.filter(|(a, b)| (**a - **b).abs() > 1e-6).count()
    };
    let counts = [1.0, 1e-1, 1e-3, 1e-6, 1e-12, 1e-30].map(differ);
    println!("pixels that differ from the hard shadow at sizes 1 to 1e-30: {counts:?}");
    assert!(counts[0] > 20 && counts[3..] == [0; 3] && counts[1] <= counts[0], "{counts:?}");
    assert!(see(&scene, &[light], &receivers, &penumbra_map(1024, Ramp::Light)).info.plan.contains("list silhouettes"));
}

#[test]
fn the_umbra_never_shrinks() {
    let mut strip = plate([-3.0, 3.0], [-3.0, 3.0], 0.0);
    strip.extend(plate([-0.2, 0.2], [-3.0, 3.0], 2.0));
    let places = Random(6).points(3000, [-1.5, 1.5], [-0.1, 0.1], [0.0, 0.0]);
    let receivers = surface_points(places.clone(), [0.0, 0.0, 1.0]);
    let dark = |technique: &Technique, side: f64| {
        let seen = see(&scene(&strip), &[over(square(side))], &receivers, technique);
        seen.values.iter().filter(|v| **v < 0.02).count()
    };
    let sizes = [0.1, 0.4, 0.8, 1.6];
    let map = sizes.map(|side| dark(&penumbra_map(1024, Ramp::Linear), side));
    let truth = sizes.map(|side| dark(&ray_traced(256), side));
    println!("dark receivers under a strip, lights of {sizes:?}: maps {map:?}, rays {truth:?}");
    assert!(map[3] * 10 > map[0] * 9, "{map:?}");
    assert!(truth[3] == 0 && truth[0] > 500, "{truth:?}");
}

#[test]
fn cameras_and_points_and_several_lights_agree() {
    let (scene, light, camera) = shipped("hall", [120, 80]);
    let sun = Light::new(LightShape::Sun { angular_diameter: 0.05 }, look_at([3.0, 8.0, 3.5], [0.0; 3], None).unwrap())
        .unwrap();
    let lights = [light, sun];
    let technique = penumbra_map(1024, Ramp::Light);
    let seen = see(&scene, &lights, &Receivers::Camera(camera), &technique);
    let placed = seen.placed.as_ref().unwrap();
    let keep: Vec<usize> = (0..seen.receivers).filter(|i| seen.valid[*i]).collect();
    let positions: Vec<Point> = keep.iter().map(|i| placed.positions[*i]).collect();
    let normals: Vec<Point> = keep.iter().map(|i| placed.normals[*i].map(f64::from)).collect();
    let receivers = Receivers::Points(Points::new(positions, Some(normals)).unwrap());
    let mut soft = 0;
    for (n, light) in lights.iter().enumerate() {
        let of_points = see(&scene, std::slice::from_ref(light), &receivers, &technique);
        let camera_values: Vec<f32> = keep.iter().map(|i| seen.values[n * seen.receivers + i]).collect();
        let differ = |a: &[f32], b: &[f32]| a.iter().zip(b).filter(|(a, b)| (**a - **b).abs() > 1e-3).count();
        let count = differ(&camera_values, &of_points.values);
        println!("light {n}: {count} of {} receivers differ between camera and points", keep.len());
        // Points are lifted once more.
        assert!(count * 500 < keep.len(), "{count}");
        let mut spoilt = camera_values.clone();
        spoilt.rotate_left(1);
        assert!(differ(&camera_values, &spoilt) * 100 > keep.len());
        soft += camera_values.iter().filter(|v| **v > 0.01 && **v < 0.99).count();
    }
    assert!(soft > 200);
}

#[test]
fn solids_shadow_themselves_and_their_error_is_dark() {
    let knot = torus(0.8, 0.3, 48, 24);
    let mut on_floor = plate([-3.0, 3.0], [-3.0, 3.0], -0.6);
    on_floor.extend(knot);
    let ring = scene(&on_floor);
    let eye = softshadow::Camera::look_at([2.0, -2.5, 2.0], [0.0; 3], Some([0.0, 0.0, 1.0]), 40.0, [96, 96]).unwrap();
    let (fork, fork_light, fork_eye) = shipped("fork", [96, 96]);
    let ring_light = Light::new(square(0.4), look_at([1.5, 1.0, 3.0], [0.0; 3], None).unwrap()).unwrap();
    for (name, scene, light, camera) in [("ring", &ring, &ring_light, eye), ("fork", &fork, &fork_light, fork_eye)] {
        let receivers = Receivers::Camera(camera);
        let light = std::slice::from_ref(light);
        let map = see(scene, light, &receivers, &penumbra_map(1024, Ramp::Light));
        let truth =
            see(scene, light, &receivers, &Technique::RayTraced(RayTraced { samples: 1024, ..RayTraced::default() }));
        let pairs = || map.values.iter().zip(&truth.values).filter(|(_, t)| **t > 0.002 && **t < 0.998);
        let bias = mean(pairs().map(|(m, t)| f64::from(m - t)));
        let rmse = mean(pairs().map(|(m, t)| f64::from(m - t).powi(2))).sqrt();
        println!(
            "{name}: {} receivers in penumbrae, bias {bias:+.3}, RMSE {rmse:.3}; {:?}",
            pairs().count(),
            map.info.notes
        );
        assert!(map.values.iter().zip(&map.valid).all(|(v, valid)| !valid || (0.0..=1.0).contains(v)));
        // Missing the inner half makes it darker; how much, a scene decides.
        assert!(bias < -0.05 && bias > -0.4, "{name}: {bias}");
    }
}

#[test]
fn what_cannot_be_served_is_refused_or_said() {
    let floor = [plate([-1.0, 1.0], [-1.0, 1.0], 0.0), cuboid([-0.2, -0.2, 0.5], [0.2, 0.2, 0.7])].concat();
    let receivers = points(vec![[0.5, 0.5, 0.0]]);
    let refused = |outline: Vec<[f64; 2]>| {
        let light = over(LightShape::Polygon { outline });
        let outcome = visibility(
            context(),
            &scene(&floor),
            &[light],
            &receivers,
            &penumbra_map(64, Ramp::Light),
            &Options::default(),
            &mut |_, _| true,
        );
        match outcome {
            Err(Error::Settings(words)) => words,
            other => panic!("{other:?}"),
        }
    };
    let beside = refused(vec![[1.0, 0.0], [2.0, 0.0], [1.5, 1.0]]);
    assert!(beside.contains("penumbra_map") && beside.contains("polygon 0"), "{beside}");
    let corner = |i: u32| {
        let angle = f64::from(i) / 65.0 * std::f64::consts::TAU;
        [angle.cos(), angle.sin()]
    };
    let many = refused((0..65).map(corner).collect());
    assert!(many.contains("65 corners"), "{many}");
    // In mid-air the map says nothing; it tells how often.
    let notes = |light: Light, at: Point| {
        see(&scene(&floor), &[light], &points(vec![at]), &penumbra_map(256, Ramp::Light)).info.notes.join("; ")
    };
    let lamp = over(square(0.5));
    assert!(notes(lamp.clone(), [0.6, 0.6, 0.4]).contains("1 receivers are not on"), "mid-air");
    let shown = notes(lamp, [0.6, 0.6, 0.0]);
    assert!(!shown.contains("receivers are not on"), "{shown}");
    let star = vec![[0.5, 0.0], [0.1, 0.1], [0.0, 0.5], [-0.5, -0.5]];
    let concave = over(LightShape::Polygon { outline: star });
    assert!(notes(concave, [0.6, 0.6, 0.0]).contains("1 concave polygons"), "a star");
}
