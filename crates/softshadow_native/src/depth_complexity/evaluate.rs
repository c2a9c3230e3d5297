//! Visibility of one receiver.

use glam::{DVec2, Vec3};
use softshadow_scene::LightFrame;
use softshadow_scene::occluders::{Occluders, UNITS_PER_HALVING};

use super::area::{AreaSum, area_beyond};
use super::counters::Counters;
use super::coverage::{Coverage, Mask, crossed_exactly};
use super::depth_of_reference::depth_of_reference;
use super::edge::ProjectedEdge;
use super::face::{Layers, weight};
use super::reach::edges_in_reach;
use super::touching::{add_touching, most_touching};
use super::view::{LightView, Receiver, Sight};

/// An area is not believed when it differs by more than this share of `samples^-3/4` from the share of the samples: stratified samples
/// of a half plane are that close (twice the largest error seen for 16, 64 and 256 of them).
const SAMPLING_BOUND: f32 = 2.0;

/// One light, everything that can hide it, and its samples.
#[derive(Debug, Clone, Copy)]
pub struct DepthComplexity<'a> {
    /// What is in the way.
    pub occluders: &'a Occluders,
    /// The light.
    pub light: &'a LightFrame,
    /// Its samples, as [`LightFrame::samples`] places them.
    pub samples: &'a [[f32; 2]],
    /// How crossings are found.
    pub coverage: Coverage<'a>,
    /// Whether areas answer where a single layer hides the light.
    pub exact_area: bool,
}

/// What a receiver sees.
#[derive(Debug, Clone, PartialEq)]
pub struct Seen<const W: usize> {
    /// Samples that are hidden wholly.
    pub hidden: Mask<W>,
    /// What passes semi-opaque faces to each sample; `None` where there are none, and samples are seen or hidden.
    pub passes: Option<Vec<f32>>,
    /// Share of the samples that is visible, what passes semi-opaque faces included.
    pub sampled: f32,
    /// Share of the light's area that is visible; `None` where samples have to answer.
    pub by_area: Option<f32>,
    /// How many edges were silhouettes over the light.
    pub silhouettes: u32,
    /// More semi-opaque layers than their counters hold: what passes is not to be trusted.
    pub overflowed: bool,
}

impl<const W: usize> Seen<W> {
    fn all_or_nothing(hidden: Mask<W>, visible: f32) -> Self {
        Self { hidden, passes: None, sampled: visible, by_area: Some(visible), silhouettes: 0, overflowed: false }
    }

    /// The best answer: by area where there is one, else by samples.
    #[must_use]
    pub fn visibility(&self) -> f32 {
        self.by_area.unwrap_or(self.sampled)
    }

    /// What passes to one sample: 0 hidden, 1 visible.
    #[must_use]
    pub fn passes(&self, sample: usize) -> f32 {
        match self.hidden[sample / 64] >> (sample % 64) & 1 {
            1 => 0.0,
            _ => self.passes.as_ref().map_or(1.0, |passes| passes[sample]),
        }
    }

    /// Visibility of a textured light: for each channel the light that passes over all light. Forest et al., equation 2, is that times the
    /// mean radiance. A channel without light returns the share of the samples.
    ///
    /// `radiance` has one entry a sample, as [`softshadow_scene::LightSamples::radiance`].
    #[must_use]
    pub fn textured(&self, radiance: &[[f32; 3]]) -> [f32; 3] {
        [0, 1, 2].map(|channel| {
            let weighted = radiance.iter().enumerate().map(|(sample, l)| (f64::from(l[channel]), self.passes(sample)));
            let (whole, seen) = weighted.fold((0.0, 0.0), |(whole, seen), (l, p)| (whole + l, seen + l * f64::from(p)));
            if whole > 0.0 { (seen / whole) as f32 } else { self.sampled }
        })
    }
}

impl DepthComplexity<'_> {
    /// What one receiver sees. `W` words hold the samples: `64·W` at most are looked at.
    #[must_use]
    pub fn see<const W: usize>(&self, receiver: &Receiver) -> Seen<W> {
        let samples = &self.samples[..self.samples.len().min(64 * W)];
        let all = first_bits::<W>(samples.len());
        let view = match LightView::towards(self.light, receiver.position) {
            Sight::Behind => return Seen::all_or_nothing(all, 0.0),
            Sight::Inside => return Seen::all_or_nothing([0; W], 1.0),
            Sight::View(view) => view,
        };
        let placed;
        let samples = if view.cap.is_some() {
            placed = view.place_samples(self.light, samples);
            &placed
        } else {
            samples
        };
        let mut hidden = below_horizon(&view, receiver, samples);
        if hidden == all {
            return Seen { by_area: None, ..Seen::all_or_nothing(hidden, 0.0) };
        }
        let depth = depth_of_reference(&view, self.occluders, receiver);
        let mut folded = Folded::new(depth, self.exact_area && is_above_horizon(&view, receiver, self.light));
        edges_in_reach(&view, self.light.bounds, self.occluders, |edge| {
            let Some(image) = ProjectedEdge::new(&view, edge).before(&view, edge) else { return };
            if image.misses(self.light.bounds) {
                return;
            }
            let weight = weight(&view, self.occluders, edge, receiver);
            if weight != Layers::NONE
                && let Some(directions) = image.directions()
            {
                let mask = match self.coverage {
                    Coverage::Tables(tables) if view.cap.is_none() => tables.crossed::<W>(&image, directions),
                    _ => crossed_exactly::<W>(&image, directions, samples),
                };
                folded.add(self.light, &image, directions, weight, &mask);
            }
        });
        let reference = self.light.reference;
        folded.most_attenuation += most_touching(self.occluders);
        add_touching(&view, self.occluders, receiver, reference, samples, &mut hidden, &mut folded.attenuation);
        hidden.iter_mut().zip(folded.opaque.nonzero()).zip(all).for_each(|((h, d), a)| *h |= d & a);
        let mut seen = Seen {
            hidden,
            passes: folded.passes(samples.len()),
            sampled: 0.0,
            by_area: None,
            silhouettes: folded.silhouettes,
            overflowed: folded.most_attenuation > i64::from(i32::MAX),
        };
        seen.sampled =
            (0..samples.len()).map(|sample| f64::from(seen.passes(sample))).sum::<f64>() as f32 / samples.len() as f32;
        seen.by_area = folded.visible_area(self.light, &all, samples.len(), seen.sampled);
        seen
    }
}

