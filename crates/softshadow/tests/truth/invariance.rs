//! What must not change a result: where a scene stands, its unit of length, the order of its triangles, and time.

use softshadow::{Camera, Light, LightShape, Material, Mesh, Receivers, Scene, Visibility, look_at, procedural};

use crate::common::{Random, bits, ray_traced, rectangle, see, surface_points};
use crate::shapes::{Point, Triangle, scene, triangles_of};

/// A scene, its light and two kinds of receivers, before anything is moved. All coordinates are multiples of 2^-20, so
/// that adding a whole number rounds nothing.
struct Original {
    triangles: Vec<Triangle>,
    eye_and_target: [Point; 2],
    light_and_target: [Point; 2],
    points: Vec<Point>,
}

const SAMPLES: u32 = 64;
const SIZE: [u32; 2] = [64, 48];

fn dyadic(p: Point) -> Point {
    p.map(|x| (x * 1_048_576.0).round() / 1_048_576.0)
}

fn original() -> Original {
    let described = procedural::shipped("toruses").unwrap();
    let (c, l) = (described.camera().clone(), described.light().clone());
    let triangles = triangles_of(&described.build().unwrap()).iter().map(|t| t.map(dyadic)).collect();
    let points = Random(9).points(1500, [-2.0, 2.0], [0.0, 1.2], [-2.0, 2.0]);
    Original {
        triangles,
        eye_and_target: [c.eye, c.target].map(dyadic),
        light_and_target: [l.position, l.target].map(dyadic),
        points: points.into_iter().map(dyadic).collect(),
    }
}

impl Original {
    /// Camera image and points of the scene under `scale·x + offset`.
    fn seen(&self, scale: f64, offset: Point) -> [Visibility; 2] {
        self.seen_as(&self.triangles, scale, offset)
    }

    fn seen_as(&self, triangles: &[Triangle], scale: f64, offset: Point) -> [Visibility; 2] {
        let place = |p: &Point| [0, 1, 2].map(|k| p[k] * scale + offset[k]);
        let moved: Vec<Triangle> = triangles.iter().map(|t| t.each_ref().map(place)).collect();
        let [at, target] = self.light_and_target.each_ref().map(place);
        let pose = look_at(at, target, None).unwrap();
        let lights = [
            Light::new(rectangle(1.5 * scale, 1.5 * scale), pose).unwrap(),
            Light::new(LightShape::Sphere { radius: 0.75 * scale }, pose).unwrap(),
        ];
        let [eye, target] = self.eye_and_target.each_ref().map(place);
        let camera = Receivers::Camera(Camera::look_at(eye, target, None, 40.0, SIZE).unwrap());
        let points = surface_points(self.points.iter().map(place).collect(), [0.3, 1.0, -0.2]);
        let scene = scene(&moved);
        [camera, points].map(|receivers| see(&scene, &lights, &receivers, &ray_traced(SAMPLES)))
    }
}

fn identical(a: &[Visibility; 2], b: &[Visibility; 2]) -> bool {
    a.iter().zip(b).all(|(a, b)| bits(a) == bits(b) && a.valid == b.valid)
}

/// Samples that differ, of how many.
fn differing(a: &[Visibility; 2], b: &[Visibility; 2]) -> (usize, usize) {
    let mut count = (0, 0);
    for (a, b) in a.iter().zip(b) {
        let words = |v: &Visibility| v.masks.as_ref().unwrap().bits.clone();
        let pairs: Vec<_> = words(a).into_iter().zip(words(b)).collect();
        count.0 += pairs.iter().map(|(a, b)| (a ^ b).count_ones() as usize).sum::<usize>();
        count.1 += pairs.len() * 32;
    }
    count
}

#[test]
fn the_same_call_twice_gives_the_same_bits() {
    let original = original();
    let first = original.seen(1.0, [0.0; 3]);
    assert!(identical(&first, &original.seen(1.0, [0.0; 3])));
    let spread = first[0].values.iter().filter(|v| **v > 0.1 && **v < 0.9).count();
    assert!(spread > 100, "an image without penumbra would be the same anyhow");
}

