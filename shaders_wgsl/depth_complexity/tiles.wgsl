// Tiles: runs of 64 receivers that lie side by side, each in two parts, with the shaft that holds all ways from a part to the light.

const TILE: u32 = 64u;

// Depth of the reference point of a receiver that does not look at the light: nothing there, behind it, or all of it below the horizon.
const NO_VIEW: i32 = -2147483647;

struct TilePart {
    planes: array<vec4<f32>, 5>,  // dot(plane.xyz, v) > plane.w: v is outside the shaft
    low: vec3<f32>,               // box of the receivers
    receiver_count: u32,          // receivers with a view of the light; 0 for none
    high: vec3<f32>,
    has_faces: u32,               // whether any face lies in the shaft
}

// A receiver in the order of the tiles.
struct Slot {
    receiver: u32,
    part: u32,        // of its tile; where faces are walked instead, the node at which the walk goes on
    depth: i32,       // of the reference point, or NO_VIEW
    attenuation: i32, // of the reference point, in units
}

// What the passes over the lists of edges report.
struct ListCounts {
    parts: atomic<u32>,           // with edges
    chunks: atomic<u32>,          // handed out; the first is left unused, 0 ends a list
    edges: atomic<u32>,           // in all lists
    unfinished: atomic<u32>,      // receivers for which a list had no room, a walk no end, or a counter no bit
    by_area: atomic<u32>,         // receivers that areas answered
    overflowed: atomic<u32>,      // receivers with more attenuation than a sum holds
    reserved0: u32,
    reserved1: u32,
}

// A tile's bundles: runs of 8 receivers, whose shafts are much thinner than the tile's.
const BUNDLE: u32 = 8u;
const BUNDLES: u32 = 8u;

// The lists: a head for each part of a tile that has edges; then, from `first_chunk_word` on, chunks. A head is the part, the first
// chunk of its list, and the first chunks of its bundles' lists.
const HEAD: u32 = 10u;

// A list grows by chunks: the next chunk, how many entries stand in this one, and those: edges, or faces.
const CHUNK: u32 = 32u;
const CHUNK_EDGES: u32 = 30u;

fn first_chunk_word(tile_count: u32) -> u32 {
    return 2u * HEAD * tile_count;
}

// An entry is an edge and, where all receivers of the list agree on it, the edge's weight: -2 to 2, 0 where each finds its own.
const EDGE_BITS: u32 = 29u;
const NO_ENTRY: u32 = 0xffffffffu;

fn listed(edge: u32, weight: i32) -> u32 {
    return edge | (select(0u, u32(weight + 4), weight != 0) << EDGE_BITS);
}

fn listed_edge(entry: u32) -> u32 {
    return entry & ((1u << EDGE_BITS) - 1u);
}

// 0 where it is not listed.
fn listed_weight(entry: u32) -> i32 {
    let code = entry >> EDGE_BITS;
    return select(0, i32(code) - 4, code != 0u);
}

// Where a list grows: its first chunk and its last, and how many edges stand in that.
struct Tail {
    first: u32,
    chunk: u32,
    filled: u32,
    full: bool,
}

fn no_list() -> Tail {
    return Tail(0u, 0u, CHUNK_EDGES, false);
}

fn plane_excludes_box(plane: vec4<f32>, middle: vec3<f32>, half: vec3<f32>) -> bool {
    return dot(plane.xyz, middle) - dot(abs(plane.xyz), half) > plane.w;
}

fn shaft_meets_box(planes: array<vec4<f32>, 5>, low: vec3<f32>, high: vec3<f32>) -> bool {
    let middle = (low + high) * 0.5;
    let half = (high - low) * 0.5;
    return !(plane_excludes_box(planes[0], middle, half)
        || plane_excludes_box(planes[1], middle, half)
        || plane_excludes_box(planes[2], middle, half)
        || plane_excludes_box(planes[3], middle, half)
        || plane_excludes_box(planes[4], middle, half));
}
