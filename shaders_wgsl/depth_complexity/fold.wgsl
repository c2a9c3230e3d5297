// Folds the silhouette edges of a part of a tile into the counters of its receivers, 64 samples at a time: D(s) is D(c) less what
// changes at every edge on the way. Where a single depth hides the light, the area beyond the edges answers instead of the samples.
//#import shared/receiver.wgsl
//#import depth_complexity/sides.wgsl
//#import depth_complexity/edge.wgsl
//#import depth_complexity/horizon.wgsl
//#import depth_complexity/coverage.wgsl
//#import depth_complexity/coverage_table.wgsl
//#import depth_complexity/sums.wgsl
//#import depth_complexity/attenuation.wgsl
//#import depth_complexity/area.wgsl
//#import depth_complexity/tiles.wgsl
//#import depth_complexity/walk.wgsl
//#import depth_complexity/sample_sets.wgsl

@group(0) @binding(0) var<uniform> light_frame: LightFrame;
@group(0) @binding(1) var<uniform> group_samples: GroupSamples;
@group(0) @binding(2) var<uniform> fold_settings: FoldSettings;
@group(0) @binding(3) var<uniform> outline: Outline;
@group(0) @binding(4) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(5) var<storage, read> edges: array<EightWords>;
@group(0) @binding(6) var<storage, read> incident_faces: array<EightWords>;
@group(0) @binding(7) var<storage, read> slots: array<Slot>;
@group(0) @binding(8) var<storage, read_write> blocked: array<u32>;
@group(0) @binding(9) var<storage, read> lists: array<u32>;
@group(0) @binding(11) var<storage, read_write> counts: ListCounts;
@group(0) @binding(10) var<storage, read_write> areas: array<u32>;
@group(0) @binding(17) var<uniform> coverage_table: CoverageTable;
@group(0) @binding(12) var<uniform> sampling: Sampling;
@group(0) @binding(13) var<uniform> sample_sets: SampleSets;
@group(0) @binding(14) var<uniform> attenuation_scale: AttenuationScale;
@group(0) @binding(15) var<storage, read> triangle_attenuation: array<u32>;
@group(0) @binding(16) var<storage, read_write> sample_transmittance: array<f32>;

struct GroupSamples {
    at: array<vec4<f32>, 64>,
}

struct Outline {
    corners: array<vec4<f32>, 64>,
}

struct FoldSettings {
    slot_count: u32,
    group: u32,             // which 64 of a receiver's samples
    sampling_bound: f32,    // an area farther from the samples' share is not believed
    tile_count: u32,
}

// Layers of which areas are believed: far below where counters or sums of areas wrap.
const MOST_AREA_LAYERS: u32 = 127u;

// Marks an area that answers; the other bits are its float.
const AREA_ANSWERS: u32 = 0x80000000u;

// D left of the edge minus D right of it.
fn weight(view: FrameView, edge: OccluderEdge, triangle: u32) -> i32 {
    var sum = 0;
    for (var k = 0u; k < edge.incidence_count; k++) {
        let face = incident_face_of(incident_faces[edge.first_incidence + k]);
        let left = weighing_side(light_frame, view, face);
        sum += select(left, 0, (face.reference >> 1u) == triangle);
    }
    return sum;
}

// The visible share of the area; negative where samples have to answer.
fn visible_area(sums: Sums, area: i32, depth: i32, hidden_samples: vec2<u32>, sampled: f32) -> f32 {
    let nothing_hidden = (hidden_samples.x | hidden_samples.y) == 0u;
    let single = counters_single_value(sums.counters, hidden_samples);
    let layers = select(single, sums.smallest, nothing_hidden);
    let agrees = layers > 0u && layers <= MOST_AREA_LAYERS && (depth == 0 || depth == i32(layers));
    let total = f32(depth) * light_frame.area + f32(area) / AREA_UNITS;
    let visible = 1.0 - total / (f32(max(layers, 1u)) * light_frame.area);
    let believed = agrees && abs(visible - sampled) <= fold_settings.sampling_bound;
    return select(-1.0, clamp(visible, 0.0, 1.0), believed);
}

