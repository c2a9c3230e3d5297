// Whether something lies between a receiver and the light's centre, by the depth map.
//#import shared/slice.wgsl
//#import shared/light.wgsl
//#import shared/shadow_view.wgsl
//#import shared/shadow_test.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> light: Light;
@group(0) @binding(2) var<uniform> shadow_views: ShadowViews;
@group(0) @binding(3) var depth_map: texture_2d_array<f32>;
@group(0) @binding(4) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(5) var<storage, read_write> visibility: array<f32>;

@compute @workgroup_size(64)
fn look_up(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    let receiver = receivers[index];
    var value = 0.0;
    let way = select(light.center - receiver.position, -light.emission, light.kind == LIGHT_SUN);
    let view = light_view(light, receiver.position);
    if (receiver.kind != RECEIVER_NONE && view.exists && !below_horizon(receiver, way)) {
        value = 1.0;
        var found = false;
        for (var layer = 0u; layer < 6u; layer++) {
            let face = shadow_views.views[layer];
            if (layer < shadow_views.count && !found && is_in_view(face, receiver.position)) {
                value = lit_in_view(depth_map, face, layer, receiver);
                found = true;
            }
        }
    }
    value = select(value, 1.0, view.inside && receiver.kind != RECEIVER_NONE);
    for (var channel = 0u; channel < shadow_views.channels; channel++) {
        visibility[index * shadow_views.channels + channel] = value;
    }
}
