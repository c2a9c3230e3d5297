//! Plans of the whole grid pass their check on the smallest host that WebGPU allows, and every parameter has its value.

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

#[test]
fn every_plan_of_the_grid_runs_on_core_webgpu() {
    let mut host = Host::default();
    assert_eq!(host.limits, CORE);
    // The same plans on a host with one storage buffer show that the check looks at them.
    let (mut passed, mut refused) = (0, 0);
    let fixture = Fixture::new();
    for technique in techniques() {
        technique.check().unwrap();
        for request in fixture.requests() {
            let plan = technique.plan(&request);
            host.limits = CORE;
            check(&plan, &host).unwrap_or_else(|error| panic!("{}: {error}\n{plan}", technique.name()));
            passed += 1;
            host.limits.storage_buffers = 1;
            refused += usize::from(matches!(check(&plan, &host), Err(PlanError::TooLarge { limit: 1, .. })));
        }
    }
    assert!(passed >= 1500 && refused * 2 > passed, "{refused} of {passed} need more than one storage buffer");
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
