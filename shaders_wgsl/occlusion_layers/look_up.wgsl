// What of the light a receiver sees past all slices before it; and what hides it before the first of them.
//#import shared/slice.wgsl
//#import shared/triangle.wgsl
//#import shared/hierarchy.wgsl
//#import occlusion_layers/kernel.wgsl
//#import occlusion_layers/levels.wgsl

struct NearCounts {
    receivers: atomic<u32>,    // times parts that rays were traced for, in runs
    unfinished: atomic<u32>,   // rays that a driver's limit on loops cut short
}

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> light: Light;
@group(0) @binding(2) var<uniform> layer_frame: LayerFrame;
@group(0) @binding(3) var<uniform> light_parts: LightParts;
@group(0) @binding(4) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(5) var<storage, read> layer_places: LayerPlaces;
@group(0) @binding(6) var<storage, read> layer_tables: array<u32>;
@group(0) @binding(7) var<storage, read_write> visibility: array<f32>;
@group(0) @binding(8) var<storage, read_write> near_blocked: array<atomic<u32>>;
@group(0) @binding(9) var<storage, read> nodes: array<BvhNode>;
@group(0) @binding(10) var<storage, read> corners: array<Corner>;
@group(0) @binding(11) var<storage, read_write> near_counts: NearCounts;

// The sums along one row of the table, of the columns before x.x and x.y and the texels that hold them: whole numbers.
fn row_sums(base: u32, row: u32, stride: u32, columns: vec4<u32>) -> vec4<u32> {
    let at = base + row * stride;
    return vec4<u32>(
        layer_tables[at + columns.x], layer_tables[at + columns.y], layer_tables[at + columns.z], layer_tables[at + columns.w],
    );
}

// Share of the box that the slice hides: the exact mean of its texels, nothing being outside of them. Differences of whole numbers come first,
// so that nothing cancels: nine cells, of which those at the border weigh what the box has of them.
fn exact_share(layer: u32, box: vec4<f32>) -> f32 {
    let resolution = f32(layer_places.window.resolution);
    let stride = layer_places.window.resolution + 1u;
    let low = clamp(box.xy, vec2<f32>(0.0), vec2<f32>(resolution));
    let high = clamp(box.zw, vec2<f32>(0.0), vec2<f32>(resolution));
    let most = vec2<f32>(resolution - 1.0);
    let low_texel = min(floor(low), most);
    let high_texel = min(floor(high), most);
    let low_share = low - low_texel;
    let high_share = high - high_texel;
    let c0 = vec2<u32>(low_texel);
    let c1 = vec2<u32>(high_texel);
    let columns = vec4<u32>(c0.x, c0.x + 1u, c1.x, c1.x + 1u);
    let base = layer * stride * stride;
    let r0 = row_sums(base, c0.y, stride, columns);
    let r1 = row_sums(base, c0.y + 1u, stride, columns);
    let r2 = row_sums(base, c1.y, stride, columns);
    let r3 = row_sums(base, c1.y + 1u, stride, columns);
    // Between one column and the next, over the rows: the middle is negative where both ends lie in one texel.
    let weights = vec3<f32>(1.0 - low_share.x, 1.0, high_share.x);
    let top = row_cells(r1 - r0);
    let middle = row_cells(r2 - r1);
    let bottom = row_cells(r3 - r2);
    let sum = (1.0 - low_share.y) * dot(weights, top) + dot(weights, middle) + high_share.y * dot(weights, bottom);
    let size = box.zw - box.xy;
    return clamp(sum / (size.x * size.y), 0.0, 1.0);
}

fn row_cells(sums: vec4<u32>) -> vec3<f32> {
    return vec3<f32>(vec3<i32>(sums.yzw - sums.xyz));
}

