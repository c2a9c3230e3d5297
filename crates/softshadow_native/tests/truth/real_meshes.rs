//! Real meshes: many receivers on and around them, every sample against float64 rays, every difference explained.
//!
//! `cargo test --release -p softshadow_native --test truth -- --ignored` runs the whole of it (`make evidence`); a short run is part of
//! every test run.

use std::path::PathBuf;

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use softshadow_measure::needed_roundings;
use softshadow_native::depth_complexity::edge::ProjectedEdge;
use softshadow_native::depth_complexity::face::{self, Layers};
use softshadow_native::depth_complexity::view::Sight;
use softshadow_native::depth_complexity::{Coverage, CoverageTables, LightView, Receiver, Seen};
use softshadow_scene::{LightShape, LocalScene, Material, Mesh, Scene, procedural, scene_file};

use crate::areas::{Answers, SQUARE, judge_area};
use crate::scene::{Random, Setup, Soup, on_triangle, opaque};
use crate::shapes::{aimed, shapes, square};

const MESHES: [&str; 6] = ["stanford-bunny", "teapot", "cow", "spot", "beetle", "fandisk"];
/// On the casters, on the ground, near the casters (10^-6 to 10^-1 away), on edges and corners of the casters, all around.
const KINDS: usize = 5;
/// A receiver with more differing samples is off as a whole.
const GROSS: u32 = 8;

/// Roundings of an edge's determinant: a way, the rows (a position in the frame, two products, their difference), a product and two sums
/// for each image; a product and a difference for the line; a sample, a product and two sums for its side.
const ROUNDINGS: f64 = 28.0;

/// What came of the samples of some receivers.
#[derive(Debug, Default, Clone)]
struct Tally {
    receivers: usize,
    penumbra: usize,
    samples: usize,
    hidden: usize,
    /// Exact coverage against rays, where a determinant lies within its bound.
    grazing: usize,
    /// The most roundings that one of these needs to be explained.
    roundings: f64,
    /// Exact coverage against rays, unexplained.
    faults: usize,
    /// Receivers with more than [`GROSS`] grazing samples: within rounding of the plane of a face that hides them.
    gross: usize,
    /// Table coverage against exact coverage: samples compared, within a cell of an edge, and unexplained.
    table_samples: usize,
    table_cells: usize,
    table_faults: usize,
    /// Where the first faults are.
    stories: Vec<String>,
}

impl Tally {
    fn plus(mut self, mut other: Self) -> Self {
        self.stories.append(&mut other.stories);
        self.stories.truncate(20);
        Self {
            receivers: self.receivers + other.receivers,
            penumbra: self.penumbra + other.penumbra,
            samples: self.samples + other.samples,
            hidden: self.hidden + other.hidden,
            grazing: self.grazing + other.grazing,
            roundings: self.roundings.max(other.roundings),
            faults: self.faults + other.faults,
            gross: self.gross + other.gross,
            table_samples: self.table_samples + other.table_samples,
            table_cells: self.table_cells + other.table_cells,
            table_faults: self.table_faults + other.table_faults,
            stories: self.stories,
        }
    }

    fn row(&self, name: &str) -> String {
        format!(
            "| {name} | {} | {} | {} | {} | {} | {} | {} | {:.1e} | {} | {} |\n",
            thousands(self.receivers),
            thousands(self.penumbra),
            thousands(self.samples),
            self.faults,
            self.grazing,
            self.gross,
            if self.grazing == 0 { "–".to_owned() } else { format!("{}", self.roundings) },
            self.table_cells as f64 / self.table_samples.max(1) as f64,
            self.table_faults,
            thousands(self.hidden),
        )
    }
}

fn thousands(n: usize) -> String {
    let digits = n.to_string();
    let groups: Vec<&str> = digits.as_bytes().rchunks(3).rev().map(|g| std::str::from_utf8(g).unwrap()).collect();
    groups.join(",")
}

