// What hides a light: faces with one plane each, and edges that several faces share. The twin of `occluders/mod.rs`.

const NO_SIDE: u32 = 0xffffffffu;

struct Face {
    normal: vec3<f32>,
    triangle: u32,
    point: vec3<f32>,
    flatness: f32,         // who is no farther off the plane than this is in it
    sides: vec4<u32>,      // edge << 1 | backward
}

struct OccluderEdge {
    low: vec3<f32>,
    first_incidence: u32,
    high: vec3<f32>,
    incidence_count: u32,  // with UNEQUAL_FACES where these differ in opacity
}

// Set in the count of an edge's faces: whichever sides its faces are on, it can change what passes, and is never left out.
const UNEQUAL_FACES: u32 = 0x80000000u;

fn face_count(edge: OccluderEdge) -> u32 {
    return edge.incidence_count & ~UNEQUAL_FACES;
}

// A face at an edge, with what decides its side.
struct IncidentFace {
    normal: vec3<f32>,
    reference: u32,        // triangle << 1 | backward
    point: vec3<f32>,
    flatness: f32,
}

// Records as they lie in buffers, in words: software drivers read four words at the price of one.
struct EightWords {
    first: vec4<u32>,
    second: vec4<u32>,
}

struct TwelveWords {
    first: vec4<u32>,
    second: vec4<u32>,
    third: vec4<u32>,
}

fn edge_of(words: EightWords) -> OccluderEdge {
    return OccluderEdge(
        bitcast<vec3<f32>>(words.first.xyz), words.first.w, bitcast<vec3<f32>>(words.second.xyz), words.second.w,
    );
}

fn incident_face_of(words: EightWords) -> IncidentFace {
    return IncidentFace(
        bitcast<vec3<f32>>(words.first.xyz), words.first.w, bitcast<vec3<f32>>(words.second.xyz), bitcast<f32>(words.second.w),
    );
}

fn face_of(words: TwelveWords) -> Face {
    return Face(
        bitcast<vec3<f32>>(words.first.xyz), words.first.w,
        bitcast<vec3<f32>>(words.second.xyz), bitcast<f32>(words.second.w),
        words.third,
    );
}

// +1 where the canonical winding is seen counter-clockwise on the light, -1 clockwise, 0 edge-on: such a face hides nothing.
fn side_of_plane(normal: vec3<f32>, point: vec3<f32>, flatness: f32, position: vec3<f32>) -> i32 {
    let height = dot(normal, position - point);
    return select(0, 1, height > flatness) - select(0, 1, height < -flatness);
}

// Which way round a face lies at its edge.
fn turned(side: i32, incident: IncidentFace) -> i32 {
    return select(side, -side, (incident.reference & 1u) != 0u);
}
