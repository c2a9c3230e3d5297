//! From masks to visibility.

use crate::harness::Same;
use crate::one_kernel::{Case, Random, Receiver};

const FILE: &str = "resolve/resolve.wgsl";

/// No multiple of what kernels take at once, and more than one run of the threads.
const RECEIVERS: usize = 1029;

/// `Sampling`.
struct Sampling {
    count: u32,
    pass_index: u32,
    passes: u32,
    sets: u32,
    row: u32,
}

impl Sampling {
    fn words(&self) -> [u32; 8] {
        let Self { count, pass_index, passes, sets, row } = *self;
        [count, count.div_ceil(32), count, pass_index, passes, sets, row, 3]
    }

    /// Samples of all sets.
    fn total(&self) -> usize {
        (self.count * if self.row > 0 { self.sets * self.sets } else { self.sets }) as usize
    }
}

/// Counts of samples at the ends of words, sets shared, drawn and placed, and the first, a middle and the last of several passes.
fn samplings() -> impl Iterator<Item = Sampling> {
    let passes = [(0, 1), (0, 4), (2, 4), (3, 4)];
    let sets = [(1, 0), (16, 0), (3, 37)];
    let counts = [1, 2, 31, 32, 33, 64, 256];
    counts.into_iter().enumerate().flat_map(move |(k, count)| {
        let (sets, row) = sets[k % 3];
        passes.map(move |(pass_index, passes)| Sampling { count, pass_index, passes, sets, row })
    })
}

/// Masks that are all open, all hidden, mixed, and with bits beyond the last sample; some receivers decided by a few samples.
fn with_masks(case: Case, sampling: &Sampling, random: &mut Random) -> Case {
    let words = sampling.count.div_ceil(32);
    let word = |random: &mut Random, receiver: usize| match receiver % 4 {
        0 => 0,
        1 => u32::MAX,
        _ => random.word(),
    };
    let blocked: Vec<u32> =
        (0..RECEIVERS).flat_map(|at| (0..words).map(|_| word(random, at)).collect::<Vec<_>>()).collect();
    let decided: Vec<u32> =
        (0..RECEIVERS).map(|at| if at.is_multiple_of(3) { 0 } else { 1 + random.below(sampling.count) }).collect();
    case.with("sampling", &sampling.words()).with("blocked", &blocked).with("decided", &decided)
}

/// What earlier passes left, or would have left.
fn with_slots(case: Case, random: &mut Random) -> Case {
    let mut slots = |scale: f32| (0..3 * RECEIVERS).map(|_| scale * random.unit()).collect::<Vec<f32>>();
    let case = case.with("visibility", &slots(1.0)).with("standard_error", &slots(0.5));
    case.with("pass_values", &vec![0x7fc0_0001_u32; 4 * RECEIVERS])
}

/// Radiance with channels that are dark in some sets, and all of them in one.
fn with_radiance(case: Case, sampling: &Sampling, random: &mut Random) -> Case {
    let sample = |at: usize| {
        let lit = |channel: usize| !(at / sampling.count as usize + channel).is_multiple_of(3);
        let mut radiance = [0, 1, 2].map(|channel| if lit(channel) { 2.0 * random.unit() } else { 0.0 });
        if random.below(5) == 0 {
            radiance = [0.0; 3];
        }
        [radiance[0], radiance[1], radiance[2], 0.0]
    };
    case.with("sample_radiance", &(0..sampling.total()).map(sample).collect::<Vec<[f32; 4]>>())
}

/// All of the light, none, and any part of it; the same for all samples, and each its own.
fn with_transmittance(case: Case, sampling: &Sampling, random: &mut Random) -> Case {
    let part = |random: &mut Random| [0.0, 1.0, random.unit(), random.unit() * 1e-3][random.below(4) as usize];
    let of = |receiver: usize| {
        let all = part(random);
        let each = |random: &mut Random| if receiver.is_multiple_of(3) { all } else { part(random) };
        (0..sampling.count).map(|_| each(random)).collect::<Vec<f32>>()
    };
    case.with("sample_transmittance", &(0..RECEIVERS).flat_map(of).collect::<Vec<f32>>())
}

/// Areas near their samples and far from them, with the sign that says that they answer and without, and -0.
fn with_areas(case: Case, sampling: &Sampling, random: &mut Random) -> Case {
    let bound = 2.0 * (sampling.count as f32).powf(-0.75);
    let area = |at: usize| match at % 5 {
        0 => (random.unit() * bound).to_bits() | 1 << 31,
        1 => (1.0 - random.unit() * bound).to_bits() | 1 << 31,
        2 => 1 << 31,
        3 => random.unit().to_bits() | 1 << 31,
        _ => random.unit().to_bits(),
    };
    case.with("areas", &(0..RECEIVERS).map(area).collect::<Vec<u32>>())
}

