//! Averages of interleaved samples: of one surface alone, with smaller errors than as many samples of one set, of light as of
//! visibility.

use softshadow::{
    Camera, DepthComplexity, Error, Light, Material, Mesh, Options, Picture, PictureOptions, RayTraced, Receivers,
    SampleSpread, Scene, Shading, Technique, measure, procedural, render,
};

use crate::common::{context, lamp, points, ray_traced, rectangle, see, shipped};
use crate::filtered::{averaged, farthest, plane_of, share_visible};
use crate::shapes::{Point, Triangle, cuboid, plate, quad, scene};
use crate::spreads::{both, folded, traced};

use SampleSpread::{Correlated, Decorrelated, Interleaved};

/// A lit plate above its own umbra, a box with a dark side, and a floor: every kind of border, with exact values on both of its sides.
fn borders() -> (Scene, Light, Camera) {
    let mut triangles = plate([-3.0, 3.0], [-3.0, 3.0], 0.0);
    triangles.extend(plate([-0.5, 0.5], [-0.6, 0.6], 1.0));
    triangles.extend(cuboid([1.4, -0.5, 0.0], [2.2, 0.5, 0.7]));
    let light = lamp(rectangle(0.3, 0.3), [-1.5, 0.0, 4.0]);
    let camera = Camera::look_at([0.8, -0.4, 9.0], [0.8, 0.0, 0.0], Some([0.0, 1.0, 0.0]), 25.0, [160, 120]).unwrap();
    (scene(&triangles), light, camera)
}

#[test]
fn averages_are_of_one_surface_and_keep_its_borders() {
    let (scene, light, above) = borders();
    let beside = Camera::look_at([6.0, -5.0, 3.0], [0.6, 0.0, 0.3], Some([0.0, 0.0, 1.0]), 30.0, [160, 120]).unwrap();
    let grazing = Camera::look_at([7.0, 1.0, 1.6], [0.0, 0.0, 0.6], Some([0.0, 0.0, 1.0]), 25.0, [160, 120]).unwrap();
    for (name, camera) in [("above", above), ("beside", beside), ("grazing", grazing)] {
        for tile in [2, 3, 4, 8] {
            for technique in [
                Technique::RayTraced(RayTraced { tile, ..traced(16, Interleaved) }),
                Technique::DepthComplexity(DepthComplexity { tile, ..folded(16, Interleaved) }),
            ] {
                let seen = see(&scene, std::slice::from_ref(&light), &Receivers::Camera(camera), &technique);
                let alone = |index: usize| share_visible(&seen, index, 16);
                let same = |a: usize, b: usize| plane_of(&seen, a) == plane_of(&seen, b);
                let expected = averaged(&seen, tile, alone, same);
                let off = farthest(&seen, &expected);
                assert!(off < 1e-5, "{name}, tile {tile}, {}: {off}", technique.name());
                // Without regard to surfaces light would bleed: many pixels, and by much.
                let bled = averaged(&seen, tile, alone, |_, _| true);
                let bleeds = |index: &usize| {
                    (f64::from(seen.values[*index]) - bled[*index]).abs() > 0.1
                        && [0.0, 1.0].contains(&expected[*index])
                };
                let borders = (0..seen.receivers).filter(|i| seen.valid[*i]).filter(bleeds).count();
                println!(
                    "{name}, tile {tile}, {}: off by {off:.1e}; {borders} exact pixels at borders",
                    technique.name()
                );
                assert!(borders > 30, "{name}, tile {tile}: {borders}");
            }
        }
    }
}

#[test]
fn sheets_closer_than_half_a_pixel_are_one_surface_and_no_others() {
    // Steps on a stair, one every 0.2, whose heights are shares of a pixel's size; seen from straight above and aslant.
    let pixel = 6.0 * 2.0 * (15.0_f64.to_radians()).tan() / 128.0;
    for (height, is_one) in [(0.2 * pixel, true), (1.5 * pixel, false)] {
        let stair: Vec<Triangle> = (0..10)
            .flat_map(|n| {
                let (x, z) = (0.2 * f64::from(n) - 1.0, height * f64::from(n % 2));
                quad([x, -1.0, z], [x + 0.2, -1.0, z], [x + 0.2, 1.0, z], [x, 1.0, z])
            })
            .collect();
        let scene = scene(&[stair, plate([-0.1, 0.1], [-0.6, 0.6], 1.0)].concat());
        let camera = Camera::look_at([0.0, 0.0, 6.0], [0.0; 3], Some([0.0, 1.0, 0.0]), 30.0, [128, 128]).unwrap();
        let light = lamp(rectangle(1.0, 1.0), [0.4, 0.1, 3.0]);
        let technique = Technique::RayTraced(RayTraced { tile: 2, ..traced(16, Interleaved) });
        let seen = see(&scene, &[light], &Receivers::Camera(camera), &technique);
        let z = |index: usize| seen.placed.as_ref().unwrap().positions[index][2];
        let (sheet, stair) = (|i: usize| z(i) > 0.5, |i: usize| z(i) > 0.5 * height);
        let alike = |a: usize, b: usize| sheet(a) == sheet(b) && (is_one || stair(a) == stair(b));
        let off = farthest(&seen, &averaged(&seen, 2, |i| share_visible(&seen, i, 16), alike));
        let otherwise = |a: usize, b: usize| sheet(a) == sheet(b) && (!is_one || stair(a) == stair(b));
        let spoilt = farthest(&seen, &averaged(&seen, 2, |i| share_visible(&seen, i, 16), otherwise));
        println!("steps of {:.1} pixels: off by {off:.1e}; taken the other way {spoilt:.2}", height / pixel);
        assert!(off < 1e-5 && spoilt > 0.01, "{off} {spoilt}");
    }
}

