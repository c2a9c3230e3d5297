// Counts the layers over the reference point by the signs with which the edges count, as far as the driver takes them alike in two
// kernels: the reference point is displaced so that nearly none is close. The twin of `depth_of_reference.rs`.
//
// Where no face lies between a bundle of receivers and the reference point there is nothing to count. Where the reference point is hidden, all samples
// are, until a fold of edges says otherwise.
//#import shared/slice.wgsl
//#import shared/receiver.wgsl
//#import depth_complexity/edge.wgsl
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

// Two directions with a smaller sine between them are one, or opposite.
const NO_TURN: f32 = 1e-6;

// How often a face covers the reference point: its side times how often the loop of its edges' images turns around that point. The twin
// of `Loop` in `depth_of_reference.rs`.
fn cover(view: FrameView, face: Face) -> i32 {
    var has_left = false;
    var has_right = false;
    var has_wide = false;
    var leaves = false;
    var returns = false;
    var outward = vec2<f32>(0.0);
    var homeward = vec2<f32>(0.0);
    for (var k = 0u; k < 4u; k++) {
        let reference = face.sides[k];
        if (reference != NO_SIDE) {
            let image = edge_image(view, edge_of(edges[reference >> 1u]));
            let low_is_ahead = image.low.z > 0.0;
            let high_is_ahead = image.high.z > 0.0;
            if (low_is_ahead || high_is_ahead) {
                let is_forward = (reference & 1u) == 0u;
                let low = low_direction(image);
                let high = high_direction(image);
                let is_left = image.left == is_forward;
                has_left = has_left || is_left;
                has_right = has_right || !is_left;
                has_wide = has_wide || dot(low, high) < 0.0;
                let infinite = select(low, high, low_is_ahead);
                let goes_out = low_is_ahead == is_forward;
                if (low_is_ahead != high_is_ahead) {
                    outward = select(outward, infinite, goes_out);
                    homeward = select(infinite, homeward, goes_out);
                    leaves = leaves || goes_out;
                    returns = returns || !goes_out;
                }
            }
        }
    }
    let side = side_of_plane(face.normal, face.point, face.flatness, view.position);
    let all_left = has_left && !has_right;
    let all_right = has_right && !has_left;
    let either = select(select(0, -1, all_right), 1, all_left);
    var turns = either;
    if (leaves && returns) {
        let across = outward.x * homeward.y - outward.y * homeward.x;
        let arc = select(-1, 1, across >= 0.0);
        let if_all_arc = select(0, arc, either == arc);
        let half_turn = select(select(side, 0, either == -side), if_all_arc, arc == side);
        let no_length = select(0, either, has_wide);
        let clear = abs(across) > NO_TURN * length(outward) * length(homeward);
        turns = select(select(half_turn, no_length, dot(outward, homeward) > 0.0), if_all_arc, clear);
    }
    var before = true;
    if (view.limited) {
        // height / slope · dot(towards, way) < limit, without dividing.
        let height = dot(face.normal, face.point - view.position);
        let slope = dot(face.normal, view.way);
        before = height * sign(slope) * dot(view.towards, view.way) < view.limit * abs(slope);
    }
    return select(0, side * turns, before);
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
        // Drivers on the CPU run both sides of a branch, and skip loops only.
        var waiting = 0u;
        for (var k = 0u; k < end; k++) {
            let face = face_of(faces[lists[here + 2u + k]]);
            waiting |= select(0u, 1u << k, (face.triangle != receiver.triangle) & !turns_away(view, face));
        }
        steps += 2u * end + 5u * countOneBits(waiting);
        while (waiting != 0u) {
            depth += cover(view, face_of(faces[lists[here + 2u + firstTrailingBit(waiting)]]));
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
        // Drivers on the CPU run both sides of a branch, and skip loops only.
        var waiting = 0u;
        for (var k = 0u; k < end; k++) {
            let face = face_of(faces[lists[here + 2u + k]]);
            waiting |= select(0u, 1u << k, (face.triangle != receiver.triangle) & !turns_away(view, face));
        }
        steps += 2u * end + 5u * countOneBits(waiting);
        while (waiting != 0u) {
            let face = face_of(faces[lists[here + 2u + firstTrailingBit(waiting)]]);
            let units = triangle_attenuation[face.triangle];
            let times = cover(view, face);
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
