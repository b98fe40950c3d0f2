//! Limits of scripts, and their list for the manual.

use std::time::Duration;

use reflet_base::digits::grouped;

/// Maximum time of one call: ten times what the largest allowed `setup` takes, since machines differ.
pub const DEADLINE: Duration = Duration::from_secs(10);
/// Kind of time that is counted: processor time if the system tells it, so that other work on the machine does
/// not count.
pub const TIME_IS: &str = if cfg!(unix) { "processor time" } else { "time" };
/// Maximum number of operations of one call.
pub const OPERATIONS: u64 = 10_000_000;
/// Maximum nesting of calls.
pub const CALLS: usize = 32;
/// Maximum number of arguments of a call.
pub const ARGUMENTS: usize = 64;
/// Maximum nesting of expressions, outside and inside functions.
pub const DEPTH: [usize; 2] = [64, 48];
/// Maximum length of a text, bytes. Rhai counts the texts inside an array or a map together, and `setup` may
/// give a name to as many elements as an array has.
pub const TEXT: usize = 1 << 20;
/// Maximum number of elements of an array, nested elements included.
pub const ARRAY: usize = 50_000;
/// Maximum number of numbers of `floats`: the corners of two million triangles.
pub use crate::toml_text::MOST_FLOATS as FLOATS;
/// Maximum number of entries of an object map, nested entries included: several for each element.
pub const MAP: usize = 500_000;
/// Maximum number of imports.
pub const MODULES: usize = 32;
/// Maximum number of functions of a script.
pub const FUNCTIONS: usize = 500;
/// Maximum number of variables of a function at a time.
pub const VARIABLES: usize = 64;
/// Maximum number of lines that a call may print, and of their bytes.
pub const LINES: usize = 1000;
pub const PRINTED: usize = 64 << 10;
/// Maximum memory that a call may add to the process, bytes, where the system tells it (Linux).
pub const MEMORY: u64 = 1 << 30;
/// Stack of the thread that a call runs on, bytes: for the deepest calls, and a KiB for each array or map of
/// the deepest value, which is copied and freed by recursion. Unused stack takes no memory.
pub const STACK: usize = (32 << 20) + ((ARRAY + MAP) << 10);
/// Maximum nesting of arrays and maps that are compared, written, exported or returned.
pub const NESTED: usize = 64;
/// Maximum size of a script file, bytes.
pub const FILE_BYTES: u64 = 1 << 20;

/// Limits of scripts for the manual: limited quantity and limit.
pub fn limits() -> Vec<(&'static str, String)> {
    let count = |n: usize| grouped(n as u64);
    vec![
        (
            "processor time (on Windows, time) of one call, and of reading a script with its imports",
            format!("{} s", DEADLINE.as_secs()),
        ),
        (
            "processor time of all scripts of a scene and of those that it places together, to read them and call \
             their `setup`, or for one frame",
            format!("{} s", DEADLINE.as_secs()),
        ),
        (
            "operations of one call; tokens that are parsed count too",
            grouped(OPERATIONS),
        ),
        (
            "memory that one call adds (Linux)",
            format!("{} MiB", grouped(MEMORY >> 20)),
        ),
        ("nesting of calls", count(CALLS)),
        ("arguments of a call", count(ARGUMENTS)),
        (
            "nesting of expressions",
            format!("{}; {} inside functions", DEPTH[0], DEPTH[1]),
        ),
        (
            "bytes of a text, or of all texts inside an array or a map",
            count(TEXT),
        ),
        (
            "elements of an array, with those inside its elements",
            count(ARRAY),
        ),
        ("numbers of `floats`", count(FLOATS)),
        (
            "entries of an object map, with those inside its entries, where it is passed or returned",
            count(MAP),
        ),
        (
            "nesting of arrays and maps where they are compared, written or returned",
            count(NESTED),
        ),
        (
            "variables of a function at a time, and of a block",
            count(VARIABLES),
        ),
        ("functions", count(FUNCTIONS)),
        ("imports", count(MODULES)),
        ("lines printed by a call", count(LINES)),
        ("bytes printed by a call", count(PRINTED)),
        ("bytes of a script file", grouped(FILE_BYTES)),
    ]
}
