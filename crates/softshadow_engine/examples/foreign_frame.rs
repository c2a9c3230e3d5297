//! Soft shadows inside a frame of somebody else's renderer, on its device: the renderer clears its target, softshadow leaves visibility in
//! one of the renderer's buffers, and the renderer's own shader reads it. Nothing passes through the processor but the finished picture.
//!
//! `cargo run --release --package softshadow_engine --example foreign_frame -- frame.png`
#![expect(clippy::print_stdout, reason = "a program for people")]

use std::collections::BTreeMap;
use std::error::Error;

use softshadow::{
    Camera, DepthComplexity, ForeignDevice, Light, LightShape, Options, Receivers, Scene, Technique, Timing, look_at,
    procedural,
};
use softshadow_engine::WgpuEngine;
use softshadow_plan::{Engine as _, StageReport};

const SIZE: [u32; 2] = [320, 180];

/// Draws one triangle over the whole target; the shadow tints it.
const SHADER: &str = "
@group(0) @binding(0) var<storage, read> visibility: array<f32>;
@vertex fn cover(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}
@fragment fn tint(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let seen = visibility[u32(at.y) * 320u + u32(at.x)];
    return vec4<f32>(seen, 0.25 + 0.75 * seen, 0.5 + 0.5 * seen, 1.0);
}";

/// A renderer that knows nothing of shadows.
struct Renderer {
    device: wgpu::Device,
    queue: wgpu::Queue,
    target: wgpu::Texture,
}

impl Renderer {
    fn new() -> Option<Self> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let found = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
        let (device, queue) =
            pollster::block_on(found.first()?.request_device(&wgpu::DeviceDescriptor::default())).ok()?;
        let target = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("frame"),
            size: wgpu::Extent3d { width: SIZE[0], height: SIZE[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        Some(Self { device, queue, target })
    }

    /// A buffer for the visibility of every pixel.
    fn buffer(&self, size: u64) -> wgpu::Buffer {
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST;
        let label = Some("visibility of the frame");
        self.device.create_buffer(&wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false })
    }

    /// Draws the frame; what softshadow has submitted before stands in `visibility` by then.
    fn draw(&self, visibility: &wgpu::Buffer) {
        let source = wgpu::ShaderSource::Wgsl(SHADER.into());
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
        let pipeline = self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("tint"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("cover"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("tint"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(wgpu::TextureFormat::Rgba8Unorm.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: visibility.as_entire_binding() }],
        });
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let view = self.target.create_view(&wgpu::TextureViewDescriptor::default());
        let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store };
        let target = wgpu::RenderPassColorAttachment { view: &view, depth_slice: None, resolve_target: None, ops };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(target)],
            ..Default::default()
        });
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
        drop(pass);
        self.queue.submit([encoder.finish()]);
    }

    /// The finished frame: red, green, blue, alpha.
    fn read(&self) -> Result<Vec<[u8; 4]>, Box<dyn Error>> {
        let size = u64::from(SIZE[0] * SIZE[1] * 4);
        let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ;
        let label = Some("picture");
        let readable =
            self.device.create_buffer(&wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false });
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let rows = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(SIZE[0] * 4), rows_per_image: None };
        encoder.copy_texture_to_buffer(
            self.target.as_image_copy(),
            wgpu::TexelCopyBufferInfo { buffer: &readable, layout: rows },
            self.target.size(),
        );
        self.queue.submit([encoder.finish()]);
        readable.map_async(wgpu::MapMode::Read, .., |_| {});
        self.device.poll(wgpu::PollType::wait_indefinitely())?;
        Ok(readable.get_mapped_range(..)?.as_chunks().0.to_vec())
    }
}

/// The frame of a shipped scene under its lamp.
fn frame(renderer: &Renderer) -> Result<Vec<[u8; 4]>, Box<dyn Error>> {
    let (scene, light, camera) = hall()?;
    // Both are kept from frame to frame: pipelines, and the scene as the device reads it.
    let engine = WgpuEngine::on_device(&renderer.device, &renderer.queue);
    let foreign = ForeignDevice::new(engine.adapter().clone(), engine.host());

    let technique = Technique::DepthComplexity(DepthComplexity::default());
    let receivers = Receivers::Camera(camera);
    let options = Options { standard_error: false, ..Options::default() };
    let call = foreign.visibility(&scene, &[light], receivers, &technique, &options)?;
    let results: BTreeMap<_, _> =
        call.results().into_iter().map(|(name, bytes)| (name, renderer.buffer(bytes))).collect();
    engine.forget(call.superseded());
    let mut stages = Vec::new();
    let report = engine.run_on_device(&call, &call.uploads(), &results, Timing::Device, &mut |stage| {
        stages.extend(stage.map(StageReport::into_owned));
        true
    })?;
    call.finish(&stages, report)?;

    renderer.draw(&results["visibility"]);
    renderer.read()
}

fn hall() -> Result<(Scene, Light, Camera), Box<dyn Error>> {
    let source = procedural::shipped("hall")?;
    let (view, lamp) = (source.camera(), source.light());
    let pose = look_at(lamp.position, lamp.target, Some(lamp.up))?;
    let light = Light::new(LightShape::Rectangle { width: 1.5, height: 1.0 }, pose)?;
    Ok((source.build()?, light, Camera::look_at(view.eye, view.target, Some(view.up), view.fov_y_deg, SIZE)?))
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "frame.png".into());
    let renderer = Renderer::new().ok_or("no adapter but GL: a Vulkan, Metal or Direct3D driver is needed")?;
    let colors: Vec<u8> = frame(&renderer)?.iter().flat_map(|c| [c[0], c[1], c[2]]).collect();
    std::fs::write(&path, softshadow::image_file::png_srgb8_bytes(&colors, SIZE)?)?;
    println!("picture {path}");
    Ok(())
}

#[cfg(test)]
mod tests {
    use softshadow::{Context, DeviceChoice, visibility};

    use super::*;

    #[test]
    fn the_frame_shows_what_an_ordinary_call_computes() {
        let Some(renderer) = Renderer::new() else {
            assert!(std::env::var("SOFTSHADOW_EXPECT_ADAPTER").is_err(), "an adapter is expected, but there is none");
            println!("skipped 1 test: the_frame_shows_what_an_ordinary_call_computes needs an adapter");
            return;
        };
        let frame = frame(&renderer).unwrap();
        let (scene, light, camera) = hall().unwrap();
        let context = Context::new(&DeviceChoice::Index(0)).unwrap();
        let technique = Technique::DepthComplexity(DepthComplexity::default());
        let receivers = Receivers::Camera(camera);
        let options = Options::default();
        let ordinary =
            visibility(&context, &scene, &[light], &receivers, &technique, &options, &mut |_, _| true).unwrap();
        let shown = |at: usize, value: f32| (f32::from(frame[at][0]) - 255.0 * value).abs() <= 0.51;
        let (mut same, mut moved) = (0, 0);
        for (at, value) in ordinary.values.iter().enumerate().filter(|(at, _)| ordinary.valid[*at]) {
            same += usize::from(shown(at, *value));
            moved += usize::from(shown((at + SIZE[0] as usize) % ordinary.values.len(), *value));
        }
        let valid = ordinary.info.valid_receivers.unwrap();
        assert_eq!(same, valid, "every pixel that sees anything");
        assert!(valid > 40_000 && moved * 100 < valid * 99, "a frame that is a row off is seen: {moved} of {valid}");
    }
}
