//! Pictures against equation 6 in float64, for Lambert and Blinn and every kind of light; and edges against rays.

use softshadow::{
    Camera, DepthComplexity, Light, LightShape, LightTexture, Material, Mesh, Options, Picture, PictureOptions,
    RayTraced, Scene, Shading, Technique, light_points, look_at, render,
};

use crate::common::{context, rectangle, shipped};
use crate::equation_6::{Emitter, Flaw, Lamp, Surface, is_free, normal_towards};
use crate::shapes::{Point, Triangle, cuboid, plate, quad, triangles_of};

const EYE: Point = [0.3, -3.4, 1.9];
const SIZE: [u32; 2] = [56, 42];

/// A floor of Lambert before a wall of Blinn, and what stands on the floor or hangs over it.
fn room(between: &[Triangle]) -> Scene {
    let mesh = |name: &str, triangles: &[Triangle], material: Material| {
        let indices = (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        Mesh::new(name, triangles.as_flattened().to_vec(), indices, material).unwrap()
    };
    let wall = quad([-1.6, 1.2, 0.0], [1.6, 1.2, 0.0], [1.6, 1.4, 2.0], [-1.6, 1.4, 2.0]);
    let shiny = Material { base_color: [0.2, 0.5, 0.7], roughness: 0.6, specular: 0.4, ..Material::default() };
    let matte = Material { base_color: [0.8, 0.6, 0.3], roughness: 1.0, specular: 0.0, ..Material::default() };
    let glossy = Material { base_color: [0.6, 0.1, 0.2], roughness: 0.35, specular: 0.2, ..Material::default() };
    let mut meshes = vec![mesh("floor", &plate([-1.6, 1.6], [-1.6, 1.2], 0.0), matte), mesh("wall", &wall, shiny)];
    meshes.extend((!between.is_empty()).then(|| mesh("between", between, glossy)));
    Scene::new(meshes).unwrap()
}

fn furnished() -> Scene {
    let leaf = vec![[[-0.9, -0.5, 0.7], [-0.1, -0.4, 0.9], [-0.5, 0.5, 0.6]]];
    room(&[cuboid([0.2, -0.4, 0.0], [0.7, 0.2, 0.5]), leaf].concat())
}

fn camera() -> Camera {
    Camera::look_at(EYE, [0.0, 0.2, 0.4], Some([0.0, 0.0, 1.0]), 42.0, SIZE).unwrap()
}

/// One light of each kind before the wall and above the floor, as the library takes it and as the truth does.
fn lamps() -> Vec<(&'static str, Light, Lamp)> {
    let pose = look_at([-0.6, -0.9, 2.2], [0.1, 0.2, 0.2], Some([0.0, 1.0, 0.2])).unwrap();
    let radiance = [9.0, 8.0, 6.0];
    let colors = [[1.5, 0.0, 0.5], [0.25, 2.0, 0.5]];
    let of = |shape: LightShape| Light::new(shape, pose).unwrap().with_radiance(radiance.map(|x| x as f32)).unwrap();
    let texture = LightTexture::new(2, 1, colors.map(|c| c.map(|x| x as f32)).to_vec()).unwrap();
    let lamp = |shape: Emitter| Lamp { shape, pose, radiance };
    let (width, height, radius) = (0.8, 0.5, 0.35);
    vec![
        ("rectangle", of(rectangle(width, height)), lamp(Emitter::Rectangle { width, height })),
        (
            "textured",
            of(rectangle(width, height)).with_texture(texture).unwrap(),
            lamp(Emitter::Textured { width, height, colors }),
        ),
        ("disc", of(LightShape::Disc { radius }), lamp(Emitter::Disc { radius })),
        ("sphere", of(LightShape::Sphere { radius }), lamp(Emitter::Sphere { radius })),
        ("sun", of(LightShape::Sun { angular_diameter: 0.35 }), lamp(Emitter::Sun { angle: 0.35 })),
    ]
}

fn edges(samples: u32, passes: u32) -> Technique {
    Technique::DepthComplexity(DepthComplexity { samples, passes, ..DepthComplexity::default() })
}

fn rays(samples: u32) -> Technique {
    Technique::RayTraced(RayTraced { samples, ..RayTraced::default() })
}

fn picture(scene: &Scene, lights: &[Light], camera: &Camera, technique: &Technique, shading: Shading) -> Picture {
    let options = Options { receivers: true, sample_masks: true, ..Options::default() };
    let options = PictureOptions { shading, options, ..PictureOptions::default() };
    render(context(), scene, lights, camera, technique, &options, &mut |_, _| true).unwrap()
}

/// What every pixel shows: where the library placed it, and all else from the test's own triangles. Pixels and their triangles.
fn surfaces(scene: &Scene, shown: &Picture) -> Vec<(usize, usize, Surface)> {
    let triangles = triangles_of(scene);
    let materials: Vec<Material> =
        scene.meshes().iter().flat_map(|m| std::iter::repeat_n(m.material, m.triangles.len())).collect();
    let placed = shown.visibility.placed.as_ref().unwrap();
    let seen = (0..placed.triangles.len()).filter(|&pixel| placed.triangles[pixel] >= 0);
    seen.map(|pixel| {
        let triangle = placed.triangles[pixel] as usize;
        let (material, normal) = (materials[triangle], normal_towards(&triangles[triangle], EYE));
        let base_color = material.base_color.map(f64::from);
        let (roughness, specular) = (f64::from(material.roughness), f64::from(material.specular));
        let position = placed.positions[pixel];
        (pixel, triangle, Surface { position, normal, eye: EYE, base_color, roughness, specular })
    })
    .collect()
}

/// Sums of equation 6 over the library's samples: with every sample's own visibility, and without shadows.
fn sums(scene: &Scene, light: &Light, lamp: &Lamp, samples: u32, shown: &Picture, flaw: Flaw) -> Vec<[Point; 2]> {
    let triangles = triangles_of(scene);
    let surfaces = surfaces(scene, shown);
    let positions: Vec<Point> = surfaces.iter().map(|(_, _, surface)| surface.position).collect();
    let settings = RayTraced { samples, ..RayTraced::default() };
    let points = light_points(scene, light, &settings.sampling(0), &positions, 0).unwrap();
    let rows = points.positions.chunks_exact(samples as usize).cycle();
    let mut found = Vec::new();
    for ((_, own, surface), row) in surfaces.iter().zip(rows) {
        let mut both = [[0.0; 3]; 2];
        for &target in row {
            let part = lamp.contribution(surface, target, flaw).map(|x| x / f64::from(samples));
            let way = if lamp.at_infinity() { target } else { [0, 1, 2].map(|k| target[k] - surface.position[k]) };
            let free = f64::from(u8::from(is_free(&triangles, *own, surface.position, way, lamp.at_infinity())));
            both = [[0, 1, 2].map(|k| both[0][k] + free * part[k]), [0, 1, 2].map(|k| both[1][k] + part[k])];
        }
        found.push(both);
    }
    found
}

/// Each pixel's largest difference, as a share of its light without shadow, sorted; a difference where there is no light is infinite.
fn shares(
    scene: &Scene,
    shown: &Picture,
    truth: &[[Point; 2]],
    expected: impl Fn(usize, &[Point; 2]) -> Point,
) -> Vec<f64> {
    let mut shares: Vec<f64> = surfaces(scene, shown)
        .iter()
        .zip(truth)
        .map(|((pixel, _, _), sums)| {
            let (color, value) = (shown.linear[*pixel], expected(*pixel, sums));
            let share = |k: usize| match (f64::from(color[k]) - value[k]).abs() {
                0.0 => 0.0,
                off => off / sums[1][k],
            };
            share(0).max(share(1)).max(share(2))
        })
        .collect();
    shares.sort_unstable_by(f64::total_cmp);
    shares
}

/// Pixels that are off by more; what is no number is off.
fn beyond(shares: &[f64], limit: f64) -> usize {
    shares.len() - shares.iter().filter(|share| **share <= limit).count()
}

/// 64 terms in float32, and a lobe's power of 131; measured: 7e-7.
const ROUNDING: f64 = 2e-6;

#[test]
fn integrated_pictures_are_equation_6() {
    let scene = furnished();
    for (name, light, lamp) in lamps() {
        for technique in [rays(64), edges(64, 1)] {
            let shown = picture(&scene, std::slice::from_ref(&light), &camera(), &technique, Shading::Integrated);
            let truth = sums(&scene, &light, &lamp, 64, &shown, Flaw::None);
            let found = shares(&scene, &shown, &truth, |_, [seen, _]| *seen);
            let half_dark =
                truth.iter().filter(|[seen, all]| seen[1] > 0.05 * all[1] && seen[1] < 0.95 * all[1]).count();
            let (median, last) = (found[found.len() / 2], found[found.len() - 1]);
            println!(
                "equation 6, {name}, {}: {} pixels, {half_dark} in penumbra, off by {median:.1e}, at most {last:.1e}",
                technique.name(),
                found.len()
            );
            assert!(found.len() > 1500 && half_dark > 60, "{name}: {} {half_dark}", found.len());
            assert_eq!(beyond(&found, ROUNDING), 0, "{name}, {}: {last}", technique.name());
        }
    }
}

#[test]
fn the_comparison_sees_every_missing_factor() {
    let scene = furnished();
    for (name, light, lamp) in lamps() {
        let shown = picture(&scene, std::slice::from_ref(&light), &camera(), &edges(64, 1), Shading::Integrated);
        let flat = !matches!(name, "sphere" | "sun");
        for (flaw, exists) in [
            (Flaw::CosineAtReceiver, true),
            (Flaw::Measure, true),
            (Flaw::CosineAtLight, flat),
            (Flaw::Distance, flat),
            (Flaw::ScaleOfLobe, true),
        ] {
            let truth = sums(&scene, &light, &lamp, 64, &shown, flaw);
            let found = shares(&scene, &shown, &truth, |_, [seen, _]| *seen);
            let seen = beyond(&found, 10.0 * ROUNDING);
            assert!(!exists || seen * 4 > found.len(), "{name} without {flaw:?}: {seen} of {}", found.len());
        }
    }
}

#[test]
fn modulated_pictures_are_the_sum_without_shadow_times_the_visibility() {
    let scene = furnished();
    for (name, light, lamp) in lamps() {
        let lights = std::slice::from_ref(&light);
        let [shown, whole] = [Shading::Modulated, Shading::Integrated]
            .map(|shading| picture(&scene, lights, &camera(), &edges(64, 1), shading));
        let truth = sums(&scene, &light, &lamp, 64, &shown, Flaw::None);
        let (values, channels) = (&shown.visibility.values, shown.visibility.channels);
        assert_eq!(channels, if name == "textured" { 3 } else { 1 });
        let seen = |pixel: usize, k: usize| f64::from(values[pixel * channels + k.min(channels - 1)]);
        let found = shares(&scene, &shown, &truth, |pixel, [_, all]| [0, 1, 2].map(|k| all[k] * seen(pixel, k)));
        println!("modulated, {name}: at most {:.1e}", found[found.len() - 1]);
        assert_eq!(beyond(&found, ROUNDING), 0, "{name}");
        // In shadow the two differ, because near samples weigh more; where all is seen they are one.
        let apart = shares(&scene, &shown, &truth, |_, [seen, _]| *seen);
        assert!(beyond(&apart, 10.0 * ROUNDING) > 20, "{name}: {}", beyond(&apart, 10.0 * ROUNDING));
        for pixel in (0..shown.linear.len()).filter(|&p| (0..3).all(|k| seen(p, k) == 1.0)) {
            let (a, b) = (shown.linear[pixel], whole.linear[pixel]);
            assert!((0..3).all(|k| (a[k] - b[k]).abs() <= 1e-6 * b[k]), "{name}, pixel {pixel}: {a:?} {b:?}");
        }
    }
}

#[test]
fn many_samples_come_to_the_integral_over_the_light() {
    // Without anything between, so that the integrand is smooth; samples, their measure and their weights are on trial.
    let scene = room(&[]);
    for (name, light, lamp) in lamps() {
        for technique in [rays(1024), edges(64, 16)] {
            let shown = picture(&scene, std::slice::from_ref(&light), &camera(), &technique, Shading::Integrated);
            let truth: Vec<[Point; 2]> =
                surfaces(&scene, &shown).iter().map(|(_, _, s)| [lamp.integral(s, 48); 2]).collect();
            let found = shares(&scene, &shown, &truth, |_, [all, _]| *all);
            let last = found[found.len() - 1];
            println!(
                "integral, {name}, {}: median {:.1e}, at most {last:.1e}",
                technique.name(),
                found[found.len() / 2]
            );
            // A cosine, a distance or a measure that is missing or counted twice is off by far more.
            assert!(found.len() > 1500 && last < 0.003, "{name}, {}: {last}", technique.name());
        }
    }
}

#[test]
fn lights_add_up_and_passes_average() {
    let scene = furnished();
    let lamps = lamps();
    let [a, b] = [&lamps[0].1, &lamps[3].1];
    let technique = edges(32, 3);
    let of = |lights: &[Light]| picture(&scene, lights, &camera(), &technique, Shading::Integrated).linear;
    let (both, [first, second]) = (of(&[a.clone(), b.clone()]), [a, b].map(|light| of(std::slice::from_ref(light))));
    for (pixel, sum) in both.iter().enumerate() {
        for k in 0..3 {
            let expected = first[pixel][k] + second[pixel][k];
            assert!((sum[k] - expected).abs() <= 1e-5 * expected, "pixel {pixel}: {} for {expected}", sum[k]);
        }
    }
}

#[test]
fn probes_speak_for_the_light_of_all_samples() {
    let scene = furnished();
    let probing = Technique::RayTraced(RayTraced { probes: 16, ..RayTraced::default() });
    for (name, light, _) in lamps() {
        let of = |technique| picture(&scene, std::slice::from_ref(&light), &camera(), technique, Shading::Integrated);
        let (all, probed) = (of(&rays(64)), of(&probing));
        let channels = all.visibility.channels;
        let value = |p: &Picture, pixel: usize| p.visibility.values[pixel * channels..][..channels].to_vec();
        // Where probes agree but other samples do not, visibility differs, too.
        let alike: Vec<usize> =
            (0..all.linear.len()).filter(|&pixel| value(&all, pixel) == value(&probed, pixel)).collect();
        assert!(alike.len() > 1500 && alike.iter().all(|&p| all.linear[p] == probed.linear[p]), "{name}");
        assert!(alike.iter().any(|&p| value(&all, p)[0] == 0.0), "{name}: some are dark");
    }
}

#[test]
fn edges_and_rays_make_one_picture_of_the_same_samples() {
    for name in ["hall", "fork", "toruses"] {
        let (scene, light, camera) = shipped(name, [96, 72]);
        let of = |technique: &Technique| {
            picture(&scene, std::slice::from_ref(&light), &camera, technique, Shading::Integrated)
        };
        let (by_rays, by_edges) = (of(&rays(64)), of(&edges(64, 1)));
        let differing = |a: &Picture, b: &Picture| -> Vec<u32> {
            let [x, y] = [a, b].map(|p| p.visibility.masks.as_ref().unwrap().bits.chunks_exact(2));
            x.zip(y).map(|(x, y)| (x[0] ^ y[0]).count_ones() + (x[1] ^ y[1]).count_ones()).collect()
        };
        let off = differing(&by_rays, &by_edges);
        // The same masks make the same bits: one kernel adds the same numbers in the same order.
        let same = (0..off.len()).filter(|&pixel| off[pixel] == 0);
        assert!(same.into_iter().all(|pixel| by_rays.linear[pixel] == by_edges.linear[pixel]), "{name}");
        let off: u32 = off.iter().sum();
        println!("{name}: {off} of {} samples differ between edges and rays", 96 * 72 * 64);
        assert!(off <= 4, "{name}: {off} samples, more than one in 10^5");
        let other = Technique::RayTraced(RayTraced { seed: 1, ..RayTraced::default() });
        assert!(differing(&by_rays, &of(&other)).iter().sum::<u32>() > 1000, "other samples are seen to differ");
    }
}
