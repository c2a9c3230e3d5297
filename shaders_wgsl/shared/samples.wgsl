// How many samples a receiver has, which they are, and how their masks lie in memory.

struct Sampling {
    count: u32,            // samples of a receiver
    words: u32,            // 32-bit words of a receiver's mask
    probes: u32,           // samples traced for every receiver; equal to `count` without probing
    pass_index: u32,
    passes: u32,
    sets: u32,             // of samples, of which every receiver has one; with a row, the side of the square of pixels that has all
    row: u32,              // pixels of a row, where sets are taken by place; 0 where they are drawn
    first_receiver: u32,   // of the block, among all of the call, so that no set depends on how a call is split
}

// A number whose every bit depends on every bit of the index (Wellons' lowbias32).
fn mixed(index: u32) -> u32 {
    var x = index;
    x = (x ^ (x >> 16u)) * 0x7feb352du;
    x = (x ^ (x >> 15u)) * 0x846ca68bu;
    return x ^ (x >> 16u);
}

// Where the set of a receiver of the block begins among all samples. The twin of `set_of` in `sample_sets.rs`.
//
// A loop that is taken once or not at all: software drivers execute both sides of a branch, and divisions are slow there. Receivers that
// share one set do not pay for those that do not.
fn first_sample(sampling: Sampling, index: u32) -> u32 {
    var chosen = 0u;
    for (var once = 1u; once < min(sampling.sets, 2u); once++) {
        let at = sampling.first_receiver + index;
        let row = max(sampling.row, 1u);
        let placed = (at % row) % sampling.sets + sampling.sets * ((at / row) % sampling.sets);
        chosen = select(mixed(at) % sampling.sets, placed, sampling.row > 0u);
    }
    return chosen * sampling.count;
}
