//! Finding an adapter by what it is, never by its name: two drivers of one machine may carry the same.

use std::sync::{Arc, Mutex};

use softshadow_plan::{AdapterInfo, DeviceKind, EngineError, Features, Host, Limits};

/// Which adapter to take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AdapterChoice {
    /// A GPU; behind GL only where nothing else answers at all: opening that is slow and noisy.
    ReadyGpu,
    /// A GPU, behind whatever interface.
    Gpu,
    /// A software driver.
    Software,
    /// The adapter with this position in [`adapters`].
    Index(usize),
    /// wgpu's backend without a driver, for tests.
    Noop,
}

/// An open device, with what went wrong on it.
pub(crate) struct Opened {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    pub(crate) info: AdapterInfo,
    pub(crate) host: Host,
    /// Set when the device is lost, with the driver's words.
    pub(crate) lost: Arc<Mutex<Option<String>>>,
    /// The first error that no scope caught.
    pub(crate) uncaught: Arc<Mutex<Option<String>>>,
}

/// Every adapter of this machine, Vulkan, Metal and Direct3D before GL.
#[must_use]
pub fn adapters() -> Vec<AdapterInfo> {
    let found = enumerate(ALL);
    let describe = |(index, a): (usize, &wgpu::Adapter)| describe(index, &a.get_info(), &a.limits(), a.features());
    found.iter().enumerate().map(describe).collect()
}

const ALL: wgpu::Backends = wgpu::Backends::PRIMARY.union(wgpu::Backends::GL);

fn enumerate(backends: wgpu::Backends) -> Vec<wgpu::Adapter> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = backends;
    if backends == wgpu::Backends::NOOP {
        // Core WebGPU's limits: what runs here runs on every host. Without them wgpu's own bookkeeping runs out of room.
        let limits = Some(wgpu::Limits::default());
        descriptor.backend_options.noop = wgpu::NoopBackendOptions { limits, ..wgpu::NoopBackendOptions::enabled() };
    }
    let instance = wgpu::Instance::new(descriptor);
    let mut found = pollster::block_on(instance.enumerate_adapters(backends));
    found.sort_by_key(|adapter| adapter.get_info().backend == wgpu::Backend::Gl);
    found
}

/// Adapters for a choice. GL is asked only where nothing else answers, for a GPU that must be, or by its index: opening it is
/// slow and noisy.
fn candidates(choice: AdapterChoice) -> Vec<wgpu::Adapter> {
    match choice {
        AdapterChoice::Noop => enumerate(wgpu::Backends::NOOP),
        AdapterChoice::Index(_) => enumerate(ALL),
        _ => {
            let found = enumerate(wgpu::Backends::PRIMARY);
            let has_gpu = found.iter().any(|a| kind(&a.get_info()) == DeviceKind::Gpu);
            let wants_gpu = choice == AdapterChoice::Gpu && !has_gpu;
            if found.is_empty() || wants_gpu { enumerate(ALL) } else { found }
        }
    }
}

pub(crate) fn open(choice: AdapterChoice) -> Result<Opened, EngineError> {
    let found = candidates(choice);
    let kinds: Vec<DeviceKind> = found.iter().map(|a| kind(&a.get_info())).collect();
    let first = |wanted| kinds.iter().position(|k| *k == wanted);
    let (index, wanted) = match choice {
        AdapterChoice::ReadyGpu | AdapterChoice::Gpu => (first(DeviceKind::Gpu), "GPU".into()),
        AdapterChoice::Software => (first(DeviceKind::Software), "software".into()),
        AdapterChoice::Index(index) => ((index < found.len()).then_some(index), format!("number {index}")),
        AdapterChoice::Noop => (first(DeviceKind::Noop), "noop".into()),
    };
    let Some(index) = index else { return Err(EngineError::NoAdapter { wanted }) };
    let adapter = &found[index];
    let info = describe(index, &adapter.get_info(), &adapter.limits(), adapter.features());
    let descriptor = wgpu::DeviceDescriptor {
        label: Some("softshadow"),
        required_features: adapter.features() & optional_features(),
        required_limits: adapter.limits(),
        ..Default::default()
    };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
        .map_err(|error| EngineError::NoDevice { adapter: info.name.clone(), reason: error.to_string() })?;
    let lost = Arc::new(Mutex::new(None));
    let uncaught = Arc::new(Mutex::new(None));
    let lost_slot = Arc::clone(&lost);
    device.set_device_lost_callback(move |reason, words| {
        if let Ok(mut slot) = lost_slot.lock() {
            slot.get_or_insert(format!("{reason:?}: {words}"));
        }
    });
    // wgpu's own handler panics.
    let uncaught_slot = Arc::clone(&uncaught);
    device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
        if let Ok(mut slot) = uncaught_slot.lock() {
            slot.get_or_insert(error.to_string());
        }
    }));
    let host = host(&device);
    Ok(Opened { device, queue, info, host, lost, uncaught })
}

/// A device that somebody else owns. Its callbacks are its owner's, so only what it answers says whether it is lost.
pub(crate) fn borrowed(device: &wgpu::Device, queue: &wgpu::Queue) -> Opened {
    Opened {
        info: describe(0, &device.adapter_info(), &device.limits(), device.features()),
        host: host(device),
        device: device.clone(),
        queue: queue.clone(),
        lost: Arc::default(),
        uncaught: Arc::default(),
    }
}

fn optional_features() -> wgpu::Features {
    wgpu::Features::TIMESTAMP_QUERY | wgpu::Features::FLOAT32_BLENDABLE
}

fn host(device: &wgpu::Device) -> Host {
    let (limits, features) = (device.limits(), device.features());
    let float32_blendable = features.contains(wgpu::Features::FLOAT32_BLENDABLE);
    // Core WebGPU promises it; wgpu's GL refuses such targets.
    let float32_drawable = device.adapter_info().backend != wgpu::Backend::Gl;
    Host {
        limits: Limits {
            storage_binding_bytes: limits.max_storage_buffer_binding_size,
            buffer_bytes: limits.max_buffer_size,
            texture_size: limits.max_texture_dimension_2d,
            texture_layers: limits.max_texture_array_layers,
            groups: limits.max_compute_workgroups_per_dimension,
            storage_buffers: limits.max_storage_buffers_per_shader_stage,
            color_targets: limits.max_color_attachments,
            color_bytes: limits.max_color_attachment_bytes_per_sample,
        },
        features: Features { raster: true, float32_blendable, float32_drawable },
    }
}

fn kind(info: &wgpu::AdapterInfo) -> DeviceKind {
    match (info.backend, info.device_type) {
        (wgpu::Backend::Noop, _) => DeviceKind::Noop,
        (_, wgpu::DeviceType::Cpu) => DeviceKind::Software,
        _ => DeviceKind::Gpu,
    }
}

fn describe(index: usize, info: &wgpu::AdapterInfo, limits: &wgpu::Limits, features: wgpu::Features) -> AdapterInfo {
    let named = [
        ("timestamp-query", wgpu::Features::TIMESTAMP_QUERY),
        ("float32-blendable", wgpu::Features::FLOAT32_BLENDABLE),
    ];
    AdapterInfo {
        index,
        name: info.name.clone(),
        backend: info.backend.to_str().to_owned(),
        device_type: kind(info),
        driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
        storage_binding_bytes: limits.max_storage_buffer_binding_size,
        texture_size: limits.max_texture_dimension_2d,
        features: named.iter().filter(|(_, f)| features.contains(*f)).map(|(name, _)| *name).collect(),
    }
}