// What one invocation folds: a receiver and the list of its bundle.
struct Task {
    slot: u32,
    chunk: u32,
    exists: bool,
}

fn task_of(group: vec3<u32>, groups: vec3<u32>, lane: u32) -> Task {
    let position = group.y * groups.x + group.x;
    let count = atomicLoad(&counts.parts);
    let item = HEAD * min(position, max(count, 1u) - 1u);
    let part = lists[item];
    let at = (part >> 1u) * TILE + lane;
    let slot = slots[min(at, fold_settings.slot_count - 1u)];
    let mine = slot.part == (part & 1u) && slot.depth != NO_VIEW;
    return Task(at, lists[item + 2u + lane / BUNDLE], position < count && at < fold_settings.slot_count && mine);
}

// One receiver in the course of its fold.
struct Fold {
    slot: Slot,
    receiver: Receiver,
    view: FrameView,
    slope: vec3<f32>,
    is_above: bool,
    count: u32,              // samples of this group
    sums: Sums,
    chunk: u32,
    steps: u32,
}

fn begin(task: Task) -> Fold {
    let slot = slots[task.slot];
    let receiver = receivers[slot.receiver];
    let view = frame_view(light_frame, receiver.position);
    let slope = horizon_slope(view, receiver);
    let is_above = is_above_horizon(light_frame, receiver, slope);
    let count = min(64u, light_frame.sample_count - 64u * fold_settings.group);
    return Fold(slot, receiver, view, slope, is_above, count, begin_fold(slot.depth), task.chunk, 0u);
}

fn image_before(view: FrameView, edge: OccluderEdge) -> EdgeImage {
    return before_limit(view, edge, edge_image(view, edge));
}

fn chunk_at(chunk: u32) -> u32 {
    return first_chunk_word(fold_settings.tile_count) + chunk * CHUNK;
}

// Drivers on the CPU run both sides of a branch, and skip loops only: so a loop over all edges, and one over those of unknown weight.
fn changes_in(view: FrameView, triangle: u32, at: u32) -> Changes {
    let end = lists[at + 1u];
    var changes = Changes(0u, 0u, 0u, 0u, 0u, 0u);
    var unknown = 0u;
    for (var k = 0u; k < end; k++) {
        let entry = lists[at + 2u + k];
        let image = image_before(view, edge_of(edges[listed_edge(entry)]));
        let bit = select(0u, 1u << k, image_matters(light_frame, image));
        let weight = listed_weight(entry);
        changes = with_change(changes, bit, weight);
        unknown |= select(0u, bit, weight == 0);
    }
    while (unknown != 0u) {
        let k = firstTrailingBit(unknown);
        unknown &= unknown - 1u;
        changes = with_change(changes, 1u << k, weight(view, edge_of(edges[listed_edge(lists[at + 2u + k])]), triangle));
    }
    return changes;
}

// What is left to write once all edges are folded. `below` are the samples below the horizon.
fn finish(fold: Fold, below: vec2<u32>) -> vec2<u32> {
    let all = existing(fold.count);
    let layered = counters_nonzero(fold.sums.counters) & all;
    let mask = layered | (below & all);
    let words = (light_frame.sample_count + 31u) / 32u;
    let first = fold.slot.receiver * words + 2u * fold_settings.group;
    blocked[first] = mask.x;
    if (fold.count > 32u) {
        blocked[first + 1u] = mask.y;
    }
    if (fold.sums.changes > LARGEST_COUNT || fold.chunk != 0u || !has_steps_left()) {
        atomicAdd(&counts.unfinished, 1u);
    }
    return layered;
}

fn is_below(slope: vec3<f32>, s: vec2<f32>) -> bool {
    return slope.z + slope.x * s.x + slope.y * s.y <= 0.0;
}

// Whether loops still run.
fn has_steps_left() -> bool {
    var steps = 0u;
    for (var k = 0u; k < LAST_STEPS; k++) {
        // Read from a buffer, so that nobody can tell the number beforehand.
        steps += select(0u, 1u, edge_of(edges[min(k, arrayLength(&edges) - 1u)]).incidence_count != 0xffffffffu);
    }
    return steps == LAST_STEPS;
}

