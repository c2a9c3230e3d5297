//! The interpreter: a program's stages, one submission each unless a pass is so long that it is split.

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use serde::Serialize;
use softshadow_plan::{
    Content, ContentKey, Count, Host, Origin, Over, Pass, Plan, Program, Raster, ResourceId, SLICE, Stage, Step,
    VertexSource, Work, check,
};

use crate::adapter::{AdapterChoice, AdapterInfo, DeviceKind, Opened, open};
use crate::error::EngineError;
use crate::pipelines::Pipelines;
use crate::pool::{Pool, Slot};
use crate::timing::Timestamps;

/// Rays or similar steps of one submission: below a second on a slow software driver, so that watchdogs stay quiet and a
/// caller can stop in between.
const WORK_PER_SUBMISSION: u64 = 1 << 25;

/// How long one submission may take.
const TIMEOUT_SECONDS: u64 = 300;

/// Distance of two slices in their buffer; at least the uniform offset alignment of every device.
const SLICE_STRIDE: u64 = 256;

/// An open device and everything that is kept on it between runs. Runs take turns.
pub struct Engine {
    opened: Opened,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    pipelines: Pipelines,
    pool: Pool,
}

/// Time of one pass by the device's clock.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PassTime {
    /// The pass.
    pub label: String,
    /// Milliseconds.
    pub ms: f64,
}

/// How passes are timed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Timing {
    /// By the device's clock, where it has one that can be trusted; costs nothing.
    #[default]
    Device,
    /// By the wall clock, each pass in a submission of its own; the whole takes longer.
    EachPass,
}

/// What one stage produced.
#[derive(Debug, Clone, PartialEq)]
pub struct StageReport {
    /// Position of the stage in its program.
    pub index: usize,
    /// Contents of the plan's outputs, by label.
    pub outputs: BTreeMap<String, Vec<u8>>,
}

/// What a run cost.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct RunReport {
    /// Wall time from the first stage to the last result, in milliseconds.
    pub wall_ms: f64,
    /// Time by pass, where the device has a clock.
    pub pass_ms: Vec<PassTime>,
    /// Exact bytes by resource of the largest stage.
    pub bytes: Vec<(String, u64)>,
    /// Command buffers handed to the device.
    pub submissions: usize,
    /// Stages.
    pub stages: usize,
}

/// A dispatch or another step, with the part of the items that it covers.
struct Dispatch<'a> {
    pass: &'a Pass,
    first: u32,
    count: u32,
    slice: usize,
}

impl Engine {
    /// Opens a device.
    ///
    /// # Errors
    /// [`EngineError::NoAdapter`] says how to install one.
    pub fn new(choice: AdapterChoice) -> Result<Self, EngineError> {
        Ok(Self { opened: open(choice)?, state: Mutex::default() })
    }

    /// What the device is.
    #[must_use]
    pub fn adapter(&self) -> &AdapterInfo {
        &self.opened.info
    }

    /// What the device can do.
    #[must_use]
    pub fn host(&self) -> Host {
        self.opened.host
    }

    /// Whether the device is gone; then a new engine has to be made.
    #[must_use]
    pub fn is_lost(&self) -> bool {
        lock(&self.opened.lost).is_some()
    }

    /// Destroys the device as a failing driver would: every later run ends in [`EngineError::DeviceLost`].
    pub fn destroy(&self) {
        self.opened.device.destroy();
        lock(&self.opened.lost).get_or_insert_with(|| "destroyed by the caller".to_owned());
    }

