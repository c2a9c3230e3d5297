//! Calls for a device that somebody else owns. Nothing here opens or knows one: what it can do comes as data, and a call is a program whose
//! results a host leaves on the device.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use softshadow_plan::{
    AdapterInfo, Content, ContentKey, Delivery, DeviceProgram, Host, ResourceId, RunReport, Stage, StageReport,
};
use softshadow_scene::{Light, Receivers, Scene};
use softshadow_techniques::parts::VISIBILITY;
use softshadow_techniques::parts::receivers::RECEIVERS;
use softshadow_techniques::parts::resolve::STANDARD_ERROR;
use softshadow_techniques::{Block, StageTask, Technique, VisibilityProgram, Wants};

use crate::error::Error;
use crate::info::{Info, notes};
use crate::scene_cache::{Prepared, SceneCache};
use crate::visibility::{Collector, Options, channels_of, check_call, hidden_lights, program, samples_of, source_of};

/// What is known of somebody else's device, and the scenes of the last calls as it reads them.
pub struct ForeignDevice {
    adapter: AdapterInfo,
    host: Host,
    scenes: Mutex<SceneCache>,
}

impl ForeignDevice {
    /// A device with these abilities; `adapter` is what results say of it.
    #[must_use]
    pub fn new(adapter: AdapterInfo, host: Host) -> Self {
        Self { adapter, host, scenes: Mutex::default() }
    }

    /// Checks a call against the device and prepares it.
    ///
    /// # Errors
    /// As [`crate::visibility`], and [`Error::Settings`] for receivers and sample masks, which are no results on a device. Nothing has been
    /// made there.
    pub fn visibility(
        &self,
        scene: &Scene,
        lights: &[Light],
        receivers: Receivers,
        technique: &Technique,
        options: &Options,
    ) -> Result<ForeignCall, Error> {
        if options.receivers || options.sample_masks {
            return Err(Error::Settings("receivers and sample masks are not left on a device".into()));
        }
        check_call(lights, &receivers, technique, &self.host)?;
        let hidden = hidden_lights(lights, &receivers, technique);
        let mut cache = self.scenes.lock().unwrap_or_else(PoisonError::into_inner);
        let (prepared, superseded) = cache.prepare(scene, &receivers, hidden, &self.host);
        drop(cache);
        let prepared = prepared?;
        technique.check_scene(&prepared.contents)?;
        let work = program(&prepared, lights, &receivers, technique, options, None, self.host)?;
        let (blocks, wants) = work.map(|p| (p.blocks, p.wants)).unwrap_or_default();
        Ok(ForeignCall {
            adapter: self.adapter.clone(),
            host: self.host,
            notes: notes(scene, lights, technique, &prepared.contents.local),
            lights: lights.to_vec(),
            receivers,
            technique: technique.clone(),
            options: options.clone(),
            prepared,
            blocks,
            wants,
            superseded,
        })
    }
}

/// A prepared call.
pub struct ForeignCall {
    adapter: AdapterInfo,
    host: Host,
    notes: Vec<String>,
    lights: Vec<Light>,
    receivers: Receivers,
    technique: Technique,
    options: Options,
    prepared: Prepared,
    /// Empty where no receiver sees anything.
    blocks: Vec<Block>,
    wants: Wants,
    superseded: Vec<ContentKey>,
}

impl ForeignCall {
    /// Names and bytes of the results: float32, lights × receivers × channels. `visibility` is always there, `standard error` where it was
    /// asked for and the technique has one. What belongs to a pixel that sees nothing has no meaning.
    #[must_use]
    pub fn results(&self) -> Vec<(&'static str, u64)> {
        let bytes = self.width() * self.receivers.count() * self.lights.len() as u64;
        let has_error = self.options.standard_error && samples_of(&self.technique).is_some();
        let labels = [VISIBILITY].into_iter().chain(has_error.then_some(STANDARD_ERROR));
        labels.map(|label| (label, bytes)).collect()
    }

    /// Channels of a value: three where a light has a texture.
    #[must_use]
    pub fn channels(&self) -> usize {
        channels_of(&self.lights)
    }

    /// Bytes of one receiver in a result.
    fn width(&self) -> u64 {
        4 * self.channels() as u64
    }

    /// Everything that plans may upload, by key.
    #[must_use]
    pub fn uploads(&self) -> BTreeMap<ContentKey, Content> {
        self.prepared.uploads()
    }

    /// Uploads of earlier calls that will not be used again: the last frame of a scene that moves.
    #[must_use]
    pub fn superseded(&self) -> &[ContentKey] {
        &self.superseded
    }

    /// What the device can do.
    #[must_use]
    pub fn host(&self) -> &Host {
        &self.host
    }

    /// How many stages there are.
    #[must_use]
    pub fn stages(&self) -> usize {
        self.program().stages()
    }

    /// What a run of all stages found, after their counts.
    ///
    /// # Errors
    /// [`Error::Gpu`] where receivers were left unfinished, with what to do instead.
    pub fn finish(&self, stages: &[StageReport], run: RunReport) -> Result<Info, Error> {
        let program = self.program();
        if stages.len() != program.stages() {
            return Err(Error::Gpu(format!("only {} of {} stages ran", stages.len(), program.stages())));
        }
        let mut collector = Collector::new(
            &self.adapter,
            self.notes.clone(),
            &self.lights,
            &self.receivers,
            &self.technique,
            &self.options,
            &self.prepared.contents,
            self.channels(),
            false,
        );
        collector.result.info.preparation = self.prepared.preparation.clone();
        if !self.blocks.is_empty() {
            collector.describe(&program);
        }
        stages.iter().for_each(|stage| collector.add_stage(&program, stage));
        collector.check(&self.technique)?;
        let mut info = collector.result.info;
        info.add_run(run);
        Ok(info)
    }

    fn program(&self) -> VisibilityProgram<'_> {
        VisibilityProgram {
            technique: &self.technique,
            scene: &self.prepared.contents,
            lights: &self.lights,
            occluders: &self.prepared.occluders,
            receivers: source_of(&self.receivers),
            blocks: self.blocks.clone(),
            channels: self.channels() as u32,
            wants: self.wants,
            host: self.host,
        }
    }

    fn delivery(&self, output: ResourceId, result: &'static str, task: StageTask) -> Delivery {
        let (block, width) = (self.blocks[task.block], self.width());
        let first = task.light as u64 * self.receivers.count() + (block.first + block.skip) as u64;
        let [source, target, bytes] = [block.skip as u64, first, block.keep as u64].map(|n| n * width);
        Delivery { output, result, source, target, bytes }
    }
}

impl DeviceProgram for ForeignCall {
    fn step_on_device(&self, index: usize, decision: &[u32]) -> Option<(Stage, Vec<Delivery>)> {
        let program = self.program();
        let task = program.task(index)?;
        // `check` has made the first stage already, and stages differ in numbers only.
        let (mut plan, values) = program.stage(task, decision).ok()?;
        let (mut small, mut deliveries) = (Vec::new(), Vec::new());
        let results = self.results();
        for id in std::mem::take(&mut plan.outputs) {
            let label = plan.resources[id.index()].label.as_str();
            match results.iter().find(|(name, _)| *name == label) {
                Some((name, _)) => deliveries.push(self.delivery(id, name, task)),
                // Which pixels see anything is known on the device alone.
                None if label == RECEIVERS => {}
                None => small.push(id),
            }
        }
        plan.outputs = small;
        Some((Stage { plan, values }, deliveries))
    }
}