// Tests that this invocation has made so far: drivers on the CPU count steps.
var<private> tests: u32 = 0u;

fn left_of_direction(v: vec2<f32>) -> Left {
    return left_in(coverage_table.directions[cell_of_direction(v)], v);
}

fn left_of_line(line: vec3<f32>) -> Left {
    return left_in(coverage_table.lines[cell_of_line(line)], line.xy);
}

// Samples that stand still are looked up; those near a border are then tested.
fn crossed_standing(c: Crossing) -> vec2<u32> {
    let begin = left_of_direction(c.sector_from);
    let end = left_of_direction(c.sector_to);
    let line = left_of_line(c.line);
    let line_possible = line.surely | line.maybe;
    let beyond = select(line.surely, ~line_possible, c.beyond_left);
    let beyond_possible = select(line_possible, ~line.surely, c.beyond_left);
    var mask = begin.surely & ~(end.surely | end.maybe) & beyond;
    var open = (begin.surely | begin.maybe) & ~end.surely & beyond_possible & ~mask;
    tests += countOneBits(open.x) + countOneBits(open.y);
    while ((open.x | open.y) != 0u) {
        let k = first_of(open);
        open &= ~set_of_one(k);
        mask |= select(vec2<u32>(0u), set_of_one(k), crosses(c, group_samples.at[k].xy));
    }
    return mask;
}

fn below_standing(fold: Fold) -> vec2<u32> {
    let above = left_of_line(fold.slope);
    var mask = select(~(above.surely | above.maybe), vec2<u32>(0u), fold.is_above);
    var open = select(above.maybe, vec2<u32>(0u), fold.is_above);
    while ((open.x | open.y) != 0u) {
        let k = first_of(open);
        open &= ~set_of_one(k);
        mask |= select(vec2<u32>(0u), set_of_one(k), is_below(fold.slope, group_samples.at[k].xy));
    }
    return mask;
}

// Bits of the edges of a chunk over 64 samples that stand still.
fn fold_standing(before: Sums, view: FrameView, at: u32, changes: Changes) -> Sums {
    var sums = before;
    var waiting = changes.edges;
    while (waiting != 0u) {
        let k = firstTrailingBit(waiting);
        waiting &= waiting - 1u;
        let image = image_before(view, edge_of(edges[listed_edge(lists[at + 2u + k])]));
        sums = folded(sums, changes, k, image.left, crossed_standing(crossing_of(image)));
    }
    return sums;
}

// Samples that a receiver has for itself: those of its own set, or a sphere's, which move with it. In eights: drivers on the CPU count
// steps.
fn own_sample(view: FrameView, at: u32) -> vec2<f32> {
    return placed_sample(light_frame, view, of_pair(sample_sets.pairs[at >> 1u], at));
}

fn first_own_sample(fold: Fold) -> u32 {
    return first_sample(sampling, fold.slot.receiver) + 64u * fold_settings.group;
}

fn crossed_own(c: Crossing, view: FrameView, first: u32, last: u32, k: u32) -> u32 {
    return select(0u, 1u << (k & 31u), crosses(c, own_sample(view, min(first + k, last))));
}

fn crossed_own_samples(c: Crossing, view: FrameView, first: u32, count: u32) -> vec2<u32> {
    let last = first + count - 1u;
    var mask = vec2<u32>(0u);
    for (var k = 0u; k < count; k += 8u) {
        let found = crossed_own(c, view, first, last, k) | crossed_own(c, view, first, last, k + 1u)
            | crossed_own(c, view, first, last, k + 2u) | crossed_own(c, view, first, last, k + 3u)
            | crossed_own(c, view, first, last, k + 4u) | crossed_own(c, view, first, last, k + 5u)
            | crossed_own(c, view, first, last, k + 6u) | crossed_own(c, view, first, last, k + 7u);
        mask |= select(vec2<u32>(found, 0u), vec2<u32>(0u, found), k >= 32u);
    }
    return mask;
}

