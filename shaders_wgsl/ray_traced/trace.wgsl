// Traces shadow rays through one sub-scene: any hit between the receiver and a sample sets the sample's bit.
//
// First the whole bundle of rays walks the hierarchy as one interval: where no leaf lies between the receiver and the box
// around its samples, no ray is traced. It also narrows the walk: rays begin at the first leaf that the bundle met and end
// after the last. Both only leave out boxes that no ray of the bundle can meet, so the answer is that of every ray.
//#import shared/slice.wgsl
//#import shared/light.wgsl
//#import shared/triangle.wgsl
//#import shared/samples.wgsl

struct BvhNode {
    low: vec3<f32>,
    skip: u32,
    high: vec3<f32>,
    leaf: u32,
}

struct TraceRange {
    first_sample: u32,
    node_count: u32,
}

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> light: Light;
@group(0) @binding(2) var<uniform> sampling: Sampling;
@group(0) @binding(3) var<uniform> trace_range: TraceRange;
@group(0) @binding(4) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(5) var<storage, read> light_samples: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read> nodes: array<BvhNode>;
@group(0) @binding(7) var<storage, read> corners: array<Corner>;
@group(0) @binding(8) var<storage, read> decided: array<u32>;
@group(0) @binding(9) var<storage, read_write> blocked: array<u32>;

const LEAF_BITS: u32 = 3u;

// The reciprocal of a component that may be zero. Local coordinates are of the order of 1, so what is replaced is far below
// the smallest step of any ray.
fn safe_reciprocal(x: vec3<f32>) -> vec3<f32> {
    let tiny = vec3<f32>(1e-20);
    let signed_tiny = select(tiny, -tiny, x < vec3<f32>(0.0));
    return 1.0 / select(x, signed_tiny, abs(x) < tiny);
}

// First and last node that the bundle of ways can meet; `first` is the number of nodes where there is none.
fn bundle_walk(receiver: Receiver, ways: WayBounds, pad: vec3<f32>) -> vec2<u32> {
    var found = vec2<u32>(trace_range.node_count, 0u);
    let unbounded = light.kind == LIGHT_SUN;
    let inverse_low = safe_reciprocal(ways.low);
    let inverse_high = safe_reciprocal(ways.high);
    let has_horizon = receiver.kind == RECEIVER_SURFACE;
    var node = 0u;
    while (node < trace_range.node_count) {
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
        let top = dot(max(receiver.normal * low, receiver.normal * high), vec3<f32>(1.0));
        let met = begin <= end * 1.00001 && (!has_horizon || top >= 0.0);
        if (met && box.leaf != 0u) {
            found = vec2<u32>(min(found.x, node), node);
        }
        node = select(box.skip, node + 1u, met && box.leaf == 0u);
    }
    return found;
}

fn is_blocked(receiver: Receiver, way: vec3<f32>, unbounded: bool, range: vec2<u32>, pad: vec3<f32>) -> bool {
    let inverse = safe_reciprocal(way);
    // The box is widened by what rounding can cost, so that no box hides a triangle that the test below would meet.
    let to_low = (-receiver.position - pad) * inverse;
    let to_high = (-receiver.position + pad) * inverse;
    let end_of_way = select(1.0, 1e30, unbounded);
    var node = range.x;
    var hit = false;
    while (node <= range.y) {
        let box = nodes[node];
        let rising = inverse >= vec3<f32>(0.0);
        let near = select(box.high * inverse + to_high, box.low * inverse + to_low, rising);
        let far = select(box.low * inverse + to_low, box.high * inverse + to_high, rising);
        let enter = max(max(near.x, near.y), max(near.z, 0.0));
        let leave = min(min(far.x, far.y), min(far.z, end_of_way));
        let met = enter <= leave;
        let count = select(0u, box.leaf & ((1u << LEAF_BITS) - 1u), met);
        let first = box.leaf >> LEAF_BITS;
        for (var k = first; k < first + count; k++) {
            let a = corners[3u * k];
            let b = corners[3u * k + 1u].position;
            let c = corners[3u * k + 2u].position;
            let blocks = triangle_blocks(a.position, b, c, receiver.position, way, unbounded);
            hit = hit || (blocks && a.triangle != receiver.triangle);
        }
        node = select(box.skip, node + 1u, met && box.leaf == 0u);
        node = select(node, 0xffffffffu, hit);
    }
    return hit;
}

@compute @workgroup_size(64)
fn trace(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    let end = decided[index];
    if (end <= trace_range.first_sample) {
        return;
    }
    let receiver = receivers[index];
    let view = light_view(light, receiver.position);
    let ways = light_way_bounds(light, view, receiver.position);
    let pad = vec3<f32>(16.0 * 5.9604645e-8 * (largest_component(receiver.position) + 1.0));
    let range = bundle_walk(receiver, ways, pad);
    if (range.x > range.y) {
        return;
    }
    let unbounded = light.kind == LIGHT_SUN;
    for (var word = trace_range.first_sample / 32u; 32u * word < end; word++) {
        var mask = blocked[index * sampling.words + word];
        let stop = min(32u, end - 32u * word);
        for (var bit = max(trace_range.first_sample, 32u * word) - 32u * word; bit < stop; bit++) {
            if ((mask & (1u << bit)) == 0u) {
                let way = light_way(light_sample(light, view, light_samples[32u * word + bit]), receiver.position);
                mask |= select(0u, 1u << bit, is_blocked(receiver, way, unbounded, range, pad));
            }
        }
        blocked[index * sampling.words + word] = mask;
    }
}
