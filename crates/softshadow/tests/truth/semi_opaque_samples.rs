//! What passes to every sample: against float64 crossings of the same triangles, and rays against edges.

use softshadow::measure::{OcclusionTracer, Receiver, Target};
use softshadow::{
    Camera, DepthComplexity, Light, LightSampling, LightTexture, RayTraced, Receivers, SamplePattern, SampleSpread,
    Scene, Technique, Visibility, light_points,
};
use softshadow_scene::LocalScene;

use crate::common::{Random, points, ray_traced, see, surface_points};
use crate::semi_opaque::{BY_LAYER, FLOAT32, edges, lights, mixed, sampled, soups, with};
use crate::shapes::{Point, Triangle, plate};

/// How many samples were compared, how many of them are wrong, and how many see something but not all.
#[derive(Debug, Default, Clone, Copy)]
struct Found {
    samples: usize,
    wrong: usize,
    partly: usize,
}

/// What passes one sample a receiver, by float64 crossings of the float32 triangles.
struct Truth {
    local: LocalScene,
    tracer: OcclusionTracer,
}

impl Truth {
    fn of(scene: &Scene) -> Self {
        let local = LocalScene::new(scene, None, 128 << 20);
        let exact: Vec<Triangle> = local.triangles().map(|t| t.map(|p| p.map(f64::from))).collect();
        let tracer = OcclusionTracer::new(&exact).unwrap();
        Self { local, tracer }
    }

    /// What passes, and through how many layers.
    fn passed(&self, origin: Point, target: &Target) -> (f64, f64) {
        let crossed = self.tracer.crossings(&Receiver::at(origin), target);
        let share = crossed.iter().map(|t| 1.0 - f64::from(self.local.opacity(*t))).product();
        (share, crossed.len() as f64)
    }

    /// Compares every receiver's only sample.
    fn compare(&self, scene: &Scene, light: &Light, seed: u32, seen: &Visibility) -> Found {
        let placed = &seen.placed.as_ref().unwrap().positions;
        let sampling = LightSampling::correlated(SamplePattern::Stratified, 1, seed);
        let at = light_points(scene, light, &sampling, placed, 0).unwrap();
        let local = |p: Point| self.local.frame.local_from_world(p).to_array();
        let float32 = |p: Point| self.local.frame.local_from_world(p).as_vec3().to_array().map(f64::from);
        let mut found = Found::default();
        for (index, (position, value)) in placed.iter().zip(&seen.values).enumerate() {
            let target = match (at.at_infinity, at.rows) {
                (true, _) => Target::Direction(at.positions[0]),
                (false, 1) => Target::Point(float32(at.positions[0])),
                _ => Target::Point(local(at.positions[index])),
            };
            let (share, layers) = self.passed(float32(*position), &target);
            let off = (f64::from(*value) - share).abs();
            found.samples += 1;
            found.wrong += usize::from(off > share * (layers * BY_LAYER + FLOAT32) + FLOAT32);
            found.partly += usize::from(share > 0.0 && share < 1.0);
        }
        found
    }
}

#[test]
fn shares_of_mixed_soups_are_those_of_float64_crossings() {
    for (name, soup) in soups() {
        let shade = with(&soup, mixed);
        let truth = Truth::of(&shade);
        let floor = points(Random(52).points(1500, [-1.5, 1.5], [-1.5, 1.5], [-1.0, -0.6]));
        for technique in ["ray_traced", "depth_complexity"] {
            let mut total = Found::default();
            for light in lights() {
                for seed in 0..6 {
                    let seen = see(&shade, std::slice::from_ref(&light), &floor, &sampled(technique, seed));
                    let found = truth.compare(&shade, &light, seed, &seen);
                    total.samples += found.samples;
                    total.wrong += found.wrong;
                    total.partly += found.partly;
                }
            }
            println!("{name}, {technique} against float64: {total:?}");
            assert!(total.partly * 20 > total.samples, "{total:?}");
            assert!(total.wrong * 10_000 <= total.samples, "{name}, {technique}: {total:?}");
        }
    }
}

