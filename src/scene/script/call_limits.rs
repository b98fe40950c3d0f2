//! A call within its limits: its own thread, what it has used of them, who may halt it, and what it
//! printed.

use std::{
    cell::{Cell, RefCell},
    panic::resume_unwind,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use rhai::{EvalAltResult, Position};

use super::limits::{DEADLINE, LINES, MEMORY, OPERATIONS, PRINTED, STACK, grouped};

/// Operations between two checks of the clock; a closure that is bound to itself doubles in about
/// as many.
const CLOCK_EVERY: u64 = 4;
/// Time between two checks of the memory, in which a call cannot fill much of it.
const MEMORY_EVERY: Duration = Duration::from_millis(5);
/// Time to find the place of a limit: the second run notes each step, and is slower.
const FINDING: Duration = Duration::from_secs(2);
/// The same where the first run has met its time: wherever the second is then is as good.
const FINDING_ANY: Duration = Duration::from_secs(1);

/// Ends calls of scripts from another thread; clones share it.
#[derive(Clone, Debug, Default)]
pub struct Halt(Arc<AtomicBool>);

impl Halt {
    /// Ends what runs under it within a few operations, and what would begin.
    pub fn halt(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Does work, on this thread, whose calls of scripts it can end; they fail then.
    pub fn over<T>(&self, work: impl FnOnce() -> T) -> T {
        let before = HALT.replace(Some(self.clone()));
        let result = work();
        HALT.set(before);
        result
    }

    /// Whether it was used.
    pub fn is_halted(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

thread_local! {
    /// What can end the calls that this thread begins.
    static HALT: RefCell<Option<Halt>> = const { RefCell::new(None) };
}

/// How much a call may use.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    time: Duration,
    operations: u64,
}

impl Bounds {
    /// Of any call.
    pub const CALL: Self = Self {
        time: DEADLINE,
        operations: OPERATIONS,
    };

    /// Whether a call may do anything at all.
    pub fn is_nothing(self) -> bool {
        self.operations == 0
    }
}

/// A call that is over.
pub struct Run<T> {
    /// What it gave.
    pub result: T,
    /// What it printed.
    pub log: Vec<String>,
    /// What a second run may use to come to the same place.
    pub again: Bounds,
    /// The limit that it met.
    met: Option<String>,
}

impl<T> Run<Result<T, Box<EvalAltResult>>> {
    /// With an error where a limit was met though the call came to its end, because a function of
    /// Rhai's passed over the error. No place is looked for: a second run would do so as well.
    pub fn or_limit(mut self) -> Self {
        if let (Ok(_), Some(why)) = (&self.result, &self.met) {
            let ended = EvalAltResult::ErrorTerminated(why.clone().into(), Position::NONE);
            self.result = Err(ended.into());
            self.again.operations = 0;
        }
        self
    }
}

/// What the call on this thread has used.
struct Used {
    bounds: Cell<Bounds>,
    operations: Cell<u64>,
    end: Cell<Option<Instant>>,
    next_memory: Cell<Option<Instant>>,
    memory_at_start: Cell<Option<u64>>,
    /// Set once a limit was met, so that nothing goes on that passes over the error.
    why: RefCell<Option<String>>,
    by_time: Cell<bool>,
    halt: RefCell<Option<Halt>>,
    log: RefCell<Vec<String>>,
    /// Bytes in it; more than it may have once it is full.
    printed: Cell<usize>,
}

thread_local! {
    static USED: Used = const {
        Used {
            bounds: Cell::new(Bounds::CALL),
            operations: Cell::new(0),
            end: Cell::new(None),
            next_memory: Cell::new(None),
            memory_at_start: Cell::new(None),
            why: RefCell::new(None),
            by_time: Cell::new(false),
            halt: RefCell::new(None),
            log: RefCell::new(Vec::new()),
            printed: Cell::new(0),
        }
    };
}

impl Used {
    fn start(&self, bounds: Bounds, halt: Option<Halt>) {
        self.halt.replace(halt);
        let now = Instant::now();
        self.bounds.set(bounds);
        self.end.set(Some(now + bounds.time));
        self.next_memory.set(Some(now + MEMORY_EVERY));
        self.memory_at_start.set(resident_bytes());
    }

    /// What ends the call now.
    fn look(&self, before: u64, count: u64) -> Option<String> {
        if count > self.bounds.get().operations {
            let most = grouped(OPERATIONS);
            return Some(format!("it takes more than {most} operations"));
        }
        if before / CLOCK_EVERY == count / CLOCK_EVERY {
            return None;
        }
        if self.is_halted() {
            return Some("it was halted".to_owned());
        }
        let now = Instant::now();
        if self.end.get().is_some_and(|end| now > end) {
            self.by_time.set(true);
            return Some(format!("it takes longer than {} s", DEADLINE.as_secs()));
        }
        if self.next_memory.get().is_none_or(|next| now < next) {
            return None;
        }
        self.next_memory.set(Some(now + MEMORY_EVERY));
        let grown = resident_bytes()?.saturating_sub(self.memory_at_start.get()?);
        let most = grouped(MEMORY >> 20);
        (grown > MEMORY).then(|| format!("it takes more than {most} MiB of memory"))
    }

    /// Whether it was used.
    pub fn is_halted(&self) -> bool {
        self.halt.borrow().as_ref().is_some_and(Halt::is_halted)
    }

    fn again(&self) -> Bounds {
        let is_ended = self.why.borrow().is_some();
        if self.is_halted() {
            // Nobody waits for its place.
            return Bounds {
                time: Duration::ZERO,
                operations: 0,
            };
        }
        Bounds {
            time: if self.by_time.get() {
                FINDING_ANY
            } else {
                FINDING
            },
            operations: self.operations.get() - u64::from(is_ended),
        }
    }
}

/// Counts operations of the call on this thread; gives why it must end, if it must.
pub fn progress(operations: u64) -> Option<String> {
    USED.with(|used| {
        if let Some(why) = &*used.why.borrow() {
            return Some(why.clone());
        }
        let before = used.operations.get();
        let count = before.saturating_add(operations);
        used.operations.set(count);
        let why = used.look(before, count)?;
        used.why.replace(Some(why.clone()));
        Some(why)
    })
}

/// Keeps a line that the call on this thread prints, as far as it may print.
pub fn print(mut line: String) {
    USED.with(|used| {
        let mut log = used.log.borrow_mut();
        let Some(left) = PRINTED.checked_sub(used.printed.get()) else {
            return;
        };
        if log.len() == LINES {
            log.push(format!("… only the first {LINES} lines are shown"));
            used.printed.set(PRINTED + 1);
            return;
        }
        used.printed.set(used.printed.get() + line.len() + 1);
        let is_cut = line.len() > left;
        line.truncate(line.floor_char_boundary(left));
        line.shrink_to_fit();
        log.push(line);
        if is_cut {
            let most = grouped(PRINTED as u64);
            log.push(format!("… only the first {most} bytes are shown"));
        }
    });
}

/// Memory of this process that is in use; `None` where the system does not tell.
#[cfg(target_os = "linux")]
fn resident_bytes() -> Option<u64> {
    use std::{fs::File, os::unix::fs::FileExt, sync::OnceLock};

    static STATUS: OnceLock<Option<File>> = OnceLock::new();
    // It counts in KiB where the faster `statm` has pages, whose size differs between machines.
    let file = STATUS.get_or_init(|| File::open("/proc/self/status").ok());
    let mut buffer = [0; 4096];
    let length = file.as_ref()?.read_at(&mut buffer, 0).ok()?;
    let text = String::from_utf8_lossy(&buffer[..length]);
    let line = text.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kib: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kib << 10)
}

/// Memory of this process that is in use; `None` where the system does not tell.
#[cfg(not(target_os = "linux"))]
fn resident_bytes() -> Option<u64> {
    None
}

/// Runs a call on its own thread, whose stack holds the deepest calls, and within bounds.
pub fn run_limited<T: Send>(bounds: Bounds, work: impl FnOnce() -> T + Send) -> Run<T> {
    let halt = HALT.with_borrow(Clone::clone);
    let limited = || {
        USED.with(|used| used.start(bounds, halt));
        let result = work();
        USED.with(|used| Run {
            result,
            log: used.log.take(),
            again: used.again(),
            met: used.why.borrow().clone(),
        })
    };
    thread::scope(|scope| {
        let thread = thread::Builder::new()
            .name("script".into())
            .stack_size(STACK)
            .spawn_scoped(scope, limited)
            .expect("the system can start a thread");
        thread.join().unwrap_or_else(|panic| resume_unwind(panic))
    })
}
