//! What the plans of the whole grid need of a host, next to the smallest that WebGPU allows; and every parameter has its value.

use std::collections::BTreeSet;

use softshadow_plan::{Host, Limits, Origin, PlanError, check};

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
};

/// The most storage buffers that any pass binds: rays bind one more than core WebGPU promises.
const MOST_STORAGE_BUFFERS: u32 = 9;

/// Names of the techniques whose plans a host with so many storage buffers refuses, somewhere in the grid.
fn refused(storage_buffers: u32) -> BTreeSet<&'static str> {
    let mut host = Host::default();
    assert_eq!(host.limits, CORE);
    host.limits.storage_buffers = storage_buffers;
    let (fixture, mut names) = (Fixture::new(), BTreeSet::new());
    for technique in techniques() {
        technique.check().unwrap();
        let requests = fixture.requests();
        assert!(requests.len() >= 200, "the grid is a grid");
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
fn plans_run_on_core_webgpu_but_for_the_storage_buffers_of_rays() {
    assert_eq!(refused(MOST_STORAGE_BUFFERS), BTreeSet::new());
    assert_eq!(refused(MOST_STORAGE_BUFFERS - 1), BTreeSet::from(["ray_traced"]));
    assert_eq!(refused(2), BTreeSet::from(["hard_shadow_map", "ray_traced"]));
}

#[test]
fn every_parameter_has_a_value_of_its_size() {
    let fixture = Fixture::new();
    for technique in techniques() {
        for request in fixture.requests() {
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
    host.limits.storage_buffers = MOST_STORAGE_BUFFERS;
    host.features.raster = false;
    for technique in techniques() {
        let draws_map = technique.name() == "hard_shadow_map";
        for (receivers, draws) in [(fixture.camera(), true), (fixture.points(), draws_map)] {
            let result = check(&technique.plan(&fixture.request(1, receivers)), &host);
            let refused = matches!(result, Err(PlanError::MissingFeature { feature: "raster", .. }));
            assert_eq!(refused, draws, "{}: {result:?}", technique.name());
        }
    }
}
