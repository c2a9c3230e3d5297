// Draws cones and sheets of silhouette edges into the penumbra map. What is drawn is a hull in the map; each fragment asks the edge itself
// what the surface in its texel sees of the light, and writes that as its depth: the darkest is the nearest, in any order.
//#import shared/shadow_view.wgsl
//#import shared/light_silhouette.wgsl
//#import penumbra_map/light.wgsl
//#import penumbra_map/hull.wgsl
//#import penumbra_map/intensity.wgsl

@group(0) @binding(0) var<uniform> shadow_view: ShadowView;
@group(0) @binding(1) var<uniform> penumbra_light: PenumbraLight;
@group(0) @binding(2) var<uniform> map_layer: MapLayer;
@group(0) @binding(3) var<storage, read> silhouettes: array<LightSilhouette>;
@group(0) @binding(4) var depth_map: texture_2d_array<f32>;

struct Drawn {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) low: vec3<f32>,
    @location(1) @interpolate(flat) high: vec3<f32>,
}

const HULL_CORNERS: u32 = 3u * HULL_TRIANGLES;

fn whole_map(triangle: u32, corner: u32) -> vec4<f32> {
    let whole = vec2<f32>(select(-1.0, 3.0, corner == 2u), select(-1.0, 3.0, corner == 1u));
    return vec4<f32>(select(vec2<f32>(0.0), whole, triangle == 0u), 0.5, 1.0);
}

// Clip coordinates of a place, or of a way where the view is a perspective.
fn clip_of(axes: Axes, at: vec2<f32>) -> vec4<f32> {
    let p = axes.x * at.x + axes.y * at.y + axes.z;
    let w = select(1.0, dot(shadow_view.forward, p), shadow_view.perspective > 0.0);
    // Depths come from fragments: half way is within the clip space of every interface.
    return vec4<f32>(dot(shadow_view.clip_x, p), dot(shadow_view.clip_y, p), 0.5 * w, w);
}

// Half of the work of every vertex shader below: where an edge's hexagon has its corner.
struct Frame {
    axes: Axes,
    a: EndImage,
    b: EndImage,
    out: vec2<f32>,      // unit, to the side with fewer layers
    along: vec2<f32>,
    margin: f32,
    reach: f32,
}

fn frame_of(axes: Axes, a: EndImage, b: EndImage, weight: i32) -> Frame {
    let way = b.at - a.at;
    let span = length(way);
    let along = select(vec2<f32>(1.0, 0.0), way / max(span, 1e-30), span > 0.0);
    // The light looks along z: there are more layers on the left, against (-y, x), where the weight is positive.
    let out = vec2<f32>(-along.y, along.x) * select(-1.0, 1.0, weight > 0);
    let slant = select(0.0, 1.0, shadow_view.perspective > 0.0);
    let slope = max(dot(a.at, a.at), dot(b.at, b.at)) * slant;
    let margin = TEXEL_MARGIN * 2.0 * shadow_view.texel * (1.0 + slope);
    return Frame(axes, a, b, out, along, margin, max(a.reach, b.reach));
}

fn drawn_corner(frame: Frame, support: Support, index: u32) -> vec4<f32> {
    let triangle = (index / 3u) % HULL_TRIANGLES;
    let corner = index % 3u;
    let is_bounded = frame.a.bounded && frame.b.bounded && frame.reach * max(support.out, support.ahead) < STEEPEST;
    let place = hexagon_corner(hull_index(triangle, corner), support, frame.margin);
    let end = select(frame.a.at, frame.b.at, place.z > 0.5);
    let at = end + frame.along * place.x + frame.out * place.y;
    return select(whole_map(triangle, corner), clip_of(frame.axes, at), is_bounded);
}

fn scaled(support: Support, reach: f32) -> Support {
    return Support(
        support.back * reach, support.back_out * reach, support.out * reach, support.ahead_out * reach, support.ahead * reach,
    );
}

