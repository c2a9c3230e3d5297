// Lists: for every bundle the faces that can lie between its receivers and the reference point; for every part of a tile, and then for every
// bundle of it, the edges that can be silhouettes between its receivers and the light.
//
// An edge is left out where its two faces lie on opposite sides for all receivers of the part, with a margin that is
// wider than a receiver's lift: the edges of a receiver's own triangle, which it leaves out, always stay.
//#import shared/slice.wgsl
//#import shared/receiver.wgsl
//#import shared/occluders.wgsl
//#import depth_complexity/clusters.wgsl
//#import depth_complexity/shaft.wgsl
//#import depth_complexity/tiles.wgsl
//#import depth_complexity/tree.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> cluster_range: ClusterRange;
@group(0) @binding(2) var<storage, read> edges: array<EightWords>;
@group(0) @binding(3) var<storage, read> incident_faces: array<EightWords>;
@group(0) @binding(4) var<storage, read> clusters: array<Cluster>;
@group(0) @binding(5) var<storage, read> groups_of_clusters: array<Cluster>;
@group(0) @binding(6) var<storage, read> parts: array<TilePart>;
@group(0) @binding(7) var<storage, read_write> lists: array<u32>;
@group(0) @binding(8) var<storage, read_write> counts: ListCounts;
@group(0) @binding(9) var<uniform> light_frame: LightFrame;
@group(0) @binding(10) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(11) var<storage, read> slots: array<Slot>;
@group(0) @binding(12) var<storage, read> face_tree: array<EightWords>;
@group(0) @binding(13) var<storage, read_write> first_faces: array<u32>;

const MARGIN: f32 = 64.0 * 5.9604645e-8;

struct Shaft {
    planes: array<vec4<f32>, 5>,
    middle: vec3<f32>,
    half: vec3<f32>,
}

fn plane_excludes(plane: vec4<f32>, a: vec3<f32>, b: vec3<f32>) -> bool {
    return dot(plane.xyz, a) > plane.w && dot(plane.xyz, b) > plane.w;
}

fn meets_edge(shaft: Shaft, a: vec3<f32>, b: vec3<f32>) -> bool {
    return !(plane_excludes(shaft.planes[0], a, b)
        || plane_excludes(shaft.planes[1], a, b)
        || plane_excludes(shaft.planes[2], a, b)
        || plane_excludes(shaft.planes[3], a, b)
        || plane_excludes(shaft.planes[4], a, b));
}

// Which side of a face all receivers are on; 0 where they are not.
fn side_of_all(face: IncidentFace, shaft: Shaft) -> i32 {
    let height = dot(face.normal, shaft.middle - face.point);
    let size = abs(shaft.middle) + shaft.half + abs(face.point);
    let margin = dot(abs(face.normal), shaft.half) + MARGIN * (1.0 + size.x + size.y + size.z);
    return select(0, 1, height > margin) - select(0, 1, height < -margin);
}

// What an edge adds to a list: nothing, or itself with its weight where that is the same for all receivers.
fn entry_of(e: u32, shaft: Shaft) -> u32 {
    let edge = edge_of(edges[e]);
    let a = incident_face_of(incident_faces[edge.first_incidence]);
    let b = incident_face_of(incident_faces[edge.first_incidence + face_count(edge) - 1u]);
    let side_a = turned(side_of_all(a, shaft), a);
    let side_b = turned(side_of_all(b, shaft), b);
    let is_pair = edge.incidence_count == 2u;
    let weight = select(side_a, side_a + side_b, is_pair);
    let is_known = (edge.incidence_count <= 2u) & (side_a != 0) & (side_b != 0) & (light_frame.weighs_from_light == 0u);
    let cancels = is_known & (weight == 0);
    return select(listed(e, select(0, weight, is_known)), NO_ENTRY, cancels | !meets_edge(shaft, edge.low, edge.high));
}

fn first_chunk_at() -> u32 {
    return first_chunk_word(cluster_range.tile_count);
}

fn appended(before: Tail, entry: u32) -> Tail {
    var tail = before;
    let base = first_chunk_at();
    if (tail.filled == CHUNK_EDGES && !tail.full) {
        let next = atomicAdd(&counts.chunks, 1u) + 1u;
        tail.full = next >= (arrayLength(&lists) - base) / CHUNK;
        if (!tail.full) {
            lists[base + next * CHUNK] = 0u;
            if (tail.chunk == 0u) {
                tail.first = next;
            } else {
                lists[base + tail.chunk * CHUNK] = next;
                lists[base + tail.chunk * CHUNK + 1u] = CHUNK_EDGES;
            }
            tail.chunk = next;
            tail.filled = 0u;
        }
    }
    if (!tail.full) {
        lists[base + tail.chunk * CHUNK + 2u + tail.filled] = entry;
        tail.filled++;
    }
    return tail;
}

fn close(tail: Tail) {
    if (tail.chunk != 0u) {
        lists[first_chunk_at() + tail.chunk * CHUNK + 1u] = tail.filled;
    }
}

// Whether loops still run.
fn has_steps_left() -> bool {
    var steps = 0u;
    for (var k = 0u; k < LAST_STEPS; k++) {
        // Read from a buffer, so that nobody can tell the number beforehand.
        steps += select(0u, 1u, edge_of(edges[min(k, arrayLength(&edges) - 1u)]).incidence_count != 0xffffffffu);
    }
    return steps == LAST_STEPS;
}

