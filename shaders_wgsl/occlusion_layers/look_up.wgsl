// What of the light a receiver sees past all slices before it.
//#import shared/slice.wgsl
//#import occlusion_layers/kernel.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> light: Light;
@group(0) @binding(2) var<uniform> layer_frame: LayerFrame;
@group(0) @binding(3) var<uniform> light_parts: LightParts;
@group(0) @binding(4) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(5) var<storage, read> layer_places: LayerPlaces;
@group(0) @binding(6) var<storage, read> summed_areas: array<u32>;
@group(0) @binding(7) var<storage, read_write> visibility: array<f32>;

// The sums along one row of the table, of the columns before x.x and x.y and the texels that hold them: whole numbers.
fn row_sums(base: u32, row: u32, stride: u32, columns: vec4<u32>) -> vec4<u32> {
    let at = base + row * stride;
    return vec4<u32>(
        summed_areas[at + columns.x], summed_areas[at + columns.y], summed_areas[at + columns.z], summed_areas[at + columns.w],
    );
}

// Share of the box that the slice hides: the exact mean of its texels, nothing being outside of them. Differences of whole numbers come first,
// so that nothing cancels: nine cells, of which those at the border weigh what the box has of them.
fn hidden_share(layer: u32, box: vec4<f32>) -> f32 {
    let resolution = f32(layer_places.resolution);
    let stride = layer_places.resolution + 1u;
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
}

fn slices_before(depth: f32) -> SlicesBefore {
    var low = 0u;
    var high = layer_places.slices;
    while (low < high) {
        let middle = (low + high) / 2u;
        if (layer_places.planes[middle] < depth) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    var before = SlicesBefore(low, 1.0);
    if (layer_places.slices > 0u) {
        let last = layer_places.planes[layer_places.slices - 1u];
        // A hair before the last plane is behind it, where a receiver was lifted off what touches the casters.
        if (depth >= last - 1e-5 * (1.0 + abs(last))) {
            before.count = layer_places.slices;
        } else if (low > 0u) {
            let plane = layer_places.planes[low - 1u];
            before.last_weight = clamp((depth - plane) / max(layer_places.planes[low] - plane, 1e-30), 0.0, 1.0);
        }
    }
    return before;
}

@compute @workgroup_size(64)
fn look_up(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    let receiver = receivers[index];
    let seen = light_view(light, receiver.position);
    var values = vec3<f32>(select(0.0, 1.0, seen.inside));
    if (receiver.kind != RECEIVER_NONE && seen.exists && !seen.inside) {
        let view = layer_view(layer_frame, layer_places, receiver.position);
        let before = slices_before(view.at.z);
        for (var k = 0u; k < light_parts.count; k++) {
            let part = light_parts.boxes[k];
            let above = horizon_share(layer_frame, receiver, view, part);
            var visible = 1.0;
            for (var layer = 0u; layer < select(0u, before.count, above > 0.0); layer++) {
                let box = kernel_box(view, layer_places, part, layer_places.planes[layer]);
                let weight = select(1.0, before.last_weight, layer + 1u == before.count);
                visible = combined(visible, weight * hidden_share(layer, box));
            }
            values += light_parts.weights[k].xyz * (above * max(visible, 0.0));
        }
        values = clamp(values, vec3<f32>(0.0), vec3<f32>(1.0));
    }
    for (var channel = 0u; channel < light_parts.channels; channel++) {
        visibility[index * light_parts.channels + channel] = values[channel];
    }
}
