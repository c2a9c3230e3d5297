// Which samples an edge covers: those in the sector of its ends, beyond its line. The twin of `depth_complexity/coverage.rs`.
//#import depth_complexity/edge.wgsl

// What decides whether the way to a sample crosses an edge. Ends stand in the order in which the sector goes round.
struct Crossing {
    sector_from: vec2<f32>,
    sector_to: vec2<f32>,
    line: vec3<f32>,
    beyond_left: bool,        // whether the reference point lies on the left of the line
}

fn crossing_of(image: EdgeImage) -> Crossing {
    let low = low_direction(image);
    let high = high_direction(image);
    return Crossing(
        select(high, low, image.left), select(low, high, image.left), image.line, line_left(image, low, high),
    );
}

fn crosses(c: Crossing, s: vec2<f32>) -> bool {
    let in_sector = (c.sector_from.x * s.y - c.sector_from.y * s.x >= 0.0) & (c.sector_to.x * s.y - c.sector_to.y * s.x < 0.0);
    return in_sector & ((c.line.x * s.x + c.line.y * s.y + c.line.z >= 0.0) != c.beyond_left);
}