@compute @workgroup_size(64)
fn cull(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    let part = parts[index];
    if (part.receiver_count == 0u || part.has_faces == 0u) {
        return;
    }
    let shaft = Shaft(part.planes, (part.low + part.high) * 0.5, (part.high - part.low) * 0.5);
    let group_count = (cluster_range.cluster_count + CLUSTER - 1u) / CLUSTER;
    var list = no_list();
    var total = 0u;
    var steps = 0u;
    for (var g = 0u; g < group_count; g++) {
        let group = groups_of_clusters[g];
        var waiting = select(0u, group.silhouettes, group.silhouettes != 0u && shaft_meets_box(shaft.planes, group.low, group.high));
        while (waiting != 0u) {
            let c = g * CLUSTER + firstTrailingBit(waiting);
            waiting &= waiting - 1u;
            let cluster = clusters[c];
            var bits = select(0u, cluster.silhouettes, shaft_meets_box(shaft.planes, cluster.low, cluster.high));
            steps += 1u + countOneBits(bits);
            if (steps > LONGEST_WALK * 4u) {
                list.full = true;
                bits = 0u;
                waiting = 0u;
            }
            while (bits != 0u) {
                let e = c * CLUSTER + firstTrailingBit(bits);
                bits &= bits - 1u;
                if (entry_of(e, shaft) != NO_ENTRY) {
                    list = appended(list, e);
                    total++;
                }
            }
        }
    }
    close(list);
    if (list.chunk != 0u) {
        let slot = atomicAdd(&counts.parts, 1u);
        lists[HEAD * slot] = index;
        lists[HEAD * slot + 1u] = list.first;
        atomicAdd(&counts.edges, total);
    }
    if (list.full || !has_steps_left()) {
        atomicAdd(&counts.unfinished, part.receiver_count);
    }
}

// The shaft between the receivers of a bundle that belong to a part, and the light or its reference point.
struct BundleShaft {
    shaft: Shaft,
    receiver_count: u32,
}

fn bundle_shaft(part: u32, bundle: u32, target_at: vec4<f32>) -> BundleShaft {
    let first = (part >> 1u) * TILE + bundle * BUNDLE;
    let end = min(first + BUNDLE, cluster_range.receiver_count);
    var low = vec3<f32>(1e30);
    var high = vec3<f32>(-1e30);
    var count = 0u;
    for (var at = first; at < end; at++) {
        let slot = slots[at];
        if (slot.depth != NO_VIEW && slot.part == (part & 1u)) {
            let p = receivers[slot.receiver].position;
            low = min(low, p);
            high = max(high, p);
            count++;
        }
    }
    let middle = (low + high) * 0.5;
    let axes = axes_of(light_frame, middle);
    var reach = no_reach();
    for (var at = first; at < end; at++) {
        let slot = slots[at];
        if (slot.depth != NO_VIEW && slot.part == (part & 1u)) {
            reach = reach_with(light_frame, axes, target_at, reach, receivers[slot.receiver].position);
        }
    }
    let planes = shaft_planes(light_frame, axes, target_at, reach, max(abs(low), abs(high)));
    return BundleShaft(Shaft(planes, middle, (high - low) * 0.5), count);
}

@compute @workgroup_size(64)
fn list_faces(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let item = slice.first + invocation.x;
    let bundle_count = 2u * BUNDLES * cluster_range.tile_count;
    let index = scattered(item / 64u, (bundle_count + 63u) / 64u) * 64u + item % 64u;
    if (index >= bundle_count) {
        return;
    }
    let part = index / BUNDLES;
    first_faces[index] = 0u;
    if (parts[part].has_faces == 0u) {
        return;
    }
    let bounds = bundle_shaft(part, index % BUNDLES, reference_point(light_frame));
    let planes = bounds.shaft.planes;
    let end = select(0u, arrayLength(&face_tree), bounds.receiver_count > 0u);
    var list = no_list();
    var node = 0u;
    var steps = 0u;
    while (node < end && steps < MOST_STEPS) {
        let box = node_of(face_tree[node]);
        let met = shaft_meets_box(planes, box.low, box.high);
        node = select(box.skip, node + 1u, met);
        let first = box.leaf >> LEAF_BITS;
        let count = select(0u, box.leaf & ((1u << LEAF_BITS) - 1u), met);
        steps += 1u + count;
        for (var k = 0u; k < count; k++) {
            list = appended(list, first + k);
        }
    }
    close(list);
    first_faces[index] = list.first;
    if (list.full || node < end || !has_steps_left()) {
        atomicAdd(&counts.unfinished, bounds.receiver_count);
    }
}

@compute @workgroup_size(64)
fn narrow(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let position = (workgroup.y * workgroups.x + workgroup.x) * (64u / BUNDLES) + lane / BUNDLES;
    let bundle = lane % BUNDLES;
    if (position >= atomicLoad(&counts.parts)) {
        return;
    }
    let bounds = bundle_shaft(lists[HEAD * position], bundle, whole_light(light_frame));
    let base = first_chunk_at();
    var chunk = select(0u, lists[HEAD * position + 1u], bounds.receiver_count > 0u);
    var list = no_list();
    while (chunk != 0u) {
        let at = base + chunk * CHUNK;
        let end = lists[at + 1u];
        for (var k = 0u; k < end; k++) {
            let entry = entry_of(lists[at + 2u + k], bounds.shaft);
            if (entry != NO_ENTRY) {
                list = appended(list, entry);
            }
        }
        chunk = lists[at];
    }
    close(list);
    // Where there is no room, the whole tile's list serves the bundle as well.
    lists[HEAD * position + 2u + bundle] = select(list.first, lists[HEAD * position + 1u], list.full);
    if (!has_steps_left()) {
        atomicAdd(&counts.unfinished, bounds.receiver_count);
    }
}
