// Folds the silhouette edges of a part of a tile into the counters of its receivers, 64 samples at a time: D(s) is D(c) less what
// changes at every edge on the way. Where a single depth hides the light, the area beyond the edges answers instead of the samples.
//#import shared/receiver.wgsl
//#import depth_complexity/edge.wgsl
//#import depth_complexity/horizon.wgsl
//#import depth_complexity/counters.wgsl
//#import depth_complexity/attenuation.wgsl
//#import depth_complexity/area.wgsl
//#import depth_complexity/tiles.wgsl
//#import depth_complexity/walk.wgsl

@group(0) @binding(0) var<uniform> light_frame: LightFrame;
@group(0) @binding(1) var<uniform> frame_samples: FrameSamples;
@group(0) @binding(2) var<uniform> fold_settings: FoldSettings;
@group(0) @binding(3) var<uniform> outline: Outline;
@group(0) @binding(4) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(5) var<storage, read> edges: array<OccluderEdge>;
@group(0) @binding(6) var<storage, read> incident_faces: array<IncidentFace>;
@group(0) @binding(7) var<storage, read> slots: array<Slot>;
@group(0) @binding(8) var<storage, read_write> blocked: array<u32>;
@group(0) @binding(9) var<storage, read> lists: array<u32>;
@group(0) @binding(11) var<storage, read_write> counts: ListCounts;
@group(0) @binding(10) var<storage, read_write> areas: array<f32>;
@group(0) @binding(12) var<uniform> attenuation_scale: AttenuationScale;
@group(0) @binding(13) var<storage, read> triangle_attenuation: array<u32>;
@group(0) @binding(14) var<storage, read_write> sample_transmittance: array<f32>;

struct Outline {
    corners: array<vec4<f32>, 64>,
}

struct FoldSettings {
    slot_count: u32,
    wants_area: u32,
    sampling_bound: f32,    // an area farther from the samples' share is not believed
    tile_count: u32,
}

// A list that is longer than this many steps is given up, and counted.
const MOST_STEPS: u32 = 60000u;

// Layers of which areas are believed: far below where counters or sums of areas wrap.
const MOST_AREA_LAYERS: u32 = 127u;

// Areas are summed in this fixed point, so that the order of edges changes no bit.
const AREA_UNITS: f32 = 4194304.0;

// What the edges of one receiver add up to.
struct Sums {
    counters: Counters,
    area: i32,
    changes: u32,           // by how much D can have changed at most
    smallest: u32,          // change of any edge
}

// D left of the edge minus D right of it.
fn weight(view: FrameView, edge: OccluderEdge, triangle: u32) -> i32 {
    var sum = 0;
    for (var k = 0u; k < edge.incidence_count; k++) {
        let face = incident_faces[edge.first_incidence + k];
        let left = turned(side_of_plane(face.normal, face.point, face.flatness, view.position), face);
        sum += select(left, 0, (face.reference >> 1u) == triangle);
    }
    return sum;
}

fn area_beyond(image: EdgeImage) -> f32 {
    let low = low_direction(image);
    let high = high_direction(image);
    let line = select(-image.line, image.line, line_left(image, low, high));
    let from_direction = select(high, low, image.left);
    let to_direction = select(low, high, image.left);
    if (light_frame.outline_count == 0u) {
        return area_beyond_arc(line, from_direction, to_direction, -light_frame.reference);
    }
    var sum = 0.0;
    var before = outline.corners[light_frame.outline_count - 1u].xy;
    for (var k = 0u; k < light_frame.outline_count; k++) {
        let corner = outline.corners[k].xy;
        sum += area_beyond_side(line, from_direction, to_direction, before, corner);
        before = corner;
    }
    return sum;
}

fn folded(before: Sums, image: EdgeImage, change: i32, mask: vec2<u32>, wants_area: bool) -> Sums {
    var sums = before;
    sums.counters = counters_change(sums.counters, mask, change);
    sums.changes += most_change(change);
    sums.smallest = min(sums.smallest, u32(abs(change)));
    if (wants_area) {
        let beyond = area_beyond(image);
        sums.area += i32(round(beyond * AREA_UNITS)) * change;
    }
    return sums;
}

