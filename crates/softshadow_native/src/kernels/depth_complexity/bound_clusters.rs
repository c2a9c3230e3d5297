//! The twin of `depth_complexity/bound_clusters.wgsl`.

use glam::Vec3;
use rayon::prelude::*;

use super::clusters::{CLUSTER, Cluster, ClusterRange};
use crate::engine::Call;
use crate::kernels::{records, records_mut};

pub(super) fn bound_clusters(call: &mut Call) {
    let items = call.item_range();
    let range: ClusterRange = call.uniform("cluster_range");
    let [clusters, groups] = call.buffers(["clusters", "groups_of_clusters"]);
    let clusters = &records::<Cluster>(clusters)[..range.cluster_count as usize];
    let groups = &mut records_mut::<Cluster>(groups)[items.clone()];
    let clusters = clusters.par_chunks(CLUSTER).skip(items.start);
    groups.par_iter_mut().zip(clusters).for_each(|(group, clusters)| *group = around(clusters));
}

fn around(clusters: &[Cluster]) -> Cluster {
    let nothing = Cluster { low: Vec3::splat(1e30), silhouettes: 0, high: Vec3::splat(-1e30), reserved: 0 };
    clusters.iter().enumerate().fold(nothing, |found, (at, cluster)| Cluster {
        low: found.low.min(cluster.low),
        silhouettes: found.silhouettes | (u32::from(cluster.silhouettes != 0) << at),
        high: found.high.max(cluster.high),
        reserved: 0,
    })
}
