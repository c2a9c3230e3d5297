//! What meshes are like: DC11 to DC16.

use std::collections::BTreeMap;

use softshadow::{
    Camera, DepthComplexity, Evaluation, Material, Mesh, Options, Receivers, Scene, Technique, visibility,
};

use super::judge::{Case, expect_rays, settings};
use super::{MANY, all_around, below, leaf, slanting};
use crate::common::{Random, bits, context, lamp, points, rectangle, see};
use crate::shapes::{Point, Triangle, plate, scene, sphere, torus};

fn ring() -> Vec<Triangle> {
    torus(0.4, 0.17, 20, 12)
}

fn expect_mesh(name: &str, triangles: &[Triangle], seed: u64) {
    expect_rays(name, [Case::run(&scene(triangles), &slanting(), &below(&mut Random(seed), MANY))]);
}

/// A share of the triangles, by chance.
fn chosen(seed: u64, share: f64) -> impl FnMut() -> bool {
    let mut random = Random(seed);
    move || random.within([0.0, 1.0]) < share
}

#[test]
fn dc13_open_meshes() {
    expect_mesh("DC13 open", &ring()[60..], 130);
    let mut is_gone = chosen(131, 0.25);
    let holes: Vec<Triangle> = ring().into_iter().filter(|_| !is_gone()).collect();
    expect_mesh("DC13 a quarter removed", &holes, 132);
}

#[test]
fn dc13_flipped_meshes() {
    let mut is_flipped = chosen(133, 0.5);
    let turn = |[a, b, c]: Triangle, flip: bool| if flip { [b, a, c] } else { [a, b, c] };
    let flipped: Vec<Triangle> = ring().into_iter().map(|t| turn(t, is_flipped())).collect();
    expect_mesh("DC13 flipped", &flipped, 134);
}

#[test]
fn dc13_duplicated_meshes() {
    let mut is_twice = chosen(135, 0.2);
    let twice = ring().into_iter().flat_map(|t| vec![t; if is_twice() { 2 } else { 1 }]).collect::<Vec<_>>();
    expect_mesh("DC13 duplicated", &twice, 136);
    // An even number of layers everywhere: parity alone would see nothing.
    expect_mesh("DC13 duplicated throughout", &[ring(), ring()].concat(), 137);
}

#[test]
fn dc13_three_faced_edges() {
    let fins = ring().into_iter().step_by(3).map(|[a, b, _]| [a, b, a.map(|x| x * 1.4 + 0.01)]).collect::<Vec<_>>();
    expect_mesh("DC13 three-faced", &[ring(), fins].concat(), 138);
}

#[test]
fn dc13_slivers() {
    let split = |[a, b, c]: Triangle| {
        // Cut in two along a line that nearly is a side, with a needle, and a triangle without area beside.
        let near: Point = [0, 1, 2].map(|k| {
            let middle = (a[k] + b[k]) * 0.5;
            middle + (c[k] - middle) * 1e-7
        });
        [[a, near, c], [near, b, c], [a, b, near], [a, a, b]]
    };
    expect_mesh("DC13 slivers", &ring().into_iter().flat_map(split).collect::<Vec<_>>(), 139);
}

#[test]
fn dc13_unwelded_meshes_are_welded() {
    // The same triangles with and without shared vertices. Every edge of a closed body without them would be two borders.
    let (mut vertices, mut found) = (Vec::new(), BTreeMap::new());
    let mut index_of = |p: Point| {
        *found.entry(p.map(f64::to_bits)).or_insert_with(|| {
            vertices.push(p);
            vertices.len() as u32 - 1
        })
    };
    let indices: Vec<[u32; 3]> = ring().into_iter().map(|t| t.map(&mut index_of)).collect();
    assert_eq!(vertices.len(), 240);
    let welded = Scene::new(vec![Mesh::new("ring", vertices, indices, Material::default()).unwrap()]).unwrap();
    let receivers = below(&mut Random(140), MANY);
    let cases = [welded, scene(&ring())].map(|scene| Case::run(&scene, &slanting(), &receivers));
    assert!(bits(&cases[0].seen) == bits(&cases[1].seen));
    assert_eq!(cases[0].seen.info.silhouette_edges, cases[1].seen.info.silhouette_edges);
    let edges = cases[0].seen.info.silhouette_edges;
    expect_rays("DC13 unwelded", cases);
    // Torn open on purpose, every edge is a border: more edges in the lists, and still the bits of rays.
    let shrunk = |t: &Triangle| {
        let middle: Point = [0, 1, 2].map(|k| (t[0][k] + t[1][k] + t[2][k]) / 3.0);
        t.map(|p| [0, 1, 2].map(|k| p[k] + (middle[k] - p[k]) * 1e-3))
    };
    let torn: Vec<Triangle> = ring().iter().map(shrunk).collect();
    let torn = Case::run(&scene(&torn), &slanting(), &receivers);
    assert!(torn.seen.info.silhouette_edges > 2 * edges, "{} {edges}", torn.seen.info.silhouette_edges);
    expect_rays("DC13 torn at every edge", [torn]);
}

