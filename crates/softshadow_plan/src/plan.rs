//! The plan itself and the calls that write it.

use serde::Serialize;

use crate::pass::{Kernel, Over, Pass, Raster, Work};
use crate::resource::{Content, ContentKey, Origin, Resource, ResourceId, Shape, TextureFormat};

/// The name of the binding by which the engine tells a kernel its part of the items: `struct Slice { first, count }`.
pub const SLICE: &str = "slice";

/// Resources and passes, in the order in which they run. Equal requests make equal plans.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Plan {
    /// What the plan computes.
    pub name: String,
    /// Everything the passes read and write.
    pub resources: Vec<Resource>,
    /// The steps.
    pub passes: Vec<Pass>,
    /// Buffers whose contents the caller receives.
    pub outputs: Vec<ResourceId>,
    /// A small buffer of u32 by which the program chooses its next stage.
    pub decision: Option<ResourceId>,
}

impl Plan {
    /// An empty plan.
    #[must_use]
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), ..Self::default() }
    }

    /// Adds a resource.
    pub fn resource(&mut self, label: impl Into<String>, shape: Shape, origin: Origin) -> ResourceId {
        self.resources.push(Resource { label: label.into(), shape, origin });
        ResourceId(self.resources.len() as u32 - 1)
    }

    /// Adds a buffer that lives within one run.
    pub fn buffer(&mut self, label: impl Into<String>, bytes: u64) -> ResourceId {
        self.resource(label, Shape::Buffer { bytes }, Origin::Transient)
    }

    /// Adds a buffer that lives as long as the program.
    pub fn persistent(&mut self, label: impl Into<String>, bytes: u64) -> ResourceId {
        self.resource(label, Shape::Buffer { bytes }, Origin::Persistent)
    }

    /// Adds a small buffer whose value is given at each run.
    pub fn parameter(&mut self, label: impl Into<String>, bytes: u64) -> ResourceId {
        self.resource(label, Shape::Buffer { bytes }, Origin::Parameter)
    }

    /// Adds a buffer whose contents are uploaded once.
    pub fn uploaded(&mut self, label: impl Into<String>, content: &Content) -> ResourceId {
        self.resource(label, Shape::Buffer { bytes: content.bytes.len() as u64 }, Origin::Uploaded(content.key))
    }

    /// Adds a texture with one layer.
    pub fn texture(
        &mut self,
        label: impl Into<String>,
        format: TextureFormat,
        size: [u32; 2],
        origin: Origin,
    ) -> ResourceId {
        self.resource(label, Shape::Texture { format, size, layers: 1 }, origin)
    }

    /// The resource with this label.
    #[must_use]
    pub fn find(&self, label: &str) -> Option<ResourceId> {
        self.resources.iter().position(|r| r.label == label).map(|index| ResourceId(index as u32))
    }

    /// Adds a compute pass over items and returns it, for `.bind`.
    pub fn compute(
        &mut self,
        label: impl Into<String>,
        why: impl Into<String>,
        kernel: Kernel,
        over: Over,
    ) -> &mut Pass {
        self.push(label, why, Work::Compute { kernel, over })
    }

    /// Adds a raster pass and returns it, for `.bind`.
    pub fn raster(&mut self, label: impl Into<String>, why: impl Into<String>, raster: Raster) -> &mut Pass {
        self.push(label, why, Work::Raster(raster))
    }

    /// Adds a pass that fills a buffer with zeros.
    pub fn clear(&mut self, label: impl Into<String>, why: impl Into<String>, target: ResourceId) {
        self.push(label, why, Work::Clear { target });
    }

    /// Adds a pass that copies the first bytes of a buffer.
    pub fn copy(
        &mut self,
        label: impl Into<String>,
        why: impl Into<String>,
        [source, target]: [ResourceId; 2],
        bytes: u64,
    ) {
        self.push(label, why, Work::Copy { source, target, bytes });
    }

    /// Exact bytes by resource, in the plan's order.
    #[must_use]
    pub fn memory(&self) -> Vec<(&str, u64)> {
        self.resources.iter().map(|r| (r.label.as_str(), r.bytes())).collect()
    }

    /// Keys of the contents that have to be uploaded.
    pub fn content_keys(&self) -> impl Iterator<Item = ContentKey> + '_ {
        self.resources.iter().filter_map(|r| match r.origin {
            Origin::Uploaded(key) => Some(key),
            _ => None,
        })
    }

    fn push(&mut self, label: impl Into<String>, why: impl Into<String>, work: Work) -> &mut Pass {
        let at = self.passes.len();
        self.passes.push(Pass { label: label.into(), why: why.into(), work, bindings: Vec::new() });
        &mut self.passes[at]
    }
}

impl Pass {
    /// Binds a resource by the WGSL name of the kernel's variable.
    pub fn bind(&mut self, name: &'static str, resource: ResourceId) -> &mut Self {
        self.bindings.push((name, resource));
        self
    }
}
