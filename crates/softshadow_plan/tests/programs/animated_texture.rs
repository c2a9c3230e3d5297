//! An animated light texture: where the light hides behind occluders does not change, so it is traced once; every frame uploads
//! its texture and weighs the same masks with it.

use softshadow_plan::{Content, Kernel, Over, Plan, Program, Stage, Step, Values};

use crate::walk::{given, text, walk, words};

const SIDE: u32 = 16;
const SAMPLES: u32 = 64;

struct AnimatedTexture {
    receivers: u32,
    /// Texels of every frame, four floats each: a buffer, because textures are only drawn.
    frames: Vec<Content>,
}

impl AnimatedTexture {
    fn frame(&self, index: usize) -> Plan {
        let mut plan = Plan::new(if index == 0 { "trace and weigh" } else { "weigh" });
        let each = u64::from(self.receivers);
        let over = |work_per_item| Over::Items { count: self.receivers, work_per_item };
        let masks = plan.persistent("blocked samples", each * u64::from(SAMPLES / 8));
        if index == 0 {
            let receivers = given(&mut plan, "receivers", each * 32);
            let samples = plan.parameter("light samples", u64::from(SAMPLES) * 16);
            let trace = Kernel { file: "rays/trace.wgsl", entry: "trace" };
            plan.compute("trace", "finds the blocked samples once for all frames", trace, over(SAMPLES))
                .bind("receivers", receivers)
                .bind("light_samples", samples)
                .bind("blocked", masks);
        }
        let texture = plan.uploaded("light texture", &self.frames[index]);
        let frame = plan.parameter("frame", 16);
        let visibility = plan.buffer("visibility", each * 12);
        let weigh = Kernel { file: "rays/weigh.wgsl", entry: "weigh" };
        plan.compute("weigh", "adds up the radiance of the samples that are seen", weigh, over(SAMPLES / 8))
            .bind("frame", frame)
            .bind("light_texture", texture)
            .bind("blocked", masks)
            .bind("visibility", visibility);
        plan.outputs.push(visibility);
        plan
    }
}

impl Program for AnimatedTexture {
    fn step(&self, index: usize, _decision: &[u32]) -> Step {
        if index >= self.frames.len() {
            return Step::Done;
        }
        let mut values = Values::from([words("frame", &[index as u32, SAMPLES, SIDE, 0])]);
        if index == 0 {
            values.extend([words("light samples", &[0; 4 * SAMPLES as usize])]);
        }
        Step::run(self.frame(index), values)
    }
}

fn flicker() -> Vec<Stage> {
    let frame = |brightness: f32| {
        let texels: Vec<u8> = [brightness; 4 * (SIDE * SIDE) as usize].iter().flat_map(|x| x.to_le_bytes()).collect();
        Content::new(&texels)
    };
    let program = AnimatedTexture { receivers: 3072, frames: [1.0, 0.5, 1.0, 0.5].map(frame).to_vec() };
    walk(&program, |_, _| Vec::new())
}

#[test]
fn the_first_frame_traces_and_the_others_weigh() {
    let stages = flicker();
    assert_eq!(stages.len(), 4);
    insta::assert_snapshot!(text(&stages, [0, 1]));
}

#[test]
fn a_frame_that_returns_is_the_same_plan_with_the_same_content() {
    let stages = flicker();
    assert_eq!(stages[1].plan, stages[3].plan);
    assert_ne!(stages[1].plan, stages[2].plan, "another texture is another content");
    assert_eq!(stages[1].plan.to_string(), stages[2].plan.to_string(), "and nothing else");
    // 16 × 16 texels of 16 bytes are what is uploaded, whatever the frame.
    let texture = stages[2].plan.find("light texture").unwrap();
    assert_eq!(stages[2].plan.resources[texture.index()].bytes(), 4096);
}
