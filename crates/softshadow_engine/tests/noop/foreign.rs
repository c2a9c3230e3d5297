//! A device that somebody else owns: results stay in his buffers, his callbacks stay his, and what goes wrong is a value.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use softshadow_engine::WgpuEngine;
use softshadow_plan::{
    Delivery, DeviceProgram, Engine as _, EngineError, PlanError, Program as _, RunReport, Stage, Step, Timing,
};

use crate::programs::{Stages, place, run};

/// One plan that leaves its receivers on the device.
struct Delivering {
    stages: Stages,
    bytes: u64,
}

impl DeviceProgram for Delivering {
    fn step_on_device(&self, index: usize, decision: &[u32]) -> Option<(Stage, Vec<Delivery>)> {
        let Step::Run(mut stage) = self.stages.step(index, decision) else { return None };
        let output = stage.plan.outputs.pop().unwrap();
        let delivery = Delivery { output, result: "receivers", source: 32, target: 64, bytes: self.bytes };
        Some((*stage, vec![delivery]))
    }
}

fn device(limits: wgpu::Limits) -> (wgpu::Device, wgpu::Queue) {
    wgpu::Device::noop(&wgpu::DeviceDescriptor { required_limits: limits, ..Default::default() })
}

fn buffer(device: &wgpu::Device, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor { label: Some("ours"), size, usage, mapped_at_creation: false })
}

fn deliver(engine: &WgpuEngine, results: &BTreeMap<&str, wgpu::Buffer>) -> Result<RunReport, EngineError> {
    let program = Delivering { stages: Stages(vec![place(10, 1)]), bytes: 320 - 32 };
    engine.run_on_device(&program, &BTreeMap::new(), results, Timing::Device, &mut |stage| {
        assert!(stage.is_none_or(|stage| stage.outputs.is_empty()), "what stays on the device is not read back");
        true
    })
}

#[test]
fn results_stay_in_the_callers_buffers_and_wrong_ones_are_named() {
    let (device, queue) = device(wgpu::Limits::default());
    let engine = WgpuEngine::on_device(&device, &queue);
    let copied = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::STORAGE;
    let good = BTreeMap::from([("receivers", buffer(&device, 64 + 288, copied))]);
    let wrong = |problem: &str| EngineError::Contents {
        stage: "place".into(),
        resource: "receivers".into(),
        problem: problem.into(),
    };
    for (results, words) in [
        (BTreeMap::new(), "no buffer for this result was given"),
        (
            BTreeMap::from([("receivers", buffer(&device, 64 + 284, copied))]),
            "its buffer has 348 bytes, at least 352 are needed",
        ),
        (
            BTreeMap::from([("receivers", buffer(&device, 512, wgpu::BufferUsages::STORAGE))]),
            "its buffer has no usage COPY_DST",
        ),
    ] {
        assert_eq!(deliver(&engine, &results).map(|r| r.stages), Err(wrong(words)));
        assert_eq!(deliver(&engine, &good).map(|r| r.stages), Ok(1), "the next call works");
    }
}

#[test]
fn callbacks_of_the_device_stay_its_owners() {
    let (device, queue) = device(wgpu::Limits::default());
    let [errors, losses] = [(); 2].map(|()| Arc::new(AtomicUsize::new(0)));
    let heard = Arc::clone(&errors);
    device.on_uncaptured_error(Arc::new(move |_: wgpu::Error| {
        heard.fetch_add(1, Ordering::Relaxed);
    }));
    let heard = Arc::clone(&losses);
    device.set_device_lost_callback(move |_, _| {
        heard.fetch_add(1, Ordering::Relaxed);
    });
    let engine = WgpuEngine::on_device(&device, &queue);
    // A buffer may not be read and written in one dispatch, which only the driver sees.
    let (mut plan, values) = place(10, 1);
    plan.passes[0].bindings[1].1 = plan.find("receivers").unwrap();
    let refused = run(&engine, &Stages(vec![(plan, values)]), Timing::Device).unwrap_err();
    assert!(matches!(&refused, EngineError::Refused { stage, .. } if stage == "place"), "{refused}");
    assert_eq!(errors.load(Ordering::Relaxed), 0, "our errors are ours");
    drop(buffer(&device, u64::MAX / 2, wgpu::BufferUsages::STORAGE));
    assert_eq!(errors.load(Ordering::Relaxed), 1, "his are still his");
    assert!(run(&engine, &Stages(vec![place(10, 1)]), Timing::Device).is_ok());
    device.destroy();
    let lost = run(&engine, &Stages(vec![place(10, 1)]), Timing::Device).unwrap_err();
    assert!(matches!(&lost, EngineError::DeviceLost { stage, .. } if stage == "place"), "{lost}");
    assert!(engine.is_lost());
    assert_eq!(losses.load(Ordering::Relaxed), 1, "he hears of the loss");
    let again = run(&engine, &Stages(vec![place(10, 1)]), Timing::Device).unwrap_err();
    assert!(matches!(again, EngineError::DeviceLost { .. }));
}

#[test]
fn limits_are_those_of_the_device() {
    let low = wgpu::Limits { max_storage_buffer_binding_size: 256, ..wgpu::Limits::default() };
    let (device, queue) = device(low);
    let engine = WgpuEngine::on_device(&device, &queue);
    assert_eq!(engine.host().limits.storage_binding_bytes, 256);
    let error = run(&engine, &Stages(vec![place(10, 1)]), Timing::Device).unwrap_err();
    let EngineError::Plan(PlanError::Binding { problem, .. }) = &error else { panic!("{error}") };
    assert!(problem.contains("320 bytes, the host binds at most 256"), "{problem}");
    assert!(run(&engine, &Stages(vec![place(8, 1)]), Timing::Device).is_ok(), "the next call works");
}

#[test]
fn two_devices_share_nothing() {
    let both = [(); 2].map(|()| device(wgpu::Limits::default()));
    let engines = both.each_ref().map(|(device, queue)| WgpuEngine::on_device(device, queue));
    for engine in &engines {
        assert!(run(engine, &Stages(vec![place(10, 1)]), Timing::Device).is_ok());
    }
    both[0].0.destroy();
    assert!(run(&engines[0], &Stages(vec![place(10, 1)]), Timing::Device).is_err());
    assert!(run(&engines[1], &Stages(vec![place(10, 1)]), Timing::Device).is_ok());
}
