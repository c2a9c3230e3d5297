//! Penumbra maps: the known bias and no other, the ramps of every outline, contact, order, overlaps, and who serves what.

mod hard_cases;
mod outlines;
mod overlaps;
mod silhouettes;

use softshadow::{Light, LightShape, Ramp, Visibility};

use crate::common::{Random, hard_shadow_map, penumbra_map, see, surface_points};
use crate::shapes::{Point, Triangle, plate, scene};

/// The lamp's height over the floor, and the plate's.
pub(crate) const LAMP: f64 = 4.0;

/// A floor under a plate at `height` that ends at x = 0.
pub(crate) fn half_plane(height: f64) -> Vec<Triangle> {
    let mut triangles = plate([-3.0, 3.0], [-3.0, 3.0], 0.0);
    triangles.extend(plate([-3.0, 0.0], [-3.0, 3.0], height));
    triangles
}

/// A light over the origin that shines straight down, its axes along x and y.
pub(crate) fn over(shape: LightShape) -> Light {
    crate::common::lamp(shape, [0.0, 0.0, LAMP])
}

/// Half the width of the penumbra on the floor: where the edge's image leaves a light of this half size.
pub(crate) fn half_width(height: f64, half_size: f64) -> f64 {
    half_size * height / (LAMP - height)
}

/// Points on the floor across the shadow's border, at `t` times the half width of the penumbra, t in (−1.2, 1.2).
pub(crate) fn across(half_width: f64) -> (Vec<f64>, Vec<Point>) {
    let mut random = Random(31);
    let t: Vec<f64> = (0..6000).map(|_| random.within([-1.2, 1.2])).collect();
    let places = t.iter().map(|t| [t * half_width, random.within([-0.1, 0.1]), 0.0]).collect();
    (t, places)
}

pub(crate) fn on_floor(
    triangles: &[Triangle],
    light: &Light,
    places: &[Point],
    resolution: u32,
    ramp: Ramp,
) -> Visibility {
    let receivers = surface_points(places.to_vec(), [0.0, 0.0, 1.0]);
    see(&scene(triangles), std::slice::from_ref(light), &receivers, &penumbra_map(resolution, ramp))
}

pub(crate) fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), v| (sum + v, count + 1));
    sum / f64::from(count)
}

/// Largest difference to a function of t, leaving out the texel at the hard edge.
pub(crate) fn farthest_from(t: &[f64], seen: &Visibility, truth: impl Fn(f64) -> f64) -> f64 {
    let pairs = t.iter().zip(&seen.values).filter(|(t, _)| t.abs() > 0.02);
    pairs.map(|(t, v)| (f64::from(*v) - truth(*t)).abs()).fold(0.0, f64::max)
}

/// Mean of `map − truth` over the whole penumbra, inner and outer.
fn bias(t: &[f64], seen: &Visibility) -> f64 {
    let inside = t.iter().zip(&seen.values).filter(|(t, _)| t.abs() < 1.0);
    mean(inside.map(|(t, v)| f64::from(*v) - (0.5 + 0.5 * t)))
}

/// The paper's intensity at the share `k` of the outer penumbra, for a surface `q` times as far from the light as the occluder.
fn paper(k: f64, q: f64) -> f64 {
    let i = k / (q - (q - 1.0) * k);
    i * i * (3.0 - 2.0 * i)
}

fn square(side: f64) -> LightShape {
    LightShape::Rectangle { width: side, height: side }
}

#[test]
fn a_half_plane_shows_the_known_bias_and_no_other() {
    for height in [1.0, LAMP / 3.0, 2.0] {
        let (t, places) = across(half_width(height, 0.5));
        let q = LAMP / (LAMP - height);
        let triangles = half_plane(height);
        let of = |ramp, side| on_floor(&triangles, &over(square(side)), &places, 2048, ramp);
        let outer = |f: &dyn Fn(f64) -> f64, t: f64| f(t.clamp(0.0, 1.0));
        // Over the inner half the truth rises from 0 to 1/2 and the map is 0; so far all ramps are alike.
        let inner = -0.125;
        for (name, ramp, f) in [
            ("linear", Ramp::Linear, &(|k| k) as &dyn Fn(f64) -> f64),
            // The edge runs along a side of the square, whose ramp is linear, too.
            ("light", Ramp::Light, &|k| k),
            ("paper", Ramp::Paper, &|k| paper(k, q)),
        ] {
            let seen = of(ramp, 1.0);
            let (found, error) = (bias(&t, &seen), farthest_from(&t, &seen, |t| outer(f, t)));
            let steps = 2000;
            let closed = inner
                + 0.5 * mean((0..steps).map(|i| (f64::from(i) + 0.5) / f64::from(steps)).map(|k| f(k) - 0.5 - 0.5 * k));
            println!(
                "half plane at {height}, {name}: bias {found:.4}, closed form {closed:.4}; at most {error:.4} off"
            );
            assert!((found - closed).abs() < 0.01, "{height} {name}: {found} {closed}");
            assert!(error < 0.01, "{height} {name}: {error}");
            if name != "paper" {
                assert!((closed + 0.25).abs() < 1e-9);
            }
            // A light a fifth larger is another bias, and another ramp.
            let wide = of(ramp, 1.2);
            assert!(farthest_from(&t, &wide, |t| outer(f, t)) > 0.05, "{name}: a larger light is seen");
        }
        // Half at the hard edge: dark on its one side, where half of the light is seen, and next to dark on the other.
        let seen = of(Ramp::Linear, 1.0);
        let near = t.iter().zip(&seen.values).filter(|(t, _)| t.abs() < 0.02);
        let worst = near.map(|(t, v)| f64::from(*v) - (0.5 + 0.5 * t)).fold(0.0, f64::min);
        println!("half plane at {height}: {worst:.4} at the hard edge");
        // In root mean square no nearer to the truth than a hard shadow, whose error is the same on the dark side and as large on the
        // bright one.
        let receivers = surface_points(places.clone(), [0.0, 0.0, 1.0]);
        let hard = see(&scene(&triangles), &[over(square(1.0))], &receivers, &hard_shadow_map(2048));
        let rmse = |seen: &Visibility| {
            let inside = t.iter().zip(&seen.values).filter(|(t, _)| t.abs() < 1.0);
            mean(inside.map(|(t, v)| (f64::from(*v) - (0.5 + 0.5 * t)).powi(2))).sqrt()
        };
        println!("half plane at {height}: RMSE {:.4}, of a hard shadow {:.4}", rmse(&seen), rmse(&hard));
        assert!([rmse(&seen), rmse(&hard)].iter().all(|r| (r - 1.0 / 12_f64.sqrt()).abs() < 0.01));
        assert!((worst + 0.5).abs() < 0.02, "{worst}");
    }
}
