//! Hard cases, each against float64 rays on the same samples.

use softshadow_native::depth_complexity::Receiver;
use softshadow_scene::{LocalScene, Material, Mesh, Scene};

use crate::scene::{Random, Setup, Soup, on_triangle, opaque};
use crate::shapes::{above, aimed, ball, cuboid, leaves, plate, shapes, soup, square, torus};

/// Receivers for at least 10^6 samples.
const MANY: usize = 16_000;

/// How many samples differ from rays, and how many are hidden.
fn compare(setup: &Setup, receivers: impl IntoIterator<Item = [f32; 3]>) -> (usize, usize) {
    let mut counts = (0, 0);
    for position in receivers {
        let receiver = Receiver { position, ..Receiver::default() };
        let rays = setup.hidden_by_rays(&receiver);
        let different = setup.see(&receiver).hidden[0] ^ rays;
        counts.0 += different.count_ones() as usize;
        counts.1 += rays.count_ones() as usize;
    }
    counts
}

fn expect_none(name: &str, setup: &Setup, receivers: impl IntoIterator<Item = [f32; 3]>) {
    let (differing, hidden) = compare(setup, receivers);
    assert!(hidden > 1000, "{name}: only {hidden} samples are hidden");
    assert_eq!(differing, 0, "{name}");
}

fn below(random: &mut Random, count: usize) -> Vec<[f32; 3]> {
    (0..count).map(|_| random.point([-1.0, -1.0, -1.0], [1.0, 1.0, -0.6])).collect()
}

fn all_around(random: &mut Random, count: usize) -> Vec<[f32; 3]> {
    (0..count).map(|_| random.point([-1.0; 3], [1.0; 3])).collect()
}

fn lamp() -> softshadow_scene::Light {
    aimed(square(1.0), [0.3, 0.4, 3.0], [0.0; 3])
}

#[test]
fn bad_meshes() {
    let mut random = Random(11);
    let clean = || soup(&torus([0.0; 3], 0.4, 0.17, 20, 12));
    let mut random_faces = Random(12);
    let mut chosen = |share: f64| random_faces.within(0.0, 1.0) < share;
    let fins: Soup = clean().iter().step_by(3).map(|[a, b, _]| [*a, *b, a.map(|x| x * 1.4 + 0.01)]).collect();
    let slivers: Soup = clean()
        .iter()
        .flat_map(|[a, b, c]| {
            // Cut in two along a line that nearly is a side, and a triangle without area beside.
            let middle: [f32; 3] = std::array::from_fn(|k| (a[k] + b[k]) * 0.5);
            let near: [f32; 3] = std::array::from_fn(|k| middle[k] + (c[k] - middle[k]) * 1e-7);
            [[*a, near, *c], [near, *b, *c], [*a, *b, near], [*a, *a, *b]]
        })
        .collect();
    let cases: [(&str, Soup); 8] = [
        ("open", clean().into_iter().skip(60).collect()),
        ("25 % removed", clean().into_iter().filter(|_| !chosen(0.25)).collect()),
        ("flipped", clean().into_iter().map(|[a, b, c]| if chosen(0.5) { [b, a, c] } else { [a, b, c] }).collect()),
        ("duplicated", clean().into_iter().flat_map(|t| vec![t; if chosen(0.2) { 2 } else { 1 }]).collect()),
        ("three-faced", clean().into_iter().chain(fins).collect()),
        ("slivers", slivers),
        ("interpenetrating", clean().into_iter().chain(soup(&ball([0.3, 0.1, 0.0], 0.35, 2))).collect()),
        ("soup of leaves", leaves(&mut random, 300, 0.4, [-0.5; 3], [0.5; 3])),
    ];
    for (name, mesh) in cases {
        let setup = Setup::new(mesh, lamp(), 64);
        expect_none(name, &setup, below(&mut random, MANY));
    }
}

#[test]
fn unwelded_vertices_are_one() {
    // A soup has no indices at all: welding has to find every shared corner, or all edges would be borders.
    let setup = Setup::new(soup(&ball([0.0; 3], 0.5, 2)), lamp(), 64);
    assert_eq!(setup.occluders.edges.len(), 480);
    assert!(setup.occluders.edges.iter().all(|e| e.incidence_count == 2));
}