fn fold_own(before: Sums, view: FrameView, at: u32, changes: Changes, first: u32, count: u32) -> Sums {
    var sums = before;
    var waiting = changes.edges;
    while (waiting != 0u) {
        let k = firstTrailingBit(waiting);
        waiting &= waiting - 1u;
        let image = image_before(view, edge_of(edges[listed_edge(lists[at + 2u + k])]));
        sums = folded(sums, changes, k, image.left, crossed_own_samples(crossing_of(image), view, first, count));
    }
    return sums;
}

fn below_own(fold: Fold) -> vec2<u32> {
    let first = first_own_sample(fold);
    var mask = vec2<u32>(0u);
    for (var k = 0u; k < select(fold.count, 0u, fold.is_above); k++) {
        mask |= select(vec2<u32>(0u), set_of_one(k), is_below(fold.slope, own_sample(fold.view, first + k)));
    }
    return mask;
}

// The sector and line of an edge, as areas take them.
struct Beyond {
    line: vec3<f32>,
    from_direction: vec2<f32>,
    to_direction: vec2<f32>,
}

fn beyond_of(image: EdgeImage) -> Beyond {
    let low = low_direction(image);
    let high = high_direction(image);
    let line = select(-image.line, image.line, line_left(image, low, high));
    return Beyond(line, select(high, low, image.left), select(low, high, image.left));
}

fn beyond_side(b: Beyond, from_corner: u32, to_corner: u32) -> f32 {
    let start = outline.corners[from_corner].xy;
    let end = outline.corners[to_corner].xy;
    return area_beyond_side(b.line, b.from_direction, b.to_direction, start, end);
}

// The area of the light beyond the edges of a chunk: a loop for each kind of outline, skipped where it is another.
fn area_in(view: FrameView, at: u32, changes: Changes) -> i32 {
    let corners = light_frame.outline_count;
    return area_in_quadrangle(view, at, changes, select(0u, changes.edges, corners == 4u))
        + area_in_polygon(view, at, changes, select(0u, changes.edges, corners != 4u && corners != 0u))
        + area_in_disc(view, at, changes, select(0u, changes.edges, corners == 0u));
}

fn area_in_quadrangle(view: FrameView, at: u32, changes: Changes, chosen: u32) -> i32 {
    var sum = 0;
    var waiting = chosen;
    while (waiting != 0u) {
        let k = firstTrailingBit(waiting);
        waiting &= waiting - 1u;
        let image = image_before(view, edge_of(edges[listed_edge(lists[at + 2u + k])]));
        let b = beyond_of(image);
        let area = beyond_side(b, 3u, 0u) + beyond_side(b, 0u, 1u) + beyond_side(b, 1u, 2u) + beyond_side(b, 2u, 3u);
        sum += signed_area(area, changes, k, image.left);
    }
    return sum;
}

fn area_in_polygon(view: FrameView, at: u32, changes: Changes, chosen: u32) -> i32 {
    var sum = 0;
    var waiting = chosen;
    while (waiting != 0u) {
        let k = firstTrailingBit(waiting);
        waiting &= waiting - 1u;
        let image = image_before(view, edge_of(edges[listed_edge(lists[at + 2u + k])]));
        let b = beyond_of(image);
        var area = 0.0;
        for (var corner = 0u; corner < light_frame.outline_count; corner++) {
            area += beyond_side(b, select(corner, light_frame.outline_count, corner == 0u) - 1u, corner);
        }
        sum += signed_area(area, changes, k, image.left);
    }
    return sum;
}

fn area_in_disc(view: FrameView, at: u32, changes: Changes, chosen: u32) -> i32 {
    var sum = 0;
    var waiting = chosen;
    while (waiting != 0u) {
        let k = firstTrailingBit(waiting);
        waiting &= waiting - 1u;
        let image = image_before(view, edge_of(edges[listed_edge(lists[at + 2u + k])]));
        let b = beyond_of(image);
        let area = area_beyond_arc(b.line, b.from_direction, b.to_direction, -light_frame.reference);
        sum += signed_area(area, changes, k, image.left);
    }
    return sum;
}

