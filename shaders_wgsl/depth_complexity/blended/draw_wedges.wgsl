// Draws the wedges of silhouette edges: what each edge changes at the receiver of every pixel that its wedge covers.
//
// The hull only finds the pixels. What changes, and for which samples, is decided by the predicates of the tiled path at the receiver
// itself, so a wide hull costs fragments and no bit. Only those triangles of a hull are drawn that the eye sees from within: each ray of
// the eye leaves the hull through one of them, also from inside the wedge, and corners at infinity need no far plane.
//
// Corners are drawn to a part of a pixel, and thin triangles may fold over: then a pixel has two fragments of one facing and one of the
// other. What faces the other way counts backwards, so that an edge always counts once.
//#import shared/receiver.wgsl
//#import depth_complexity/sides.wgsl
//#import depth_complexity/coverage.wgsl
//#import depth_complexity/blended/hull.wgsl
//#import depth_complexity/blended/packing.wgsl

@group(0) @binding(0) var<uniform> light_frame: LightFrame;
@group(0) @binding(1) var<uniform> wedge_view: WedgeView;
@group(0) @binding(2) var<storage, read> wedges: array<u32>;
@group(0) @binding(3) var<storage, read> edges: array<OccluderEdge>;
@group(0) @binding(4) var<storage, read> incident_faces: array<IncidentFace>;
@group(0) @binding(5) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(6) var<storage, read_write> changes: array<Changes>;
@group(0) @binding(7) var<uniform> frame_samples: FrameSamples;
@group(0) @binding(8) var<uniform> packing: Packing;
@group(0) @binding(9) var<storage, read_write> words: array<atomic<u32>>;

// By how much the counters of a receiver can rise and fall at most.
struct Changes {
    rise: atomic<u32>,
    fall: atomic<u32>,
}

struct Drawn {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) plane: vec4<f32>,
    @location(1) @interpolate(flat) edge: u32,
}

fn clip_of(corner: HullCorner) -> vec4<f32> {
    let p = corner.place - wedge_view.eye * corner.weight;
    let w = dot(wedge_view.forward, p);
    // Depths decide nothing: half way is within the clip space of every interface.
    return vec4<f32>(dot(wedge_view.clip_x, p), dot(wedge_view.clip_y, p), 0.5 * w, w);
}

@vertex
fn extrude(@builtin(vertex_index) index: u32) -> Drawn {
    let corner = index % 3u;
    let triangle = (index / 3u) % WEDGE_TRIANGLES;
    let edge = wedges[index / (3u * WEDGE_TRIANGLES)];
    let hull = hull_of(light_frame, wedge_view, edges[edge].low, edges[edge].high);
    if (!hull.bounded) {
        // One triangle over the whole image; the others have no area.
        let whole = vec2<f32>(select(-1.0, 3.0, corner == 2u), select(-1.0, 3.0, corner == 1u));
        return Drawn(vec4<f32>(select(vec2<f32>(0.0), whole, triangle == 0u), 0.5, 1.0), vec4<f32>(0.0, 0.0, 0.0, 1.0), edge);
    }
    let plane = hull_plane(hull, triangle);
    let is_seen_from_within = dot(plane.xyz, wedge_view.eye) < plane.w;
    let clip = clip_of(hull_corner(hull, triangle, corner));
    return Drawn(select(vec4<f32>(0.0, 0.0, 0.0, 1.0), clip, is_seen_from_within), plane, edge);
}

// D left of the edge minus D right of it.
fn weight(view: FrameView, edge: OccluderEdge, triangle: u32) -> i32 {
    var sum = 0;
    for (var k = 0u; k < edge.incidence_count; k++) {
        let face = incident_faces[edge.first_incidence + k];
        let left = weighing_side(light_frame, view, face);
        sum += select(left, 0, (face.reference >> 1u) == triangle);
    }
    return sum;
}

// What an edge changes at a receiver, and where.
struct Event {
    receiver: u32,
    change: i32,
    view: FrameView,
    crossing: Crossing,
}

fn event_at(drawn: Drawn, faces_eye: bool) -> Event {
    let pixel = vec2<u32>(drawn.clip.xy);
    let index = min(pixel.y * wedge_view.width + pixel.x, wedge_view.receiver_count - 1u);
    let receiver = receivers[index];
    let is_before_exit = dot(drawn.plane.xyz, receiver.position) < drawn.plane.w;
    var event: Event;
    event.receiver = index;
    event.change = 0;
    // A loop of one step: software drivers skip a loop that no lane needs, and run both sides of a branch.
    for (var k = 0u; k < select(0u, 1u, is_before_exit && receiver.kind != RECEIVER_NONE); k++) {
        let view = frame_view(light_frame, receiver.position);
        let edge = edges[drawn.edge];
        let image = before_limit(view, edge, edge_image(view, edge));
        if (view.exists && image_matters(light_frame, image)) {
            let change = weight(view, edge, receiver.triangle) * select(1, -1, image.left);
            event.change = select(change, -change, faces_eye);
            event.view = view;
            event.crossing = crossing_of(image);
        }
    }
    return event;
}

