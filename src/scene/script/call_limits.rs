//! Calls of scripts within limits: each on its own thread, with counters of its use, a way to halt it, and its printed
//! lines.

use std::{cell::RefCell, panic::resume_unwind, thread, time::Duration};

use rhai::{AST, Engine, EvalAltResult, LexError, ParseError, ParseErrorType, Position};

use super::{
    bounds::{Bounds, Halt, halt, of_next_call, take},
    limits::{DEADLINE, LINES, MEMORY, PRINTED, STACK, TIME_IS},
};
use crate::diagnostic::printable_lines;
use reflet_base::{clock::Instant, digits::grouped, guard, processor_time};

/// Number of operations between two checks of the clock; a closure that is bound to itself can double in about
/// as many.
const CLOCK_EVERY: u64 = 4;
/// Time between two checks of the memory, in which a call cannot fill much of it.
const MEMORY_EVERY: Duration = Duration::from_millis(5);
/// Time to find the place of a limit in a second run, which notes each step and is slower.
const FINDING: Duration = Duration::from_secs(2);
/// Time of the second run if the first has met its time limit: any place that the second reaches then is as
/// good.
const FINDING_ANY: Duration = Duration::from_secs(1);

/// A finished call.
pub struct Run<T> {
    /// Result of the call.
    pub result: T,
    /// Lines that the call printed.
    pub log: Vec<String>,
    /// Limits for a second run that comes to the same place.
    pub again: Bounds,
    /// Limit that the call has met, as a message.
    met: Option<String>,
    /// Time that the call took, as it is counted for its limit.
    time: Duration,
}

impl<T> Run<Result<T, Box<EvalAltResult>>> {
    /// Turns the result into an error if a limit was met though the call came to its end, because a function of
    /// Rhai ignored the error. No place is looked for: a second run would come to its end as well.
    pub fn or_limit(mut self) -> Self {
        if let (Ok(_), Some(why)) = (&self.result, &self.met) {
            let ended = EvalAltResult::ErrorTerminated(why.clone().into(), Position::NONE);
            self.result = Err(ended.into());
            self.again.operations = 0;
        }
        self
    }
}

/// Use of the limits by the call on this thread.
struct Used {
    bounds: Bounds,
    operations: u64,
    start: Instant,
    /// Processor time of the thread when the call began, where the system tells it.
    processor_at_start: Option<Duration>,
    /// Earliest moment at which the time can be over, since the thread works at most all the time.
    end: Instant,
    next_memory: Instant,
    memory_at_start: Option<u64>,
    /// Limit that was met, kept so that code that ignores the error cannot go on.
    why: Option<String>,
    by_time: bool,
    halt: Option<Halt>,
    log: Vec<String>,
    /// Bytes in the log; above the limit once the log is full.
    printed: usize,
}

thread_local! {
    /// Begins with the call, which has a thread of its own.
    static USED: RefCell<Option<Used>> = const { RefCell::new(None) };
}

/// Reads or changes the use of the limits by the call on this thread; `None` outside of calls.
fn with_used<T>(work: impl FnOnce(&mut Used) -> T) -> Option<T> {
    USED.with_borrow_mut(|used| used.as_mut().map(work))
}

impl Used {
    fn begin(bounds: Bounds, halt: Option<Halt>) -> Self {
        let start = Instant::now();
        Self {
            bounds,
            operations: 0,
            start,
            processor_at_start: processor_time::of_thread(),
            end: start + bounds.time,
            next_memory: start + MEMORY_EVERY,
            memory_at_start: resident_bytes(),
            why: None,
            by_time: false,
            halt,
            log: Vec::new(),
            printed: 0,
        }
    }