#[test]
fn a_power_of_two_changes_no_bit() {
    let original = original();
    let base = original.seen(1.0, [0.0; 3]);
    for power in [20, -20] {
        let scale = 2_f64.powi(power);
        let scaled = original.seen(scale, [0.0; 3]);
        assert!(identical(&base, &scaled), "2^{power}: {:?}", differing(&base, &scaled));
        let (a, b) = (base[0].placed.as_ref().unwrap(), scaled[0].placed.as_ref().unwrap());
        let same_place =
            |(a, b): (&Point, &Point)| a.iter().zip(b).all(|(a, b)| a * scale == *b || a.is_nan() && b.is_nan());
        assert!(a.positions.iter().zip(&b.positions).all(same_place), "receivers lie where they lay, 2^{power} as far");
    }
    let tripled = original.seen(3.0, [0.0; 3]);
    println!("scaled by 3: {:?} samples differ", differing(&base, &tripled));
    assert_ne!(base[0].placed, tripled[0].placed);
    let moved = original.seen_as(&shifted(&original.triangles, 0.01), 1.0, [0.0; 3]);
    assert!(!identical(&base, &moved), "a shift of the scene alone is seen");
}

#[test]
fn an_offset_that_rounds_nothing_changes_no_bit() {
    let original = original();
    let base = original.seen(1.0, [0.0; 3]);
    let moved = original.seen(1.0, [5e5, 4e6, 0.0]);
    assert!(identical(&base, &moved), "{:?}", differing(&base, &moved));
    let (scene_moved_only, all) =
        differing(&base, &original.seen_as(&shifted(&original.triangles, 0.01), 1.0, [0.0; 3]));
    assert!(scene_moved_only * 1000 > all, "a shift of the scene alone is seen: {scene_moved_only} of {all}");
}

fn shifted(triangles: &[Triangle], by: f64) -> Vec<Triangle> {
    triangles.iter().map(|t| t.map(|p| [p[0] + by, p[1], p[2]])).collect()
}

#[test]
fn any_offset_changes_one_sample_of_ten_thousand_at_most() {
    let original = original();
    let base = original.seen(1.0, [0.0; 3]);
    for offset in [[5e5, 4e6, 0.0].map(|x| x + 0.1), [500_123.456_7, 4_000_765.432_1, 321.098_7]] {
        let (different, all) = differing(&base, &original.seen(1.0, offset));
        println!("offset {offset:?}: {different} of {all} samples differ, {:.1e}", different as f64 / all as f64);
        assert!(different * 10_000 <= all, "{different} of {all}");
    }
}

#[test]
fn order_winding_and_meshes_change_no_bit() {
    let original = original();
    let base = original.seen(1.0, [0.0; 3]);
    let mut random = Random(31);
    let mut shuffled = original.triangles.clone();
    for i in (1..shuffled.len()).rev() {
        shuffled.swap(i, (random.next() % (i as u64 + 1)) as usize);
    }
    for t in &mut shuffled {
        t.rotate_left((random.next() % 3) as usize);
        if random.next().is_multiple_of(2) {
            t.swap(0, 1);
        }
    }
    assert_ne!(shuffled, original.triangles);
    let other = original.seen_as(&shuffled, 1.0, [0.0; 3]);
    assert!(identical(&base, &other), "{:?}", differing(&base, &other));

    // One triangle fewer is another scene, and seen as one.
    let fewer = &shuffled[shuffled.len() / 2..];
    assert!(!identical(&base, &original.seen_as(fewer, 1.0, [0.0; 3])));
}

#[test]
fn shared_vertices_and_several_meshes_change_no_bit() {
    let (whole, light, camera) = crate::common::shipped("hall", SIZE);
    let mut meshes: Vec<Mesh> = whole.meshes().to_vec();
    meshes.reverse();
    let reversed = Scene::new(meshes).unwrap();
    let soup = scene(&triangles_of(&whole));
    let one_mesh_each = triangles_of(&whole)
        .into_iter()
        .map(|t| Mesh::new("triangle", t.to_vec(), vec![[0, 1, 2]], Material::default()).unwrap());
    let apart = Scene::new(one_mesh_each.collect()).unwrap();
    let seen = |scene: &Scene| see(scene, std::slice::from_ref(&light), &Receivers::Camera(camera), &ray_traced(32));
    let expected = bits(&seen(&whole));
    for (name, other) in [("reversed", &reversed), ("soup", &soup), ("a mesh a triangle", &apart)] {
        assert!(bits(&seen(other)) == expected, "{name}");
    }
    // Nobody's triangle ids but the caller's: they follow his order.
    let id_of = |scene: &Scene| seen(scene).placed.unwrap().triangles;
    assert_eq!(id_of(&whole), id_of(&soup));
    assert_ne!(id_of(&whole), id_of(&reversed));
}
