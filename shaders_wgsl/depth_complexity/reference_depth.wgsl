// Counts the layers over the reference point by the signs with which the edges count, as far as the driver takes them alike in two
// kernels: the reference point is displaced so that nearly none is close. The twin of `depth_of_reference.rs`.
//
// Where no face lies between a bundle of receivers and the reference point there is nothing to count. Where the reference point is hidden, all samples
// are, until a fold of edges says otherwise.
//#import shared/slice.wgsl
//#import shared/receiver.wgsl
//#import depth_complexity/cover.wgsl
//#import depth_complexity/clusters.wgsl
//#import depth_complexity/tiles.wgsl
//#import depth_complexity/walk.wgsl
//#import depth_complexity/attenuation.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> light_frame: LightFrame;
@group(0) @binding(2) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(3) var<storage, read> faces: array<TwelveWords>;
@group(0) @binding(4) var<storage, read> edges: array<EightWords>;
@group(0) @binding(5) var<storage, read> first_faces: array<u32>;
@group(0) @binding(6) var<storage, read> lists: array<u32>;
@group(0) @binding(7) var<storage, read_write> slots: array<Slot>;
@group(0) @binding(8) var<storage, read_write> blocked: array<u32>;
@group(0) @binding(10) var<uniform> cluster_range: ClusterRange;
@group(0) @binding(9) var<storage, read_write> counts: ListCounts;
@group(0) @binding(11) var<storage, read> triangle_attenuation: array<u32>;

// Rounding, with room to spare.
const SLACK: f32 = 4e-6;

fn with_side(before: Loop, view: FrameView, reference: u32) -> Loop {
    var border = before;
    if (reference != NO_SIDE) {
        border = with_image(border, edge_image(view, edge_of(edges[reference >> 1u])), (reference & 1u) == 0u);
    }
    return border;
}

// Side by side without a loop: drivers on the CPU count steps.
fn cover_of(view: FrameView, face: Face) -> i32 {
    var border = with_side(no_loop(), view, face.sides.x);
    border = with_side(border, view, face.sides.y);
    border = with_side(border, view, face.sides.z);
    border = with_side(border, view, face.sides.w);
    return cover(view, face, border);
}

// Whether the way to the reference point leads off a face's plane, by more than rounding could turn it: then it does not meet the face.
fn turns_away(view: FrameView, face: Face) -> bool {
    let height = dot(face.normal, view.position - face.point);
    let slope = dot(face.normal, view.way);
    let size = dot(abs(face.normal), 1.0 + abs(view.position) + abs(face.point));
    let margin = SLACK * size;
    let turn = SLACK * dot(abs(face.normal), abs(view.way));
    return ((height > margin) & (slope > turn)) | ((height < -margin) & (slope < -turn));
}

// The bit of an entry of a chunk whose face may cover the reference point. Four at a step of a loop: drivers on the CPU count steps.
fn may_cover(view: FrameView, triangle: u32, here: u32, k: u32, end: u32) -> u32 {
    let face = face_of(faces[lists[here + 2u + min(k, end - 1u)]]);
    return select(0u, 1u << (k & 31u), (k < end) & (face.triangle != triangle) & !turns_away(view, face));
}

// The entries of a chunk whose faces may. Drivers on the CPU run both sides of a branch, and skip loops only: so who tests them goes over
// these bits.
fn candidates(view: FrameView, triangle: u32, here: u32, end: u32) -> u32 {
    var found = 0u;
    for (var k = 0u; k < end; k += 4u) {
        found |= may_cover(view, triangle, here, k, end) | may_cover(view, triangle, here, k + 1u, end)
            | may_cover(view, triangle, here, k + 2u, end) | may_cover(view, triangle, here, k + 3u, end);
    }
    return found;
}

