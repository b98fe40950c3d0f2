//! The sandbox: the parts of Rhai that a script may use, and the limits that end it.

use std::sync::Arc;

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
    limited_parser,
    limits::{ARRAY, CALLS, DEPTH, FUNCTIONS, MAP, MODULES, OPERATIONS, TEXT, VARIABLES},
    nested_values, push, sort,
    source_files::{Resolver, Sources},
};

/// Makes an engine for one script.
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
    // Rhai has no limit for functions bound to functions bound to functions.
    engine.disable_symbol("curry");
    engine.set_strict_variables(true);
    engine.set_fail_on_invalid_map_property(true);
    engine.set_max_expr_depths(DEPTH[0], DEPTH[1]);
    engine.set_max_call_levels(CALLS);
    // The progress callback ends a call first, with a better message; this is a second barrier.
    engine.set_max_operations(OPERATIONS * 2);
    engine.set_max_string_size(TEXT);
    engine.set_max_array_size(ARRAY);
    engine.set_max_map_size(MAP);
    engine.set_max_modules(MODULES);
    engine.set_max_functions(FUNCTIONS);
    engine.set_max_variables(VARIABLES);
    // Count operations here: Rhai's own count starts anew inside closures.
    engine.on_progress(|_| progress(1).map(Into::into));
    engine.on_print(print);
    engine.on_debug(|text, source, at| print(&placed(source, at, text)));
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
    push::register(&mut engine);
    let caught = Caught::default();
    limited_parser::register(&mut engine, &caught);
    catch_values::register(&mut engine, &caught);
    api::register(&mut engine, sources);
    engine
}

/// A line with the file and the line of the script that prints it.
fn placed(file: Option<&str>, at: Position, text: &str) -> String {
    let (file, line) = (file.unwrap_or_default(), at.line().unwrap_or(0));
    format!("{file}:{line}: {text}")
}

/// Registers `print` of a type, in place of Rhai's own, which does not tell where it was called.
fn register_print<T: Variant + Clone>(engine: &mut Engine) {
    engine.register_fn(
        "print",
        |context: NativeCallContext, value: T| -> Result<ImmutableString, Box<EvalAltResult>> {
            let text: ImmutableString = context.call_native_fn("to_string", (value,))?;
            Ok(placed(context.call_source(), context.call_position(), &text).into())
        },
    );
}