// Samples and area of one receiver are summed: the area answers where it can, and no part of the light lies below the horizon.
fn finish_area(fold: Fold, area: i32, below: vec2<u32>) {
    let layered = finish(fold, below);
    let sampled = 1.0 - f32(countOneBits(layered.x) + countOneBits(layered.y)) / f32(fold.count);
    let visible = visible_area(fold.sums, area, fold.slot.depth, layered, sampled);
    if (fold.is_above && visible >= 0.0) {
        areas[fold.slot.receiver] = AREA_ANSWERS | bitcast<u32>(visible);
        atomicAdd(&counts.by_area, 1u);
    }
}

// Steps that a driver counts for a chunk, where every change takes so many inner ones.
fn steps_in(at: u32, changes: Changes, inner: u32) -> u32 {
    return 4u * lists[at + 1u] + countOneBits(changes.edges) * (4u + inner);
}

// All receivers share samples that stand still.
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
    var fold = begin(task);
    while (fold.chunk != 0u && fold.steps + tests < MOST_STEPS) {
        let at = chunk_at(fold.chunk);
        let changes = changes_in(fold.view, fold.receiver.triangle, at);
        fold.sums = fold_standing(fold.sums, fold.view, at, changes);
        fold.steps += steps_in(at, changes, 0u);
        fold.chunk = lists[at];
    }
    finish(fold, below_standing(fold));
}

@compute @workgroup_size(64)
fn fold_areas(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let task = task_of(workgroup, workgroups, lane);
    if (!task.exists) {
        return;
    }
    var fold = begin(task);
    var area = 0;
    while (fold.chunk != 0u && fold.steps + tests < MOST_STEPS) {
        let at = chunk_at(fold.chunk);
        let changes = changes_in(fold.view, fold.receiver.triangle, at);
        fold.sums = fold_standing(fold.sums, fold.view, at, changes);
        area += area_in(fold.view, at, changes);
        fold.steps += steps_in(at, changes, light_frame.outline_count);
        fold.chunk = lists[at];
    }
    finish_area(fold, area, below_standing(fold));
}

// The same where receivers have samples of their own: other entries, because what is read at one place for all is faster.
@compute @workgroup_size(64)
fn fold_own_samples(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let task = task_of(workgroup, workgroups, lane);
    if (!task.exists) {
        return;
    }
    var fold = begin(task);
    let first = first_own_sample(fold);
    while (fold.chunk != 0u && fold.steps + tests < MOST_STEPS) {
        let at = chunk_at(fold.chunk);
        let changes = changes_in(fold.view, fold.receiver.triangle, at);
        fold.sums = fold_own(fold.sums, fold.view, at, changes, first, fold.count);
        fold.steps += steps_in(at, changes, fold.count / 8u);
        fold.chunk = lists[at];
    }
    finish(fold, below_own(fold));
}

@compute @workgroup_size(64)
fn fold_own_samples_areas(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let task = task_of(workgroup, workgroups, lane);
    if (!task.exists) {
        return;
    }
    var fold = begin(task);
    let first = first_own_sample(fold);
    var area = 0;
    while (fold.chunk != 0u && fold.steps + tests < MOST_STEPS) {
        let at = chunk_at(fold.chunk);
        let changes = changes_in(fold.view, fold.receiver.triangle, at);
        fold.sums = fold_own(fold.sums, fold.view, at, changes, first, fold.count);
        area += area_in(fold.view, at, changes);
        fold.steps += steps_in(at, changes, fold.count / 8u + light_frame.outline_count);
        fold.chunk = lists[at];
    }
    finish_area(fold, area, below_own(fold));
}

// As `weight`, of both kinds of layers.
fn weight_of_both(view: FrameView, edge: OccluderEdge, triangle: u32) -> Layers {
    var sum = Layers(0, 0);
    for (var k = 0u; k < face_count(edge); k++) {
        let face = incident_face_of(incident_faces[edge.first_incidence + k]);
        let units = triangle_attenuation[face.reference >> 1u];
        let turn = weighing_side(light_frame, view, face);
        let left = select(turn, 0, (face.reference >> 1u) == triangle);
        sum.opaque += select(0, left, units == OPAQUE);
        sum.attenuation += select(left * i32(units), 0, units == OPAQUE);
    }
    return sum;
}

