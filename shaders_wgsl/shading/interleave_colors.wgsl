// Averages the light of pixels side by side whose samples make up one set, where they see one surface of one material.
//#import shared/slice.wgsl
//#import shared/continuity.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> interleaving: Interleaving;
@group(0) @binding(2) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(3) var<storage, read> triangle_materials: array<u32>;
@group(0) @binding(4) var<storage, read> noisy_color: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read_write> color: array<vec4<f32>>;

@compute @workgroup_size(64)
fn interleave_colors(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    let receiver = receivers[index];
    if (receiver.kind == RECEIVER_NONE) {
        color[index] = vec4<f32>(0.0);
        return;
    }
    let material = triangle_materials[receiver.triangle];
    let size = vec2<i32>(vec2<u32>(interleaving.width, interleaving.height));
    let here = vec2<i32>(vec2<u32>(index % interleaving.width, index / interleaving.width));
    let reach = i32(interleaving.tile / 2u);
    var sum = vec4<f32>(0.0);
    var total = 0.0;
    for (var y = max(here.y - reach, 0); y <= min(here.y + reach, size.y - 1); y++) {
        for (var x = max(here.x - reach, 0); x <= min(here.x + reach, size.x - 1); x++) {
            let other = u32(y * size.x + x);
            let neighbour = receivers[other];
            // Where nothing is seen there is no triangle: any material does, it is not continuous.
            let triangle = select(neighbour.triangle, receiver.triangle, neighbour.kind == RECEIVER_NONE);
            let is_alike = triangle_materials[triangle] == material && is_continuous(receiver, neighbour, interleaving.eye);
            let box = share_of_box(x - here.x, interleaving.tile) * share_of_box(y - here.y, interleaving.tile);
            let weight = select(0.0, box, is_alike || other == index);
            sum += weight * noisy_color[other];
            total += weight;
        }
    }
    color[index] = vec4<f32>((sum / total).xyz, 1.0);
}
