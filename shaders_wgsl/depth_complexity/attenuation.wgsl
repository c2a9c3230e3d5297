// What semi-opaque layers take away from 64 samples at a time, in units: beside the counters of opaque layers, and like them one bit of all
// samples in a pair of words. Integers, so that what is added at one edge of a face is taken away at another to the last bit.
//
// Sums are two's complement of 28 bits. In between they may leave that range, in any order of the edges; that the final value fits, who
// folds must see.
//#import depth_complexity/counters.wgsl

// What no sum exceeds of which every change is at most that in all.
const LARGEST_ATTENUATION: u32 = 134217727u;

// Units of a triangle that lets nothing through.
const OPAQUE: u32 = 0xffffffffu;

// At more faces than that an edge counts as more than any sum holds.
const MOST_ATTENUATING_FACES: u32 = 1024u;

// What one unit takes away.
struct AttenuationScale {
    halvings: f32,   // of the light: layers multiply
    shares: f32,     // of all light: layers add
}

// What passes a sum. Within rounding of an edge a sample may count a face as taken away: nothing passes more than all.
fn passed(scale: AttenuationScale, units: i32) -> f32 {
    let layers = f32(max(units, 0));
    return max(exp2(-layers * scale.halvings) - layers * scale.shares, 0.0);
}

struct Attenuation {
    p0: vec2<u32>, p1: vec2<u32>, p2: vec2<u32>, p3: vec2<u32>, p4: vec2<u32>, p5: vec2<u32>, p6: vec2<u32>,
    p7: vec2<u32>, p8: vec2<u32>, p9: vec2<u32>, p10: vec2<u32>, p11: vec2<u32>, p12: vec2<u32>, p13: vec2<u32>,
    p14: vec2<u32>, p15: vec2<u32>, p16: vec2<u32>, p17: vec2<u32>, p18: vec2<u32>, p19: vec2<u32>, p20: vec2<u32>,
    p21: vec2<u32>, p22: vec2<u32>, p23: vec2<u32>, p24: vec2<u32>, p25: vec2<u32>, p26: vec2<u32>, p27: vec2<u32>,
}

fn attenuation_at(value: i32) -> Attenuation {
    return Attenuation(
        plane_of(value, 0u), plane_of(value, 1u), plane_of(value, 2u), plane_of(value, 3u),
        plane_of(value, 4u), plane_of(value, 5u), plane_of(value, 6u), plane_of(value, 7u),
        plane_of(value, 8u), plane_of(value, 9u), plane_of(value, 10u), plane_of(value, 11u),
        plane_of(value, 12u), plane_of(value, 13u), plane_of(value, 14u), plane_of(value, 15u),
        plane_of(value, 16u), plane_of(value, 17u), plane_of(value, 18u), plane_of(value, 19u),
        plane_of(value, 20u), plane_of(value, 21u), plane_of(value, 22u), plane_of(value, 23u),
        plane_of(value, 24u), plane_of(value, 25u), plane_of(value, 26u), plane_of(value, 27u),
    );
}

struct PlaneSum {
    plane: vec2<u32>,
    carry: vec2<u32>,
}

fn added(plane: vec2<u32>, addend: vec2<u32>, carry: vec2<u32>) -> PlaneSum {
    let half = plane ^ addend;
    return PlaneSum(half ^ carry, (plane & addend) | (half & carry));
}

