//! What must hold for the occluders of any triangles, and what must be left of chosen ones.

mod effects;
mod rules;

use rules::{check, check_winding, corners, sides};

use super::*;

type Triangle = [[f32; 3]; 3];

fn solid(triangles: &[Triangle]) -> Occluders {
    Occluders::new(triangles, |_| 1.0, &LightBoundary::None).unwrap()
}

fn cut_by(triangles: &[Triangle], point: [f64; 3], normal: [f64; 3]) -> Occluders {
    Occluders::new(triangles, |_| 1.0, &LightBoundary::Plane { point, normal }).unwrap()
}

fn closed_box(low: [f32; 3], high: [f32; 3]) -> Vec<Triangle> {
    let corner = |i: usize| [0, 1, 2].map(|k| if i >> k & 1 == 1 { high[k] } else { low[k] });
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).map(|t| t.map(corner)).collect()
}

fn unit_box() -> Vec<Triangle> {
    closed_box([-0.5, -0.25, 0.0], [0.75, 0.5, 0.625])
}

struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1 << 23) as f32 - 1.0
    }

    fn position(&mut self) -> [f32; 3] {
        [self.next(), self.next(), self.next()]
    }

    /// Multiples of 2^-10, so that 128-bit integers decide every determinant.
    fn dyadic(&mut self) -> [f32; 3] {
        self.position().map(|x| (x * 1024.0).round() / 1024.0)
    }

    fn unit(&mut self) -> [f64; 3] {
        glam::DVec3::from(self.position().map(f64::from)).normalize().to_array()
    }
}

fn tetrahedron([a, b, c, d]: [[f32; 3]; 4]) -> Vec<Triangle> {
    vec![[a, b, c], [a, d, b], [b, d, c], [c, d, a]]
}

/// A soup whose triangles share corners and edges at random.
fn soup(random: &mut Random, triangles: usize) -> Vec<Triangle> {
    let corners: Vec<[f32; 3]> = (0..12).map(|_| random.dyadic()).collect();
    let mut pick = || corners[((random.next() + 1.0) * 6.0) as usize % 12];
    (0..triangles).map(|_| [pick(), pick(), pick()]).collect()
}

/// Edges with the triangles at them instead of the faces: what does not depend on the order of faces.
fn by_triangle(occluders: &Occluders, triangle: impl Fn(u32) -> u32) -> Vec<([[f32; 3]; 2], Vec<u32>)> {
    let name = |i: Incidence| triangle(occluders.faces[(i >> 1) as usize].triangle) << 1 | i & 1;
    let list = occluders.edges.iter().map(|edge| {
        let range = edge.first_incidence as usize..(edge.first_incidence + edge.incidence_count) as usize;
        let mut names: Vec<u32> = occluders.incidences[range].iter().map(|&i| name(i)).collect();
        names.sort_unstable();
        ([edge.low, edge.high], names)
    });
    list.collect()
}

fn counts(occluders: &Occluders) -> Vec<u32> {
    let mut counts: Vec<u32> = occluders.edges.iter().map(|edge| edge.incidence_count).collect();
    counts.sort_unstable();
    counts
}

#[test]
fn a_closed_box_has_eighteen_edges_with_two_faces_each() {
    let occluders = solid(&unit_box());
    assert_eq!((occluders.faces.len(), occluders.edges.len()), (12, 18));
    assert_eq!(counts(&occluders), [2; 18]);
    assert_eq!((occluders.cut, occluders.behind, occluders.touching.len()), (0, 0, 0));
    assert!(occluders.faces.iter().all(|face| face.attenuation == OPAQUE && face.sides[3] == NO_SIDE));
    check(&occluders).and_then(|()| check_winding(&occluders)).unwrap();
}

