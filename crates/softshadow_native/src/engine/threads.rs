//! Threads of our own, made when they are first needed, and once a process: the threads of a forked process's parent are not there.

use std::sync::{Arc, Mutex, PoisonError};

use rayon::{ThreadPool, ThreadPoolBuilder};
use softshadow_plan::EngineError;

struct Pool {
    process: u32,
    threads: Option<usize>,
    pool: Arc<ThreadPool>,
}

static POOLS: Mutex<Vec<Pool>> = Mutex::new(Vec::new());

/// How many threads a pool has.
pub(super) fn count(threads: Option<usize>) -> usize {
    let wanted = || std::env::var("RAYON_NUM_THREADS").ok()?.parse().ok().filter(|n| *n > 0);
    let cores = || std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    threads.or_else(wanted).unwrap_or_else(cores).max(1)
}

/// The pool with so many threads.
pub(super) fn pool(threads: Option<usize>) -> Result<Arc<ThreadPool>, EngineError> {
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    if let Some(known) = pools.iter().find(|p| p.process == process && p.threads == threads) {
        return Ok(Arc::clone(&known.pool));
    }
    // A parent's pool cannot be ended: nobody would answer.
    pools.drain(..).filter(|p| p.process != process).for_each(std::mem::forget);
    let made = ThreadPoolBuilder::new().num_threads(count(threads)).thread_name(|k| format!("softshadow {k}")).build();
    let pool = Arc::new(made.map_err(|error| EngineError::NoDevice {
        adapter: "native".into(),
        reason: format!("threads do not start: {error}"),
    })?);
    pools.push(Pool { process, threads, pool: Arc::clone(&pool) });
    Ok(pool)
}