    /// Runs a program. `on_stage` receives each stage's outputs and returns whether to go on; it is also asked, with `None`,
    /// between the submissions of a stage that was split.
    ///
    /// # Errors
    /// Any [`EngineError`]; the engine stays usable unless the device was lost.
    pub fn run(
        &self,
        program: &dyn Program,
        contents: &BTreeMap<ContentKey, Content>,
        timing: Timing,
        on_stage: &mut dyn FnMut(Option<StageReport>) -> bool,
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
            let outputs = result?;
            decision = stage.plan.decision.map_or_else(Vec::new, |id| {
                let bytes = outputs.get(&stage.plan.resources[id.index()].label).map_or(&[][..], Vec::as_slice);
                bytes.chunks_exact(4).map(bytemuck::pod_read_unaligned).collect()
            });
            report.wall_ms = started.elapsed().as_secs_f64() * 1e3;
            report.stages += 1;
            if !on_stage(Some(StageReport { index, outputs })) {
                return Err(EngineError::Interrupted);
            }
            index += 1;
        }
        Ok(report)
    }

    fn run_stage(
        &self,
        state: &mut State,
        stage: &Stage,
        contents: &BTreeMap<ContentKey, Content>,
        timing: Timing,
        report: &mut RunReport,
        on_stage: &mut dyn FnMut(Option<StageReport>) -> bool,
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
            return Err(EngineError::from_wgpu(&plan.name, &error));
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
        on_stage: &mut dyn FnMut(Option<StageReport>) -> bool,
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
            for dispatch in dispatches {
                self.encode(state, plan, &slots, &slices, dispatch, &mut encoder, &mut timestamps)?;
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
                add_times(&mut report.pass_ms, times);
            }
            if let (Timing::EachPass, [dispatch]) = (timing, dispatches.as_slice()) {
                let ms = submitted.elapsed().as_secs_f64() * 1e3;
                add_times(&mut report.pass_ms, vec![PassTime { label: dispatch.pass.label.clone(), ms }]);
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

    #[expect(clippy::too_many_arguments, reason = "one step of the interpreter: everything it may touch, in one place")]
    fn encode(
        &self,
        state: &mut State,
        plan: &Plan,
        slots: &[Slot],
        slices: &wgpu::Buffer,
        dispatch: &Dispatch<'_>,
        encoder: &mut wgpu::CommandEncoder,
        timestamps: &mut Option<Timestamps>,
    ) -> Result<(), EngineError> {
        let device = &self.opened.device;
        let pass = dispatch.pass;
        let buffer = |id: ResourceId| match &slots[id.index()] {
            Slot::Buffer(buffer) => Ok(buffer),
            Slot::Texture(_) => {
                let label = &plan.resources[id.index()].label;
                Err(EngineError::contents(&plan.name, label, "is a texture where a buffer is needed"))
            }
        };
        match &pass.work {
            Work::Clear { target } => encoder.clear_buffer(buffer(*target)?, 0, None),
            Work::Copy { source, target, bytes } => {
                encoder.copy_buffer_to_buffer(buffer(*source)?, 0, buffer(*target)?, 0, *bytes);
            }
            Work::Compute { kernel, over } => {
                let pipeline = state.pipelines.compute(device, *kernel)?;
                let module = softshadow_shaders::module(kernel.file)
                    .map_err(|error| softshadow_plan::PlanError::Shader { pass: pass.label.clone(), error })?;
                let entry = &module.entry_points[kernel.entry];
                let group = bind_group(
                    device,
                    plan,
                    pass,
                    slots,
                    &pipeline.get_bind_group_layout(0),
                    &entry.bindings,
                    Some((slices, dispatch.slice)),
                );
                let timestamp_writes = timestamps.as_mut().map(|t| {
                    let (query_set, begin, end) = t.next(&pass.label);
                    wgpu::ComputePassTimestampWrites {
                        query_set,
                        beginning_of_pass_write_index: Some(begin),
                        end_of_pass_write_index: Some(end),
                    }
                });
                let mut compute = encoder
                    .begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some(&pass.label), timestamp_writes });
                compute.set_pipeline(&pipeline);
                compute.set_bind_group(0, &group, &[]);
                match over {
                    Over::Items { .. } => {
                        compute.dispatch_workgroups(dispatch.count.div_ceil(entry.workgroup_size[0]), 1, 1);
                    }
                    Over::Indirect(counts) => compute.dispatch_workgroups_indirect(buffer(*counts)?, 0),
                }
            }
            Work::Raster(raster) => self.encode_raster(state, plan, slots, pass, raster, encoder, timestamps)?,
        }
        Ok(())
    }

    #[expect(clippy::too_many_arguments, reason = "as `encode`, whose raster arm this is")]
    fn encode_raster(
        &self,
        state: &mut State,
        plan: &Plan,
        slots: &[Slot],
        pass: &Pass,
        raster: &Raster,
        encoder: &mut wgpu::CommandEncoder,
        timestamps: &mut Option<Timestamps>,
    ) -> Result<(), EngineError> {
        let device = &self.opened.device;
        let corners = matches!(raster.vertices, VertexSource::Corners { .. });
        let pipeline = state.pipelines.raster(device, plan, raster, corners)?;
        let bindings = raster_bindings(pass, raster)?;
        let group = (!bindings.is_empty())
            .then(|| bind_group(device, plan, pass, slots, &pipeline.get_bind_group_layout(0), &bindings, None));
        let view = |id: ResourceId, layer: u32| match &slots[id.index()] {
            Slot::Texture(texture) => Ok(texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2),
                base_array_layer: layer,
                array_layer_count: Some(1),
                ..Default::default()
            })),
            Slot::Buffer(_) => {
                let label = &plan.resources[id.index()].label;
                Err(EngineError::contents(&plan.name, label, "is a buffer where a texture is needed"))
            }
        };
        let color_views = raster.colors.iter().map(|c| view(c.texture, c.layer)).collect::<Result<Vec<_>, _>>()?;
        let depth_view = raster.depth.as_ref().map(|d| view(d.texture, d.layer)).transpose()?;
        let attachments: Vec<_> = raster
            .colors
            .iter()
            .zip(&color_views)
            .map(|(target, view)| {
                let load = target
                    .clear
                    .map_or(wgpu::LoadOp::Load, |v| wgpu::LoadOp::Clear(wgpu::Color { r: v, g: v, b: v, a: v }));
                let ops = wgpu::Operations { load, store: wgpu::StoreOp::Store };
                Some(wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops })
            })
            .collect();
        let depth = raster.depth.as_ref().zip(depth_view.as_ref()).map(|(target, view)| {
            let load = target.clear.map_or(wgpu::LoadOp::Load, wgpu::LoadOp::Clear);
            let depth_ops = Some(wgpu::Operations { load, store: wgpu::StoreOp::Store });
            wgpu::RenderPassDepthStencilAttachment { view, depth_ops, stencil_ops: None }
        });
        let timestamp_writes = timestamps.as_mut().map(|t| {
            let (query_set, begin, end) = t.next(&pass.label);
            wgpu::RenderPassTimestampWrites {
                query_set,
                beginning_of_pass_write_index: Some(begin),
                end_of_pass_write_index: Some(end),
            }
        });
        let mut draw = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(&pass.label),
            color_attachments: &attachments,
            depth_stencil_attachment: depth,
            timestamp_writes,
            occlusion_query_set: None,
            multiview_mask: None,
        });
        draw.set_pipeline(&pipeline);
        if let Some(group) = &group {
            draw.set_bind_group(0, group, &[]);
        }
        match raster.vertices {
            VertexSource::Corners { buffer, count } => {
                if let Slot::Buffer(buffer) = &slots[buffer.index()] {
                    draw.set_vertex_buffer(0, buffer.slice(..));
                    draw.draw(0..count, 0..1);
                }
            }
            VertexSource::Generated(Count::Fixed(count)) => draw.draw(0..count, 0..1),
            VertexSource::Generated(Count::Indirect(counts)) => {
                if let Slot::Buffer(counts) = &slots[counts.index()] {
                    draw.draw_indirect(counts, 0);
                }
            }
        }
        Ok(())
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