#[test]
fn any_soup_keeps_its_rules_and_every_spoilt_entry_is_noticed() {
    let mut random = Random(1);
    for triangles in [1, 2, 7, 40, 300] {
        let occluders = solid(&soup(&mut random, triangles));
        check(&occluders).and_then(|()| check_winding(&occluders)).unwrap();
    }
    let spoil: [fn(&mut Occluders); 8] = [
        |o| o.edges[3].high[1] += 1e-3,
        |o| o.faces[5].sides[1] ^= 1,
        |o| o.faces[5].sides.swap(0, 1),
        |o| o.incidences[4] ^= 1,
        |o| o.incidences.swap(4, 30),
        |o| o.faces.swap(0, 7),
        |o| o.edge_tree.nodes[0].high[2] -= 1e-3,
        |o| o.face_tree.nodes.iter_mut().find(|n| n.leaf != 0).unwrap().leaf -= 1,
    ];
    let base = solid(&unit_box());
    for (index, spoil) in spoil.iter().enumerate() {
        let mut spoilt = base.clone();
        spoil(&mut spoilt);
        assert!(check(&spoilt).is_err(), "{index}");
    }
    let mut turned = base;
    turned.faces[2].normal = turned.faces[2].normal.map(|x| -x);
    assert!(check_winding(&turned).is_err(), "a plane turned round");
}

#[test]
fn order_and_winding_of_the_input_change_no_edge() {
    let mut random = Random(2);
    let triangles = soup(&mut random, 60);
    let base = solid(&triangles);
    let count = triangles.len() as u32;
    let turned: Vec<Triangle> = triangles.iter().rev().map(|&[a, b, c]| [c, b, a]).collect();
    let other = solid(&turned);
    assert_eq!(base.edges, other.edges);
    assert_eq!(base.edge_tree, other.edge_tree);
    assert_eq!(by_triangle(&base, |t| t), by_triangle(&other, |t| count - 1 - t));

    let mut moved = triangles;
    moved[0][0][0] += 1e-6;
    assert_ne!(base.edges, solid(&moved).edges, "a moved corner is a new one");
}

#[test]
fn a_negative_zero_is_a_zero() {
    let triangles = closed_box([0.0; 3], [0.75, 0.5, 0.625]);
    // Every second corner, so that one triangle holds zeros of both signs.
    let mut signed = triangles.clone();
    signed.as_flattened_mut().iter_mut().step_by(2).flatten().filter(|x| **x == 0.0).for_each(|x| *x = -0.0);
    let (base, other) = (solid(&triangles), solid(&signed));
    // As text, where -0.0 is not 0.0.
    assert_eq!(format!("{:?}{:?}", base.faces, base.edges), format!("{:?}{:?}", other.faces, other.edges));
}

#[test]
fn doubled_triangles_share_the_edges_of_the_single_ones() {
    let base = solid(&unit_box());
    let doubled = solid(&[unit_box(), unit_box()].concat());
    assert_eq!(counts(&doubled), [4; 18]);
    let ends = |occluders: &Occluders| {
        let mut list: Vec<_> = by_triangle(occluders, |t| t % 12).into_iter().collect();
        list.iter_mut().for_each(|(_, names)| names.dedup());
        list.sort_by(|a, b| a.partial_cmp(b).unwrap());
        list
    };
    assert_eq!(ends(&base), ends(&doubled));
    check(&doubled).and_then(|()| check_winding(&doubled)).unwrap();
}

#[test]
fn a_cut_tetrahedron_stays_closed_up_to_the_plane() {
    let mut random = Random(3);
    let mut met = [0; 4];
    for _ in 0..3000 {
        let tips = [random.position(), random.position(), random.position(), random.position()];
        let (point, normal) = (random.position().map(|x| f64::from(x) * 0.5), random.unit());
        let height = |c: [f32; 3]| (0..3).map(|k| normal[k] * (f64::from(c[k]) - point[k])).sum::<f64>();
        let front = tips.iter().filter(|&&c| height(c) > 0.0).count();
        let occluders = cut_by(&tetrahedron(tips), point, normal);
        check(&occluders).unwrap();
        let sizes = |n: usize| occluders.faces.iter().filter(|face| sides(face).len() == n).count();
        // Faces with three and four sides, cut, behind, edges at the plane and edges that two faces share.
        let expected = match front {
            0 => [0, 0, 0, 4, 0, 0],
            1 => [3, 0, 3, 1, 3, 3],
            2 => [2, 2, 4, 0, 4, 5],
            3 => [1, 3, 3, 0, 3, 6],
            _ => [4, 0, 0, 0, 0, 6],
        };
        let shared = |n: u32| occluders.edges.iter().filter(|edge| edge.incidence_count == n).count();
        let got = [sizes(3), sizes(4), occluders.cut, occluders.behind, shared(1), shared(2)];
        assert_eq!(got, expected, "{tips:?} {point:?} {normal:?}");
        for edge in &occluders.edges {
            for corner in [edge.low, edge.high] {
                assert!(height(corner) >= -1e-7, "{}", height(corner));
                assert!(edge.incidence_count == 2 || height(corner) <= 1e-7, "{}", height(corner));
            }
        }
        for face in &occluders.faces {
            assert!(tips.contains(&face.point), "the plane is the whole triangle's");
            let ring: Vec<_> = corners(&occluders, face).into_iter().map(|c| glam::Vec3::from(c).as_dvec3()).collect();
            let area: glam::DVec3 = (1..ring.len() - 1).map(|k| (ring[k] - ring[0]).cross(ring[k + 1] - ring[0])).sum();
            // A sliver's part may be folded by rounding.
            assert!(area.dot(glam::Vec3::from(face.normal).as_dvec3()) > -1e-7);
        }
        let mut turned: Vec<Triangle> = tetrahedron(tips).iter().map(|&[a, b, c]| [b, a, c]).collect();
        turned.reverse();
        assert_eq!(cut_by(&turned, point, normal).edges, occluders.edges);
        met[front.min(3)] += 1;
    }
    assert!(met.iter().all(|&count| count > 100), "{met:?}");
}

