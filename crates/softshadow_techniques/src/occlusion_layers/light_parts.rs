//! The light as a few boxes: parts of it for which slices are put together one by one.

use glam::DVec2;
use softshadow_scene::{Light, LightShape};

use super::frame::{LightAxes, middle_and_half};
use super::settings::{Combine, OcclusionLayers};

/// `LightParts` of `kernel.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct LightParts {
    boxes: [[f32; 4]; 64],
    weights: [[f32; 4]; 64],
    whole: [f32; 4],
    count: u32,
    channels: u32,
    combine: u32,
    reserved: u32,
}

/// Corners of the polygon that stands for a disc; only shares and moments of its parts are taken from it.
const DISC_CORNERS: usize = 256;

/// Points across a part at which a texture is read.
const TEXTURE_POINTS: usize = 8;

/// A box of the light, in half sizes of its frame, and its share of the light by area.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Part {
    center: DVec2,
    half: DVec2,
    share: f64,
}

impl LightParts {
    pub(super) fn new(light: &Light, axes: &LightAxes, settings: &OcclusionLayers, channels: u32) -> Self {
        let parts = light_parts(light, settings);
        let mut record = Self {
            boxes: [[0.0; 4]; 64],
            weights: [[0.0; 4]; 64],
            whole: [0.0, 0.0, axes.reach.x as f32, axes.reach.y as f32],
            count: parts.len() as u32,
            channels,
            combine: match settings.combine {
                Combine::Product => 0,
                Combine::Maximum => 1,
                Combine::Sum => 2,
            },
            reserved: 0,
        };
        let radiance: Vec<[f64; 3]> = parts.iter().map(|part| mean_radiance(light, part)).collect();
        for (index, part) in parts.iter().enumerate() {
            let (center, half) = ((part.center * axes.reach).as_vec2(), (part.half * axes.reach).as_vec2());
            record.boxes[index] = [center.x, center.y, half.x, half.y];
            for channel in 0..3 {
                let whole: f64 = parts.iter().zip(&radiance).map(|(p, r)| p.share * r[channel]).sum();
                // A channel without light is weighed by area.
                let weight = if whole > 0.0 { part.share * radiance[index][channel] / whole } else { part.share };
                record.weights[index][channel] = weight as f32;
            }
        }
        record
    }
}

/// How many parts a light has.
pub(super) fn part_count(light: &Light, settings: &OcclusionLayers) -> u32 {
    light_parts(light, settings).len() as u32
}

fn light_parts(light: &Light, settings: &OcclusionLayers) -> Vec<Part> {
    parts(&outline(light), settings.split)
}

/// The light's border within `[-1, 1]²`, its y turned as in the frame, counter-clockwise.
fn outline(light: &Light) -> Vec<DVec2> {
    match light.shape() {
        LightShape::Rectangle { .. } => [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(DVec2::from).to_vec(),
        LightShape::Disc { .. } | LightShape::Sphere { .. } | LightShape::Sun { .. } => {
            let step = std::f64::consts::TAU / DISC_CORNERS as f64;
            (0..DISC_CORNERS).map(|k| DVec2::from_angle(step * k as f64)).collect()
        }
        LightShape::Polygon { outline } => {
            let [middle, half] = middle_and_half(outline);
            let turned = |c: &[f64; 2]| (DVec2::from(*c) - middle) / half * DVec2::new(1.0, -1.0);
            let mut corners: Vec<DVec2> = outline.iter().map(turned).collect();
            if moments(&corners).area < 0.0 {
                corners.reverse();
            }
            corners
        }
    }
}

/// Cells of a square grid of `split` a side, each as the box with the area's centre and variances: a whole cell is its own box.
fn parts(outline: &[DVec2], split: u32) -> Vec<Part> {
    let size = 2.0 / f64::from(split);
    let whole = moments(outline).area;
    let cells = (0..split * split).map(|k| DVec2::new(f64::from(k % split), f64::from(k / split)) * size - 1.0);
    let part = |low: DVec2| {
        let inside = moments(&clipped(outline, low, low + size));
        // A sliver of a cell that rounding left is no part of the light.
        (inside.area > 1e-9 * whole).then(|| {
            let center = inside.first / inside.area;
            let variance = (inside.second / inside.area - center * center).max(DVec2::ZERO);
            Part { center, half: (variance * 3.0).map(f64::sqrt), share: inside.area / whole }
        })
    };
    cells.filter_map(part).collect()
}

/// Area, and the integrals of position and its square over it.
#[derive(Debug, Clone, Copy, Default)]
struct Moments {
    area: f64,
    first: DVec2,
    second: DVec2,
}

fn moments(corners: &[DVec2]) -> Moments {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).fold(Moments::default(), |sum, (a, b)| {
        let cross = a.perp_dot(*b);
        Moments {
            area: sum.area + cross / 2.0,
            first: sum.first + (*a + *b) * (cross / 6.0),
            second: sum.second + (*a * *a + *a * *b + *b * *b) * (cross / 12.0),
        }
    })
}