#[test]
fn the_comparison_sees_one_opacity_changed_and_one_triangle_gone() {
    let (_, soup) = &soups()[1];
    let floor = points(Random(52).points(1500, [-1.5, 1.5], [-1.5, 1.5], [-1.0, -0.6]));
    let light = &lights()[0];
    let shade = with(soup, mixed);
    let seen = see(&shade, std::slice::from_ref(light), &floor, &sampled("ray_traced", 1));
    assert_eq!(Truth::of(&shade).compare(&shade, light, 1, &seen).wrong, 0);
    let wrong = |spoilt: &dyn Fn(usize) -> f32| Truth::of(&with(soup, spoilt)).compare(&shade, light, 1, &seen).wrong;
    assert!(wrong(&|t| if t % 7 == 0 { 0.501 } else { mixed(t) }) > 10);
    assert!(wrong(&|t| if t % 7 == 2 { 0.0 } else { mixed(t) }) > 10);
}

/// Receivers whose samples together pass something else in both, by more than rounding can; and how many there are.
fn against_rays(shade: &Scene, light: &Light, receivers: &Receivers, samples: u32) -> (usize, usize) {
    let light = std::slice::from_ref(light);
    let (a, b) = (see(shade, light, receivers, &ray_traced(samples)), see(shade, light, receivers, &edges(samples)));
    // No sample of these scenes is crossed by ten semi-opaque layers and still passes anything to speak of.
    let rounding = |a: f32| 10.0 * BY_LAYER * f64::from(a) + FLOAT32;
    let differs = |(a, b): (&f32, &f32)| f64::from((a - b).abs()) > rounding(*a);
    assert!(a.values.iter().filter(|v| **v > 0.01 && **v < 0.99).count() > a.values.len() / 10);
    (a.values.iter().zip(&b.values).filter(|pair| differs(*pair)).count(), a.values.len())
}

#[test]
fn every_sample_has_the_share_of_its_ray() {
    let floor = points(Random(60).points(4000, [-1.2, 1.2], [-1.2, 1.2], [-1.0, -0.5]));
    let (mut differing, mut partly, mut all) = (0, 0, 0);
    for (_, soup) in soups() {
        let shade = with(&soup, mixed);
        for light in lights() {
            let light = std::slice::from_ref(&light);
            for seed in 0..8 {
                let of = |technique| see(&shade, light, &floor, &sampled(technique, seed)).values;
                let (rays, edges) = (of("ray_traced"), of("depth_complexity"));
                // A layer more or less is a quarter of it or more.
                let differs = |a: f32, b: f32| f64::from((a - b).abs()) > 10.0 * BY_LAYER * f64::from(a);
                differing += rays.iter().zip(&edges).filter(|(a, b)| differs(**a, **b)).count();
                partly += rays.iter().filter(|share| **share > 0.0 && **share < 1.0).count();
                all += rays.len();
            }
        }
    }
    println!("edges against rays: {differing} of {all} samples differ; {partly} are lit in part");
    assert!(partly * 10 > all, "{partly} of {all}");
    assert!(differing * 10_000 <= all, "{differing} of {all}");
}

#[test]
fn edges_pass_what_rays_pass() {
    let floor = Random(53).points(1500, [-1.2, 1.2], [-1.2, 1.2], [-1.0, -0.5]);
    let (free, surface) = (points(floor.clone()), surface_points(floor, [0.0, 0.3, 0.9]));
    let (mut differing, mut all) = (0, 0);
    for (_, soup) in soups() {
        let shade = with(&soup, mixed);
        for light in lights() {
            for samples in [16, 64, 130, 256] {
                for receivers in [&free, &surface] {
                    let (found, compared) = against_rays(&shade, &light, receivers, samples);
                    differing += found;
                    all += compared;
                }
            }
        }
    }
    println!("edges against rays: {differing} of {all} receivers differ");
    assert!(differing * 10_000 <= all, "{differing} of {all}");
}