    /// Message about the limit that ends the call now, if any; operations were `before`.
    fn look(&mut self, before: u64) -> Option<String> {
        let bounds = self.bounds;
        if self.operations > bounds.operations {
            let most = grouped(bounds.operations);
            return Some(format!("it takes more than {most} operations"));
        }
        if before / CLOCK_EVERY == self.operations / CLOCK_EVERY {
            return None;
        }
        if self.is_halted() {
            return Some("it was halted".to_owned());
        }
        let now = Instant::now();
        if self.is_out_of_time(now) {
            self.by_time = true;
            let most = bounds.time.as_secs_f64();
            return Some(match bounds.is_rest {
                true => format!(
                    "all scripts of the scene together take more than {} s of {TIME_IS}",
                    DEADLINE.as_secs()
                ),
                false => format!("it takes more than {most} s of {TIME_IS}"),
            });
        }
        if now < self.next_memory {
            return None;
        }
        self.next_memory = now + MEMORY_EVERY;
        let grown = resident_bytes()?.saturating_sub(self.memory_at_start?);
        let most = grouped(MEMORY >> 20);
        (grown > MEMORY).then(|| format!("it takes more than {most} MiB of memory"))
    }

    /// Processor time that the call has taken so far; `None` where the system does not tell it.
    fn processor_time(&self) -> Option<Duration> {
        Some(processor_time::of_thread()?.saturating_sub(self.processor_at_start?))
    }

    /// Whether the processor time of the thread is used up; other work on the machine does not count.
    fn is_out_of_time(&mut self, now: Instant) -> bool {
        if now <= self.end {
            return false;
        }
        let Some(processor) = self.processor_time() else {
            return true;
        };
        let left = self.bounds.time.checked_sub(processor);
        self.end = left.map_or(self.end, |left| now + left);
        left.is_none()
    }

    /// Whether the handle of this call was halted.
    fn is_halted(&self) -> bool {
        self.halt.as_ref().is_some_and(Halt::is_halted)
    }

    fn again(&self) -> Bounds {
        if self.is_halted() {
            // No second run: nobody waits for the place.
            return Bounds::CALL.within(Duration::ZERO).at_most(0);
        }
        Bounds {
            time: if self.by_time { FINDING_ANY } else { FINDING },
            operations: self.operations - u64::from(self.why.is_some()),
            is_rest: false,
        }
    }
}

/// Counts operations of the call on this thread; gives the reason why it must end, if any.
pub fn progress(operations: u64) -> Option<String> {
    with_used(|used| {
        if used.why.is_none() {
            let before = used.operations;
            used.operations = before.saturating_add(operations);
            used.why = used.look(before);
        }
        used.why.clone()
    })?
}

/// Limit that the call on this thread has met, as a message.
pub fn met() -> Option<String> {
    with_used(|used| used.why.clone())?
}

/// Compiles a text. If a limit was met, the error says so: Rhai may say that it expected something else there.
///
/// # Errors
/// A mistake of the text, or the limit that was met.
pub fn compile(engine: &Engine, text: &str) -> Result<AST, ParseError> {
    engine.compile(text).map_err(|wrong| match met() {
        Some(why) => {
            let limit = ParseErrorType::BadInput(LexError::Runtime(why));
            ParseError(limit.into(), wrong.position())
        }
        None => wrong,
    })
}

/// Keeps a line that the call on this thread prints, as far as its limits allow; what could control a terminal is
/// replaced.
pub fn print(text: &str) {
    with_used(|used| {
        let Some(left) = PRINTED.checked_sub(used.printed) else {
            return;
        };
        if used.log.len() == LINES {
            let cut = format!("… only the first {LINES} lines are shown");
            used.log.push(cut);
            used.printed = PRINTED + 1;
            return;
        }
        used.printed += text.len() + 1;
        let is_cut = text.len() > left;
        let text = &text[..text.floor_char_boundary(left)];
        used.log.push(printable_lines(text));
        if is_cut {
            let most = grouped(PRINTED as u64);
            let cut = format!("… only the first {most} bytes are shown");
            used.log.push(cut);
        }
    });
}

