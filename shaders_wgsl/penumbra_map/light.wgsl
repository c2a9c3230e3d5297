// A light as the penumbra map sees it: a plane through its centre with an outline in it.
//
// Places are given in the light's frame, relative to the eye of the shadow views: x and y along the light, z the way it shines. So are those
// of a sun, whose eye stands before the scene. A sphere's frame turns with whom it shines on: its places stay in the scene's axes.

const RAMP_LIGHT: u32 = 0u;
const RAMP_LINEAR: u32 = 1u;
const RAMP_PAPER: u32 = 2u;

struct PenumbraLight {
    x_axis: vec3<f32>,
    far: f32,               // farthest depth of any receiver; from a sphere's centre its distance
    y_axis: vec3<f32>,
    radius: f32,            // of a disc or a sphere; the tangent of half a sun's angle
    z_axis: vec3<f32>,
    corner_count: u32,      // of a polygon
    half_size: vec2<f32>,   // of a rectangle
    area: f32,              // of a polygon
    ramp: u32,
    outline: array<vec4<f32>, 64>,   // corners of a polygon, counter-clockwise; the lines through them are dot(zw, p) = 1
}

// Which layer of the maps is drawn.
struct MapLayer {
    layer: u32,
    reserved0: u32,
    reserved1: u32,
    reserved2: u32,
}

struct Axes {
    x: vec3<f32>,
    y: vec3<f32>,
    z: vec3<f32>,
}

fn fixed_axes(light: PenumbraLight) -> Axes {
    return Axes(light.x_axis, light.y_axis, light.z_axis);
}

// Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
fn axes_towards(place: vec3<f32>) -> Axes {
    let n = place / max(length(place), 1e-30);
    let s = select(-1.0, 1.0, n.z >= 0.0);
    let a = -1.0 / (s + n.z);
    let b = n.x * n.y * a;
    return Axes(vec3<f32>(1.0 + s * n.x * n.x * a, s * b, -s * n.x), vec3<f32>(b, s + n.y * n.y * a, -n.y), n);
}

fn in_axes(axes: Axes, place: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(dot(axes.x, place), dot(axes.y, place), dot(axes.z, place));
}
