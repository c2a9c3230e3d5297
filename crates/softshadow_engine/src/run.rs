//! The interpreter: a program's stages, one submission each unless a pass is so long that it is split.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use softshadow_plan::{
    AdapterInfo, Content, ContentKey, DeviceKind, Engine, EngineError, Host, OnStage, Origin, PassTime, Plan, Program,
    ResourceId, RunReport, SLICE, Stage, StageReport, Step, Timing, check,
};

use crate::adapter::{AdapterChoice, Opened, open};
use crate::encode::{Encoding, SLICE_STRIDE};
use crate::error::from_wgpu;
use crate::pipelines::Pipelines;
use crate::pool::{Pool, Slot};
use crate::schedule::{Dispatch, schedule};
use crate::timing::Timestamps;

/// How long one submission may take.
const TIMEOUT_SECONDS: u64 = 300;

/// An open device and everything that is kept on it between runs. Runs take turns.
pub struct WgpuEngine {
    opened: Opened,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    pipelines: Pipelines,
    pool: Pool,
}

impl Engine for WgpuEngine {
    fn adapter(&self) -> &AdapterInfo {
        &self.opened.info
    }

    fn host(&self) -> Host {
        self.opened.host
    }

    fn is_lost(&self) -> bool {
        lock(&self.opened.lost).is_some()
    }

    fn destroy(&self) {
        self.opened.device.destroy();
        lock(&self.opened.lost).get_or_insert_with(|| "destroyed by the caller".to_owned());
    }

    fn forget(&self, contents: &[ContentKey]) {
        lock(&self.state).pool.forget(contents);
    }

    fn run(
        &self,
        program: &dyn Program,
        contents: &BTreeMap<ContentKey, Content>,
        timing: Timing,
        on_stage: OnStage<'_>,
    ) -> Result<RunReport, EngineError> {
        let mut state = lock(&self.state);
        state.pool.begin_run();
        let started = Instant::now();
        let mut report = RunReport::default();
        let mut decision: Vec<u32> = Vec::new();
        let mut index = 0;
        while let Step::Run(stage) = program.step(index, &decision) {
            let result = self.run_stage(&mut state, &stage, contents, timing, &mut report, on_stage);
            if result.is_err() {
                // Whatever a failed stage left behind is not trusted again.
                state.pool.clear();
            }
            let mut outputs = result?;
            let label = |id: &ResourceId| stage.plan.resources[id.index()].label.as_str();
            decision = stage
                .plan
                .decision
                .as_ref()
                .and_then(|id| outputs.get(label(id)))
                .map_or_else(Vec::new, |bytes| bytes.chunks_exact(4).map(bytemuck::pod_read_unaligned).collect());
            outputs.retain(|name, _| stage.plan.outputs.iter().any(|id| label(id) == name));
            report.wall_ms = started.elapsed().as_secs_f64() * 1e3;
            report.stages += 1;
            let outputs = outputs.into_iter().map(|(label, bytes)| (label, Cow::Owned(bytes))).collect();
            if !on_stage(Some(StageReport { index, outputs })) {
                return Err(EngineError::Interrupted);
            }
            index += 1;
        }
        Ok(report)
    }
}

impl WgpuEngine {
    /// Opens a device.
    ///
    /// # Errors
    /// [`EngineError::NoAdapter`] says how to install one.
    pub fn new(choice: AdapterChoice) -> Result<Self, EngineError> {
        Ok(Self { opened: open(choice)?, state: Mutex::default() })
    }

