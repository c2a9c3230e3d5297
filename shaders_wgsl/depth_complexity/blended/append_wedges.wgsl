// Lists the edges that can be silhouettes over any part of the light, and counts the corners of their wedges for an indirect draw.
//#import shared/slice.wgsl
//#import shared/occluders.wgsl
//#import depth_complexity/clusters.wgsl
//#import depth_complexity/tiles.wgsl
//#import depth_complexity/blended/hull.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<storage, read> clusters: array<Cluster>;
@group(0) @binding(2) var<storage, read> edges: array<OccluderEdge>;
@group(0) @binding(3) var<storage, read_write> wedges: array<u32>;
@group(0) @binding(4) var<storage, read_write> draw: DrawArguments;
@group(0) @binding(5) var<storage, read_write> counts: ListCounts;

struct DrawArguments {
    vertices: atomic<u32>,
    instances: u32,
    first_vertex: u32,
    first_instance: u32,
}

const WEDGE_CORNERS: u32 = 3u * WEDGE_TRIANGLES;

// Faces of one edge at most: a fragment walks all of them, and software drivers end long loops.
const MOST_FACES: u32 = 4096u;

@compute @workgroup_size(64)
fn append_wedges(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    if (index == 0u) {
        draw.instances = 1u;
    }
    var bits = clusters[index].silhouettes;
    let count = countOneBits(bits);
    if (count == 0u) {
        return;
    }
    var at = atomicAdd(&draw.vertices, count * WEDGE_CORNERS) / WEDGE_CORNERS;
    atomicAdd(&counts.edges, count);
    while (bits != 0u) {
        let edge = index * CLUSTER + firstTrailingBit(bits);
        bits &= bits - 1u;
        wedges[at] = edge;
        at++;
        if (edges[edge].incidence_count > MOST_FACES) {
            atomicAdd(&counts.unfinished, 1u);
        }
    }
}
