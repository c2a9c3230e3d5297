//! The order in which tiles take receivers.

use crate::request::{ReceiverSource, Request};

/// Receivers of a block in the order of the tiles: pixels in squares of 8 × 8 made of blocks of
/// 4 × 2, points along a space-filling curve.
pub(super) fn order(request: &Request<'_>) -> Vec<u32> {
    let count = request.block.count;
    match request.receivers {
        ReceiverSource::Camera(camera) => {
            let width = camera.size()[0] as usize;
            let rows = count / width.max(1);
            let mut order = Vec::with_capacity(count);
            // Plain loops: this is done for every call, and chains of iterators took a hundredth of it.
            for top in (0..rows).step_by(8) {
                for left in (0..width).step_by(8) {
                    for y in (top..rows.min(top + 8)).step_by(2) {
                        for x in (left..width.min(left + 8)).step_by(4) {
                            for row in y..rows.min(y + 2) {
                                let first = (row * width + x) as u32;
                                order.extend(first..first + (width - x).min(4) as u32);
                            }
                        }
                    }
                }
            }
            order
        }
        ReceiverSource::Points(points) => {
            let frame = &request.scene.local.frame;
            let block = request.block;
            let positions: Vec<glam::DVec3> = points.positions()[block.first..block.first + count]
                .iter()
                .map(|p| frame.local_from_world(*p))
                .collect();
            let low = positions.iter().fold(glam::DVec3::INFINITY, |low, p| low.min(*p));
            let high = positions.iter().fold(glam::DVec3::NEG_INFINITY, |high, p| high.max(*p));
            let size = (high - low).max_element().max(f64::MIN_POSITIVE);
            let mut keyed: Vec<(u64, u32)> =
                (0..).zip(&positions).map(|(index, p)| (morton((*p - low) / size), index)).collect();
            keyed.sort_unstable();
            keyed.into_iter().map(|(_, index)| index).collect()
        }
    }
}

/// The place of a point of the unit cube on Morton's curve, 16 bits an axis.
fn morton(p: glam::DVec3) -> u64 {
    let spread = |x: f64| {
        let bits = (x * 65_535.0) as u64;
        (0..16).fold(0, |key, bit| key | (bits >> bit & 1) << (3 * bit))
    };
    spread(p.x) | spread(p.y) << 1 | spread(p.z) << 2
}
