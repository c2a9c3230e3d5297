//! What runs programs: the contract of every engine, and what a run reports.

use std::borrow::Cow;
use std::collections::BTreeMap;

use serde::Serialize;

use crate::engine_error::EngineError;
use crate::host::Host;
use crate::program::Program;
use crate::resource::{Content, ContentKey};

/// Receives each stage's outputs and returns whether to go on; it is also asked, with `None`, between the parts of a long stage.
pub type OnStage<'a> = &'a mut dyn FnMut(Option<StageReport<'_>>) -> bool;

/// Something that runs programs. Engines know no technique: they look kernels up by name and do what the passes say, in order.
pub trait Engine: Send + Sync {
    /// What the device is.
    fn adapter(&self) -> &AdapterInfo;

    /// What the device can do.
    fn host(&self) -> Host;

    /// Whether the device is gone; then a new engine has to be made.
    fn is_lost(&self) -> bool;

    /// Destroys the device as a failing driver would: every later run ends in [`EngineError::DeviceLost`].
    fn destroy(&self);

    /// Gives uploads back that will not be used again, such as the last frame of a scene that moves. A run that uses one all the same
    /// uploads it again.
    fn forget(&self, contents: &[ContentKey]);

    /// Runs a program.
    ///
    /// # Errors
    /// Any [`EngineError`]; the engine stays usable unless the device was lost.
    fn run(
        &self,
        program: &dyn Program,
        contents: &BTreeMap<ContentKey, Content>,
        timing: Timing,
        on_stage: OnStage<'_>,
    ) -> Result<RunReport, EngineError>;
}

/// What kind of device stands behind an adapter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum DeviceKind {
    /// A graphics processor.
    Gpu,
    /// A driver that runs on the CPU.
    Software,
    /// Threads of the CPU, without any driver.
    Native,
    /// wgpu's backend that validates and computes nothing.
    Noop,
}

/// What is known about an adapter.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct AdapterInfo {
    /// Position among the adapters of this machine.
    pub index: usize,
    /// The driver's name for it.
    pub name: String,
    /// Interface: `vulkan`, `gl`, `metal`, `dx12`, `native` or `noop`.
    pub backend: String,
    /// Kind of device.
    pub device_type: DeviceKind,
    /// Driver and its version.
    pub driver: String,
    /// Largest storage binding in bytes.
    pub storage_binding_bytes: u64,
    /// Largest width of a texture.
    pub texture_size: u32,
    /// Optional abilities that the library can use.
    pub features: Vec<&'static str>,
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

/// Time of one pass by the device's clock.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PassTime {
    /// The pass.
    pub label: String,
    /// Milliseconds.
    pub ms: f64,
}

/// What one stage produced.
#[derive(Debug, Clone, PartialEq)]
pub struct StageReport<'a> {
    /// Position of the stage in its program.
    pub index: usize,
    /// Contents of the plan's outputs, by label. An engine lends what lies in its own memory.
    pub outputs: BTreeMap<String, Cow<'a, [u8]>>,
}

impl StageReport<'_> {
    /// A report that outlives the engine's call.
    #[must_use]
    pub fn into_owned(self) -> StageReport<'static> {
        let own = |(label, bytes): (String, Cow<'_, [u8]>)| (label, Cow::Owned(bytes.into_owned()));
        StageReport { index: self.index, outputs: self.outputs.into_iter().map(own).collect() }
    }
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

impl RunReport {
    /// Adds the times of passes; parts of a split pass are added up.
    pub fn add_times(&mut self, times: Vec<PassTime>) {
        for time in times {
            match self.pass_ms.iter_mut().find(|t| t.label == time.label) {
                Some(known) => known.ms += time.ms,
                None => self.pass_ms.push(time),
            }
        }
    }
}
