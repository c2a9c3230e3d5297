//! Twins of the kernels of `depth_complexity`.

mod beam;
mod bound_clusters;
mod bound_tiles;
mod bundles;
mod clusters;
mod cover;
mod cover_faces;
mod coverage;
mod cull;
mod edge;
mod eight_edges;
mod find_faces;
mod frame;
mod hider;
mod horizon;
#[expect(dead_code, reason = "its kernels are on their way")]
mod occluders;
mod open_masks;
mod positions;
mod sample_bins;
mod sample_sets;
mod shaft;
mod silhouettes;
mod size_fold;
mod spread_reference;
#[expect(dead_code, reason = "its kernels are on their way")]
mod tiles;
mod touching;
mod tree;

use super::Twin;

pub(super) fn twin(file: &str, entry: &str) -> Option<Twin> {
    Some(match (file, entry) {
        ("bound_clusters", "bound_clusters") => bound_clusters::bound_clusters,
        ("bound_tiles", "bound_tiles") => bound_tiles::bound_tiles,
        ("cover_faces", "cover_faces" | "cover_moving") => cover_faces::cover_faces,
        ("cull", "cull") => cull::cull,
        ("cull", "list_faces") => cull::list_faces,
        ("cull", "narrow") => cull::narrow,
        ("find_faces", "find_faces") => find_faces::find_faces,
        ("open_masks", "open_masks") => open_masks::open_masks,
        ("open_masks", "open_masks_of_sets") => open_masks::open_masks_of_sets,
        ("silhouettes", "silhouettes") => silhouettes::silhouettes,
        ("silhouettes", "standard_silhouettes") => silhouettes::standard_silhouettes,
        ("size_fold", "size_fold") => size_fold::size_fold,
        ("spread_reference", "spread_reference") => spread_reference::spread_reference,
        ("touching", "try_touching") => touching::try_touching,
        _ => return None,
    })
}
