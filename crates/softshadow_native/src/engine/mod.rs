//! The interpreter: a program's passes, one after the other, each on all threads.

mod atomic_words;
mod call;
mod store;
mod threads;

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use fearless_simd::Level;
use rayon::ThreadPool;
use softshadow_plan::{
    AdapterInfo, Content, ContentKey, DeviceKind, Engine, EngineError, Features, Host, Limits, OnStage, Over, Pass,
    PassTime, Program, ResourceId, RunReport, Stage, StageReport, Step, Timing, Work, check,
};

pub(crate) use atomic_words::{atomic_words, shared};
pub(crate) use call::Call;
use store::Store;

use crate::kernels::twin;

/// Steps of one slice of a pass: some tens of milliseconds, so that a caller can stop in between.
const WORK_PER_SLICE: u64 = 1 << 24;

/// How the engine uses the machine. Results depend on neither setting.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct NativeSettings {
    /// Threads; `None` takes as many as `RAYON_NUM_THREADS` says, else one a core.
    pub threads: Option<usize>,
    /// Which vector instructions.
    pub vectors: Vectors,
}

/// Which vector instructions the kernels use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Vectors {
    /// The widest that the processor has.
    #[default]
    Widest,
    /// Those that every processor of its kind has.
    Baseline,
}

/// Threads, and what is kept between runs. Runs take turns.
pub struct NativeEngine {
    info: AdapterInfo,
    settings: NativeSettings,
    level: Level,
    destroyed: AtomicBool,
    store: Mutex<Store>,
}

impl NativeEngine {
    /// An engine; it starts no thread before its first run.
    #[must_use]
    pub fn new(settings: NativeSettings) -> Self {
        let level = match settings.vectors {
            Vectors::Widest => Level::new(),
            Vectors::Baseline => Level::baseline(),
        };
        let count = threads::count(settings.threads);
        let words = format!("{level:?}");
        let info = AdapterInfo {
            index: 0,
            name: format!("{count} CPU thread{}", if count == 1 { "" } else { "s" }),
            backend: "native".into(),
            device_type: DeviceKind::Native,
            driver: words.split('(').next().unwrap_or_default().to_owned(),
            storage_binding_bytes: LIMITS.storage_binding_bytes,
            texture_size: LIMITS.texture_size,
            features: Vec::new(),
        };
        Self { info, settings, level, destroyed: AtomicBool::new(false), store: Mutex::default() }
    }
}

/// What indices of 32 bits reach.
const LIMITS: Limits = Limits {
    storage_binding_bytes: (1 << 32) - 64,
    buffer_bytes: (1 << 32) - 64,
    texture_size: 1 << 15,
    texture_layers: 0,
    groups: u32::MAX,
    storage_buffers: 64,
    color_targets: 0,
    color_bytes: 0,
};

impl Engine for NativeEngine {
    fn adapter(&self) -> &AdapterInfo {
        &self.info
    }

    fn host(&self) -> Host {
        Host { limits: LIMITS, features: Features { raster: false, float32_blendable: false } }
    }

    fn is_lost(&self) -> bool {
        self.destroyed.load(Ordering::Relaxed)
    }

    fn destroy(&self) {
        self.destroyed.store(true, Ordering::Relaxed);
    }

    fn forget(&self, contents: &[ContentKey]) {
        self.store.lock().unwrap_or_else(PoisonError::into_inner).forget(contents);
    }

    fn run(
        &self,
        program: &dyn Program,
        contents: &BTreeMap<ContentKey, Content>,
        timing: Timing,
        on_stage: OnStage<'_>,
    ) -> Result<RunReport, EngineError> {
        // Passes always run one after the other, so both ways of timing are the wall clock's.
        let (Timing::Device | Timing::EachPass) = timing;
        let mut store = self.store.lock().unwrap_or_else(PoisonError::into_inner);
        store.begin_run();
        let threads = threads::pool(self.settings.threads)?;
        let started = Instant::now();
        let mut report = RunReport::default();
        let mut decision: Vec<u32> = Vec::new();
        let mut index = 0;
        while let Step::Run(stage) = program.step(index, &decision) {
            let result = self.run_stage(&mut store, &threads, &stage, contents, &mut report, on_stage);
            if result.is_err() {
                // Whatever a failed stage left behind is not trusted again.
                *store = Store::default();
            }
            let buffers = result?;
            report.wall_ms = started.elapsed().as_secs_f64() * 1e3;
            report.stages += 1;
            let lend = |id: &ResourceId| {
                let resource = &stage.plan.resources[id.index()];
                let bytes: &[u8] = bytemuck::cast_slice(&buffers[id.index()]);
                (resource.label.clone(), Cow::Borrowed(&bytes[..resource.bytes() as usize]))
            };
            let goes_on = on_stage(Some(StageReport { index, outputs: stage.plan.outputs.iter().map(lend).collect() }));
            decision = stage.plan.decision.map_or_else(Vec::new, |id| buffers[id.index()].clone());
            store.put_back(&stage.plan, buffers);
            if !goes_on {
                return Err(EngineError::Interrupted);
            }
            index += 1;
        }
        Ok(report)
    }
}

