// Opens the masks of blocked samples: what lies below the receiver's horizon is blocked, and everything is from behind a
// one-sided light or where there is no receiver.
//#import shared/slice.wgsl
//#import shared/light.wgsl
//#import shared/samples.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> light: Light;
@group(0) @binding(2) var<uniform> sampling: Sampling;
@group(0) @binding(3) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(4) var<storage, read> light_samples: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read_write> blocked: array<u32>;
@group(0) @binding(6) var<storage, read_write> decided: array<u32>;

@compute @workgroup_size(64)
fn begin(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    let receiver = receivers[index];
    let view = light_view(light, receiver.position);
    let hidden = receiver.kind == RECEIVER_NONE || !view.exists;
    let open = view.inside && !hidden;
    // Most receivers have the whole light above their horizon: no sample has to be asked.
    let ways = light_way_bounds(light, view, receiver.position);
    let lowest = min(receiver.normal * ways.low, receiver.normal * ways.high);
    let magnitude = max(abs(ways.low), abs(ways.high));
    let all_above = dot(lowest, vec3<f32>(1.0)) > 4e-6 * dot(magnitude, vec3<f32>(1.0));
    let first = first_sample(sampling, index);
    for (var word = 0u; word < sampling.words; word++) {
        var mask = select(0u, 0xffffffffu, hidden);
        let here = min(32u, sampling.count - 32u * word);
        for (var bit = 0u; bit < select(here, 0u, hidden || open || all_above); bit++) {
            let way = light_way(light_sample(light, view, light_samples[first + 32u * word + bit], receiver.position), receiver.position);
            mask |= select(0u, 1u << bit, below_horizon(receiver, way));
        }
        blocked[index * sampling.words + word] = mask;
    }
    // A receiver without light needs no ray; inside a sphere light nothing lies between.
    decided[index] = select(sampling.probes, 0u, hidden || open);
}
