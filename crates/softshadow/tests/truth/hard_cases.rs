//! The hard cases of counting layers by silhouette edges, on the device, each against float64 rays on the same receivers and samples, and
//! each with its mutation check (`judge.rs`). The same cases for the scalar model: `hard_cases.rs` of `softshadow_native`.
//!
//! | case | input | test |
//! |---|---|---|
//! | DC1 | ties: an edge's plane holds receiver and reference point | `edges::dc01_a_lattice_of_ties`, `edges::dc01_faces_in_one_plane_with_the_reference_point` |
//! | DC2 | an edge along the view ray | `edges::dc02_edges_along_the_view` |
//! | DC3 | an edge parallel to the light's plane | `edges::dc03_edges_parallel_to_the_light` |
//! | DC4 | an edge through the receiver's plane | `places::dc04_half_buried_bodies`, `places::dc04_floors_through_bodies_under_a_camera` |
//! | DC5 | geometry through, around and behind the light | `lamps::dc05_*` |
//! | DC6 | receivers in a closed body | `places::dc06_inside_a_closed_body_nothing_is_seen` |
//! | DC7 | receivers on the occluder | `places::dc07_the_terminator_of_a_ball`, `places::dc07_the_own_corners_of_a_body` |
//! | DC8 | contact | `places::dc08_contact_gaps` |
//! | DC9 | a camera in shadow volumes and at the near plane | `blended::cameras_stand_in_wedges_and_before_casters` |
//! | DC10 | rasterised decisions | `blended::shipped_scenes_have_the_bits_of_tiles`, `places::dc04_floors_through_bodies_under_a_camera` |
//! | DC11 | more layers than counters hold | `meshes::dc11_*`, `blended::any_number_of_layers_is_counted` |
//! | DC12 | the order of events | `meshes::dc12_the_order_of_triangles_changes_no_bit`, `blended::blocks_textures_and_passes_change_no_bit` |
//! | DC13 | open, flipped, duplicated, three-faced, unwelded, sliver meshes | `meshes::dc13_*` |
//! | DC14 | T-junctions | `meshes::dc14_t_junctions_are_hairlines` |
//! | DC15 | two-sided leaves | `meshes::dc15_leaves` |
//! | DC16 | bodies in each other | `meshes::dc16_bodies_in_each_other` |
//! | DC17 | silhouettes of one point of the light alone | `depth_complexity::silhouettes_of_one_point_are_fewer_and_wrong` |
//! | DC18 | coverage by tables | `tables.rs` of `softshadow_native` |
//! | DC19 | semi-opaque occluders | `semi_opaque.rs` of `softshadow_native`, and of this folder |
//!
//! Offsets and scales, which are no cases of their own, are in `sizes`.

mod edges;
mod judge;
mod lamps;
mod meshes;
mod places;
mod sizes;

use softshadow::{Light, LightShape, Receivers, look_at};

use crate::common::{Random, points, rectangle};
use crate::shapes::{Point, Triangle};

fn aimed(shape: LightShape, eye: Point, target: Point) -> Light {
    Light::new(shape, look_at(eye, target, None).unwrap()).unwrap()
}

/// The light of cases that need no other: lopsided, so that a mirror would show.
fn slanting() -> Light {
    aimed(rectangle(1.0, 0.8), [0.3, 0.4, 3.0], [0.0; 3])
}

/// 131,072 pairs with 64 samples each.
const MANY: usize = 2048;

fn below(random: &mut Random, count: usize) -> Receivers {
    points(random.points(count, [-1.0, 1.0], [-1.0, 1.0], [-1.0, -0.6]))
}

fn all_around(random: &mut Random, count: usize) -> Receivers {
    points(random.points(count, [-1.0, 1.0], [-1.0, 1.0], [-1.0, 1.0]))
}

/// A triangle of any orientation; corners are up to `size` off its middle.
fn leaf(random: &mut Random, size: f64, across: [f64; 2], up: [f64; 2]) -> Triangle {
    let middle = random.point(across, across, up);
    let mut corner = || {
        let off = random.point([-size, size], [-size, size], [-size, size]);
        [0, 1, 2].map(|k| middle[k] + off[k])
    };
    [corner(), corner(), corner()]
}
