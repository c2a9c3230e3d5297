// How much of the light a surface sees past a silhouette edge, by where the edge stands before the light.
//
// Seen from the surface, the edge has an image in the light's plane. A cone or sheet whose fragment lies at depth z(F), between the occluder at
// z(V) and the surface at z(P), stands for the share I = (1/z(V) - 1/z(F)) / (1/z(V) - 1/z(P)): just the distance of that image from the
// light's centre, in units of the light's outline. So it is taken of the image, where cones and sheets are one thing, warped sheets are
// exact, and nothing is interpolated.
//#import penumbra_map/light.wgsl

// An edge's image; `along` is a unit vector.
struct EdgeImage {
    start: vec2<f32>,
    along: vec2<f32>,
    span: f32,
    heights: vec2<f32>,   // of the ends over the surface, towards the light
    exists: bool,         // false for an edge that is not above the surface
}

// The image's place that is nearest to the light's centre.
struct Nearest {
    distance: f32,        // 0 at the centre, 1 on the outline
    height: f32,          // of the edge over the surface there
}

// So many last places of a depth are no height: in contact the shadow is hard.
const CONTACT: f32 = 4.0 * 1.1920929e-7;

// `low` and `high` are places of an edge, `p` of a surface; `slant` is 1 for lights at a distance, 0 for a sun.
fn edge_image(low: vec3<f32>, high: vec3<f32>, p: vec3<f32>, slant: f32) -> EdgeImage {
    let a = low - p;
    let b = high - p;
    let least = max(CONTACT * max(abs(p.z), max(abs(low.z), abs(high.z))), 1e-30);
    // What lies lower than that is cut off.
    let fall = b.z - a.z;
    let cut = clamp((-least - a.z) / select(fall, 1.0, fall == 0.0), 0.0, 1.0);
    let cut_place = vec3<f32>(mix(a.xy, b.xy, cut), -least);
    let start = select(a, cut_place, -a.z < least);
    let end = select(b, cut_place, -b.z < least);
    // Sun: the way to the edge, at distance 1. Else that way's end in the light's plane.
    let scale = mix(1.0, p.z, slant);
    let image_a = (start.xy * scale - p.xy * start.z * slant) / -start.z;
    let image_b = (end.xy * scale - p.xy * end.z * slant) / -end.z;
    // The line starts at the nearer end: a far one, of an edge that meets the height of the surface, has lost the digits that matter here.
    let is_turned = dot(image_a, image_a) > dot(image_b, image_b);
    let near = select(image_a, image_b, is_turned);
    let way = select(image_b, image_a, is_turned) - near;
    let span = length(way);
    let heights = -vec2<f32>(start.z, end.z);
    var image: EdgeImage;
    image.start = near;
    image.along = select(vec2<f32>(1.0, 0.0), way / max(span, 1e-30), span > 0.0);
    image.span = span;
    image.heights = select(heights, heights.yx, is_turned);
    image.exists = max(-a.z, -b.z) > least;
    return image;
}

fn nearest_at(image: EdgeImage, x: f32, distance: f32) -> Nearest {
    let t = clamp(x / max(image.span, 1e-30), 0.0, 1.0);
    // Reciprocals of heights are linear along an image.
    let height = image.heights.x * image.heights.y / max(mix(image.heights.y, image.heights.x, t), 1e-30);
    return Nearest(distance, height);
}

fn nearest_to_disc(image: EdgeImage, radius: f32) -> Nearest {
    let x = clamp(-dot(image.start, image.along), 0.0, image.span);
    return nearest_at(image, x, length(image.start + image.along * x) / radius);
}

// The image where the rectangle is [-1, 1]².
fn on_unit_square(image: EdgeImage, half_size: vec2<f32>) -> EdgeImage {
    let way = image.along / half_size;
    let stretch = length(way);
    var scaled = image;
    scaled.start = image.start / half_size;
    scaled.along = way / stretch;
    scaled.span = image.span * stretch;
    return scaled;
}

// The larger of |x| and |y| falls and rises along a line: it is least at an end, or where both are equal.
fn nearest_to_square(image: EdgeImage) -> Nearest {
    let a = image.start;
    let d = image.along;
    let apart = vec2<f32>(d.x - d.y, d.x + d.y);
    let at = vec2<f32>(a.y - a.x, -a.x - a.y) / select(apart, vec2<f32>(1.0), apart == vec2<f32>(0.0));
    let places = array<f32, 4>(0.0, image.span, clamp(at.x, 0.0, image.span), clamp(at.y, 0.0, image.span));
    var best = 1e30;
    var x = 0.0;
    for (var i = 0u; i < 4u; i++) {
        let p = abs(a + d * places[i]);
        let distance = max(p.x, p.y);
        x = select(x, places[i], distance < best);
        best = min(best, distance);
    }
    return nearest_at(image, x, best);
}

// The share of a disc on one side of a line, which moves across it as `t` goes from -1 to 1.
fn disc_share(t: f32) -> f32 {
    return clamp(0.5 + (t * sqrt(max(1.0 - t * t, 0.0)) + asin(clamp(t, -1.0, 1.0))) * 0.31830987, 0.0, 1.0);
}

// The same of [-1, 1]² and a line of this direction.
fn square_share(t: f32, along: vec2<f32>) -> f32 {
    let long = max(abs(along.x), abs(along.y));
    let short = min(abs(along.x), abs(along.y));
    let at = abs(t) * (long + short);
    let left = long + short - at;
    let beyond = select(left * left / max(8.0 * long * short, 1e-30), 0.5 - 0.5 * at / long, at <= long - short);
    return clamp(select(beyond, 1.0 - beyond, t > 0.0), 0.0, 1.0);
}

// The paper's: I = (z(F) - z(V)) / (z(P) - z(V)), then 3 I² - 2 I³.
fn paper_share(nearest: Nearest, depth: f32, slant: f32) -> f32 {
    let occluder = mix(1.0, max(depth - nearest.height, 0.0), slant);
    let surface = mix(1.0, depth, slant);
    let i = nearest.distance * occluder / max(surface * (1.0 - nearest.distance) + nearest.distance * occluder, 1e-30);
    return clamp(i * i * (3.0 - 2.0 * i), 0.0, 1.0);
}
