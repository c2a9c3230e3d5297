//! Plans as data for other languages: numbers in the place of names, complete, and only of plans that pass.

use softshadow_plan::{Exported, Host, PlanError, SLICE, Work, shader_text};

use crate::small_plan::{pass, raster_of, small_plan};

#[test]
fn every_binding_has_its_number_and_every_item_a_dispatch() {
    let plan = small_plan();
    let exported = Exported::new(&plan, &Host::default()).unwrap();
    assert_eq!(exported.bindings.len(), plan.passes.len());
    for (pass, bindings) in plan.passes.iter().zip(&exported.bindings) {
        let sliced = usize::from(matches!(pass.work, Work::Compute { .. }));
        assert_eq!(bindings.len(), pass.bindings.len() + sliced, "{}", pass.label);
        for binding in bindings {
            let bound = pass.bindings.iter().find(|(name, _)| *name == binding.name).map(|(_, id)| *id);
            assert_eq!(binding.resource, bound);
            assert_eq!(binding.resource.is_none(), binding.name == SLICE);
        }
        let mut numbers: Vec<u32> = bindings.iter().map(|b| b.binding).collect();
        numbers.sort_unstable();
        numbers.dedup();
        assert_eq!(numbers.len(), bindings.len(), "each number once");
    }
    let dispatches: Vec<_> = exported.submissions.concat();
    let over_items = |at: usize| matches!(plan.passes[at].work, Work::Compute { .. });
    for (slice, dispatch) in dispatches.iter().enumerate() {
        assert_eq!((dispatch.slice, dispatch.pass), (slice, slice), "nothing here is so long that it is split");
        let (count, groups) = if over_items(dispatch.pass) { (32, 1) } else { (0, 0) };
        assert_eq!((dispatch.first, dispatch.count, dispatch.groups), (0, count, groups));
    }
    let Work::Compute { kernel, .. } = &plan.passes[1].work else { panic!("'place' computes") };
    assert!(shader_text(kernel.file).unwrap().contains("fn place("), "with its text it is complete");
    assert!(shader_text("nowhere.wgsl").is_err());
}

#[test]
fn a_plan_that_does_not_pass_is_not_exported() {
    let mut plan = small_plan();
    pass(&mut plan, "choose").bindings.pop();
    let error = Exported::new(&plan, &Host::default()).unwrap_err();
    assert!(matches!(&error, PlanError::Binding { pass, binding, .. } if pass == "choose" && binding == "decided"));
}

#[test]
fn targets_are_cleared_to_numbers() {
    for value in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
        let mut plan = small_plan();
        raster_of(&mut plan).colors[0].clear = Some(value);
        let error = Exported::new(&plan, &Host::default()).unwrap_err();
        let PlanError::Binding { binding, problem, .. } = &error else { panic!("{error}") };
        assert_eq!(binding, "triangle ids");
        assert!(problem.contains("not finite"), "{problem}");
    }
    let mut plan = small_plan();
    raster_of(&mut plan).depth.as_mut().unwrap().clear = Some(f32::NAN);
    assert!(Exported::new(&plan, &Host::default()).is_err());
}
