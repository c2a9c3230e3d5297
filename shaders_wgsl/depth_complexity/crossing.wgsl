// What decides whether the way from the reference point to a sample crosses an edge.
//#import depth_complexity/edge.wgsl

struct Crossing {
    low: vec2<f32>,
    high: vec2<f32>,
    line: vec3<f32>,
    left: bool,
    beyond_left: bool,
}

fn crossing_of(image: EdgeImage) -> Crossing {
    let low = low_direction(image);
    let high = high_direction(image);
    return Crossing(low, high, image.line, image.left, line_left(image, low, high));
}

// Whether a sample lies beyond the edge in its sector.
fn crosses(c: Crossing, s: vec2<f32>) -> bool {
    let left_of_low = c.low.x * s.y - c.low.y * s.x >= 0.0;
    let left_of_high = c.high.x * s.y - c.high.y * s.x >= 0.0;
    let beyond = (c.line.x * s.x + c.line.y * s.y + c.line.z >= 0.0) != c.beyond_left;
    return left_of_low != left_of_high && left_of_low == c.left && beyond;
}