/// The bindings of both entry points of a raster pass, each once.
fn raster_bindings(pass: &Pass, raster: &Raster) -> Result<Vec<softshadow_shaders::Binding>, EngineError> {
    let module = softshadow_shaders::module(raster.kernel.file)
        .map_err(|error| softshadow_plan::PlanError::Shader { pass: pass.label.clone(), error })?;
    let mut bindings = module.entry_points[raster.kernel.vertex].bindings.clone();
    for entry in raster.kernel.fragment.iter().map(|name| &module.entry_points[*name]) {
        for binding in &entry.bindings {
            if !bindings.iter().any(|known| known.name == binding.name) {
                bindings.push(binding.clone());
            }
        }
    }
    Ok(bindings)
}

fn bind_group(
    device: &wgpu::Device,
    plan: &Plan,
    pass: &Pass,
    slots: &[Slot],
    layout: &wgpu::BindGroupLayout,
    bindings: &[softshadow_shaders::Binding],
    slice: Option<(&wgpu::Buffer, usize)>,
) -> wgpu::BindGroup {
    let texture_view = |texture: &wgpu::Texture, array: bool| {
        let dimension = if array { wgpu::TextureViewDimension::D2Array } else { wgpu::TextureViewDimension::D2 };
        texture.create_view(&wgpu::TextureViewDescriptor { dimension: Some(dimension), ..Default::default() })
    };
    let bound = |name: &str| pass.bindings.iter().find(|(n, _)| *n == name).map(|(_, id)| &slots[id.index()]);
    // Views have to outlive the entries that refer to them.
    let views: Vec<Option<wgpu::TextureView>> = bindings
        .iter()
        .map(|binding| match (bound(&binding.name), binding.kind) {
            (Some(Slot::Texture(texture)), softshadow_shaders::BindingKind::Texture(shape)) => {
                Some(texture_view(texture, shape.array))
            }
            _ => None,
        })
        .collect();
    let mut entries = Vec::with_capacity(bindings.len());
    for (binding, view) in bindings.iter().zip(&views) {
        let resource = match (bound(&binding.name), slice, view) {
            (_, _, Some(view)) => wgpu::BindingResource::TextureView(view),
            (Some(Slot::Buffer(buffer)), _, _) => buffer.as_entire_binding(),
            (None, Some((buffer, index)), _) if binding.name == SLICE => {
                let size = std::num::NonZeroU64::new(8);
                wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer, offset: index as u64 * SLICE_STRIDE, size })
            }
            // `check` refuses a plan with a missing binding; leaving it out makes the driver say so too.
            _ => continue,
        };
        entries.push(wgpu::BindGroupEntry { binding: binding.binding, resource });
    }
    let label = format!("{}: {}", plan.name, pass.label);
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(&label), layout, entries: &entries })
}