@fragment
fn bound_changes(drawn: Drawn, @builtin(front_facing) faces_eye: bool) -> @location(0) u32 {
    let event = event_at(drawn, faces_eye);
    if (event.change > 0) {
        atomicAdd(&changes[event.receiver].rise, u32(event.change));
    }
    if (event.change < 0) {
        atomicAdd(&changes[event.receiver].fall, u32(-event.change));
    }
    // There is nothing to draw. And it has to be said: where a later triangle covers a whole tile of pixels, Mesa's software driver (22.3)
    // takes earlier ones for hidden and leaves them out, buffer writes and all, unless their shader can discard.
    discard;
}

// Whether this draw counts the change.
fn is_counted(change: i32) -> bool {
    return change != 0 && (packing.batch == 0u || (packing.batch == 1u) == (change > 0));
}

// A one in the digit of every sample of a word that lies beyond the edge.
fn digits(event: Event, word: u32) -> u32 {
    var value = 0u;
    let first = lowest_sample(packing, word);
    for (var k = 0u; k < packing.fields; k++) {
        let sample = first + k;
        let at = min(packing.first_sample + sample, light_frame.sample_count - 1u);
        let s = placed_sample(light_frame, event.view, frame_samples.at[at].xy);
        let hit = sample < packing.sample_count && crosses(event.crossing, s);
        value |= select(0u, 1u << (k * packing.bits), hit);
    }
    return value;
}

@fragment
fn add_words(drawn: Drawn, @builtin(front_facing) faces_eye: bool) -> @location(0) u32 {
    let event = event_at(drawn, faces_eye);
    for (var word = 0u; word < select(0u, packing.words, is_counted(event.change)); word++) {
        let value = digits(event, word);
        if (value != 0u) {
            atomicAdd(&words[event.receiver * packing.words + word], u32(event.change) * value);
        }
    }
    discard;
}

// Four channels of one target. Exact: the largest sum of a receiver's digits lies below 2^24.
fn channels(event: Event, texel: u32) -> vec4<f32> {
    var sum = vec4<f32>(0.0);
    for (var k = 0u; k < select(0u, 4u, is_counted(event.change)); k++) {
        sum[k] = f32(event.change * i32(digits(event, 4u * texel + k)));
    }
    return sum;
}

@fragment
fn add_digits_1(drawn: Drawn, @builtin(front_facing) faces_eye: bool) -> @location(0) vec4<f32> {
    return channels(event_at(drawn, faces_eye), 0u);
}

struct Targets2 {
    @location(0) t0: vec4<f32>,
    @location(1) t1: vec4<f32>,
}

@fragment
fn add_digits_2(drawn: Drawn, @builtin(front_facing) faces_eye: bool) -> Targets2 {
    let event = event_at(drawn, faces_eye);
    return Targets2(channels(event, 0u), channels(event, 1u));
}

struct Targets3 {
    @location(0) t0: vec4<f32>,
    @location(1) t1: vec4<f32>,
    @location(2) t2: vec4<f32>,
}

@fragment
fn add_digits_3(drawn: Drawn, @builtin(front_facing) faces_eye: bool) -> Targets3 {
    let event = event_at(drawn, faces_eye);
    return Targets3(channels(event, 0u), channels(event, 1u), channels(event, 2u));
}

struct Targets4 {
    @location(0) t0: vec4<f32>,
    @location(1) t1: vec4<f32>,
    @location(2) t2: vec4<f32>,
    @location(3) t3: vec4<f32>,
}

@fragment
fn add_digits_4(drawn: Drawn, @builtin(front_facing) faces_eye: bool) -> Targets4 {
    let event = event_at(drawn, faces_eye);
    return Targets4(channels(event, 0u), channels(event, 1u), channels(event, 2u), channels(event, 3u));
}

struct Targets6 {
    @location(0) t0: vec4<f32>,
    @location(1) t1: vec4<f32>,
    @location(2) t2: vec4<f32>,
    @location(3) t3: vec4<f32>,
    @location(4) t4: vec4<f32>,
    @location(5) t5: vec4<f32>,
}

@fragment
fn add_digits_6(drawn: Drawn, @builtin(front_facing) faces_eye: bool) -> Targets6 {
    let event = event_at(drawn, faces_eye);
    return Targets6(
        channels(event, 0u), channels(event, 1u), channels(event, 2u), channels(event, 3u),
        channels(event, 4u), channels(event, 5u),
    );
}

struct Targets8 {
    @location(0) t0: vec4<f32>,
    @location(1) t1: vec4<f32>,
    @location(2) t2: vec4<f32>,
    @location(3) t3: vec4<f32>,
    @location(4) t4: vec4<f32>,
    @location(5) t5: vec4<f32>,
    @location(6) t6: vec4<f32>,
    @location(7) t7: vec4<f32>,
}

@fragment
fn add_digits_8(drawn: Drawn, @builtin(front_facing) faces_eye: bool) -> Targets8 {
    let event = event_at(drawn, faces_eye);
    return Targets8(
        channels(event, 0u), channels(event, 1u), channels(event, 2u), channels(event, 3u),
        channels(event, 4u), channels(event, 5u), channels(event, 6u), channels(event, 7u),
    );
}