// Whether loops still run.
fn has_steps_left() -> bool {
    var steps = 0u;
    for (var k = 0u; k < LAST_STEPS; k++) {
        // Read from a buffer, so that nobody can tell the number beforehand.
        steps += select(0u, 1u, lists[min(k, arrayLength(&lists) - 1u)] != 0xffffffffu);
    }
    return steps == LAST_STEPS;
}

@compute @workgroup_size(64)
fn reference_depth(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let item = slice.first + invocation.x;
    let tile_count = cluster_range.tile_count;
    let tile = scattered(item / TILE, tile_count);
    let at = tile * TILE + item % TILE;
    if (at >= cluster_range.receiver_count) {
        return;
    }
    let slot = slots[at];
    let bundle = (2u * tile + slot.part) * BUNDLES + (at % TILE) / BUNDLE;
    var chunk = select(first_faces[bundle], 0u, slot.depth == NO_VIEW);
    if (chunk == 0u) {
        return;
    }
    let receiver = receivers[slot.receiver];
    let view = frame_view(light_frame, receiver.position);
    let base = first_chunk_word(tile_count);
    var depth = 0;
    var steps = 0u;
    while (chunk != 0u && steps < MOST_STEPS) {
        let here = base + chunk * CHUNK;
        let end = lists[here + 1u];
        var waiting = candidates(view, receiver.triangle, here, end);
        steps += end / 4u + 2u + countOneBits(waiting);
        while (waiting != 0u) {
            depth += cover_of(view, face_of(faces[lists[here + 2u + firstTrailingBit(waiting)]]));
            waiting &= waiting - 1u;
        }
        chunk = lists[here];
    }
    if (chunk != 0u || !has_steps_left()) {
        atomicAdd(&counts.unfinished, 1u);
    }
    slots[at].depth = depth;
    let words = (light_frame.sample_count + 31u) / 32u;
    for (var word = 0u; word < select(0u, words, depth != 0); word++) {
        blocked[slot.receiver * words + word] = 0xffffffffu;
    }
}

// As `reference_depth`, of opaque and semi-opaque faces apart; what that makes of the samples is another pass.
@compute @workgroup_size(64)
fn reference_depth_attenuated(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let item = slice.first + invocation.x;
    let tile_count = cluster_range.tile_count;
    let tile = scattered(item / TILE, tile_count);
    let at = tile * TILE + item % TILE;
    if (at >= cluster_range.receiver_count) {
        return;
    }
    let slot = slots[at];
    let bundle = (2u * tile + slot.part) * BUNDLES + (at % TILE) / BUNDLE;
    var chunk = select(first_faces[bundle], 0u, slot.depth == NO_VIEW);
    if (chunk == 0u) {
        return;
    }
    let receiver = receivers[slot.receiver];
    let view = frame_view(light_frame, receiver.position);
    let base = first_chunk_word(tile_count);
    var depth = 0;
    var attenuation = 0;
    var most = 0u;
    var steps = 0u;
    while (chunk != 0u && steps < MOST_STEPS) {
        let here = base + chunk * CHUNK;
        let end = lists[here + 1u];
        var waiting = candidates(view, receiver.triangle, here, end);
        steps += end / 4u + 2u + countOneBits(waiting);
        while (waiting != 0u) {
            let face = face_of(faces[lists[here + 2u + firstTrailingBit(waiting)]]);
            let units = triangle_attenuation[face.triangle];
            let times = cover_of(view, face);
            depth += select(0, times, units == OPAQUE);
            if (units != OPAQUE && times != 0 && most <= LARGEST_ATTENUATION) {
                attenuation += times * i32(units);
                most += units;
            }
            waiting &= waiting - 1u;
        }
        chunk = lists[here];
    }
    if (chunk != 0u || !has_steps_left()) {
        atomicAdd(&counts.unfinished, 1u);
    }
    if (most > LARGEST_ATTENUATION) {
        atomicAdd(&counts.overflowed, 1u);
    }
    slots[at].depth = depth;
    slots[at].attenuation = attenuation;
}