#[test]
fn half_buried_and_in_contact() {
    let mut random = Random(13);
    for (name, mesh) in [("ball", ball([0.0; 3], 0.5, 3)), ("torus", torus([0.0; 3], 0.5, 0.2, 24, 16))] {
        let setup = Setup::new(soup(&mesh), lamp(), 64);
        // Edges cross the plane through every receiver; many receivers are inside.
        expect_none(&format!("{name} half buried"), &setup, all_around(&mut random, MANY));
        // Receivers at the height of a ring of vertices, where ends lie in the plane itself.
        let rings: Vec<f32> = mesh.0.iter().map(|v| v[2] as f32).collect();
        let at_ring: Vec<[f32; 3]> =
            all_around(&mut random, MANY).into_iter().map(|p| [p[0], p[1], rings[random.below(rings.len())]]).collect();
        let level = Setup::new(soup(&mesh), above(square(1.0), [0.1, 0.05, 3.0]), 64);
        expect_none(&format!("{name} at a ring of vertices"), &level, at_ring);
    }
}

#[test]
fn contact_sweep() {
    let mut random = Random(14);
    // A plate at a height that is no float32 neighbour of a power of two, under all gaps.
    let setup = Setup::new(plate([0.05, 0.02, 0.3], 0.31), above(square(1.0), [0.1, 0.05, 3.0]), 64);
    for exponent in 1..=6 {
        let gap = 10f32.powi(-exponent);
        let under = (0..MANY / 4).map(|_| {
            // Under the plate and a little beside it, as far as the shadow's border reaches.
            let [x, y, _] = random.point([-0.5; 3], [0.6; 3]);
            [x, y, 0.3 - gap]
        });
        expect_none(&format!("gap {gap}"), &setup, under.collect::<Vec<_>>());
    }
    // Within a few gaps of the border.
    for exponent in 2..=6 {
        let gap = 10f64.powi(-exponent);
        let edge = (0..MANY / 4).map(|_| {
            [(0.36 + random.within(-1.0, 1.0) * gap) as f32, random.within(-0.2, 0.2) as f32, (0.3 - gap) as f32]
        });
        expect_none(&format!("border, gap {gap}"), &setup, edge.collect::<Vec<_>>());
    }
}

#[test]
fn a_lattice_of_ties() {
    // Everything axis-aligned and dyadic: receivers, box, light. Lines through corners meet the light's middle everywhere.
    let mesh = soup(&cuboid([-0.5, -0.5, 0.0], [0.5, 0.5, 0.5]));
    let setup = Setup::new(mesh, above(square(2.0), [0.0, 0.0, 2.0]), 64);
    let lattice =
        |n: i32, z: f32| (-n..=n).flat_map(move |i| (-n..=n).map(move |j| [i as f32 / 32.0, j as f32 / 32.0, z]));
    let receivers: Vec<[f32; 3]> = [-1.0, -0.5, -0.25, -0.125].iter().flat_map(|z| lattice(32, *z)).collect();
    assert!(receivers.len() * 64 >= 1_000_000);
    expect_none("lattice", &setup, receivers);
}

#[test]
fn ties_of_samples_take_one_of_their_limits() {
    // Samples on the lattice, too: a sample on an edge's image has two limits, and has to take one of them.
    let mesh = soup(&cuboid([-0.5, -0.5, 0.0], [0.5, 0.5, 0.5]));
    let light = above(square(2.0), [0.0, 0.0, 2.0]);
    let mut setup = Setup::new(mesh, light, 64);
    let on_lattice = |shift: [f32; 2]| -> Vec<[f32; 2]> {
        (0..64).map(|i| [(i % 8) as f32 / 4.0 - 0.875 + shift[0], (i / 8) as f32 / 4.0 - 0.875 + shift[1]]).collect()
    };
    let shifts = [[0.0, 0.0], [1e-4, 3e-5], [-1e-4, 3e-5], [3e-5, 1e-4], [3e-5, -1e-4], [-3e-5, -1e-4], [1e-4, -3e-5]];
    let (mut ties, mut unexplained) = (0, 0);
    for i in -16i32..=16 {
        for j in -16i32..=16 {
            let receiver = Receiver { position: [i as f32 / 16.0, j as f32 / 16.0, -0.5], ..Receiver::default() };
            let mut limits = [0u64; 2];
            for (at, shift) in shifts.iter().enumerate().skip(1) {
                setup.parameters.parameters = on_lattice(*shift);
                let rays = setup.hidden_by_rays(&receiver);
                limits = if at == 1 { [rays, rays] } else { [limits[0] | rays, limits[1] & rays] };
            }
            setup.parameters.parameters = on_lattice(shifts[0]);
            setup.samples = setup.frame.samples(&setup.light, &setup.parameters);
            let edges = setup.see(&receiver).hidden[0];
            ties += (limits[0] ^ limits[1]).count_ones();
            unexplained += ((edges & !limits[0]) | (!edges & limits[1])).count_ones();
        }
    }
    assert!(ties > 300, "only {ties} ties");
    assert_eq!(unexplained, 0);
}

