// Spreads what passes to the reference point over all samples, until a fold of edges says otherwise.
//#import shared/slice.wgsl
//#import depth_complexity/frame.wgsl
//#import depth_complexity/tiles.wgsl
//#import depth_complexity/attenuation.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> light_frame: LightFrame;
@group(0) @binding(2) var<uniform> attenuation_scale: AttenuationScale;
@group(0) @binding(3) var<storage, read> slots: array<Slot>;
@group(0) @binding(4) var<storage, read_write> sample_transmittance: array<f32>;

@compute @workgroup_size(64)
fn spread_reference(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let slot = slots[slice.first + invocation.x];
    // Without a view of the light nothing was counted.
    let counted = slot.depth != NO_VIEW && (slot.depth != 0 || slot.attenuation != 0);
    let passes = select(passed(attenuation_scale, slot.attenuation), 0.0, slot.depth != 0);
    let first = slot.receiver * light_frame.sample_count;
    for (var k = first; k < first + select(0u, light_frame.sample_count, counted); k++) {
        sample_transmittance[k] *= passes;
    }
}
