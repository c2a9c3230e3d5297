// One counter a sample, 64 samples at a time: bit k of all counters stands in one pair of words. The twin of `counters.rs`, with a fixed
// number of planes: values from 0 to 4,095 are told apart, and who folds must see that no more can come.

const LARGEST_COUNT: u32 = 4095u;

struct Counters {
    p0: vec2<u32>, p1: vec2<u32>, p2: vec2<u32>, p3: vec2<u32>, p4: vec2<u32>, p5: vec2<u32>,
    p6: vec2<u32>, p7: vec2<u32>, p8: vec2<u32>, p9: vec2<u32>, p10: vec2<u32>, p11: vec2<u32>,
}

fn plane_of(value: i32, bit: u32) -> vec2<u32> {
    return vec2<u32>(select(0u, 0xffffffffu, ((u32(value) >> bit) & 1u) != 0u));
}

fn counters_at(value: i32) -> Counters {
    return Counters(
        plane_of(value, 0u), plane_of(value, 1u), plane_of(value, 2u), plane_of(value, 3u),
        plane_of(value, 4u), plane_of(value, 5u), plane_of(value, 6u), plane_of(value, 7u),
        plane_of(value, 8u), plane_of(value, 9u), plane_of(value, 10u), plane_of(value, 11u),
    );
}

// Adds `ones` at plane 0, `twos` at plane 1 and `fours` at plane 2, or takes them away when `borrow` is all ones.
fn counters_add(counters: Counters, ones: vec2<u32>, twos: vec2<u32>, fours: vec2<u32>, borrow: vec2<u32>) -> Counters {
    var c = counters;
    var carry = ones;
    var digit = c.p0 ^ borrow;
    c.p0 = digit ^ carry ^ borrow;
    carry = digit & carry;
    // At most one of two carries into a plane can be passed on from each.
    digit = c.p1 ^ borrow;
    var sum = digit ^ carry;
    var next = digit & carry;
    c.p1 = sum ^ twos ^ borrow;
    next = next | (sum & twos);
    carry = next;
    digit = c.p2 ^ borrow;
    sum = digit ^ carry;
    next = digit & carry;
    c.p2 = sum ^ fours ^ borrow;
    carry = next | (sum & fours);
    digit = c.p3 ^ borrow; c.p3 = digit ^ carry ^ borrow; carry &= digit;
    digit = c.p4 ^ borrow; c.p4 = digit ^ carry ^ borrow; carry &= digit;
    digit = c.p5 ^ borrow; c.p5 = digit ^ carry ^ borrow; carry &= digit;
    digit = c.p6 ^ borrow; c.p6 = digit ^ carry ^ borrow; carry &= digit;
    digit = c.p7 ^ borrow; c.p7 = digit ^ carry ^ borrow; carry &= digit;
    digit = c.p8 ^ borrow; c.p8 = digit ^ carry ^ borrow; carry &= digit;
    digit = c.p9 ^ borrow; c.p9 = digit ^ carry ^ borrow; carry &= digit;
    digit = c.p10 ^ borrow; c.p10 = digit ^ carry ^ borrow; carry &= digit;
    digit = c.p11 ^ borrow; c.p11 = digit ^ carry ^ borrow;
    return c;
}

// Adds a change of up to seven layers to the samples of a mask.
fn counters_change(counters: Counters, mask: vec2<u32>, change: i32) -> Counters {
    let size = u32(abs(change));
    let bit = vec3<u32>(size & 1u, (size >> 1u) & 1u, (size >> 2u) & 1u) * 0xffffffffu;
    let borrow = vec2<u32>(select(0u, 0xffffffffu, change < 0));
    return counters_add(counters, mask & vec2<u32>(bit.x), mask & vec2<u32>(bit.y), mask & vec2<u32>(bit.z), borrow);
}

// How much a change counts towards what counters hold: more faces than seven at one edge as more than any of them does.
fn most_change(change: i32) -> u32 {
    return select(u32(abs(change)), LARGEST_COUNT + 1u, abs(change) > 7);
}

fn counters_nonzero(c: Counters) -> vec2<u32> {
    return c.p0 | c.p1 | c.p2 | c.p3 | c.p4 | c.p5 | c.p6 | c.p7 | c.p8 | c.p9 | c.p10 | c.p11;
}

// What a plane adds to the one value that all counters in `any` have; a number past all values where they differ.
fn plane_value(plane: vec2<u32>, any: vec2<u32>, bit: u32) -> u32 {
    let here = plane & any;
    return select(select(1u << 20u, 0u, all(here == vec2<u32>(0u))), 1u << bit, all(here == any));
}

// The one value of all counters in `any`, which must not be empty; at least 2^20 where they differ.
fn counters_single_value(c: Counters, any: vec2<u32>) -> u32 {
    return plane_value(c.p0, any, 0u) + plane_value(c.p1, any, 1u) + plane_value(c.p2, any, 2u)
        + plane_value(c.p3, any, 3u) + plane_value(c.p4, any, 4u) + plane_value(c.p5, any, 5u)
        + plane_value(c.p6, any, 6u) + plane_value(c.p7, any, 7u) + plane_value(c.p8, any, 8u)
        + plane_value(c.p9, any, 9u) + plane_value(c.p10, any, 10u) + plane_value(c.p11, any, 11u);
}