    fn run_stage(
        &self,
        state: &mut State,
        stage: &Stage,
        contents: &BTreeMap<ContentKey, Content>,
        timing: Timing,
        report: &mut RunReport,
        on_stage: OnStage<'_>,
    ) -> Result<BTreeMap<String, Vec<u8>>, EngineError> {
        let (plan, device) = (&stage.plan, &self.opened.device);
        self.fail_if_lost(&plan.name)?;
        check(plan, &self.opened.host)?;
        let bytes = plan.resources.iter().map(softshadow_plan::Resource::bytes).sum::<u64>();
        if bytes > report.bytes.iter().map(|(_, b)| b).sum() {
            report.bytes = plan.memory().into_iter().map(|(label, bytes)| (label.to_owned(), bytes)).collect();
        }
        let scopes = [wgpu::ErrorFilter::OutOfMemory, wgpu::ErrorFilter::Validation, wgpu::ErrorFilter::Internal]
            .map(|filter| device.push_error_scope(filter));
        let result = self.encode_and_run(state, stage, contents, timing, report, on_stage);
        // Scopes close in the reverse of the order in which they were opened.
        let mut caught = None;
        for scope in scopes.into_iter().rev() {
            caught = pollster::block_on(scope.pop()).or(caught);
        }
        self.fail_if_lost(&plan.name)?;
        if let Some(error) = caught {
            return Err(from_wgpu(&plan.name, &error));
        }
        if let Some(reason) = lock(&self.opened.uncaught).take() {
            return Err(EngineError::Refused { stage: plan.name.clone(), reason });
        }
        result
    }

    fn fail_if_lost(&self, stage: &str) -> Result<(), EngineError> {
        match lock(&self.opened.lost).clone() {
            Some(reason) => Err(EngineError::DeviceLost { stage: stage.to_owned(), reason }),
            None => Ok(()),
        }
    }

