// Draws silhouettes into the distortion map: each is extruded along its normal into a quad across the light's view, to either side of the
// hard shadow's border, and around its ends, so that nothing is missing at convex corners. Where quads overlap, the nearest silhouette stays.
//#import shared/shadow_view.wgsl
//#import shared/light_silhouette.wgsl
//#import occlusion_camera/camera.wgsl

struct MapLayer {
    layer: u32,          // of the depth map
    reserved0: u32,
    reserved1: u32,
    reserved2: u32,
}

@group(0) @binding(0) var<uniform> shadow_view: ShadowView;
@group(0) @binding(1) var<uniform> camera_light: CameraLight;
@group(0) @binding(2) var<uniform> map_layer: MapLayer;
@group(0) @binding(3) var<storage, read> silhouettes: array<LightSilhouette>;
@group(0) @binding(4) var depth_map: texture_2d_array<f32>;

struct Drawn {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) ends: vec4<f32>,       // images of both ends
    @location(1) @interpolate(flat) depths: vec2<f32>,
    @location(2) @interpolate(flat) normal: vec2<f32>,
    @location(3) @interpolate(flat) edge: u32,
}

// Ends nearer to the eye's own plane than this share of their distance are cut there: what such an edge shades lies outside of the image.
const STEEPEST: f32 = 1.0 / 64.0;

// Depth of what the light's centre sees there.
fn seen_depth(axes: ImageAxes, image: vec2<f32>) -> f32 {
    let texel = floor(texel_of(shadow_view, axes, image));
    let last = shadow_view.resolution - 1.0;
    let is_within = all(texel >= vec2<f32>(0.0)) && all(texel <= vec2<f32>(last));
    let at = vec2<u32>(clamp(texel, vec2<f32>(0.0), vec2<f32>(last)));
    let stored = select(0.0, textureLoad(depth_map, at, map_layer.layer, 0).x, is_within);
    let depth = select((1.0 - stored) * shadow_view.near, shadow_view.near / max(stored, 1e-30), shadow_view.perspective > 0.0);
    return select(exit_depth(shadow_view, axes, camera_light, image), depth, stored > 0.0);
}

// Out of sight.
fn nothing() -> Drawn {
    return Drawn(vec4<f32>(0.0, 0.0, 0.0, 1.0), vec4<f32>(0.0), vec2<f32>(1.0), vec2<f32>(1.0, 0.0), 0u);
}

// How much longer than the edge a quad is at its outer border, at either end, as a share of its width: at a corner of 90 degrees two quads
// share the gap.
const SPLAY: f32 = 1.2;

