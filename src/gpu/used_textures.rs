//! Textures that a shader uses, by name.

use std::collections::BTreeSet;

use naga::{
    Expression, Function, GlobalVariable, Handle, ImageClass, Module, Statement, TypeInner,
};

use super::specialize::visit;

/// Names of the textures of `@group(2)` that some entry point of a shader uses, by binding number.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UsedTextures {
    /// Textures that are read, whatever the values of overrides.
    pub read: Vec<String>,
    /// Textures that are written with these values of overrides; some may be read too.
    pub written: Vec<String>,
}

impl UsedTextures {
    /// Textures of a parsed shader, and of the part of it that some values of overrides leave.
    pub fn new(whole: &Module, part: &Module) -> Self {
        let used = |module: &Module, is_written: bool| {
            let globals = if is_written {
                stored_textures(module)
            } else {
                read_textures(module)
            };
            let used = globals.into_iter().filter_map(|handle| {
                let global = &module.global_variables[handle];
                let slot = global.binding.filter(|slot| slot.group == 2)?;
                Some((slot.binding, global.name.clone()?))
            });
            let mut used: Vec<_> = used.collect();
            used.sort_unstable();
            used.into_iter().map(|(_, name)| name).collect()
        };
        Self {
            read: used(whole, false),
            written: used(part, true),
        }
    }
}

/// Textures that entry points and the functions that they call store to.
fn stored_textures(module: &Module) -> BTreeSet<Handle<GlobalVariable>> {
    let mut stored = BTreeSet::new();
    for function in used_functions(module) {
        visit(&function.body, &mut |statement| {
            if let Statement::ImageStore { image, .. } = statement
                && let Expression::GlobalVariable(handle) = function.expressions[*image]
            {
                stored.insert(handle);
            }
        });
    }
    stored
}

/// Textures that entry points and the functions that they call read: all that are sampled, and storage textures that they load.
fn read_textures(module: &Module) -> BTreeSet<Handle<GlobalVariable>> {
    let mut read = BTreeSet::new();
    for function in used_functions(module) {
        for (_, expression) in function.expressions.iter() {
            let (image, is_load) = match expression {
                Expression::ImageLoad { image, .. } => (function.expressions[*image].clone(), true),
                other => (other.clone(), false),
            };
            let Expression::GlobalVariable(handle) = image else {
                continue;
            };
            let TypeInner::Image { class, .. } =
                module.types[module.global_variables[handle].ty].inner
            else {
                continue;
            };
            if is_load || !matches!(class, ImageClass::Storage { .. }) {
                read.insert(handle);
            }
        }
    }
    read
}

/// Entry points and the functions that they call.
fn used_functions(module: &Module) -> Vec<&Function> {
    let mut called = BTreeSet::new();
    let mut pending: Vec<&Function> = module.entry_points.iter().map(|e| &e.function).collect();
    let mut used = Vec::new();
    while let Some(function) = pending.pop() {
        used.push(function);
        visit(&function.body, &mut |statement| {
            if let Statement::Call { function, .. } = statement
                && called.insert(*function)
            {
                pending.push(&module.functions[*function]);
            }
        });
    }
    used
}
