//! The sandbox: which parts of Rhai a script has, and what ends it.

use std::{sync::Arc, time::Duration};

use rhai::{
    Array, Dynamic, Engine, EvalAltResult, ImmutableString, Map, NativeCallContext, Position,
    Variant,
    packages::{
        ArithmeticPackage, BasicArrayPackage, BasicFnPackage, BasicIteratorPackage,
        BasicMapPackage, BasicMathPackage, BasicStringPackage, LogicPackage, MoreStringPackage,
        Package,
    },
};

use super::{
    api, bounded_functions,
    call_limits::{print, progress},
    catch_values::{self, Caught},
    dedup, limited_parser,
    nested_values::{self, NESTED},
    push, sort,
    source_files::{MOST_BYTES, Resolver, Sources},
};

/// Longest time of one call: ten times what the largest allowed `setup` takes, since other work
/// may share the machine.
pub const DEADLINE: Duration = Duration::from_secs(10);
/// Most operations of one call.
pub const OPERATIONS: u64 = 10_000_000;
/// Deepest nesting of calls.
pub const CALLS: usize = 32;
/// Deepest nesting of expressions outside and inside functions.
const DEPTH: [usize; 2] = [64, 48];
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
const FUNCTIONS: usize = 500;
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

/// What ends a call, for the manual: what is limited, and where.
pub fn limits() -> Vec<(&'static str, String)> {
    let count = |n: usize| grouped(n as u64);
    vec![
        (
            "time of one call, and of reading a script with its imports",
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
        ("bytes of a script file", grouped(MOST_BYTES)),
    ]
}

/// Digits in groups of three.
pub fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let groups = digits.as_bytes().rchunks(3).rev();
    let texts: Vec<_> = groups.map(String::from_utf8_lossy).collect();
    texts.join(",")
}

/// An engine for one script.
pub fn engine(sources: &Arc<Sources>) -> Engine {
    let mut engine = Engine::new_raw();
    // Everything but the core of the language package, which has `sleep`, and the clock.
    engine.register_global_module(ArithmeticPackage::new().as_shared_module());
    engine.register_global_module(LogicPackage::new().as_shared_module());
    engine.register_global_module(BasicMathPackage::new().as_shared_module());
    engine.register_global_module(BasicStringPackage::new().as_shared_module());
    engine.register_global_module(MoreStringPackage::new().as_shared_module());
    engine.register_global_module(BasicArrayPackage::new().as_shared_module());
    engine.register_global_module(BasicMapPackage::new().as_shared_module());
    engine.register_global_module(BasicIteratorPackage::new().as_shared_module());
    engine.register_global_module(BasicFnPackage::new().as_shared_module());
    engine.disable_symbol("eval");
    // Functions inside functions inside functions have no limit of Rhai's.
    engine.disable_symbol("curry");
    engine.set_strict_variables(true);
    engine.set_fail_on_invalid_map_property(true);
    engine.set_max_expr_depths(DEPTH[0], DEPTH[1]);
    engine.set_max_call_levels(CALLS);
    // The progress callback ends it with more to say; this only backs it.
    engine.set_max_operations(OPERATIONS * 2);
    engine.set_max_string_size(TEXT);
    engine.set_max_array_size(ARRAY);
    engine.set_max_map_size(MAP);
    engine.set_max_modules(MODULES);
    engine.set_max_functions(FUNCTIONS);
    engine.set_max_variables(VARIABLES);
    // Rhai's own count begins anew inside closures.
    engine.on_progress(|_| progress(1).map(Into::into));
    engine.on_print(|text| print(text.to_owned()));
    engine.on_debug(|text, source, at| print(placed(source, at, text)));
    register_print::<ImmutableString>(&mut engine);
    register_print::<char>(&mut engine);
    register_print::<bool>(&mut engine);
    register_print::<()>(&mut engine);
    register_print::<f64>(&mut engine);
    register_print::<Array>(&mut engine);
    register_print::<Map>(&mut engine);
    register_print::<Dynamic>(&mut engine);
    engine.set_module_resolver(Resolver(Arc::clone(sources)));
    bounded_functions::register(&mut engine);
    nested_values::register(&mut engine);
    sort::register(&mut engine);
    dedup::register(&mut engine);
    push::register(&mut engine);
    let caught = Caught::default();
    limited_parser::register(&mut engine, &caught);
    catch_values::register(&mut engine, &caught);
    api::register(&mut engine);
    engine
}

/// A line with the place that it comes from.
fn placed(file: Option<&str>, at: Position, text: &str) -> String {
    let (file, line) = (file.unwrap_or_default(), at.line().unwrap_or(0));
    format!("{file}:{line}: {text}")
}

/// `print` of a type, in place of Rhai's own, which does not say where it was called.
fn register_print<T: Variant + Clone>(engine: &mut Engine) {
    engine.register_fn(
        "print",
        |context: NativeCallContext, value: T| -> Result<ImmutableString, Box<EvalAltResult>> {
            let text: ImmutableString = context.call_native_fn("to_string", (value,))?;
            Ok(placed(context.call_source(), context.call_position(), &text).into())
        },
    );
}
