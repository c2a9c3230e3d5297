//! Receivers with samples of their own: edges and rays take the same ones, those that `light_points` says, whatever the block.

use softshadow::{
    Camera, DepthComplexity, Light, LightShape, LightTexture, Options, RayTraced, Receivers, SamplePattern,
    SampleSpread, Scene, Technique, Visibility, light_points, look_at, measure, visibility,
};

use crate::agreement::{Agreement, Truth};
use crate::common::{Random, bits, context, lamp, points, ray_traced, rays, rectangle, see, shipped, surface_points};
use crate::coverage::Coverage;
use crate::filtered::{averaged, plane_of};
use crate::shapes::{map, plate, scene, sphere, torus, turned};

use SampleSpread::{Correlated, Decorrelated, Interleaved};

pub(crate) fn traced(samples: u32, spread: SampleSpread) -> RayTraced {
    RayTraced { spread, ..rays(samples) }
}

pub(crate) fn folded(samples: u32, spread: SampleSpread) -> DepthComplexity {
    DepthComplexity { samples, spread, exact_area: false, ..DepthComplexity::default() }
}

/// Both techniques with the same samples, and without exact areas.
pub(crate) fn both(samples: u32, spread: SampleSpread) -> [Technique; 2] {
    [Technique::RayTraced(traced(samples, spread)), Technique::DepthComplexity(folded(samples, spread))]
}

/// A ring and a ball over a floor.
fn bodies() -> Scene {
    scene(&[plate([-2.0, 2.0], [-2.0, 2.0], -0.6), torus(0.5, 0.2, 24, 12), sphere([0.1, 0.0, 0.6], 0.25, 2)].concat())
}

fn bodies_seen(size: [u32; 2]) -> Camera {
    Camera::look_at([1.6, -3.2, 2.2], [0.0, 0.0, -0.2], Some([0.0, 0.0, 1.0]), 40.0, size).unwrap()
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
    ]
    .map(|shape| Light::new(shape, pose).unwrap())
    .to_vec()
}

/// Bits in which two results differ, and bits of hidden samples. Those past the last sample mean nothing.
fn differing(a: &Visibility, b: &Visibility, samples: u32) -> (u32, u32) {
    let (a, b) = (&a.masks.as_ref().unwrap().bits, &b.masks.as_ref().unwrap().bits);
    let used = |at: usize| {
        let left = samples - 32 * (at as u32 % samples.div_ceil(32));
        if left >= 32 { !0 } else { !(!0u32 << left) }
    };
    let differ = a.iter().zip(b).enumerate().map(|(at, (x, y))| ((x ^ y) & used(at)).count_ones()).sum();
    (differ, a.iter().enumerate().map(|(at, x)| (x & used(at)).count_ones()).sum())
}

#[test]
fn edges_and_rays_take_the_same_samples() {
    let scene = bodies();
    let camera = Receivers::Camera(bodies_seen([64, 48]));
    let floor = Random(6).points(2000, [-1.5, 1.5], [-1.5, 1.5], [-0.6, -0.4]);
    let (free, surface) = (points(floor.clone()), surface_points(floor, [0.0, 0.3, 0.9]));
    let (mut total, mut wrong, mut apart) = (0, 0, 0);
    for light in lights() {
        let lights = std::slice::from_ref(&light);
        for samples in [16, 32, 64, 128, 256] {
            for (pattern, spread, receivers) in [
                (SamplePattern::Stratified, Interleaved, &camera),
                (SamplePattern::LowDiscrepancy, Interleaved, &camera),
                (SamplePattern::Stratified, Decorrelated, &camera),
                (SamplePattern::LowDiscrepancy, Decorrelated, &free),
                (SamplePattern::Stratified, Decorrelated, &surface),
            ] {
                let rays = RayTraced { pattern, ..traced(samples, spread) };
                let edges = DepthComplexity { pattern, ..folded(samples, spread) };
                let rays = see(&scene, lights, receivers, &Technique::RayTraced(rays));
                let edges = see(&scene, lights, receivers, &Technique::DepthComplexity(edges));
                let (differ, hidden) = differing(&rays, &edges, samples);
                assert!(hidden > 200 * samples, "{:?} {spread:?}: {hidden}", light.shape());
                total += rays.receivers * samples as usize;
                wrong += differ as usize;
                // Of one set for all nearly everything in the penumbra is another.
                if samples == 64 {
                    let one_set = see(&scene, lights, receivers, &ray_traced(samples));
                    apart += differing(&rays, &one_set, samples).0 as usize;
                }
            }
        }
    }
    println!("spread samples: {wrong} of {total} differ between edges and rays; {apart} from those of one set");
    assert!(wrong * 10_000 <= total, "{wrong} of {total} differ");
    assert!(apart > 20_000, "{apart}");
}