fn begin_fold(depth: i32) -> Sums {
    return Sums(counters_at(depth), 0, u32(abs(depth)), 0xffffu);
}

// The visible share of the area; negative where samples have to answer.
fn visible_area(sums: Sums, depth: i32, hidden_samples: vec2<u32>, sampled: f32) -> f32 {
    let nothing_hidden = (hidden_samples.x | hidden_samples.y) == 0u;
    let single = counters_single_value(sums.counters, hidden_samples);
    let layers = select(single, sums.smallest, nothing_hidden);
    let agrees = layers > 0u && layers <= MOST_AREA_LAYERS && (depth == 0 || depth == i32(layers));
    let total = f32(depth) * light_frame.area + f32(sums.area) / AREA_UNITS;
    let visible = 1.0 - total / (f32(max(layers, 1u)) * light_frame.area);
    let believed = agrees && abs(visible - sampled) <= fold_settings.sampling_bound;
    return select(-1.0, clamp(visible, 0.0, 1.0), believed);
}

// The samples of a group of 64 that exist.
fn existing(samples: u32) -> vec2<u32> {
    let low = min(samples, 32u);
    let high = min(max(samples, 32u) - 32u, 32u);
    return vec2<u32>(
        select(0u, 0xffffffffu >> (32u - max(low, 1u)), low > 0u),
        select(0u, 0xffffffffu >> (32u - max(high, 1u)), high > 0u),
    );
}

// Samples of the group below the receiver's horizon.
fn below_horizon(view: FrameView, slope: vec3<f32>, first: u32, count: u32) -> vec2<u32> {
    var mask = vec2<u32>(0u);
    for (var k = 0u; k < count; k++) {
        let s = placed_sample(light_frame, view, frame_samples.at[first + k].xy);
        let below = select(0u, 1u << (k & 31u), slope.z + slope.x * s.x + slope.y * s.y <= 0.0);
        mask |= select(vec2<u32>(below, 0u), vec2<u32>(0u, below), k >= 32u);
    }
    return mask;
}

// A slot whose receiver an invocation folds for 64 of its samples.
struct Task {
    slot: u32,
    group: u32,
    chunk: u32,
    exists: bool,
}

fn task_of(group: vec3<u32>, groups: vec3<u32>, lane: u32) -> Task {
    let position = group.y * groups.x + group.x;
    let count = atomicLoad(&counts.parts);
    let item = 2u * min(position, max(count, 1u) - 1u);
    let part = lists[item];
    let at = (part >> 1u) * TILE + lane;
    let slot = slots[min(at, fold_settings.slot_count - 1u)];
    let mine = slot.part == (part & 1u) && slot.depth != NO_VIEW;
    return Task(at, group.z, lists[item + 1u], position < count && at < fold_settings.slot_count && mine);
}

fn finish(sums: Sums, view: FrameView, receiver: Receiver, task: Task, wants_area: bool) {
    let slot = slots[task.slot];
    let first = task.group * 64u;
    let count = min(64u, light_frame.sample_count - first);
    let all = existing(count);
    let words = (light_frame.sample_count + 31u) / 32u;
    let layered = counters_nonzero(sums.counters) & all;
    let slope = horizon_slope(view, receiver);
    let crossing = select(count, 0u, is_above_horizon(light_frame, receiver, slope));
    let mask = layered | (below_horizon(view, slope, first, crossing) & all);
    blocked[slot.receiver * words + 2u * task.group] = mask.x;
    if (count > 32u) {
        blocked[slot.receiver * words + 2u * task.group + 1u] = mask.y;
    }
    if (wants_area) {
        let sampled = 1.0 - f32(countOneBits(mask.x) + countOneBits(mask.y)) / f32(count);
        let visible = visible_area(sums, slot.depth, layered, sampled);
        areas[slot.receiver] = visible;
        if (visible >= 0.0) {
            atomicAdd(&counts.by_area, 1u);
        }
    }
    if (sums.changes > LARGEST_COUNT) {
        atomicAdd(&counts.unfinished, 1u);
    }
}

// What decides whether the way to a sample crosses an edge.
struct Crossing {
    low: vec2<f32>,
    high: vec2<f32>,
    line: vec3<f32>,
    left: bool,
    beyond_left: bool,
}

