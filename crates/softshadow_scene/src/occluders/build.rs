//! From triangles to faces, edges and a hierarchy over each.

use glam::{DVec3, Vec3};

use super::cut::{Front, Polygon, in_front, touches, widen};
use super::{
    Face, Incidence, LightBoundary, NO_SIDE, OPAQUE, OccluderEdge, Occluders, TouchingTriangle, UNITS_PER_HALVING,
};
use crate::bvh::Bvh;
use crate::edges::weld;
use crate::error::SceneError;
use crate::mesh::MAX_TRIANGLES;

/// Every face has at most four sides, and the largest packed index is a leaf's `first << 3 | count`. So within the limit of
/// triangles every index fits, and no later count has to be checked.
const _: () = assert!(4 * MAX_TRIANGLES <= (u32::MAX as u64 + 1) >> 3);

/// A side of a face, before its edge has an index.
struct Side {
    vertices: [u32; 2],
    incidence: Incidence,
    slot: u32,
}

impl Occluders {
    /// Prepares local triangles for one light; `opacity` gives that of a triangle by its index, 1 and more let nothing through.
    ///
    /// Triangles without area and triangles that attenuate by less than half a unit hide nothing and are left out.
    ///
    /// # Errors
    /// [`SceneError::TooLarge`] above [`MAX_TRIANGLES`], [`SceneError::NotFinite`] for the first triangle without a position,
    /// [`SceneError::Invalid`] for the first with an opacity that is negative or not finite.
    pub fn new(
        triangles: &[[[f32; 3]; 3]],
        opacity: impl Fn(usize) -> f32,
        boundary: &LightBoundary,
    ) -> Result<Self, SceneError> {
        check_count(triangles.len())?;
        let mut occluders = Self::default();
        let mut polygons = Vec::with_capacity(triangles.len());
        for (index, triangle) in triangles.iter().enumerate() {
            if !triangle.as_flattened().iter().all(|x| x.is_finite()) {
                return Err(SceneError::NotFinite { what: "triangles of the occluders".into(), index });
            }
            let attenuation = checked_attenuation(opacity(index), index)?;
            let corners = canonical(triangle);
            let Some(normal) = unit_normal(&corners) else { continue };
            if attenuation == 0 {
                continue;
            }
            let triangle = index as u32;
            let polygon = match *boundary {
                LightBoundary::Plane { point, normal } => match in_front(&corners, point.into(), normal.into()) {
                    Front::Behind => {
                        occluders.behind += 1;
                        continue;
                    }
                    Front::Whole => Polygon::whole(&corners),
                    Front::Part(part) => {
                        occluders.cut += 1;
                        part
                    }
                },
                LightBoundary::Ball { center, radius } if touches(&corners, center.into(), radius) => {
                    occluders.touching.push(TouchingTriangle { corners, triangle, attenuation });
                    continue;
                }
                LightBoundary::Ball { .. } | LightBoundary::None => Polygon::whole(&corners),
            };
            if polygon.corners().len() >= 3 {
                let (point, flatness) = (corners[0], flatness(normal, &corners));
                occluders.faces.push(Face { normal, triangle, point, attenuation, flatness, sides: [NO_SIDE; 4] });
                polygons.push(polygon);
            }
        }
        let polygons = occluders.arrange_faces(&polygons);
        occluders.join_edges(&polygons)?;
        Ok(occluders)
    }

    /// Builds the hierarchy over the faces, and puts faces and polygons in the order of its leaves.
    fn arrange_faces(&mut self, polygons: &[Polygon]) -> Vec<Polygon> {
        let boxes: Vec<[[f32; 3]; 3]> = polygons.iter().map(|polygon| box_around(polygon.corners())).collect();
        let Bvh { nodes, order, built_cost } = Bvh::build(&boxes);
        self.face_tree = Bvh { nodes, order: Vec::new(), built_cost };
        self.faces = order.iter().map(|&old| self.faces[old as usize]).collect();
        order.iter().map(|&old| polygons[old as usize]).collect()
    }

    /// Finds the edges that the polygons share, builds the hierarchy over them, and ties edges and faces to each other.
    fn join_edges(&mut self, polygons: &[Polygon]) -> Result<(), SceneError> {
        let corners: Vec<[f32; 3]> = polygons.iter().flat_map(Polygon::corners).copied().collect();
        let positions: Vec<[f64; 3]> = corners.iter().map(|corner| corner.map(f64::from)).collect();
        let weld = weld(&positions)?;
        let mut sides = Vec::with_capacity(corners.len());
        let mut first = 0;
        for (polygon, face) in polygons.iter().zip(0u32..) {
            let ring = &weld.canonical[first..first + polygon.corners().len()];
            first += ring.len();
            for ((&from, &to), slot) in ring.iter().zip(ring.iter().cycle().skip(1)).zip(0..) {
                let incidence = face << 1 | u32::from(from > to);
                sides.push(Side { vertices: [from.min(to), from.max(to)], incidence, slot });
            }
        }
        // With the slot the key is unique: a part that rounding folded flat may have the same side twice.
        sides.sort_unstable_by_key(|side| (side.vertices, side.incidence, side.slot));

        let runs: Vec<&[Side]> = sides.chunk_by(|a, b| a.vertices == b.vertices).collect();
        let ends = |run: &[Side]| run[0].vertices.map(|v| corners[weld.representatives[v as usize] as usize]);
        let boxes: Vec<[[f32; 3]; 3]> = runs.iter().map(|run| box_around(&ends(run))).collect();
        let Bvh { nodes, order, built_cost } = Bvh::build(&boxes);
        self.edge_tree = Bvh { nodes, order: Vec::new(), built_cost };
        self.edges.reserve_exact(runs.len());
        self.incidences.reserve_exact(sides.len());
        for (&old, edge) in order.iter().zip(0u32..) {
            let run = runs[old as usize];
            let [low, high] = ends(run);
            let first_incidence = self.incidences.len() as u32;
            self.edges.push(OccluderEdge { low, first_incidence, high, incidence_count: run.len() as u32 });
            for side in run {
                self.incidences.push(side.incidence);
                let face = &mut self.faces[(side.incidence >> 1) as usize];
                face.sides[side.slot as usize] = edge << 1 | side.incidence & 1;
            }
        }
        Ok(())
    }
}

