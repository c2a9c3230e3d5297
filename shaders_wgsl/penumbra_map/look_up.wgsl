// What a receiver sees of a light: nothing where the depth map has something before it, else what the penumbra map says of the surface.
//#import shared/slice.wgsl
//#import shared/light.wgsl
//#import shared/shadow_view.wgsl
//#import shared/shadow_test.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> light: Light;
@group(0) @binding(2) var<uniform> shadow_views: ShadowViews;
@group(0) @binding(3) var depth_map: texture_2d_array<f32>;
@group(0) @binding(4) var penumbra_map: texture_2d_array<f32>;
@group(0) @binding(5) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(6) var<storage, read_write> visibility: array<f32>;
@group(0) @binding(7) var<storage, read_write> counts: LookUpCounts;

struct LookUpCounts {
    strays: atomic<u32>,   // receivers that no texel shows
}

fn write(index: u32, value: f32) {
    for (var channel = 0u; channel < shadow_views.channels; channel++) {
        visibility[index * shadow_views.channels + channel] = value;
    }
}

// What a receiver sees before anything is in the way, and whether anything can be.
struct Outlook {
    value: f32,
    is_open: bool,
}

fn outlook(receiver: Receiver) -> Outlook {
    let way = select(light.center - receiver.position, -light.emission, light.kind == LIGHT_SUN);
    let view = light_view(light, receiver.position);
    let exists = receiver.kind != RECEIVER_NONE;
    let faces = exists && view.exists && !below_horizon(receiver, way);
    let inside = exists && view.inside;
    return Outlook(select(0.0, 1.0, faces || inside), faces && !inside);
}

// Which view shows a receiver; the number of views where none does.
fn layer_of(receiver: Receiver) -> u32 {
    var found = shadow_views.count;
    for (var layer = 0u; layer < 6u; layer++) {
        if (layer < shadow_views.count && found == shadow_views.count && is_in_view(shadow_views.views[layer], receiver.position)) {
            found = layer;
        }
    }
    return found;
}

// Points without a normal may lie on a surface of any slope that a map resolves.
fn shows_surface(receiver: Receiver, gap: TexelGap, view: ShadowView, scale: f32) -> bool {
    let slack = select(LARGEST_SLOPE * view.texel * scale, 2.0 * gap.slack, receiver.kind == RECEIVER_SURFACE);
    return gap.exists && abs(gap.gap) <= slack;
}

// Interpolated between those of the four nearest texels that show the receiver's own surface; -1 where none does.
fn penumbra(receiver: Receiver, view: ShadowView, layer: u32) -> f32 {
    let place = place_in_view(view, receiver.position);
    let corner = floor(place.texel - 0.5);
    let part = place.texel - 0.5 - corner;
    var sum = 0.0;
    var weights = 0.0;
    for (var i = 0u; i < 4u; i++) {
        let step = vec2<f32>(f32(i & 1u), f32(i >> 1u));
        let texel = texel_in_view(view, corner + step);
        // Never 0, so that a receiver on a texel's centre has neighbours, too.
        let shares = max(select(1.0 - part, part, step > vec2<f32>(0.5)), vec2<f32>(1e-3));
        let gap = texel_gap(depth_map, view, layer, receiver, texel);
        let weight = select(0.0, shares.x * shares.y, shows_surface(receiver, gap, view, place.scale));
        sum += weight * textureLoad(penumbra_map, vec2<u32>(texel), layer, 0).x;
        weights += weight;
    }
    return select(-1.0, sum / max(weights, 1e-30), weights > 0.0);
}

@compute @workgroup_size(64)
fn look_up(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    let receiver = receivers[index];
    let seen = outlook(receiver);
    var value = seen.value;
    let layer = layer_of(receiver);
    if (seen.is_open && layer < shadow_views.count) {
        let view = shadow_views.views[layer];
        value = lit_in_view(depth_map, view, layer, receiver);
        if (value > 0.0) {
            let share = penumbra(receiver, view, layer);
            if (share < 0.0) {
                atomicAdd(&counts.strays, 1u);
            } else {
                value = share;
            }
        }
    }
    write(index, value);
}

// A light without size has no penumbra.
@compute @workgroup_size(64)
fn look_up_depth(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    let receiver = receivers[index];
    let seen = outlook(receiver);
    var value = seen.value;
    let layer = layer_of(receiver);
    if (seen.is_open && layer < shadow_views.count) {
        value = lit_in_view(depth_map, shadow_views.views[layer], layer, receiver);
    }
    write(index, value);
}

// Nothing casts a shadow.
@compute @workgroup_size(64)
fn see_all(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    write(index, outlook(receivers[index]).value);
}