#[test]
fn rods_along_the_view_and_edges_along_the_light() {
    let mut random = Random(15);
    // A thin vertical rod: its long edges project to points as seen from below.
    let rod = soup(&cuboid([-0.01, -0.01, -0.5], [0.01, 0.01, 1.5]));
    let setup = Setup::new(rod, above(square(1.0), [0.0, 0.0, 3.0]), 64);
    let under: Vec<[f32; 3]> = (0..MANY)
        .map(|i| {
            let off = 10f64.powf(random.within(-7.0, -1.0));
            let around = random.direction() * if i % 10 == 0 { 0.0 } else { off };
            [around.x as f32, around.y as f32, -0.9]
        })
        .collect();
    expect_none("rod", &setup, under);
    // An edge turning through the directions parallel and perpendicular to the light.
    for turn in 0..=36 {
        let angle = f64::from(turn) * std::f64::consts::PI / 36.0;
        let (s, c) = if turn % 18 == 0 { (angle.sin().round(), angle.cos().round()) } else { angle.sin_cos() };
        let tip = |sign: f64| [(sign * c * 0.4) as f32, 0.0, (sign * s * 0.4) as f32];
        let setup = Setup::new(vec![[tip(1.0), tip(-1.0), [0.05, 0.3, 0.1]]], lamp(), 64);
        let (differing, _) = compare(&setup, all_around(&mut random, MANY / 32));
        assert_eq!(differing, 0, "turned by {turn} · 5°");
    }
}

#[test]
fn geometry_through_the_light() {
    let mut random = Random(16);
    for (name, shape) in shapes(1.0, 3.0) {
        let mesh: Soup = [
            soup(&ball([0.2, 0.1, 1.0], 0.3, 2)),
            soup(&torus([-0.1, 0.0, 0.95], 0.5, 0.2, 20, 12)),
            leaves(&mut random, 40, 0.5, [-0.6, -0.6, 0.6], [0.6, 0.6, 1.4]),
        ]
        .concat();
        let setup = Setup::new(mesh, aimed(shape, [0.05, 0.02, 1.0], [0.0, 0.0, -1.0]), 64);
        match name {
            "sun" => {}
            "sphere" => assert!(setup.occluders.touching.len() > 20),
            _ => assert!(setup.occluders.cut > 20 && setup.occluders.behind > 20, "{name}"),
        }
        expect_none(name, &setup, below(&mut random, MANY));
        expect_none(name, &setup, all_around(&mut random, MANY / 4));
    }
}

#[test]
fn light_inside_geometry_and_occluder_behind_the_light() {
    let mut random = Random(17);
    let around_light = soup(&ball([0.0, 0.0, 1.0], 0.8, 2));
    let setup = Setup::new(around_light, above(square(0.5), [0.0, 0.0, 1.0]), 64);
    expect_none("light inside a ball", &setup, all_around(&mut random, MANY));
    let behind = Setup::new(soup(&ball([0.0, 0.0, 1.5], 0.3, 2)), above(square(0.5), [0.0, 0.0, 1.0]), 64);
    assert!(behind.occluders.edges.is_empty());
    assert_eq!(behind.see(&Receiver::default()).sampled, 1.0);
    let sphere = softshadow_scene::LightShape::Sphere { radius: 0.2 };
    let ball_behind = Setup::new(soup(&ball([0.0, 0.0, 1.6], 0.3, 2)), above(sphere, [0.0, 0.0, 1.0]), 64);
    assert_eq!(compare(&ball_behind, below(&mut random, 1000)), (0, 0));
    expect_none(
        "either side of a ball of light",
        &ball_behind,
        all_around(&mut random, MANY * 4).into_iter().map(|p| [p[0] * 2.0, p[1] * 2.0, p[2] * 3.0]),
    );
}

#[test]
fn inside_a_closed_occluder_nothing_is_seen() {
    let mut random = Random(18);
    let setup = Setup::new(soup(&ball([0.0; 3], 0.9, 3)), lamp(), 64);
    for _ in 0..2000 {
        let position = random.point([-0.5; 3], [0.5; 3]);
        assert_eq!(setup.see(&Receiver { position, ..Receiver::default() }).hidden[0], !0);
    }
}