/// A shipped scene through a longer lens: its penumbrae are as many pixels wider.
fn close_up(name: &str, fov_y_deg: f64) -> (Scene, Light, Camera) {
    let (scene, light, _) = shipped(name, [8, 8]);
    let described = procedural::shipped(name).unwrap();
    let c = described.camera();
    (scene, light, Camera::look_at(c.eye, c.target, Some(c.up), fov_y_deg, [200, 150]).unwrap())
}

#[test]
fn interleaved_samples_err_less_where_penumbrae_are_wider_than_the_square() {
    for (name, fov, is_wide) in [("toruses", 6.0, true), ("fork", 5.0, true), ("fork", 30.0, false)] {
        let (scene, light, camera) = close_up(name, fov);
        let run = |technique: &Technique| {
            see(&scene, std::slice::from_ref(&light), &Receivers::Camera(camera), technique).values
        };
        let truth = run(&ray_traced(512));
        let image = measure::ReferenceImage { visibility: &truth, standard_error: None, width: Some(200) };
        let rmse = |spread| {
            let report = measure::compare(&run(&both(16, spread)[1]), &image).unwrap();
            let penumbra = report.penumbra.unwrap();
            println!("{name} at {fov} degrees, {spread:?}: RMSE {:.4}, bias {:+.4}", penumbra.rmse, penumbra.bias);
            penumbra.rmse
        };
        let [one, apart, interleaved] = [Correlated, Decorrelated, Interleaved].map(rmse);
        // Decorrelated noise is as large as the steps of one set, only elsewhere.
        assert!(apart < 1.5 * one, "{name}: {apart} of {one}");
        // Penumbrae of a few pixels are blurred, as the technique's page says.
        assert!(if is_wide { interleaved < 0.55 * one } else { interleaved > one }, "{name}: {interleaved} of {one}");
    }
}

#[test]
fn what_areas_answer_is_left_alone() {
    let (scene, light, camera) = borders();
    let run = |spread| {
        let exact = DepthComplexity { exact_area: true, ..folded(64, spread) };
        see(&scene, std::slice::from_ref(&light), &Receivers::Camera(camera), &Technique::DepthComplexity(exact))
    };
    let (one, apart, filtered) = (run(Correlated), run(Decorrelated), run(Interleaved));
    assert!(one.info.area_receivers > 500 && filtered.info.area_receivers > 500);
    // Single layers hide the light here: what has no error is the area, the same whatever the samples.
    let exact = |index: usize| {
        let has_no_error = |seen: &softshadow::Visibility| seen.standard_error.as_ref().unwrap()[index] == 0.0;
        one.values[index] > 0.02 && one.values[index] < 0.98 && has_no_error(&one) && has_no_error(&filtered)
    };
    let found: Vec<usize> = (0..one.receivers).filter(|i| one.valid[*i] && exact(*i)).collect();
    let off = found.iter().map(|i| (one.values[*i] - filtered.values[*i]).abs()).fold(0.0, f32::max);
    let apart = found.iter().map(|i| (one.values[*i] - apart.values[*i]).abs()).fold(0.0, f32::max);
    let blurred = averaged(&one, 4, |i| f64::from(one.values[i]), |a, b| plane_of(&one, a) == plane_of(&one, b));
    let blur = found.iter().map(|i| (f64::from(one.values[*i]) - blurred[*i]).abs()).fold(0.0, f64::max);
    assert!(blur > 0.01, "an average would be seen: {blur}");
    println!("{} receivers by area: off by {off:.1e} where averaged, {apart:.1e} where not", found.len());
    assert!(found.len() > 300 && off == 0.0, "{} {off}", found.len());
}

