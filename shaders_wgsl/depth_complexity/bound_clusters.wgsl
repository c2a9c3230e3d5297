// The boxes of 32 clusters at a time, so that a tile looks at few of them.
//#import shared/slice.wgsl
//#import depth_complexity/clusters.wgsl

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<uniform> cluster_range: ClusterRange;
@group(0) @binding(2) var<storage, read> clusters: array<Cluster>;
@group(0) @binding(3) var<storage, read_write> groups_of_clusters: array<Cluster>;

@compute @workgroup_size(64)
fn bound_clusters(@builtin(global_invocation_id) invocation: vec3<u32>) {
    if (invocation.x >= slice.count) {
        return;
    }
    let index = slice.first + invocation.x;
    let first = index * CLUSTER;
    let end = min(first + CLUSTER, cluster_range.cluster_count);
    var found = Cluster(vec3<f32>(1e30), 0u, vec3<f32>(-1e30), 0u);
    for (var at = first; at < end; at++) {
        let cluster = clusters[at];
        found.silhouettes |= select(0u, 1u << (at - first), cluster.silhouettes != 0u);
        found.low = min(found.low, cluster.low);
        found.high = max(found.high, cluster.high);
    }
    groups_of_clusters[index] = found;
}
