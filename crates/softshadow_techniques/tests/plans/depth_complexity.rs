//! What `depth_complexity` is told of a light, a block and its settings; and what hides a light, laid out.

use std::collections::BTreeSet;

use softshadow_plan::{Pass, Plan, Work};
use softshadow_scene::occluders::LightBoundary;
use softshadow_scene::{
    Camera, Light, LightFrame, LightShape, LocalScene, Material, Mesh, Outline, Points, Scene, look_at,
};
use softshadow_techniques::parts::occluder_buffers::boundary_of;
use softshadow_techniques::{Block, DepthComplexity, OccluderContents, ReceiverSource, Request, Technique, blocks};

use crate::requests::{Fixture, stage};

fn technique(samples: u32, exact_area: bool) -> Technique {
    Technique::DepthComplexity(DepthComplexity { samples, exact_area, ..DepthComplexity::default() })
}

fn words(value: &[u8]) -> Vec<u32> {
    value.chunks_exact(4).map(|w| u32::from_le_bytes(w.try_into().unwrap())).collect()
}

fn floats(value: &[u8]) -> Vec<f32> {
    words(value).into_iter().map(f32::from_bits).collect()
}

/// A light over the fixture's sheets.
fn light(shape: LightShape) -> Light {
    Light::new(shape, look_at([0.0, 0.0, 5.0], [0.0, 0.0, -9.0], Some([0.0, 1.0, 0.0])).unwrap()).unwrap()
}

/// A regular polygon.
fn polygon(corners: u32) -> LightShape {
    let corner = |n: u32| (std::f64::consts::TAU * f64::from(n) / f64::from(corners)).sin_cos();
    LightShape::Polygon { outline: (0..corners).map(|n| [corner(n).1, corner(n).0]).collect() }
}

#[test]
fn a_light_is_told_by_kind_corners_and_whether_area_is_visibility() {
    let fixture = Fixture::new();
    let sun = |angular_diameter| LightShape::Sun { angular_diameter };
    for (shape, kind, corners, has_area) in [
        (LightShape::Rectangle { width: 1.0, height: 0.5 }, 0, 4, true),
        (LightShape::Rectangle { width: 1.0, height: 0.0 }, 0, 0, false),
        (polygon(3), 0, 3, true),
        (polygon(64), 0, 64, true),
        // More corners than fit: samples answer.
        (polygon(65), 0, 0, false),
        (LightShape::Disc { radius: 1.0 }, 0, 0, true),
        (LightShape::Sphere { radius: 0.5 }, 1, 0, false),
        // The sun of the Earth, and one so wide that its middle counts for less than its border.
        (sun(0.0093), 2, 0, true),
        (sun(0.5), 2, 0, false),
    ] {
        let light = light(shape);
        let request = Request { light: &light, ..fixture.request(1, fixture.points()) };
        for (exact_area, channels) in [(true, 1), (false, 1), (true, 3)] {
            let (plan, values) = stage(&technique(65, exact_area), &Request { channels, ..request });
            let frame = words(&values["light frame"]);
            let by_area = exact_area && has_area && channels == 1;
            let corners = if by_area { corners } else { 0 };
            assert_eq!((frame[3], frame[15], frame[19]), (kind, corners, 65), "{:?}", light.shape());
            let fold = [0, 1].map(|group| words(&values[&format!("fold settings {group}")]));
            assert_eq!(fold.map(|fold| [fold[0], fold[1], fold[3]]), [[5, 0, 1], [5, 1, 1]], "{:?}", light.shape());
            // The first 64 samples come with the area. A sphere's samples move with the receiver.
            let without = if kind == 1 { "fold_own_samples" } else { "fold" };
            let first = if by_area { "fold_areas" } else { without };
            assert_eq!(folds(&plan), [first, without], "{:?}", light.shape());
            let outline = floats(&values["light outline"]);
            let expected = match LightFrame::new(&light, &fixture.scenes[1].local.frame).outline {
                Some(Outline::Polygon(corners)) => corners,
                _ => Vec::new(),
            };
            for (at, row) in outline.chunks_exact(4).enumerate() {
                let [x, y] = expected.get(at).copied().unwrap_or_default();
                assert_eq!(row, [x, y, 0.0, 0.0], "corner {at}");
            }
        }
    }
}

