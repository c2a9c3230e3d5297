// Opens what passes to each sample: all of its light, or none where its bit is set.
//#import shared/slice.wgsl
//#import shared/samples.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> sampling: Sampling;
@group(0) @binding(2) var<storage, read> blocked: array<u32>;
@group(0) @binding(3) var<storage, read_write> sample_transmittance: array<f32>;

@compute @workgroup_size(64)
fn open_samples(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    for (var sample = 0u; sample < sampling.count; sample++) {
        let word = blocked[index * sampling.words + sample / 32u];
        sample_transmittance[index * sampling.count + sample] = select(1.0, 0.0, (word & (1u << (sample % 32u))) != 0u);
    }
}
