//! Twins of the kernels of `occlusion_layers`.

mod bound_casters;
mod build_levels;
mod casters;
mod kernel;
mod layers;
mod levels;
mod look_up;
mod outline;
mod place_planes;
mod slice_triangles;
mod sum_areas;

use super::Twin;

pub(super) fn twin(file: &str, entry: &str) -> Option<Twin> {
    Some(match (file, entry) {
        ("bound_casters", "bound_casters") => bound_casters::bound_casters,
        ("build_levels", "build_level") => build_levels::build_level,
        ("build_levels", "expand") => build_levels::expand,
        ("look_up", "look_up") => look_up::look_up,
        ("look_up", "look_up_beyond") => look_up::look_up_beyond,
        ("look_up", "trace_near") => look_up::trace_near,
        ("place_planes", "place_planes") => place_planes::place_planes,
        ("slice_triangles", "slice_triangles") => slice_triangles::slice_triangles,
        ("slice_triangles", "size_rows") => slice_triangles::size_rows,
        ("slice_triangles", "slice_rows") => slice_triangles::slice_rows,
        ("sum_areas", "count_words") => sum_areas::count_words,
        ("sum_areas", "sum_columns") => sum_areas::sum_columns,
        _ => return None,
    })
}
