//! Feeds a target changed inputs and notices panics, hangs and memory out of proportion.
//!
//! Nothing watches which lines run. Instead an input whose outcome was never seen joins those that are changed next: readers give
//! every check its own words, so new words are a new path.

use std::collections::BTreeSet;
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, MutexGuard, Once, PoisonError};
use std::time::{Duration, Instant};

use crate::memory::most_held;
use crate::mutate::{Random, mutated};

/// Enough for every message of a reader; names that a message does not quote could go on for ever.
const MOST_INPUTS: usize = 1000;

/// What is tried.
#[derive(Clone, Copy)]
pub(crate) struct Target {
    /// Also the name of the folder with its inputs.
    pub(crate) name: &'static str,
    /// What its inputs are made of.
    pub(crate) words: &'static [&'static str],
    /// The longest input, in bytes.
    pub(crate) longest: usize,
    /// The most memory that one input may take, in bytes.
    pub(crate) memory: u64,
    /// How long one input may take on a busy machine.
    pub(crate) patience: Duration,
    /// Says in words what an input led to.
    pub(crate) run: fn(&[u8]) -> String,
}

/// Why an input is red.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Finding {
    Panic(String),
    Memory(u64),
    Hang,
}

/// What was tried, and what came of it.
#[derive(Default)]
pub(crate) struct Figures {
    pub(crate) executions: u64,
    pub(crate) seconds: f64,
    /// How many outcomes differed in their words, as far as they were kept.
    pub(crate) outcomes: usize,
    /// The first input of each kind of finding.
    pub(crate) findings: Vec<(Finding, Vec<u8>)>,
    /// Changed inputs with an outcome of their own.
    pub(crate) news: Vec<Vec<u8>>,
}

impl fmt::Display for Figures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { executions, seconds, outcomes, findings, .. } = self;
        write!(f, "{executions} executions in {seconds:.0} s, {outcomes} outcomes, {} findings", findings.len())
    }
}

/// What the thread that tries inputs shows to the one that waits.
struct Shown {
    input: Vec<u8>,
    begun: Instant,
    figures: Figures,
    is_done: bool,
}

/// Tries all `inputs` as they are, then changed ones until `time` is over; the same seed tries the same ones. A hang ends the run.
pub(crate) fn fuzz(target: &Target, inputs: Vec<Vec<u8>>, seed: u64, time: Duration) -> Figures {
    keep_quiet();
    let started = Instant::now();
    let shown = Shown { input: Vec::new(), begun: started, figures: Figures::default(), is_done: false };
    let shown = Arc::new(Mutex::new(shown));
    let (worker, of) = (Arc::clone(&shown), *target);
    // A thread that hangs cannot be ended: it is left behind.
    let explorer = std::thread::Builder::new().name(QUIET.into()).spawn(move || {
        explore(&of, inputs, seed, started + time, &worker);
        lock(&worker).is_done = true;
    });
    drop(explorer.expect("a thread"));
    loop {
        std::thread::sleep(Duration::from_millis(5));
        let mut now = lock(&shown);
        let hangs = !now.is_done && now.begun.elapsed() > target.patience;
        if hangs || now.is_done {
            let mut figures = std::mem::take(&mut now.figures);
            if hangs {
                figures.findings.push((Finding::Hang, now.input.clone()));
            }
            figures.seconds = started.elapsed().as_secs_f64();
            return figures;
        }
    }
}

/// The threads whose panics are findings, and reported as such.
const QUIET: &str = "explorer";

fn keep_quiet() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let loud = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if std::thread::current().name() != Some(QUIET) {
                loud(info);
            }
        }));
    });
}

