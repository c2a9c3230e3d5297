//! How visibility is computed, as a value: resources and passes in the order in which they run. No device is needed to make,
//! check, print, compare or weigh a plan.

mod check;
mod engine;
mod engine_error;
mod explain;
mod export;
mod host;
mod pass;
mod plan;
mod program;
mod resource;
mod schedule;
mod work;

pub use check::{PlanError, bindings, check};
pub use engine::{AdapterInfo, DeviceKind, Engine, OnStage, PassTime, RunReport, StageReport, Timing};
pub use engine_error::EngineError;
pub use export::{Exported, ExportedBinding, shader_text};
pub use host::{Features, Host, Limits};
pub use pass::{
    Blend, ColorTarget, Compare, Count, DepthTarget, Kernel, Over, Pass, Raster, RasterKernel, VertexSource, Work,
};
pub use plan::{Plan, SLICE};
pub use program::{Delivery, DeviceProgram, Program, Stage, Step, Values};
pub use resource::{Content, ContentKey, Origin, Resource, ResourceId, Shape, TextureFormat};
pub use schedule::{Dispatch, schedule};
pub use work::PassWork;
