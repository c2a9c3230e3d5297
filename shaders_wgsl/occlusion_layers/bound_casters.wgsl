// How far the casters reach, and how much of them the projection sees from the side.
//#import shared/slice.wgsl
//#import occlusion_layers/casters.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> layer_frame: LayerFrame;
@group(0) @binding(2) var<uniform> caster_range: CasterRange;
@group(0) @binding(3) var<storage, read> corners: array<Corner>;
@group(0) @binding(4) var<storage, read_write> caster_bounds: CasterBounds;

// Seen at less than this share of its area, a triangle is seen from the side.
const EDGE_ON: f32 = 0.08;

@compute @workgroup_size(64)
fn bound_casters(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    let p0 = corners[3u * index].position;
    let p1 = corners[3u * index + 1u].position;
    let p2 = corners[3u * index + 2u].position;
    let normal = cross(p1 - p0, p2 - p0);
    let outline = outline_of(layer_frame, caster_range.inverse_distance, p0, p1, p2);
    if (!outline.exists || outline.low.z >= caster_range.farthest || !can_hide(caster_range, p0, normal)) {
        return;
    }
    let low = max(outline.low, vec3<f32>(caster_range.hull_low, -1e30));
    let high = min(outline.high, vec3<f32>(caster_range.hull_high, caster_range.farthest));
    if (low.x > high.x || low.y > high.y) {
        return;
    }
    for (var axis = 0u; axis < 3u; axis++) {
        atomicMax(&caster_bounds.low[axis], ~key_of(low[axis]));
        atomicMax(&caster_bounds.high[axis], key_of(high[axis]));
    }
    atomicAdd(&caster_bounds.count, 1u);
    // The way from the centre of projection to the middle of the triangle, all in the scene's own space.
    let middle = (p0 + p1 + p2) / 3.0;
    let eye_way = (middle - layer_frame.origin) * caster_range.inverse_distance + layer_frame.row_z;
    let cosine = abs(dot(normal, eye_way)) / max(length(normal) * length(eye_way), 1e-30);
    let unit = 0.25 * 4194304.0 / max(dot(caster_range.box_half, caster_range.box_half), 1e-30);
    let area = u32(min(0.5 * length(normal) * unit, 4194304.0));
    atomicAdd(&caster_bounds.area, area);
    if (cosine < EDGE_ON) {
        atomicAdd(&caster_bounds.edge_on, area);
    }
}
