// Finds the edges that can be silhouettes over any part of the light, cluster by cluster (Forest et al., section 4.1: accurate), or over
// its reference point (standard).
//
// An edge may be left out only if it has exactly two faces, on opposite sides for every point of the light:
// what it adds on one side it takes away on the other, from whatever receiver. The sides are taken with a margin for rounding, so
// that an edge is kept wherever a receiver's own signs could say otherwise.
//#import shared/slice.wgsl
//#import depth_complexity/frame.wgsl
//#import shared/occluders.wgsl
//#import depth_complexity/clusters.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> light_frame: LightFrame;
@group(0) @binding(2) var<uniform> cluster_range: ClusterRange;
@group(0) @binding(3) var<storage, read> edges: array<EightWords>;
@group(0) @binding(4) var<storage, read> incident_faces: array<EightWords>;
@group(0) @binding(5) var<storage, read_write> clusters: array<Cluster>;

// Which side of a face a part of the light is on, `half` its size to either side of `middle` and `radius` that of a ball; 0 where the
// face's plane meets it.
fn side_of_light(face: IncidentFace, middle: vec2<f32>, half: vec2<f32>, radius: f32) -> i32 {
    var height = 0.0;
    var spread = 0.0;
    var size = 0.0;
    if (light_frame.kind == FRAME_SUN) {
        let x = light_frame.x_row * light_frame.size;
        let y = light_frame.y_row * light_frame.size;
        height = dot(face.normal, light_frame.z_row + x * middle.x + y * middle.y);
        spread = abs(dot(face.normal, x)) * half.x + abs(dot(face.normal, y)) * half.y;
        size = 1.0;
    } else {
        let is_flat = light_frame.kind == FRAME_FLAT;
        let offset = select(vec3<f32>(0.0), light_frame.x_way * middle.x + light_frame.y_way * middle.y, is_flat);
        let way = light_frame.origin + offset - face.point;
        height = dot(face.normal, way);
        let across = abs(dot(face.normal, light_frame.x_way)) * half.x + abs(dot(face.normal, light_frame.y_way)) * half.y;
        spread = select(radius, across, is_flat);
        size = dot(abs(light_frame.origin) + abs(offset) + abs(face.point), vec3<f32>(1.0));
    }
    // Local scenes lie within 1: so far can a receiver be whose own sign has to agree.
    let margin = spread + 4e-6 * (1.0 + size + spread);
    return select(0, 1, height > margin) - select(0, 1, height < -margin);
}

fn can_be_silhouette(edge: OccluderEdge, middle: vec2<f32>, half: vec2<f32>, radius: f32) -> bool {
    if (edge.incidence_count != 2u) {
        return true;
    }
    let a = incident_face_of(incident_faces[edge.first_incidence]);
    let b = incident_face_of(incident_faces[edge.first_incidence + 1u]);
    let side_a = turned(side_of_light(a, middle, half, radius), a);
    let side_b = turned(side_of_light(b, middle, half, radius), b);
    return side_a + side_b != 0 || side_a == 0;
}

fn find(index: u32, middle: vec2<f32>, half: vec2<f32>, radius: f32) {
    let first = index * CLUSTER;
    let end = min(first + CLUSTER, cluster_range.edge_count);
    var found = Cluster(vec3<f32>(1e30), 0u, vec3<f32>(-1e30), 0u);
    for (var at = first; at < end; at++) {
        let edge = edge_of(edges[at]);
        if (can_be_silhouette(edge, middle, half, radius)) {
            found.silhouettes |= 1u << (at - first);
            found.low = min(found.low, min(edge.low, edge.high));
            found.high = max(found.high, max(edge.low, edge.high));
        }
    }
    clusters[index] = found;
}

@compute @workgroup_size(64)
fn silhouettes(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x < slice.count) {
        let middle = (light_frame.low + light_frame.high) * 0.5 + light_frame.reference;
        find(slice.first + invocation.x, middle, (light_frame.high - light_frame.low) * 0.5, light_frame.size);
    }
}

// Those of the reference point alone, as most publications have them: edges that are silhouettes for a part of the light only are missed.
@compute @workgroup_size(64)
fn standard_silhouettes(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x < slice.count) {
        find(slice.first + invocation.x, light_frame.reference, vec2<f32>(0.0), 0.0);
    }
}
