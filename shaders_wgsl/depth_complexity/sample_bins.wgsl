// Which samples lie in a part of the light: for either axis, the samples before each of 63 strips, one bit a sample.
//#import depth_complexity/frame.wgsl

const BINS: u32 = 63u;

struct SampleBins {
    low: vec2<f32>,      // of the samples
    scale: vec2<f32>,    // strips in one unit
    before: array<vec4<u32>, 64>,  // samples before strip i along x, and along y; the last row are all
}

// What bounds images on the light, as far as rounding lets them be trusted. What lies beside or behind the receiver has an image that
// runs out to infinity: there the guarded denominators widen the bounds beyond every sample.
struct ImageBounds {
    low: vec2<f32>,
    high: vec2<f32>,
    beyond: bool,        // all of it lies behind the receiver, or to one side of the light
}

// A box of this middle and half size. `slack` is what rounding can have cost the image of a point.
//
// Distances from the image of the middle: (x - q·z) / z, where the numerator is 0 in the middle.
fn bounds_of_box(frame: LightFrame, view: FrameView, middle: vec3<f32>, half: vec3<f32>, slack: vec3<f32>) -> ImageBounds {
    let at = project(view, middle - view.position);
    let depth = dot(abs(view.z_row), half) + slack.z;
    let nearest = at.z - depth;
    let q = at.xy / max(at.z, 1e-37);
    let x = dot(abs(view.x_row - view.z_row * q.x), half) + slack.x + abs(q.x) * slack.z;
    let y = dot(abs(view.y_row - view.z_row * q.y), half) + slack.y + abs(q.y) * slack.z;
    let reach = vec2<f32>(x, y) / max(nearest, 1e-37);
    let right = at.x - frame.high.x * at.z > dot(abs(view.x_row - view.z_row * frame.high.x), half) + slack.x + abs(frame.high.x) * slack.z;
    let left = frame.low.x * at.z - at.x > dot(abs(view.x_row - view.z_row * frame.low.x), half) + slack.x + abs(frame.low.x) * slack.z;
    let over = at.y - frame.high.y * at.z > dot(abs(view.y_row - view.z_row * frame.high.y), half) + slack.y + abs(frame.high.y) * slack.z;
    let under = frame.low.y * at.z - at.y > dot(abs(view.y_row - view.z_row * frame.low.y), half) + slack.y + abs(frame.low.y) * slack.z;
    return ImageBounds(q - reach, q + reach, right || left || over || under || at.z + depth <= 0.0);
}

// Four corners.
fn bounds_of_corners(frame: LightFrame, a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, d: vec3<f32>, slack: vec3<f32>) -> ImageBounds {
    let x = vec4<f32>(a.x, b.x, c.x, d.x);
    let y = vec4<f32>(a.y, b.y, c.y, d.y);
    let z = vec4<f32>(a.z, b.z, c.z, d.z);
    let nearest = least(z) - slack.z;
    let share = 1.0 / max(z, vec4<f32>(1e-37));
    let low = vec2<f32>(least(x * share), least(y * share));
    let high = vec2<f32>(-least(-x * share), -least(-y * share));
    let pad = (slack.xy + max(abs(low), abs(high)) * slack.z) / max(nearest, 1e-37);
    let right = least(x - frame.high.x * z) > slack.x + abs(frame.high.x) * slack.z;
    let left = least(frame.low.x * z - x) > slack.x + abs(frame.low.x) * slack.z;
    let over = least(y - frame.high.y * z) > slack.y + abs(frame.high.y) * slack.z;
    let under = least(frame.low.y * z - y) > slack.y + abs(frame.low.y) * slack.z;
    let is_behind = -least(-z) + slack.z <= 0.0;
    return ImageBounds(low - pad, high + pad, right || left || over || under || is_behind);
}

fn least(v: vec4<f32>) -> f32 {
    return min(min(v.x, v.y), min(v.z, v.w));
}

// The first strip that bounds reach into, and the one after the last.
fn strips(low: f32, high: f32, scale: f32) -> vec2<u32> {
    let first = clamp(floor(low * scale), 0.0, f32(BINS));
    let end = clamp(floor(high * scale) + 1.0, 0.0, f32(BINS));
    return vec2<u32>(u32(first), u32(end));
}
