//! Pipelines by kernel, made at first use and kept. Layouts come from the shader itself.

use std::collections::HashMap;

use softshadow_plan::{Blend, Compare, DepthTarget, Kernel, Plan, Raster, RasterKernel, Shape, TextureFormat};

use softshadow_plan::EngineError;

/// What a raster pipeline depends on beside its shaders.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
struct RasterKey {
    kernel: RasterKernel,
    colors: Vec<(wgpu::TextureFormat, Option<wgpu::BlendState>)>,
    depth: Option<(wgpu::TextureFormat, wgpu::CompareFunction)>,
    corners: bool,
}

#[derive(Default)]
pub(crate) struct Pipelines {
    modules: HashMap<&'static str, wgpu::ShaderModule>,
    compute: HashMap<Kernel, wgpu::ComputePipeline>,
    raster: HashMap<RasterKey, wgpu::RenderPipeline>,
}

pub(crate) fn texture_format(format: TextureFormat) -> wgpu::TextureFormat {
    match format {
        TextureFormat::R32Uint => wgpu::TextureFormat::R32Uint,
        TextureFormat::R32Float => wgpu::TextureFormat::R32Float,
        TextureFormat::Rgba32Float => wgpu::TextureFormat::Rgba32Float,
        TextureFormat::Depth32Float => wgpu::TextureFormat::Depth32Float,
    }
}

impl Pipelines {
    pub(crate) fn compute(
        &mut self,
        device: &wgpu::Device,
        kernel: Kernel,
    ) -> Result<wgpu::ComputePipeline, EngineError> {
        if let Some(known) = self.compute.get(&kernel) {
            return Ok(known.clone());
        }
        let module = self.module(device, kernel.file)?;
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(&kernel.to_string()),
            layout: None,
            module: &module,
            entry_point: Some(kernel.entry),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        self.compute.insert(kernel, pipeline.clone());
        Ok(pipeline)
    }

    pub(crate) fn raster(
        &mut self,
        device: &wgpu::Device,
        plan: &Plan,
        raster: &Raster,
        corners: bool,
    ) -> Result<wgpu::RenderPipeline, EngineError> {
        let format = |id: softshadow_plan::ResourceId| match plan.resources[id.index()].shape {
            Shape::Texture { format, .. } => texture_format(format),
            // `check` refuses a pass that draws to a buffer.
            Shape::Buffer { .. } => wgpu::TextureFormat::R32Float,
        };
        let key = RasterKey {
            kernel: raster.kernel,
            colors: raster.colors.iter().map(|c| (format(c.texture), blend_state(c.blend))).collect(),
            depth: raster.depth.as_ref().map(|d| (format(d.texture), compare(d))),
            corners,
        };
        if let Some(known) = self.raster.get(&key) {
            return Ok(known.clone());
        }
        let module = self.module(device, raster.kernel.file)?;
        let pipeline = create_raster(device, &module, &key);
        self.raster.insert(key, pipeline.clone());
        Ok(pipeline)
    }

    fn module(&mut self, device: &wgpu::Device, file: &'static str) -> Result<wgpu::ShaderModule, EngineError> {
        if let Some(known) = self.modules.get(file) {
            return Ok(known.clone());
        }
        let linked = softshadow_shaders::module(file)
            .map_err(|error| softshadow_plan::PlanError::Shader { pass: file.to_owned(), error })?;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(file),
            source: wgpu::ShaderSource::Wgsl(linked.linked.text.as_str().into()),
        });
        self.modules.insert(file, module.clone());
        Ok(module)
    }
}

fn create_raster(device: &wgpu::Device, module: &wgpu::ShaderModule, key: &RasterKey) -> wgpu::RenderPipeline {
    let targets: Vec<_> = key
        .colors
        .iter()
        .map(|(format, blend)| {
            Some(wgpu::ColorTargetState { format: *format, blend: *blend, write_mask: wgpu::ColorWrites::ALL })
        })
        .collect();
    let attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Uint32];
    let layout =
        wgpu::VertexBufferLayout { array_stride: 16, step_mode: wgpu::VertexStepMode::Vertex, attributes: &attributes };
    let buffers = [Some(layout)];
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(&key.kernel.to_string()),
        layout: None,
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(key.kernel.vertex),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: if key.corners { &buffers } else { &[] },
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: key.depth.map(|(format, compare)| wgpu::DepthStencilState {
            format,
            depth_write_enabled: Some(true),
            depth_compare: Some(compare),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: key.kernel.fragment.map(|entry| wgpu::FragmentState {
            module,
            entry_point: Some(entry),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn compare(depth: &DepthTarget) -> wgpu::CompareFunction {
    match depth.compare {
        Compare::Less => wgpu::CompareFunction::Less,
        Compare::Greater => wgpu::CompareFunction::Greater,
    }
}

fn blend_state(blend: Blend) -> Option<wgpu::BlendState> {
    let operation = match blend {
        Blend::Replace => return None,
        Blend::Add => wgpu::BlendOperation::Add,
        Blend::Min => wgpu::BlendOperation::Min,
        Blend::Max => wgpu::BlendOperation::Max,
    };
    let one = wgpu::BlendFactor::One;
    let component = wgpu::BlendComponent { src_factor: one, dst_factor: one, operation };
    Some(wgpu::BlendState { color: component, alpha: component })
}
