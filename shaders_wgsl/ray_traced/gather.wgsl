// Finds the receivers that need rays: the whole bundle of rays from a receiver to the light walks the hierarchy as one interval.
//
// Where no leaf lies between the receiver and the box around its samples, no ray is traced. Elsewhere the walk of every ray
// begins at the first leaf that the bundle met and ends after the last. Both only leave out boxes that no ray of the bundle can
// meet, so the answer is that of every ray.
//#import shared/slice.wgsl
//#import shared/light.wgsl
//#import ray_traced/hierarchy.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> light: Light;
@group(0) @binding(2) var<uniform> trace_range: TraceRange;
@group(0) @binding(3) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(4) var<storage, read> nodes: array<BvhNode>;
@group(0) @binding(5) var<storage, read> decided: array<u32>;
@group(0) @binding(6) var<storage, read_write> candidates: array<Candidate>;
@group(0) @binding(7) var<storage, read_write> candidate_count: atomic<u32>;

// First and last node that the bundle of ways can meet; `first` is the number of nodes where there is none.
fn bundle_walk(receiver: Receiver, ways: WayBounds) -> vec2<u32> {
    let pad = vec3<f32>(box_pad(receiver.position));
    var found = vec2<u32>(trace_range.node_count, 0u);
    let unbounded = light.kind == LIGHT_SUN;
    let inverse_low = safe_reciprocal(ways.low);
    let inverse_high = safe_reciprocal(ways.high);
    let has_horizon = receiver.kind == RECEIVER_SURFACE;
    // Less than the lift of the receiver, so that what lies in its own plane stays below.
    let horizon_slack = 0.25 * pad.x;
    var node = 0u;
    var steps = 0u;
    while (node < trace_range.node_count && steps < LONGEST_BUNDLE_WALK) {
        steps++;
        let box = nodes[node];
        let low = box.low - receiver.position - pad;
        let high = box.high - receiver.position + pad;
        // Along each axis the bundle covers [t·way_low, t·way_high]; t must reach the box with both ends.
        let t_low = low * inverse_high;
        let t_high = high * inverse_low;
        let enters = max(select(vec3<f32>(0.0), t_low, ways.high > vec3<f32>(0.0)),
                         select(vec3<f32>(0.0), t_high, ways.low < vec3<f32>(0.0)));
        let endless = vec3<f32>(1e30);
        let leaves = min(select(endless, t_low, ways.high < vec3<f32>(0.0)),
                         select(endless, t_high, ways.low > vec3<f32>(0.0)));
        let begin = max(0.0, max(enters.x, max(enters.y, enters.z)));
        let end = min(select(1.0, 1e30, unbounded), min(leaves.x, min(leaves.y, leaves.z)));
        // A box below the receiver's own plane lies between it and no visible sample.
        let top = dot(max(receiver.normal * (low + pad), receiver.normal * (high - pad)), vec3<f32>(1.0));
        let met = begin <= end * 1.00001 && (!has_horizon || top >= -horizon_slack);
        if (met && box.leaf != 0u) {
            found = vec2<u32>(min(found.x, node), node);
        }
        node = select(box.skip, node + 1u, met && box.leaf == 0u);
    }
    // A walk that was not finished has met what it has met, and may meet more to the end.
    if (node < trace_range.node_count) {
        found = vec2<u32>(min(found.x, node), trace_range.node_count - 1u);
    }
    return found;
}

@compute @workgroup_size(64)
fn gather(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    if (decided[index] == 0u) {
        return;
    }
    let receiver = receivers[index];
    let view = light_view(light, receiver.position);
    let walk = bundle_walk(receiver, light_way_bounds(light, view, receiver.position));
    if (walk.x <= walk.y) {
        // In whatever order: each candidate is written and read by one invocation, so the order changes no result.
        candidates[atomicAdd(&candidate_count, 1u)] = Candidate(index, walk.x, walk.y);
    }
}
