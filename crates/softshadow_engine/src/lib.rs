//! Runs plans on wgpu: adapters, pipelines, resources, uploads, readback, timing
