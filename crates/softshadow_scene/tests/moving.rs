//! A moved scene is the scene made anew from the same vertices, but for the order of its triangles, faces and edges.

use std::collections::BTreeMap;

use softshadow_scene::occluders::{BoundaryEffect, Face, LightBoundary, NO_SIDE, Occluders};
use softshadow_scene::{LocalScene, Material, Mesh, Rebuild, Scene, SceneError, procedural};

const ROOMY: u64 = 128 << 20;
const UNCUT: BoundaryEffect = BoundaryEffect { boundary: LightBoundary::None, behind: Vec::new() };

fn local(scene: &Scene) -> LocalScene {
    LocalScene::new(scene, None, ROOMY)
}

fn occluders(local: &LocalScene) -> Occluders {
    let triangles: Vec<_> = local.triangles().collect();
    Occluders::new(&triangles, |_| 1.0, &LightBoundary::None).unwrap()
}

fn mesh(name: &str, vertices: &[[f64; 3]], triangles: &[[u32; 3]]) -> Mesh {
    Mesh::new(name, vertices.to_vec(), triangles.to_vec(), Material::default()).unwrap()
}

/// Two triangles that share an edge, one given without shared vertices.
fn hinge() -> Scene {
    let flap = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let other = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.5]];
    Scene::new(vec![mesh("flap", &flap, &[[0, 1, 2]]), mesh("other", &other, &[[0, 1, 2]])]).unwrap()
}

/// The hinge with one of the six vertices elsewhere.
fn hinge_with(vertex: usize, place: [f64; 3]) -> Scene {
    let scene = hinge();
    let mut vertices: Vec<Vec<[f64; 3]>> = scene.meshes().iter().map(|m| m.vertices.clone()).collect();
    vertices[vertex / 3][vertex % 3] = place;
    scene.with_vertices(vertices.into_iter().map(Some).collect()).unwrap()
}

/// The same vertices in a scene that remembers nothing.
fn anew(scene: &Scene) -> Scene {
    Scene::new(scene.meshes().to_vec()).unwrap()
}

/// Bits of the corners, their vertices, mesh.
type Told = ([[u32; 3]; 3], [u32; 3], u32);

/// Triangles by the caller's id.
fn by_caller(local: &LocalScene) -> BTreeMap<u32, Told> {
    let bits = |t: [[f32; 3]; 3]| t.map(|c| c.map(f32::to_bits));
    let rows = local.triangles().zip(&local.vertex_ids).zip(&local.mesh_ids).zip(&local.caller_ids);
    rows.map(|(((t, v), m), id)| (*id, (bits(t), *v, *m))).collect()
}

/// Plane of a face and its sides as ends and direction, by the caller's id of its triangle.
fn faces(occluders: &Occluders, local: &LocalScene) -> BTreeMap<u32, String> {
    let side = |s: &u32| {
        let edge = &occluders.edges[(s >> 1) as usize];
        (edge.low, edge.high, s & 1)
    };
    let told = |f: &Face| {
        let sides: Vec<_> = f.sides.iter().filter(|s| **s != NO_SIDE).map(side).collect();
        format!("{:?} {:?} {} {} {sides:?}", f.normal, f.point, f.flatness, f.attenuation)
    };
    occluders.faces.iter().map(|f| (local.caller_ids[f.triangle as usize], told(f))).collect()
}

/// Ends of every edge with the triangles at it and their directions.
fn edges(occluders: &Occluders, local: &LocalScene) -> Vec<String> {
    let incidence = |i: &u32| {
        let triangle = occluders.faces[(i >> 1) as usize].triangle;
        (local.caller_ids[triangle as usize], i & 1)
    };
    let list = occluders.edges.iter().map(|edge| {
        let first = edge.first_incidence as usize;
        let range = first..first + edge.incidence_count as usize;
        assert!(occluders.incidences[range.clone()].is_sorted());
        let mut at: Vec<_> = occluders.incidences[range].iter().map(incidence).collect();
        at.sort_unstable();
        format!("{:?} {:?} {at:?}", edge.low, edge.high)
    });
    let mut list: Vec<String> = list.collect();
    list.sort_unstable();
    list
}

fn same_scene(a: &LocalScene, b: &LocalScene) -> bool {
    by_caller(a) == by_caller(b) && (a.frame, a.extent, a.dropped) == (b.frame, b.extent, b.dropped)
}

fn same_occluders((a, of_a): (&Occluders, &LocalScene), (b, of_b): (&Occluders, &LocalScene)) -> bool {
    faces(a, of_a) == faces(b, of_b) && edges(a, of_a) == edges(b, of_b) && a.behind == b.behind
}