// The mean over the 2^level texels around a place, between the four entries next to it.
fn level_mean(layer: u32, level: u32, middle: vec2<f32>) -> f32 {
    let is_nbuffer = layer_frame.filter_kind == FILTER_NBUFFER;
    let resolution = layer_places.window.resolution;
    let groups = (layer_frame.slices + 3u) / 4u;
    let side = level_side(is_nbuffer, resolution, level);
    let base = level_begin(is_nbuffer, resolution, groups, level) + layer / 4u * side * side;
    let size = f32(1u << level);
    let place = select(middle / size - 0.5, middle + 0.5 * size - 1.0, is_nbuffer);
    let bounded = clamp(place, vec2<f32>(-2.0), vec2<f32>(f32(side) + 1.0));
    let low = floor(bounded);
    let share = bounded - low;
    var sum = 0.0;
    for (var k = 0u; k < 4u; k++) {
        let at = vec2<i32>(low) + vec2<i32>(i32(k & 1u), i32(k >> 1u));
        let is_there = at.x >= 0 && at.y >= 0 && at.x < i32(side) && at.y < i32(side);
        let word = layer_tables[base + select(0u, u32(at.y) * side + u32(at.x), is_there)];
        let weights = select(1.0 - share, share, vec2<bool>((k & 1u) != 0u, (k >> 1u) != 0u));
        sum += select(0.0, unpack4x8unorm(word)[layer % 4u] * weights.x * weights.y, is_there);
    }
    return sum;
}

// As published: between the two levels next to the kernel's size. A kernel larger than all texels has what lies in all of them.
fn level_share(layer: u32, box: vec4<f32>) -> f32 {
    let size = box.zw - box.xy;
    let wanted = max(0.5 * log2(size.x * size.y), 0.0);
    let last = firstLeadingBit(layer_places.window.resolution);
    let level = min(u32(wanted), last - 1u);
    let middle = (box.xy + box.zw) * 0.5;
    let share = clamp(wanted - f32(level), 0.0, 1.0);
    let mean = mix(level_mean(layer, level, middle), level_mean(layer, level + 1u, middle), share);
    return mean * exp2(-2.0 * max(wanted - f32(last), 0.0));
}

// A loop of one step for each filter: software drivers skip a loop that no lane needs, and run both sides of a branch.
fn hidden_share(layer: u32, box: vec4<f32>) -> f32 {
    var share = 0.0;
    let is_exact = layer_frame.filter_kind == FILTER_SUMMED_AREA;
    for (var k = 0u; k < select(0u, 1u, is_exact); k++) {
        share = exact_share(layer, box);
    }
    for (var k = 0u; k < select(1u, 0u, is_exact); k++) {
        share = level_share(layer, box);
    }
    return share;
}

// Hidden shares put together, from 0 hidden on: what is visible, or hidden, so far.
fn combined(before: f32, share: f32) -> f32 {
    switch light_parts.combine {
        case COMBINE_MAXIMUM: { return min(before, 1.0 - share); }
        case COMBINE_SUM: { return before - share; }
        default: { return before * (1.0 - share); }
    }
}

// Slices before a depth, and the weight of the last of them: it fades in from its own plane to the next, so that nothing jumps. Who stands
// behind all casters sees all slices as they are.
struct SlicesBefore {
    count: u32,
    last_weight: f32,
    is_behind_all: bool,
}

