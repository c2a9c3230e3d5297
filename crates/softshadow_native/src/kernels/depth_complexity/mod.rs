//! Twins of the kernels of `depth_complexity`.

mod area;
mod attenuation;
mod bound_clusters;
mod bound_tiles;
mod clusters;
mod counters;
mod cover;
mod coverage;
mod coverage_table;
mod cull;
mod edge;
mod eight_edges;
mod find_faces;
mod fold;
mod frame;
mod horizon;
mod lists;
mod occluders;
mod open_masks;
mod positions;
mod reference_depth;
mod sample_sets;
mod shaft;
mod silhouettes;
mod size_fold;
mod spread_reference;
mod sums;
mod tiles;
mod tree;
mod walk;

use super::Twin;

pub(super) fn twin(file: &str, entry: &str) -> Option<Twin> {
    Some(match (file, entry) {
        ("fold", "fold") => fold::fold,
        ("fold", "fold_areas") => fold::fold_areas,
        ("fold", "fold_own_samples") => fold::fold_own_samples,
        ("fold", "fold_own_samples_areas") => fold::fold_own_samples_areas,
        ("fold", "fold_attenuated") => fold::fold_attenuated,
        ("fold", "fold_attenuated_own_samples") => fold::fold_attenuated_own_samples,
        ("reference_depth", "reference_depth") => reference_depth::reference_depth,
        ("reference_depth", "reference_depth_attenuated") => reference_depth::reference_depth_attenuated,
        ("bound_clusters", "bound_clusters") => bound_clusters::bound_clusters,
        ("bound_tiles", "bound_tiles") => bound_tiles::bound_tiles,
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
        _ => return None,
    })
}