/// Every corner lies in the boxes of its leaf and of all above, and the boxes are no larger than that.
fn boxes_fit(local: &LocalScene) -> bool {
    local.sub_scenes.iter().all(|s| {
        (0..s.nodes.len()).all(|at| {
            let node = &s.nodes[at];
            let leaves = s.nodes[at..node.skip as usize].iter().filter(|n| n.leaf != 0);
            let corners: Vec<[f32; 3]> = leaves
                .flat_map(|n| {
                    let (first, count) = ((n.leaf >> 3) as usize, (n.leaf & 7) as usize);
                    s.corners[3 * first..3 * (first + count)].iter().map(|c| c.position)
                })
                .collect();
            (0..3).all(|k| {
                let low = corners.iter().fold(f32::INFINITY, |m, c| m.min(c[k]));
                let high = corners.iter().fold(f32::NEG_INFINITY, |m, c| m.max(c[k]));
                (node.low[k], node.high[k]) == (low, high)
            })
        })
    })
}

#[test]
fn frames_of_a_waving_scene_are_those_made_anew() {
    let still = procedural::shipped("toruses").unwrap().build().unwrap();
    let (mut scene, mut hidden) = (local(&still), occluders(&local(&still)));
    for frame in 0..5 {
        let now = procedural::waving(&still, f64::from(frame) / 5.0).unwrap();
        let moved = scene.moved(&now).unwrap();
        let hides = hidden.moved(&scene, &moved, &UNCUT).unwrap();
        let made = local(&anew(&now));
        assert!(same_scene(&moved, &made), "frame {frame}");
        assert!(same_occluders((&hides, &moved), (&occluders(&made), &made)), "frame {frame}");
        assert!(!same_scene(&moved, &scene), "it moves");
        assert!(!same_occluders((&hides, &moved), (&hidden, &scene)), "silhouettes move");
        (scene, hidden) = (moved, hides);
    }
    assert!(boxes_fit(&scene), "after five frames");
    let mut spoilt = scene.clone();
    spoilt.sub_scenes[0].nodes[5].high[1] += 1e-3;
    assert!(!boxes_fit(&spoilt), "a box too large is seen");
    let mut turned = hidden.clone();
    turned.faces[7].sides.swap(0, 1);
    assert!(!same_occluders((&turned, &scene), (&hidden, &scene)), "swapped sides are seen");
    let mut flipped = hidden.clone();
    flipped.incidences[9] ^= 1;
    assert!(!same_occluders((&flipped, &scene), (&hidden, &scene)), "a flipped incidence is seen");
}

#[test]
fn a_mirrored_turned_and_grown_scene_is_refitted() {
    let still = procedural::shipped("fork").unwrap().build().unwrap();
    let first = local(&still);
    let hidden = occluders(&first);
    type Way = fn(&[f64; 3]) -> [f64; 3];
    let ways: [Way; 3] =
        [|v| [-v[0], v[2], v[1]], |v| [v[1], v[2], v[0]], |v| [7.0 - 30.0 * v[0], 90.0 * v[1], 50.0 * v[2] + 1e5]];
    for way in ways {
        let vertices = still.meshes().iter().map(|m| Some(m.vertices.iter().map(way).collect()));
        let now = still.with_vertices(vertices.collect()).unwrap();
        let (moved, made) = (first.moved(&now).unwrap(), local(&anew(&now)));
        assert!(same_scene(&moved, &made) && boxes_fit(&moved));
        let hides = hidden.moved(&first, &moved, &UNCUT).unwrap();
        assert!(same_occluders((&hides, &moved), (&occluders(&made), &made)));
    }
}

