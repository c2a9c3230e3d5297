//! What interleaved pixels must come to, computed on the CPU from masks: averages over pixels of one surface, which the scene's maker knows
//! and no threshold decides.

use softshadow::Visibility;

/// Which surface a receiver lies on: its plane, to three digits. Only for scenes of planes that lie farther apart.
pub(crate) fn plane_of(seen: &Visibility, index: usize) -> [i64; 4] {
    let placed = seen.placed.as_ref().unwrap();
    let (normal, at) = (placed.normals[index].map(f64::from), placed.positions[index]);
    let offset: f64 = normal.iter().zip(at).map(|(n, x)| n * x).sum();
    [normal[0], normal[1], normal[2], offset].map(|x| (x * 1000.0).round() as i64)
}

/// The weight of a pixel so far aside.
fn share(offset: i64, tile: i64) -> f64 {
    match (2 * offset.abs()).cmp(&tile) {
        std::cmp::Ordering::Less => 1.0,
        std::cmp::Ordering::Equal => 0.5,
        std::cmp::Ordering::Greater => 0.0,
    }
}

/// The mean of `value` around every pixel that sees anything, over pixels that are `alike`.
pub(crate) fn averaged(
    seen: &Visibility,
    tile: u32,
    value: impl Fn(usize) -> f64,
    alike: impl Fn(usize, usize) -> bool,
) -> Vec<f64> {
    let [width, height] = seen.image.unwrap().map(i64::from);
    let (tile, reach) = (i64::from(tile), i64::from(tile) / 2);
    let at = |x: i64, y: i64| (y * width + x) as usize;
    let mean = |x: i64, y: i64| {
        let (mut sum, mut total) = (0.0, 0.0);
        for v in (y - reach).max(0)..=(y + reach).min(height - 1) {
            for u in (x - reach).max(0)..=(x + reach).min(width - 1) {
                if seen.valid[at(u, v)] && (at(u, v) == at(x, y) || alike(at(x, y), at(u, v))) {
                    let weight = share(u - x, tile) * share(v - y, tile);
                    sum += weight * value(at(u, v));
                    total += weight;
                }
            }
        }
        sum / total
    };
    (0..width * height).map(|i| if seen.valid[i as usize] { mean(i % width, i / width) } else { f64::NAN }).collect()
}

/// The share of the samples that a receiver's mask leaves visible.
pub(crate) fn share_visible(seen: &Visibility, index: usize, samples: u32) -> f64 {
    let masks = seen.masks.as_ref().unwrap();
    let is_hidden = |s: usize| masks.bits[index * masks.words + s / 32] >> (s % 32) & 1 == 1;
    1.0 - (0..samples as usize).filter(|s| is_hidden(*s)).count() as f64 / f64::from(samples)
}

/// The largest difference between a result and what it must come to, where anything is seen.
pub(crate) fn farthest(seen: &Visibility, expected: &[f64]) -> f64 {
    let pairs = seen.values.iter().zip(expected).zip(&seen.valid);
    pairs.filter(|(_, valid)| **valid).map(|((v, e), _)| (f64::from(*v) - e).abs()).fold(0.0, f64::max)
}