// Bit `k` of a group where sample `first + k` lies beyond the edge in its sector.
fn crossed(crossing: Crossing, view: FrameView, first: u32, k: u32) -> u32 {
    let s = placed_sample(light_frame, view, frame_samples.at[min(first + k, light_frame.sample_count - 1u)].xy);
    let left_of_low = crossing.low.x * s.y - crossing.low.y * s.x >= 0.0;
    let left_of_high = crossing.high.x * s.y - crossing.high.y * s.x >= 0.0;
    let beyond = (crossing.line.x * s.x + crossing.line.y * s.y + crossing.line.z >= 0.0) != crossing.beyond_left;
    return select(0u, 1u << (k & 31u), left_of_low != left_of_high && left_of_low == crossing.left && beyond);
}

// 64 samples, eight at a step: drivers on the CPU count steps.
fn crossed_exactly(view: FrameView, image: EdgeImage, first: u32, count: u32) -> vec2<u32> {
    let low = low_direction(image);
    let high = high_direction(image);
    let c = Crossing(low, high, image.line, image.left, line_left(image, low, high));
    var mask = vec2<u32>(0u);
    for (var k = 0u; k < count; k += 8u) {
        let found = crossed(c, view, first, k) | crossed(c, view, first, k + 1u) | crossed(c, view, first, k + 2u)
            | crossed(c, view, first, k + 3u) | crossed(c, view, first, k + 4u) | crossed(c, view, first, k + 5u)
            | crossed(c, view, first, k + 6u) | crossed(c, view, first, k + 7u);
        mask |= select(vec2<u32>(found, 0u), vec2<u32>(0u, found), k >= 32u);
    }
    return mask;
}

// Whether loops still run.
fn has_steps_left() -> bool {
    var steps = 0u;
    for (var k = 0u; k < LAST_STEPS; k++) {
        // Read from a buffer, so that nobody can tell the number beforehand.
        steps += select(0u, 1u, edges[min(k, arrayLength(&edges) - 1u)].incidence_count != 0xffffffffu);
    }
    return steps == LAST_STEPS;
}

@compute @workgroup_size(64)
fn fold(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let task = task_of(workgroup, workgroups, lane);
    if (!task.exists) {
        return;
    }
    let receiver = receivers[slots[task.slot].receiver];
    let view = frame_view(light_frame, receiver.position);
    let is_above = is_above_horizon(light_frame, receiver, horizon_slope(view, receiver));
    let wants_area = fold_settings.wants_area != 0u && task.group == 0u && is_above;
    let first = task.group * 64u;
    let count = min(64u, light_frame.sample_count - first);
    var sums = begin_fold(slots[task.slot].depth);
    let base = first_chunk_word(fold_settings.tile_count);
    var chunk = task.chunk;
    var steps = 0u;
    while (chunk != 0u && steps < MOST_STEPS) {
        let at = base + chunk * CHUNK;
        let end = lists[at + 1u];
        for (var k = 0u; k < end; k++) {
            steps++;
            let edge = edges[lists[at + 2u + k]];
            let image = before_limit(view, edge, edge_image(view, edge));
            if (image_matters(light_frame, image)) {
                let change = weight(view, edge, receiver.triangle) * select(1, -1, image.left);
                steps += edge.incidence_count;
                if (change != 0) {
                    steps += count / 8u + 1u + light_frame.outline_count;
                    sums = folded(sums, image, change, crossed_exactly(view, image, first, count), wants_area);
                }
            }
        }
        chunk = lists[at];
    }
    finish(sums, view, receiver, task, wants_area);
    if (chunk != 0u || !has_steps_left()) {
        atomicAdd(&counts.unfinished, 1u);
    }
}

// Layers, opaque and in units of attenuation.
struct Layers {
    opaque: i32,
    attenuation: i32,
}