#[test]
fn faces_in_one_plane_with_the_reference_point_tear_nothing() {
    // A triangle whose plane holds c, and receivers in that plane and around it: c lies within rounding of all its edges' images.
    let light = above(square(1.0), [0.1, 0.2, 3.0]);
    let bare = Setup::new(Soup::new(), light.clone(), 64);
    let c = bare.frame.reference.map(f64::from);
    // The light's frame has y turned.
    let c = glam::DVec3::new(0.1 + c[0] * 0.5, 0.2 - c[1] * 0.5, 3.0);
    let (across, down) = (glam::DVec3::new(0.6, 0.8, 0.0), glam::DVec3::NEG_Z);
    let normal = across.cross(down);
    let corner = |s: f64, t: f64| (c + across * s + down * t).as_vec3().to_array();
    for (name, mesh) in [
        ("ahead", vec![[corner(-0.8, 0.5), corner(0.9, 0.7), corner(0.1, 2.0)]]),
        // Beside the receivers: inside a face visibility jumps.
        ("partly behind", vec![[corner(1.2, 0.5), corner(1.9, 0.7), corner(1.3, 6.0)]]),
    ] {
        let setup = Setup::new(mesh, light.clone(), 64);
        let mut random = Random(26);
        for off in [0.0, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4] {
            let (mut torn, mut most) = (0, 0);
            for _ in 0..4000 {
                let (s, t) = (random.within(-1.0, 1.0), random.within(2.1, 4.0));
                let p = (c + across * s + down * t + normal * random.within(-off, off)).as_vec3();
                let receiver = Receiver { position: p.to_array(), ..Receiver::default() };
                let differ = (setup.see(&receiver).hidden[0] ^ setup.hidden_by_rays(&receiver)).count_ones();
                torn += usize::from(differ > 8);
                most = most.max(differ);
            }
            assert_eq!(torn, 0, "{name}, {off} off the plane: {torn} receivers, up to {most} samples");
        }
    }
}

#[test]
fn lifted_receivers_on_edges_and_corners_of_bodies() {
    // With normal and triangle, as the receiver stage makes them: on an edge that two coplanar triangles share, an edge of the next
    // triangle passes 8e-7 below.
    let mut random = Random(27);
    let boxes = [
        soup(&cuboid([-0.5, -0.5, 0.0], [0.5, 0.5, 0.5])),
        [soup(&cuboid([-0.5; 3], [0.5, 0.5, 0.0])), soup(&cuboid([-0.2, -0.3, 0.0], [0.3, 0.2, 0.4]))].concat(),
        soup(&ball([0.0; 3], 0.5, 2)),
    ];
    for mesh in boxes {
        for (name, shape) in shapes(1.0, 3.0) {
            let setup = Setup::new(mesh.clone(), aimed(shape, [0.3, 0.4, 3.0], [0.0; 3]), 64);
            let (mut differing, mut most, mut visible) = (0, 0, 0);
            for i in 0..12_000 {
                let index = random.below(mesh.len());
                let mut flat = mesh[index];
                // All weight on two corners, or on one.
                flat[2] = flat[i % 2];
                let u = random.within(0.0, 1.0) as f32;
                let place: [f32; 3] = std::array::from_fn(|k| flat[0][k] + (flat[1 + i % 2][k] - flat[0][k]) * u);
                let near = [mesh[index][0], mesh[index][1], place];
                let Some(mut receiver) = on_triangle(&mut random, &mesh[index], index, glam::DVec3::Z * 9.0, 1.0)
                else {
                    continue;
                };
                let at = glam::Vec3::from(if i % 3 == 0 { near[i % 2] } else { near[2] });
                let lift = 14.0 * 5.960_464_5e-8 * (at.abs().max_element() + 1.0);
                receiver.position = (at + glam::Vec3::from(receiver.normal.unwrap()) * lift).to_array();
                let rays = setup.hidden_by_rays(&receiver);
                let differ = (setup.see(&receiver).hidden[0] ^ rays).count_ones();
                differing += differ;
                most = most.max(differ);
                visible += (!rays).count_ones();
            }
            assert!(visible > 100_000, "{name}");
            assert!(differing <= 7 && most <= 2, "{name}: {differing} samples differ, up to {most} at one receiver");
        }
    }
}

