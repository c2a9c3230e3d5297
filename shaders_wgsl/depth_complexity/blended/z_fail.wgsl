// Layers over the reference point as Forest et al. count them: shadow volumes by z-fail, in one pass, without a stencil (section 7.2).
//
// A volume is what a face hides from the reference point: its near cap is the face, its far cap lies at infinity, and its sides join
// them. Sides of neighbours cancel but for silhouettes, which count by their weight as seen from the reference point. What leaves a volume
// behind a receiver counts one more, what enters one less. Whether a fragment lies behind is decided by rasterised depth, and not by the
// signs with which edges count: so next to edges, and in contact, this disagrees with rays, and all samples of the receiver are wrong.
//#import shared/receiver.wgsl
//#import depth_complexity/frame.wgsl
//#import shared/occluders.wgsl
//#import depth_complexity/blended/hull.wgsl

@group(0) @binding(0) var<uniform> light_frame: LightFrame;
@group(0) @binding(1) var<uniform> wedge_view: WedgeView;
@group(0) @binding(2) var<storage, read> wedges: array<u32>;
@group(0) @binding(3) var<storage, read> faces: array<Face>;
@group(0) @binding(4) var<storage, read> edges: array<OccluderEdge>;
@group(0) @binding(5) var<storage, read> incident_faces: array<IncidentFace>;
@group(0) @binding(6) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(7) var<storage, read_write> layers: array<atomic<i32>>;

struct Drawn {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) weight: i32,
    @location(1) @interpolate(flat) triangle: u32,    // of a near cap
    @location(2) share: f32,                          // 1 at a corner, 0 at infinity
}

// The reference point and 1, or the direction to that of a sun and 0.
fn reference_point() -> vec4<f32> {
    let c = light_frame.reference;
    if (light_frame.kind == FRAME_SUN) {
        return vec4<f32>(light_frame.z_row + (light_frame.x_row * c.x + light_frame.y_row * c.y) * light_frame.size, 0.0);
    }
    return vec4<f32>(light_frame.origin + light_frame.x_way * c.x + light_frame.y_way * c.y, 1.0);
}

fn side_of_reference(normal: vec3<f32>, point: vec3<f32>, flatness: f32) -> i32 {
    let c = reference_point();
    if (c.w == 0.0) {
        return i32(sign(dot(normal, c.xyz)));
    }
    return side_of_plane(normal, point, flatness, c.xyz);
}

fn clip_of(place: vec3<f32>, is_infinite: bool) -> vec4<f32> {
    let c = reference_point();
    let p = select(place - wedge_view.eye, place * c.w - c.xyz, is_infinite);
    let w = dot(wedge_view.forward, p);
    return vec4<f32>(dot(wedge_view.clip_x, p), dot(wedge_view.clip_y, p), 0.5 * w, w);
}

fn face_corner(face: Face, corner: u32) -> vec3<f32> {
    let reference = face.sides[corner];
    let edge = edges[reference >> 1u];
    return select(edge.low, edge.high, (reference & 1u) != 0u);
}

// Both caps of a face of up to four corners: two triangles each.
@vertex
fn draw_caps(@builtin(vertex_index) index: u32) -> Drawn {
    let face = faces[index / 12u];
    let is_far = index % 12u >= 6u;
    let fan = index / 3u % 2u;
    var corner = select(0u, fan + index % 3u, index % 3u > 0u);
    // The far cap is seen from the other side.
    if (is_far && corner > 0u) {
        corner = fan + 3u - index % 3u;
    }
    let exists = fan == 0u || face.sides[3] != NO_SIDE;
    let clip = clip_of(face_corner(face, select(0u, corner, exists)), is_far);
    let weight = side_of_reference(face.normal, face.point, face.flatness);
    return Drawn(clip, weight, select(face.triangle, NO_TRIANGLE, is_far), select(1.0, 0.0, is_far));
}

// The sides over silhouettes: two triangles of each wedge's ten; the others have no area.
@vertex
fn draw_sides(@builtin(vertex_index) index: u32) -> Drawn {
    let edge = edges[wedges[index / (3u * WEDGE_TRIANGLES)]];
    var weight = 0;
    for (var k = 0u; k < edge.incidence_count; k++) {
        let face = incident_faces[edge.first_incidence + k];
        weight += turned(side_of_reference(face.normal, face.point, face.flatness), face);
    }
    let corner = index % 3u;
    let second = index / 3u % WEDGE_TRIANGLES == 1u;
    let exists = index / 3u % WEDGE_TRIANGLES < 2u && weight != 0;
    // high, low, low at infinity; high, low at infinity, high at infinity.
    let is_high = corner == 0u || (second && corner == 2u);
    let is_infinite = corner == 2u || (second && corner == 1u);
    let clip = clip_of(select(edge.low, edge.high, is_high), is_infinite);
    return Drawn(select(vec4<f32>(0.0, 0.0, 0.0, 1.0), clip, exists), weight, NO_TRIANGLE, select(1.0, 0.0, is_infinite));
}

@fragment
fn count_layers(drawn: Drawn, @builtin(front_facing) enters: bool) -> @location(0) u32 {
    let pixel = vec2<u32>(drawn.clip.xy);
    let index = min(pixel.y * wedge_view.width + pixel.x, wedge_view.receiver_count - 1u);
    let receiver = receivers[index];
    let distance = dot(wedge_view.forward, receiver.position - wedge_view.eye);
    let change = select(drawn.weight, -drawn.weight, enters);
    // The fragment's w is the reciprocal of its distance where it is no way to infinity. A receiver's own face, which it is lifted off,
    // lies behind it; and hides nothing from it, so that it enters its volume there but does not leave it.
    let is_behind = drawn.clip.w * distance * drawn.share < 1.0;
    let counts = select(is_behind, change < 0, drawn.triangle != NO_TRIANGLE && drawn.triangle == receiver.triangle);
    if (counts && change != 0 && receiver.kind != RECEIVER_NONE) {
        atomicAdd(&layers[index], change);
    }
    // As in the draws of wedges: a driver must not take earlier fragments for hidden.
    discard;
}
