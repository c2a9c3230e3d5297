// All rays from one receiver to the light as one interval: along each axis they cover [t·low, t·high].
// Wald, Ize, Kensler, Knoll, Parker 2006, section 3.
//#import shared/light.wgsl
//#import ray_traced/hierarchy.wgsl

// Share of the pad by which a box may lie below the receiver's plane and still count: 6.4 u, more than rounding costs, and less
// than the receiver's lift, so that what lies in its own plane stays below.
const HORIZON_SLACK: f32 = 0.4;

struct Bundle {
    origin: vec3<f32>,
    pad: f32,
    low: vec3<f32>,
    end: f32,
    high: vec3<f32>,
    has_horizon: bool,
    inverse_low: vec3<f32>,
    inverse_high: vec3<f32>,
    normal: vec3<f32>,
}

fn bundle_of(receiver: Receiver, ways: WayBounds, unbounded: bool) -> Bundle {
    var bundle: Bundle;
    bundle.origin = receiver.position;
    bundle.pad = box_pad(receiver.position);
    bundle.low = ways.low;
    bundle.high = ways.high;
    bundle.end = select(1.0, 1e30, unbounded);
    bundle.inverse_low = safe_reciprocal(ways.low);
    bundle.inverse_high = safe_reciprocal(ways.high);
    bundle.has_horizon = receiver.kind == RECEIVER_SURFACE;
    bundle.normal = receiver.normal;
    return bundle;
}

// Whether any ray of the bundle can meet the box, above the receiver's own plane.
fn bundle_meets(bundle: Bundle, box: BvhNode) -> bool {
    let low = box.low - bundle.origin;
    let high = box.high - bundle.origin;
    // t must reach the box with both ends of the interval.
    let t_low = (low - bundle.pad) * bundle.inverse_high;
    let t_high = (high + bundle.pad) * bundle.inverse_low;
    let zero = vec3<f32>(0.0);
    let endless = vec3<f32>(1e30);
    let enters = max(select(zero, t_low, bundle.high > zero), select(zero, t_high, bundle.low < zero));
    let leaves = min(select(endless, t_low, bundle.high < zero), select(endless, t_high, bundle.low > zero));
    let begin = max(0.0, max(enters.x, max(enters.y, enters.z)));
    let end = min(bundle.end, min(leaves.x, min(leaves.y, leaves.z)));
    // What lies below the receiver's own plane lies between it and no visible sample.
    let top = dot(max(bundle.normal * low, bundle.normal * high), vec3<f32>(1.0));
    return begin <= end * 1.00001 && (!bundle.has_horizon || top >= -HORIZON_SLACK * bundle.pad);
}