fn explore(target: &Target, inputs: Vec<Vec<u8>>, seed: u64, end: Instant, shown: &Mutex<Shown>) {
    let mut random = Random::new(seed);
    let (given, mut pool, mut seen) = (inputs.len(), inputs, BTreeSet::new());
    for turn in 0_usize.. {
        let input = match pool.get(turn) {
            Some(input) if turn < given => input.clone(),
            _ if Instant::now() > end => return,
            _ => {
                // New ones may be many and alike, where a message quotes what a file calls things.
                let among = if random.below(2) == 0 { given } else { pool.len() };
                let chosen = random.below(among);
                mutated(&mut random, &pool[chosen], &pool, target.words, target.longest)
            }
        };
        {
            let mut shown = lock(shown);
            shown.input.clone_from(&input);
            shown.begun = Instant::now();
        }
        let outcome = outcome(target, &input);
        let is_new = seen.insert(match &outcome {
            Ok(words) => kind(words),
            Err(Finding::Panic(words)) => format!("panic: {}", kind(words)),
            Err(other) => format!("{:?}", std::mem::discriminant(other)),
        });
        let mut shown = lock(shown);
        shown.begun = Instant::now();
        shown.figures.executions += 1;
        shown.figures.outcomes = seen.len().min(MOST_INPUTS);
        match outcome {
            Err(finding) if is_new => shown.figures.findings.push((finding, input)),
            Ok(_) if is_new && turn >= given && pool.len() < MOST_INPUTS => {
                shown.figures.news.push(input.clone());
                pool.push(input);
            }
            _ => {}
        }
    }
}

fn outcome(target: &Target, input: &[u8]) -> Result<String, Finding> {
    let (result, memory) = most_held(|| catch_unwind(AssertUnwindSafe(|| (target.run)(input))));
    let words = result.map_err(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        Finding::Panic(text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no message").to_owned())
    })?;
    if memory > target.memory { Err(Finding::Memory(memory)) } else { Ok(words) }
}

/// The end of an outcome, behind the place that it names, without numbers and without what it quotes.
fn kind(words: &str) -> String {
    let is_quote = |c: char| "'`\"".contains(c);
    let (start, end) = (words.find(is_quote).unwrap_or(words.len()), words.rfind(is_quote).unwrap_or(words.len()));
    let own = words[..start].trim_end_matches([' ', ':']).rsplit(": ").next().unwrap_or_default();
    [own, &words[end..]].concat().chars().filter(char::is_ascii_alphabetic).collect()
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A target that goes wrong where its input says so, to see that this is noticed.
fn spoilt(input: &[u8]) -> String {
    let text = String::from_utf8_lossy(input);
    assert!(!text.contains("bad index"), "index out of bounds");
    if text.contains("bad size") {
        drop(Vec::<u8>::with_capacity(1 << 24));
    }
    if text.contains("bad loop") {
        std::thread::sleep(Duration::from_secs(6));
    }
    // Words lead to words: no single change makes the last from the first.
    let depth = ["bad", "bad i", "bad s", "bad l"].iter().filter(|words| text.contains(**words)).count();
    format!("{} steps", ["no", "one", "two", "three", "four"][depth])
}

#[test]
fn panics_hangs_and_memory_are_noticed_and_name_their_input() {
    let run = |input: &str, words: &'static [&'static str], seconds| {
        let target = Target {
            name: "spoilt",
            words,
            longest: 256,
            memory: 1 << 20,
            patience: Duration::from_secs(2),
            run: spoilt,
        };
        fuzz(&target, vec![input.as_bytes().to_vec()], 1, Duration::from_secs(seconds)).findings
    };
    assert_eq!(run("good", &["fine"], 1), []);
    assert_eq!(
        run("bad index", &["fine"], 0)[0],
        (Finding::Panic("index out of bounds".into()), b"bad index".to_vec())
    );
    assert!(matches!(run("bad size", &["fine"], 0)[0], (Finding::Memory(bytes), _) if bytes >= 1 << 24));
    assert_eq!(run("bad loop", &["fine"], 0), [(Finding::Hang, b"bad loop".to_vec())]);
    // From an input without anything bad.
    for (words, finding) in [(&["bad ", "index"], "Panic"), (&["bad ", "size"], "Memory"), (&["bad ", "loop"], "Hang")]
    {
        let found = run("good", words, 2);
        assert!(found.iter().any(|(kind, _)| format!("{kind:?}").starts_with(finding)), "{words:?}: {found:?}");
    }
}
