// Lists, for every part of a tile, the edges that can be silhouettes between its receivers and the light.
//
// An edge is left out where its two faces lie on opposite sides for all receivers of the part, with a margin that is
// wider than a receiver's lift: the edges of a receiver's own triangle, which it leaves out, always stay.
//#import shared/slice.wgsl
//#import depth_complexity/occluders.wgsl
//#import depth_complexity/clusters.wgsl
//#import depth_complexity/tiles.wgsl
//#import depth_complexity/walk.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> cluster_range: ClusterRange;
@group(0) @binding(2) var<storage, read> edges: array<OccluderEdge>;
@group(0) @binding(3) var<storage, read> incident_faces: array<IncidentFace>;
@group(0) @binding(4) var<storage, read> clusters: array<Cluster>;
@group(0) @binding(5) var<storage, read> groups_of_clusters: array<Cluster>;
@group(0) @binding(6) var<storage, read> parts: array<TilePart>;
@group(0) @binding(7) var<storage, read_write> lists: array<u32>;
@group(0) @binding(8) var<storage, read_write> counts: ListCounts;

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

// Which side of a face all receivers of the part are on; 0 where they are not.
fn side_of_part(face: IncidentFace, shaft: Shaft) -> i32 {
    let height = dot(face.normal, shaft.middle - face.point);
    let size = abs(shaft.middle) + shaft.half + abs(face.point);
    let margin = dot(abs(face.normal), shaft.half) + MARGIN * (1.0 + size.x + size.y + size.z);
    return select(0, 1, height > margin) - select(0, 1, height < -margin);
}

fn matters(edge: OccluderEdge, shaft: Shaft) -> bool {
    if (!meets_edge(shaft, edge.low, edge.high)) {
        return false;
    }
    if (edge.incidence_count != 2u) {
        return true;
    }
    let a = incident_faces[edge.first_incidence];
    let b = incident_faces[edge.first_incidence + 1u];
    let side_a = turned(side_of_part(a, shaft), a);
    let side_b = turned(side_of_part(b, shaft), b);
    return side_a + side_b != 0 || side_a == 0;
}

// Whether loops still run.
fn has_steps_left() -> bool {
    var steps = 0u;
    for (var k = 0u; k < LAST_STEPS; k++) {
        // Read from a buffer, so that nobody can tell the number beforehand.
        steps += select(0u, 1u, edges[min(k, arrayLength(&edges) - 1u)].incidence_count != 0xffffffffu);
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
    let base = first_chunk_word(cluster_range.tile_count);
    let capacity = (arrayLength(&lists) - base) / CHUNK;
    let group_count = (cluster_range.cluster_count + CLUSTER - 1u) / CLUSTER;
    var first_chunk = 0u;
    var chunk = 0u;
    var filled = CHUNK_EDGES;
    var total = 0u;
    var steps = 0u;
    var full = false;
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
                full = true;
                bits = 0u;
                waiting = 0u;
            }
            while (bits != 0u) {
                let e = c * CLUSTER + firstTrailingBit(bits);
                bits &= bits - 1u;
                if (matters(edges[e], shaft)) {
                    if (filled == CHUNK_EDGES && !full) {
                        let next = atomicAdd(&counts.chunks, 1u) + 1u;
                        full = next >= capacity;
                        if (!full) {
                            lists[base + next * CHUNK] = 0u;
                            if (chunk == 0u) {
                                first_chunk = next;
                            } else {
                                lists[base + chunk * CHUNK] = next;
                                lists[base + chunk * CHUNK + 1u] = CHUNK_EDGES;
                            }
                            chunk = next;
                            filled = 0u;
                        }
                    }
                    if (!full) {
                        lists[base + chunk * CHUNK + 2u + filled] = e;
                        filled++;
                        total++;
                    }
                }
            }
        }
    }
    if (chunk != 0u) {
        lists[base + chunk * CHUNK + 1u] = filled;
        let slot = atomicAdd(&counts.parts, 1u);
        lists[2u * slot] = index;
        lists[2u * slot + 1u] = first_chunk;
        atomicAdd(&counts.edges, total);
    }
    if (full || !has_steps_left()) {
        atomicAdd(&counts.unfinished, part.receiver_count);
    }
}
