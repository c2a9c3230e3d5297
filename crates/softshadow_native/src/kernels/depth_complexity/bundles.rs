//! Which receivers walk together: up to eight neighbours that see nearly the same.
//!
//! Eight slots in a row are neighbours in the image, and yet some may stand on a leaf and some on the ground far below it. What they look
//! at together is what any of them might see, so they part where that is far more than each alone.

use glam::Vec3;

use super::tree::TreeNode;
use crate::kernels::lanes::LANES;

/// Receivers that walk together stand no farther apart than this share of the average leaf's size. On foliage half of it takes more
/// steps, and twice of it 8 % longer.
const SHARE_OF_LEAF: f32 = 0.5;

/// How far apart receivers that walk together may stand.
pub(super) fn reach_of(tree: &[TreeNode]) -> f32 {
    let leaves = || tree.iter().filter(|node| node.leaf != 0);
    let sizes: f32 = leaves().map(|node| (node.high - node.low).max_element()).sum();
    SHARE_OF_LEAF * sizes / leaves().count().max(1) as f32
}

/// Parts lanes, one bit each, until those of a group stand together.
pub(super) fn groups(lanes: u8, positions: &[Vec3; LANES], reach: f32) -> impl Iterator<Item = u8> {
    // A group that parts stays where it is, and its other half takes a place that nobody has.
    let mut groups = [0; LANES];
    groups[0] = lanes;
    let mut count = usize::from(lanes != 0);
    let mut at = 0;
    while at < count {
        match half(groups[at], positions, reach) {
            None => at += 1,
            Some(first) => {
                groups[count] = groups[at] & !first;
                groups[at] = first;
                count += 1;
            }
        }
    }
    groups.into_iter().take(count)
}

/// The lanes on one side of the widest gap; nothing where all stand together.
fn half(lanes: u8, positions: &[Vec3; LANES], reach: f32) -> Option<u8> {
    let members = || (0..LANES).filter(|k| lanes >> k & 1 != 0);
    let low = members().fold(Vec3::INFINITY, |low, k| low.min(positions[k]));
    let high = members().fold(Vec3::NEG_INFINITY, |high, k| high.max(positions[k]));
    let axis = (high - low).max_position();
    if (high - low)[axis] <= reach {
        return None;
    }
    let place = |k: usize| positions[k][axis];
    // How far it is from each to the next one.
    let gap = |k: usize| members().map(place).filter(|next| *next > place(k)).fold(f32::INFINITY, f32::min) - place(k);
    let before = members().filter(|k| place(*k) < high[axis]).max_by(|a, b| gap(*a).total_cmp(&gap(*b)))?;
    Some(members().filter(|k| place(*k) <= place(before)).fold(0, |lanes, k| lanes | 1 << k))
}
