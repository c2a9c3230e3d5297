// Samples of all sets, where receivers do not share one: as in `FrameSamples`, two a row, because that is all a uniform holds. A fold has
// no storage buffer left.
//#import shared/samples.wgsl

struct SampleSets {
    pairs: array<vec4<f32>, 4096>,
}

fn of_pair(pair: vec4<f32>, at: u32) -> vec2<f32> {
    return select(pair.xy, pair.zw, (at & 1u) != 0u);
}
