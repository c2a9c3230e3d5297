//! Coverage from tables: neighbours tile the light, and what differs lies within a cell of an edge.

use glam::Vec3;
use softshadow_native::depth_complexity::coverage::crossed_exactly;
use softshadow_native::depth_complexity::edge::ProjectedEdge;
use softshadow_native::depth_complexity::{Coverage, CoverageTables, Receiver, Seen};

use crate::scene::{Random, Setup, Soup};
use crate::shapes::{aimed, ball, leaves, shapes, soup, square, torus};

fn tables(setup: &Setup, directions: usize, lines: usize) -> CoverageTables {
    CoverageTables::new(&setup.samples, directions, lines, lines)
}

/// Differing samples, samples, and the largest number that differ at one receiver.
fn against_exact(setup: &Setup, tables: &CoverageTables, random: &mut Random, count: usize) -> (usize, usize, u32) {
    let mut counts = (0, 0, 0);
    for _ in 0..count {
        let receiver = Receiver { position: random.point([-1.0, -1.0, -0.9], [1.0, 1.0, -0.4]), ..Receiver::default() };
        let exact: Seen<4> = setup.technique(Coverage::Exact, false).see(&receiver);
        let quick: Seen<4> = setup.technique(Coverage::Tables(tables), false).see(&receiver);
        let different = (0..4).map(|w| (exact.hidden[w] ^ quick.hidden[w]).count_ones()).sum();
        counts.0 += different as usize;
        counts.1 += setup.samples.len();
        counts.2 = counts.2.max(different);
    }
    counts
}

#[test]
fn finer_tables_are_closer_to_exact() {
    for (name, shape) in shapes(1.0, 3.0) {
        let light = aimed(shape, [0.3, 0.4, 3.0], [0.0; 3]);
        let setup = Setup::new(soup(&torus([0.0; 3], 0.4, 0.17, 40, 24)), light, 64);
        let share = |lines: usize| {
            let (differ, samples, _) = against_exact(&setup, &tables(&setup, 4 * lines, lines), &mut Random(51), 4000);
            differ as f64 / samples as f64
        };
        let [coarse, fine] = [share(32), share(512)];
        if name == "sphere" {
            assert_eq!((coarse, fine), (0.0, 0.0), "a sphere's samples move: exact coverage");
        } else {
            assert!(coarse > 5.0 * fine && fine < 2e-3 && fine > 0.0, "{name}: {coarse} {fine}");
        }
    }
}

#[test]
fn sectors_tile_whatever_the_resolution() {
    // Eight directions for the whole circle. Samples may move by a cell, but none may be counted twice or left out: the counters of a
    // closed mesh stay even and never negative, so that far from every edge nothing changes.
    let setup = Setup::new(soup(&ball([0.0; 3], 0.35, 3)), aimed(square(1.0), [0.3, 0.4, 3.0], [0.0; 3]), 64);
    let coarse = CoverageTables::new(&setup.samples, 8, 512, 512);
    let mut random = Random(52);
    let (mut worst, mut partly) = (0, 0);
    for _ in 0..4000 {
        let receiver = Receiver { position: random.point([-1.0, -1.0, -0.9], [1.0, 1.0, -0.4]), ..Receiver::default() };
        let exact = setup.see(&receiver);
        let quick: Seen<1> = setup.technique(Coverage::Tables(&coarse), false).see(&receiver);
        worst = worst.max((exact.hidden[0] ^ quick.hidden[0]).count_ones());
        partly += usize::from(exact.hidden[0] != 0 && exact.hidden[0] != !0);
        if exact.hidden[0] == 0 && exact.silhouettes == 0 {
            assert_eq!(quick.hidden[0], 0);
        }
    }
    assert!(partly > 500);
    // A gap between two sectors would hide or bare all samples beyond it, up to 64.
    assert!(worst < 24, "{worst} samples differ at one receiver");
}

#[test]
fn every_sample_count_fits() {
    let mesh: Soup = leaves(&mut Random(53), 80, 0.4, [-0.5; 3], [0.5; 3]);
    let mut random = Random(54);
    for samples in [16, 32, 64, 128, 256] {
        let setup = Setup::new(mesh.clone(), aimed(square(1.0), [0.3, 0.4, 3.0], [0.0; 3]), samples);
        let fine = tables(&setup, 2048, 512);
        assert_eq!(fine.words(), (samples as usize).div_ceil(64));
        let (differ, of, _) = against_exact(&setup, &fine, &mut random, 1000);
        assert!((differ as f64) < 3e-3 * of as f64, "{samples}: {differ} of {of}");
        for _ in 0..300 {
            let position = random.point([-1.0, -1.0, -0.9], [1.0, 1.0, -0.6]);
            let receiver = Receiver { position, ..Receiver::default() };
            let seen: Seen<4> = setup.technique(Coverage::Exact, false).see(&receiver);
            let hidden = setup.tracer.hidden(&Setup::true_receiver(&receiver), &setup.targets(&receiver));
            for (sample, truth) in hidden.iter().enumerate() {
                assert_eq!(seen.hidden[sample / 64] >> (sample % 64) & 1 == 1, *truth, "{samples} {position:?}");
            }
            let share = 1.0 - hidden.iter().filter(|h| **h).count() as f32 / samples as f32;
            assert!((seen.sampled - share).abs() < 1e-6);
        }
    }
}

#[test]
fn edges_seen_end_on_wrap_by_signs() {
    // Two ends in nearly the same direction: which of them comes first is the side of c. Comparing their angles can contradict it, and
    // half of all samples would be crossed.
    let setup = Setup::new(Soup::new(), aimed(square(1.0), [0.3, 0.4, 3.0], [0.0; 3]), 64);
    let fine = tables(&setup, 2048, 512);
    let mut random = Random(55);
    let mut worst = 0;
    for _ in 0..400_000 {
        let (angle, turn) = (random.within(0.0, std::f64::consts::TAU), random.within(-2e-7, 2e-7));
        let end =
            |angle: f64, length: f64| Vec3::new((angle.cos() * length) as f32, (angle.sin() * length) as f32, 1.0);
        let ends = [end(angle, random.within(0.01, 0.3)), end(angle + turn, random.within(0.3, 2.0))];
        let image = ProjectedEdge::from_images(ends, ends[1] - ends[0]);
        let mask: [u64; 1] = fine.crossed(&image, image.directions().unwrap());
        worst = worst.max(mask[0].count_ones());
    }
    assert!(worst <= 3, "{worst} samples between two ends 2e-7 apart");
}

#[test]
fn what_lies_behind_the_reference_point_is_never_crossed() {
    // An edge ahead of c, with a line that rounding has put on c's other side: seen from it a sample behind c lies beyond.
    let ends = [Vec3::new(1.0, 1.0, 1.0), Vec3::new(1.0, -1.0, 1.0)];
    let right = ProjectedEdge::from_images(ends, ends[1] - ends[0]);
    let rounded = ProjectedEdge { line: Vec3::new(right.line.x, right.line.y, 1e-9), ..right };
    assert!(right.line.z < 0.0 && !right.has_reference_left);
    let (ahead, behind) = ([[1.5, 0.1]], [[-0.5, 0.1]]);
    let directions = right.directions().unwrap();
    assert_eq!(crossed_exactly::<1>(&right, directions, &ahead), [1]);
    for image in [right, rounded] {
        assert_eq!(crossed_exactly::<1>(&image, directions, &behind), [0]);
    }
}
