//! Edges of a triangle soup with all triangles that share them, whatever the mesh: open, non-manifold, cut at
//! texture seams or wound inconsistently.
//!
//! Vertices are welded by exact position for adjacency only; what the caller sees keeps his vertices. A canonical
//! index sorts by position, so it does not depend on how the file orders its vertices, and every pipeline that
//! evaluates an edge from its lower to its higher vertex rounds alike.

use std::cmp::Ordering;

use crate::error::SceneError;
use crate::mesh::MAX_TRIANGLES;

/// Vertices at the same position are one vertex.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Weld {
    /// For each vertex its canonical index, which counts the different positions in the order of x, then y, then z.
    pub canonical: Vec<u32>,
    /// For each canonical index the first vertex that lies there.
    pub representatives: Vec<u32>,
}

/// One triangle at an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Incidence {
    /// Index of the triangle in the caller's list.
    pub triangle: u32,
    /// Whether the triangle's winding goes from the edge's lower canonical vertex to the higher.
    pub forward: bool,
}

/// Two vertices that at least one triangle joins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Edge {
    /// Canonical indices, the lower first.
    pub vertices: [u32; 2],
    /// Where the edge's incidences start in [`EdgeList::incidences`].
    pub first_incidence: u32,
    /// How many there are: 1 at a border, 2 inside a surface, more at a fin.
    pub incidence_count: u32,
}

/// Every edge once, sorted by its vertices.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct EdgeList {
    /// How the caller's vertices map to those of the edges.
    pub weld: Weld,
    /// The edges.
    pub edges: Vec<Edge>,
    /// The incidences of all edges, each edge's together and sorted by triangle.
    pub incidences: Vec<Incidence>,
}

impl EdgeList {
    /// The triangles that share an edge of this list; empty for an edge of another.
    #[must_use]
    pub fn incidences_of(&self, edge: &Edge) -> &[Incidence] {
        let first = edge.first_incidence as usize;
        self.incidences.get(first..first + edge.incidence_count as usize).unwrap_or_default()
    }
}

/// Welds vertices whose coordinates are equal as numbers (`-0.0` and `0.0` are); no tolerance.
///
/// # Errors
/// [`SceneError::TooLarge`] for more vertices than 32-bit indices count, [`SceneError::NotFinite`] for the first
/// vertex that has no position.
pub fn weld(positions: &[[f64; 3]]) -> Result<Weld, SceneError> {
    let count = u32::try_from(positions.len()).map_err(|_| SceneError::TooLarge {
        what: "vertices of the scene".into(),
        needed: positions.len() as u64,
        limit: u64::from(u32::MAX),
    })?;
    if let Some(index) = positions.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        return Err(SceneError::NotFinite { what: "vertices to weld".into(), index });
    }
    // Adding +0.0 turns -0.0 into +0.0 and changes nothing else, so that a total order puts both together.
    let key = |vertex: u32| positions.get(vertex as usize).map_or([0.0; 3], |p| p.map(|x| x + 0.0));
    let mut order: Vec<u32> = (0..count).collect();
    order.sort_unstable_by(|&a, &b| compare_positions(&key(a), &key(b)).then(a.cmp(&b)));

    let mut weld = Weld { canonical: vec![0; positions.len()], representatives: Vec::new() };
    for run in order.chunk_by(|&a, &b| compare_positions(&key(a), &key(b)).is_eq()) {
        for &vertex in run {
            if let Some(canonical) = weld.canonical.get_mut(vertex as usize) {
                *canonical = weld.representatives.len() as u32;
            }
        }
        weld.representatives.extend(run.first());
    }
    Ok(weld)
}

fn compare_positions(a: &[f64; 3], b: &[f64; 3]) -> Ordering {
    a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])).then(a[2].total_cmp(&b[2]))
}

/// The edges of all triangles. A triangle that has two corners at one position spans no area, hides nothing, and is
/// left out.
///
/// # Errors
/// Those of [`weld`], [`SceneError::TooLarge`] above [`MAX_TRIANGLES`], and [`SceneError::IndexOutOfRange`] for the
/// first triangle with a vertex that is not there.
pub fn edges(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Result<EdgeList, SceneError> {
    let needed = triangles.len() as u64;
    if needed > MAX_TRIANGLES {
        return Err(SceneError::TooLarge { what: "triangles of the scene".into(), needed, limit: MAX_TRIANGLES });
    }
    let weld = weld(positions)?;
    let canonical_of = |triangle: usize, vertex: u32| {
        weld.canonical.get(vertex as usize).copied().ok_or_else(|| SceneError::IndexOutOfRange {
            mesh: "all meshes".into(),
            triangle,
            vertex: u64::from(vertex),
            vertices: positions.len(),
        })
    };
    let mut sides: Vec<([u32; 2], Incidence)> = Vec::with_capacity(triangles.len() * 3);
    for (index, &[a, b, c]) in triangles.iter().enumerate() {
        let [a, b, c] = [canonical_of(index, a)?, canonical_of(index, b)?, canonical_of(index, c)?];
        if a == b || b == c || c == a {
            continue;
        }
        for [from, to] in [[a, b], [b, c], [c, a]] {
            let incidence = Incidence { triangle: index as u32, forward: from < to };
            sides.push(([from.min(to), from.max(to)], incidence));
        }
    }
    // A triangle that is left in has three different edges, so this key is unique and the order is the only one.
    sides.sort_unstable_by_key(|(vertices, incidence)| (*vertices, incidence.triangle));

    let mut list = EdgeList { weld, edges: Vec::new(), incidences: Vec::with_capacity(sides.len()) };
    for run in sides.chunk_by(|a, b| a.0 == b.0) {
        if let Some((vertices, _)) = run.first() {
            let first_incidence = list.incidences.len() as u32;
            list.edges.push(Edge { vertices: *vertices, first_incidence, incidence_count: run.len() as u32 });
        }
        list.incidences.extend(run.iter().map(|(_, incidence)| *incidence));
    }
    Ok(list)
}
