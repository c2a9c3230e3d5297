// How many samples a receiver has, and how their masks lie in memory.

struct Sampling {
    count: u32,    // samples of the light
    words: u32,    // 32-bit words of a receiver's mask
    probes: u32,   // samples traced for every receiver; equal to `count` without probing
    pass_index: u32,
    passes: u32,
    reserved0: u32,
    reserved1: u32,
    reserved2: u32,
}