impl NativeEngine {
    /// Runs the passes of a stage and returns the buffers of its resources.
    fn run_stage(
        &self,
        store: &mut Store,
        threads: &Arc<ThreadPool>,
        stage: &Stage,
        contents: &BTreeMap<ContentKey, Content>,
        report: &mut RunReport,
        on_stage: OnStage<'_>,
    ) -> Result<Vec<Vec<u32>>, EngineError> {
        let plan = &stage.plan;
        if self.is_lost() {
            let reason = "destroyed by the caller".to_owned();
            return Err(EngineError::DeviceLost { stage: plan.name.clone(), reason });
        }
        check(plan, &self.host())?;
        plan.passes.iter().try_for_each(has_kernel)?;
        let bytes = plan.resources.iter().map(softshadow_plan::Resource::bytes).sum::<u64>();
        if bytes > report.bytes.iter().map(|(_, b)| b).sum() {
            report.bytes = plan.memory().into_iter().map(|(label, bytes)| (label.to_owned(), bytes)).collect();
        }
        let mut buffers = store.take(stage, contents)?;
        report.submissions += 1;
        for pass in &plan.passes {
            let started = Instant::now();
            let goes_on = self.run_pass(&mut buffers, threads, pass, &plan.name, on_stage)?;
            let ms = started.elapsed().as_secs_f64() * 1e3;
            report.add_times(vec![PassTime { label: pass.label.clone(), ms }]);
            if !goes_on {
                return Err(EngineError::Interrupted);
            }
        }
        Ok(buffers)
    }

    /// Runs one pass; false where the caller asked to stop.
    fn run_pass(
        &self,
        buffers: &mut [Vec<u32>],
        threads: &ThreadPool,
        pass: &Pass,
        stage: &str,
        on_stage: OnStage<'_>,
    ) -> Result<bool, EngineError> {
        match &pass.work {
            Work::Clear { target } => buffers[target.index()].fill(0),
            Work::Copy { source, target, bytes } => {
                let words = bytes.div_ceil(4) as usize;
                let source = std::mem::take(&mut buffers[source.index()]);
                buffers[target.index()][..words].copy_from_slice(&source[..words]);
                let Work::Copy { source: from, .. } = &pass.work else { return Ok(true) };
                buffers[from.index()] = source;
            }
            Work::Compute { kernel, over } => {
                let Some(twin) = twin(*kernel) else { return has_kernel(pass).map(|()| true) };
                let (count, each) = match over {
                    Over::Items { count, work_per_item } => (*count, u64::from((*work_per_item).max(1))),
                    // Its size is known only now, and blocks bound it.
                    Over::Indirect(id) => (buffers[id.index()][..3].iter().product(), 0),
                };
                let most =
                    WORK_PER_SLICE.checked_div(each).map_or(u64::MAX, |most| most.max(1024).next_multiple_of(1024));
                let most = u32::try_from(most).unwrap_or(u32::MAX);
                let mut first = 0;
                while first < count {
                    let end = first.saturating_add(most).min(count);
                    let mut call = Call::new(pass, buffers, first..end, self.level);
                    let done = catch_unwind(AssertUnwindSafe(|| threads.install(|| twin(&mut call))));
                    call.put_back(buffers);
                    done.map_err(|_| EngineError::Refused {
                        stage: stage.to_owned(),
                        reason: format!("the kernel {kernel} panicked"),
                    })?;
                    first = end;
                    if first < count && !on_stage(None) {
                        return Ok(false);
                    }
                }
            }
            Work::Raster(_) => return has_kernel(pass).map(|()| true),
        }
        Ok(true)
    }
}

/// An error where a pass has no twin.
fn has_kernel(pass: &Pass) -> Result<(), EngineError> {
    let missing = match &pass.work {
        Work::Compute { kernel, .. } if twin(*kernel).is_none() => kernel.to_string(),
        Work::Raster(raster) => raster.kernel.to_string(),
        _ => return Ok(()),
    };
    Err(EngineError::NoKernel {
        engine: "the native engine",
        pass: pass.label.clone(),
        kernel: missing,
        way_out: "use device 'gpu' or 'software'",
    })
}