// As `weight`, of both kinds of layers.
fn weight_of_both(view: FrameView, edge: OccluderEdge, triangle: u32) -> Layers {
    var sum = Layers(0, 0);
    for (var k = 0u; k < face_count(edge); k++) {
        let face = incident_faces[edge.first_incidence + k];
        let units = triangle_attenuation[face.reference >> 1u];
        let turn = turned(side_of_plane(face.normal, face.point, face.flatness, view.position), face);
        let left = select(turn, 0, (face.reference >> 1u) == triangle);
        sum.opaque += select(0, left, units == OPAQUE);
        sum.attenuation += select(left * i32(units), 0, units == OPAQUE);
    }
    return sum;
}

// What the edges of one receiver add up to where some of what they border lets light through.
struct AttenuatedSums {
    counters: Counters,
    attenuation: Attenuation,
    changes: u32,           // by how much D can have changed at most
    most: u32,              // and the attenuation
}

fn attenuated(before: AttenuatedSums, change: Layers, faces: u32, mask: vec2<u32>) -> AttenuatedSums {
    var sums = before;
    sums.counters = counters_change(sums.counters, mask, change.opaque);
    sums.attenuation = attenuation_add(sums.attenuation, mask, change.attenuation);
    sums.changes += most_change(change.opaque);
    let most = select(u32(abs(change.attenuation)), LARGEST_ATTENUATION + 1u, faces > MOST_ATTENUATING_FACES);
    sums.most = min(sums.most, LARGEST_ATTENUATION + 1u) + most;
    return sums;
}

fn finish_attenuated(sums: AttenuatedSums, view: FrameView, receiver: Receiver, task: Task) {
    let first = task.group * 64u;
    let count = min(64u, light_frame.sample_count - first);
    let slope = horizon_slope(view, receiver);
    let crossing = select(count, 0u, is_above_horizon(light_frame, receiver, slope));
    let hidden = counters_nonzero(sums.counters) | below_horizon(view, slope, first, crossing);
    let at = slots[task.slot].receiver * light_frame.sample_count + first;
    for (var k = 0u; k < count; k++) {
        let passes = passed(attenuation_scale, attenuation_of(sums.attenuation, k));
        sample_transmittance[at + k] = select(passes, 0.0, digit_of(hidden, k, 0u) != 0u);
    }
    if (sums.changes > LARGEST_COUNT) {
        atomicAdd(&counts.unfinished, 1u);
    }
    if (sums.most > LARGEST_ATTENUATION) {
        atomicAdd(&counts.overflowed, 1u);
    }
}

// As `fold`, where some faces are semi-opaque. Samples answer: an area under a layer that lets light through is no visibility.
@compute @workgroup_size(64)
fn fold_attenuated(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let task = task_of(workgroup, workgroups, lane);
    if (!task.exists) {
        return;
    }
    let slot = slots[task.slot];
    let receiver = receivers[slot.receiver];
    let view = frame_view(light_frame, receiver.position);
    let first = task.group * 64u;
    let count = min(64u, light_frame.sample_count - first);
    var sums = AttenuatedSums(
        counters_at(slot.depth), attenuation_at(slot.attenuation), u32(abs(slot.depth)), u32(abs(slot.attenuation))
    );
    let base = first_chunk_word(fold_settings.tile_count);
    var chunk = task.chunk;
    var steps = 0u;
    while (chunk != 0u && steps < MOST_STEPS) {
        let at = base + chunk * CHUNK;
        let end = lists[at + 1u];
        for (var k = 0u; k < end; k++) {
            steps++;
            let edge = edges[lists[at + 2u + k]];
            let image = before_limit(view, edge, edge_image(view, edge));
            if (image_matters(light_frame, image)) {
                let weight = weight_of_both(view, edge, receiver.triangle);
                steps += face_count(edge);
                if (weight.opaque != 0 || weight.attenuation != 0) {
                    steps += count / 8u + 1u;
                    let mask = crossed_exactly(view, image, first, count);
                    let sign = select(1, -1, image.left);
                    let change = Layers(weight.opaque * sign, weight.attenuation * sign);
                    if ((mask.x | mask.y) != 0u) {
                        sums = attenuated(sums, change, face_count(edge), mask);
                    }
                }
            }
        }
        chunk = lists[at];
    }
    finish_attenuated(sums, view, receiver, task);
    if (chunk != 0u || !has_steps_left()) {
        atomicAdd(&counts.unfinished, 1u);
    }
}
