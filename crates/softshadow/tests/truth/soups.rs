//! Soups of triangles: `depth_complexity` triangle by triangle against edges and rays to the same samples.

use softshadow::{
    DepthComplexity, Light, LightShape, OccluderUnit, Receivers, Scene, Technique, Visibility, look_at, procedural,
};

use crate::common::{Random, lamp, points, ray_traced, rectangle, see, shipped, surface_points};
use crate::shapes::{Point, Triangle, scene, sphere, torus};

fn unit(samples: u32, unit: OccluderUnit) -> Technique {
    Technique::DepthComplexity(DepthComplexity { samples, exact_area: false, unit, ..DepthComplexity::default() })
}

/// In how many samples two results differ, and how many the first hides. Bits past the last sample mean nothing.
fn differences(a: &Visibility, b: &Visibility, samples: u32) -> (u32, u32) {
    let used = |at: usize| {
        let left = samples - 32 * (at as u32 % samples.div_ceil(32));
        if left >= 32 { !0 } else { !(!0u32 << left) }
    };
    let (a, b) = (&a.masks.as_ref().unwrap().bits, &b.masks.as_ref().unwrap().bits);
    let differ = a.iter().zip(b).enumerate().map(|(at, (x, y))| ((x ^ y) & used(at)).count_ones()).sum();
    (differ, a.iter().enumerate().map(|(at, x)| (x & used(at)).count_ones()).sum())
}

#[test]
fn triangles_and_edges_have_the_same_bits_on_shipped_scenes() {
    for name in ["fork", "cards", "toruses", "hall"] {
        let (scene, light, camera) = shipped(name, [160, 120]);
        let run = |technique| see(&scene, std::slice::from_ref(&light), &Receivers::Camera(camera.clone()), &technique);
        println!("{name}");let (edges, triangles) = (run(unit(64, OccluderUnit::Edges)), run(unit(64, OccluderUnit::Triangles)));
        let (differ, hidden) = differences(&edges, &triangles, 64);
        let from_rays = differences(&run(ray_traced(64)), &triangles, 64).0;
        println!("{name}: {differ} samples differ from edges, {from_rays} from rays, {hidden} hidden");
        assert!(hidden > 100_000, "{name}: {hidden}");
        assert_eq!((edges.info.occluder_units, triangles.info.occluder_units), (vec!["edges"], vec!["triangles"]));
        assert!(triangles.info.silhouette_edges == 0 && edges.info.silhouette_edges > 0);
        assert_eq!(differ, 0, "{name}");
        assert!(from_rays <= 12, "{name}: {from_rays}");
    }
}

/// A ring and a ball over each other, and every kind of light over them.
fn bodies() -> Scene {
    scene(&[torus(0.5, 0.2, 24, 12), sphere([0.1, 0.0, 0.6], 0.25, 2)].concat())
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
        rectangle(0.0, 0.0),
    ]
    .map(|shape| Light::new(shape, pose).unwrap())
    .to_vec()
}

#[test]
fn every_light_and_count_of_samples_has_the_bits_of_edges() {
    let scene = bodies();
    let floor = Random(6).points(3000, [-1.5, 1.5], [-1.5, 1.5], [-1.0, -0.4]);
    let (free, surface) = (points(floor.clone()), surface_points(floor, [0.0, 0.3, 0.9]));
    for light in lights() {
        for samples in [1, 16, 40, 64, 128, 256] {
            for receivers in [&free, &surface] {
                let run = |kind| see(&scene, std::slice::from_ref(&light), receivers, &unit(samples, kind));
                let (edges, triangles) = (run(OccluderUnit::Edges), run(OccluderUnit::Triangles));
                let (differ, hidden) = differences(&edges, &triangles, samples);
                assert!(hidden > 200 * samples, "{:?}: {hidden}", light.shape());
                assert_eq!(differ, 0, "{:?}, {samples} samples", light.shape());
            }
        }
    }
}
