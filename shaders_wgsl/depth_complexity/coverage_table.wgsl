// Which of 64 samples lie left of a direction or a line, looked up. The twin of `coverage_table.rs`.

// For the 64 samples: which lie left of a direction, and of a line, by cells of directions and distances. Two words of those that surely do,
// wherever in the cell, and two of those that may.
const DIRECTIONS: u32 = 512u;
const LINE_DIRECTIONS: u32 = 64u;
const LINE_DISTANCES: u32 = 56u;
const FARTHEST: f32 = 1.1;

// What is smaller has no direction.
const TINY: f32 = 1e-30;

struct CoverageTable {
    directions: array<vec4<u32>, 512>,
    lines: array<vec4<u32>, 3584>,
}

// Which samples lie left of something: surely, or by a closer look.
struct Left {
    surely: vec2<u32>,
    maybe: vec2<u32>,
}

// A number from 0 to 4 that grows with the angle of a vector; `size` is the sum of its sizes along the axes.
fn turn_of(v: vec2<f32>, size: f32) -> f32 {
    let q = v.y / max(size, 1e-37);
    return select(3.0 - q, 1.0 + q, v.x >= 0.0);
}

fn cell_of_direction(v: vec2<f32>) -> u32 {
    let turn = turn_of(v, abs(v.x) + abs(v.y));
    return min(u32(turn * (f32(DIRECTIONS) / 4.0)), DIRECTIONS - 1u);
}

fn cell_of_line(line: vec3<f32>) -> u32 {
    let size = abs(line.x) + abs(line.y);
    let direction = min(u32(turn_of(line.xy, size) * (f32(LINE_DIRECTIONS) / 4.0)), LINE_DIRECTIONS - 1u);
    let share = clamp(line.z / max(size, 1e-37) / (2.0 * FARTHEST) + 0.5, 0.0, 1.0);
    let distance = min(u32(share * f32(LINE_DISTANCES)), LINE_DISTANCES - 1u);
    return direction * LINE_DISTANCES + distance;
}

// What a cell says of a vector or a line in it; all samples need a closer look where it has no direction.
fn left_in(cell: vec4<u32>, v: vec2<f32>) -> Left {
    let has_direction = abs(v.x) + abs(v.y) > TINY;
    return Left(
        select(vec2<u32>(0u), cell.xy, has_direction),
        select(vec2<u32>(0xffffffffu), cell.zw, has_direction),
    );
}

// The first of a set of samples, which must not be empty, and a set of one.
fn first_of(samples: vec2<u32>) -> u32 {
    return select(32u + firstTrailingBit(samples.y), firstTrailingBit(samples.x), samples.x != 0u);
}

fn set_of_one(k: u32) -> vec2<u32> {
    let bit = 1u << (k & 31u);
    return select(vec2<u32>(bit, 0u), vec2<u32>(0u, bit), k >= 32u);
}
