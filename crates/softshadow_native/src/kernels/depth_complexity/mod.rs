//! Twins of the kernels of `depth_complexity`.

mod area;
mod attenuation;
mod beam;
mod bound_clusters;
mod bound_tiles;
mod bundles;
mod clusters;
mod counters;
mod cover;
mod cover_faces;
mod coverage;
mod coverage_table;
mod cull;
mod edge;
mod eight_edges;
mod find_faces;
mod fold;
mod frame;
mod hider;
mod horizon;
mod lists;
mod occluders;
mod open_masks;
mod positions;
mod reference_depth;
mod sample_bins;
mod sample_sets;
mod shaft;
mod sides;
mod silhouettes;
mod size_fold;
mod spread_reference;
mod sums;
mod tiles;
mod touching;
mod tree;
mod walk;

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
        ("fold", "fold") => fold::fold,
        ("fold", "fold_areas") => fold::fold_areas,
        ("fold", "fold_attenuated") => fold::fold_attenuated,
        ("fold", "fold_attenuated_own_samples") => fold::fold_attenuated_own_samples,
        ("fold", "fold_own_samples") => fold::fold_own_samples,
        ("fold", "fold_own_samples_areas") => fold::fold_own_samples_areas,
        ("open_masks", "open_masks") => open_masks::open_masks,
        ("open_masks", "open_masks_of_sets") => open_masks::open_masks_of_sets,
        ("reference_depth", "reference_depth") => reference_depth::reference_depth,
        ("reference_depth", "reference_depth_attenuated") => reference_depth::reference_depth_attenuated,
        ("silhouettes", "silhouettes") => silhouettes::silhouettes,
        ("silhouettes", "standard_silhouettes") => silhouettes::standard_silhouettes,
        ("size_fold", "size_fold") => size_fold::size_fold,
        ("spread_reference", "spread_reference") => spread_reference::spread_reference,
        ("touching", "try_touching") => touching::try_touching,
        _ => return None,
    })
}
