//! Threads in forked children. A fork copies the library's thread pool without its threads: whatever is handed to it in
//! the child waits for ever. So a process that inherited a pool computes on one of its own.

use std::io;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use rayon::{ThreadPool, ThreadPoolBuilder};

/// The process that uses the pool that everybody shares: the first that computed, as seen from it and from its children.
static FIRST: OnceLock<u32> = OnceLock::new();

static OWN: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Runs `work` where its threads are alive. In a forked child that is another thread than the caller's.
pub(crate) fn with_live_threads<T: Send>(work: impl FnOnce() -> T + Send) -> io::Result<T> {
    let process = std::process::id();
    if *FIRST.get_or_init(|| process) == process {
        return Ok(work());
    }
    Ok(own_pool(process)?.install(work))
}

fn own_pool(process: u32) -> io::Result<Arc<ThreadPool>> {
    let mut own = OWN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, pool)) = own.as_ref().filter(|(owner, _)| *owner == process) {
        return Ok(Arc::clone(pool));
    }
    let pool = Arc::new(ThreadPoolBuilder::new().build().map_err(io::Error::other)?);
    // A pool of the parent is not dropped: that would wake threads that are not there.
    std::mem::forget(own.replace((process, Arc::clone(&pool))));
    Ok(pool)
}
