// Triangle by triangle: which samples each face hides from a receiver, 64 at a time, until all are hidden. For what has no surface to
// take silhouettes of.
//
// A receiver walks the hierarchy once for all its samples: what no sample lies behind that is still visible is passed by. A face hides a
// sample where it covers the reference point, unless the way from there to the sample crosses its border; every sign is the one that a
// fold of edges takes.
//
// Software drivers end long loops, so an invocation goes so far and the next round goes on from there.
//#import shared/slice.wgsl
//#import shared/receiver.wgsl
//#import depth_complexity/cover.wgsl
//#import depth_complexity/coverage.wgsl
//#import depth_complexity/sample_bins.wgsl
//#import depth_complexity/tiles.wgsl
//#import depth_complexity/tree.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> light_frame: LightFrame;
@group(0) @binding(2) var<uniform> group_samples: GroupSamples;
@group(0) @binding(3) var<uniform> sample_bins: SampleBins;
@group(0) @binding(4) var<uniform> cover_settings: CoverSettings;
@group(0) @binding(5) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(6) var<storage, read> faces: array<TwelveWords>;
@group(0) @binding(7) var<storage, read> face_corners: array<TwelveWords>;
@group(0) @binding(8) var<storage, read> face_tree: array<EightWords>;
@group(0) @binding(9) var<storage, read_write> slots: array<Slot>;
@group(0) @binding(10) var<storage, read_write> blocked: array<u32>;
@group(0) @binding(11) var<storage, read_write> counts: ListCounts;

struct GroupSamples {
    at: array<vec4<f32>, 64>,
}

struct CoverSettings {
    receiver_count: u32,
    group: u32,          // which 64 of a receiver's samples
    round: u32,
    rounds: u32,
}

// A driver that ends the loops of eight lanes after 65,535 steps together lets each of them take an eighth, less what one leaf can
// take: four faces of four sides, each with 64 samples.
const ROUND_STEPS: u32 = 7000u;

// What rounding can cost an image, as a share of the products before they cancel; with room to spare.
const SLACK: f32 = 4e-6;

// A receiver, and what its walk needs throughout.
struct Eye {
    view: FrameView,
    slack: vec3<f32>,
    offset: vec2<f32>,      // from bounds of images to where samples were before a sphere moved them,
    widest: f32,            // and how far they were moved at most
    triangle: u32,
}

fn eye_of(receiver: Receiver) -> Eye {
    let view = frame_view(light_frame, receiver.position);
    let root = node_of(face_tree[0]);
    let size = abs(receiver.position) + max(abs(root.low), abs(root.high));
    let slack = SLACK * vec3<f32>(dot(abs(view.x_row), size), dot(abs(view.y_row), size), dot(abs(view.z_row), size));
    let is_sphere = light_frame.kind == FRAME_SPHERE;
    let moves = is_sphere && view.cap > 0.0;
    let widest = select(1.0, view.tangent * inverseSqrt(2.0 * max(view.cap, 1e-37)), moves);
    return Eye(view, slack, select(vec2<f32>(0.0), light_frame.reference, is_sphere), widest, receiver.triangle);
}

// The samples that can lie within bounds.
fn samples_within(eye: Eye, bounds: ImageBounds) -> vec2<u32> {
    // Far beyond every sample, and far from where products of them would have no value.
    let low = max(bounds.low, vec2<f32>(-1e18)) + eye.offset;
    let high = min(bounds.high, vec2<f32>(1e18)) + eye.offset;
    let from_ = min(low, low * eye.widest) - sample_bins.low;
    let to = max(high, high * eye.widest) - sample_bins.low;
    let x = strips(from_.x, to.x, sample_bins.scale.x);
    let y = strips(from_.y, to.y, sample_bins.scale.y);
    let found = (sample_bins.before[x.y].xy & ~sample_bins.before[x.x].xy)
        & (sample_bins.before[y.y].zw & ~sample_bins.before[y.x].zw);
    return select(found, vec2<u32>(0u), bounds.beyond);
}

// The samples that can lie behind a box.
fn samples_behind_box(eye: Eye, box: TreeNode) -> vec2<u32> {
    let middle = (box.low + box.high) * 0.5;
    return samples_within(eye, bounds_of_box(light_frame, eye.view, middle, (box.high - box.low) * 0.5, eye.slack));
}

// Corners of a face in the order of its sides; a triangle comes back to its first.
struct Corners {
    a: vec3<f32>,
    b: vec3<f32>,
    c: vec3<f32>,
    d: vec3<f32>,
}

fn corners_of(words: TwelveWords) -> Corners {
    return Corners(
        bitcast<vec3<f32>>(words.first.xyz),
        bitcast<vec3<f32>>(vec3<u32>(words.first.w, words.second.xy)),
        bitcast<vec3<f32>>(vec3<u32>(words.second.zw, words.third.x)),
        bitcast<vec3<f32>>(words.third.yzw),
    );
}

// The samples that can lie behind a face.
fn samples_behind_face(eye: Eye, corners: Corners) -> vec2<u32> {
    let a = project(eye.view, corners.a - eye.view.position);
    let b = project(eye.view, corners.b - eye.view.position);
    let c = project(eye.view, corners.c - eye.view.position);
    let d = project(eye.view, corners.d - eye.view.position);
    return samples_within(eye, bounds_of_corners(light_frame, a, b, c, d, eye.slack));
}

fn one_bit(i: u32) -> vec2<u32> {
    let bit = 1u << (i & 31u);
    return select(vec2<u32>(bit, 0u), vec2<u32>(0u, bit), i >= 32u);
}