#[test]
fn just_in_front_of_the_light() {
    let mut random = Random(28);
    let mesh = [leaves(&mut random, 200, 0.5, [-0.6, -0.6, 0.2], [0.6, 0.6, 0.99])].concat();
    let setup = Setup::new(mesh, above(square(1.0), [0.1, 0.2, 1.0]), 64);
    for exponent in 1..=6 {
        let height = 10f64.powi(-exponent);
        let receivers: Vec<[f32; 3]> =
            (0..4000).map(|_| random.point([-0.5, -0.5, 1.0 - height], [0.7, 0.7, 1.0 - height])).collect();
        let (differing, _) = compare(&setup, receivers);
        assert_eq!(differing, 0, "{height} in front");
    }
}

#[test]
fn the_own_triangle_hides_nothing() {
    // Receivers a little inside a body, each told the triangle above it: light comes through that one and no other.
    let mut random = Random(25);
    let mesh = soup(&ball([0.0; 3], 0.6, 2));
    let setup = Setup::new(mesh.clone(), lamp(), 64);
    let (mut differing, mut passing) = (0, 0);
    for index in (0..mesh.len()).filter(|i| mesh[*i].iter().all(|v| v[2] > 0.2)) {
        for _ in 0..80 {
            let towards = glam::DVec3::new(0.3, 0.4, 3.0);
            let above = on_triangle(&mut random, &mesh[index], index, towards, 1.0).unwrap();
            let position = above.position.map(|x| x * 0.97);
            let own = Receiver { position, normal: None, triangle: Some(index as u32) };
            let rays = setup.hidden_by_rays(&own);
            differing += (setup.see(&own).hidden[0] ^ rays).count_ones();
            passing += (!rays).count_ones();
            assert_eq!(setup.see(&Receiver { triangle: None, ..own }).hidden[0], !0, "inside a closed body");
        }
    }
    assert!(passing > 50_000, "{passing} samples are seen through the own triangle");
    assert_eq!(differing, 0);
}

#[test]
fn receivers_on_corners_see_past_the_faces_there() {
    // Given neither a normal nor a triangle. The faces around a corner have no image, and hide nothing.
    let mesh = leaves(&mut Random(24), 4000, 0.1, [-0.5, -0.5, -0.5], [0.5, 0.5, 0.5]);
    let setup = Setup::new(mesh.clone(), lamp(), 64);
    let (mut hidden, mut differing) = (0, 0);
    for (index, leaf) in mesh.iter().enumerate() {
        for position in *leaf {
            let free = Receiver { position, ..Receiver::default() };
            // Rays are told which leaf that is: in float64, too, its determinants are noise there.
            let rays = setup.hidden_by_rays(&Receiver { triangle: Some(index as u32), ..free });
            hidden += rays.count_ones();
            differing += (setup.see(&free).hidden[0] ^ rays).count_ones();
        }
    }
    assert!(hidden > 100_000);
    assert_eq!(differing, 0);
}

#[test]
fn receivers_inside_a_face_take_one_of_its_limits() {
    // A tilted face with dyadic points on it: visibility jumps there, and whichever side rounding chooses has to serve all samples.
    let face = [[-0.5, -0.5, -0.5], [0.5, -0.5, 0.0], [0.0, 0.5, 0.0]];
    let setup = Setup::new([vec![face], plate([0.0, 0.0, 0.5], 0.2)].concat(), lamp(), 64);
    let [a, b, c] = face.map(glam::Vec3::from);
    let normal = (b - a).cross(c - a).normalize();
    let rays = |p: glam::Vec3| setup.hidden_by_rays(&Receiver { position: p.to_array(), ..Receiver::default() });
    let (mut jumps, mut unexplained) = (0, 0);
    for i in 1..127 {
        // On the line through two corners an edge has no image either; rays and edges may both be wrong there.
        for j in (1..64).filter(|j| i + j != 64) {
            let p = a + (b - a) * (i as f32 / 64.0) + (c - a) * (j as f32 / 64.0);
            let edges = setup.see(&Receiver { position: p.to_array(), ..Receiver::default() }).hidden[0];
            let limits = [rays(p), rays(p + normal * 1e-6), rays(p - normal * 1e-6)];
            jumps += usize::from(limits[1] != limits[2]);
            unexplained += limits.iter().map(|limit| (limit ^ edges).count_ones()).min().unwrap_or_default();
        }
    }
    assert!(jumps > 1500, "{jumps}");
    assert_eq!(unexplained, 0);
}