/// Passes as dispatches, grouped into submissions of bounded work.
fn schedule<'a>(plan: &'a Plan, host: &Host, timing: Timing) -> Vec<Vec<Dispatch<'a>>> {
    let mut submissions: Vec<Vec<Dispatch<'a>>> = vec![Vec::new()];
    let mut work = 0u64;
    let mut slice = 0;
    for pass in &plan.passes {
        let Work::Compute { kernel, over: Over::Items { count, work_per_item } } = &pass.work else {
            submissions.last_mut().expect("never empty").push(Dispatch { pass, first: 0, count: 0, slice });
            slice += 1;
            continue;
        };
        let group = softshadow_shaders::module(kernel.file)
            .ok()
            .and_then(|m| m.entry_points.get(kernel.entry))
            .map_or(1, |e| e.workgroup_size[0]);
        let most = u64::from(host.limits.groups) * u64::from(group);
        let cost = u64::from((*work_per_item).max(1));
        let mut first = 0u64;
        while first < u64::from(*count) {
            let room = (WORK_PER_SUBMISSION.saturating_sub(work) / cost).max(u64::from(group));
            let part = (u64::from(*count) - first).min(most).min(room);
            let dispatch = Dispatch { pass, first: first as u32, count: part as u32, slice };
            submissions.last_mut().expect("never empty").push(dispatch);
            slice += 1;
            first += part;
            work += part * cost;
            if work >= WORK_PER_SUBMISSION && first < u64::from(*count) {
                submissions.push(Vec::new());
                work = 0;
            }
        }
    }
    if timing == Timing::EachPass {
        submissions = submissions.into_iter().flatten().map(|dispatch| vec![dispatch]).collect();
        if submissions.is_empty() {
            submissions.push(Vec::new());
        }
    }
    submissions
}

fn add_times(total: &mut Vec<PassTime>, times: Vec<PassTime>) {
    for time in times {
        match total.iter_mut().find(|t| t.label == time.label) {
            Some(known) => known.ms += time.ms,
            None => total.push(time),
        }
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
