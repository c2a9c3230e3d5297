//! What a host can do, as data: plans are made and checked for it before any driver is asked.

/// A host's abilities.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Host {
    /// Largest sizes.
    pub limits: Limits,
    /// Optional abilities.
    pub features: Features,
}

/// Largest sizes that a host takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of one storage binding.
    pub storage_binding_bytes: u64,
    /// Bytes of one buffer.
    pub buffer_bytes: u64,
    /// Width and height of a texture.
    pub texture_size: u32,
    /// Layers of a texture.
    pub texture_layers: u32,
    /// Groups of one dispatch in one dimension.
    pub groups: u32,
    /// Storage buffers of one pass.
    pub storage_buffers: u32,
    /// Colour targets of one raster pass.
    pub color_targets: u32,
    /// Bytes of one pixel in all colour targets of one raster pass.
    pub color_bytes: u32,
}

/// Optional abilities of a host.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Features {
    /// Draws triangles at all.
    pub raster: bool,
    /// Blends float32 targets.
    pub float32_blendable: bool,
    /// Draws into colour targets of four float32.
    pub float32_drawable: bool,
}

impl Default for Host {
    /// The limits of core WebGPU, with raster and without options.
    fn default() -> Self {
        Self {
            limits: Limits {
                storage_binding_bytes: 128 << 20,
                buffer_bytes: 256 << 20,
                texture_size: 8192,
                texture_layers: 256,
                groups: 65_535,
                storage_buffers: 8,
                color_targets: 8,
                color_bytes: 32,
            },
            features: Features { raster: true, float32_blendable: false, float32_drawable: true },
        }
    }
}
