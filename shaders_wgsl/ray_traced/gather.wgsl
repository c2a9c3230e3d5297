// Finds the receivers that need rays: the whole bundle of rays from a receiver to the light walks the hierarchy as one interval.
//
// Where no leaf lies between the receiver and the box around its samples, no ray is traced. Elsewhere the walk of every ray
// begins at the first leaf that the bundle met and ends after the last. Both only leave out boxes that no ray of the bundle can
// meet, so the answer is that of every ray.
//#import shared/slice.wgsl
//#import shared/light.wgsl
//#import ray_traced/bundle.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> light: Light;
@group(0) @binding(2) var<uniform> trace_range: TraceRange;
@group(0) @binding(3) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(4) var<storage, read> nodes: array<BvhNode>;
@group(0) @binding(5) var<storage, read> decided: array<u32>;
@group(0) @binding(6) var<storage, read_write> candidates: CandidateList;

// First and last leaf that the bundle can meet; `first` is the number of nodes where there is none.
fn bundle_walk(receiver: Receiver, ways: WayBounds) -> vec2<u32> {
    let bundle = bundle_of(receiver, ways, light.kind == LIGHT_SUN);
    var found = vec2<u32>(trace_range.node_count, 0u);
    var node = 0u;
    var steps = 0u;
    while (node < trace_range.node_count && steps < LONGEST_BUNDLE_WALK) {
        steps++;
        let box = nodes[node];
        let met = bundle_meets(bundle, box);
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
        candidates.items[atomicAdd(&candidates.count, 1u)] = Candidate(index, walk.x, walk.y);
    }
}