#[test]
fn rays_go_where_light_points_says() {
    let scene = bodies();
    let truth = Truth::of(&scene);
    let camera = Receivers::Camera(bodies_seen([48, 32]));
    let floor = points(Random(8).points(1000, [-1.0, 1.0], [-1.0, 1.0], [-0.55, -0.4]));
    let mut total = Agreement::default();
    for light in lights() {
        for (spread, receivers) in [(Interleaved, &camera), (Decorrelated, &camera), (Decorrelated, &floor)] {
            let settings = RayTraced { seed: 3, ..traced(32, spread) };
            let technique = Technique::RayTraced(settings.clone());
            let seen = see(&scene, std::slice::from_ref(&light), receivers, &technique);
            let found = truth.compare(&scene, &light, &settings, &seen);
            assert_eq!(found.differing, 0, "{:?} {spread:?}: {found:?}", light.shape());
            assert!(found.grazing * 50 < found.samples && found.hidden * 50 > found.samples, "{found:?}");
            // Were the sets those of a neighbour, it would be seen.
            let mut shifted = seen.clone();
            let words = &mut shifted.masks.as_mut().unwrap().bits;
            words.rotate_right(1);
            assert!(truth.compare(&scene, &light, &settings, &shifted).differing > 500);
            total += found;
        }
    }
    println!("spread samples against float64 rays: {total:?}");
}

#[test]
fn neighbours_have_samples_of_their_own() {
    let (scene, light) = (bodies(), lights().remove(0));
    let receivers = vec![[0.0; 3]; 24 * 16];
    let rows = |spread, width| {
        let found = light_points(&scene, &light, &traced(64, spread).sampling(0), &receivers, width).unwrap();
        assert_eq!(found.parameters.len(), found.positions.len());
        found.positions
    };
    assert_eq!(rows(Correlated, 0).len(), 64);
    for spread in [Decorrelated, Interleaved] {
        let all = rows(spread, 24);
        let row = |index: usize| &all[64 * index..64 * (index + 1)];
        let same =
            (0..24 * 16 - 24).filter(|i| (i % 24 < 23 && row(*i) == row(i + 1)) || row(*i) == row(i + 24)).count();
        // Of 128 sets two receivers have the same by chance.
        assert!(same <= 12 && (spread == Decorrelated || same == 0), "{spread:?}: {same} of 744 neighbours");
    }
    assert_eq!(rows(Decorrelated, 24), rows(Decorrelated, 0), "drawn by index, of whatever image");
    let refused = light_points(&scene, &light, &traced(64, Interleaved).sampling(0), &receivers, 0).unwrap_err();
    assert!(refused.to_string().contains("interleaved samples are those of an image's pixels"), "{refused}");
}

