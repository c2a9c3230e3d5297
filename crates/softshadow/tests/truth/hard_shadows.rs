//! Hard shadow maps: no shadow where there is no occluder, no light under one, and the border where it belongs, to a texel.

use softshadow::{Light, LightShape, Receivers, Scene, Visibility, look_at};

use crate::common::{Random, hard_shadow_map, lamp, points, ray_traced, rectangle, see, shipped, surface_points};
use crate::shapes::{Point, Triangle, add, cross, cuboid, dot, length, map, plate, quad, scene, sub, turned};

const RESOLUTION: u32 = 1024;

/// A bound on the world width of a texel. A sun's map is fitted to the box around the scene, and no side of it exceeds the
/// box's diagonal. A perspective map spans the cone around the box, or 90 degrees, and is widest at its far end.
fn texel(scene: &Scene, light_at: Option<Point>) -> f64 {
    let (low, high) = scene.bounds().unwrap();
    let Some(eye) = light_at else {
        return length(sub(high, low)) * 1.001 / f64::from(RESOLUTION);
    };
    let axis = sub([0, 1, 2].map(|k| (low[k] + high[k]) * 0.5), eye);
    let (mut tangent, mut farthest) = (1e-6, 0.0_f64);
    for i in 0..8 {
        let to_corner = sub([0, 1, 2].map(|k| if i >> k & 1 == 0 { low[k] } else { high[k] }), eye);
        tangent = f64::max(tangent, length(cross(to_corner, axis)) / dot(to_corner, axis).max(1e-9));
        farthest = farthest.max(length(to_corner));
    }
    let is_cube = tangent > 3_f64.sqrt();
    2.0 * if is_cube { 1.0 } else { tangent } * farthest * 1.001 / f64::from(RESOLUTION)
}

fn point_light(at: Point, target: Point) -> Light {
    Light::new(rectangle(0.0, 0.0), look_at(at, target, None).unwrap()).unwrap()
}

/// A square of side 2 whose normal stands `tilt` degrees away from z, with points on it.
fn tilted(tilt: f64) -> (Vec<Triangle>, Vec<Point>, Point) {
    let place = |p: Point| turned(p, tilt.to_radians(), 0.6);
    let on_it = Random(3).points(4000, [-0.99, 0.99], [-0.99, 0.99], [0.0, 0.0]).into_iter().map(place).collect();
    (map(&plate([-1.0, 1.0], [-1.0, 1.0], 0.0), place), on_it, place([0.0, 0.0, 1.0]))
}

#[test]
fn a_tilted_surface_does_not_shadow_itself() {
    let far_corner = quad([3.0, 3.0, -3.0], [3.1, 3.0, -3.0], [3.1, 3.1, -3.0], [3.0, 3.1, -3.0]);
    for tilt in [0.0, 45.0, 75.0, 85.0] {
        let (surface, on_it, normal) = tilted(tilt);
        let with_corner: Vec<Triangle> = surface.iter().chain(&far_corner).copied().collect();
        for (name, triangles) in [("alone", &surface), ("in a larger scene", &with_corner)] {
            let lights = [
                ("near", point_light([0.1, 0.2, 6.0], [0.0; 3])),
                ("sun", lamp(LightShape::Sun { angular_diameter: 0.01 }, [0.0; 3])),
            ];
            for (light_name, light) in lights {
                let receivers = surface_points(on_it.clone(), normal);
                let seen = see(&scene(triangles), &[light], &receivers, &hard_shadow_map(RESOLUTION));
                let dark = seen.values.iter().filter(|v| **v != 1.0).count();
                println!("tilt {tilt}, {name}, {light_name}: {dark} of {} receivers dark", on_it.len());
                assert_eq!(dark, 0, "{tilt} degrees, {name}, {light_name}");
            }
        }
    }
    // A lid over it darkens what the same call said was lit.
    let (mut surface, on_it, normal) = tilted(45.0);
    surface.extend(plate([-2.0, 2.0], [-2.0, 2.0], 2.0));
    let receivers = surface_points(on_it, normal);
    let light = point_light([0.1, 0.2, 6.0], [0.0; 3]);
    let seen = see(&scene(&surface), &[light], &receivers, &hard_shadow_map(RESOLUTION));
    assert!(seen.values.iter().all(|v| *v == 0.0));
}

