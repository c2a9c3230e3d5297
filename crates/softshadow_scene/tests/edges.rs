//! Edges and their triangles, on meshes that are closed, open, cut at seams, and not manifold.

use softshadow_scene::SceneError;
use softshadow_scene::edges::{Edge, EdgeList, edges, weld};

const CUBE: [[f64; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [1.0, 1.0, 1.0],
];
const CUBE_TRIANGLES: [[u32; 3]; 12] = [
    [0, 4, 6],
    [0, 6, 2],
    [1, 3, 7],
    [1, 7, 5],
    [0, 1, 5],
    [0, 5, 4],
    [2, 6, 7],
    [2, 7, 3],
    [0, 2, 3],
    [0, 3, 1],
    [4, 5, 7],
    [4, 7, 6],
];

/// Two incidences that run in opposite directions, at every edge.
fn is_closed_and_oriented(list: &EdgeList) -> bool {
    list.edges.iter().all(|edge| matches!(list.incidences_of(edge), [a, b] if a.forward != b.forward))
}

/// What no order of the input may change: where the edges are, and how often each is run along each way.
fn geometry(list: &EdgeList, positions: &[[f64; 3]]) -> Vec<([[f64; 3]; 2], usize, usize)> {
    let position = |canonical: u32| positions[list.weld.representatives[canonical as usize] as usize];
    let describe = |edge: &Edge| {
        let forward = list.incidences_of(edge).iter().filter(|i| i.forward).count();
        (edge.vertices.map(position), forward, edge.incidence_count as usize - forward)
    };
    list.edges.iter().map(describe).collect()
}

#[test]
fn a_cube_has_eighteen_edges_between_two_opposite_triangles() {
    let list = edges(&CUBE, &CUBE_TRIANGLES).unwrap();
    assert_eq!(list.edges.len(), 18);
    assert_eq!(list.incidences.len(), 36);
    assert!(is_closed_and_oriented(&list));
    assert!(list.edges.iter().all(|edge| edge.vertices[0] < edge.vertices[1]));

    let mut flipped = CUBE_TRIANGLES;
    flipped[5].swap(1, 2);
    let list = edges(&CUBE, &flipped).unwrap();
    assert_eq!(list.edges.len(), 18);
    assert!(!is_closed_and_oriented(&list), "a flipped triangle must show");
}

#[test]
fn canonical_indices_sort_by_position_and_not_by_the_files_order() {
    let welded = weld(&[[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 1.0, 5.0], [0.0, 1.0, -5.0], [0.0, 2.0, 0.0]]).unwrap();
    assert_eq!(welded.canonical, [3, 2, 1, 0, 2]);
    assert_eq!(welded.representatives, [3, 2, 1, 0]);
}

#[test]
fn equal_numbers_weld_and_near_ones_do_not() {
    let welded = weld(&[[0.0, 1.0, 2.0], [-0.0, 1.0, 2.0], [0.0, 1.0, 2.0_f64.next_up()]]).unwrap();
    assert_eq!(welded.canonical, [0, 0, 1]);
    assert_eq!(welded.representatives, [0, 2]);
}

#[test]
fn a_seam_of_split_vertices_closes() {
    // Every triangle with vertices of its own, as exporters write them at texture seams and creases.
    let mut soup: Vec<[f64; 3]> = CUBE_TRIANGLES.iter().flatten().map(|&v| CUBE[v as usize]).collect();
    let triangles: Vec<[u32; 3]> = (0..12).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let list = edges(&soup, &triangles).unwrap();
    assert!(is_closed_and_oriented(&list));
    assert_eq!(geometry(&list, &soup), geometry(&edges(&CUBE, &CUBE_TRIANGLES).unwrap(), &CUBE));

    soup[7][0] += 1e-12;
    assert!(!is_closed_and_oriented(&edges(&soup, &triangles).unwrap()), "a gap must stay a gap");
}

#[test]
fn a_fin_has_three_triangles_and_a_border_one() {
    let positions = [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]];
    let list = edges(&positions, &[[0, 1, 2], [0, 1, 3], [1, 0, 4]]).unwrap();
    let shared: Vec<_> = list.edges.iter().filter(|edge| edge.incidence_count == 3).collect();
    assert_eq!(shared.len(), 1);
    let incidences = list.incidences_of(shared[0]);
    assert_eq!(
        incidences.iter().map(|i| (i.triangle, i.forward)).collect::<Vec<_>>(),
        [(0, true), (1, true), (2, false)]
    );
    assert_eq!(list.edges.iter().filter(|edge| edge.incidence_count == 1).count(), 6);
}

#[test]
fn a_duplicated_triangle_counts_twice() {
    let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let list = edges(&positions, &[[0, 1, 2], [2, 0, 1]]).unwrap();
    assert_eq!(list.edges.len(), 3);
    for edge in &list.edges {
        assert!(matches!(list.incidences_of(edge), [a, b] if a.forward == b.forward));
    }
}

#[test]
fn triangles_that_weld_to_a_line_are_left_out() {
    let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
    let list = edges(&positions, &[[0, 1, 3], [0, 0, 2], [0, 1, 2], [2, 1, 2]]).unwrap();
    assert_eq!(list.edges.len(), 3);
    assert!(list.incidences.iter().all(|incidence| incidence.triangle == 2));
}

#[test]
fn order_does_not_matter() {
    let expected = geometry(&edges(&CUBE, &CUBE_TRIANGLES).unwrap(), &CUBE);
    // Triangles backwards, corners turned, vertices renumbered by v → 7 - v.
    let positions: Vec<_> = CUBE.iter().rev().copied().collect();
    let mut triangles: Vec<_> = CUBE_TRIANGLES.iter().rev().map(|&[a, b, c]| [7 - b, 7 - c, 7 - a]).collect();
    assert_eq!(geometry(&edges(&positions, &triangles).unwrap(), &positions), expected);

    triangles.pop();
    assert_ne!(geometry(&edges(&positions, &triangles).unwrap(), &positions), expected);
}

#[test]
fn nothing_has_no_edges() {
    assert_eq!(edges(&[], &[]).unwrap(), EdgeList::default());
}

#[test]
fn bad_input_is_an_error() {
    let out_of_range = SceneError::IndexOutOfRange { mesh: "all meshes".into(), triangle: 1, vertex: 8, vertices: 8 };
    assert_eq!(edges(&CUBE, &[[0, 1, 2], [0, 1, 8]]).unwrap_err(), out_of_range);
    let mut positions = CUBE;
    positions[3][1] = f64::NAN;
    assert!(matches!(edges(&positions, &CUBE_TRIANGLES), Err(SceneError::NotFinite { index: 3, .. })));
    let foreign = Edge { vertices: [0, 1], first_incidence: 30, incidence_count: 9 };
    assert!(edges(&CUBE, &CUBE_TRIANGLES).unwrap().incidences_of(&foreign).is_empty());
}
