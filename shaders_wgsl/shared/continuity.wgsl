// Which pixels see one surface: the discontinuity filter of interleaved samples.
//#import shared/receiver.wgsl

// A block of an image whose pixels are averaged with their neighbours.
struct Interleaving {
    eye: vec3<f32>,
    tile: u32,        // side of the square of pixels whose sets of samples make up one set
    width: u32,
    height: u32,      // of the block, with the rows around what is kept
    channels: u32,
    reserved: u32,
}

// Eight degrees between two facets: a round body of 45 of them. Normals are those of triangles, so every facet has a horizon of its own
// and cuts the light elsewhere; what is averaged over coarser ones is no longer what either sees.
const LEAST_COSINE: f32 = 0.99;

// A neighbour may lie off the receiver's plane by this share of the way on that plane from pixel to pixel. Both grow with the pixels alone:
// no length is built in. Half a way tells sheets apart down to half a pixel's size between them, at any slope.
const MOST_STEP: f32 = 0.5;

// Whether both lie on one surface, as seen by `a`: where the ray to `b` meets the plane of `a`, and how far `b` is from there,
// both times what would divide them.
fn is_continuous(a: Receiver, b: Receiver, eye: vec3<f32>) -> bool {
    let to_a = a.position - eye;
    let to_b = b.position - eye;
    let way = b.position - a.position;
    let height = dot(a.normal, to_a);
    let rise = dot(a.normal, way);
    let off = length(to_b) * abs(rise);
    let across = length(way * height - to_a * rise);
    let is_ahead = height * (height + rise) > 0.0;
    let are_surfaces = a.kind == RECEIVER_SURFACE && b.kind == RECEIVER_SURFACE;
    return are_surfaces && is_ahead && off <= MOST_STEP * across && dot(a.normal, b.normal) >= LEAST_COSINE;
}

// The weight of a neighbour so many pixels aside, along one axis: a box as wide as the square. One of even width has half a pixel at both
// ends, which have the same set: so every set weighs as much as any other.
fn share_of_box(offset: i32, tile: u32) -> f32 {
    return select(1.0, 0.5, 2u * u32(abs(offset)) == tile);
}
