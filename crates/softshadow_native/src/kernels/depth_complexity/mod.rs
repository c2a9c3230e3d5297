//! Twins of the kernels of `depth_complexity`.

mod area;
mod attenuation;
mod clusters;
mod counters;
mod cover;
mod coverage;
mod coverage_table;
mod edge;
mod fold;
mod frame;
mod horizon;
mod lists;
mod occluders;
mod reference_depth;
mod sums;
mod tiles;
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
        _ => return None,
    })
}