fn round_support(frame: Frame) -> Support {
    let r = support_of_disc(penumbra_light) * frame.reach;
    return Support(r, r, r, r, r);
}

fn in_light_frame(place: vec3<f32>) -> vec3<f32> {
    return in_axes(fixed_axes(penumbra_light), place - shadow_view.eye);
}

@vertex
fn extrude_disc(@builtin(vertex_index) index: u32) -> Drawn {
    let edge = silhouettes[index / HULL_CORNERS];
    let low = in_light_frame(edge.low);
    let high = in_light_frame(edge.high);
    let frame = frame_of(fixed_axes(penumbra_light), flat_end(penumbra_light, low), flat_end(penumbra_light, high), edge.weight);
    return Drawn(drawn_corner(frame, round_support(frame), index), low, high);
}

@vertex
fn extrude_sun(@builtin(vertex_index) index: u32) -> Drawn {
    let edge = silhouettes[index / HULL_CORNERS];
    let low = in_light_frame(edge.low);
    let high = in_light_frame(edge.high);
    var axes = fixed_axes(penumbra_light);
    // Along the way of the light nothing moves in the map.
    axes.z = vec3<f32>(0.0);
    let frame = frame_of(axes, sun_end(penumbra_light, low), sun_end(penumbra_light, high), edge.weight);
    return Drawn(drawn_corner(frame, round_support(frame), index), low, high);
}

@vertex
fn extrude_sphere(@builtin(vertex_index) index: u32) -> Drawn {
    let edge = silhouettes[index / HULL_CORNERS];
    let low = edge.low - shadow_view.eye;
    let high = edge.high - shadow_view.eye;
    let axes = axes_towards(low + high);
    let a = sphere_end(penumbra_light, in_axes(axes, low));
    let b = sphere_end(penumbra_light, in_axes(axes, high));
    let frame = frame_of(axes, a, b, edge.weight);
    return Drawn(drawn_corner(frame, round_support(frame), index), low, high);
}

@vertex
fn extrude_rectangle(@builtin(vertex_index) index: u32) -> Drawn {
    let edge = silhouettes[index / HULL_CORNERS];
    let low = in_light_frame(edge.low);
    let high = in_light_frame(edge.high);
    let frame = frame_of(fixed_axes(penumbra_light), flat_end(penumbra_light, low), flat_end(penumbra_light, high), edge.weight);
    let d = frame.along;
    let n = frame.out;
    let support = Support(
        support_of_rectangle(penumbra_light, d), support_of_rectangle(penumbra_light, (n - d) * DIAGONAL),
        support_of_rectangle(penumbra_light, n), support_of_rectangle(penumbra_light, (n + d) * DIAGONAL),
        support_of_rectangle(penumbra_light, d),
    );
    return Drawn(drawn_corner(frame, scaled(support, frame.reach), index), low, high);
}

fn support_of_polygon(way: vec2<f32>) -> f32 {
    var farthest = 0.0;
    for (var i = 0u; i < penumbra_light.corner_count; i++) {
        farthest = max(farthest, -dot(way, penumbra_light.outline[i].xy));
    }
    return farthest;
}

@vertex
fn extrude_polygon(@builtin(vertex_index) index: u32) -> Drawn {
    let edge = silhouettes[index / HULL_CORNERS];
    let low = in_light_frame(edge.low);
    let high = in_light_frame(edge.high);
    let frame = frame_of(fixed_axes(penumbra_light), flat_end(penumbra_light, low), flat_end(penumbra_light, high), edge.weight);
    let d = frame.along;
    let n = frame.out;
    let support = Support(
        support_of_polygon(-d), support_of_polygon((n - d) * DIAGONAL), support_of_polygon(n),
        support_of_polygon((n + d) * DIAGONAL), support_of_polygon(d),
    );
    return Drawn(drawn_corner(frame, scaled(support, frame.reach), index), low, high);
}

// What a texel shows, relative to the eye.
struct Surface {
    place: vec3<f32>,
    exists: bool,
}

