// The frame in which a scene is sliced, and where its slices lie.
//
// The light is [-1, 1]² at depth 0. Seen from a point d behind it, (x, y, z) becomes (x, y, z) / (1 + z / d): a projective map that leaves the
// light where it is and moves the centre of projection to infinity. Straight lines stay straight, so here slicing is a parallel projection,
// and the light as seen from a receiver at depth T covers (1 - t / T) of its own size on the plane at depth t. A sun has d at infinity.

const LAYERS_FLAT: u32 = 0u;
const LAYERS_SPHERE: u32 = 1u;
const LAYERS_SUN: u32 = 2u;


struct LayerFrame {
    origin: vec3<f32>,
    kind: u32,
    row_x: vec3<f32>,      // dots with p - origin: half sizes of the light across, scene units in depth
    tangent: f32,          // of half a sun's angle
    row_y: vec3<f32>,
    slices: u32,
    row_z: vec3<f32>,
    resolution: u32,
    successors: u32,       // whether every slice is written into the next one, too
    filter_kind: u32,      // one of FILTER_
    reserved0: u32,
    reserved1: u32,
}

// Where texels and slices are. Zero, so without a slice, until slicing has found out about the casters.
struct LayerWindow {
    low: vec2<f32>,          // where the first texel begins
    texels: vec2<f32>,       // a unit of the frame
    inverse_distance: f32,   // 1 / d
    slices: u32,
    resolution: u32,
    reserved: u32,
}

struct LayerPlaces {
    window: LayerWindow,
    planes: array<f32, 128>, // depth of the far plane of every slice, ascending
}

fn in_light_frame(frame: LayerFrame, p: vec3<f32>) -> vec3<f32> {
    let way = p - frame.origin;
    return vec3<f32>(dot(frame.row_x, way), dot(frame.row_y, way), dot(frame.row_z, way));
}

// The projective map; for points before the light, and all of a sun.
fn projected(q: vec3<f32>, inverse_distance: f32) -> vec3<f32> {
    return q / (1.0 + q.z * inverse_distance);
}