/// Resident memory of this process, bytes; `None` where the system does not tell it.
#[cfg(target_os = "linux")]
fn resident_bytes() -> Option<u64> {
    use std::{fs::File, os::unix::fs::FileExt, sync::OnceLock};

    static STATUS: OnceLock<Option<File>> = OnceLock::new();
    // `status` counts in KiB; the faster `statm` counts pages, whose size differs between machines.
    let file = STATUS.get_or_init(|| File::open("/proc/self/status").ok());
    let mut buffer = [0; 4096];
    let length = file.as_ref()?.read_at(&mut buffer, 0).ok()?;
    let text = String::from_utf8_lossy(&buffer[..length]);
    let line = text.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kib: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kib << 10)
}

/// Resident memory of this process, bytes; `None` where the system does not tell it.
#[cfg(not(target_os = "linux"))]
fn resident_bytes() -> Option<u64> {
    None
}

/// Runs a call within limits on a thread of its own, whose stack is large enough for the deepest calls. It takes from
/// the time that calls have [`together`].
pub fn run_limited<T: Send>(bounds: Bounds, work: impl FnOnce() -> T + Send) -> Run<T> {
    let (bounds, halt) = of_next_call(bounds);
    let ran = run_alone_under(bounds, halt, work);
    take(ran.time);
    ran
}

/// Runs a call within limits as [`run_limited`] does, without taking from the time of others: a second run of a call
/// that was counted.
pub fn run_alone<T: Send>(bounds: Bounds, work: impl FnOnce() -> T + Send) -> Run<T> {
    run_alone_under(bounds, halt(), work)
}

fn run_alone_under<T: Send>(
    bounds: Bounds,
    halt: Option<Halt>,
    work: impl FnOnce() -> T + Send,
) -> Run<T> {
    let limited = || {
        USED.set(Some(Used::begin(bounds, halt)));
        let result = work();
        let used = USED.take().expect("it began with the call");
        Run {
            result,
            again: used.again(),
            time: used
                .processor_time()
                .unwrap_or_else(|| used.start.elapsed()),
            met: used.why,
            log: used.log,
        }
    };
    let thread = thread::Builder::new().name("script".into());
    let done = guard::apart(thread.stack_size(STACK), limited);
    done.unwrap_or_else(|panic| resume_unwind(panic))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::script::bounds::{LEFT, together};

    const SHORT: Bounds = Bounds {
        time: Duration::from_millis(20),
        ..Bounds::CALL
    };

    #[test]
    fn a_call_that_waits_for_a_processor_has_its_time_left() {
        let ran = run_limited(SHORT, || {
            thread::sleep(2 * SHORT.time);
            progress(CLOCK_EVERY)
        });
        assert_eq!(ran.result.is_none(), processor_time::of_thread().is_some());
    }

    #[test]
    fn calls_together_have_the_time_of_one() {
        let work = |bounds| {
            run_limited(bounds, || {
                loop {
                    if let Some(why) = progress(CLOCK_EVERY) {
                        return why;
                    }
                }
            })
            .result
        };
        together(|| {
            LEFT.set(Some(SHORT.time * 3 / 2));
            let [first, second, third] = [(); 3].map(|()| work(SHORT));
            assert!(first.contains("it takes"), "{first}");
            assert!(second.contains("together"), "{second}");
            assert!(third.contains("together"), "{third}");
            assert_eq!(LEFT.get(), Some(Duration::ZERO));
            // The place of a limit is looked for all the same.
            assert!(run_alone(SHORT, || progress(CLOCK_EVERY)).result.is_none());
            together(|| {
                assert!(
                    work(SHORT).contains("together"),
                    "it is inside of the other"
                )
            });
        });
        assert_eq!(LEFT.get(), None);
    }

    #[test]
    fn a_call_that_works_comes_to_the_end_of_its_time() {
        let ran = run_limited(SHORT, || {
            loop {
                if let Some(why) = progress(CLOCK_EVERY) {
                    return why;
                }
            }
        });
        assert!(ran.result.contains(TIME_IS), "{}", ran.result);
        assert_eq!(ran.again.time, FINDING_ANY);
    }
}
