//! Occlusion layers where the layered scene is the scene: plates parallel to the light, on the planes of their slices. What is left is the
//! texel, and the filter, which is exact.

use softshadow::measure::{Receiver, RectangleLight, rectangle_visibility};
use softshadow::{Combine, Light, LightShape, OcclusionLayers, Projection, Receivers, Technique};

use crate::common::{Random, lamp, points, rectangle, see, surface_points};
use crate::shapes::{Point, Triangle, map, plate, scene, turned};

/// Height of the light over the receivers.
const HEIGHT: f64 = 2.0;

fn layers(slices: u32, resolution: u32, split: u32) -> OcclusionLayers {
    OcclusionLayers { slices, resolution, split, ..OcclusionLayers::default() }
}

fn values(triangles: &[Triangle], light: &Light, receivers: &Receivers, settings: &OcclusionLayers) -> Vec<f64> {
    let technique = Technique::OcclusionLayers(settings.clone());
    let seen = see(&scene(triangles), std::slice::from_ref(light), receivers, &technique);
    seen.values.iter().map(|v| f64::from(*v)).collect()
}

fn floor(count: usize, seed: u64) -> Vec<Point> {
    Random(seed).points(count, [-1.5, 1.5], [-1.5, 1.5], [0.0, 0.2])
}

fn exact(triangles: &[Triangle], [width, height]: [f64; 2], p: Point) -> f64 {
    let light =
        RectangleLight::new([0.0, 0.0, HEIGHT], [width / 2.0, 0.0, 0.0], [0.0, height / 2.0, 0.0], [0.0, 0.0, -1.0]);
    rectangle_visibility(&light.unwrap(), triangles, &Receiver::at(p)).unwrap()
}

/// The most that texels can cost one plate: along each of its sides within the kernel, half a texel's diagonal.
fn texel_bound(resolution: u32, window: f64, plate_height: f64, size: [f64; 2], p: Point) -> f64 {
    let shrink = (plate_height - p[2]) / (HEIGHT - p[2]);
    let kernel = size.map(|side| side * shrink);
    let texel = window / f64::from(resolution);
    2.0 * (kernel[0] + kernel[1]) * 0.5 * 2f64.sqrt() * texel / (kernel[0] * kernel[1])
}

#[test]
fn a_turned_plate_hides_its_share_within_a_texel() {
    let size = [1.0, 0.6];
    let light = lamp(rectangle(size[0], size[1]), [0.0, 0.0, HEIGHT]);
    let height = 0.8;
    let turned_plate = |x: f64| map(&plate([-0.4 + x, 0.5 + x], [-0.2, 0.3], height), |p| turned(p, 0.0, 0.4));
    let triangles = turned_plate(0.0);
    let positions = floor(400, 3);
    let receivers = points(positions.clone());
    let truth: Vec<f64> = positions.iter().map(|p| exact(&triangles, size, *p)).collect();
    let window = 1.3;
    let mut means = Vec::new();
    for (resolution, split) in [(64, 1), (64, 4), (256, 1), (1024, 1), (1024, 3)] {
        let off = |triangles: &[Triangle]| -> Vec<f64> {
            let seen = values(triangles, &light, &receivers, &layers(1, resolution, split));
            seen.iter().zip(&truth).map(|(a, b)| (a - b).abs()).collect()
        };
        let bounds: Vec<f64> = positions.iter().map(|p| texel_bound(resolution, window, height, size, *p)).collect();
        let within = |off: &[f64]| off.iter().zip(&bounds).all(|(off, bound)| off <= bound);
        let errors = off(&triangles);
        let (worst, mean) = (errors.iter().copied().fold(0.0, f64::max), errors.iter().sum::<f64>() / 400.0);
        println!("turned plate, {resolution} texels, split {split}: worst {worst:.5}, mean {mean:.6}");
        assert!(within(&errors), "{resolution} texels");
        // Ten texels to one side are seen.
        assert!(!within(&off(&turned_plate(10.0 * window / f64::from(resolution)))), "{resolution} texels, spoilt");
        means.push(mean);
    }
    assert!(means[3] < 0.15 * means[0], "sixteen times the texels, a fraction of the error: {means:?}");
    assert!(truth.iter().any(|v| *v < 0.5) && truth.iter().filter(|v| **v > 0.0 && **v < 1.0).count() > 100);
}

/// Plates in a square lattice, each there or not.
struct Lattice {
    cells: usize,
    size: f64,
    height: f64,
    filled: Vec<bool>,
}