#[test]
fn blocks_of_any_size_give_the_same_bits() {
    let (scene, light, camera) = shipped("toruses", [96, 64]);
    let floor = surface_points(Random(2).points(20_000, [-2.0, 2.0], [0.0, 0.0], [-2.0, 2.0]), [0.0, 1.0, 0.0]);
    let camera = Receivers::Camera(camera);
    let probed = RayTraced { probes: 8, tile: 5, passes: 2, ..traced(40, Interleaved) };
    let exact = DepthComplexity { samples: 40, spread: Interleaved, passes: 2, ..DepthComplexity::default() };
    let [rays, edges] = both(40, Interleaved);
    let [rays_apart, edges_apart] = both(40, Decorrelated);
    for (receivers, technique, limit) in [
        (&camera, &rays, 150_000),
        (&camera, &Technique::RayTraced(probed), 200_000),
        (&camera, &edges, 350_000),
        (&camera, &Technique::DepthComplexity(exact), 400_000),
        (&camera, &rays_apart, 150_000),
        (&floor, &rays_apart, 400_000),
        (&floor, &edges_apart, 1_000_000),
    ] {
        let run = |memory_limit_bytes| {
            let options =
                Options { memory_limit_bytes, standard_error: true, sample_masks: true, ..Options::default() };
            let lights = std::slice::from_ref(&light);
            visibility(context(), &scene, lights, receivers, technique, &options, &mut |_, _| true).unwrap()
        };
        let (whole, parts) = (run(1 << 30), run(limit));
        assert!(whole.info.blocks == 1 && parts.info.blocks > 3, "{} {}", technique.name(), parts.info.blocks);
        assert_eq!(differing(&whole, &parts, 40).0, 0, "{technique:?}");
        assert!(bits(&whole).0 == bits(&parts).0, "{technique:?}");
        let errors = |v: &Visibility| v.standard_error.iter().flatten().map(|e| e.to_bits()).collect::<Vec<_>>();
        assert!(errors(&whole) == errors(&parts));
    }
}

/// A light whose texture is stripes that have come so far.
fn frame(light: &Light, phase: usize) -> (Light, LightTexture) {
    let texels = (0..16).map(|x| if (x + phase) % 8 < 4 { [2.0, 0.0, 0.5] } else { [0.0, 1.0, 0.5] }).collect();
    let texture = LightTexture::new(16, 1, texels).unwrap();
    (light.clone().with_texture(texture.clone()).unwrap(), texture)
}

#[test]
fn frames_of_a_texture_weigh_the_samples_of_each_receiver() {
    let (scene, light) = (bodies(), lights().remove(0));
    let camera = Receivers::Camera(bodies_seen([48, 32]));
    for spread in [Correlated, Decorrelated, Interleaved] {
        let mut still: Option<Visibility> = None;
        for phase in [0, 2, 4] {
            let (light, texture) = frame(&light, phase);
            let [rays, edges] = both(32, spread).map(|t| see(&scene, std::slice::from_ref(&light), &camera, &t));
            assert!(bits(&rays) == bits(&edges), "{spread:?}");
            let placed = &rays.placed.as_ref().unwrap().positions;
            let samples = light_points(&scene, &light, &traced(32, spread).sampling(0), placed, 48).unwrap();
            // What each receiver sees of a channel, through its own samples.
            let weighed = |index: usize, channel: usize| {
                let first = if samples.rows == 1 { 0 } else { 32 * index };
                let mask = rays.masks.as_ref().unwrap().bits[index];
                let radiance = |s: usize| {
                    let p = samples.parameters[first + s].map(f64::from);
                    f64::from(texture.at(p[0], p[1])[channel])
                };
                let whole: f64 = (0..32).map(radiance).sum();
                (0..32).filter(|s| mask >> s & 1 == 0).map(radiance).sum::<f64>() / whole
            };
            let surface = |index: usize| rays.placed.as_ref().unwrap().positions[index][2] < -0.59;
            let mut worst: f64 = 0.0;
            for channel in 0..3 {
                let alone = |index: usize| weighed(index, channel);
                let expected = match spread {
                    Interleaved => averaged(&rays, 4, alone, |a, b| surface(a) && surface(b)),
                    _ => (0..rays.receivers).map(|i| if rays.valid[i] { alone(i) } else { f64::NAN }).collect(),
                };
                // Of what interleaves, the floor is judged: there it is known what is one surface.
                let judged = (0..rays.receivers).filter(|i| rays.valid[*i] && (spread != Interleaved || surface(*i)));
                let off = judged.map(|i| (f64::from(rays.values[3 * i + channel]) - expected[i]).abs());
                worst = off.fold(worst, f64::max);
            }
            println!("{spread:?}, frame {phase}: off by {worst:.1e}");
            assert!(worst < 1e-5, "{spread:?}, frame {phase}: {worst}");
            if let Some(still) = &still {
                assert_eq!(differing(still, &rays, 32).0, 0, "masks know nothing of a texture");
                assert!(bits(still).0 != bits(&rays).0, "and values do");
            }
            still = Some(rays);
        }
    }
}

