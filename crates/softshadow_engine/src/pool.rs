//! Buffers and textures, kept between runs and given back when they have not been used for a while.

use std::collections::{BTreeMap, HashMap};

use softshadow_plan::{Content, ContentKey, Origin, Resource, Shape};

use crate::pipelines::texture_format;
use softshadow_plan::EngineError;

/// Runs after which uploads that were not used are given back. Other buffers are given back after one: a caller's memory limit
/// holds for each call, and its buffers must not pile up.
const KEPT_RUNS: u64 = 8;

#[derive(Clone)]
pub(crate) enum Slot {
    Buffer(wgpu::Buffer),
    Texture(wgpu::Texture),
}

impl Slot {
    fn destroy(&self) {
        match self {
            Self::Buffer(buffer) => buffer.destroy(),
            Self::Texture(texture) => texture.destroy(),
        }
    }
}

#[derive(PartialEq, Eq, Hash)]
enum Key {
    Content(ContentKey),
    /// A label and a shape: within one plan labels are unique, and runs do not overlap. Parameters are apart, because they
    /// can be bound as uniforms.
    Named(String, [u64; 5]),
}

#[derive(Default)]
pub(crate) struct Pool {
    slots: HashMap<Key, (Slot, u64)>,
    run: u64,
}

impl Pool {
    /// Begins a run and gives back what has not been used for a while.
    pub(crate) fn begin_run(&mut self) {
        self.run += 1;
        let run = self.run;
        self.slots.retain(|key, (slot, used)| {
            let kept = *used + if matches!(key, Key::Content(_)) { KEPT_RUNS } else { 1 } >= run;
            if !kept {
                slot.destroy();
            }
            kept
        });
    }

    /// Gives uploads back that will not be used again.
    pub(crate) fn forget(&mut self, contents: &[ContentKey]) {
        for key in contents {
            if let Some((slot, _)) = self.slots.remove(&Key::Content(*key)) {
                slot.destroy();
            }
        }
    }

    /// Gives everything back.
    pub(crate) fn clear(&mut self) {
        self.slots.drain().for_each(|(_, (slot, _))| slot.destroy());
    }

    /// The buffer or texture of a resource; contents are uploaded when they are new.
    pub(crate) fn get(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        stage: &str,
        resource: &Resource,
        contents: &BTreeMap<ContentKey, Content>,
    ) -> Result<Slot, EngineError> {
        let key = match resource.origin {
            Origin::Uploaded(key) => Key::Content(key),
            Origin::External => {
                return Err(EngineError::contents(stage, &resource.label, "no external resource was given"));
            }
            _ => Key::Named(resource.label.clone(), shape_key(resource)),
        };
        if let Some((slot, used)) = self.slots.get_mut(&key) {
            *used = self.run;
            return Ok(slot.clone());
        }
        let slot = create(device, resource);
        if let (Key::Content(key), Slot::Buffer(buffer)) = (&key, &slot) {
            let content = contents
                .get(key)
                .filter(|content| content.bytes.len() as u64 == resource.bytes())
                .ok_or_else(|| EngineError::contents(stage, &resource.label, "its contents were not given"))?;
            queue.write_buffer(buffer, 0, &content.bytes);
        }
        self.slots.insert(key, (slot.clone(), self.run));
        Ok(slot)
    }
}

fn shape_key(resource: &Resource) -> [u64; 5] {
    match resource.shape {
        Shape::Buffer { bytes } => [0, bytes, 0, 0, u64::from(resource.origin == Origin::Parameter)],
        Shape::Texture { format, size, layers } => {
            [1 + format as u64, u64::from(size[0]), u64::from(size[1]), u64::from(layers), 0]
        }
    }
}

fn create(device: &wgpu::Device, resource: &Resource) -> Slot {
    match resource.shape {
        Shape::Buffer { bytes } => {
            use wgpu::BufferUsages as U;
            let usage = match resource.origin {
                Origin::Parameter => U::UNIFORM | U::STORAGE | U::COPY_DST,
                Origin::Uploaded(_) => U::STORAGE | U::VERTEX | U::COPY_DST,
                _ => U::STORAGE | U::VERTEX | U::INDIRECT | U::COPY_SRC | U::COPY_DST,
            };
            Slot::Buffer(device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(&resource.label),
                // Copies move whole words.
                size: bytes.next_multiple_of(4),
                usage,
                mapped_at_creation: false,
            }))
        }
        Shape::Texture { format, size, layers } => Slot::Texture(device.create_texture(&wgpu::TextureDescriptor {
            label: Some(&resource.label),
            size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: layers },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: texture_format(format),
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        })),
    }
}
