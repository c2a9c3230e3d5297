// An edge that is a silhouette as seen from the light's centre.

struct LightSilhouette {
    low: vec3<f32>,
    weight: i32,      // layers to the left of low -> high less those to its right, as the light sees it
    high: vec3<f32>,
    edge: u32,
}
