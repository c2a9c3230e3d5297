//! What the plans of the whole grid need of a host, next to the smallest that WebGPU allows; and every parameter has its value.

use std::collections::BTreeSet;

use softshadow_plan::{Host, Limits, Origin, PlanError, Work, check};
use softshadow_shaders::BindingKind;

use crate::requests::{Fixture, stage, techniques};

/// What every WebGPU device has: written out here, so that a default that grows is seen.
const CORE: Limits = Limits {
    storage_binding_bytes: 134_217_728,
    buffer_bytes: 268_435_456,
    texture_size: 8192,
    texture_layers: 256,
    groups: 65_535,
    storage_buffers: 8,
    color_targets: 8,
    color_bytes: 32,
};

/// Names of the techniques whose plans a host with so many storage buffers refuses, somewhere in the grid.
fn refused(storage_buffers: u32) -> BTreeSet<&'static str> {
    let mut host = Host::default();
    assert_eq!(host.limits, CORE);
    host.limits.storage_buffers = storage_buffers;
    let (fixture, mut names) = (Fixture::new(), BTreeSet::new());
    for technique in techniques() {
        technique.check().unwrap();
        let requests = fixture.requests(&technique);
        // Who averages pixels serves no points.
        let served = if technique.interleaves() { 2 } else { 1 };
        assert!(requests.len() * served >= 200, "the grid is a grid");
        for plan in requests.iter().map(|request| technique.plan(request)) {
            match check(&plan, &host) {
                Ok(()) => {}
                Err(PlanError::TooLarge { limit, .. }) if limit == u64::from(storage_buffers) => {
                    names.insert(technique.name());
                }
                Err(error) => panic!("{}: {error}\n{plan}", technique.name()),
            }
        }
    }
    names
}

#[test]
fn plans_run_on_core_webgpu_and_need_all_of_its_storage_buffers() {
    assert_eq!(refused(CORE.storage_buffers), BTreeSet::new());
    assert_eq!(refused(CORE.storage_buffers - 1), BTreeSet::from(["depth_complexity", "ray_traced"]));
    let all =
        ["depth_complexity", "hard_shadow_map", "occlusion_camera", "occlusion_layers", "penumbra_map", "ray_traced"];
    assert_eq!(refused(2), BTreeSet::from(all));
}

/// The most storage buffers that a pass of any plan of the grid binds, by the labels of the passes that bind so many.
fn most_bound() -> (usize, BTreeSet<String>) {
    let (fixture, mut most, mut labels) = (Fixture::new(), 0, BTreeSet::new());
    for technique in techniques() {
        for plan in fixture.requests(&technique).iter().map(|request| technique.plan(request)) {
            for pass in &plan.passes {
                let Work::Compute { kernel, .. } = &pass.work else { continue };
                let entry = &softshadow_shaders::module(kernel.file).unwrap().entry_points[kernel.entry];
                let storage = entry.bindings.iter().filter(|b| matches!(b.kind, BindingKind::Storage { .. })).count();
                if storage > most {
                    (most, labels) = (storage, BTreeSet::new());
                }
                if storage == most {
                    labels.insert(pass.label.clone());
                }
            }
        }
    }
    (most, labels)
}

#[test]
fn the_fullest_pass_fills_core_webgpu() {
    // The bits of every sample, its light and its material: nothing more fits a kernel that makes a picture. Depths are counted over
    // faces, their edges and their tree; folds have edges, their faces and lists, and write bits and areas. Rays that go through triangles
    // know what passes each and write what passes to each sample; folds of semi-opaque edges do the same.
    let fullest = ["shade", "count reference depth", "list faces", "probe 0", "probe 1", "trace 0", "trace 1"];
    let folds = (0..4).map(|group| format!("fold edges {group}"));
    let fullest: BTreeSet<String> = fullest.into_iter().map(str::to_owned).chain(folds).collect();
    assert_eq!(most_bound(), (8, fullest));
}

#[test]
fn every_parameter_has_a_value_of_its_size() {
    let fixture = Fixture::new();
    for technique in techniques() {
        for request in fixture.requests(&technique) {
            let (plan, values) = stage(&technique, &request);
            for parameter in plan.resources.iter().filter(|r| r.origin == Origin::Parameter) {
                let given = values.get(&parameter.label).map(|v| v.len() as u64);
                assert_eq!(given, Some(parameter.bytes()), "{} '{}'", technique.name(), parameter.label);
            }
        }
    }
}

#[test]
fn cameras_need_raster_and_points_only_where_a_map_is_drawn() {
    let fixture = Fixture::new();
    let mut host = Host::default();
    host.features.raster = false;
    for technique in techniques() {
        let draws_map = technique.draws();
        for (receivers, draws) in [(fixture.camera(), true), (fixture.points(), draws_map)] {
            let result = check(&technique.plan(&fixture.request(1, receivers)), &host);
            let refused = matches!(result, Err(PlanError::MissingFeature { feature: "raster", .. }));
            assert_eq!(refused, draws, "{}: {result:?}", technique.name());
        }
    }
}
