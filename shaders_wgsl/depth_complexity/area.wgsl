// How much of the light lies beyond an edge. The twin of `area.rs`.

fn turn(a: vec2<f32>, b: vec2<f32>) -> f32 {
    return a.x * b.y - a.y * b.x;
}

fn height_over(line: vec3<f32>, p: vec2<f32>) -> f32 {
    return dot(line.xy, p) + line.z;
}

// The share of the way from the origin to a point beyond the line, or on it, that lies before the line.
fn share_before(line: vec3<f32>, p: vec2<f32>) -> f32 {
    let fall = -dot(line.xy, p);
    return select(1.0, clamp(line.z / max(fall, 1e-37), 0.0, 1.0), fall > 0.0);
}

fn holds(from_direction: vec2<f32>, to_direction: vec2<f32>, d: vec2<f32>) -> bool {
    return turn(from_direction, d) >= 0.0 && turn(d, to_direction) >= 0.0;
}

struct Sector {
    first: vec2<f32>,
    last: vec2<f32>,
    exists: bool,
}

// Where two sectors, each below a half turn, overlap.
fn common_sector(a: vec2<f32>, b: vec2<f32>, u: vec2<f32>, v: vec2<f32>) -> Sector {
    let u_inside = holds(a, b, u);
    let v_inside = holds(a, b, v);
    return Sector(
        select(a, u, u_inside),
        select(b, v, v_inside),
        (u_inside || holds(u, v, a)) && (v_inside || holds(u, v, b)),
    );
}

fn on_side(a: vec2<f32>, b: vec2<f32>, direction: vec2<f32>) -> vec2<f32> {
    let from_a = turn(a, direction);
    let whole = from_a + turn(direction, b);
    return select(a, a + (b - a) * (from_a / max(whole, 1e-37)), whole > 0.0);
}

// The part between the origin and one side of the light; negative for a side that turns away.
fn area_beyond_side(line: vec3<f32>, from_direction: vec2<f32>, to_direction: vec2<f32>, a: vec2<f32>, b: vec2<f32>) -> f32 {
    let facing = turn(a, b);
    let start = select(b, a, facing > 0.0);
    let end = select(a, b, facing > 0.0);
    let sector = common_sector(from_direction, to_direction, start, end);
    var p = on_side(start, end, sector.first);
    var q = on_side(start, end, sector.last);
    let at_p = height_over(line, p);
    let at_q = height_over(line, q);
    let span = at_p - at_q;
    let crossing = p + (q - p) * (at_p / select(1.0, span, span != 0.0));
    let p_beyond = at_p < 0.0;
    let q_beyond = at_q < 0.0;
    p = select(crossing, p, p_beyond);
    q = select(crossing, q, q_beyond);
    let beyond = turn(p, q) * 0.5 * (1.0 - share_before(line, p) * share_before(line, q));
    let counts = sector.exists && (p_beyond || q_beyond) && facing != 0.0;
    return select(0.0, select(-beyond, beyond, facing > 0.0), counts);
}

fn on_circle(center: vec2<f32>, direction: vec2<f32>) -> vec2<f32> {
    let d = direction / max(length(direction), 1e-37);
    let along = dot(d, center);
    return d * (along + sqrt(max(along * along + 1.0 - dot(center, center), 0.0)));
}

fn area_beyond_arc(line: vec3<f32>, from_direction: vec2<f32>, to_direction: vec2<f32>, center: vec2<f32>) -> f32 {
    let size = max(length(line.xy), 1e-37);
    let normal = line.xy / size;
    let depth = dot(normal, center) + line.z / size;
    let half_chord = sqrt(max(1.0 - depth * depth, 0.0));
    let middle = center - normal * depth;
    let along = vec2<f32>(-normal.y, normal.x) * half_chord;
    let ordered = turn(middle - along, middle + along) >= 0.0;
    let start = select(middle + along, middle - along, ordered);
    let end = select(middle - along, middle + along, ordered);
    let sector = common_sector(from_direction, to_direction, start, end);
    let p = on_circle(center, sector.first);
    let q = on_circle(center, sector.last);
    let x = p - center;
    let y = q - center;
    let angle = atan2(turn(x, y), dot(x, y));
    let swept = select(angle, angle + 6.2831855, angle < 0.0) + turn(center, q - p);
    let beyond = (swept - turn(p, q) * share_before(line, p) * share_before(line, q)) * 0.5;
    return select(0.0, beyond, sector.exists && half_chord > 0.0);
}
