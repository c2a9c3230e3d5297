// How often a face covers the reference point: its side times how often the loop of its edges' images turns around that point. The twin
// of `Loop` in `depth_of_reference.rs`.
//#import depth_complexity/edge.wgsl

// Two directions with a smaller sine between them are one, or opposite.
const NO_TURN: f32 = 1e-6;

// The images of the edges seen so far, in the order of the winding.
struct Loop {
    has_left: bool,
    has_right: bool,
    has_wide: bool,
    leaves: bool,
    returns: bool,
    outward: vec2<f32>,
    homeward: vec2<f32>,
}

fn no_loop() -> Loop {
    return Loop(false, false, false, false, false, vec2<f32>(0.0), vec2<f32>(0.0));
}

fn with_image(before: Loop, image: EdgeImage, is_forward: bool) -> Loop {
    var border = before;
    let low_is_ahead = image.low.z > 0.0;
    let high_is_ahead = image.high.z > 0.0;
    if (low_is_ahead || high_is_ahead) {
        let low = low_direction(image);
        let high = high_direction(image);
        let is_left = image.left == is_forward;
        border.has_left = border.has_left || is_left;
        border.has_right = border.has_right || !is_left;
        border.has_wide = border.has_wide || dot(low, high) < 0.0;
        let infinite = select(low, high, low_is_ahead);
        let goes_out = low_is_ahead == is_forward;
        if (low_is_ahead != high_is_ahead) {
            border.outward = select(border.outward, infinite, goes_out);
            border.homeward = select(infinite, border.homeward, goes_out);
            border.leaves = border.leaves || goes_out;
            border.returns = border.returns || !goes_out;
        }
    }
    return border;
}

fn cover(view: FrameView, face: Face, border: Loop) -> i32 {
    let side = side_of_plane(face.normal, face.point, face.flatness, view.position);
    let all_left = border.has_left && !border.has_right;
    let all_right = border.has_right && !border.has_left;
    let either = select(select(0, -1, all_right), 1, all_left);
    var turns = either;
    if (border.leaves && border.returns) {
        let across = border.outward.x * border.homeward.y - border.outward.y * border.homeward.x;
        let arc = select(-1, 1, across >= 0.0);
        let if_all_arc = select(0, arc, either == arc);
        let half_turn = select(select(side, 0, either == -side), if_all_arc, arc == side);
        let no_length = select(0, either, border.has_wide);
        let clear = abs(across) > NO_TURN * length(border.outward) * length(border.homeward);
        turns = select(select(half_turn, no_length, dot(border.outward, border.homeward) > 0.0), if_all_arc, clear);
    }
    var before = true;
    if (view.limited) {
        // height / slope · dot(towards, way) < limit, without dividing.
        let height = dot(face.normal, face.point - view.position);
        let slope = dot(face.normal, view.way);
        before = height * sign(slope) * dot(view.towards, view.way) < view.limit * abs(slope);
    }
    return select(0, side * turns, before);
}
