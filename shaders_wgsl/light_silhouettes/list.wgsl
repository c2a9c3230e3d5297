// Lists the edges that are silhouettes as seen from the light's centre, and counts the corners of what is drawn at them for an indirect draw.
//
// An edge is one where the number of layers changes: the weight is how many more there are to the left of low -> high, as the light sees
// it. That serves open, non-manifold and inconsistently wound meshes alike.
//#import shared/slice.wgsl
//#import shared/light.wgsl
//#import shared/occluders.wgsl
//#import shared/light_silhouette.wgsl

struct DrawArguments {
    vertices: atomic<u32>,
    instances: u32,
    first_vertex: u32,
    first_instance: u32,
}

struct EdgeCorners {
    per_edge: u32,
    reserved0: u32,
    reserved1: u32,
    reserved2: u32,
}

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> light: Light;
@group(0) @binding(2) var<uniform> edge_corners: EdgeCorners;
@group(0) @binding(3) var<storage, read> edges: array<OccluderEdge>;
@group(0) @binding(4) var<storage, read> incident_faces: array<IncidentFace>;
@group(0) @binding(5) var<storage, read_write> silhouettes: array<LightSilhouette>;
@group(0) @binding(6) var<storage, read_write> draw: DrawArguments;

fn side_from_center(face: IncidentFace) -> i32 {
    let is_sun = light.kind == LIGHT_SUN;
    let height = dot(face.normal, select(light.center - face.point, -light.emission, is_sun));
    let flatness = select(face.flatness, 0.0, is_sun);
    return turned(select(0, 1, height > flatness) - select(0, 1, height < -flatness), face);
}

@compute @workgroup_size(64)
fn list_silhouettes(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    if (index == 0u) {
        draw.instances = 1u;
    }
    let edge = edges[index];
    var weight = 0;
    for (var at = 0u; at < face_count(edge); at++) {
        weight += side_from_center(incident_faces[edge.first_incidence + at]);
    }
    if (weight != 0) {
        let place = atomicAdd(&draw.vertices, edge_corners.per_edge) / edge_corners.per_edge;
        silhouettes[place] = LightSilhouette(edge.low, weight, edge.high, index);
    }
}
