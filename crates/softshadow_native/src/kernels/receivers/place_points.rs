//! The twin of `receivers/place_points.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use rayon::prelude::*;

use crate::engine::Call;
use crate::kernels::shared::receiver::{NO_TRIANGLE, RECEIVER_POINT, RECEIVER_SURFACE, Receiver, receiver_lift};
use crate::kernels::{RUN, records, records_mut};

#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct LocalPoint {
    position: Vec3,
    has_normal: u32,
    normal: Vec3,
    unused: u32,
}

pub(super) fn place(call: &mut Call) {
    let items = call.item_range();
    let scene_extent: f32 = call.uniform("point_range");
    let [points, receivers] = call.buffers(["points", "receivers"]);
    let points = &records::<LocalPoint>(points)[items.clone()];
    let receivers = &mut records_mut::<Receiver>(receivers)[items];
    let place = |(receiver, point): (&mut Receiver, &LocalPoint)| {
        let has_normal = point.has_normal != 0;
        let lifted = receiver_lift(point.position, point.normal, scene_extent);
        let position = if has_normal { lifted } else { point.position };
        let kind = if has_normal { RECEIVER_SURFACE } else { RECEIVER_POINT };
        *receiver = Receiver { position, triangle: NO_TRIANGLE, normal: point.normal, kind };
    };
    receivers.par_iter_mut().zip(points).with_min_len(RUN).for_each(place);
}
