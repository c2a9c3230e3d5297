//! The program of a whole call: every block of receivers, every light, every progressive pass, one stage each, or as many as the
//! technique has.

use std::sync::Arc;

use softshadow_plan::{Host, Plan, Program, Step, Values};
use softshadow_scene::Light;

use crate::block::Block;
use crate::parts::occluder_buffers::OccluderContents;
use crate::parts::scene_buffers::SceneContents;
use crate::request::{ReceiverSource, Request, Wants};
use crate::{Technique, TechniqueError};

/// Blocks × lights × passes × stages. Only the later stages of a pass need a decision, from the one before.
#[derive(Debug)]
pub struct VisibilityProgram<'a> {
    /// The technique and its settings.
    pub technique: &'a Technique,
    /// The scene on the device.
    pub scene: &'a SceneContents,
    /// The lights, in the caller's order.
    pub lights: &'a [Light],
    /// What hides each light, where the technique asks for it; else empty.
    pub occluders: &'a [Arc<OccluderContents>],
    /// Where receivers come from.
    pub receivers: ReceiverSource<'a>,
    /// Blocks of receivers.
    pub blocks: Vec<Block>,
    /// Channels of a value.
    pub channels: u32,
    /// What is wanted.
    pub wants: Wants,
    /// What the host can do.
    pub host: Host,
}

/// Which part of the call a stage does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StageTask {
    /// Index of the block.
    pub block: usize,
    /// Index of the light.
    pub light: usize,
    /// Progressive pass.
    pub pass: u32,
    /// Stage of that pass.
    pub stage: u32,
}

impl VisibilityProgram<'_> {
    /// How many stages there are.
    #[must_use]
    pub fn stages(&self) -> usize {
        self.blocks.len() * self.lights.len() * self.technique.passes() as usize * self.technique.stages() as usize
    }

    /// What stage `index` does; `None` after the last.
    #[must_use]
    pub fn task(&self, index: usize) -> Option<StageTask> {
        let (passes, stages) = (self.technique.passes() as usize, self.technique.stages() as usize);
        (index < self.stages()).then(|| StageTask {
            block: index / (stages * passes * self.lights.len()),
            light: index / (stages * passes) % self.lights.len(),
            pass: (index / stages % passes) as u32,
            stage: (index % stages) as u32,
        })
    }

    fn request(&self, task: StageTask, read_back: &[u32]) -> Request<'_> {
        let opens_pass = task.stage == 0;
        let last_pass = task.pass + 1 == self.technique.passes() && task.stage + 1 == self.technique.stages();
        let mut decision = [0; 4];
        decision.iter_mut().zip(read_back).for_each(|(word, read)| *word = *read);
        Request {
            scene: self.scene,
            receivers: self.receivers,
            block: self.blocks[task.block],
            light: &self.lights[task.light],
            occluders: self.occluders.get(task.light).map(Arc::as_ref),
            channels: self.channels,
            opens_block: opens_pass && task.light == 0 && task.pass == 0,
            first_light: task.light == 0,
            opens_run: opens_pass && task.block == 0 && task.light == 0 && task.pass == 0,
            only_light: self.lights.len() == 1,
            closes_light: last_pass,
            closes_block: last_pass && task.light + 1 == self.lights.len(),
            stage: task.stage,
            decision,
            wants: self.wants,
            host: self.host,
        }
    }

    /// The plan of one stage, after what the stage before read back.
    #[must_use]
    pub fn plan(&self, task: StageTask, decision: &[u32]) -> Plan {
        self.technique.plan(&self.request(task, decision))
    }

    /// The plan and the parameters of one stage.
    ///
    /// # Errors
    /// As [`Technique::values`].
    pub fn stage(&self, task: StageTask, decision: &[u32]) -> Result<(Plan, Values), TechniqueError> {
        let request = self.request(task, decision);
        Ok((self.technique.plan(&request), self.technique.values(&request, &self.lights[task.light], task.pass)?))
    }

    /// Checks what would make a stage fail, so that [`Program::step`] cannot.
    ///
    /// # Errors
    /// As [`Technique::check`], [`Technique::check_call`], [`Technique::check_scene`] and [`Technique::check_light`].
    pub fn check(&self) -> Result<(), TechniqueError> {
        self.technique.check()?;
        self.technique.check_call(self.receivers, self.lights, &self.host)?;
        self.technique.check_scene(self.scene)?;
        if self.technique.wants_occluders() && self.occluders.len() != self.lights.len() {
            let reason = format!("{} given for {} lights", self.occluders.len(), self.lights.len());
            return Err(TechniqueError::Setting { technique: self.technique.name(), setting: "occluders", reason });
        }
        self.technique.check_occluders(self.occluders)?;
        self.lights.iter().try_for_each(|light| light.check_local(&self.scene.local.frame))?;
        if let ReceiverSource::Points(points) = self.receivers {
            points.check_local(&self.scene.local.frame)?;
        }
        // What a light can be refused for shows in its first stage: the others differ in numbers only.
        let per_light = self.technique.passes() as usize * self.technique.stages() as usize;
        let mut firsts = (0..self.lights.len()).filter_map(|light| self.task(light * per_light));
        firsts.try_for_each(|task| self.technique.check_light(&self.request(task, &[])))
    }
}

impl Program for VisibilityProgram<'_> {
    fn step(&self, index: usize, decision: &[u32]) -> Step {
        match self.task(index).map(|task| self.stage(task, decision)) {
            Some(Ok((plan, values))) => Step::run(plan, values),
            // `check` has tried every light, and nothing else can fail.
            Some(Err(_)) | None => Step::Done,
        }
    }
}