#[test]
fn what_no_refit_can_serve_is_named() {
    let scene = hinge();
    let first = local(&scene);
    let hidden = occluders(&first);
    assert_eq!(hidden.edges.len(), 5);
    // Vertex 2 lies where vertex 4 does: alone it leaves, and the shared edge parts.
    let parted = first.moved(&hinge_with(2, [0.1, 1.2, 0.0])).unwrap();
    assert_eq!(hidden.moved(&first, &parted, &UNCUT), Err(Rebuild::Welding));
    // From there vertices meet.
    let apart = occluders(&parted);
    assert_eq!(apart.edges.len(), 6);
    assert_eq!(apart.moved(&parted, &first, &UNCUT), Err(Rebuild::Welding));
    // A triangle that becomes a line, and one that comes back.
    let flat = hinge_with(5, [0.5, 0.5, 0.0]);
    assert_eq!(first.moved(&flat), Err(Rebuild::Triangles));
    assert_eq!(local(&flat).moved(&scene), Err(Rebuild::Triangles));
    // Another order of the triangles.
    let swapped = Scene::new(scene.meshes().iter().rev().cloned().collect()).unwrap();
    assert_eq!(hidden.moved(&first, &local(&swapped), &UNCUT), Err(Rebuild::Order));
    // A light that leaves out a triangle, or cuts one.
    let behind = BoundaryEffect { boundary: LightBoundary::None, behind: vec![1] };
    assert_eq!(hidden.moved(&first, &first, &behind), Err(Rebuild::Boundary));
    let plane = LightBoundary::Plane { point: [0.0; 3], normal: [1.0, 0.0, 0.0] };
    let cut = BoundaryEffect { boundary: plane, behind: Vec::new() };
    assert_eq!(hidden.moved(&first, &first, &cut), Err(Rebuild::Boundary));
    assert_eq!(hidden.moved(&first, &first, &UNCUT), Ok(hidden));
}

#[test]
fn a_hierarchy_that_lost_its_neighbourhoods_is_built_anew() {
    // A row of blades that trade places: a third of the way is a small move, all of it puts neighbours far apart.
    let blade = |x: f64| [[x, 0.0, 0.0], [x + 0.01, 0.0, 0.0], [x, 1.0, 0.02]];
    let row = |of: &dyn Fn(usize) -> f64| (0..400).flat_map(|i| blade(of(i))).collect::<Vec<_>>();
    let triangles: Vec<[u32; 3]> = (0..400).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let still = Scene::new(vec![mesh("row", &row(&|i| i as f64), &triangles)]).unwrap();
    let first = local(&still);
    let frame = |of: &dyn Fn(usize) -> f64| still.with_vertices(vec![Some(row(of))]).unwrap();
    assert!(first.moved(&frame(&|i| i as f64 + 0.3 * (i as f64).sin())).is_ok());
    let shuffled = frame(&|i| (i * 171 % 400) as f64);
    assert_eq!(first.moved(&shuffled), Err(Rebuild::Stretched));
    let mut forced = first.clone();
    forced.sub_scenes[0].built_cost = f64::INFINITY;
    let forced = forced.moved(&shuffled).unwrap();
    assert!(same_scene(&forced, &local(&anew(&shuffled))) && boxes_fit(&forced), "slow, but not wrong");
    assert_eq!(occluders(&first).moved(&first, &forced, &UNCUT), Err(Rebuild::Stretched));
}

#[test]
fn bad_vertices_are_named() {
    let scene = hinge();
    let place = scene.meshes()[0].vertices.clone();
    let mut endless = place.clone();
    endless[2][1] = f64::NAN;
    assert_eq!(
        scene.with_vertices(vec![Some(endless), None]),
        Err(SceneError::NotFinite { what: "mesh 'flap' vertices".into(), index: 2 })
    );
    assert_eq!(
        scene.with_vertices(vec![None, Some(place[..2].to_vec())]),
        Err(SceneError::VertexCount { mesh: "other".into(), given: 2, expected: 3 })
    );
    let error = scene.with_vertices(vec![None]).unwrap_err().to_string();
    assert_eq!(error, "vertices of the scene: 1 entries given, but there are 2 meshes; give one a mesh");
    let moved = scene.with_vertices(vec![None, Some(place)]).unwrap();
    assert_eq!((moved.topology(), moved.meshes()[0].clone()), (scene.topology(), scene.meshes()[0].clone()));
    assert!(moved.identity() != scene.identity() && anew(&scene).topology() != scene.topology());
}

#[test]
fn waves_leave_the_floor_and_come_back() {
    let still = procedural::shipped("toruses").unwrap().build().unwrap();
    let low = still.bounds().unwrap().0[1];
    let frame = procedural::waving(&still, 0.25).unwrap();
    let pairs = still.meshes().iter().zip(frame.meshes()).flat_map(|(a, b)| a.vertices.iter().zip(&b.vertices));
    let (mut stayed, mut moved) = (0, 0);
    for (a, b) in pairs {
        assert_eq!(a[1], b[1]);
        if a[1] == low {
            assert_eq!(a, b);
            stayed += 1;
        } else {
            moved += usize::from(a != b);
        }
    }
    assert!(stayed >= 4 && moved > 1000, "{stayed} {moved}");
    assert_eq!(frame, procedural::waving(&still, 3.25).unwrap());
}