/// What of a polygon lies in a box. Where that is in several pieces they are joined by lines along the box, which hold no area.
fn clipped(corners: &[DVec2], low: DVec2, high: DVec2) -> Vec<DVec2> {
    let sides = [(DVec2::X, -low.x), (DVec2::NEG_X, high.x), (DVec2::Y, -low.y), (DVec2::NEG_Y, high.y)];
    sides.iter().fold(corners.to_vec(), |polygon, (normal, offset)| {
        let inside = |p: &DVec2| normal.dot(*p) + offset;
        let next = polygon.iter().cycle().skip(1);
        let mut kept = Vec::with_capacity(polygon.len() + 2);
        for (a, b) in polygon.iter().zip(next) {
            let (da, db) = (inside(a), inside(b));
            if da >= 0.0 {
                kept.push(*a);
            }
            if (da >= 0.0) != (db >= 0.0) {
                kept.push(*a + (*b - *a) * (da / (da - db)));
            }
        }
        kept
    })
}

/// The mean of a light's texture over a part; 1 without one.
fn mean_radiance(light: &Light, part: &Part) -> [f64; 3] {
    let Some(texture) = light.texture() else { return [1.0; 3] };
    let place = |k: usize| (2.0 * k as f64 + 1.0) / TEXTURE_POINTS as f64 - 1.0;
    let mut sum = [0.0; 3];
    for k in 0..TEXTURE_POINTS * TEXTURE_POINTS {
        let at = part.center + part.half * DVec2::new(place(k % TEXTURE_POINTS), place(k / TEXTURE_POINTS));
        // The frame's y is turned against the light's.
        let texel = texture.at(at.x, -at.y);
        (0..3).for_each(|c| sum[c] += f64::from(texel[c]) / (TEXTURE_POINTS * TEXTURE_POINTS) as f64);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<DVec2> {
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(DVec2::from).to_vec()
    }

    #[test]
    fn a_rectangle_falls_into_equal_boxes_that_tile_it() {
        for split in 1..=8 {
            let parts = parts(&square(), split);
            assert_eq!(parts.len(), (split * split) as usize);
            for part in &parts {
                assert!((part.half - 1.0 / f64::from(split)).abs().max_element() < 1e-9);
                assert!((part.share - 1.0 / f64::from(split * split)).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn parts_of_any_shape_have_its_area_centre_and_variance() {
        let arrow: Vec<DVec2> = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [0.0, -0.25]].map(DVec2::from).to_vec();
        let disc: Vec<DVec2> = (0..256).map(|k| DVec2::from_angle(f64::from(k) * 0.024_543_692_606_170_26)).collect();
        for outline in [arrow, disc, square()] {
            let all = moments(&outline);
            for split in [1, 3, 8] {
                let parts = parts(&outline, split);
                let share: f64 = parts.iter().map(|p| p.share).sum();
                let center: DVec2 = parts.iter().map(|p| p.center * p.share).sum();
                let second: DVec2 = parts.iter().map(|p| (p.center * p.center + p.half * p.half / 3.0) * p.share).sum();
                assert!((share - 1.0).abs() < 1e-9, "{share}");
                assert!((center - all.first / all.area).abs().max_element() < 1e-9);
                assert!((second - all.second / all.area).abs().max_element() < 1e-9);
                // And another outline has others.
                let moved = parts.iter().map(|p| p.center * (p.share * 1.01)).sum::<DVec2>();
                assert!(split == 1 || moved != center || center == DVec2::ZERO);
            }
        }
    }
}
