// Which receivers need all samples: those whose probes disagree, among themselves or with a neighbour's.
//#import shared/slice.wgsl
//#import shared/receiver.wgsl
//#import shared/samples.wgsl

struct ProbeImage {
    width: u32,    // of the rows in this block; 0 where receivers have no neighbours
    height: u32,
}

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> sampling: Sampling;
@group(0) @binding(2) var<uniform> probe_image: ProbeImage;
@group(0) @binding(3) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(4) var<storage, read> blocked: array<u32>;
@group(0) @binding(5) var<storage, read_write> decided: array<u32>;
@group(0) @binding(6) var<storage, read> sample_transmittance: array<f32>;

const LIT: u32 = 1u;
const DARK: u32 = 2u;

// LIT, DARK or both, from the probes of one receiver; nothing where there is no receiver.
fn probe_classes(index: u32) -> u32 {
    if (receivers[index].kind == RECEIVER_NONE) {
        return 0u;
    }
    var hidden = 0u;
    for (var word = 0u; 32u * word < sampling.probes; word++) {
        let bits = min(32u, sampling.probes - 32u * word);
        hidden += countOneBits(blocked[index * sampling.words + word] & (0xffffffffu >> (32u - bits)));
    }
    return select(0u, LIT, hidden < sampling.probes) | select(0u, DARK, hidden > 0u);
}

@compute @workgroup_size(64)
fn choose(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    if (decided[index] == 0u) {
        return;
    }
    var classes = probe_classes(index);
    if (probe_image.width > 0u) {
        let x = index % probe_image.width;
        let y = index / probe_image.width;
        for (var row = max(y, 1u) - 1u; row <= min(y + 1u, probe_image.height - 1u); row++) {
            for (var column = max(x, 1u) - 1u; column <= min(x + 1u, probe_image.width - 1u); column++) {
                classes |= probe_classes(row * probe_image.width + column);
            }
        }
    }
    if (classes == (LIT | DARK)) {
        decided[index] = sampling.count;
    }
}

// Least and most that passes to the probes of one receiver; no range where there is no receiver.
fn probe_range(index: u32) -> vec2<f32> {
    var range = vec2<f32>(1.0, 0.0);
    for (var probe = 0u; probe < select(sampling.probes, 0u, receivers[index].kind == RECEIVER_NONE); probe++) {
        let passes = sample_transmittance[index * sampling.count + probe];
        range = vec2<f32>(min(range.x, passes), max(range.y, passes));
    }
    return range;
}

// As `choose`, where probes may be neither lit nor dark: all have to see the same.
@compute @workgroup_size(64)
fn choose_attenuated(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    if (decided[index] == 0u) {
        return;
    }
    var range = probe_range(index);
    if (probe_image.width > 0u) {
        let x = index % probe_image.width;
        let y = index / probe_image.width;
        for (var row = max(y, 1u) - 1u; row <= min(y + 1u, probe_image.height - 1u); row++) {
            for (var column = max(x, 1u) - 1u; column <= min(x + 1u, probe_image.width - 1u); column++) {
                let other = probe_range(row * probe_image.width + column);
                range = vec2<f32>(min(range.x, other.x), max(range.y, other.y));
            }
        }
    }
    if (range.x != range.y) {
        decided[index] = sampling.count;
    }
}
