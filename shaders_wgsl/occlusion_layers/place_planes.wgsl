// Puts the texels' window around the casters, and the planes between the nearest and the farthest of them.
//#import shared/slice.wgsl
//#import occlusion_layers/casters.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> layer_frame: LayerFrame;
@group(0) @binding(2) var<uniform> caster_range: CasterRange;
@group(0) @binding(3) var<storage, read_write> caster_bounds: CasterBounds;
@group(0) @binding(4) var<storage, read_write> layer_places: LayerPlaces;

@compute @workgroup_size(1)
fn place_planes() {
    let resolution = layer_frame.resolution;
    let has_casters = slice.count > 0u && atomicLoad(&caster_bounds.count) > 0u;
    layer_places.window.slices = select(0u, layer_frame.slices, has_casters);
    layer_places.window.resolution = resolution;
    layer_places.window.inverse_distance = caster_range.inverse_distance;
    layer_places.window.reserved = 0u;
    if (!has_casters) {
        return;
    }
    let low = vec3<f32>(
        number_of(~atomicLoad(&caster_bounds.low[0])), number_of(~atomicLoad(&caster_bounds.low[1])),
        number_of(~atomicLoad(&caster_bounds.low[2])),
    );
    let high = vec3<f32>(
        number_of(atomicLoad(&caster_bounds.high[0])), number_of(atomicLoad(&caster_bounds.high[1])),
        number_of(atomicLoad(&caster_bounds.high[2])),
    );
    let extent = high.xy - low.xy;
    let fitted = select(extent, vec2<f32>(max(extent.x, extent.y)), caster_range.is_square != 0u);
    let size = max(fitted, vec2<f32>(1e-6));
    layer_places.window.low = (low.xy + high.xy - size) * 0.5;
    layer_places.window.texels = f32(resolution) / size;
    // Even in depth before the projection. The last plane a hair behind the farthest caster, which must not fall out by rounding.
    let inverse = caster_range.inverse_distance;
    let near = low.z / (1.0 - low.z * inverse);
    let far = high.z / (1.0 - high.z * inverse);
    for (var k = 0u; k < layer_frame.slices; k++) {
        let z = near + (far - near) * (f32(k + 1u) / f32(layer_frame.slices));
        layer_places.planes[k] = z / (1.0 + z * inverse);
    }
    let last = layer_frame.slices - 1u;
    layer_places.planes[last] = high.z + 1e-6 * (abs(high.z) + abs(low.z));
}