impl Lattice {
    fn new(cells: usize, seed: u64) -> Self {
        let mut random = Random(seed);
        let mut filled: Vec<bool> = (0..cells * cells).map(|_| random.next() & 1 == 1).collect();
        // Its corners hold the window.
        filled[0] = true;
        filled[cells * cells - 1] = true;
        Self { cells, size: 1.6, height: 0.9, filled }
    }

    fn side(&self, k: usize) -> f64 {
        self.size * (k as f64 / self.cells as f64 - 0.5)
    }

    fn triangles(&self) -> Vec<Triangle> {
        let cell = |k: usize| {
            let (x, y) = (k % self.cells, k / self.cells);
            plate([self.side(x), self.side(x + 1)], [self.side(y), self.side(y + 1)], self.height)
        };
        (0..self.filled.len()).filter(|k| self.filled[*k]).flat_map(cell).collect()
    }

    /// Share of the light that is visible: areas of cells within the light's image on the plates.
    fn visible(&self, light: [f64; 2], p: Point) -> f64 {
        let shrink = (self.height - p[2]) / (HEIGHT - p[2]);
        let range = |axis: usize| {
            let middle = p[axis] * (1.0 - shrink);
            [middle - light[axis] / 2.0 * shrink, middle + light[axis] / 2.0 * shrink]
        };
        let ([x0, x1], [y0, y1]) = (range(0), range(1));
        let overlap = |k: usize, low: f64, high: f64| (self.side(k + 1).min(high) - self.side(k).max(low)).max(0.0);
        let mut hidden = 0.0;
        for (k, _) in self.filled.iter().enumerate().filter(|(_, filled)| **filled) {
            hidden += overlap(k % self.cells, x0, x1) * overlap(k / self.cells, y0, y1);
        }
        1.0 - hidden / ((x1 - x0) * (y1 - y0))
    }
}

#[test]
fn the_mean_over_any_box_is_exact() {
    // Lights of many sizes and a 4:1 one make kernels from below two texels to wider than all of them, and some that jut out.
    let lattice = Lattice::new(64, 5);
    let triangles = lattice.triangles();
    let positions = Random(9).points(300, [-2.0, 2.0], [-2.0, 2.0], [-0.5, 0.6]);
    for (resolution, size) in
        [(64, [0.9, 0.9]), (64, [2.4, 0.6]), (128, [0.3, 0.3]), (1024, [0.9, 0.3]), (2048, [3.0, 3.0])]
    {
        let light = lamp(rectangle(size[0], size[1]), [0.0, 0.0, HEIGHT]);
        for split in [1, 3] {
            let seen = values(&triangles, &light, &points(positions.clone()), &layers(1, resolution, split));
            let worst = |shift: f64| {
                let off = |(p, v): (&Point, &f64)| (lattice.visible(size, [p[0] + shift, p[1], p[2]]) - v).abs();
                positions.iter().zip(&seen).map(off).fold(0.0, f64::max)
            };
            println!("lattice, {resolution} texels, light {size:?}, split {split}: worst {:.2e}", worst(0.0));
            assert!(worst(0.0) < 2e-4, "{resolution} texels, light {size:?}, split {split}: {}", worst(0.0));
            assert!(worst(1e-2) > 2e-3, "a shifted lattice is seen");
        }
    }
}

#[test]
fn slices_are_put_together_by_the_rule_and_no_worse() {
    // Two plates of half the light each, seen from below the middle of both: complementary, or one over the other.
    let light = lamp(rectangle(0.5, 0.5), [0.0, 0.0, HEIGHT]);
    let half = |sign: f64, height: f64| {
        let x = if sign < 0.0 { [-1.0, 0.0] } else { [0.0, 1.0] };
        plate(x, [-1.0, 1.0], height)
    };
    let receivers = points(vec![[0.0, 0.0, 0.0]]);
    let with = |triangles: &[Triangle], combine: Combine, split: u32| {
        values(triangles, &light, &receivers, &OcclusionLayers { combine, ..layers(2, 256, split) })[0]
    };
    let near = |a: f64, b: f64| assert!((a - b).abs() < 5e-3, "{a} is not {b}");
    let complementary: Vec<Triangle> = [half(-1.0, 0.5), half(1.0, 1.0)].concat();
    let stacked: Vec<Triangle> = [half(-1.0, 0.5), half(-1.0, 1.0)].concat();
    // The product takes a half of a half; split along the plates' edge, it is right for both.
    near(with(&complementary, Combine::Product, 1), 0.25);
    near(with(&complementary, Combine::Maximum, 1), 0.5);
    near(with(&complementary, Combine::Sum, 1), 0.0);
    near(with(&complementary, Combine::Product, 2), 0.0);
    near(with(&stacked, Combine::Product, 1), 0.25);
    near(with(&stacked, Combine::Maximum, 1), 0.5);
    near(with(&stacked, Combine::Sum, 1), 0.0);
    near(with(&stacked, Combine::Product, 2), 0.5);
}