#[test]
fn an_edge_is_cut_at_one_place_whichever_way_its_faces_run() {
    // Found by search: from high to low, the cut corner rounds to another float32.
    let unit = 2f32.powi(-24);
    let (low, high) = ([-15_864_339.0 * unit, 0.0, -12.0], [31_644_762.0 * unit, 0.0, 5.0]);
    // The edge is the second side of the first triangle and, run backward, the third of the other.
    let triangles = [[[-4.0, 1.0, 1.0], low, high], [low, [0.0, -1.0, 1.0], high]];
    let occluders = cut_by(&triangles, [0.0; 3], [0.0, 0.0, 1.0]);
    check(&occluders).unwrap();
    assert_eq!(occluders.cut, 2);
    let shared: Vec<_> = occluders.edges.iter().filter(|edge| edge.incidence_count == 2).collect();
    assert!(shared.len() == 1 && shared[0].high == high, "{:?}", occluders.edges);
}

#[test]
fn corners_on_the_plane_are_kept_and_shared() {
    let tips = [[0.0, 0.0, -0.3], [1.0, 0.0, 0.25], [0.0, 1.0, 0.25], [0.0, 0.0, 0.75]];
    let occluders = cut_by(&tetrahedron(tips), [0.0, 0.0, 0.25], [0.0, 0.0, 1.0]);
    check(&occluders).unwrap();
    assert_eq!((occluders.faces.len(), occluders.cut, occluders.behind), (3, 2, 1));
    assert_eq!(counts(&occluders), [1, 1, 1, 2, 2, 2]);
    let kept = occluders.edges.iter().flat_map(|edge| [edge.low, edge.high]);
    assert!(kept.clone().all(|c| c[2] >= 0.25) && tips[1..].iter().all(|&t| kept.clone().any(|c| c == t)));

    let touching = cut_by(&tetrahedron(tips)[2..3], [0.0, 0.0, 0.25], [0.0, 0.0, 1.0]);
    assert_eq!((touching.faces.len(), touching.cut, touching.behind), (1, 0, 0), "a side in the plane is no cut");
    let lying = cut_by(&[[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]], [0.0; 3], [0.0, 0.0, 1.0]);
    assert_eq!((lying.faces.len(), lying.cut, lying.behind), (0, 0, 1));
    assert_eq!(lying, Occluders { behind: 1, ..Occluders::default() });

    let tip = cut_by(&tetrahedron(tips)[..1], [1.0 - 1e-9, 0.0, 0.0], [1.0, 0.0, 0.0]);
    assert_eq!(tip, Occluders { cut: 1, ..Occluders::default() }, "a part that rounds to its tip");
}

#[test]
fn triangles_at_a_ball_of_light_are_set_apart() {
    let mut triangles = unit_box();
    triangles.extend(closed_box([2.0, 2.0, 2.0], [3.0, 3.0, 3.0]));
    let ball = LightBoundary::Ball { center: [0.125, 0.125, 1.0], radius: 0.375 };
    let opacity = |index: usize| if index < 12 { 0.5 } else { 1.0 };
    let occluders = Occluders::new(&triangles, opacity, &ball).unwrap();
    check(&occluders).unwrap();
    let touching: Vec<_> = occluders.touching.iter().map(|t| (t.triangle, t.attenuation)).collect();
    assert_eq!(touching, [(10, 4096), (11, 4096)], "the two triangles of the lid");
    assert!(occluders.touching.iter().all(|t| t.corners.is_sorted() && t.corners.iter().all(|c| c[2] == 0.625)));
    assert_eq!(occluders.faces.len(), 22);
    assert_eq!(counts(&occluders).iter().filter(|&&n| n == 1).count(), 4, "the lid is open");
}

