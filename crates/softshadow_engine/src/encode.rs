//! One pass as commands: pipeline, bindings by name, targets, and how many invocations.

use std::collections::BTreeMap;

use softshadow_plan::{
    Count, Delivery, Dispatch, Over, Pass, Plan, Raster, ResourceId, SLICE, VertexSource, Work, bindings,
};

use crate::pipelines::Pipelines;
use crate::pool::Slot;
use crate::timing::Timestamps;
use softshadow_plan::EngineError;

/// Distance of two slices in their buffer; at least the uniform offset alignment of every device.
pub(crate) const SLICE_STRIDE: u64 = 256;

/// What the passes of one plan refer to while they are encoded.
pub(crate) struct Encoding<'a> {
    pub(crate) device: &'a wgpu::Device,
    pub(crate) pipelines: &'a mut Pipelines,
    pub(crate) plan: &'a Plan,
    /// Buffers and textures by resource.
    pub(crate) slots: &'a [Slot],
    /// The parts of the items, one a dispatch.
    pub(crate) slices: &'a wgpu::Buffer,
}

impl Encoding<'_> {
    /// Encodes one dispatch, with its pass around it.
    pub(crate) fn dispatch(
        &mut self,
        dispatch: &Dispatch,
        encoder: &mut wgpu::CommandEncoder,
        timestamps: &mut Option<Timestamps>,
    ) -> Result<(), EngineError> {
        let (device, plan, slots, slices) = (self.device, self.plan, self.slots, self.slices);
        let pass = &plan.passes[dispatch.pass];
        let buffer = |id| buffer_of(plan, slots, id);
        match &pass.work {
            Work::Clear { target } => encoder.clear_buffer(buffer(*target)?, 0, None),
            Work::Copy { source, target, bytes } => {
                encoder.copy_buffer_to_buffer(buffer(*source)?, 0, buffer(*target)?, 0, *bytes);
            }
            Work::Compute { kernel, over } => {
                let pipeline = self.pipelines.compute(device, *kernel)?;
                let group = bind_group(
                    device,
                    plan,
                    pass,
                    slots,
                    &pipeline.get_bind_group_layout(0),
                    &bindings(pass)?,
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
                        compute.dispatch_workgroups(dispatch.groups, 1, 1);
                    }
                    Over::Indirect(counts) => compute.dispatch_workgroups_indirect(buffer(*counts)?, 0),
                }
            }
            Work::Raster(raster) => self.raster(pass, raster, encoder, timestamps)?,
        }
        Ok(())
    }

    fn raster(
        &mut self,
        pass: &Pass,
        raster: &Raster,
        encoder: &mut wgpu::CommandEncoder,
        timestamps: &mut Option<Timestamps>,
    ) -> Result<(), EngineError> {
        let (device, plan, slots) = (self.device, self.plan, self.slots);
        let corners = matches!(raster.vertices, VertexSource::Corners { .. });
        let pipeline = self.pipelines.raster(device, plan, raster, corners)?;
        let bindings = bindings(pass)?;
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
}

/// The buffer of a resource.
fn buffer_of<'a>(plan: &Plan, slots: &'a [Slot], id: ResourceId) -> Result<&'a wgpu::Buffer, EngineError> {
    match &slots[id.index()] {
        Slot::Buffer(buffer) => Ok(buffer),
        Slot::Texture(_) => {
            let label = &plan.resources[id.index()].label;
            Err(EngineError::contents(&plan.name, label, "is a texture where a buffer is needed"))
        }
    }
}

/// Copies a part of an output to the result that it belongs to.
pub(crate) fn deliver(
    plan: &Plan,
    slots: &[Slot],
    delivery: &Delivery,
    results: &BTreeMap<&str, wgpu::Buffer>,
    encoder: &mut wgpu::CommandEncoder,
) -> Result<(), EngineError> {
    let source = buffer_of(plan, slots, delivery.output)?;
    let wrong = |problem: String| EngineError::contents(&plan.name, delivery.result, problem);
    let target = results.get(delivery.result).ok_or_else(|| wrong("no buffer for this result was given".into()))?;
    let needed = delivery.target + delivery.bytes;
    if target.size() < needed {
        return Err(wrong(format!("its buffer has {} bytes, at least {needed} are needed", target.size())));
    }
    if !target.usage().contains(wgpu::BufferUsages::COPY_DST) {
        return Err(wrong("its buffer has no usage COPY_DST".into()));
    }
    encoder.copy_buffer_to_buffer(source, delivery.source, target, delivery.target, delivery.bytes);
    Ok(())
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
