// Traces shadow rays through one sub-scene: any hit between a candidate's receiver and a sample sets the sample's bit, or takes its share
// of what passes.
//#import shared/light.wgsl
//#import shared/triangle.wgsl
//#import shared/samples.wgsl
//#import ray_traced/hierarchy.wgsl

@group(0) @binding(1) var<uniform> light: Light;
@group(0) @binding(2) var<uniform> sampling: Sampling;
@group(0) @binding(3) var<uniform> trace_range: TraceRange;
@group(0) @binding(4) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(5) var<storage, read> light_samples: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read> nodes: array<BvhNode>;
@group(0) @binding(7) var<storage, read> corners: array<Corner>;
@group(0) @binding(8) var<storage, read> decided: array<u32>;
@group(0) @binding(9) var<storage, read_write> candidates: CandidateList;
@group(0) @binding(10) var<storage, read_write> blocked: array<atomic<u32>>;
@group(0) @binding(11) var<storage, read> triangle_transmittance: array<f32>;
@group(0) @binding(12) var<storage, read_write> sample_transmittance: array<f32>;

fn is_blocked(receiver: Receiver, way: vec3<f32>, unbounded: bool, walk: vec2<u32>, pad: vec3<f32>) -> bool {
    let inverse = safe_reciprocal(way);
    // The box is widened by what rounding can cost, so that no box hides a triangle that the test below would meet.
    let to_low = (-receiver.position - pad) * inverse;
    let to_high = (-receiver.position + pad) * inverse;
    let end_of_way = select(1.0, 1e30, unbounded);
    let rising = inverse >= vec3<f32>(0.0);
    var node = walk.x;
    var hit = false;
    while (node <= walk.y && !hit) {
        var leaf = 0u;
        while (leaf == 0u && node <= walk.y) {
            let box = nodes[node];
            let near = select(box.high * inverse + to_high, box.low * inverse + to_low, rising);
            let far = select(box.low * inverse + to_low, box.high * inverse + to_high, rising);
            let enter = max(max(near.x, near.y), max(near.z, 0.0));
            let leave = min(min(far.x, far.y), min(far.z, end_of_way));
            let met = enter <= leave;
            leaf = select(0u, box.leaf, met);
            node = select(box.skip, node + 1u, met && box.leaf == 0u);
        }
        let first = leaf >> LEAF_BITS;
        let count = leaf & ((1u << LEAF_BITS) - 1u);
        for (var k = first; k < first + count && !hit; k++) {
            let a = corners[3u * k];
            let b = corners[3u * k + 1u].position;
            let c = corners[3u * k + 2u].position;
            let blocks = triangle_blocks(a.position, b, c, receiver.position, way, unbounded);
            hit = blocks && a.triangle != receiver.triangle;
        }
    }
    if (node <= walk.y && !hit) {
        atomicAdd(&candidates.unfinished, 1u);
    }
    return hit;
}

@compute @workgroup_size(64)  // GROUP
fn trace(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let chunks = chunks_of(trace_range);
    let candidate_count = atomicLoad(&candidates.count);
    let used = (candidate_count * chunks + GROUP - 1u) / GROUP;
    let position = scattered(group.y * groups.x + group.x, used) * GROUP + lane;
    if (position >= candidate_count * chunks) {
        return;
    }
    let candidate = candidates.items[position / chunks];
    let index = candidate.receiver;
    let first = trace_range.first_sample + position % chunks * SAMPLES_PER_INVOCATION;
    let end = min(min(first + SAMPLES_PER_INVOCATION, trace_range.end_sample), decided[index]);
    let receiver = receivers[index];
    let view = light_view(light, receiver.position);
    let pad = vec3<f32>(box_pad(receiver.position));
    let walk = vec2<u32>(candidate.first_node, candidate.last_node);
    let unbounded = light.kind == LIGHT_SUN;
    let own = first_sample(sampling, index);
    for (var sample = first; sample < end; sample++) {
        let word = index * sampling.words + sample / 32u;
        let bit = 1u << (sample % 32u);
        if ((atomicLoad(&blocked[word]) & bit) == 0u) {
            let way = light_way(light_sample(light, view, light_samples[own + sample], receiver.position), receiver.position);
            if (is_blocked(receiver, way, unbounded, walk, pad)) {
                atomicOr(&blocked[word], bit);
            }
        }
    }
}

// What passes all triangles on the way: as `is_blocked`, but only an opaque one ends it.
fn passed_share(receiver: Receiver, way: vec3<f32>, unbounded: bool, walk: vec2<u32>, pad: vec3<f32>) -> f32 {
    let inverse = safe_reciprocal(way);
    let to_low = (-receiver.position - pad) * inverse;
    let to_high = (-receiver.position + pad) * inverse;
    let end_of_way = select(1.0, 1e30, unbounded);
    let rising = inverse >= vec3<f32>(0.0);
    var node = walk.x;
    var share = 1.0;
    while (node <= walk.y && share > 0.0) {
        var leaf = 0u;
        while (leaf == 0u && node <= walk.y) {
            let box = nodes[node];
            let near = select(box.high * inverse + to_high, box.low * inverse + to_low, rising);
            let far = select(box.low * inverse + to_low, box.high * inverse + to_high, rising);
            let enter = max(max(near.x, near.y), max(near.z, 0.0));
            let leave = min(min(far.x, far.y), min(far.z, end_of_way));
            let met = enter <= leave;
            leaf = select(0u, box.leaf, met);
            node = select(box.skip, node + 1u, met && box.leaf == 0u);
        }
        let first = leaf >> LEAF_BITS;
        let count = leaf & ((1u << LEAF_BITS) - 1u);
        for (var k = first; k < first + count; k++) {
            let a = corners[3u * k];
            let b = corners[3u * k + 1u].position;
            let c = corners[3u * k + 2u].position;
            let blocks = triangle_blocks(a.position, b, c, receiver.position, way, unbounded);
            share *= select(1.0, triangle_transmittance[a.triangle], blocks && a.triangle != receiver.triangle);
        }
    }
    if (node <= walk.y && share > 0.0) {
        atomicAdd(&candidates.unfinished, 1u);
    }
    return share;
}

// As `trace`, where some triangles are semi-opaque.
@compute @workgroup_size(64)  // GROUP
fn trace_attenuated(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let chunks = chunks_of(trace_range);
    let candidate_count = atomicLoad(&candidates.count);
    let used = (candidate_count * chunks + GROUP - 1u) / GROUP;
    let position = scattered(group.y * groups.x + group.x, used) * GROUP + lane;
    if (position >= candidate_count * chunks) {
        return;
    }
    let candidate = candidates.items[position / chunks];
    let index = candidate.receiver;
    let first = trace_range.first_sample + position % chunks * SAMPLES_PER_INVOCATION;
    let end = min(min(first + SAMPLES_PER_INVOCATION, trace_range.end_sample), decided[index]);
    let receiver = receivers[index];
    let view = light_view(light, receiver.position);
    let pad = vec3<f32>(box_pad(receiver.position));
    let walk = vec2<u32>(candidate.first_node, candidate.last_node);
    let unbounded = light.kind == LIGHT_SUN;
    let own = first_sample(sampling, index);
    for (var sample = first; sample < end; sample++) {
        let at = index * sampling.count + sample;
        let before = sample_transmittance[at];
        if (before > 0.0) {
            let way = light_way(light_sample(light, view, light_samples[own + sample], receiver.position), receiver.position);
            sample_transmittance[at] = before * passed_share(receiver, way, unbounded, walk, pad);
        }
    }
}
