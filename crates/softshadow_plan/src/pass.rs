//! Passes of a plan: what runs, over how many items, and what it reads and writes.

use std::fmt;

use serde::Serialize;

use crate::resource::ResourceId;

/// A compute kernel: an entry point of a file in `shaders_wgsl/`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
pub struct Kernel {
    /// Path of the file.
    pub file: &'static str,
    /// Name of the entry point.
    pub entry: &'static str,
}

/// A pair of vertex and fragment entry points of one file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
pub struct RasterKernel {
    /// Path of the file.
    pub file: &'static str,
    /// Name of the vertex entry point.
    pub vertex: &'static str,
    /// Name of the fragment entry point; `None` writes depth only.
    pub fragment: Option<&'static str>,
}

impl fmt::Display for Kernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.file, self.entry)
    }
}

impl fmt::Display for RasterKernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}+{}", self.file, self.vertex, self.fragment.unwrap_or("depth"))
    }
}

/// One step of a plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Pass {
    /// Unique name.
    pub label: String,
    /// Why the plan has it, in one sentence.
    pub why: String,
    /// What it does.
    pub work: Work,
    /// Resources by the WGSL names of the kernel's bindings.
    pub bindings: Vec<(&'static str, ResourceId)>,
}

/// What a pass does.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Work {
    /// Runs a compute kernel.
    Compute {
        /// The kernel.
        kernel: Kernel,
        /// Over what.
        over: Over,
    },
    /// Draws triangles.
    Raster(Raster),
    /// Fills a buffer with zeros.
    Clear {
        /// The buffer.
        target: ResourceId,
    },
    /// Copies the first bytes of one buffer to another.
    Copy {
        /// Where the bytes come from.
        source: ResourceId,
        /// Where they go.
        target: ResourceId,
        /// How many.
        bytes: u64,
    },
}

/// How many invocations a compute pass has.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Over {
    /// One invocation an item. The engine may split the range, and tells the kernel by its binding `slice`.
    Items {
        /// How many items.
        count: u32,
        /// Roughly how many rays or similar steps an item costs; long passes are split by it.
        work_per_item: u32,
    },
    /// A count of groups that an earlier pass wrote (`x, y, z` at the start of a buffer).
    Indirect(ResourceId),
}

/// A raster pass.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Raster {
    /// Shaders.
    pub kernel: RasterKernel,
    /// Where vertices come from.
    pub vertices: VertexSource,
    /// Colour targets, in the order of `@location`.
    pub colors: Vec<ColorTarget>,
    /// Depth target.
    pub depth: Option<DepthTarget>,
}

/// Where the vertices of a raster pass come from. Triangles are never culled: every occluder is two-sided.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum VertexSource {
    /// Corners of 16 bytes: a position at `@location(0)`, a triangle index at `@location(1)`.
    Corners {
        /// The buffer.
        buffer: ResourceId,
        /// How many corners.
        count: u32,
    },
    /// The vertex shader makes them from its index.
    Generated(Count),
}

/// A number of vertices.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Count {
    /// Known when the plan is made.
    Fixed(u32),
    /// Written by an earlier pass (`vertices, instances, first vertex, first instance` at the start of a buffer).
    Indirect(ResourceId),
}

/// A colour target of a raster pass.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ColorTarget {
    /// The texture.
    pub texture: ResourceId,
    /// The layer drawn to.
    pub layer: u32,
    /// Cleared to this value first; `None` keeps the contents.
    pub clear: Option<f64>,
    /// How a fragment joins what is there.
    pub blend: Blend,
}

/// How a fragment's colour joins the target's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Blend {
    /// Replaces it.
    Replace,
    /// Adds to it.
    Add,
    /// Keeps the smaller.
    Min,
    /// Keeps the larger.
    Max,
}

/// The depth target of a raster pass.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DepthTarget {
    /// The texture.
    pub texture: ResourceId,
    /// The layer drawn to.
    pub layer: u32,
    /// Cleared to this value first; `None` keeps the contents.
    pub clear: Option<f32>,
    /// Which fragments pass; they write their depth.
    pub compare: Compare,
}

/// A depth comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Compare {
    /// The nearer of a depth that grows with distance.
    Less,
    /// The nearer of a reversed depth.
    Greater,
}