// Adds an amount, which may be negative, to the samples of a mask.
fn attenuation_add(attenuation: Attenuation, mask: vec2<u32>, amount: i32) -> Attenuation {
    var a = attenuation;
    var s = PlaneSum(vec2<u32>(0u), vec2<u32>(0u));
    s = added(a.p0, mask & plane_of(amount, 0u), s.carry); a.p0 = s.plane;
    s = added(a.p1, mask & plane_of(amount, 1u), s.carry); a.p1 = s.plane;
    s = added(a.p2, mask & plane_of(amount, 2u), s.carry); a.p2 = s.plane;
    s = added(a.p3, mask & plane_of(amount, 3u), s.carry); a.p3 = s.plane;
    s = added(a.p4, mask & plane_of(amount, 4u), s.carry); a.p4 = s.plane;
    s = added(a.p5, mask & plane_of(amount, 5u), s.carry); a.p5 = s.plane;
    s = added(a.p6, mask & plane_of(amount, 6u), s.carry); a.p6 = s.plane;
    s = added(a.p7, mask & plane_of(amount, 7u), s.carry); a.p7 = s.plane;
    s = added(a.p8, mask & plane_of(amount, 8u), s.carry); a.p8 = s.plane;
    s = added(a.p9, mask & plane_of(amount, 9u), s.carry); a.p9 = s.plane;
    s = added(a.p10, mask & plane_of(amount, 10u), s.carry); a.p10 = s.plane;
    s = added(a.p11, mask & plane_of(amount, 11u), s.carry); a.p11 = s.plane;
    s = added(a.p12, mask & plane_of(amount, 12u), s.carry); a.p12 = s.plane;
    s = added(a.p13, mask & plane_of(amount, 13u), s.carry); a.p13 = s.plane;
    s = added(a.p14, mask & plane_of(amount, 14u), s.carry); a.p14 = s.plane;
    s = added(a.p15, mask & plane_of(amount, 15u), s.carry); a.p15 = s.plane;
    s = added(a.p16, mask & plane_of(amount, 16u), s.carry); a.p16 = s.plane;
    s = added(a.p17, mask & plane_of(amount, 17u), s.carry); a.p17 = s.plane;
    s = added(a.p18, mask & plane_of(amount, 18u), s.carry); a.p18 = s.plane;
    s = added(a.p19, mask & plane_of(amount, 19u), s.carry); a.p19 = s.plane;
    s = added(a.p20, mask & plane_of(amount, 20u), s.carry); a.p20 = s.plane;
    s = added(a.p21, mask & plane_of(amount, 21u), s.carry); a.p21 = s.plane;
    s = added(a.p22, mask & plane_of(amount, 22u), s.carry); a.p22 = s.plane;
    s = added(a.p23, mask & plane_of(amount, 23u), s.carry); a.p23 = s.plane;
    s = added(a.p24, mask & plane_of(amount, 24u), s.carry); a.p24 = s.plane;
    s = added(a.p25, mask & plane_of(amount, 25u), s.carry); a.p25 = s.plane;
    s = added(a.p26, mask & plane_of(amount, 26u), s.carry); a.p26 = s.plane;
    s = added(a.p27, mask & plane_of(amount, 27u), s.carry); a.p27 = s.plane;
    return a;
}

fn digit_of(plane: vec2<u32>, sample: u32, bit: u32) -> u32 {
    return ((select(plane.x, plane.y, sample >= 32u) >> (sample & 31u)) & 1u) << bit;
}

// The sum of one sample of the 64.
fn attenuation_of(a: Attenuation, sample: u32) -> i32 {
    let digits = digit_of(a.p0, sample, 0u) | digit_of(a.p1, sample, 1u) | digit_of(a.p2, sample, 2u) | digit_of(a.p3, sample, 3u)
        | digit_of(a.p4, sample, 4u) | digit_of(a.p5, sample, 5u) | digit_of(a.p6, sample, 6u) | digit_of(a.p7, sample, 7u)
        | digit_of(a.p8, sample, 8u) | digit_of(a.p9, sample, 9u) | digit_of(a.p10, sample, 10u) | digit_of(a.p11, sample, 11u)
        | digit_of(a.p12, sample, 12u) | digit_of(a.p13, sample, 13u) | digit_of(a.p14, sample, 14u) | digit_of(a.p15, sample, 15u)
        | digit_of(a.p16, sample, 16u) | digit_of(a.p17, sample, 17u) | digit_of(a.p18, sample, 18u) | digit_of(a.p19, sample, 19u)
        | digit_of(a.p20, sample, 20u) | digit_of(a.p21, sample, 21u) | digit_of(a.p22, sample, 22u) | digit_of(a.p23, sample, 23u)
        | digit_of(a.p24, sample, 24u) | digit_of(a.p25, sample, 25u) | digit_of(a.p26, sample, 26u) | digit_of(a.p27, sample, 27u);
    return i32(digits << 4u) >> 4u;
}

// Layers, opaque and in units of attenuation.
struct Layers {
    opaque: i32,
    attenuation: i32,
}

// What semi-opaque layers add up to beside the counters of a fold.
struct Attenuated {
    attenuation: Attenuation,
    most: u32,              // by how much it can have changed at most
}

fn attenuated_by(before: Attenuated, amount: i32, faces: u32, mask: vec2<u32>) -> Attenuated {
    let changes = (mask.x | mask.y) != 0u && amount != 0;
    let size = select(u32(abs(amount)), LARGEST_ATTENUATION + 1u, faces > MOST_ATTENUATING_FACES);
    return Attenuated(
        attenuation_add(before.attenuation, mask, amount),
        min(before.most, LARGEST_ATTENUATION + 1u) + select(0u, size, changes),
    );
}