// The edges of a chunk that may lie between a receiver and the light, one bit each.
fn before_light(view: FrameView, at: u32) -> u32 {
    let end = lists[at + 1u];
    var found = 0u;
    for (var k = 0u; k < end; k++) {
        let image = image_before(view, edge_of(edges[listed_edge(lists[at + 2u + k])]));
        found |= select(0u, 1u << k, image_matters(light_frame, image));
    }
    return found;
}

fn finish_attenuated(fold: Fold, attenuated: Attenuated, below: vec2<u32>) {
    let hidden = counters_nonzero(fold.sums.counters) | below;
    let at = fold.slot.receiver * light_frame.sample_count + 64u * fold_settings.group;
    for (var k = 0u; k < fold.count; k++) {
        let passes = passed(attenuation_scale, attenuation_of(attenuated.attenuation, k));
        sample_transmittance[at + k] = select(passes, 0.0, digit_of(hidden, k, 0u) != 0u);
    }
    if (attenuated.most > LARGEST_ATTENUATION) {
        atomicAdd(&counts.overflowed, 1u);
    }
    if (fold.sums.changes > LARGEST_COUNT || fold.chunk != 0u || !has_steps_left()) {
        atomicAdd(&counts.unfinished, 1u);
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
    var fold = begin(task);
    var sums = Attenuated(attenuation_at(fold.slot.attenuation), u32(abs(fold.slot.attenuation)));
    while (fold.chunk != 0u && fold.steps + tests < MOST_STEPS) {
        let at = chunk_at(fold.chunk);
        var waiting = before_light(fold.view, at);
        fold.steps += 4u * lists[at + 1u];
        while (waiting != 0u) {
            let edge = edge_of(edges[listed_edge(lists[at + 2u + firstTrailingBit(waiting)])]);
            waiting &= waiting - 1u;
            let weight = weight_of_both(fold.view, edge, fold.receiver.triangle);
            let image = image_before(fold.view, edge);
            let mask = crossed_standing(crossing_of(image));
            let sign = select(1, -1, image.left);
            fold.sums = with_layers(fold.sums, weight.opaque * sign, mask);
            sums = attenuated_by(sums, weight.attenuation * sign, face_count(edge), mask);
            fold.steps += 4u + face_count(edge);
        }
        fold.chunk = lists[at];
    }
    finish_attenuated(fold, sums, below_standing(fold));
}

@compute @workgroup_size(64)
fn fold_attenuated_own_samples(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let task = task_of(workgroup, workgroups, lane);
    if (!task.exists) {
        return;
    }
    var fold = begin(task);
    let first = first_own_sample(fold);
    var sums = Attenuated(attenuation_at(fold.slot.attenuation), u32(abs(fold.slot.attenuation)));
    while (fold.chunk != 0u && fold.steps + tests < MOST_STEPS) {
        let at = chunk_at(fold.chunk);
        var waiting = before_light(fold.view, at);
        fold.steps += 4u * lists[at + 1u];
        while (waiting != 0u) {
            let edge = edge_of(edges[listed_edge(lists[at + 2u + firstTrailingBit(waiting)])]);
            waiting &= waiting - 1u;
            let weight = weight_of_both(fold.view, edge, fold.receiver.triangle);
            let image = image_before(fold.view, edge);
            let mask = crossed_own_samples(crossing_of(image), fold.view, first, fold.count);
            let sign = select(1, -1, image.left);
            fold.sums = with_layers(fold.sums, weight.opaque * sign, mask);
            sums = attenuated_by(sums, weight.attenuation * sign, face_count(edge), mask);
            fold.steps += 4u + face_count(edge) + fold.count / 8u;
        }
        fold.chunk = lists[at];
    }
    finish_attenuated(fold, sums, below_own(fold));
}
