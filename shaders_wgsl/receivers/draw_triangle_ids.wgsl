// Which triangle each pixel sees: one raster pass over the scene, nearest wins, 0 where there is none.

struct CameraClip {
    eye: vec3<f32>,
    near: f32,
    clip_x: vec3<f32>,
    reserved0: u32,
    clip_y: vec3<f32>,
    reserved1: u32,
    forward: vec3<f32>,
    reserved2: u32,
}

@group(0) @binding(0) var<uniform> camera_clip: CameraClip;

struct Drawn {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) triangle: u32,
}

@vertex
fn draw(@location(0) position: vec3<f32>, @location(1) triangle: u32) -> Drawn {
    let p = position - camera_clip.eye;
    // Reversed depth, near / distance: float32 keeps its relative accuracy at every distance.
    let clip = vec4<f32>(dot(camera_clip.clip_x, p), dot(camera_clip.clip_y, p), camera_clip.near, dot(camera_clip.forward, p));
    return Drawn(clip, triangle);
}

struct Written {
    @location(0) id: u32,
    @builtin(frag_depth) depth: f32,
}

// Depth is written from the distance (the fragment's w is its reciprocal): GL would squeeze a reversed depth through -1 ... 1 and
// lose nearly all of it.
@fragment
fn write_id(drawn: Drawn) -> Written {
    return Written(drawn.triangle + 1u, camera_clip.near * drawn.clip.w);
}
