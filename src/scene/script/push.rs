//! `push` in place of Rhai's own, which measures the whole list after each call: adding n elements takes n²
//! steps.
//!
//! Rhai measures what a native function may have changed, but not the `this` of a script function. So
//! `push` is a script function; its body is custom syntax, which measures the list only after enough was
//! added.

use std::{cell::Cell, sync::OnceLock};

use rhai::{
    AST, Array, Dynamic, Engine, EvalAltResult as Wrong, EvalContext, Expression, ImmutableString,
    Map, Module, Position, Scope, Shared,
};

use super::limits::{ARRAY, MAP, TEXT};

type Result<T> = std::result::Result<T, Box<Wrong>>;

/// Word of the custom syntax that appends to `this`.
const WORD: &str = "push_to_this";
/// Function around that syntax, which replaces the built-in `push`.
const FUNCTION: &str = "fn push(item) { push_to_this item; }";
/// Name of the file of that function in messages; no script can have it.
const FILE: &str = "<push>";

/// Amount that may be added before a list is measured in any case: elements, entries and blocks of text.
const LITTLE: usize = 1024;
/// Size of a block of text that counts as one element, bytes.
const BLOCK: usize = 64;

/// Amount that was added on this thread, so by one call, since a list was last measured, and the amount at
/// which the next list is measured.
#[derive(Clone, Copy)]
struct Added {
    now: usize,
    most: usize,
}

thread_local! {
    static ADDED: Cell<Added> = const { Cell::new(Added { now: 0, most: LITTLE }) };
}

/// Replaces Rhai's `push` in an engine.
pub fn register(engine: &mut Engine) {
    register_word(engine);
    engine.register_global_module(Shared::clone(function()));
}

fn register_word(engine: &mut Engine) {
    let syntax = engine.register_custom_syntax([WORD, "$expr$"], false, push);
    syntax.expect("a word and an expression");
}

/// Module with the function, compiled once for all engines, so that its tokens count for no call.
fn function() -> &'static Shared<Module> {
    static MODULE: OnceLock<Shared<Module>> = OnceLock::new();
    MODULE.get_or_init(|| {
        let mut engine = Engine::new_raw();
        register_word(&mut engine);
        let mut ast: AST = engine.compile(FUNCTION).expect("it is right");
        ast.set_source(FILE);
        let module = Module::eval_ast_as_new(Scope::new(), &ast, &engine);
        module.expect("nothing runs").into()
    })
}

fn push(context: &mut EvalContext, inputs: &[Expression]) -> Result<Dynamic> {
    let item = context.eval_expression_tree(&inputs[0])?;
    let of_item = item.type_name();
    let Some(this) = context.this_ptr_mut() else {
        let signature = format!("push ({of_item})");
        return Err(Wrong::ErrorFunctionNotFound(signature, Position::NONE).into());
    };
    if this.is_read_only() {
        let name = "push".to_owned();
        return Err(Wrong::ErrorNonPureMethodCallOnConstant(name, Position::NONE).into());
    }
    let of_this = this.type_name();
    let Some(mut list) = this.write_lock::<Array>() else {
        let signature = format!("push ({of_this}, {of_item})");
        return Err(Wrong::ErrorFunctionNotFound(signature, Position::NONE).into());
    };
    let mut size = Size::default();
    size.add(&item);
    list.push(item);
    let Added { now, most } = ADDED.get();
    let now = now + 1 + size.total();
    if now < most && list.len() <= ARRAY {
        ADDED.set(Added { now, most });
        return Ok(Dynamic::UNIT);
    }
    let mut size = Size::default();
    size.add_all(&list);
    // A list that grows steadily is measured when it has grown by a quarter.
    let most = LITTLE.max(size.total() / 4);
    ADDED.set(Added { now: 0, most });
    size.check()?;
    Ok(Dynamic::UNIT)
}

/// Number of nested elements and entries, and bytes of text, of a value, as Rhai counts them.
#[derive(Default)]
struct Size {
    elements: usize,
    entries: usize,
    bytes: usize,
}

impl Size {
    fn add(&mut self, value: &Dynamic) {
        if let Some(list) = value.read_lock::<Array>() {
            self.add_all(&list);
        } else if let Some(map) = value.read_lock::<Map>() {
            self.entries += map.len();
            map.values().for_each(|value| self.add(value));
        } else if let Some(text) = value.read_lock::<ImmutableString>() {
            self.bytes += text.len();
        }
    }

    fn add_all(&mut self, list: &Array) {
        self.elements += list.len();
        list.iter().for_each(|value| self.add(value));
    }

    fn total(&self) -> usize {
        self.elements + self.entries + self.bytes / BLOCK
    }

    fn check(&self) -> Result<()> {
        let what = if self.bytes > TEXT {
            "Length of string"
        } else if self.elements > ARRAY {
            "Size of array/BLOB"
        } else if self.entries > MAP {
            "Size of object map"
        } else {
            return Ok(());
        };
        Err(Wrong::ErrorDataTooLarge(what.to_owned(), Position::NONE).into())
    }
}