fn mesh_folder() -> Option<PathBuf> {
    let folder = std::env::var_os("SOFTSHADOW_MESHES")
        .map_or_else(|| PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/meshes")), PathBuf::from);
    folder.is_dir().then_some(folder)
}

/// A model of height 1 on a ground of 6 × 6; the model's triangles come first.
fn on_ground(name: &str) -> Scene {
    let model = scene_file::load(&mesh_folder().unwrap().join(format!("{name}.obj"))).unwrap();
    let vertices = || model.meshes().iter().flat_map(|m| m.vertices.iter());
    let low = vertices().fold([f64::INFINITY; 3], |l, v| std::array::from_fn(|k| l[k].min(v[k])));
    let high = vertices().fold([f64::NEG_INFINITY; 3], |h, v| std::array::from_fn(|k| h[k].max(v[k])));
    let scale = 1.0 / (high[1] - low[1]);
    let place = |v: &[f64; 3]| {
        [(v[0] - 0.5 * (low[0] + high[0])) * scale, (v[1] - low[1]) * scale, (v[2] - 0.5 * (low[2] + high[2])) * scale]
    };
    let mut meshes: Vec<Mesh> = model
        .meshes()
        .iter()
        .map(|m| {
            let vertices = m.vertices.iter().map(place).collect();
            Mesh::new(m.name.clone(), vertices, m.triangles.clone(), Material::default()).unwrap()
        })
        .collect();
    let corners = [[-3.0, 0.0, -3.0], [3.0, 0.0, -3.0], [3.0, 0.0, 3.0], [-3.0, 0.0, 3.0]].to_vec();
    meshes.push(Mesh::new("ground", corners, vec![[0, 2, 1], [0, 3, 2]], Material::default()).unwrap());
    Scene::new(meshes).unwrap()
}

struct Place {
    setup: Setup,
    /// Indices of the triangles of casters and of the ground.
    casters: Vec<usize>,
    ground: Vec<usize>,
    /// World units to local.
    unit: f64,
    top: f64,
}

fn place(scene: &Scene, shape: LightShape, eye: [f64; 3], target: [f64; 3], top: f64) -> Place {
    let local = LocalScene::new(scene, None, u64::MAX / 2);
    let triangles: Soup = local.triangles().collect();
    let is_ground = |i: &usize| scene.meshes()[local.mesh_ids[*i] as usize].name == "ground";
    let (ground, casters) = (0..triangles.len()).partition(is_ground);
    let light = aimed(shape, eye, target);
    let setup = Setup::in_frame(triangles, local.frame, light, 64, opaque);
    Place { setup, casters, ground, unit: local.frame.local_length(1.0), top }
}

impl Place {
    fn local(&self, world: [f64; 3]) -> DVec3 {
        self.setup.local.local_from_world(world)
    }

    fn receiver(&self, kind: usize, random: &mut Random) -> Option<Receiver> {
        let setup = &self.setup;
        // The local frame fills [-1, 1]³.
        let extent = 1.0;
        let towards = setup.light.local(&setup.local);
        let light = if matches!(setup.light.shape(), LightShape::Sun { .. }) {
            -towards.emission * 1e3
        } else {
            towards.center
        };
        let on = |list: &[usize], random: &mut Random| {
            let index = list[random.below(list.len())];
            on_triangle(random, &setup.triangles[index], index, light, extent)
        };
        match kind {
            0 => on(&self.casters, random),
            1 => {
                // The ground, but mostly where the shadow is.
                let reach = random.within(0.0, 2.0);
                let around = random.direction() * reach;
                let p = self.local([around.x, 0.0, around.z]);
                let index = self.ground[random.below(self.ground.len())];
                let mut receiver = on_triangle(random, &setup.triangles[index], index, light, extent)?;
                // Stay on this triangle when the place lies on it, else take its own random place.
                let q = DVec3::from(receiver.position.map(f64::from));
                if inside(&setup.exact[index], p) {
                    receiver.position = [p.x as f32, q.y as f32, p.z as f32];
                }
                Some(receiver)
            }
            2 => {
                let surface = on(&self.casters, random)?;
                let distance = self.unit * 10f64.powf(random.within(-6.0, -1.0));
                let p = DVec3::from(surface.position.map(f64::from)) + random.direction() * distance;
                Some(Receiver { position: p.as_vec3().to_array(), normal: None, triangle: None })
            }
            3 => {
                let index = self.casters[random.below(self.casters.len())];
                let mut receiver = on_triangle(random, &setup.triangles[index], index, light, extent)?;
                let [a, b] = [0, 1].map(|k| glam::Vec3::from(setup.triangles[index][(k + index) % 3]));
                let along = if random.below(2) == 0 { 0.0 } else { random.within(0.0, 1.0) as f32 };
                let place = a + (b - a) * along;
                let lift = 14.0 * 5.960_464_5e-8 * (place.abs().max_element() + extent);
                receiver.position = (place + glam::Vec3::from(receiver.normal?) * lift).to_array();
                Some(receiver)
            }
            _ => {
                let world = [random.within(-1.0, 1.0), random.within(0.0, self.top), random.within(-1.0, 1.0)];
                Some(Receiver { position: self.local(world).as_vec3().to_array(), normal: None, triangle: None })
            }
        }
    }

    fn judge(&self, kind: usize, count: usize, seed: u64, tables: &CoverageTables) -> Tally {
        (0..count)
            .into_par_iter()
            .map(|i| {
                let mut random = Random(seed.wrapping_mul(0xD134_2543_DE82_EF95) ^ (i as u64) << 20);
                let receiver = loop {
                    if let Some(receiver) = self.receiver(kind, &mut random) {
                        break receiver;
                    }
                };
                let edges = self.setup.see(&receiver).hidden[0];
                let rays = self.setup.hidden_by_rays(&receiver);
                let mut tally = Tally {
                    receivers: 1,
                    penumbra: usize::from(rays != 0 && rays != !0),
                    samples: 64,
                    hidden: rays.count_ones() as usize,
                    ..Tally::default()
                };
                self.explain(&receiver, edges ^ rays, &mut tally);
                tally.gross = usize::from((edges ^ rays).count_ones() > GROSS);
                if i % 8 == 0 {
                    let quick: Seen<1> = self.setup.technique(Coverage::Tables(tables), false).see(&receiver);
                    tally.table_samples += 64;
                    self.explain_tables(&receiver, quick.hidden[0] ^ edges, tables, &mut tally);
                }
                tally
            })
            .reduce(Tally::default, Tally::plus)
    }

    /// Every sample in which edges and rays differ is grazing, or a fault.
    fn explain(&self, receiver: &Receiver, different: u64, tally: &mut Tally) {
        if different == 0 {
            return;
        }
        let setup = &self.setup;
        let from = Setup::true_receiver(receiver);
        if setup.foregone(receiver).is_some() {
            // Behind the light or inside it there are no rays: only the kernel's one dot product can have rounded to the other side.
            tally.faults += different.count_ones() as usize;
            return;
        }
        let view = setup.exact_view(receiver);
        for (bit, target) in
            setup.targets(receiver).into_iter().enumerate().filter(|(bit, _)| different >> bit & 1 == 1)
        {
            let sample = setup.exact_sample(&view, receiver, target);
            match needed_roundings(&setup.exact, &from, &view, &sample, 1024.0) {
                Some(roundings) if roundings <= ROUNDINGS => {
                    tally.grazing += 1;
                    tally.roundings = tally.roundings.max(roundings);
                }
                other => {
                    tally.stories.push(format!("{receiver:?}, sample {bit}, needs {other:?} roundings"));
                    tally.faults += 1;
                }
            }
        }
    }

    /// Every sample in which tables differ from exact coverage lies within a table's cell of the line of a silhouette edge, in its
    /// sector widened by a cell.
    fn explain_tables(&self, receiver: &Receiver, different: u64, tables: &CoverageTables, tally: &mut Tally) {
        if different == 0 {
            return;
        }
        let setup = &self.setup;
        let Sight::View(view) = LightView::towards(&setup.frame, receiver.position) else { return };
        let [reach, turn] = tables.discretisation().map(f64::from);
        let images: Vec<ProjectedEdge> = setup
            .occluders
            .edges
            .iter()
            .filter(|edge| face::weight(&view, &setup.occluders, edge, receiver) != Layers::NONE)
            .map(|edge| ProjectedEdge::new(&view, edge))
            .collect();
        for bit in (0..64).filter(|bit| different >> bit & 1 == 1) {
            let [x, y] = setup.samples[bit].map(f64::from);
            let explains = |image: &ProjectedEdge| {
                let Some(directions) = image.directions() else { return false };
                let line = image.line.as_dvec3();
                let away = (line.x * x + line.y * y + line.z).abs() / line.truncate().length();
                let [from, to] = directions.map(DVec2::normalize);
                let way = DVec2::new(x, y).normalize();
                let near = |d: DVec2| d.angle_to(way).abs() <= turn;
                let between = from.perp_dot(way) * way.perp_dot(to) >= 0.0 && (from + to).dot(way) >= 0.0;
                // At a corner a sample may be given to the neighbour, whose line is followed beyond its end: between the two lines, and
                // within a cell of the direction of the corner, one of them is no farther than two cells away.
                let beside_corner = 2.0 * turn * x.hypot(y);
                away <= (reach + beside_corner) * 1.001 && (between || near(from) || near(to))
            };
            if images.iter().any(explains) {
                tally.table_cells += 1;
            } else {
                tally.stories.push(format!("{receiver:?}, sample {bit}, by tables"));
                tally.table_faults += 1;
            }
        }
    }
}

/// Strictly inside the triangle as seen from above.
fn inside(triangle: &[[f64; 3]; 3], p: DVec3) -> bool {
    let [a, b, c] = triangle.map(|v| DVec3::new(v[0], 0.0, v[2]));
    let p = DVec3::new(p.x, 0.0, p.z);
    let turn = |u: DVec3, v: DVec3| (v - u).cross(p - u).y;
    let turns = [turn(a, b), turn(b, c), turn(c, a)];
    turns.iter().all(|t| *t > 0.0) || turns.iter().all(|t| *t < 0.0)
}

/// All meshes, or the shipped canopy alone where there are none; a table of what came of it.
fn run(receivers: usize) -> (String, Tally) {
    let names: Vec<&str> = MESHES.iter().copied().filter(|_| mesh_folder().is_some()).chain(["canopy"]).collect();
    let mut table = String::from(
        "| casters and ground, light | receivers | in penumbra | samples | faults | grazing | gross | roundings needed | by tables | table faults | hidden |\n\
         |---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    let mut total = Tally::default();
    for name in &names {
        let (scene, eye, target, size, top) = if *name == "canopy" {
            (procedural::shipped(name).unwrap().build().unwrap(), [0.3, 5.0, 0.2], [0.0; 3], 2.0, 2.4)
        } else {
            (on_ground(name), [1.5, 3.5, 1.0], [0.0, 0.3, 0.0], 1.0, 1.2)
        };
        for (shape_name, shape) in shapes(size, DVec3::from(eye).distance(DVec3::from(target))) {
            let place = place(&scene, shape, eye, target, top);
            let tables = CoverageTables::new(&place.setup.samples, 2048, 512, 512);
            let share = if shape_name == "rectangle" { 0.6 } else { 0.1 };
            let count = (receivers as f64 / (MESHES.len() + 1) as f64 * share / KINDS as f64).ceil() as usize;
            let line = (0..KINDS)
                .fold(Tally::default(), |sum, kind| sum.plus(place.judge(kind, count, kind as u64 + 1, &tables)));
            table += &line.row(&format!("{name}, {shape_name}"));
            total = total.plus(line);
        }
    }
    table += &total.row("**all**");
    (table, total)
}

fn expect_no_faults(table: &str, total: &Tally) {
    assert!(total.penumbra * 50 > total.receivers, "the receivers are hard enough:\n{table}");
    assert_eq!((total.faults, total.table_faults), (0, 0), "{:#?}\n{table}", total.stories);
    assert!((total.grazing as f64) <= 1e-5 * total.samples as f64, "\n{table}");
    // Nearly all of them stand in a crease at a right angle, in the plane of the wall to within rounding: either answer is one of its limits.
    assert!((total.gross as f64) <= 1e-5 * total.receivers as f64 + 1.0, "\n{table}");
}

#[test]
fn some_receivers_have_no_faults() {
    let (table, total) = run(60_000);
    expect_no_faults(&table, &total);
}

#[test]
#[ignore = "minutes; part of `make evidence`"]
fn ten_million_receivers_have_no_faults() {
    assert!(mesh_folder().is_some(), "set SOFTSHADOW_MESHES");
    let (table, total) = run(10_000_000);
    if let Some(path) = std::env::var_os("SOFTSHADOW_EDGE_TABLE") {
        std::fs::write(path, &table).unwrap();
    }
    expect_no_faults(&table, &total);
    assert!(total.receivers >= 10_000_000);
}

/// Areas on real meshes against exact unions of polygons, in the penumbra on and around casters.
#[test]
#[ignore = "minutes; part of `make evidence`"]
fn areas_on_real_meshes() {
    assert!(mesh_folder().is_some(), "set SOFTSHADOW_MESHES");
    let mut table = String::from(
        "| casters and ground | in penumbra | by area | fooled (> 1e-5) | > 0.01 | > 0.03 | RMSE by area | RMSE of 64 samples there | worst by area |\n\
         |---|---|---|---|---|---|---|---|---|\n",
    );
    for name in MESHES {
        let (eye, target) = ([1.5, 3.5, 1.0], [0.0, 0.3, 0.0]);
        let place = place(&on_ground(name), square(1.0), eye, target, 1.2);
        let answers = (0..12_000)
            .into_par_iter()
            .map(|i| {
                let mut random = Random(0xD134_2543_DE82_EF95 ^ (i as u64) << 20);
                let receiver = loop {
                    if let Some(receiver) = place.receiver(i % KINDS, &mut random) {
                        break receiver;
                    }
                };
                judge_area(&place.setup, SQUARE, &receiver)
            })
            .reduce(Answers::default, Answers::plus);
        let rms = |squared: f64| (squared / answers.by_area as f64).sqrt();
        table += &format!(
            "| {name} | {} | {:.1} % | {:.1} % | {:.2} % | {:.2} % | {:.5} | {:.5} | {:.4} |\n",
            answers.penumbra,
            100.0 * answers.by_area as f64 / answers.penumbra as f64,
            100.0 * answers.share_fooled(),
            100.0 * answers.share_over(0),
            100.0 * answers.share_over(1),
            rms(answers.squared),
            rms(answers.squared_sampled),
            answers.worst,
        );
        assert!(answers.penumbra > 300, "{table}{answers:?}");
        // Many are fooled a little. Samples in their place would be off by several times as much.
        assert!(answers.share_over(0) < 0.2 && answers.share_over(1) < 0.02, "{table}{answers:?}");
        assert!(answers.gain() < 0.5, "{table}{answers:?}");
    }
    if let Some(path) = std::env::var_os("SOFTSHADOW_AREA_TABLE") {
        std::fs::write(path, &table).unwrap();
    }
}