/// How a half-plane over the floor stands: aslant to the light's sides, along which a Sobol sequence errs unlike any normal number.
const ANGLE: f64 = 0.7;

/// What a point of the floor sees past it, half way up to the light; its underside sees nothing.
fn past_the_half_plane(p: [f64; 3]) -> f64 {
    let across = p[0] * ANGLE.cos() + p[1] * ANGLE.sin();
    if p[2] > 0.5 { 0.0 } else { measure::half_plane_over_rectangle(-across, ANGLE, [0.6, 0.35]).unwrap() }
}

/// How a mean of 64 passes lies to the closed form, and to that of receivers a fiftieth of a unit further on.
fn judge(seen: &Visibility, spread: SampleSpread, coverages: &mut [Coverage; 2]) {
    let placed = &seen.placed.as_ref().unwrap().positions;
    let errors = seen.standard_error.as_ref().unwrap();
    for (coverage, shift) in coverages.iter_mut().zip([0.0, 0.02]) {
        let exact = |i: usize| past_the_half_plane([placed[i][0] + shift, placed[i][1] + shift, placed[i][2]]);
        // Interleaved pixels come to the mean of what each of them sees.
        let expected = match spread {
            Interleaved => averaged(seen, 4, exact, |a, b| plane_of(seen, a) == plane_of(seen, b)),
            _ => (0..seen.receivers).map(|i| if seen.valid[i] { exact(i) } else { f64::NAN }).collect(),
        };
        for i in (0..seen.receivers).filter(|i| seen.valid[*i]) {
            coverage.add(f64::from(seen.values[i]), f64::from(errors[i]), [expected[i]; 2]);
        }
    }
}

#[test]
fn passes_converge_to_the_closed_form_of_each_spread() {
    let half_plane = map(&plate([-8.0, 0.0], [-8.0, 8.0], 1.0), |p| turned(p, 0.0, ANGLE));
    let scene = scene(&[plate([-2.0, 2.0], [-2.0, 2.0], 0.0), half_plane].concat());
    let light = lamp(rectangle(1.2, 0.7), [0.0, 0.0, 2.0]);
    for spread in [Correlated, Decorrelated, Interleaved] {
        let rays = |seed| RayTraced { seed, passes: 64, ..traced(64, spread) };
        let pattern = SamplePattern::LowDiscrepancy;
        let edges = |seed| DepthComplexity { seed, pattern, passes: 64, ..folded(64, spread) };
        let techniques: [&dyn Fn(u32) -> Technique; 2] =
            [&|seed| Technique::RayTraced(rays(seed)), &|seed| Technique::DepthComplexity(edges(seed))];
        for technique in techniques {
            let mut coverages = [Coverage::default(); 2];
            // Receivers of a call err together where they share samples: there are several calls, each with its seed.
            for seed in 0..6 {
                let eye = [0.3 + 0.01 * f64::from(seed), -1.6, 0.8];
                let camera = Camera::look_at(eye, [0.0; 3], Some([0.0, 0.0, 1.0]), 35.0, [24, 18]).unwrap();
                let technique = technique(1000 * seed);
                let seen = see(&scene, std::slice::from_ref(&light), &Receivers::Camera(camera), &technique);
                judge(&seen, spread, &mut coverages);
            }
            println!("{spread:?}, {}: {:?}", technique(0).name(), coverages[0]);
            assert!(coverages[0].holds(), "{spread:?}: {:?}", coverages[0]);
            assert!(!coverages[1].holds(), "{spread:?}: a shifted truth passes");
        }
    }
}
