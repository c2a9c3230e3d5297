// How the counters of a receiver's samples lie in words, or in the channels of colour targets: digits of so many bits, the first lowest.

struct Packing {
    bits: u32,
    fields: u32,          // digits of a word or channel
    words: u32,           // words of a receiver
    bias: u32,            // every digit is read as its count plus this, so that a count below 0 borrows nothing
    first_sample: u32,    // the samples that this draw counts
    sample_count: u32,
    batch: u32,           // which changes it counts: 0 all, 1 those that add, 2 those that take away
    reserved: u32,
}

fn lowest_sample(packing: Packing, word: u32) -> u32 {
    return word * packing.fields;
}