/// What the edges of one receiver add up to.
struct Folded<const W: usize> {
    depth: Layers,
    opaque: Counters<W>,
    attenuation: Counters<W>,
    areas: Option<AreaSum>,
    silhouettes: u32,
    smallest_weight: u32,
    is_opaque: bool,
    /// No sample has more attenuation than that.
    most_attenuation: i64,
}

impl<const W: usize> Folded<W> {
    fn new(depth: Layers, wants_area: bool) -> Self {
        Self {
            depth,
            opaque: Counters::filled(depth.opaque),
            attenuation: Counters::filled(depth.attenuation as i32),
            areas: wants_area.then(AreaSum::default),
            silhouettes: 0,
            smallest_weight: u32::MAX,
            is_opaque: depth.attenuation == 0,
            most_attenuation: depth.attenuation.abs(),
        }
    }

    /// Takes one silhouette edge in: `D` beyond it is `D` before it, less λ·w.
    fn add(
        &mut self,
        light: &LightFrame,
        image: &ProjectedEdge,
        [from, to]: [DVec2; 2],
        weight: Layers,
        mask: &Mask<W>,
    ) {
        let left = image.has_reference_left;
        let change = if left { weight.negated() } else { weight };
        self.silhouettes += 1;
        self.opaque.add(mask, change.opaque);
        self.attenuation.add(mask, change.attenuation as i32);
        self.is_opaque &= weight.attenuation == 0;
        self.most_attenuation += weight.attenuation.abs();
        if weight.opaque != 0 {
            self.smallest_weight = self.smallest_weight.min(weight.opaque.unsigned_abs());
        }
        if let (Some(areas), Some(outline)) = (&mut self.areas, &light.outline) {
            let line = if image.line_has_reference_left([from, to]) { image.line } else { -image.line };
            let [first, last] = if left { [from, to] } else { [to, from] };
            let beyond = area_beyond(outline, line, first.as_vec2(), last.as_vec2());
            areas.add(beyond, change.opaque);
        }
    }

    /// What passes semi-opaque faces to each sample.
    fn passes(&self, samples: usize) -> Option<Vec<f32>> {
        // Within rounding of an edge a sample may count a face as taken away: nothing passes more than all.
        let of = |sample| (-f64::from(self.attenuation.value(sample).max(0)) / UNITS_PER_HALVING).exp2() as f32;
        (self.attenuation.nonzero() != [0; W]).then(|| (0..samples).map(of).collect())
    }

    /// The visible share of the light's area, where all samples that are hidden lie under equally many layers.
    fn visible_area(&self, light: &LightFrame, all: &Mask<W>, samples: usize, sampled: f32) -> Option<f32> {
        let whole = light.outline.as_ref()?.area();
        let change = self.areas?.value();
        if !self.is_opaque {
            return None;
        }
        let nothing_hidden = self.opaque.nonzero().iter().zip(all).all(|(d, a)| d & a == 0);
        let layers = match self.opaque.single_value(all) {
            Some(value) if value > 0 => f64::from(value),
            // A sliver between the samples: a layer of the thinnest edge seen.
            _ if nothing_hidden && self.smallest_weight < u32::MAX => f64::from(self.smallest_weight),
            _ if nothing_hidden => return Some(1.0),
            _ => return None,
        };
        // The reference point is one more sample.
        if self.depth.opaque != 0 && f64::from(self.depth.opaque) != layers {
            return None;
        }
        let hidden = (f64::from(self.depth.opaque) * whole + change) / (layers * whole);
        let visible = 1.0 - hidden as f32;
        let bound = SAMPLING_BOUND * (samples as f32).powf(-0.75);
        ((visible - sampled).abs() <= bound).then(|| visible.clamp(0.0, 1.0))
    }
}

fn first_bits<const W: usize>(count: usize) -> Mask<W> {
    std::array::from_fn(|w| match count.saturating_sub(64 * w) {
        0 => 0,
        rest if rest >= 64 => !0,
        rest => !0 >> (64 - rest),
    })
}

/// Samples on or below the plane of the receiver's surface.
fn below_horizon<const W: usize>(view: &LightView, receiver: &Receiver, samples: &[[f32; 2]]) -> Mask<W> {
    let mut mask = [0; W];
    if let Some(normal) = receiver.normal.map(Vec3::from) {
        let [x, y, way] = view.ways.map(|w| normal.dot(w));
        for (word, chunk) in mask.iter_mut().zip(samples.chunks(64)) {
            for (bit, s) in chunk.iter().enumerate() {
                *word |= u64::from(way + x * s[0] + y * s[1] <= 0.0) << bit;
            }
        }
    }
    mask
}

/// Whether the whole light lies above the receiver's plane.
fn is_above_horizon(view: &LightView, receiver: &Receiver, light: &LightFrame) -> bool {
    let [low, high] = light.bounds;
    receiver.normal.is_none_or(|normal| {
        let corners = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]];
        corners.iter().all(|c| Vec3::from(normal).dot(view.way_to(*c)) > 0.0)
    })
}