#[test]
fn hundreds_of_layers_are_counted() {
    let mut random = Random(19);
    let mut stack = Soup::new();
    for layer in 0..300 {
        stack.extend(plate([0.0, 0.0, -0.5 + f64::from(layer) * 0.004], 0.2));
        if [1, 2, 63, 127, 128, 255, 299].contains(&layer) {
            let setup = Setup::new(stack.clone(), above(square(1.0), [0.1, 0.05, 3.0]), 64);
            expect_none(&format!("{layer} layers"), &setup, below(&mut random, 4000));
        }
    }
}

#[test]
fn t_junctions_are_hairlines() {
    let mut random = Random(20);
    // A plate whose long edge meets two short ones, the middle off the line by 1e-7.
    let [a, b, c, d]: [[f32; 3]; 4] = [[-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.5, 0.5, 0.0], [-0.5, 0.5, 0.0]];
    let middle = [0.03, 0.03 + 1e-7, 0.0];
    let mesh = vec![[a, b, c], [a, middle, d], [middle, c, d]];
    let setup = Setup::new(mesh, above(square(1.0), [0.1, 0.05, 3.0]), 64);
    let (differing, hidden) = compare(&setup, below(&mut random, 4 * MANY));
    assert!(hidden > 1_000_000);
    assert!(differing <= 2, "{differing} of {hidden} next to a T-junction differ from rays");
}

/// A torus and a ball in world coordinates, and the light's height.
fn world_scene(scale: f64, offset: [f64; 3]) -> Scene {
    let placed = |(vertices, faces): crate::shapes::Indexed, name: &str| {
        let vertices = vertices.iter().map(|v| std::array::from_fn(|k| v[k] * scale + offset[k])).collect();
        let faces = faces.iter().map(|f| f.map(|i| i as u32)).collect();
        Mesh::new(name, vertices, faces, Material::default()).unwrap()
    };
    let ball = placed(ball([0.25, 0.0, 0.5], 0.25, 2), "ball");
    Scene::new(vec![placed(torus([0.0; 3], 0.5, 0.25, 16, 8), "torus"), ball]).unwrap()
}

fn world_setup(scale: f64, offset: [f64; 3]) -> Setup {
    let local = LocalScene::new(&world_scene(scale, offset), None, u64::MAX / 2);
    let center = std::array::from_fn(|k| [0.125, 0.25, 3.0][k] * scale + offset[k]);
    let light = above(square(1.0 * scale), center);
    Setup::in_frame(local.triangles().collect(), local.frame, light, 64, opaque)
}

#[test]
fn scales_change_no_bit() {
    let mut random = Random(21);
    let base = world_setup(1.0, [0.0; 3]);
    let receivers = all_around(&mut random, MANY);
    let of = |setup: &Setup| -> Vec<u64> {
        receivers.iter().map(|p| setup.see(&Receiver { position: *p, ..Receiver::default() }).hidden[0]).collect()
    };
    let expected = of(&base);
    assert!(expected.iter().any(|m| *m != 0 && *m != !0));
    for power in [-20, -7, 1, 13, 20] {
        assert_eq!(of(&world_setup(2f64.powi(power), [0.0; 3])), expected, "2^{power}");
    }
    assert_ne!(of(&world_setup(1.5, [0.0; 3])), expected, "1.5 is no power of two");
    for power in [-20, 20] {
        expect_none("scaled", &world_setup(2f64.powi(power), [0.0; 3]), receivers.clone());
    }
}

#[test]
fn far_from_the_origin() {
    let mut random = Random(22);
    for offset in [[5e5, 4e6, 300.0], [524_288.0, 4_194_304.0, 0.0], [1e3, -1e5, 7.7]] {
        let setup = world_setup(1.0, offset);
        expect_none(&format!("{offset:?}"), &setup, all_around(&mut random, MANY));
    }
}

#[test]
fn the_order_of_triangles_changes_no_bit() {
    let mut random = Random(23);
    let mesh = soup(&torus([0.0; 3], 0.5, 0.2, 24, 16));
    let mut shuffled: Soup = mesh.iter().map(|[a, b, c]| [*c, *a, *b]).collect();
    shuffled.reverse();
    let (first, second) = (Setup::new(mesh, lamp(), 64), Setup::new(shuffled, lamp(), 64));
    for position in all_around(&mut random, 4000) {
        let receiver = Receiver { position, ..Receiver::default() };
        assert_eq!(first.see(&receiver), second.see(&receiver));
    }
}
