//! Search for the place where a limit was met. Rhai overwrites that place at the end of each function that
//! the error leaves, so the call, which is deterministic, is run again with a debugger that notes it.

use std::{cell::RefCell, mem::discriminant, sync::Arc};

use rhai::{
    Engine, EvalAltResult, EvalContext, Position,
    debugger::{DebuggerCommand, DebuggerEvent},
};

use super::{
    ended::{LimitHit, Place, is_limit},
    engine,
    source_files::Sources,
};

/// Notes of the debugger so far.
#[derive(Default)]
struct Seen {
    /// Newest place in each of the running functions, outermost first.
    places: Vec<Place>,
    /// Place and calls when the error of a limit left its first function.
    met: Option<LimitHit>,
}

thread_local! {
    static SEEN: RefCell<Seen> = RefCell::default();
}

/// Runs a call that has met a limit again, on an engine that notes its places; `None` if it ends differently
/// this time. To be called inside [`super::call_limits::run_limited`], because the notes are thread-local.
pub fn again<T>(
    sources: &Arc<Sources>,
    first: &EvalAltResult,
    work: impl FnOnce(&Engine) -> Result<T, Box<EvalAltResult>>,
) -> Option<LimitHit> {
    SEEN.take();
    let result = work(&watching(sources));
    let mut seen = SEEN.take();
    let kind = |wrong: &EvalAltResult| discriminant(wrong.unwrap_inner());
    if !result.is_err_and(|wrong| kind(&wrong) == kind(first)) {
        return None;
    }
    // Outside of functions no function is left, so `met` was not set.
    seen.met.or_else(|| {
        let place = seen.places.pop()?;
        Some(LimitHit {
            place,
            calls: Vec::new(),
        })
    })
}

/// An engine with a debugger that notes the place of every expression.
#[expect(
    deprecated,
    reason = "Rhai marks its debugger so to say that it may change"
)]
fn watching(sources: &Arc<Sources>) -> Engine {
    let mut engine = engine::engine(sources);
    engine.register_debugger(
        |_, debugger| debugger,
        |context, event, _, file, at| {
            SEEN.with_borrow_mut(|seen| note(seen, &context, event, file.unwrap_or_default(), at));
            Ok(DebuggerCommand::StepInto)
        },
    );
    engine
}

fn note(seen: &mut Seen, context: &EvalContext, event: DebuggerEvent, file: &str, at: Position) {
    if seen.met.is_some() {
        return;
    }
    let level = context.call_level();
    match event {
        DebuggerEvent::FunctionExitWithValue(_) => seen.places.truncate(level),
        DebuggerEvent::FunctionExitWithError(wrong) if is_limit(wrong) => {
            seen.met = Some(met(seen, context));
        }
        DebuggerEvent::FunctionExitWithError(_) => seen.places.truncate(level),
        _ if at.is_none() => {}
        _ => {
            seen.places.resize_with(level + 1, Place::default);
            let place = &mut seen.places[level];
            if place.file != file {
                file.clone_into(&mut place.file);
            }
            place.at = at;
        }
    }
}

fn met(seen: &Seen, context: &EvalContext) -> LimitHit {
    let stack = context.global_runtime_state().debugger().call_stack();
    // A call is located in the file of the function that makes it.
    let mut file = String::new();
    let mut calls = Vec::new();
    for call in stack {
        let from = Place {
            file: std::mem::take(&mut file),
            at: call.pos,
        };
        file = call.source.as_deref().unwrap_or_default().to_owned();
        calls.push((call.fn_name.to_string(), from));
    }
    LimitHit {
        place: seen.places.last().cloned().unwrap_or_default(),
        calls,
    }
}
