//! The rules that every set of occluders keeps, as checks that name what breaks them.

use super::super::*;

/// Start and end of a side.
fn ends(occluders: &Occluders, side: u32) -> [[f32; 3]; 2] {
    let edge = &occluders.edges[(side >> 1) as usize];
    if side & 1 == 1 { [edge.high, edge.low] } else { [edge.low, edge.high] }
}

pub(super) fn sides(face: &Face) -> &[u32] {
    &face.sides[..face.sides.iter().position(|&s| s == NO_SIDE).unwrap_or(4)]
}

pub(super) fn corners(occluders: &Occluders, face: &Face) -> Vec<[f32; 3]> {
    sides(face).iter().map(|&s| ends(occluders, s)[0]).collect()
}

/// Faces close, faces and edges name each other, and both hierarchies cover everything once.
pub(super) fn check(occluders: &Occluders) -> Result<(), String> {
    let mut seen = Vec::new();
    for (index, face) in occluders.faces.iter().enumerate() {
        let sides = sides(face);
        if sides.len() < 3 || face.sides[sides.len()..].iter().any(|&s| s != NO_SIDE) {
            return Err(format!("face {index} has {:?}", face.sides));
        }
        for (k, &side) in sides.iter().enumerate() {
            if ends(occluders, side)[1] != ends(occluders, sides[(k + 1) % sides.len()])[0] {
                return Err(format!("face {index} is open after side {k}"));
            }
            seen.push((side >> 1, (index as u32) << 1 | side & 1));
        }
        if (f64::from(face.normal[0]).hypot(face.normal[1].into()).hypot(face.normal[2].into()) - 1.0).abs() > 1e-6 {
            return Err(format!("face {index} has the normal {:?}", face.normal));
        }
    }
    let mut listed = Vec::new();
    for (edge, index) in occluders.edges.iter().zip(0u32..) {
        if edge.low >= edge.high || edge.first_incidence as usize != listed.len() {
            return Err(format!("edge {index} is {edge:?}"));
        }
        let range = edge.first_incidence as usize..(edge.first_incidence + edge.incidence_count) as usize;
        listed.extend(occluders.incidences[range].iter().map(|&incidence| (index, incidence)));
    }
    seen.sort_unstable();
    if seen != listed {
        return Err("sides and incidences differ".into());
    }
    let faces: Vec<_> = occluders.faces.iter().map(|face| corners(occluders, face)).collect();
    let edges: Vec<_> = occluders.edges.iter().map(|edge| vec![edge.low, edge.high]).collect();
    check_tree(&occluders.face_tree, &faces).and_then(|()| check_tree(&occluders.edge_tree, &edges))
}

fn check_tree(tree: &Bvh, items: &[Vec<[f32; 3]>]) -> Result<(), String> {
    let mut covered = vec![0; items.len()];
    let mut open: Vec<usize> = Vec::new();
    for (index, node) in tree.nodes.iter().enumerate() {
        open.retain(|&o| tree.nodes[o].skip as usize > index);
        open.push(index);
        for slot in node.leaf >> 3..(node.leaf >> 3) + (node.leaf & 7) {
            covered[slot as usize] += 1;
            for o in open.iter().map(|&o| &tree.nodes[o]) {
                if items[slot as usize].iter().any(|v| (0..3).any(|k| v[k] < o.low[k] || v[k] > o.high[k])) {
                    return Err(format!("entry {slot} leaves its box"));
                }
            }
        }
    }
    if covered.iter().any(|&count| count != 1) || !tree.order.is_empty() {
        return Err("leaves do not index every entry once".into());
    }
    Ok(())
}

fn exact(position: [f32; 3]) -> [i128; 3] {
    position.map(|x| {
        assert_eq!((x * 1024.0).fract(), 0.0);
        (x * 1024.0) as i128
    })
}

fn minus(a: [i128; 3], b: [i128; 3]) -> [i128; 3] {
    [0, 1, 2].map(|k| a[k] - b[k])
}

fn cross(a: [i128; 3], b: [i128; 3]) -> [i128; 3] {
    [0, 1, 2].map(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
}

fn dot(a: [i128; 3], b: [i128; 3]) -> i128 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Seen from the positive side of its plane, a face lies left of an edge exactly where it does not run backward along it.
pub(super) fn check_winding(occluders: &Occluders) -> Result<(), String> {
    for face in &occluders.faces {
        let ring = corners(occluders, face);
        let mut canonical: Vec<_> = ring.iter().map(|&c| exact(c)).collect();
        canonical.sort_unstable();
        let area = cross(minus(canonical[1], canonical[0]), minus(canonical[2], canonical[0]));
        let along: f64 = (0..3).map(|k| area[k] as f64 * f64::from(face.normal[k])).sum();
        if along <= 0.0 || exact(face.point) != canonical[0] {
            return Err(format!("the plane of triangle {}", face.triangle));
        }
        for (k, &side) in sides(face).iter().enumerate() {
            let edge = &occluders.edges[(side >> 1) as usize];
            let (low, high, third) = (exact(edge.low), exact(edge.high), exact(ring[(k + 2) % 3]));
            let left = dot(cross(area, minus(high, low)), minus(third, low)) > 0;
            if left != (side & 1 == 0) {
                return Err(format!("side {k} of triangle {}", face.triangle));
            }
        }
    }
    Ok(())
}
