// Which samples lie in a part of the light: for either axis, the samples before each of 64 strips, one bit a sample.
//#import depth_complexity/frame.wgsl

const BINS: u32 = 64u;

struct SampleBins {
    low: vec2<f32>,      // of the samples
    scale: vec2<f32>,    // strips in one unit
    before: array<vec4<u32>, 65>,  // samples before strip i along x, and along y; the last row are all
}

// What bounds images on the light, as far as rounding lets them be trusted.
struct ImageBounds {
    low: vec2<f32>,
    high: vec2<f32>,
    any_ahead: bool,
    all_ahead: bool,     // else the image runs out to infinity
    beyond: vec4<f32>,   // positive where all points lie right, left, above or below the light, wherever they are
}

fn no_image() -> ImageBounds {
    return ImageBounds(vec2<f32>(1e30), vec2<f32>(-1e30), false, true, vec4<f32>(1e30));
}

// `slack` is what rounding can have cost the image of a point.
fn bounds_with(frame: LightFrame, before: ImageBounds, image: vec3<f32>, slack: vec3<f32>) -> ImageBounds {
    let share = 1.0 / max(image.z - slack.z, 1e-37);
    let at = image.xy / max(image.z, 1e-37);
    let light = vec4<f32>(frame.high.x, -frame.low.x, frame.high.y, -frame.low.y);
    let across = vec4<f32>(image.x, -image.x, image.y, -image.y);
    let pad = (slack.xy + abs(at) * slack.z) * share;
    return ImageBounds(
        min(before.low, at - pad),
        max(before.high, at + pad),
        before.any_ahead || image.z + slack.z > 0.0,
        before.all_ahead && image.z > slack.z,
        min(before.beyond, across - light * image.z - slack.xxyy - abs(light) * slack.z),
    );
}

// The first strip that bounds reach into, and the one after the last.
fn strips(low: f32, high: f32, scale: f32) -> vec2<u32> {
    let first = clamp(floor(low * scale), 0.0, f32(BINS));
    let end = clamp(floor(high * scale) + 1.0, 0.0, f32(BINS));
    return vec2<u32>(u32(first), u32(end));
}