fn first_of(mask: vec2<u32>) -> u32 {
    return select(firstTrailingBit(mask.x), 32u + firstTrailingBit(mask.y), mask.x == 0u);
}

fn has_any(mask: vec2<u32>) -> bool {
    return (mask.x | mask.y) != 0u;
}

// Those samples on whose way from the reference point an edge lies.
fn crossed(eye: Eye, image: EdgeImage, samples: vec2<u32>, samples_move: bool) -> vec2<u32> {
    let crossing = crossing_of(image);
    var mask = vec2<u32>(0u);
    var waiting = select(vec2<u32>(0u), samples, image_matters(light_frame, image));
    while (has_any(waiting)) {
        let i = first_of(waiting);
        let bit = one_bit(i);
        waiting &= ~bit;
        var s = group_samples.at[i].xy;
        if (samples_move) {
            s = placed_sample(light_frame, eye.view, s);
        }
        mask |= select(vec2<u32>(0u), bit, crosses(crossing, s));
    }
    return mask;
}

// Whether loops still run.
fn has_steps_left() -> bool {
    var steps = 0u;
    for (var k = 0u; k < LAST_STEPS; k++) {
        // Read from a buffer, so that nobody can tell the number beforehand.
        steps += select(0u, 1u, face_tree[min(k, arrayLength(&face_tree) - 1u)].first.w != 0xffffffffu);
    }
    return steps == LAST_STEPS;
}

fn cover_samples(invocation: u32, samples_move: bool) {
    if (invocation >= slice.count) {
        return;
    }
    let item = slice.first + invocation;
    let groups = (cover_settings.receiver_count + 63u) / 64u;
    let at = scattered(item / 64u, groups) * 64u + item % 64u;
    if (at >= cover_settings.receiver_count) {
        return;
    }
    let slot = slots[at];
    let end = arrayLength(&face_tree);
    // Where the walk of the round before ended.
    var node = select(slot.part, 0u, cover_settings.round == 0u);
    if (slot.depth == NO_VIEW || node >= end) {
        return;
    }
    let eye = eye_of(receivers[slot.receiver]);
    let words = (light_frame.sample_count + 31u) / 32u;
    let first_word = slot.receiver * words + 2u * cover_settings.group;
    let has_second = 2u * cover_settings.group + 1u < words;
    let all = sample_bins.before[BINS].xy;
    var seen = all & ~vec2<u32>(blocked[first_word], blocked[first_word + select(0u, 1u, has_second)]);
    var steps = 0u;
    while (node < end && has_any(seen) && steps < ROUND_STEPS) {
        // Every loop takes a step to find its end.
        steps += 3u;
        var leaf = 0u;
        while (leaf == 0u && node < end && steps < ROUND_STEPS) {
            steps++;
            let box = node_of(face_tree[node]);
            let met = has_any(samples_behind_box(eye, box) & seen);
            leaf = select(0u, box.leaf, met);
            node = select(box.skip, node + 1u, met && box.leaf == 0u);
        }
        let first = leaf >> LEAF_BITS;
        let count = leaf & ((1u << LEAF_BITS) - 1u);
        for (var f = first; f < first + count; f++) {
            var corners = corners_of(face_corners[f]);
            let near = samples_behind_face(eye, corners) & seen;
            // Drivers on the CPU run both sides of a branch, and skip loops only.
            var waiting = has_any(near);
            steps += 2u + select(0u, 9u + 4u * (countOneBits(near.x) + countOneBits(near.y)), waiting);
            while (waiting) {
                waiting = false;
                let face = face_of(faces[f]);
                let side = side_of_plane(face.normal, face.point, face.flatness, eye.view.position);
                // One seen edge-on hides nothing, nor does the receiver's own.
                let hides = side != 0 && face.triangle != eye.triangle;
                var border = no_loop();
                var mask = vec2<u32>(0u);
                for (var k = 0u; k < select(0u, 4u, hides); k++) {
                    let reference = face.sides[k];
                    let is_forward = (reference & 1u) == 0u;
                    let edge = OccluderEdge(select(corners.b, corners.a, is_forward), 0u, select(corners.a, corners.b, is_forward), 0u);
                    let image = edge_image(eye.view, edge);
                    let exists = reference != NO_SIDE;
                    if (exists) {
                        border = with_image(border, image, is_forward);
                    }
                    mask ^= crossed(eye, before_limit(eye.view, edge, image), select(vec2<u32>(0u), near, exists), samples_move);
                    corners = Corners(corners.b, corners.c, corners.d, corners.a);
                }
                let covers = (cover(eye.view, face, border) & 1) != 0;
                seen &= ~select(vec2<u32>(0u), select(mask, ~mask, covers) & near, hides);
            }
        }
    }
    let hidden = all & ~seen;
    blocked[first_word] = hidden.x;
    if (has_second) {
        blocked[first_word + 1u] = hidden.y;
    }
    let is_done = node >= end || !has_any(seen);
    slots[at].part = select(node, end, is_done);
    if (!has_steps_left() || (!is_done && cover_settings.round + 1u == cover_settings.rounds)) {
        atomicAdd(&counts.unfinished, 1u);
    }
}

@compute @workgroup_size(64)
fn cover_faces(@builtin(global_invocation_id) invocation: vec3<u32>) {
    cover_samples(invocation.x, false);
}

// A sphere's samples move with the receiver.
@compute @workgroup_size(64)
fn cover_moving(@builtin(global_invocation_id) invocation: vec3<u32>) {
    cover_samples(invocation.x, true);
}
