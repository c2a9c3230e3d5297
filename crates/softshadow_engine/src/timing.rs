//! Time of each pass by the device's own clock, where it has one.

use softshadow_plan::PassTime;

pub(crate) struct Timestamps {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    readable: wgpu::Buffer,
    labels: Vec<String>,
}

impl Timestamps {
    /// A pair of timestamps a pass; `None` where the device has no clock.
    pub(crate) fn new(device: &wgpu::Device, passes: usize) -> Option<Self> {
        // A query set holds at most 4096.
        if !device.features().contains(wgpu::Features::TIMESTAMP_QUERY) || passes == 0 || passes > 2048 {
            return None;
        }
        let count = passes as u32 * 2;
        let size = u64::from(count) * 8;
        let buffer = |usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("timestamps"),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        Some(Self {
            queries: device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("timestamps"),
                ty: wgpu::QueryType::Timestamp,
                count,
            }),
            resolved: buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC),
            readable: buffer(wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ),
            labels: Vec::with_capacity(passes),
        })
    }

    /// The indices of the two timestamps of the next pass.
    pub(crate) fn next(&mut self, label: &str) -> (&wgpu::QuerySet, u32, u32) {
        let at = self.labels.len() as u32 * 2;
        self.labels.push(label.to_owned());
        (&self.queries, at, at + 1)
    }

    /// Copies the timestamps to where they can be read; returns that buffer.
    pub(crate) fn resolve(&self, encoder: &mut wgpu::CommandEncoder) -> Option<&wgpu::Buffer> {
        let count = self.labels.len() as u32 * 2;
        if count == 0 {
            return None;
        }
        encoder.resolve_query_set(&self.queries, 0..count, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.readable, 0, u64::from(count) * 8);
        Some(&self.readable)
    }

    /// Milliseconds by pass label; parts of a split pass are added up.
    pub(crate) fn read(&self, bytes: &[u8], nanoseconds_per_tick: f32) -> Vec<PassTime> {
        let ticks: Vec<u64> = bytes.chunks_exact(8).map(bytemuck::pod_read_unaligned).collect();
        let mut times: Vec<PassTime> = Vec::new();
        for (label, pair) in self.labels.iter().zip(ticks.chunks_exact(2)) {
            let ms = pair[1].saturating_sub(pair[0]) as f64 * f64::from(nanoseconds_per_tick) * 1e-6;
            match times.iter_mut().find(|t| t.label == *label) {
                Some(time) => time.ms += ms,
                None => times.push(PassTime { label: label.clone(), ms }),
            }
        }
        times
    }
}
