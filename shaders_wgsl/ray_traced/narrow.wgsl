// Asks the candidates again, triangle by triangle: most have a few boxes but no triangle between them and the light.
//#import shared/light.wgsl
//#import shared/triangle.wgsl
//#import ray_traced/bundle.wgsl

@group(0) @binding(0) var<uniform> light: Light;
@group(0) @binding(1) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(2) var<storage, read> nodes: array<BvhNode>;
@group(0) @binding(3) var<storage, read> corners: array<Corner>;
@group(0) @binding(4) var<storage, read_write> candidates: CandidateList;
@group(0) @binding(5) var<storage, read_write> narrowed: CandidateList;

const LONGEST_NARROW_WALK: u32 = 64u;

// Whether a triangle can block any way of the bundle: it is not the receiver's own, rises above its plane, and has no edge
// that all ways pass on the outer side.
fn triangle_can_block(receiver: Receiver, k: u32, ways: WayBounds, horizon_slack: f32) -> bool {
    let corner = corners[3u * k];
    let v0 = corner.position;
    let v1 = corners[3u * k + 1u].position;
    let v2 = corners[3u * k + 2u].position;
    let a = v0 - receiver.position;
    let b = v1 - receiver.position;
    let c = v2 - receiver.position;
    let top = max(dot(receiver.normal, a), max(dot(receiver.normal, b), dot(receiver.normal, c)));
    let rises = receiver.kind != RECEIVER_SURFACE || top >= -horizon_slack;
    let ab = way_range(a, v1 - v0, ways);
    let bc = way_range(b, v2 - v1, ways);
    let ca = way_range(a, v0 - v2, ways);
    let can_enclose = (ab.y >= 0.0 && bc.y >= 0.0 && ca.y >= 0.0) || (ab.x <= 0.0 && bc.x <= 0.0 && ca.x <= 0.0);
    return rises && can_enclose && corner.triangle != receiver.triangle;
}

// Smallest and largest value of way · (corner × edge) over the bundle, widened by what rounding can cost here and in the rays'
// own test: a share of the products before any of them cancel.
fn way_range(corner: vec3<f32>, edge: vec3<f32>, ways: WayBounds) -> vec2<f32> {
    let normal = cross(corner, edge);
    let c = abs(corner);
    let e = abs(edge);
    let uncancelled = c.yzx * e.zxy + c.zxy * e.yzx;
    let slack = 4e-6 * dot(max(abs(ways.low), abs(ways.high)), uncancelled);
    let at_low = ways.low * normal;
    let at_high = ways.high * normal;
    let least = dot(min(at_low, at_high), vec3<f32>(1.0));
    let most = dot(max(at_low, at_high), vec3<f32>(1.0));
    return vec2<f32>(least - slack, most + slack);
}

// Where the rays of the candidate begin: at the first leaf with such a triangle; after its last node where there is none.
// A long walk is given up: it would cost more than the rays that it saves.
fn first_leaf(receiver: Receiver, candidate: Candidate, ways: WayBounds) -> u32 {
    let slack = HORIZON_SLACK * box_pad(receiver.position);
    let bundle = bundle_of(receiver, ways, light.kind == LIGHT_SUN);
    var node = candidate.first_node;
    var leaf_node = node;
    var steps = 0u;
    var any = false;
    // Walking to a leaf and testing its triangles are loops of their own: a driver that runs lanes in step would otherwise
    // pay for the triangles at every node.
    while (node <= candidate.last_node && !any) {
        var leaf = 0u;
        while (leaf == 0u && node <= candidate.last_node && steps < LONGEST_NARROW_WALK) {
            steps++;
            let box = nodes[node];
            let met = bundle_meets(bundle, box);
            leaf = select(0u, box.leaf, met);
            leaf_node = node;
            node = select(box.skip, node + 1u, met && box.leaf == 0u);
        }
        any = steps >= LONGEST_NARROW_WALK;
        let first = leaf >> LEAF_BITS;
        let count = leaf & ((1u << LEAF_BITS) - 1u);
        for (var k = first; k < first + count && !any; k++) {
            any = triangle_can_block(receiver, k, ways, slack);
        }
    }
    return select(candidate.last_node + 1u, leaf_node, any);
}

@compute @workgroup_size(64)  // GROUP
fn narrow(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let candidate_count = atomicLoad(&candidates.count);
    let used = (candidate_count + GROUP - 1u) / GROUP;
    let position = scattered(group.y * groups.x + group.x, used) * GROUP + lane;
    if (position >= candidate_count) {
        return;
    }
    let candidate = candidates.items[position];
    let receiver = receivers[candidate.receiver];
    let view = light_view(light, receiver.position);
    let first = first_leaf(receiver, candidate, light_way_bounds(light, view, receiver.position));
    if (first <= candidate.last_node) {
        narrowed.items[atomicAdd(&narrowed.count, 1u)] = Candidate(candidate.receiver, first, candidate.last_node);
    }
}