fn extruded(index: u32, side: f32) -> Drawn {
    let view = shadow_view;
    let axes = image_axes(view);
    let silhouette = silhouettes[index / 6u];
    var a = silhouette.low - view.eye;
    var b = silhouette.high - view.eye;
    let nearest = max(view.near, (length(a) + length(b)) * STEEPEST);
    let heights = vec2<f32>(dot(view.forward, a), dot(view.forward, b)) - nearest;
    if (view.perspective > 0.0) {
        if (heights.x < 0.0 && heights.y < 0.0) {
            return nothing();
        }
        let cut = a + (b - a) * clamp(heights.x / select(heights.x - heights.y, 1e-30, heights.x == heights.y), 0.0, 1.0);
        a = select(a, cut, heights.x < 0.0);
        b = select(b, cut, heights.y < 0.0);
    }
    let at_a = image_of(view, axes, a);
    let at_b = image_of(view, axes, b);
    let along = at_b.xy - at_a.xy;
    let extent = length(along);
    let tangent = select(vec2<f32>(1.0, 0.0), along / max(extent, 1e-30), extent > 0.0);
    // Left of low -> high as seen from the light: across the way, then across the view.
    let left = cross(axes.x * tangent.x + axes.y * tangent.y, view.forward);
    let normal = vec2<f32>(dot(axes.x, left), dot(axes.y, left)) * select(1.0, -1.0, silhouette.weight > 0);
    // The farthest that is seen past it. An edge with its own body behind it shades little, and needs no large quad.
    var far = 0.0;
    for (var i = 0u; i < 15u; i++) {
        let past = array<f32, 3>(3.0, 12.0, 48.0)[i % 3u] * view.texel;
        far = max(far, seen_depth(axes, at_a.xy + along * (0.25 * f32(i / 3u)) + normal * past));
    }
    let lean = select(0.0, max(dot(at_a.xy, at_a.xy), dot(at_b.xy, at_b.xy)), view.perspective > 0.0);
    let most = separation(view, min(at_a.z, at_b.z), far) * RANGE;
    if (most <= 0.0) {
        return nothing();
    }
    let reach = camera_light.half_size * sqrt(1.0 + lean) * most + MARGIN * view.texel;
    // Two triangles, 0 1 2 and 2 1 3.
    let corner = select(index % 6u, 6u - index % 6u, index % 6u >= 3u);
    let is_end = corner == 1u || corner == 3u;
    let is_out = corner >= 2u;
    let longer = select(MARGIN * view.texel, reach * SPLAY, is_out);
    let start = select(at_a.xy - tangent * longer, at_b.xy + tangent * longer, is_end);
    let image = start + normal * side * select(-MARGIN * view.texel, reach, is_out);
    let clip = vec4<f32>(image / axes.tangents, 0.5, 1.0);
    return Drawn(clip, vec4<f32>(at_a.xy, at_b.xy), vec2<f32>(at_a.z, at_b.z), normal, silhouette.edge + 1u);
}

@vertex
fn extrude_outside(@builtin(vertex_index) index: u32) -> Drawn {
    return extruded(index, 1.0);
}

@vertex
fn extrude_inside(@builtin(vertex_index) index: u32) -> Drawn {
    return extruded(index, -1.0);
}

struct Texel {
    @location(0) silhouette: vec4<f32>,
    @location(1) depths: vec4<f32>,
    @builtin(frag_depth) distance: f32,
}

fn distorted(drawn: Drawn, side: f32) -> Texel {
    let view = shadow_view;
    let axes = image_axes(view);
    let image = image_of_texel(view, axes, drawn.clip.xy * COARSER);
    let along = drawn.ends.zw - drawn.ends.xy;
    let share = clamp(dot(image - drawn.ends.xy, along) / max(dot(along, along), 1e-30), 0.0, 1.0);
    let point = drawn.ends.xy + along * share;
    let inverse = 1.0 / mix(1.0 / drawn.depths.x, 1.0 / drawn.depths.y, share);
    let near = select(mix(drawn.depths.x, drawn.depths.y, share), inverse, view.perspective > 0.0);
    let offset = image - point;
    let distance = length(offset);
    let across = dot(offset, drawn.normal) * side;
    // Around an end the way from it is the normal.
    let is_around = (share <= 0.0 || share >= 1.0) && across > 0.0;
    let normal = select(drawn.normal, offset * (side / max(distance, 1e-30)), is_around);
    let past = point + normal * (3.0 * view.texel);
    let far = max(seen_depth(axes, past), seen_depth(axes, point + normal * distance));
    let plane = axes.x * normal.x + axes.y * normal.y;
    let lean = select(0.0, dot(normal, point), view.perspective > 0.0);
    let size = reach_of(camera_light, half_plane(camera_light, plane - view.forward * lean, 0.0));
    let reach = size * separation(view, near, far) * RANGE;
    // Penumbrae narrower than a texel of the depth map are as well without.
    if (across < -MARGIN * view.texel || reach < view.texel || distance > reach + MARGIN * view.texel) {
        discard;
    }
    return Texel(vec4<f32>(point, normal), vec4<f32>(near, far, f32(drawn.edge), 0.0), distance / (1.0 + distance));
}

@fragment
fn distort_outside(drawn: Drawn) -> Texel {
    return distorted(drawn, 1.0);
}

@fragment
fn distort_inside(drawn: Drawn) -> Texel {
    return distorted(drawn, -1.0);
}
