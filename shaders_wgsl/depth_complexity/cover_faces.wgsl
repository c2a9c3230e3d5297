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
@group(0) @binding(7) var<storage, read> edges: array<EightWords>;
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
// take: four faces of four sides, each with 64 samples, and then some.
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
    let low = bounds.low + eye.offset;
    let high = bounds.high + eye.offset;
    let from_ = min(low, low * eye.widest) - sample_bins.low;
    let to = max(high, high * eye.widest) - sample_bins.low;
    let x = strips(from_.x, to.x, sample_bins.scale.x);
    let y = strips(from_.y, to.y, sample_bins.scale.y);
    let found = (sample_bins.before[x.y].xy & ~sample_bins.before[x.x].xy)
        & (sample_bins.before[y.y].zw & ~sample_bins.before[y.x].zw);
    let everywhere = select(found, vec2<u32>(0xffffffffu), !bounds.all_ahead);
    return select(vec2<u32>(0u), everywhere, bounds.any_ahead && all(bounds.beyond <= vec4<f32>(0.0)));
}

// The samples that can lie behind a box.
fn samples_behind_box(eye: Eye, box: TreeNode) -> vec2<u32> {
    let half = (box.high - box.low) * 0.5;
    let middle = project(eye.view, (box.low + box.high) * 0.5 - eye.view.position);
    let x = vec3<f32>(eye.view.x_row.x, eye.view.y_row.x, eye.view.z_row.x) * half.x;
    let y = vec3<f32>(eye.view.x_row.y, eye.view.y_row.y, eye.view.z_row.y) * half.y;
    let z = vec3<f32>(eye.view.x_row.z, eye.view.y_row.z, eye.view.z_row.z) * half.z;
    var bounds = bounds_with(light_frame, no_image(), middle - x - y - z, eye.slack);
    bounds = bounds_with(light_frame, bounds, middle + x - y - z, eye.slack);
    bounds = bounds_with(light_frame, bounds, middle - x + y - z, eye.slack);
    bounds = bounds_with(light_frame, bounds, middle + x + y - z, eye.slack);
    bounds = bounds_with(light_frame, bounds, middle - x - y + z, eye.slack);
    bounds = bounds_with(light_frame, bounds, middle + x - y + z, eye.slack);
    bounds = bounds_with(light_frame, bounds, middle - x + y + z, eye.slack);
    bounds = bounds_with(light_frame, bounds, middle + x + y + z, eye.slack);
    return samples_within(eye, bounds);
}

// The samples that can lie behind a face; none behind one seen edge-on, and behind the receiver's own. Two sides hold all corners.
fn samples_behind_face(eye: Eye, face: Face) -> vec2<u32> {
    let first = edge_of(edges[face.sides.x >> 1u]);
    let second = edge_of(edges[select(face.sides.z, face.sides.y, face.sides.w == NO_SIDE) >> 1u]);
    let p = eye.view.position;
    var bounds = bounds_with(light_frame, no_image(), project(eye.view, first.low - p), eye.slack);
    bounds = bounds_with(light_frame, bounds, project(eye.view, first.high - p), eye.slack);
    bounds = bounds_with(light_frame, bounds, project(eye.view, second.low - p), eye.slack);
    bounds = bounds_with(light_frame, bounds, project(eye.view, second.high - p), eye.slack);
    let side = side_of_plane(face.normal, face.point, face.flatness, p);
    return select(samples_within(eye, bounds), vec2<u32>(0u), side == 0 || face.triangle == eye.triangle);
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

// Those samples of `waiting` on whose way from the reference point an edge lies.
fn crossed(eye: Eye, image: EdgeImage, samples: vec2<u32>) -> vec2<u32> {
    let crossing = crossing_of(image);
    var mask = vec2<u32>(0u);
    var waiting = select(vec2<u32>(0u), samples, image_matters(light_frame, image));
    while (has_any(waiting)) {
        let i = first_of(waiting);
        let bit = one_bit(i);
        waiting &= ~bit;
        let s = placed_sample(light_frame, eye.view, group_samples.at[i].xy);
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

@compute @workgroup_size(64)
fn cover_faces(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let item = slice.first + invocation.x;
    let groups = (cover_settings.receiver_count + 63u) / 64u;
    let at = scattered(item / 64u, groups) * 64u + item % 64u;
    if (at >= cover_settings.receiver_count) {
        return;
    }
    let slot = slots[at];
    let end = arrayLength(&face_tree);
    // Where the walk of the round before ended.
    var node = select(slot.reached, 0u, cover_settings.round == 0u);
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
            let face = face_of(faces[f]);
            let near = samples_behind_face(eye, face) & seen;
            // Drivers on the CPU run both sides of a branch, and skip loops only.
            var k = select(4u, 0u, has_any(near));
            steps += 2u + select(0u, 8u + 4u * (countOneBits(near.x) + countOneBits(near.y)), k == 0u);
            var border = no_loop();
            var mask = vec2<u32>(0u);
            while (k < 4u) {
                let reference = face.sides[k];
                k++;
                if (reference != NO_SIDE) {
                    let edge = edge_of(edges[reference >> 1u]);
                    let image = edge_image(eye.view, edge);
                    border = with_image(border, image, (reference & 1u) == 0u);
                    mask ^= crossed(eye, before_limit(eye.view, edge, image), near);
                }
            }
            let covers = (cover(eye.view, face, border) & 1) != 0;
            seen &= ~(select(mask, ~mask, covers) & near);
        }
    }
    let hidden = all & ~seen;
    blocked[first_word] = hidden.x;
    if (has_second) {
        blocked[first_word + 1u] = hidden.y;
    }
    let is_done = node >= end || !has_any(seen);
    slots[at].reached = select(node, end, is_done);
    if (!has_steps_left() || (!is_done && cover_settings.round + 1u == cover_settings.rounds)) {
        atomicAdd(&counts.unfinished, 1u);
    }
}