fn check_count(triangles: usize) -> Result<(), SceneError> {
    let needed = triangles as u64;
    if needed > MAX_TRIANGLES {
        return Err(SceneError::TooLarge { what: "triangles of the occluders".into(), needed, limit: MAX_TRIANGLES });
    }
    Ok(())
}

/// Corners by position: x, then y, then z.
fn canonical(triangle: &[[f32; 3]; 3]) -> [[f32; 3]; 3] {
    // Adding +0 turns −0 into +0: equal positions must be equal bits.
    let mut corners = triangle.map(|corner| corner.map(|x| x + 0.0));
    corners.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])).then(a[2].total_cmp(&b[2])));
    corners
}

/// The largest height of a corner over the plane through the first.
pub(super) fn flatness(normal: [f32; 3], [point, b, c]: &[[f32; 3]; 3]) -> f32 {
    // The very operations with which a kernel takes a receiver's height over the plane: on a corner it then finds no more than this.
    let height = |corner: &[f32; 3]| Vec3::from(normal).dot(Vec3::from(*corner) - Vec3::from(*point)).abs();
    height(b).max(height(c))
}

/// The plane's side that sees the corners run counterclockwise; `None` without an area. The exponents of float32 fit four times
/// into those of float64, so no product of edges under- or overflows.
pub(super) fn unit_normal(corners: &[[f32; 3]; 3]) -> Option<[f32; 3]> {
    let [a, b, c] = corners.map(widen);
    let area = (b - a).cross(c - a);
    (area != DVec3::ZERO).then(|| area.normalize().as_vec3().to_array())
}

fn checked_attenuation(opacity: f32, triangle: usize) -> Result<u32, SceneError> {
    if !opacity.is_finite() || opacity < 0.0 {
        let reason = format!("{opacity} is no opacity; it is a number from 0, invisible, to 1, opaque");
        return Err(SceneError::invalid(format!("opacity of triangle {triangle}"), reason));
    }
    Ok(attenuation(opacity))
}

/// [`OPAQUE`], or the units of attenuation of one crossing: logarithms, so that what passes several layers is a sum, and integers, so that
/// what is added at one edge of a triangle is taken away at another to the last bit.
#[must_use]
pub fn attenuation(opacity: f32) -> u32 {
    if opacity >= 1.0 {
        return OPAQUE;
    }
    (-(1.0 - f64::from(opacity)).log2() * UNITS_PER_HALVING).round() as u32
}

/// A box as the degenerate triangle that spans it.
fn box_around(corners: &[[f32; 3]]) -> [[f32; 3]; 3] {
    let low = corners.iter().fold([f32::INFINITY; 3], |low, c| [0, 1, 2].map(|k| low[k].min(c[k])));
    let high = corners.iter().fold([f32::NEG_INFINITY; 3], |high, c| [0, 1, 2].map(|k| high[k].max(c[k])));
    [low, high, high]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opacity_becomes_units_of_attenuation() {
        let cases = [
            (0.0, 0),
            (-0.0, 0),
            (1e-5, 0),
            (2e-4, 1),
            (0.5, 4096),
            (0.75, 8192),
            (1.0 - f32::EPSILON / 2.0, 24 * 4096),
            (1.0, OPAQUE),
            (7.0, OPAQUE),
        ];
        for (opacity, expected) in cases {
            assert_eq!(checked_attenuation(opacity, 0), Ok(expected), "{opacity}");
        }
        for opacity in [-0.1, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let message = checked_attenuation(opacity, 41).unwrap_err().to_string();
            assert!(message.starts_with("opacity of triangle 41: "), "{message}");
        }
    }

    #[test]
    fn the_limit_of_triangles_is_checked_before_anything_is_built() {
        assert_eq!(check_count(1 << 27), Ok(()));
        assert!(matches!(check_count((1 << 27) + 1), Err(SceneError::TooLarge { .. })));
    }

    #[test]
    fn a_normal_exists_at_every_scale_that_float32_has() {
        let triangle = |s: f32| canonical(&[[0.0, s, 0.0], [0.0, 0.0, s], [s, 0.0, 0.0]]);
        let expected = unit_normal(&triangle(1.0));
        assert!(expected.is_some());
        for scale in [f32::from_bits(1), 2f32.powi(-126), 2f32.powi(-70), 2f32.powi(126)] {
            assert_eq!(unit_normal(&triangle(scale)), expected, "{scale}");
        }
        assert_eq!(unit_normal(&[[0.0; 3], [1.0; 3], [2.0; 3]]), None, "collinear");
        assert_eq!(unit_normal(&[[0.0; 3], [0.0; 3], [0.0, 1.0, 2.0]]), None, "equal corners");
    }
}