/// How far from the foot of an occluder at x = 0 light leaks on to the floor, which is all in shadow there.
fn leak_width(triangles: &[Triangle], light: &Light) -> f64 {
    let mut random = Random(7);
    let distances: Vec<f64> = (0..8000).map(|_| 10_f64.powf(random.within([-5.0, -0.4]))).collect();
    let on_floor = distances.iter().map(|d| [*d, random.within([-0.3, 0.3]), 0.0]).collect();
    let receivers = surface_points(on_floor, [0.0, 0.0, 1.0]);
    let seen = see(&scene(triangles), std::slice::from_ref(light), &receivers, &hard_shadow_map(RESOLUTION));
    distances.iter().zip(&seen.values).filter(|(_, v)| **v > 0.0).map(|(d, _)| *d).fold(0.0, f64::max)
}

#[test]
fn what_stands_on_the_floor_leaks_two_texels_at_most() {
    let floor = plate([-2.0, 2.0], [-2.0, 2.0], 0.0);
    let with = |more: Vec<Triangle>| -> Vec<Triangle> { floor.iter().copied().chain(more).collect() };
    let cases = [
        ("box", with(cuboid([-0.5, -0.7, 0.0], [0.0, 0.7, 1.0]))),
        ("sheet", with(quad([0.0, -0.7, 0.0], [0.0, 0.7, 0.0], [0.0, 0.7, 1.0], [0.0, -0.7, 1.0]))),
    ];
    // From −x at 45 degrees: the shadow reaches a metre beyond the foot.
    let sun = Light::new(LightShape::Sun { angular_diameter: 0.0 }, look_at([-1.0, 0.0, 1.0], [0.0; 3], None).unwrap());
    let lights =
        [("sun", sun.unwrap(), None), ("near", point_light([-4.0, 0.0, 4.0], [0.0; 3]), Some([-4.0, 0.0, 4.0]))];
    for (name, triangles) in &cases {
        for (light_name, light, at) in &lights {
            let (width, limit) = (leak_width(triangles, light), 2.0 * texel(&scene(triangles), *at));
            println!("leak at the foot of a {name}, {light_name}: {width:.5}, two texels are {limit:.5}");
            assert!(width <= limit, "{name}, {light_name}: {width} of {limit}");
        }
    }
    // A gap of a tenth under the sheet lets light through, and is seen.
    let raised = map(&cases[1].1[2..], |p| add(p, [0.0, 0.0, 0.1]));
    assert!(leak_width(&with(raised), &lights[0].1) > 0.05);
}

/// Receivers where two techniques disagree, and how far from the border of a shadow the farthest of them lies.
fn disagreement(a: &Visibility, b: &Visibility, positions: &[Point], border: impl Fn(Point) -> f64) -> (usize, f64) {
    let apart = positions.iter().zip(a.values.iter().zip(&b.values)).filter(|(_, (a, b))| a != b);
    apart.fold((0, 0.0), |(count, farthest), (p, _)| (count + 1, border(*p).abs().max(farthest)))
}