#[test]
fn dc14_t_junctions_are_hairlines() {
    // A plate whose long edge meets two short ones, the middle off the line by 1e-7.
    let [a, b, c, d]: [Point; 4] = [[-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.5, 0.5, 0.0], [-0.5, 0.5, 0.0]];
    let middle = [0.03, 0.03 + 1e-7, 0.0];
    let cracked = scene(&[[a, b, c], [a, middle, d], [middle, c, d]]);
    let light = lamp(rectangle(1.0, 1.0), [0.1, 0.05, 3.0]);
    let case = Case::run(&cracked, &light, &below(&mut Random(141), 8 * MANY));
    let found = case.found();
    println!("hard case DC14 T-junctions {found:?}");
    case.goes_red_when_spoilt("DC14");
    // Like a ray tracer's: a sample in 10^5 may find the crack.
    assert!(found.hidden > 200_000 && (found.wrong + found.grazing) * 100_000 <= found.samples, "{found:?}");
}

#[test]
fn dc15_leaves() {
    let mut random = Random(150);
    let leaves: Vec<_> = (0..200).map(|_| leaf(&mut random, 0.2, [-0.5, 0.5], [-0.5, 0.5])).collect();
    let foliage = scene(&leaves);
    let places = [below(&mut random, MANY / 2), all_around(&mut random, MANY)];
    expect_rays("DC15 leaves", places.map(|receivers| Case::run(&foliage, &slanting(), &receivers)));
}

#[test]
fn dc15_small_leaves_far_away() {
    // Edges of a thousandth of their distance: corners have images that agree in nearly all digits.
    let mut random = Random(151);
    let leaves: Vec<_> = (0..200).map(|_| leaf(&mut random, 0.001, [-0.005, 0.005], [-0.005, 0.005])).collect();
    let light = lamp(rectangle(0.02, 0.02), [0.001, 0.002, 2.0]);
    let far = points(random.points(MANY, [-0.01, 0.01], [-0.01, 0.01], [-2.5, -1.5]));
    expect_rays("DC15 small leaves far away", [Case::run(&scene(&leaves), &light, &far)]);
}

#[test]
fn dc16_bodies_in_each_other() {
    let mut random = Random(160);
    let both = scene(&[ring(), sphere([0.3, 0.1, 0.0], 0.35, 2)].concat());
    let places = [below(&mut random, MANY), all_around(&mut random, MANY)];
    expect_rays("DC16 bodies in each other", places.map(|receivers| Case::run(&both, &slanting(), &receivers)));
}

#[test]
fn dc11_hundreds_of_layers() {
    let mut random = Random(110);
    let layer = |k: i32| plate([-0.2, 0.2], [-0.2, 0.2], -0.5 + f64::from(k) * 0.004);
    let light = lamp(rectangle(1.0, 1.0), [0.1, 0.05, 3.0]);
    let calls = [1, 2, 63, 64, 127, 128, 255, 256, 300].map(|layers| {
        let stack = scene(&(0..layers).flat_map(layer).collect::<Vec<_>>());
        Case::run(&stack, &light, &below(&mut random, MANY / 8))
    });
    expect_rays("DC11 1 to 300 layers", calls);
}

#[test]
fn dc11_what_a_counter_cannot_hold_is_refused() {
    // Up to seven faces in one place add up in a counter at once; more are an error, never a wrong bit.
    let light = lamp(rectangle(1.0, 1.0), [0.1, 0.05, 3.0]);
    let receivers = below(&mut Random(111), MANY);
    let alike = |times: usize| scene(&vec![plate([-0.4, 0.3], [-0.2, 0.2], 0.1); times].concat());
    expect_rays("DC11 7 alike", [Case::run(&alike(7), &light, &receivers)]);
    let technique = Technique::DepthComplexity(settings());
    let options = Options::default();
    let refused = visibility(context(), &alike(8), &[light], &receivers, &technique, &options, &mut |_, _| true);
    let words = refused.unwrap_err().to_string();
    assert!(words.contains("use ray_traced"), "{words}");
}

#[test]
fn dc12_the_order_of_triangles_changes_no_bit() {
    let floor = plate([-2.0, 2.0], [-2.0, 2.0], -0.7);
    let given = [ring(), sphere([0.3, 0.1, 0.2], 0.3, 2), floor].concat();
    let mut shuffled: Vec<Triangle> = given.iter().map(|[a, b, c]| [*c, *a, *b]).collect();
    let mut random = Random(120);
    for last in (1..shuffled.len()).rev() {
        shuffled.swap(last, (random.next() % (last as u64 + 1)) as usize);
    }
    let camera = Camera::look_at([1.8, -2.4, 1.6], [0.0, 0.0, -0.4], None, 50.0, [64, 48]).unwrap();
    let receivers = Receivers::Camera(camera);
    for evaluation in [Evaluation::Tiled, Evaluation::Blended] {
        let technique = Technique::DepthComplexity(DepthComplexity { evaluation, ..settings() });
        let seen = |triangles: &[Triangle]| bits(&see(&scene(triangles), &[slanting()], &receivers, &technique));
        assert!(seen(&given) == seen(&shuffled), "{evaluation:?}");
        assert!(seen(&given) != seen(&given[480..]), "{evaluation:?}: a missing ring is noticed");
    }
    let calls = [&given, &shuffled].map(|triangles| Case::run(&scene(triangles), &slanting(), &receivers));
    expect_rays("DC12 in any order", calls);
}
