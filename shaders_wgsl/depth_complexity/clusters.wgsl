// Runs of 32 edges that lie side by side, with those of them that can be silhouettes over the light.

struct Cluster {
    low: vec3<f32>,
    silhouettes: u32,     // one bit an edge
    high: vec3<f32>,
    reserved: u32,
}

struct ClusterRange {
    edge_count: u32,
    cluster_count: u32,
    tile_count: u32,
    receiver_count: u32,
}

const CLUSTER: u32 = 32u;
