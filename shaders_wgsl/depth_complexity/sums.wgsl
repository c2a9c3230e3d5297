// What the edges of one receiver add up to: counters of 64 samples, and by how much an edge changes them.
//#import depth_complexity/counters.wgsl

struct Sums {
    counters: Counters,
    changes: u32,           // by how much D can have changed at most
    smallest: u32,          // change of any edge
}

fn begin_fold(depth: i32) -> Sums {
    return Sums(counters_at(depth), u32(abs(depth)), 0xffffu);
}

// The samples of a group of 64 that exist.
fn existing(samples: u32) -> vec2<u32> {
    let low = min(samples, 32u);
    let high = min(max(samples, 32u) - 32u, 32u);
    return vec2<u32>(
        select(0u, 0xffffffffu >> (32u - max(low, 1u)), low > 0u),
        select(0u, 0xffffffffu >> (32u - max(high, 1u)), high > 0u),
    );
}

// The edges of a chunk that change anything for a receiver, one bit each, and by how much: binary digits, and a sign.
struct Changes {
    edges: u32,
    ones: u32,
    twos: u32,
    fours: u32,
    minus: u32,
    many: u32,              // more than any counter holds
}

fn with_change(before: Changes, bit: u32, weight: i32) -> Changes {
    var changes = before;
    let size = u32(abs(weight));
    changes.edges |= select(0u, bit, weight != 0);
    changes.ones |= select(0u, bit, (size & 1u) != 0u);
    changes.twos |= select(0u, bit, (size & 2u) != 0u);
    changes.fours |= select(0u, bit, (size & 4u) != 0u);
    changes.minus |= select(0u, bit, weight < 0);
    changes.many |= select(0u, bit, size > 7u);
    return changes;
}

fn digit(bits: u32, k: u32) -> vec2<u32> {
    return vec2<u32>(0u - ((bits >> k) & 1u));
}

// Adds what changes at one edge for the samples of `mask`. D grows where the reference point lies right of an edge of positive weight.
fn folded(before: Sums, changes: Changes, k: u32, left: bool, mask: vec2<u32>) -> Sums {
    var sums = before;
    let ones = digit(changes.ones, k);
    let twos = digit(changes.twos, k);
    let fours = digit(changes.fours, k);
    let sign = digit(changes.minus, k) ^ vec2<u32>(select(0u, 0xffffffffu, left));
    sums.counters = counters_add(sums.counters, mask & ones, mask & twos, mask & fours, sign);
    let size = (ones.x & 1u) + (twos.x & 2u) + (fours.x & 4u);
    // More faces than that at one edge: counted as more than any counter holds.
    sums.changes += select(size, LARGEST_COUNT + 1u, (digit(changes.many, k).x) != 0u);
    sums.smallest = min(sums.smallest, size);
    return sums;
}

fn with_layers(before: Sums, change: i32, mask: vec2<u32>) -> Sums {
    var sums = before;
    sums.counters = counters_change(sums.counters, mask, change);
    sums.changes += most_change(change);
    return sums;
}

// Areas are summed in this fixed point, so that the order of edges changes no bit.
const AREA_UNITS: f32 = 4194304.0;

// An area in fixed point, with the sign of the change.
fn signed_area(area: f32, changes: Changes, k: u32, left: bool) -> i32 {
    let size = i32(((changes.ones >> k) & 1u) + 2u * ((changes.twos >> k) & 1u) + 4u * ((changes.fours >> k) & 1u));
    let positive = (((changes.minus >> k) & 1u) != 0u) == left;
    return i32(round(area * AREA_UNITS)) * select(-size, size, positive);
}