#[test]
fn a_frame_is_written_as_it_is() {
    let fixture = Fixture::new();
    for light in &fixture.lights {
        let request = Request { light, ..fixture.request(0, fixture.points()) };
        let (_, values) = stage(&technique(16, true), &request);
        let written = floats(&values["light frame"]);
        let frame = LightFrame::new(light, &fixture.scenes[0].local.frame);
        assert_eq!(written[24..30], [frame.reference, frame.bounds[0], frame.bounds[1]].concat());
        assert_eq!(written[11], frame.outline.map_or(0.0, |outline| outline.area() as f32));
        let row = |at: usize| <[f32; 3]>::try_from(&written[at..at + 3]).unwrap();
        match frame.kind {
            softshadow_scene::LightKind::Flat { origin, rows, axes } => {
                assert_eq!(([row(0), row(4), row(8), row(12)]), [origin, rows[0], rows[1], rows[2]]);
                assert_eq!([row(16), row(20)], axes);
            }
            softshadow_scene::LightKind::Sun { axes, tangent } => {
                assert_eq!(([row(4), row(8), row(12)], written[7]), (axes, tangent));
            }
            softshadow_scene::LightKind::Sphere { center, radius } => {
                assert_eq!((row(0), written[7]), (center, radius));
            }
        }
    }
}

#[test]
fn samples_fill_their_place_and_no_more() {
    let fixture = Fixture::new();
    let mut bounds = Vec::new();
    for samples in [1, 16, 33, 64, 256] {
        let (_, values) = stage(&technique(samples, true), &fixture.request(1, fixture.points()));
        let rows = floats(&values["frame samples"]);
        let is_set = |row: &[f32]| row.iter().any(|x| *x != 0.0);
        let set = rows.chunks_exact(4).take_while(|row| is_set(row)).count();
        assert_eq!((rows.len(), set), (4 * 256, samples as usize));
        assert!(!rows.chunks_exact(4).skip(set).any(is_set));
        let sampling = words(&values["sampling"]);
        assert_eq!(sampling, [samples, samples.div_ceil(32), samples, 0, 1, 1, 0, 0]);
        assert_eq!(words(&values["light frame"])[19], samples);
        bounds.push(f32::from_bits(words(&values["fold settings 0"])[2]));
        // Folds have 64 of them each.
        let groups: Vec<f32> =
            (0..samples.div_ceil(64)).flat_map(|group| floats(&values[&format!("group samples {group}")])).collect();
        assert_eq!(groups[..4 * samples as usize], rows[..4 * samples as usize]);
        assert!(groups[4 * samples as usize..].iter().all(|x| *x == 0.0) && groups.len().is_multiple_of(256));
    }
    // An area may differ from the samples that are folded with it by less, the more of them there are.
    assert!(bounds[..4].is_sorted_by(|a, b| a > b), "{bounds:?}");
    assert_eq!((bounds[0], bounds[1]), (2.0, 0.25));
}

/// Entry points of the folds of a plan.
fn folds(plan: &Plan) -> Vec<&'static str> {
    let entry = |pass: &Pass| match pass.work {
        Work::Compute { kernel, .. } if pass.label.starts_with("fold edges") => Some(kernel.entry),
        _ => None,
    };
    plan.passes.iter().filter_map(entry).collect()
}

/// The order in which receivers of a block are taken.
fn order(fixture: &Fixture, receivers: ReceiverSource<'_>, block: Block) -> Vec<u32> {
    let request = Request { receivers, block, ..fixture.request(1, fixture.points()) };
    words(&stage(&technique(16, true), &request).1["receiver order"])
}

/// The first index that stands twice or is beyond the end, if every one else stands once.
fn misplaced(order: &[u32]) -> Option<u32> {
    let mut seen = BTreeSet::new();
    order.iter().copied().find(|index| *index as usize >= order.len() || !seen.insert(*index))
}