#[test]
fn a_shadow_ends_where_it_should_to_half_a_texel() {
    let (half, x, y, height, light_at) = (1.25, [-0.4, 0.5], [-0.3, 0.2], 0.8, [0.0, 0.0, 3.0]);
    let mut triangles = plate([-half, half], [-half, half], 0.0);
    triangles.extend(plate(x, y, height));
    let scene = scene(&triangles);
    let light = point_light(light_at, [0.0; 3]);
    let positions = Random(12).points(40_000, [-1.2, 1.2], [-1.2, 1.2], [0.0, 0.0]);
    let receivers = surface_points(positions.clone(), [0.0, 0.0, 1.0]);
    // Distance on the floor from the border of the plate's shadow, for points near it.
    let k = light_at[2] / (light_at[2] - height);
    let shadow = [0, 1].map(|i| [x, y][i].map(|edge| light_at[i] + (edge - light_at[i]) * k));
    let border = |p: Point| {
        let outside = [0, 1].map(|i| (shadow[i][0] - p[i]).max(p[i] - shadow[i][1]));
        outside[0].max(outside[1])
    };
    let exact = see(&scene, std::slice::from_ref(&light), &receivers, &ray_traced(1));
    let wrong = exact.values.iter().zip(&positions).filter(|(v, p)| (**v == 0.0) != (border(**p) < 0.0)).count();
    assert!(wrong <= 2, "rays to a light without size give the hard shadow: {wrong}");
    let mapped = see(&scene, std::slice::from_ref(&light), &receivers, &hard_shadow_map(RESOLUTION));
    let (count, farthest) = disagreement(&exact, &mapped, &positions, border);
    // The light stands over the middle, so the map's sides are those of the box: its top subtends the largest angle, and the
    // floor is seen through the same. A texel is dark or lit by its centre.
    let texel = 2.0 * half * 1.001 / (light_at[2] - height) * light_at[2] / f64::from(RESOLUTION);
    println!("hard shadow map: {count} of 40000 differ, at most {farthest:.5} from the border; a texel is {texel:.5}");
    let limit = 0.51 * texel;
    assert!(farthest <= limit, "{farthest} of {limit}");
    assert!(count > 0, "no map has no texels");
    let coarse = see(&scene, std::slice::from_ref(&light), &receivers, &hard_shadow_map(64));
    assert!(disagreement(&exact, &coarse, &positions, border).1 > limit, "a map of 64 texels is seen");
}

#[test]
fn in_the_hall_map_and_rays_differ_along_borders_only() {
    let (scene, _, camera) = shipped("hall", [160, 120]);
    let receivers = Receivers::Camera(camera);
    let pose = look_at([8.0, 8.0, 3.5], [0.0, 0.5, -1.0], None).unwrap();
    let above_floor = look_at([0.3, 2.2, 0.4], [0.0; 3], None).unwrap();
    for (name, light) in [
        ("near", Light::new(rectangle(0.0, 0.0), pose).unwrap()),
        ("sun", Light::new(LightShape::Sun { angular_diameter: 0.0 }, pose).unwrap()),
        ("within the scene", Light::new(LightShape::Sphere { radius: 0.0 }, above_floor).unwrap()),
    ] {
        let of = |technique| see(&scene, std::slice::from_ref(&light), &receivers, &technique);
        let exact = of(ray_traced(1));
        let share = |seen: &Visibility| {
            let pairs = exact.values.iter().zip(&seen.values).filter(|(a, _)| !a.is_nan());
            let different = pairs.clone().filter(|(a, b)| a != b).count();
            different as f64 / pairs.count() as f64
        };
        let [coarse, middle, fine] = [256, 1024, 4096].map(|resolution| share(&of(hard_shadow_map(resolution))));
        println!(
            "hall, {name}: maps of 256, 1024, 4096 texels differ from rays in {coarse:.4}, {middle:.4}, {fine:.4}"
        );
        let lit = exact.values.iter().filter(|v| **v == 1.0).count();
        let dark = exact.values.iter().filter(|v| **v == 0.0).count();
        assert!(lit > 1000 && dark > 1000, "{name}: {lit} lit, {dark} dark");
        // What differs is a band of texels along borders: it narrows with the texels.
        assert!(middle < coarse * 0.5 && fine <= middle, "{name}: {coarse} {middle} {fine}");
        assert!(fine < 0.002, "{name}: {fine}");
    }
}

