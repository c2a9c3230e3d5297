//! Polygons as triangles between their own corners.

use earcut::Earcut;
use earcut::utils3d::project3d_to_2d;
use glam::DVec3;

/// Clipping ears takes quadratic time, so a hostile file must not choose how many corners it is tried on.
const MAX_EARS: usize = 1 << 10;

/// Cuts a polygon whose corners are all in range, and says whether the cut is sure.
///
/// A fan around the first corner serves where no triangle of it folds back; other polygons have their ears clipped. What cannot be
/// clipped, because it crosses itself, spans no area or has more than [`MAX_EARS`] corners, becomes a fan all the same.
pub(super) fn cut(vertices: &[[f64; 3]], corners: &[u32], triangles: &mut Vec<[u32; 3]>) -> bool {
    let fan = |triangles: &mut Vec<[u32; 3]>| {
        if let [first, rim @ ..] = corners {
            triangles.extend(rim.iter().zip(rim.iter().skip(1)).map(|(&a, &b)| [*first, a, b]));
        }
    };
    if corners.len() <= 3 {
        fan(triangles);
        return true;
    }
    let outline = unit_outline(vertices, corners);
    if is_fan(&outline) {
        fan(triangles);
        return true;
    }
    let mut flat: Vec<[f64; 2]> = Vec::new();
    let mut ears: Vec<u32> = Vec::new();
    if corners.len() <= MAX_EARS && project3d_to_2d(&outline, outline.len(), &mut flat) {
        Earcut::new().earcut(flat, &[], &mut ears);
    }
    let corner = |&ear: &u32| corners.get(ear as usize).copied().unwrap_or_default();
    let clipped = ears.as_chunks::<3>().0;
    if clipped.is_empty() {
        fan(triangles);
        return false;
    }
    triangles.extend(clipped.iter().map(|ear| ear.each_ref().map(corner)));
    true
}

/// The corners relative to the first one and as large as 1, so that neither map coordinates nor units matter.
fn unit_outline(vertices: &[[f64; 3]], corners: &[u32]) -> Vec<[f64; 3]> {
    let at = |corner: &u32| vertices.get(*corner as usize).copied().map(DVec3::from).unwrap_or_default();
    let first = corners.first().map(at).unwrap_or_default();
    let relative = || corners.iter().map(|corner| at(corner) - first);
    let extent = relative().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let scale = if extent > 0.0 { extent.recip() } else { 1.0 };
    relative().map(|p| (p * scale).to_array()).collect()
}

/// Whether all triangles of the fan turn the same way as the polygon.
fn is_fan(outline: &[[f64; 3]]) -> bool {
    let turns =
        || outline.iter().zip(outline.iter().skip(1)).skip(1).map(|(a, b)| DVec3::from(*a).cross(DVec3::from(*b)));
    let normal: DVec3 = turns().sum();
    turns().all(|turn| turn.dot(normal) >= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twice the area that the triangles cover, and whether the cut is sure.
    fn area(outline: &[[f64; 3]]) -> (f64, bool) {
        let corners: Vec<u32> = (0..outline.len() as u32).collect();
        let mut triangles = Vec::new();
        let sure = cut(outline, &corners, &mut triangles);
        let corner = |i: u32| DVec3::from(outline[i as usize]);
        let twice = triangles.iter().map(|t| (corner(t[1]) - corner(t[0])).cross(corner(t[2]) - corner(t[0])).length());
        (twice.sum(), sure)
    }

    #[test]
    fn convex_and_concave_polygons_are_covered_once_in_any_plane_and_place() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        // The first corner sees not all of the others: a fan around it would fold over.
        let arrow = [[0.0, 2.0], [1.0, 0.5], [2.0, 2.0], [1.0, -1.0]];
        let comb = [[3.0, 3.0], [2.5, 1.0], [2.0, 3.0], [1.0, 3.0], [0.5, 1.0], [0.0, 3.0], [0.0, 0.0], [3.0, 0.0]];
        let shoelace = |p: &[[f64; 2]]| -> f64 {
            p.iter().zip(p.iter().cycle().skip(1)).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>().abs()
        };
        for outline in [&square[..], &arrow, &comb] {
            for scale in [1e-20, 1.0, 1e20] {
                let placed = |f: fn([f64; 2]) -> [f64; 3]| -> Vec<[f64; 3]> {
                    outline.iter().map(|p| f(*p).map(|x| (x + 8.0) * scale)).collect()
                };
                for polygon in [placed(|[x, y]| [x, y, 0.0]), placed(|[x, y]| [0.0, y, x]), placed(|[x, y]| [y, x, y])]
                {
                    let flat = polygon.iter().all(|p| p[2] == 8.0 * scale || p[0] == 8.0 * scale);
                    let expected = shoelace(outline) * scale * scale * if flat { 1.0 } else { 2f64.sqrt() };
                    let (got, sure) = area(&polygon);
                    assert!(sure && (got / expected - 1.0).abs() < 1e-9, "{polygon:?}: {got} of {expected}");
                }
            }
        }
    }

    #[test]
    fn what_cannot_be_cut_is_a_fan_and_says_so() {
        let mut star: Vec<[f64; 3]> = (0..3000)
            .map(|i| (f64::from(i) * 0.01, f64::from(1 + i % 2)))
            .map(|(a, r)| [a.cos() * r, a.sin() * r, 0.0])
            .collect();
        let mut triangles = Vec::new();
        let corners: Vec<u32> = (0..3000).collect();
        assert!(!cut(&star, &corners, &mut triangles));
        assert_eq!(triangles.len(), 2998);
        // All corners in one place have no area to lose.
        star.fill([1.0; 3]);
        assert_eq!(area(&star[..5]), (0.0, true));
    }
}