/// A floor of two materials that meet in a line through the shadow of a plate.
fn two_materials(base_colors: [[f32; 3]; 2]) -> (Scene, Light, Camera) {
    let mesh = |triangles: Vec<Triangle>, base_color: [f32; 3]| {
        let vertices: Vec<Point> = triangles.as_flattened().to_vec();
        let indices = (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        Mesh::new("part", vertices, indices, Material { base_color, ..Material::default() }).unwrap()
    };
    let halves = [plate([-2.0, 0.03], [-2.0, 2.0], 0.0), plate([0.03, 2.0], [-2.0, 2.0], 0.0)];
    let [left, right] = halves;
    let meshes = vec![
        mesh(left, base_colors[0]),
        mesh(right, base_colors[1]),
        mesh(plate([-0.3, 0.4], [-0.3, 0.3], 1.0), [0.5; 3]),
    ];
    let camera = Camera::look_at([0.1, -3.0, 3.0], [0.0; 3], Some([0.0, 0.0, 1.0]), 30.0, [96, 72]).unwrap();
    (Scene::new(meshes).unwrap(), lamp(rectangle(1.0, 1.0), [0.0, 0.0, 3.0]), camera)
}

fn picture(of: &(Scene, Light, Camera), technique: &Technique, shading: Shading, memory_limit_bytes: u64) -> Picture {
    let options = Options { memory_limit_bytes, receivers: true, ..Options::default() };
    let options = PictureOptions { shading, options, ..PictureOptions::default() };
    let lights = [of.1.clone(), of.1.clone().with_radiance([0.5, 0.2, 0.1]).unwrap()];
    render(context(), &of.0, &lights, &of.2, technique, &options, &mut |_, _| true).unwrap()
}

#[test]
fn averaged_light_stays_on_its_material_and_has_less_noise() {
    let dark = two_materials([[0.8; 3], [0.0; 3]]);
    let grey = two_materials([[0.8; 3], [0.4; 3]]);
    for index in 0..2 {
        for shading in [Shading::Integrated, Shading::Modulated] {
            let of = |spread, scene| picture(scene, &both(16, spread)[index], shading, 1 << 30);
            // What is black stays so, whatever shines beside it.
            let seen = of(Interleaved, &dark);
            let placed = &seen.visibility.placed.as_ref().unwrap().positions;
            let is_black = |i: &usize| placed[*i][0] > 0.03 && placed[*i][2] < 0.5;
            let black: Vec<usize> = (0..placed.len()).filter(is_black).collect();
            assert!(black.len() > 1000 && black.iter().all(|i| seen.linear[*i] == [0.0; 3]));

            let truth = picture(&grey, &ray_traced(1024), shading, 1 << 30);
            let rmse = |p: &Picture| {
                let off = p.linear.iter().zip(&truth.linear).map(|(a, b)| f64::from(a[0] - b[0]).powi(2));
                (off.sum::<f64>() / p.linear.len() as f64).sqrt()
            };
            let [one, apart, averaged] = [Correlated, Decorrelated, Interleaved].map(|s| rmse(&of(s, &grey)));
            println!(
                "{shading:?}, {index}: RMSE of light {one:.5}, decorrelated {apart:.5}, interleaved {averaged:.5}"
            );
            assert!(averaged < 0.6 * one, "{shading:?}: {averaged} of {one}");
        }
    }
}

#[test]
fn pictures_do_not_depend_on_blocks() {
    let of = two_materials([[0.8; 3], [0.3, 0.6, 0.1]]);
    for technique in both(16, Interleaved).iter().chain(&both(16, Decorrelated)) {
        for shading in [Shading::Integrated, Shading::Modulated] {
            let (whole, parts) = (picture(&of, technique, shading, 1 << 30), picture(&of, technique, shading, 400_000));
            assert!(parts.visibility.info.blocks > 2, "{}", parts.visibility.info.blocks);
            let words = |p: &Picture| p.linear.as_flattened().iter().map(|c| c.to_bits()).collect::<Vec<_>>();
            assert!(words(&whole) == words(&parts), "{} {shading:?}", technique.name());
        }
    }
}

#[test]
fn points_do_not_interleave() {
    let (scene, light, _) = borders();
    for technique in both(16, Interleaved) {
        for receivers in [points(vec![[0.0; 3]]), points(Vec::new())] {
            let options = Options::default();
            let lights = std::slice::from_ref(&light);
            let found =
                softshadow::visibility(context(), &scene, lights, &receivers, &technique, &options, &mut |_, _| true);
            let Err(Error::Settings(words)) = found else { panic!("{found:?}") };
            assert!(words.contains(technique.name()) && words.contains("give a camera"), "{words}");
        }
    }
}