#[test]
fn a_light_inside_the_scene_shines_through_all_six_faces() {
    // A ball of plates around a light; receivers beyond a plate are dark, receivers between plates are lit.
    let plates: Vec<Triangle> = (0..40)
        .flat_map(|i| {
            let place = |p: Point| turned(p, 0.157 * f64::from(i % 20) + 0.05, 0.7 * f64::from(i));
            map(&plate([-0.08, 0.08], [-0.08, 0.08], 1.0), place)
        })
        .collect();
    let scene = scene(&plates);
    let light = lamp(LightShape::Sphere { radius: 0.0 }, [0.0; 3]);
    let all_around: Vec<Point> = Random(14)
        .points(60_000, [-1.0, 1.0], [-1.0, 1.0], [-1.0, 1.0])
        .into_iter()
        .filter(|p| length(*p) > 0.3)
        .map(|p| p.map(|x| x * 2.0 / length(p)))
        .collect();
    let of = |technique| see(&scene, std::slice::from_ref(&light), &points(all_around.clone()), &technique);
    let (exact, mapped) = (of(ray_traced(1)), of(hard_shadow_map(RESOLUTION)));
    let different = exact.values.iter().zip(&mapped.values).filter(|(a, b)| a != b).count();
    let dark = exact.values.iter().filter(|v| **v == 0.0).count();
    println!("six faces: {different} of {} receivers differ, {dark} are dark", all_around.len());
    assert!(dark * 50 > all_around.len());
    // 40 outlines of 0.64 at distance 1; a texel of a face is at most 2/1024 wide there, the sphere 4π large.
    let band = 40.0 * 0.64 * (2.0 / 1024.0) * 2_f64.sqrt() / (4.0 * std::f64::consts::PI);
    assert!((different as f64) < band * all_around.len() as f64, "{different} of {}", all_around.len());
}

#[test]
fn behind_a_light_and_facing_away_it_is_dark() {
    let floor = scene(&plate([-1.0, 1.0], [-1.0, 1.0], 0.0));
    let light = lamp(rectangle(0.5, 0.5), [0.0, 0.0, 1.0]);
    let values = |receivers| see(&floor, std::slice::from_ref(&light), &receivers, &hard_shadow_map(64)).values;
    assert_eq!(values(points(vec![[0.1, 0.2, 1.5], [0.1, 0.2, 1.0], [0.1, 0.2, 0.5]])), [0.0, 0.0, 1.0]);
    assert_eq!(values(surface_points(vec![[0.1, 0.2, 0.5]], [0.0, 0.0, -1.0])), [0.0]);
}

#[test]
fn two_planes_close_in_depth_keep_their_order() {
    // A thousandth apart at a distance of a hundred, alone and with something else half way.
    let (far, gap) = (100.0, 1e-3);
    let mut triangles = plate([-0.5, 0.5], [-0.5, 0.5], 0.0);
    triangles.extend(plate([-0.25, 0.25], [-0.25, 0.25], gap));
    let half_way = plate([0.16, 0.17], [0.16, 0.17], far / 2.0);
    for (name, more) in [("two planes", Vec::new()), ("and one half way", half_way)] {
        let scene = scene(&triangles.iter().copied().chain(more).collect::<Vec<_>>());
        let light = point_light([0.0, 0.0, far], [0.0; 3]);
        let on = |z: f64| surface_points(Random(2).points(4000, [-0.2, 0.2], [-0.2, 0.2], [z, z]), [0.0, 0.0, 1.0]);
        let mean = |receivers, resolution| {
            let seen = see(&scene, std::slice::from_ref(&light), &receivers, &hard_shadow_map(resolution));
            seen.values.iter().map(|v| f64::from(*v)).sum::<f64>() / 4000.0
        };
        let (upper, lower) = (mean(on(gap), 4096), mean(on(0.0), 4096));
        println!("{name}: V {upper} on the upper, {lower} on the lower");
        assert_eq!(upper, 1.0, "{name}");
        assert_eq!(lower, 0.0, "{name}");
        assert!(mean(on(0.0), 64) > 0.5, "texels far wider than the gap do not resolve it");
    }
}