fn slices_before(depth: f32) -> SlicesBefore {
    var low = 0u;
    var high = layer_places.window.slices;
    while (low < high) {
        let middle = (low + high) / 2u;
        if (layer_places.planes[middle] < depth) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    var before = SlicesBefore(low, 1.0, false);
    if (layer_places.window.slices > 0u) {
        let last = layer_places.planes[layer_places.window.slices - 1u];
        // A hair before the last plane is behind it, where a receiver was lifted off what touches the casters.
        if (depth >= last - 1e-5 * (1.0 + abs(last))) {
            before.count = layer_places.window.slices;
            before.is_behind_all = true;
        } else if (low > 0u) {
            let plane = layer_places.planes[low - 1u];
            before.last_weight = clamp((depth - plane) / max(layer_places.planes[low] - plane, 1e-30), 0.0, 1.0);
        }
    }
    return before;
}

// As above where rays find what is near. They pass the receiver's own slice and the one before it, whose casters were moved next to the
// receiver, where the surface that it stands on goes on.
fn slices_beyond_rays(depth: f32) -> SlicesBefore {
    var before = slices_before(depth);
    before.last_weight = 1.0;
    before.count -= select(1u, 0u, before.is_behind_all || before.count == 0u);
    return before;
}

// The slices that hide any of the light at all from a receiver, a bit each; or all of it.
struct Hiding {
    slices: vec4<u32>,
    is_dark: bool,
}

// Looked up a texel around the whole light, so that no part of it sees what is not found here.
fn hiding_slices(view: LayerView, before: SlicesBefore) -> Hiding {
    var hiding = Hiding(vec4<u32>(0u), false);
    for (var layer = 0u; layer < before.count; layer++) {
        let box = kernel_box(view, layer_places.window, light_parts.whole, layer_places.planes[layer]) + vec4<f32>(-1.0, -1.0, 1.0, 1.0);
        let share = hidden_share(layer, box);
        hiding.slices[layer / 32u] |= select(0u, 1u << (layer % 32u), share > 0.0);
        let is_full = share > 0.999999 && (layer + 1u < before.count || before.last_weight >= 1.0);
        hiding.is_dark = hiding.is_dark || is_full;
    }
    return hiding;
}

// What a part of the light shows past all slices that hide any of it.
fn visible_share(view: LayerView, before: SlicesBefore, part: vec4<f32>, slices: vec4<u32>) -> f32 {
    var visible = 1.0;
    for (var word = 0u; word < 4u; word++) {
        var left = slices[word];
        while (left != 0u) {
            let layer = 32u * word + firstTrailingBit(left);
            left &= left - 1u;
            let box = kernel_box(view, layer_places.window, part, layer_places.planes[layer]);
            let weight = select(1.0, before.last_weight, layer + 1u == before.count);
            visible = combined(visible, weight * hidden_share(layer, box));
        }
    }
    return max(visible, 0.0);
}

fn view_of(index: u32) -> LayerView {
    return layer_view(layer_frame, layer_places.window.inverse_distance, receivers[index].position);
}

fn values_of(index: u32, view: LayerView, before: SlicesBefore, blocked: vec2<u32>) -> vec3<f32> {
    let receiver = receivers[index];
    let seen = light_view(light, receiver.position);
    var values = vec3<f32>(select(0.0, 1.0, seen.inside));
    if (receiver.kind != RECEIVER_NONE && seen.exists && !seen.inside) {
        let hiding = hiding_slices(view, before);
        for (var k = 0u; k < select(light_parts.count, 0u, hiding.is_dark); k++) {
            let part = light_parts.boxes[k];
            let is_blocked = (blocked[k / 32u] & (1u << (k % 32u))) != 0u;
            let above = select(horizon_share(layer_frame, receiver, view, part), 0.0, is_blocked);
            let asked = select(vec4<u32>(0u), hiding.slices, above > 0.0);
            values += light_parts.weights[k].xyz * (above * visible_share(view, before, part, asked));
        }
        values = clamp(values, vec3<f32>(0.0), vec3<f32>(1.0));
    }
    return values;
}

fn store(index: u32, values: vec3<f32>) {
    for (var channel = 0u; channel < light_parts.channels; channel++) {
        visibility[index * light_parts.channels + channel] = values[channel];
    }
}

@compute @workgroup_size(64)
fn look_up(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x < slice.count) {
        let index = slice.first + invocation.x;
        let view = view_of(index);
        store(index, values_of(index, view, slices_before(view.at.z), vec2<u32>(0u)));
    }
}

