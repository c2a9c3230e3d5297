// The image of an edge on the light: its line, and the directions of its ends. The twin of `depth_complexity/edge.rs`.
//#import depth_complexity/frame.wgsl
//#import shared/occluders.wgsl

struct EdgeImage {
    low: vec3<f32>,
    high: vec3<f32>,
    line: vec3<f32>,       // line·(x, y, 1) is positive left of it
    left: bool,            // whether the reference point lies left of it
}

// What a rounded product leaves out, exactly: halves of twelve bits have products without rounding. Found by masking, because a driver
// that fuses operations would undo a split by subtraction.
fn product_error(a: f32, b: f32, rounded: f32) -> f32 {
    let a_high = bitcast<f32>(bitcast<u32>(a) & 0xfffff000u);
    let b_high = bitcast<f32>(bitcast<u32>(b) & 0xfffff000u);
    let a_low = a - a_high;
    let b_low = b - b_high;
    return ((a_high * b_high - rounded) + a_high * b_low + a_low * b_high) + a_low * b_low;
}

// Whether b lies left of a, or in line with it: the exact sign. The signs at the three edges of a face have to fit each other, or c counts
// as hidden by a face that it lies in one plane with, and no edge takes that back. Unequal products have the sign of their difference.
fn is_left(a: vec2<f32>, b: vec2<f32>) -> bool {
    let p = a.x * b.y;
    let q = a.y * b.x;
    return select(p > q, product_error(a.x, b.y, p) >= product_error(a.y, b.x, q), p == q);
}

// The line is the product of the nearer end's image and of the edge's image: a short edge far away has corners whose images agree in
// nearly all digits. The side of the reference point is that of the corners' images, which sectors are made of: a side that contradicts
// them would tear the image.
fn edge_image(view: FrameView, edge: OccluderEdge) -> EdgeImage {
    let low = project(view, edge.low - view.position);
    let high = project(view, edge.high - view.position);
    let low_is_nearer = dot(abs(low), vec3<f32>(1.0)) <= dot(abs(high), vec3<f32>(1.0));
    let line = cross(select(high, low, low_is_nearer), project(view, edge.high - edge.low));
    return EdgeImage(low, high, line, is_left(low.xy, high.xy));
}

// Whether the image can be crossed on the way from the reference point to the light at all: some of it lies ahead, before a
// sphere's disc, and not wholly beyond one side of the light's bounds.
fn image_matters(frame: LightFrame, image: EdgeImage) -> bool {
    let a = image.low;
    let b = image.high;
    let beyond = (a.x > frame.high.x * a.z && b.x > frame.high.x * b.z)
        || (a.x < frame.low.x * a.z && b.x < frame.low.x * b.z)
        || (a.y > frame.high.y * a.z && b.y > frame.high.y * b.z)
        || (a.y < frame.low.y * a.z && b.y < frame.low.y * b.z);
    return !beyond && (a.z > 0.0 || b.z > 0.0);
}

// The part before a sphere's disc; nothing of it lies ahead when there is none.
fn before_limit(view: FrameView, edge: OccluderEdge, whole: EdgeImage) -> EdgeImage {
    var image = whole;
    if (view.limited) {
        let low = dot(view.towards, edge.low - view.position);
        let high = dot(view.towards, edge.high - view.position);
        let low_is_before = low < view.limit;
        let high_is_before = high < view.limit;
        let span = high - low;
        let t = (view.limit - low) / select(span, 1.0, span == 0.0);
        let cut = image.low + (image.high - image.low) * t;
        image.low = select(select(cut, vec3<f32>(0.0), !high_is_before), image.low, low_is_before);
        image.high = select(select(cut, vec3<f32>(0.0), !low_is_before), image.high, high_is_before);
    }
    return image;
}

// Directions of the ends from the reference point. An end behind the receiver is replaced by where the edge crosses the plane through
// the receiver along the light, infinitely far: a direction.
fn along_image(image: EdgeImage) -> vec2<f32> {
    return image.high.xy * image.low.z - image.low.xy * image.high.z;
}

fn low_direction(image: EdgeImage) -> vec2<f32> {
    return select(-along_image(image), image.low.xy, image.low.z > 0.0);
}

fn high_direction(image: EdgeImage) -> vec2<f32> {
    return select(along_image(image), image.high.xy, image.high.z > 0.0);
}

// On which side of the line the reference point counts. Where the line passes it within rounding, the line's own sign is noise: with the
// reference point between the ends the sector is nearly a half plane, and the corners say which.
fn line_left(image: EdgeImage, low: vec2<f32>, high: vec2<f32>) -> bool {
    return select(image.line.z >= 0.0, image.left, dot(low, high) < 0.0);
}
