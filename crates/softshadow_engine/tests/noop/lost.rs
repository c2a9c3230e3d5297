//! A device that is gone.

use std::collections::BTreeMap;

use softshadow_plan::{Engine as _, EngineError, Timing};

use crate::programs::{Stages, engine, place, run};

fn is_lost(error: &EngineError) -> bool {
    matches!(error, EngineError::DeviceLost { stage, reason } if stage == "place" && !reason.is_empty())
}

#[test]
fn every_run_on_a_lost_device_says_so_and_a_new_engine_works() {
    let engine = engine();
    let stages = Stages(vec![place(10, 1)]);
    assert!(run(&engine, &stages, Timing::Device).is_ok());
    engine.destroy();
    assert!(engine.is_lost());
    for timing in [Timing::Device, Timing::EachPass] {
        let error = run(&engine, &stages, timing).unwrap_err();
        assert!(is_lost(&error), "{error}");
    }
    assert!(run(&crate::programs::engine(), &stages, Timing::Device).is_ok());
}

#[test]
fn a_device_lost_between_two_submissions_or_stages_is_not_taken_for_anything_else() {
    let stages = Stages(vec![place(1 << 10, 1 << 18), place(10, 1)]);
    // Asked seven times within the first stage, then after it.
    for fatal in [1, 5, 8] {
        let engine = engine();
        let mut asked = 0;
        let result = engine.run(&stages, &BTreeMap::new(), Timing::Device, &mut |_| {
            asked += 1;
            if asked == fatal {
                engine.destroy();
            }
            true
        });
        let error = result.unwrap_err();
        assert!(is_lost(&error), "lost at {fatal}: {error}");
        assert!(asked <= 8, "no result is handed out after the device was lost");
    }
}
