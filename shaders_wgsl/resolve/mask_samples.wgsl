// The mask of samples to which nothing passes.
//#import shared/slice.wgsl
//#import shared/samples.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> sampling: Sampling;
@group(0) @binding(2) var<storage, read> sample_transmittance: array<f32>;
@group(0) @binding(3) var<storage, read_write> blocked: array<u32>;

@compute @workgroup_size(64)
fn mask_samples(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    for (var word = 0u; word < sampling.words; word++) {
        var mask = 0u;
        for (var bit = 0u; bit < min(32u, sampling.count - 32u * word); bit++) {
            let passes = sample_transmittance[index * sampling.count + 32u * word + bit];
            mask |= select(0u, 1u << bit, passes <= 0.0);
        }
        blocked[index * sampling.words + word] = mask;
    }
}
