//! Adaptive packing: counters of one sample each are digits of float32 colour targets, added by the blending unit. The first
//! stage counts how deep a counter begins; the second packs as narrowly as that allows; an overflow is packed again, wider.

use softshadow_plan::{
    Blend, ColorTarget, Count, Host, Kernel, Origin, Over, Plan, Program, Raster, RasterKernel, ResourceId, Shape,
    Step, TextureFormat, Values, VertexSource,
};

use crate::walk::{given, text, walk, words};

struct AdaptivePacking {
    size: [u32; 2],
    samples: u32,
    wedge_vertices: u32,
    host: Host,
}

/// Integers below 2^24 are exact in float32.
const EXACT_BITS: u32 = 24;

/// How the samples' counters lie in colour targets.
#[derive(Debug, PartialEq)]
struct Packing {
    bits: u32,
    targets: u32,
}

impl AdaptivePacking {
    /// One bit of room above the largest initial count, four more after every overflow.
    fn packing(&self, largest_count: u32, overflows: u32) -> Packing {
        let bits = (u32::BITS - largest_count.leading_zeros() + 1 + 4 * overflows).min(EXACT_BITS);
        Packing { bits, targets: self.samples.div_ceil(4 * (EXACT_BITS / bits)) }
    }

    fn targets_per_pass(&self) -> usize {
        self.host.limits.color_targets as usize
    }

    fn pixels(&self) -> u64 {
        u64::from(self.size[0]) * u64::from(self.size[1])
    }

    fn over_pixels(&self) -> Over {
        Over::Items { count: self.pixels() as u32, work_per_item: self.samples }
    }

    /// What both kinds of stages share: receivers, and the integers that decide. `[largest initial count, overflows]` stay from
    /// stage to stage, so that a later stage still knows what an earlier one found.
    fn shared(&self, plan: &mut Plan) -> [ResourceId; 3] {
        let receivers = given(plan, "receivers", self.pixels() * 32);
        let initial = plan.persistent("initial counts", self.pixels() * u64::from(self.samples));
        let decision = plan.persistent("decision", 8);
        plan.decision = Some(decision);
        [receivers, initial, decision]
    }

    fn count(&self) -> Plan {
        let mut plan = Plan::new("count initial depth");
        let [receivers, initial, decision] = self.shared(&mut plan);
        plan.clear("reset decision", "counts of the last run are forgotten", decision);
        let count = Kernel { file: "depth_complexity/count.wgsl", entry: "count" };
        plan.compute("count", "how many surfaces hide each sample before any silhouette", count, self.over_pixels())
            .bind("receivers", receivers)
            .bind("initial_counts", initial)
            .bind("decision", decision);
        plan
    }

    fn pack(&self, packing: &Packing) -> Plan {
        let mut plan = Plan::new(format!("pack {} bits in {} targets", packing.bits, packing.targets));
        let [receivers, initial, decision] = self.shared(&mut plan);
        let shape = Shape::Texture { format: TextureFormat::Rgba32Float, size: self.size, layers: packing.targets };
        let digits = plan.resource("digits", shape, Origin::Transient);
        let targets: Vec<u32> = (0..packing.targets).collect();
        // A pass draws to so many targets at once; the wedges are drawn again for the others.
        for (number, group) in targets.chunks(self.targets_per_pass()).enumerate() {
            let layout = plan.parameter(format!("packing {number}"), 16);
            let colors = group
                .iter()
                .map(|layer| ColorTarget { texture: digits, layer: *layer, clear: Some(0.0), blend: Blend::Add })
                .collect();
            let kernel =
                RasterKernel { file: "depth_complexity/wedges.wgsl", vertex: "extrude", fragment: Some("add_digits") };
            let vertices = VertexSource::Generated(Count::Fixed(self.wedge_vertices));
            let raster = Raster { kernel, vertices, colors, depth: None };
            plan.raster(format!("wedges {number}"), "adds every silhouette's step to its samples' digits", raster)
                .bind("packing", layout)
                .bind("receivers", receivers);
        }
        let layout = plan.find("packing 0").expect("there is a sample, so there is a target");
        let visibility = plan.persistent("visibility", self.pixels() * 4);
        let unpack = Kernel { file: "depth_complexity/unpack.wgsl", entry: "unpack" };
        plan.compute("unpack", "adds up the samples whose digits are zero", unpack, self.over_pixels())
            .bind("packing", layout)
            .bind("initial_counts", initial)
            .bind("digits", digits)
            .bind("visibility", visibility)
            .bind("decision", decision);
        plan.outputs.push(visibility);
        plan
    }
}

impl Program for AdaptivePacking {
    fn step(&self, index: usize, decision: &[u32]) -> Step {
        match (index, decision) {
            (0, _) => Step::run(self.count(), Values::new()),
            // Every packing before this one has overflowed, or the program were done.
            (_, [largest, overflows]) if *overflows as usize + 1 == index => {
                let packing = self.packing(*largest, *overflows);
                let most = self.targets_per_pass() as u32;
                let value =
                    |group: u32| words(&format!("packing {group}"), &[packing.bits, group * most, self.samples, 0]);
                Step::run(self.pack(&packing), (0..packing.targets.div_ceil(most)).map(value).collect())
            }
            _ => Step::Done,
        }
    }
}

fn program() -> AdaptivePacking {
    AdaptivePacking { size: [64, 48], samples: 64, wedge_vertices: 900, host: Host::default() }
}

/// A device on which the first `overflows` packings overflow.
fn device(largest: u32, overflows: u32) -> impl FnMut(usize, &softshadow_plan::Stage) -> Vec<u32> {
    move |index, _| vec![largest, (index as u32).min(overflows)]
}

#[test]
fn a_shallow_scene_is_packed_once() {
    let stages = walk(&program(), device(3, 0));
    assert_eq!(stages.len(), 2);
    insta::assert_snapshot!(text(&stages, [0, 1]));
}

#[test]
fn an_overflow_is_packed_again_with_wider_digits_in_more_passes() {
    let stages = walk(&program(), device(300, 1));
    assert_eq!(stages.len(), 3);
    let draws = |stage: usize| stages[stage].plan.passes.iter().filter(|p| p.label.starts_with("wedges")).count();
    assert_eq!((draws(1), draws(2)), (1, 2), "sixteen targets need two passes of eight");
    insta::assert_snapshot!(text(&stages, [2]));
}

#[test]
fn the_stage_follows_from_the_integers_alone() {
    let names = |largest, overflows| -> Vec<String> {
        walk(&program(), device(largest, overflows)).into_iter().map(|stage| stage.plan.name).collect()
    };
    assert_eq!(names(0, 0), ["count initial depth", "pack 1 bits in 1 targets"]);
    assert_eq!(
        names(5, 2),
        ["count initial depth", "pack 4 bits in 3 targets", "pack 8 bits in 6 targets", "pack 12 bits in 8 targets"]
    );
    assert_ne!(names(5, 2), names(9, 2), "another count makes other plans");
}