fn case(sampling: &Sampling) -> Case {
    let random = &mut Random::new(u64::from(sampling.count + 1000 * sampling.pass_index));
    let case = with_masks(Case::new(FILE, "resolve").items(RECEIVERS), sampling, random);
    let case = with_radiance(with_slots(case, random), sampling, random);
    with_areas(with_transmittance(case, sampling, random), sampling, random)
}

#[test]
fn masks_areas_and_transmittances_are_resolved_alike() {
    let entries = ["resolve", "resolve_areas", "resolve_textured", "resolve_attenuated", "resolve_attenuated_textured"];
    for sampling in samplings() {
        for entry in entries {
            case(&sampling).entry(entry).compare(|buffer| match (entry, buffer) {
                // The driver takes the 1 − v of v (1 − v), where v = 1 − h, for h: the last bit of an error of at most 1.
                ("resolve", "standard_error") if sampling.passes == 1 => Same::Within(6e-8),
                _ => Same::Bits,
            });
        }
    }
}

#[test]
fn values_of_a_pass_are_kept_alike() {
    let entries = ["keep_samples", "keep_areas", "keep_textured", "keep_attenuated", "keep_attenuated_textured"];
    for sampling in samplings().filter(|sampling| sampling.passes == 1) {
        entries.iter().for_each(|entry| case(&sampling).entry(entry).compare(|_| Same::Bits));
    }
}

#[test]
fn samples_are_masked_and_opened_alike() {
    for sampling in samplings().filter(|sampling| sampling.passes == 1) {
        let masked = with_slots(case(&sampling), &mut Random::new(1));
        masked.kernel("resolve/mask_samples.wgsl", "mask_samples").compare(|_| Same::Bits);
        masked.kernel("resolve/open_samples.wgsl", "open_samples").compare(|_| Same::Bits);
    }
}

/// An image of a plane with steps, folds and holes, and what its pixels saw alone; `Interleaving` with it.
pub(crate) fn image(tile: u32, [width, height]: [u32; 2], channels: u32, random: &mut Random) -> Case {
    let eye = [0.1_f32, 0.2, 3.0];
    let receiver = |pixel: u32| {
        let at = [(pixel % width) as f32 * 0.05, (pixel / width) as f32 * 0.05];
        // Slopes turn within a patch by about as much as is continuous; some patches lie a step behind others.
        let patch = (pixel % width / 5 + pixel / width / 4) % 3;
        let tilt = [0.07 * random.signed(), 0.07 * random.signed() + 0.1 * patch as f32];
        let length = (1.0 + tilt[0] * tilt[0] + tilt[1] * tilt[1]).sqrt();
        let normal = [tilt[0] / length, tilt[1] / length, 1.0 / length];
        let position = [at[0], at[1], 0.04 * patch as f32 - tilt[0] * at[0] - tilt[1] * at[1]];
        let kind = [1, 1, 1, 1, 1, 1, 1, 2, 0][random.below(9) as usize];
        Receiver::new(position, if kind == 0 { u32::MAX } else { pixel }, normal, kind)
    };
    let receivers: Vec<Receiver> = (0..width * height).map(receiver).collect();
    let value = |pixel: u32| {
        // An area answers every seventh.
        let known = if pixel.is_multiple_of(7) { 0.0 } else { 1.0 + random.below(64) as f32 };
        [random.unit(), random.unit(), random.unit(), known]
    };
    let values: Vec<[f32; 4]> = (0..width * height).map(value).collect();
    let interleaving = [eye[0].to_bits(), eye[1].to_bits(), eye[2].to_bits(), tile, width, height, channels, 0];
    Case::new(FILE, "interleave")
        .items((width * height) as usize)
        .with("interleaving", &interleaving)
        .with("receivers", &receivers)
        .with("pass_values", &values)
}

/// Squares of even and odd width, wider than the image too.
pub(crate) fn images() -> impl Iterator<Item = (u32, [u32; 2])> {
    [(1, [9, 7]), (2, [33, 41]), (3, [40, 30]), (4, [37, 29]), (5, [8, 3]), (4, [1, 17]), (6, [3, 2])].into_iter()
}

#[test]
fn neighbours_are_averaged_alike() {
    for (tile, size) in images() {
        for (channels, pass_index, passes) in [(1, 0, 1), (3, 0, 1), (1, 2, 3), (3, 1, 3)] {
            let random = &mut Random::new(u64::from(tile));
            let sampling = Sampling { count: 32, pass_index, passes, sets: tile, row: size[0] };
            let slots = 3 * (size[0] * size[1]) as usize;
            image(tile, size, channels, random)
                .with("sampling", &sampling.words())
                .with("visibility", &(0..slots).map(|_| random.unit()).collect::<Vec<f32>>())
                .with("standard_error", &(0..slots).map(|_| random.unit()).collect::<Vec<f32>>())
                .compare(|_| Same::Bits);
        }
    }
}