#[test]
fn the_horizon_cuts_the_light() {
    let light = lamp(rectangle(1.0, 1.0), [0.0, 0.0, HEIGHT]);
    // Far away to the side, so that nothing hides the light.
    let triangles = plate([5.0, 5.1], [5.0, 5.1], 0.5);
    // The receiver's plane passes through the light's middle, and beside it.
    let seen = |normal: Point, split: u32| {
        values(&triangles, &light, &surface_points(vec![[0.0, 0.0, 0.0]], normal), &layers(4, 64, split))[0]
    };
    for split in [1, 2, 5] {
        assert!((seen([1.0, 0.0, 0.0], split) - 0.5).abs() < 1e-5);
        assert!((seen([0.6, 0.8, 0.0], split) - 0.5).abs() < 1e-5);
        // n·s >= 0 where 0.1 + x >= 0 at x in [-0.5, 0.5].
        let tilt = (0.05_f64.atan2(1.0)).sin();
        assert!((seen([(1.0 - tilt * tilt).sqrt(), 0.0, tilt], split) - 0.6).abs() < 1e-4);
        assert!((seen([0.0, 0.0, -1.0], split)).abs() < 1e-6);
    }
}

#[test]
fn what_hides_nothing_is_not_sliced() {
    // A floor under all receivers, and a ceiling over the light, take no slice: the plate gets all texels, at any size of the floor.
    let light = lamp(rectangle(1.0, 1.0), [0.0, 0.0, HEIGHT]);
    let alone = map(&plate([-0.4, 0.5], [-0.2, 0.3], 0.8), |p| turned(p, 0.0, 0.4));
    let positions = floor(100, 7).into_iter().map(|[x, y, _]| [x, y, 0.0]).collect::<Vec<Point>>();
    let receivers = points(positions);
    let settings = layers(4, 128, 1);
    let bare = values(&alone, &light, &receivers, &settings);
    let with = [alone.clone(), plate([-50.0, 50.0], [-50.0, 50.0], 0.0), plate([-9.0, 9.0], [-9.0, 9.0], 2.5)].concat();
    let housed = values(&with, &light, &receivers, &settings);
    let worst = bare.iter().zip(&housed).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(worst < 1e-4, "{worst}");
    assert!(bare.iter().any(|v| *v < 0.5));
}

#[test]
fn projections_agree_on_plates_and_every_shape_is_served() {
    let triangles = plate([-0.4, 0.5], [-0.2, 0.3], 0.8);
    let positions = floor(200, 11);
    let receivers = points(positions.clone());
    let sun = LightShape::Sun { angular_diameter: 20f64.to_radians() };
    let outline = vec![[-0.5, -0.5], [0.5, -0.5], [0.5, 0.0], [0.0, 0.0], [0.0, 0.5], [-0.5, 0.5]];
    for (shape, most) in [
        (LightShape::Disc { radius: 0.4 }, 0.03),
        (LightShape::Sphere { radius: 0.3 }, 0.05),
        (LightShape::Polygon { outline }, 0.03),
        (sun, 0.03),
    ] {
        let light = lamp(shape.clone(), [0.0, 0.0, HEIGHT]);
        let traced =
            see(&scene(&triangles), std::slice::from_ref(&light), &receivers, &crate::common::ray_traced(1024));
        for projection in [Projection::Perspective, Projection::Parallel] {
            let settings = OcclusionLayers { projection, ..layers(2, 512, 8) };
            let seen = values(&triangles, &light, &receivers, &settings);
            let off = seen.iter().zip(&traced.values).map(|(a, b)| (a - f64::from(*b)).abs());
            let worst = off.fold(0.0, f64::max);
            println!("{shape:?}, {projection:?}: worst {worst:.4}");
            assert!(worst < most, "{shape:?}: {worst}");
        }
        assert!(traced.values.iter().filter(|v| **v > 0.02 && **v < 0.98).count() > 10);
    }
}