#[test]
fn what_hides_nothing_is_left_out() {
    let sliver = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, f32::from_bits(1), 0.0]];
    let triangles = [
        [[0.0; 3], [0.0; 3], [1.0, 0.0, 0.0]],
        [[0.0; 3], [0.5, 0.25, 0.125], [1.0, 0.5, 0.25]],
        [[0.0; 3], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]],
        sliver,
    ];
    let occluders = Occluders::new(&triangles, |index| if index == 2 { 0.0 } else { 0.25 }, &LightBoundary::None);
    let occluders = occluders.unwrap();
    check(&occluders).unwrap();
    assert_eq!(occluders.faces.iter().map(|f| f.triangle).collect::<Vec<_>>(), [3], "a sliver has an area");
    assert_eq!(occluders.faces[0].normal.map(f32::abs), [0.0, 0.0, 1.0]);
    assert_eq!(occluders.faces[0].attenuation, 1700);
    assert_eq!(solid(&[]), Occluders::default());
}

#[test]
fn bad_input_is_named() {
    let triangles = unit_box();
    let opacity = |index: usize| if index == 7 { f32::NAN } else { 1.0 };
    let error = Occluders::new(&triangles, opacity, &LightBoundary::None).unwrap_err();
    assert!(error.to_string().starts_with("opacity of triangle 7: "), "{error}");
    let mut endless = triangles;
    endless[4][1][2] = f32::INFINITY;
    let error = Occluders::new(&endless, |_| 1.0, &LightBoundary::None).unwrap_err();
    assert!(error.to_string().ends_with("entry 4 is not finite"), "{error}");
}

#[test]
fn scaling_by_a_power_of_two_changes_no_plane_and_no_part() {
    let mut random = Random(4);
    let triangles = soup(&mut random, 60);
    let scaled = |s: f32| triangles.iter().map(|t| t.map(|c| c.map(|x| x * s))).collect::<Vec<Triangle>>();
    let parts = |s: f32| {
        let occluders = cut_by(&scaled(s), [0.1 * f64::from(s), 0.0, 0.0], [0.6, 0.0, 0.8]);
        check(&occluders).unwrap();
        let list = occluders.faces.iter().map(|face| {
            (face.triangle, face.normal, corners(&occluders, face).iter().map(|c| c.map(|x| x / s)).collect::<Vec<_>>())
        });
        let mut list: Vec<_> = list.collect();
        list.sort_by_key(|entry| entry.0);
        (list, occluders.cut, occluders.behind)
    };
    assert!(parts(1.0).1 > 0);
    for scale in [2f32.powi(-90), 2f32.powi(40)] {
        assert_eq!(parts(scale), parts(1.0));
    }
}

#[test]
fn corners_are_no_farther_off_their_face_than_its_flatness() {
    let soup: Vec<[[f32; 3]; 3]> =
        (0..3000).map(|i| [0, 1, 2].map(|k| [0, 1, 2].map(|c| scatter(i, 3 * k + c)))).collect();
    let occluders = solid(&soup);
    let mut off = 0;
    for face in &occluders.faces {
        let normal = glam::Vec3::from(face.normal);
        for corner in soup[face.triangle as usize] {
            let height = normal.dot(glam::Vec3::from(corner) - glam::Vec3::from(face.point)).abs();
            assert!(height <= face.flatness);
            off += usize::from(height > 0.0);
        }
        assert!(face.flatness < 1e-6);
    }
    assert!(off > 1000, "rounding puts corners off the plane: {off}");
}

/// A number in [-1, 1) that looks random.
fn scatter(triangle: u32, coordinate: u32) -> f32 {
    let mixed = (triangle * 9 + coordinate).wrapping_mul(0x9E37_79B9) ^ 0x5bd1_e995;
    (mixed.wrapping_mul(mixed | 1) >> 8) as f32 / 8_388_608.0 - 1.0
}
