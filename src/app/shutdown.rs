//! Ctrl-C and SIGTERM as a shutdown request after the current frame; the second one ends at once.

use std::sync::{
    Arc, OnceLock,
    atomic::{AtomicBool, AtomicUsize, Ordering},
};

use signal_hook::{
    consts::{SIGINT, SIGTERM},
    flag::{register_conditional_shutdown, register_usize},
};

/// Number of the signal that came first, 0 before any.
fn signal() -> &'static Arc<AtomicUsize> {
    static SIGNAL: OnceLock<Arc<AtomicUsize>> = OnceLock::new();
    SIGNAL.get_or_init(Arc::default)
}

/// Handles the signals as shutdown requests from now on; see [`is_requested`].
pub fn listen() {
    static LISTENING: OnceLock<()> = OnceLock::new();
    LISTENING.get_or_init(|| {
        for number in [SIGINT, SIGTERM] {
            // The order matters: the first signal finds `came` unset, the second one set. Where a
            // system refuses, the signal ends the program, and files are whole even then.
            let came = Arc::new(AtomicBool::new(false));
            let _ = register_conditional_shutdown(number, 128 + number, came.clone())
                .and_then(|_| signal_hook::flag::register(number, came))
                .and_then(|_| register_usize(number, signal().clone(), number as usize));
        }
    });
}

/// Whether a shutdown was requested.
pub fn is_requested() -> bool {
    signal().load(Ordering::SeqCst) != 0
}

/// The exit code of a program that a signal stopped: 130 after Ctrl-C, 143 after SIGTERM.
pub fn exit_code() -> u8 {
    let number = match signal().load(Ordering::SeqCst) {
        0 => SIGINT as usize,
        number => number,
    };
    128 + number as u8
}
