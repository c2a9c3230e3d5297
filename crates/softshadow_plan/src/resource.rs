//! Resources of a plan: what they are, how large, and where their contents come from.

use std::hash::Hasher as _;
use std::sync::Arc;

use serde::Serialize;

/// A resource of one plan: its index.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct ResourceId(pub(crate) u32);

impl ResourceId {
    /// Position in [`crate::Plan::resources`].
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A buffer or texture.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Resource {
    /// Unique name, used in timings, memory rows, errors and GPU labels.
    pub label: String,
    /// Kind and size.
    pub shape: Shape,
    /// Where its contents come from.
    pub origin: Origin,
}

/// Kind and size of a resource.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// Bytes without structure.
    Buffer {
        /// Size.
        bytes: u64,
    },
    /// A two-dimensional texture or an array of them, without mips.
    Texture {
        /// Texel format.
        format: TextureFormat,
        /// Width and height in texels.
        size: [u32; 2],
        /// Layers, at least 1.
        layers: u32,
    },
}

impl Shape {
    /// Bytes of one texel; 0 of a buffer.
    #[must_use]
    pub fn texel_bytes(self) -> u64 {
        match self {
            Self::Buffer { .. } => 0,
            Self::Texture { format, .. } => format.texel_bytes(),
        }
    }
}

/// Texel formats that plans use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum TextureFormat {
    /// One 32-bit unsigned integer.
    R32Uint,
    /// One float32.
    R32Float,
    /// Four float32.
    Rgba32Float,
    /// Depth in float32.
    Depth32Float,
}

impl TextureFormat {
    /// Bytes of one texel.
    #[must_use]
    pub fn texel_bytes(self) -> u64 {
        match self {
            Self::R32Uint | Self::R32Float | Self::Depth32Float => 4,
            Self::Rgba32Float => 16,
        }
    }
}

/// Where the contents of a resource come from, and how long they live.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Origin {
    /// Made and used within one run of the plan; undefined until a pass writes it.
    Transient,
    /// Uploaded, and kept on the device until its key is no longer used.
    Uploaded(ContentKey),
    /// Kept under its label from stage to stage of one program; undefined until a stage writes it.
    Persistent,
    /// A small value that changes from run to run without changing the plan.
    Parameter,
    /// A texture or buffer that the caller owns.
    External,
}

/// Names the bytes of an uploaded resource: equal bytes have equal keys.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct ContentKey(pub u64);

/// Bytes to upload, and their key.
#[derive(Debug, Clone)]
pub struct Content {
    /// The key, made from the bytes.
    pub key: ContentKey,
    /// The bytes; a multiple of four.
    pub bytes: Arc<[u8]>,
}

impl Content {
    /// Copies bytes, padded with zeros to a multiple of four, and makes their key.
    #[must_use]
    pub fn new(bytes: &[u8]) -> Self {
        let mut padded = bytes.to_vec();
        padded.resize(bytes.len().next_multiple_of(4), 0);
        let mut hasher = std::hash::DefaultHasher::new();
        hasher.write(bytes);
        Self { key: ContentKey(hasher.finish()), bytes: padded.into() }
    }
}

impl Resource {
    /// Exact size in bytes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        match self.shape {
            Shape::Buffer { bytes } => bytes,
            Shape::Texture { format, size, layers } => {
                u64::from(size[0]) * u64::from(size[1]) * u64::from(layers) * format.texel_bytes()
            }
        }
    }
}
