//! Which faces and edges can matter to a receiver: walks through their hierarchies that leave out only what no sign could count.

use glam::Vec3;
use softshadow_scene::occluders::{Face, OccluderEdge, Occluders};
use softshadow_scene::{Bvh, BvhNode};

use super::view::LightView;

/// Widens every test by more than its own rounding.
const SLACK: f32 = 4e-6;

/// Calls `visit` for every face that the way to the reference point may meet.
pub fn faces_on_the_way(view: &LightView, occluders: &Occluders, mut visit: impl FnMut(&Face)) {
    let way = view.ways[2];
    walk(&occluders.face_tree, |node| way_meets(view.position, way, node), |face| visit(&occluders.faces[face]));
}

/// Calls `visit` for every edge that a way from the reference point to the light may cross. `bounds` holds the light.
pub fn edges_in_reach(
    view: &LightView,
    bounds: [[f32; 2]; 2],
    occluders: &Occluders,
    mut visit: impl FnMut(&OccluderEdge),
) {
    let [low, high] = bounds;
    let [x, y, z] = view.rows;
    // Each is positive for what projects beyond one side of the bounds, also behind the receiver.
    let outside = [x - z * high[0], z * low[0] - x, y - z * high[1], z * low[1] - y];
    let may_matter = |node: &BvhNode| {
        let (middle, half) = box_around(view.position, node);
        let size = middle.abs() + half;
        let is_outside = |row: &Vec3| row.dot(middle) > row.abs().dot(half + size * SLACK);
        let is_beyond = view.limit.is_some_and(|(towards, limit)| {
            towards.dot(middle) - towards.abs().dot(half + size * SLACK) > limit * (1.0 + SLACK)
        });
        !(is_beyond || outside.iter().any(is_outside))
    };
    walk(&occluders.edge_tree, may_matter, |edge| visit(&occluders.edges[edge]));
}

fn walk(tree: &Bvh, enters: impl Fn(&BvhNode) -> bool, mut visit: impl FnMut(usize)) {
    let mut at = 0;
    while let Some(node) = tree.nodes.get(at) {
        if !enters(node) {
            at = node.skip as usize;
            continue;
        }
        let (first, count) = (node.leaf >> 3, node.leaf & 7);
        (first..first + count).for_each(|index| visit(index as usize));
        at += 1;
    }
}

/// Middle and half size of a box, relative to the receiver.
fn box_around(position: Vec3, node: &BvhNode) -> (Vec3, Vec3) {
    let (low, high) = (Vec3::from(node.low) - position, Vec3::from(node.high) - position);
    ((low + high) * 0.5, (high - low) * 0.5)
}

/// Whether the line from the receiver along `way`, ahead of it, may meet a box.
fn way_meets(position: Vec3, way: Vec3, node: &BvhNode) -> bool {
    let (middle, half) = box_around(position, node);
    let half = half + (middle.abs() + half) * SLACK;
    let ahead = middle.dot(way) + half.dot(way.abs()) >= 0.0;
    // Separating axes of a line and a box: the cross products with the box's axes.
    let across = middle.cross(way).abs();
    let size = way.abs();
    let reach = Vec3::new(
        half.y * size.z + half.z * size.y,
        half.z * size.x + half.x * size.z,
        half.x * size.y + half.y * size.x,
    );
    ahead && across.cmple(reach).all()
}