    fn encode_and_run(
        &self,
        state: &mut State,
        stage: &Stage,
        contents: &BTreeMap<ContentKey, Content>,
        timing: Timing,
        report: &mut RunReport,
        on_stage: OnStage<'_>,
    ) -> Result<BTreeMap<String, Vec<u8>>, EngineError> {
        let (plan, values) = (&stage.plan, &stage.values);
        let (device, queue) = (&self.opened.device, &self.opened.queue);
        let slots = plan
            .resources
            .iter()
            .map(|resource| {
                let slot = state.pool.get(device, queue, &plan.name, resource, contents)?;
                if let (Origin::Parameter, Slot::Buffer(buffer)) = (resource.origin, &slot) {
                    let value = values.get(&resource.label).filter(|v| v.len() as u64 == resource.bytes());
                    let missing = || EngineError::contents(&plan.name, &resource.label, "its value was not given");
                    write_padded(queue, buffer, value.ok_or_else(missing)?);
                }
                Ok(slot)
            })
            .collect::<Result<Vec<Slot>, EngineError>>()?;
        let submissions = schedule(plan, &self.opened.host, timing);
        let slices = self.slice_buffer(&submissions);
        let last = submissions.len().saturating_sub(1);
        let outputs: Vec<ResourceId> = plan.outputs.iter().chain(&plan.decision).copied().collect();
        let mut readback = Vec::new();
        for (number, dispatches) in submissions.iter().enumerate() {
            let mut encoder =
                device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some(&plan.name) });
            // Software drivers stamp a pass before its work is done: their passes are timed one submission at a time.
            let has_clock = timing == Timing::Device && self.opened.info.device_type == DeviceKind::Gpu;
            let mut timestamps = if has_clock { Timestamps::new(device, dispatches.len()) } else { None };
            let mut encoding =
                Encoding { device, pipelines: &mut state.pipelines, plan, slots: &slots, slices: &slices };
            for dispatch in dispatches {
                encoding.dispatch(dispatch, &mut encoder, &mut timestamps)?;
            }
            if number == last {
                readback = self.copy_outputs(plan, &slots, &outputs, &mut encoder);
            }
            let clock = timestamps.as_ref().and_then(|t| t.resolve(&mut encoder)).cloned();
            let submitted = Instant::now();
            queue.submit([encoder.finish()]);
            report.submissions += 1;
            let mut waiting: Vec<&wgpu::Buffer> = clock.iter().collect();
            waiting.extend(&readback);
            let mut read = self.wait(&plan.name, &waiting)?;
            if let (Some(timestamps), true) = (&timestamps, clock.is_some()) {
                let times = timestamps.read(&read.remove(0), queue.get_timestamp_period());
                report.add_times(times);
            }
            if let (Timing::EachPass, [dispatch]) = (timing, dispatches.as_slice()) {
                let ms = submitted.elapsed().as_secs_f64() * 1e3;
                report.add_times(vec![PassTime { label: dispatch.pass.label.clone(), ms }]);
            }
            if number == last {
                let labels = outputs.iter().map(|id| plan.resources[id.index()].label.clone());
                return Ok(labels.zip(read).collect());
            }
            if !on_stage(None) {
                return Err(EngineError::Interrupted);
            }
        }
        Ok(BTreeMap::new())
    }

    fn slice_buffer(&self, submissions: &[Vec<Dispatch<'_>>]) -> wgpu::Buffer {
        let dispatches: Vec<&Dispatch<'_>> = submissions.iter().flatten().collect();
        let mut bytes = vec![0u8; (dispatches.len().max(1) as u64 * SLICE_STRIDE) as usize];
        for dispatch in dispatches {
            let at = dispatch.slice * SLICE_STRIDE as usize;
            bytes[at..at + 8].copy_from_slice(bytemuck::cast_slice(&[dispatch.first, dispatch.count]));
        }
        let buffer = self.opened.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(SLICE),
            size: bytes.len() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        self.opened.queue.write_buffer(&buffer, 0, &bytes);
        buffer
    }

    fn copy_outputs(
        &self,
        plan: &Plan,
        slots: &[Slot],
        outputs: &[ResourceId],
        encoder: &mut wgpu::CommandEncoder,
    ) -> Vec<wgpu::Buffer> {
        let copy = |id: &ResourceId| {
            let Slot::Buffer(source) = &slots[id.index()] else { return None };
            let readable = self.opened.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(&plan.resources[id.index()].label),
                size: source.size(),
                usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
                mapped_at_creation: false,
            });
            encoder.copy_buffer_to_buffer(source, 0, &readable, 0, source.size());
            Some(readable)
        };
        outputs.iter().filter_map(copy).collect()
    }

    /// Waits for everything submitted and returns the contents of the given buffers.
    fn wait(&self, stage: &str, buffers: &[&wgpu::Buffer]) -> Result<Vec<Vec<u8>>, EngineError> {
        let lost = |reason: String| EngineError::DeviceLost { stage: stage.to_owned(), reason };
        let (sender, receiver) = std::sync::mpsc::channel();
        for buffer in buffers {
            let sender = sender.clone();
            // The receiver lives until every callback has run; a failed send has nobody to tell.
            buffer.map_async(wgpu::MapMode::Read, .., move |result| drop(sender.send(result)));
        }
        let wait = wgpu::PollType::Wait { submission_index: None, timeout: Some(Duration::from_secs(TIMEOUT_SECONDS)) };
        match self.opened.device.poll(wait) {
            Ok(_) => {}
            Err(wgpu::PollError::Timeout) => {
                return Err(EngineError::Timeout { stage: stage.to_owned(), seconds: TIMEOUT_SECONDS });
            }
            Err(error) => return Err(lost(error.to_string())),
        }
        for result in receiver.try_iter().take(buffers.len()) {
            result.map_err(|error| lost(error.to_string()))?;
        }
        let read = |buffer: &&wgpu::Buffer| {
            let bytes = buffer.get_mapped_range(..).map_err(|error| lost(error.to_string()))?.to_vec();
            buffer.unmap();
            Ok(bytes)
        };
        buffers.iter().map(read).collect()
    }
}

/// Writes bytes whose length need not be a multiple of four.
fn write_padded(queue: &wgpu::Queue, buffer: &wgpu::Buffer, bytes: &[u8]) {
    if bytes.len().is_multiple_of(4) {
        queue.write_buffer(buffer, 0, bytes);
    } else {
        let mut padded = bytes.to_vec();
        padded.resize(bytes.len().next_multiple_of(4), 0);
        queue.write_buffer(buffer, 0, &padded);
    }
}

/// Locks a mutex even where a panic has poisoned it: what is behind it stays consistent between statements.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
