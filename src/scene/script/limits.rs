//! The limits of scripts, and how the manual lists them.

use std::time::Duration;

/// Longest time of one call: ten times what the largest allowed `setup` takes, since machines differ.
pub const DEADLINE: Duration = Duration::from_secs(10);
/// What is counted of it: other work that shares the machine is not, where the system tells.
pub const TIME_IS: &str = if cfg!(unix) { "processor time" } else { "time" };
/// Most operations of one call.
pub const OPERATIONS: u64 = 10_000_000;
/// Deepest nesting of calls.
pub const CALLS: usize = 32;
/// Deepest nesting of expressions outside and inside functions.
pub const DEPTH: [usize; 2] = [64, 48];
/// Longest text, bytes. Rhai counts the texts inside an array or a map together, and `setup` may
/// name as many elements as an array has.
pub const TEXT: usize = 1 << 20;
/// Most elements of an array, with those inside its elements.
pub const ARRAY: usize = 50_000;
/// Most entries of an object map, with those inside its entries: several for each element.
pub const MAP: usize = 500_000;
/// Most imports.
pub const MODULES: usize = 32;
/// Most functions of a script.
pub const FUNCTIONS: usize = 500;
/// Most variables in a function at a time.
pub const VARIABLES: usize = 64;
/// Most lines that a call may print, and most bytes of them.
pub const LINES: usize = 1000;
pub const PRINTED: usize = 64 << 10;
/// Most memory that a call may add to the process, bytes, where the system tells (Linux).
pub const MEMORY: u64 = 1 << 30;
/// Stack of the thread that a call runs on, bytes: for the deepest calls, and a KiB for each array
/// or map of the deepest value, which is copied and freed by recursion. What is not used of it takes
/// no memory.
pub const STACK: usize = (32 << 20) + ((ARRAY + MAP) << 10);
/// Deepest nesting of arrays and maps that are compared, written, exported or returned.
pub const NESTED: usize = 64;
/// Largest script, bytes.
pub const FILE_BYTES: u64 = 1 << 20;

/// What ends a call, for the manual: what is limited, and where.
pub fn limits() -> Vec<(&'static str, String)> {
    let count = |n: usize| grouped(n as u64);
    vec![
        (
            "processor time (on Windows, time) of one call, and of reading a script with its imports",
            format!("{} s", DEADLINE.as_secs()),
        ),
        (
            "operations of one call; words and signs that are read count too",
            grouped(OPERATIONS),
        ),
        (
            "memory that one call adds (Linux)",
            format!("{} MiB", grouped(MEMORY >> 20)),
        ),
        ("calls inside calls", count(CALLS)),
        (
            "nested expressions",
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
        (
            "entries of an object map, with those inside its entries, where it is passed or returned",
            count(MAP),
        ),
        (
            "arrays and maps inside each other where they are compared, written or returned",
            count(NESTED),
        ),
        ("variables of a function at a time", count(VARIABLES)),
        ("functions", count(FUNCTIONS)),
        ("imports", count(MODULES)),
        ("lines printed by a call", count(LINES)),
        ("bytes printed by a call", count(PRINTED)),
        ("bytes of a script file", grouped(FILE_BYTES)),
    ]
}

/// Digits in groups of three.
pub fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let groups = digits.as_bytes().rchunks(3).rev();
    let texts: Vec<_> = groups.map(String::from_utf8_lossy).collect();
    texts.join(",")
}
