//! The picture.

use crate::harness::Same;
use crate::one_kernel::{Case, Random, Receiver};
use crate::resolve::{image, images};

const FILE: &str = "shading/shade.wgsl";
const RECEIVERS: usize = 517;
const MATERIALS: usize = 6;

#[derive(Clone, Copy, PartialEq)]
enum Light {
    Flat,
    Sphere,
    Sun,
}

fn unit(random: &mut Random) -> [f32; 3] {
    loop {
        let v = [random.signed(), random.signed(), random.signed()];
        let squared: f32 = v.iter().map(|x| x * x).sum();
        if (0.01..1.0).contains(&squared) {
            return v.map(|x| x / squared.sqrt());
        }
    }
}

fn normalized(v: [f32; 3]) -> [f32; 3] {
    let length = v.iter().map(|x| x * x).sum::<f32>().sqrt();
    v.map(|x| x / length)
}

const EYE: [f32; 3] = [0.3, -4.0, 1.0];
const CENTER: [f32; 3] = [0.0, 0.0, 2.0];

fn mirroring(position: [f32; 3], random: &mut Random) -> [f32; 3] {
    let [to_light, to_eye] = [CENTER, EYE].map(|end| normalized(std::array::from_fn(|i| end[i] - position[i])));
    normalized(std::array::from_fn(|i| to_light[i] + to_eye[i] + 0.1 * random.signed()))
}

/// A light of size 1 above receivers on all sides of it, some inside a sphere.
fn case(light: Light, [count, sets, row]: [u32; 3], adds: bool, exponent: f32, random: &mut Random) -> Case {
    let bits = |v: [f32; 3]| v.map(f32::to_bits);
    let (kind, radius, measure) = match light {
        Light::Flat => (0, 0.0, 4.0_f32),
        Light::Sphere => (1, 0.5_f32, 0.0),
        Light::Sun => (2, 0.0, 0.5),
    };
    let rows = [
        (bits(CENTER), kind),
        (bits([0.0, 0.0, -1.0]), radius.to_bits()),
        (bits([5.0, 3.0, 1.0]), measure.to_bits()),
        (bits([-1.0, -1.0, 2.0]), 0),
        (bits([1.0, 1.0, 2.0]), 0),
    ];
    let record: Vec<u32> = rows.into_iter().flat_map(|([x, y, z], w)| [x, y, z, w]).collect();
    let sample = |_| match light {
        Light::Flat => [random.signed(), random.signed(), 2.0, 1.0],
        Light::Sphere => [0.7 * random.signed(), 0.7 * random.signed(), 0.0, 1.0],
        Light::Sun => [0.05 * random.signed(), 0.05 * random.signed(), 1.0, 0.0],
    };
    let total = count * if row > 0 { sets * sets } else { sets };
    let samples: Vec<[f32; 4]> = (0..total).map(sample).collect();
    let radiance = |at: u32| if at % 11 == 5 { [0.0; 4] } else { [random.unit(), random.unit(), 1.0, 0.0] };
    let radiance: Vec<[f32; 4]> = (0..total).map(radiance).collect();
    let receiver = |at: usize| {
        let kind = [1, 1, 1, 2, 0][at % 5];
        let far = if at.is_multiple_of(7) { 0.4 } else { 3.0 };
        let position = [far * random.signed(), far * random.signed(), 2.0 + far * random.signed()];
        // Every other one mirrors the light, more or less, into the eye.
        let normal = if at.is_multiple_of(2) { unit(random) } else { mirroring(position, random) };
        Receiver::new(position, if kind == 0 { u32::MAX } else { random.below(40) }, normal, kind)
    };
    let receivers: Vec<Receiver> = (0..RECEIVERS).map(receiver).collect();
    let material = |at: usize| {
        let specular = if exponent > 0.0 { [0.0, 0.04, 0.5][at % 3] } else { 0.0 };
        let color = if at == 0 { [0.0; 3] } else { [random.unit(), random.unit(), random.unit()] };
        [color[0], color[1], color[2], specular, exponent, 0.0, 0.0, 0.0]
    };
    let materials: Vec<[f32; 8]> = (0..MATERIALS).map(material).collect();
    let eye = bits(EYE);
    let shading = [eye[0], eye[1], eye[2], u32::from(adds), 0.25_f32.to_bits(), 3, 0, 0];
    let words = count.div_ceil(32);
    let mask = |at: usize| [0, u32::MAX, random.word(), random.word() & random.word()][at / words as usize % 4];
    let blocked: Vec<u32> = (0..RECEIVERS * words as usize).map(mask).collect();
    let decided: Vec<u32> =
        (0..RECEIVERS).map(|at| if at.is_multiple_of(3) { 0 } else { 1 + random.below(count) }).collect();
    let part = |at: usize| [0.0, 1.0, random.unit()][(at / count as usize + at % 5) % 3];
    let transmittance: Vec<f32> = (0..RECEIVERS * count as usize).map(part).collect();
    Case::new(FILE, "integrated")
        .items(RECEIVERS)
        .with("light", &record)
        .with("sampling", &[count, words, count, 0, 1, sets, row, 5])
        .with("shading", &shading)
        .with("receivers", &receivers)
        .with("light_samples", &samples)
        .with("sample_radiance", &radiance)
        .with("triangle_materials", &(0..40).map(|_| random.below(MATERIALS as u32)).collect::<Vec<u32>>())
        .with("materials", &materials)
        .with("color", &(0..4 * RECEIVERS).map(|_| random.unit()).collect::<Vec<f32>>())
        .with("blocked", &blocked)
        .with("decided", &decided)
        .with("sample_transmittance", &transmittance)
        .with("visibility", &(0..3 * RECEIVERS).map(|_| random.unit()).collect::<Vec<f32>>())
}

const ENTRIES: [&str; 3] = ["integrated", "integrated_attenuated", "modulated"];

#[test]
fn matt_surfaces_are_shaded_alike() {
    for light in [Light::Flat, Light::Sphere, Light::Sun] {
        for (k, sampling) in [[1, 1, 0], [8, 4, 37], [33, 1, 0], [64, 16, 0]].into_iter().enumerate() {
            let case = case(light, sampling, k % 2 == 0, 0.0, &mut Random::new(k as u64));
            ENTRIES.iter().for_each(|entry| case.entry(entry).compare(|_| Same::Bits));
        }
    }
}

/// Colours of the order of 1 that differ by what the driver's logarithm leaves out times the exponent: near 1, where highlights are, it
/// is the difference of two numbers near 1.
#[test]
fn highlights_are_shaded_alike() {
    for (exponent, within) in [(2.0, 1e-6), (30.0, 3e-6), (4998.0, 1e-3)] {
        for light in [Light::Flat, Light::Sphere, Light::Sun] {
            let case = case(light, [33, 1, 0], true, exponent, &mut Random::new(7));
            ENTRIES.iter().for_each(|entry| case.entry(entry).compare(|_| Same::Within(within)));
        }
    }
}

#[test]
fn colors_of_neighbours_are_averaged_alike() {
    for (tile, size) in images() {
        let random = &mut Random::new(100 + u64::from(tile));
        let pixels = size[0] * size[1];
        let color = (0..4 * pixels).map(|_| random.unit()).collect::<Vec<f32>>();
        image(tile, size, 1, random)
            .kernel("shading/interleave_colors.wgsl", "interleave_colors")
            .with("triangle_materials", &(0..pixels).map(|pixel| pixel / 3 % 2).collect::<Vec<u32>>())
            .with("noisy_color", &color)
            .with("color", &color)
            .compare(|_| Same::Bits);
    }
}