// As `look_up`, where short rays say what hides the light before the first slice.
@compute @workgroup_size(64)
fn look_up_beyond(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x < slice.count) {
        let index = slice.first + invocation.x;
        let view = view_of(index);
        let blocked = vec2<u32>(atomicLoad(&near_blocked[2u * index]), atomicLoad(&near_blocked[2u * index + 1u]));
        store(index, values_of(index, view, slices_beyond_rays(view.at.z), blocked));
    }
}

// Rays of one invocation, and steps of one ray: Mesa's software driver ends every loop after 65,535 steps in all, without a word.
const RAYS: u32 = 8u;
const LONGEST_WALK: u32 = 4096u;

// Longer than any way through a scene, whose coordinates lie in [-1, 1].
const ACROSS: f32 = 4.0;

fn is_near_blocked(receiver: Receiver, way: vec3<f32>) -> bool {
    let inverse = safe_reciprocal(way);
    let pad = vec3<f32>(box_pad(receiver.position));
    let to_low = (-receiver.position - pad) * inverse;
    let to_high = (-receiver.position + pad) * inverse;
    let rising = inverse >= vec3<f32>(0.0);
    let end = arrayLength(&nodes);
    var node = 0u;
    var steps = 0u;
    var hit = false;
    while (node < end && steps < LONGEST_WALK && !hit) {
        let box = nodes[node];
        let near = select(box.high * inverse + to_high, box.low * inverse + to_low, rising);
        let far = select(box.low * inverse + to_low, box.high * inverse + to_high, rising);
        let enter = max(max(near.x, near.y), max(near.z, 0.0));
        let leave = min(min(far.x, far.y), min(far.z, 1.0));
        let met = enter <= leave;
        node = select(box.skip, node + 1u, met && box.leaf == 0u);
        let first = box.leaf >> LEAF_BITS;
        let count = select(0u, box.leaf & ((1u << LEAF_BITS) - 1u), met);
        for (var k = first; k < first + count; k++) {
            let a = corners[3u * k];
            let blocks = triangle_blocks(
                a.position, corners[3u * k + 1u].position, corners[3u * k + 2u].position, receiver.position, way, false,
            );
            hit = hit || (blocks && a.triangle != receiver.triangle);
        }
        steps++;
    }
    if (node < end && !hit) {
        atomicAdd(&near_counts.unfinished, 1u);
    }
    return hit;
}

@compute @workgroup_size(64)
fn trace_near(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let runs = (light_parts.count + RAYS - 1u) / RAYS;
    let item = slice.first + invocation.x;
    let index = item / runs;
    let receiver = receivers[index];
    let seen = light_view(light, receiver.position);
    let view = view_of(index);
    let before = slices_beyond_rays(view.at.z);
    let is_asked = receiver.kind != RECEIVER_NONE && seen.exists && !seen.inside && !before.is_behind_all && layer_places.window.slices > 0u;
    let first = item % runs * RAYS;
    let end = select(first, min(first + RAYS, light_parts.count), is_asked);
    // The share of the way to the light at which the slices begin.
    var share = 1.0;
    if (before.count > 0u) {
        let projected_depth = layer_places.planes[before.count - 1u];
        let depth = projected_depth / (1.0 - projected_depth * layer_places.window.inverse_distance);
        let own = dot(layer_frame.row_z, receiver.position - layer_frame.origin);
        share = select((own - depth) / max(own, 1e-30), own - depth, view.is_sun);
    } else if (view.is_sun) {
        share = ACROSS;
    }
    var mask = 0u;
    for (var k = first; k < end; k++) {
        let part = light_parts.boxes[k];
        let way = way_to(layer_frame, receiver, view, part.xy) * share;
        if (horizon_share(layer_frame, receiver, view, part) > 0.0 && is_near_blocked(receiver, way)) {
            mask |= 1u << (k % 32u);
        }
    }
    if (end > first) {
        atomicAdd(&near_counts.receivers, 1u);
    }
    if (mask != 0u) {
        atomicOr(&near_blocked[2u * index + first / 32u], mask);
    }
}
