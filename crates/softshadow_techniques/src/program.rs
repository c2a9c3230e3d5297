//! The program of a whole call: every block of receivers, every light, every progressive pass, one stage each.

use std::sync::Arc;

use softshadow_plan::{Host, Plan, Program, Step, Values};
use softshadow_scene::Light;

use crate::block::Block;
use crate::parts::occluder_buffers::OccluderContents;
use crate::parts::scene_buffers::SceneContents;
use crate::request::{ReceiverSource, Request, Wants};
use crate::{Technique, TechniqueError};

/// Blocks × lights × passes. Stages need no decision from the one before.
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
}

impl VisibilityProgram<'_> {
    /// How many stages there are.
    #[must_use]
    pub fn stages(&self) -> usize {
        self.blocks.len() * self.lights.len() * self.technique.passes() as usize
    }

    /// What stage `index` does; `None` after the last.
    #[must_use]
    pub fn task(&self, index: usize) -> Option<StageTask> {
        let passes = self.technique.passes() as usize;
        (index < self.stages()).then(|| StageTask {
            block: index / (passes * self.lights.len()),
            light: index / passes % self.lights.len(),
            pass: (index % passes) as u32,
        })
    }

    fn request(&self, task: StageTask) -> Request<'_> {
        let last_pass = task.pass + 1 == self.technique.passes();
        Request {
            scene: self.scene,
            receivers: self.receivers,
            block: self.blocks[task.block],
            light: &self.lights[task.light],
            occluders: self.occluders.get(task.light).map(Arc::as_ref),
            channels: self.channels,
            opens_block: task.light == 0 && task.pass == 0,
            first_light: task.light == 0,
            opens_run: task.block == 0 && task.light == 0 && task.pass == 0,
            closes_light: last_pass,
            closes_block: last_pass && task.light + 1 == self.lights.len(),
            wants: self.wants,
            host: self.host,
        }
    }

    /// The plan of one stage.
    #[must_use]
    pub fn plan(&self, task: StageTask) -> Plan {
        self.technique.plan(&self.request(task))
    }

    /// The plan and the parameters of one stage.
    ///
    /// # Errors
    /// As [`Technique::values`].
    pub fn stage(&self, task: StageTask) -> Result<(Plan, Values), TechniqueError> {
        let request = self.request(task);
        Ok((self.technique.plan(&request), self.technique.values(&request, &self.lights[task.light], task.pass)?))
    }

    /// Checks what would make a stage fail, so that [`Program::step`] cannot.
    ///
    /// # Errors
    /// As [`Technique::check`] and [`Technique::values`].
    pub fn check(&self) -> Result<(), TechniqueError> {
        self.technique.check()?;
        self.technique.check_receivers(self.receivers)?;
        if self.technique.wants_occluders() && self.occluders.len() != self.lights.len() {
            let reason = format!("{} given for {} lights", self.occluders.len(), self.lights.len());
            return Err(TechniqueError::Setting { technique: self.technique.name(), setting: "occluders", reason });
        }
        if let ReceiverSource::Points(points) = self.receivers {
            points.check_local(&self.scene.local.frame)?;
        }
        match self.task(0) {
            Some(task) => self.stage(task).map(|_| ()),
            None => Ok(()),
        }
    }
}

impl Program for VisibilityProgram<'_> {
    fn step(&self, index: usize, _decision: &[u32]) -> Step {
        match self.task(index).map(|task| self.stage(task)) {
            Some(Ok((plan, values))) => Step::run(plan, values),
            // `check` has made the first stage already, and stages differ in numbers only.
            Some(Err(_)) | None => Step::Done,
        }
    }
}