#[test]
fn pixels_are_taken_in_squares_each_once() {
    let fixture = Fixture::new();
    for ([width, height], most) in
        [([8, 4], 32), ([16, 16], 1000), ([13, 11], 39), ([64, 3], 1000), ([1, 70], 9), ([200, 17], 1800)]
    {
        let camera = Camera::look_at([3.0, 0.5, 4.0], [0.0; 3], None, 45.0, [width, height]).unwrap();
        let source = ReceiverSource::Camera(&camera);
        for block in blocks((width * height) as usize, width as usize, 0, most) {
            let order = order(&fixture, source, block);
            assert_eq!((order.len(), misplaced(&order)), (block.count, None), "{width} x {height}, {block:?}");
        }
    }
    // Where eights fit, a tile is a square.
    let camera = Camera::look_at([3.0, 0.5, 4.0], [0.0; 3], None, 45.0, [24, 16]).unwrap();
    let block = Block { first: 0, count: 24 * 16, skip: 0, keep: 24 * 16 };
    for (tile, pixels) in order(&fixture, ReceiverSource::Camera(&camera), block).chunks_exact(64).enumerate() {
        let places: BTreeSet<_> = pixels.iter().map(|p| ((p % 24 / 8) as usize, (p / 24 / 8) as usize)).collect();
        assert_eq!(places, BTreeSet::from([(tile % 3, tile / 3)]));
        // And a bundle lies in a block of four by two.
        for bundle in pixels.chunks_exact(8) {
            let places: BTreeSet<_> = bundle.iter().map(|p| (p % 24 / 4, p / 24 / 2)).collect();
            assert_eq!(places.len(), 1, "{bundle:?}");
        }
    }
    assert_eq!(misplaced(&[0, 2, 1]), None);
    assert_eq!(misplaced(&[0, 2, 2]), Some(2));
    assert_eq!(misplaced(&[0, 3, 1]), Some(3));
}

#[test]
fn points_are_taken_with_their_neighbours() {
    let fixture = Fixture::new();
    // Eight clumps of 64 points in the corners of a cube, dealt out one by one; and a point that no block holds.
    let mut positions = vec![[99.0; 3]];
    for n in 0..512_u32 {
        let corner = [n & 1, n >> 1 & 1, n >> 2 & 1].map(f64::from);
        let small = f64::from(n) * 1e-4;
        positions.push([corner[0] - small, corner[1] + small, corner[2]]);
    }
    let points = Points::new(positions, None).unwrap();
    let block = Block { first: 1, count: 512, skip: 0, keep: 512 };
    let taken = order(&fixture, ReceiverSource::Points(&points), block);
    assert_eq!(misplaced(&taken), None);
    for tile in taken.chunks_exact(64) {
        let clumps: BTreeSet<u32> = tile.iter().map(|index| index % 8).collect();
        assert_eq!(clumps.len(), 1, "{tile:?}");
    }
    // Points in one place keep their order, and one point is no division by nothing.
    let same = Points::new(vec![[0.5; 3]; 100], None).unwrap();
    let block = |count| Block { first: 0, count, skip: 0, keep: count };
    assert_eq!(order(&fixture, ReceiverSource::Points(&same), block(100)), (0..100).collect::<Vec<_>>());
    assert_eq!(order(&fixture, ReceiverSource::Points(&same), block(1)), [0]);
    assert!(order(&fixture, ReceiverSource::Points(&same), block(0)).is_empty());
}

#[test]
fn lights_before_the_whole_scene_have_no_boundary() {
    let fixture = Fixture::new();
    let kinds = |scene: usize| {
        fixture.lights.iter().map(|light| boundary_of(&fixture.scenes[scene].local, light)).collect::<Vec<_>>()
    };
    assert_eq!(kinds(0), [LightBoundary::None; 6], "nothing can be behind a light");
    for scene in [1, 2] {
        let kinds = kinds(scene);
        for index in [0, 2, 3, 4] {
            assert_eq!(kinds[index], LightBoundary::None);
        }
        assert!(matches!(kinds[1], LightBoundary::Plane { .. }), "it lies between the sheets");
        assert!(matches!(kinds[5], LightBoundary::Ball { .. }), "it touches one");
    }
}

#[test]
fn occluders_say_what_they_are() {
    let fixture = Fixture::new();
    let told = |scene: usize, light: usize| {
        let o = &fixture.occluders[scene][light];
        let bytes: Vec<usize> = o.contents().map(|content| content.bytes.len()).collect();
        (bytes, o.edge_count, o.cut_triangles, o.triangles_behind)
    };
    // Faces, their corners, their tree, edges, faces at edges: four triangles in two sheets, or one sheet below a light between them.
    for scene in [1, 2] {
        assert_eq!(told(scene, 0), (vec![4 * 48, 4 * 48, 7 * 32, 10 * 32, 12 * 32], 10, 0, 0));
        assert_eq!(told(scene, 1), (vec![2 * 48, 2 * 48, 3 * 32, 5 * 32, 6 * 32], 5, 0, 2));
    }
    // A binding must not be empty.
    assert_eq!(told(0, 0), (vec![48, 48, 32, 32, 32], 0, 0, 0));
}