fn surface_at(clip: vec4<f32>) -> Surface {
    let stored = textureLoad(depth_map, vec2<u32>(clip.xy), map_layer.layer, 0).x;
    let ndc = (clip.xy / shadow_view.resolution - 0.5) * vec2<f32>(2.0, -2.0);
    let x_axis = shadow_view.clip_x / dot(shadow_view.clip_x, shadow_view.clip_x);
    let y_axis = shadow_view.clip_y / dot(shadow_view.clip_y, shadow_view.clip_y);
    let is_face = shadow_view.perspective > 0.0;
    let depth = select((1.0 - stored) * shadow_view.near, shadow_view.near / max(stored, 1e-30), is_face);
    let scale = select(1.0, depth, is_face);
    return Surface(shadow_view.forward * depth + (x_axis * ndc.x + y_axis * ndc.y) * scale, stored > 0.0);
}

// The depth of a fragment that nothing can pass, and that passes nothing.
const LIT: f32 = 1.0;

// Of lights whose share depends on the distance alone.
fn round_share(image: EdgeImage, radius: f32, depth: f32, slant: f32) -> f32 {
    let nearest = nearest_to_disc(image, radius);
    let linear = min(nearest.distance, 1.0);
    var share = linear;
    if (penumbra_light.ramp == RAMP_LIGHT) {
        share = disc_share(2.0 * linear - 1.0);
    } else if (penumbra_light.ramp == RAMP_PAPER) {
        share = paper_share(Nearest(linear, nearest.height), depth, slant);
    }
    return select(LIT, share, nearest.distance < 1.0);
}

@fragment
fn shade_disc(drawn: Drawn) -> @builtin(frag_depth) f32 {
    let surface = surface_at(drawn.clip);
    let p = in_axes(fixed_axes(penumbra_light), surface.place);
    let image = edge_image(drawn.low, drawn.high, p, 1.0);
    let share = round_share(image, penumbra_light.radius, p.z, 1.0);
    return select(LIT, share, surface.exists && image.exists && p.z > 0.0);
}

@fragment
fn shade_sun(drawn: Drawn) -> @builtin(frag_depth) f32 {
    let surface = surface_at(drawn.clip);
    let p = in_axes(fixed_axes(penumbra_light), surface.place);
    let image = edge_image(drawn.low, drawn.high, p, 0.0);
    let share = round_share(image, penumbra_light.radius, p.z, 0.0);
    return select(LIT, share, surface.exists && image.exists);
}

@fragment
fn shade_sphere(drawn: Drawn) -> @builtin(frag_depth) f32 {
    let surface = surface_at(drawn.clip);
    let axes = axes_towards(surface.place);
    let p = vec3<f32>(0.0, 0.0, length(surface.place));
    let image = edge_image(in_axes(axes, drawn.low), in_axes(axes, drawn.high), p, 1.0);
    // The disc that the surface sees of it.
    let sine = penumbra_light.radius / max(p.z, 1e-30);
    let radius = penumbra_light.radius / sqrt(max(1.0 - sine * sine, 1e-6));
    let share = round_share(image, radius, p.z, 1.0);
    return select(LIT, share, surface.exists && image.exists && sine < 1.0);
}

@fragment
fn shade_rectangle(drawn: Drawn) -> @builtin(frag_depth) f32 {
    let surface = surface_at(drawn.clip);
    let p = in_axes(fixed_axes(penumbra_light), surface.place);
    let image = on_unit_square(edge_image(drawn.low, drawn.high, p, 1.0), penumbra_light.half_size);
    let nearest = nearest_to_square(image);
    let linear = min(nearest.distance, 1.0);
    var share = linear;
    if (penumbra_light.ramp == RAMP_LIGHT) {
        share = square_share(2.0 * linear - 1.0, image.along);
    } else if (penumbra_light.ramp == RAMP_PAPER) {
        share = paper_share(Nearest(linear, nearest.height), p.z, 1.0);
    }
    return select(LIT, share, surface.exists && image.exists && p.z > 0.0 && nearest.distance < 1.0);
}

