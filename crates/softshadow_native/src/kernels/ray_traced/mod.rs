//! Twins of the kernels of `ray_traced`.

mod begin;
mod bundle;
mod choose;
mod count_groups;
mod gather;
mod hierarchy;
mod narrow;
mod trace;

use super::Twin;

pub(super) fn twin(file: &str, entry: &str) -> Option<Twin> {
    Some(match (file, entry) {
        ("begin", "begin") => begin::begin,
        ("choose", "choose") => choose::choose,
        ("choose", "choose_attenuated") => choose::choose_attenuated,
        ("count_groups", "count_groups") => count_groups::count_groups,
        ("gather", "gather") => gather::gather,
        ("narrow", "narrow") => narrow::narrow,
        ("trace", "trace") => trace::trace,
        ("trace", "trace_attenuated") => trace::trace_attenuated,
        _ => return None,
    })
}
