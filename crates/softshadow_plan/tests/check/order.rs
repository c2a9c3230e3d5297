//! Nothing is read before something was written to it.

use softshadow_plan::{Count, Host, Origin, PlanError, VertexSource, check};

use crate::small_plan::{error, pass, raster_of, resource, small_plan};

fn unwritten(pass: &str, resource: &str) -> PlanError {
    PlanError::ReadBeforeWrite { pass: pass.into(), resource: resource.into() }
}

#[test]
fn kernels_read_what_was_written() {
    // Without the pass that writes it, and with the two passes in the wrong order.
    let receivers = unwritten("choose", "receivers");
    assert_eq!(error(|plan| plan.passes.retain(|p| p.label != "place")), receivers);
    assert_eq!(error(|plan| plan.passes.swap(1, 3)), receivers);
    let ids = unwritten("place", "triangle ids");
    assert_eq!(error(|plan| plan.passes.retain(|p| p.label != "draw")), ids);
}

#[test]
fn copies_outputs_and_decisions_read_too() {
    let without =
        |label: &'static str| move |plan: &mut softshadow_plan::Plan| plan.passes.retain(|p| p.label != label);
    let both = error(|plan| {
        without("reset")(plan);
        without("choose")(plan);
    });
    assert_eq!(both, unwritten("keep", "decided"));
    assert_eq!(error(without("keep")), unwritten("output", "kept"));
    let decision = error(|plan| {
        without("keep")(plan);
        plan.decision = plan.outputs.pop();
    });
    assert_eq!(decision, unwritten("output", "kept"));
}

#[test]
fn raster_reads_its_vertices_counts_and_the_targets_that_it_keeps() {
    let vertices = error(|plan| resource(plan, "corners").origin = Origin::Transient);
    assert_eq!(vertices, unwritten("draw", "corners"));
    let counts = error(|plan| {
        raster_of(plan).vertices = VertexSource::Generated(Count::Indirect(small_plan().find("decided").unwrap()));
    });
    assert_eq!(counts, unwritten("draw", "decided"));
    assert_eq!(error(|plan| raster_of(plan).colors[0].clear = None), unwritten("draw", "triangle ids"));
    let depth = error(|plan| raster_of(plan).depth.as_mut().unwrap().clear = None);
    assert_eq!(depth, unwritten("draw", "depth"));
}

#[test]
fn what_comes_from_outside_counts_as_written() {
    for origin in [Origin::Persistent, Origin::External] {
        let mut plan = small_plan();
        plan.passes.retain(|p| p.label != "place");
        resource(&mut plan, "receivers").origin = origin;
        assert_eq!(check(&plan, &Host::default()), Ok(()));
    }
}

#[test]
fn indirect_counts_are_read_before_the_kernel_runs() {
    let counts = error(|plan| {
        let receivers = plan.find("receivers").unwrap();
        let work = &mut pass(plan, "place").work;
        let softshadow_plan::Work::Compute { over, .. } = work else { panic!("'place' computes") };
        *over = softshadow_plan::Over::Indirect(receivers);
    });
    assert_eq!(counts, unwritten("place", "receivers"));
}
