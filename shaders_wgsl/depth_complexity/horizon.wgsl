// The receiver's own plane on the light: samples where slope.x·x + slope.y·y + slope.z <= 0 are hidden.
//#import shared/receiver.wgsl
//#import depth_complexity/frame.wgsl

fn horizon_slope(view: FrameView, receiver: Receiver) -> vec3<f32> {
    return vec3<f32>(dot(receiver.normal, view.x_way), dot(receiver.normal, view.y_way), dot(receiver.normal, view.way));
}

// Whether the whole light lies above it.
fn is_above_horizon(frame: LightFrame, receiver: Receiver, slope: vec3<f32>) -> bool {
    let lowest = min(slope.x * frame.low.x, slope.x * frame.high.x) + min(slope.y * frame.low.y, slope.y * frame.high.y);
    return receiver.kind != RECEIVER_SURFACE || slope.z + lowest > 0.0;
}