// The line of a convex outline that is farthest along the image at `x`: its value at 0, and its slope.
fn farthest_line(image: EdgeImage, x: f32) -> vec2<f32> {
    var best = vec2<f32>(0.0);
    var value = -1e30;
    for (var i = 0u; i < penumbra_light.corner_count; i++) {
        let line = penumbra_light.outline[i].zw;
        let of_line = vec2<f32>(dot(line, image.start), dot(line, image.along));
        let here = of_line.x + of_line.y * x;
        best = select(best, of_line, here > value);
        value = max(value, here);
    }
    return best;
}

// The same, for the largest of many lines: the crossing of one that falls and one that rises, until no line is above it.
fn nearest_to_polygon(image: EdgeImage) -> Nearest {
    var falling = farthest_line(image, 0.0);
    var rising = farthest_line(image, image.span);
    if (falling.y >= 0.0) {
        return nearest_at(image, 0.0, falling.x);
    }
    if (rising.y <= 0.0) {
        return nearest_at(image, image.span, rising.x + rising.y * image.span);
    }
    var x = 0.0;
    for (var i = 0u; i < penumbra_light.corner_count; i++) {
        x = clamp((rising.x - falling.x) / (falling.y - rising.y), 0.0, image.span);
        let line = farthest_line(image, x);
        if (line.y < 0.0) {
            falling = line;
        } else {
            rising = line;
        }
    }
    return nearest_at(image, x, max(falling.x + falling.y * x, rising.x + rising.y * x));
}

fn positive_square(x: f32) -> f32 {
    let positive = max(x, 0.0);
    return positive * positive;
}

// The same of the polygon: the area nearer than a line that lies beyond the image's side, by Green's theorem.
fn polygon_share(t: f32, image: EdgeImage) -> f32 {
    let across = vec2<f32>(-image.along.y, image.along.x);
    let normal = select(-across, across, dot(across, image.start) >= 0.0);
    let tangent = vec2<f32>(-normal.y, normal.x);
    var low = 1e30;
    var high = -1e30;
    for (var i = 0u; i < penumbra_light.corner_count; i++) {
        let at = dot(normal, penumbra_light.outline[i].xy);
        low = min(low, at);
        high = max(high, at);
    }
    let line = mix(low, high, 0.5 + 0.5 * t);
    var area = 0.0;
    var before = penumbra_light.outline[penumbra_light.corner_count - 1u].xy;
    for (var i = 0u; i < penumbra_light.corner_count; i++) {
        let corner = penumbra_light.outline[i].xy;
        let x0 = dot(normal, before);
        let x1 = dot(normal, corner);
        let rise = abs(x1 - x0);
        // The mean of the smaller of `line` and a side's own distance.
        let short = (positive_square(line - min(x0, x1)) - positive_square(line - max(x0, x1))) / max(2.0 * rise, 1e-30);
        let mean = select(line - short, min(line, x0), rise < 1e-6 * (high - low));
        area += mean * dot(tangent, corner - before);
        before = corner;
    }
    return clamp(area / penumbra_light.area, 0.0, 1.0);
}

@fragment
fn shade_polygon(drawn: Drawn) -> @builtin(frag_depth) f32 {
    let surface = surface_at(drawn.clip);
    let p = in_axes(fixed_axes(penumbra_light), surface.place);
    let image = edge_image(drawn.low, drawn.high, p, 1.0);
    let nearest = nearest_to_polygon(image);
    let linear = clamp(nearest.distance, 0.0, 1.0);
    var share = linear;
    if (penumbra_light.ramp == RAMP_LIGHT) {
        share = polygon_share(2.0 * linear - 1.0, image);
    } else if (penumbra_light.ramp == RAMP_PAPER) {
        share = paper_share(Nearest(linear, nearest.height), p.z, 1.0);
    }
    return select(LIT, share, surface.exists && image.exists && p.z > 0.0 && nearest.distance < 1.0);
}
