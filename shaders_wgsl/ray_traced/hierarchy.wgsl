// What walks over the hierarchy leave and take: candidates, and which samples of them.
//#import shared/hierarchy.wgsl

// A receiver whose bundle of rays meets something, and the part of the hierarchy in which that lies.
struct Candidate {
    receiver: u32,
    first_node: u32,
    last_node: u32,
}

// Candidates in no particular order: each is read by one invocation a sample, so the order changes no result.
struct CandidateList {
    count: atomic<u32>,
    unfinished: atomic<u32>,   // rays that a driver cut short
    reserved0: u32,
    reserved1: u32,
    items: array<Candidate>,
}

// Which samples of the candidates a pass traces.
struct TraceRange {
    first_sample: u32,
    end_sample: u32,
    node_count: u32,
    reserved: u32,
}

// Invocations of one workgroup.
const GROUP: u32 = 64u;

// Mesa's software driver ends every loop of an invocation, without a word, once all its loops together have taken 65,535
// steps. So an invocation traces few samples, walks are bounded, and a ray that was cut short is counted.
const SAMPLES_PER_INVOCATION: u32 = 8u;
const LONGEST_BUNDLE_WALK: u32 = 8192u;

fn chunks_of(range: TraceRange) -> u32 {
    return (range.end_sample - range.first_sample + SAMPLES_PER_INVOCATION - 1u) / SAMPLES_PER_INVOCATION;
}

// A group's place among all. Drivers on the CPU hand each thread a run of groups; candidates that lie side by side in the list
// lie side by side in the image and cost alike, so runs of the list would leave threads idle.
fn scattered(group: u32, used: u32) -> u32 {
    // A prime that does not divide the number of groups visits each of them once.
    let stride = select(7919u, 7907u, used % 7919u == 0u);
    return select(group, (group * stride) % max(used, 1u), group < used && used < 500000u);
}