#[test]
fn what_stands_in_for_nothing_hides_nothing() {
    let fixture = Fixture::new();
    let nothing = &fixture.occluders[0][0];
    assert_eq!(words(&nothing.faces.bytes)[8..], [u32::MAX; 4], "a face without sides");
    let node = floats(&nothing.face_tree.bytes);
    assert!(node[0] > node[4] && node[1] > node[5] && node[2] > node[6], "a box inside out");
    assert_eq!(words(&nothing.face_tree.bytes)[3], 1, "the walk ends behind it");
    // Of a real face neither is true.
    let sheets = &fixture.occluders[1][0];
    assert!(words(&sheets.faces.bytes)[8..11].iter().all(|side| *side != u32::MAX));
    let node = floats(&sheets.face_tree.bytes);
    assert!(node[0] < node[4] && node[1] < node[5] && node[2] < node[6]);
}

#[test]
fn records_refer_to_each_other() {
    let fixture = Fixture::new();
    for occluders in [&fixture.occluders[1][0], &fixture.occluders[1][1]] {
        let (faces, edges) = (words(&occluders.faces.bytes), words(&occluders.edges.bytes));
        let incident = words(&occluders.incident_faces.bytes);
        let face_of = |triangle: u32| faces.chunks_exact(12).find(|face| face[3] == triangle).unwrap();
        let mut next = 0;
        for (index, edge) in edges.chunks_exact(8).enumerate() {
            assert_eq!(edge[3], next, "each edge's faces stand together");
            next += edge[7];
            for at in edge[3]..next {
                let side = &incident[8 * at as usize..][..8];
                let face = face_of(side[3] >> 1);
                // The face's normal, point and flatness, and a side of it that is this edge, turned the same way.
                assert_eq!((&side[..3], &side[4..8]), (&face[..3], &face[4..8]));
                assert!(face[8..].contains(&((index as u32) << 1 | side[3] & 1)), "edge {index}, {face:?}");
            }
        }
        assert_eq!(next as usize, incident.len() / 8);
    }
}

/// A scene of one triangle through the plane of a light that looks along x from the origin.
fn crossed() -> (LocalScene, Light) {
    let positions = vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]];
    let mesh = Mesh::new("blade", positions, vec![[0, 1, 2]], Material::default()).unwrap();
    let light = LightShape::Rectangle { width: 0.1, height: 0.1 };
    let way = look_at([0.0; 3], [9.0, 0.0, 0.0], None).unwrap();
    (LocalScene::new(&Scene::new(vec![mesh]).unwrap(), None, 1 << 20), Light::new(light, way).unwrap())
}

#[test]
fn triangles_across_a_light_are_cut_and_counted() {
    let (local, light) = crossed();
    let boundary = boundary_of(&local, &light);
    assert!(matches!(boundary, LightBoundary::Plane { .. }));
    let occluders = OccluderContents::new(&local, boundary).unwrap();
    assert_eq!((occluders.boundary, occluders.cut_triangles, occluders.triangles_behind), (boundary, 1, 0));
    // Half of the triangle is a triangle again, or has a fourth side where rounding puts the tip beside the plane.
    assert!((3..=4).contains(&occluders.edge_count));
    // Uncut it has three sides.
    let whole = OccluderContents::new(&local, LightBoundary::None).unwrap();
    assert_eq!((whole.edge_count, whole.cut_triangles), (3, 0));
}

#[test]
fn a_sphere_cuts_nothing() {
    let fixture = Fixture::new();
    let local = &fixture.scenes[1].local;
    // One between the sheets touches neither.
    let between = LightShape::Sphere { radius: 0.2 };
    let way = look_at([0.0, 0.0, 0.25], [0.0, 0.0, -9.0], Some([0.0, 1.0, 0.0])).unwrap();
    let boundary = boundary_of(local, &Light::new(between, way).unwrap());
    assert_eq!(boundary, LightBoundary::None, "it leaves everything as it is");
    let occluders = OccluderContents::new(local, boundary).unwrap();
    assert_eq!((occluders.edge_count, occluders.touching.is_some()), (10, false));
}