#[test]
fn receivers_on_semi_opaque_bodies_leave_their_own_triangle_out() {
    let camera = Camera::look_at([1.6, -1.9, 1.4], [0.0, 0.0, 0.2], Some([0.0, 0.0, 1.0]), 40.0, [96, 72]).unwrap();
    for (name, soup) in soups() {
        let soup = [soup, plate([-2.0, 2.0], [-2.0, 2.0], -0.9)].concat();
        let (differing, pixels) = against_rays(&with(&soup, mixed), &lights()[0], &Receivers::Camera(camera), 64);
        println!("{name} seen by a camera: {differing} of {pixels} pixels differ");
        assert!(differing * 1000 <= pixels, "{name}: {differing} of {pixels}");
    }
}

/// One set of samples for every receiver, or several: rays and edges pass the same to each of them, and see the same light by it.
#[test]
fn spread_samples_pass_what_rays_pass() {
    let camera = Camera::look_at([1.6, -1.9, 1.4], [0.0, 0.0, 0.2], Some([0.0, 0.0, 1.0]), 40.0, [48, 36]).unwrap();
    let camera = Receivers::Camera(camera);
    let floor = points(Random(62).points(1500, [-1.2, 1.2], [-1.2, 1.2], [-1.0, -0.5]));
    let texture = LightTexture::new(2, 1, vec![[1.0, 0.0, 0.2], [0.0, 1.0, 0.2]]).unwrap();
    let textured = lights()[0].clone().with_texture(texture).unwrap();
    let (mut differing, mut apart, mut partly, mut all) = (0, 0, 0, 0);
    for (_, soup) in soups() {
        let shade = with(&[soup, plate([-2.0, 2.0], [-2.0, 2.0], -0.9)].concat(), mixed);
        for light in lights().into_iter().chain([textured.clone()]) {
            let light = std::slice::from_ref(&light);
            for (spread, receivers, samples) in [
                (SampleSpread::Decorrelated, &floor, 1),
                (SampleSpread::Decorrelated, &camera, 16),
                (SampleSpread::Decorrelated, &floor, 130),
                (SampleSpread::Interleaved, &camera, 16),
                (SampleSpread::Interleaved, &camera, 100),
            ] {
                let of = |technique: &Technique| see(&shade, light, receivers, technique);
                let rays = of(&Technique::RayTraced(RayTraced { samples, spread, ..RayTraced::default() }));
                let folded = DepthComplexity { samples, spread, ..DepthComplexity::default() };
                let edges = of(&Technique::DepthComplexity(folded));
                let one_set = of(&ray_traced(samples));
                let differs =
                    |(a, b): (&f32, &f32)| f64::from((a - b).abs()) > 10.0 * BY_LAYER * f64::from(*a) + FLOAT32;
                differing += rays.values.iter().zip(&edges.values).filter(|pair| differs(*pair)).count();
                apart += rays.values.iter().zip(&one_set.values).filter(|pair| differs(*pair)).count();
                partly += rays.values.iter().filter(|share| **share > 0.01 && **share < 0.99).count();
                all += rays.values.len();
                let errors = [&rays, &edges].map(|seen| seen.standard_error.as_ref().unwrap());
                let wrong = |(a, b): (&&f32, &&f32)| (**a - **b).abs() > 2e-3;
                differing += errors[0].iter().zip(errors[1]).filter(|(a, b)| wrong((a, b))).count();
            }
        }
    }
    println!(
        "spread edges against rays: {differing} of {all} values differ; {apart} from those of one set; {partly} partly lit"
    );
    assert!(partly * 10 > all && apart * 10 > all, "{partly} {apart} of {all}");
    assert!(differing * 1000 <= all, "{differing} of {all}");
}
